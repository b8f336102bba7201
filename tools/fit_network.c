#include "fit_network.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include <lambent/vector.h>

#include "fit_solve.h"

/* Examples side by side, so that the compiler makes vectors of them. */
enum { LANES = 16 };

typedef struct lanes {
    float x[LANES];
} lanes;

/* Sums of units in all layers, and how the loss changes with them. */
typedef struct network_pass {
    lanes unit[FIT_LAYERS + 1][FIT_WIDEST];
    lanes slope[FIT_LAYERS + 1][FIT_WIDEST];
} network_pass;

typedef struct gradient {
    lanes weight[FIT_LAYERS][FIT_WIDEST][FIT_WIDEST + 1];
} gradient;

int fit_layer_from(int layer)
{
    static const int from[FIT_LAYERS] = {FIT_INPUTS, FIT_FIRST, FIT_SECOND};
    return from[layer];
}

int fit_layer_to(int layer)
{
    return layer == FIT_LAYERS - 1 ? FIT_OUTPUTS : fit_layer_from(layer + 1);
}

static void network_forward(const fit_network *network, network_pass *pass)
{
    for (int layer = 0; layer < FIT_LAYERS; ++layer) {
        const int from = fit_layer_from(layer);
        for (int to = 0; to < fit_layer_to(layer); ++to) {
            const float *weight = network->weight[layer][to];
            lanes sum;
            for (int l = 0; l < LANES; ++l) {
                sum.x[l] = weight[from];
            }
            for (int i = 0; i < from; ++i) {
                for (int l = 0; l < LANES; ++l) {
                    sum.x[l] += weight[i] * pass->unit[layer][i].x[l];
                }
            }
            for (int l = 0; l < LANES && layer < FIT_LAYERS - 1; ++l) {
                sum.x[l] = lmb_larger(sum.x[l], 0.0f);
            }
            pass->unit[layer + 1][to] = sum;
        }
    }
}

/* Of the units below a layer, from those above it. */
static void slopes_below(const fit_network *network, int layer, network_pass *pass)
{
    for (int i = 0; i < fit_layer_from(layer); ++i) {
        lanes slope = {{0.0f}};
        for (int to = 0; to < fit_layer_to(layer); ++to) {
            const float weight = network->weight[layer][to][i];
            for (int l = 0; l < LANES; ++l) {
                slope.x[l] += weight * pass->slope[layer + 1][to].x[l];
            }
        }
        for (int l = 0; l < LANES; ++l) {
            slope.x[l] = pass->unit[layer][i].x[l] > 0.0f ? slope.x[l] : 0.0f;
        }
        pass->slope[layer][i] = slope;
    }
}

static void network_backward(const fit_network *network, network_pass *pass, gradient *sum)
{
    for (int layer = FIT_LAYERS - 1; layer >= 0; --layer) {
        const int from = fit_layer_from(layer);
        for (int to = 0; to < fit_layer_to(layer); ++to) {
            const lanes slope = pass->slope[layer + 1][to];
            lanes *weight = sum->weight[layer][to];
            for (int i = 0; i < from; ++i) {
                for (int l = 0; l < LANES; ++l) {
                    weight[i].x[l] += slope.x[l] * pass->unit[layer][i].x[l];
                }
            }
            for (int l = 0; l < LANES; ++l) {
                weight[from].x[l] += slope.x[l];
            }
        }
        if (layer > 0) {
            slopes_below(network, layer, pass);
        }
    }
}

static void inputs_of(const fit_sh3 *sh, float *x)
{
    const float *v = sh->v, *q = sh->q;
    float qv[2];
    fit_sectoral_times(sh, v, qv);
    const float inputs[FIT_INPUTS] = {sh->l1_zonal,
                                      sh->l2_zonal,
                                      v[0] * v[0] + v[1] * v[1],
                                      q[0] * q[0] + q[1] * q[1],
                                      v[0] * q[0] + v[1] * q[1],
                                      sh->m[0] * sh->m[0] + sh->m[1] * sh->m[1],
                                      v[0] * qv[0] + v[1] * qv[1],
                                      q[0] * qv[0] + q[1] * qv[1],
                                      sh->cone_cos};
    memcpy(x, inputs, sizeof inputs);
}

static void inputs_fill(const fit_example *const example[LANES], network_pass *pass)
{
    for (int l = 0; l < LANES; ++l) {
        float x[FIT_INPUTS];
        inputs_of(&example[l]->sh, x);
        for (int i = 0; i < FIT_INPUTS; ++i) {
            pass->unit[0][i].x[l] = x[i];
        }
    }
}

/* Error over all normals, and how it changes with the light. */
static lanes errors_and_slopes(const fit_example *const example[LANES], const lanes light[4], lanes slope[4])
{
    lanes truth[FIT_NORMALS], weight, error = {{0.0f}};
    for (int l = 0; l < LANES; ++l) {
        weight.x[l] = example[l]->weight / FIT_NORMALS;
        for (int k = 0; k < FIT_NORMALS; ++k) {
            truth[k].x[l] = example[l]->irradiance[k];
        }
        for (int i = 0; i < 4; ++i) {
            slope[i].x[l] = 0.0f;
        }
    }
    for (int k = 0; k < FIT_NORMALS; ++k) {
        const float x = fit_normal[0][k], y = fit_normal[1][k], z = fit_normal[2][k], hemisphere = 0.5f + 0.5f * z;
        for (int l = 0; l < LANES; ++l) {
            const float cosine = x * light[1].x[l] + y * light[2].x[l] + z * light[3].x[l];
            const float off = light[0].x[l] * hemisphere + lmb_larger(cosine, 0.0f) - truth[k].x[l];
            const float of_light = 2.0f * weight.x[l] * off, of_direction = cosine > 0.0f ? of_light : 0.0f;
            error.x[l] += weight.x[l] * off * off;
            slope[0].x[l] += of_light * hemisphere;
            slope[1].x[l] += of_direction * x;
            slope[2].x[l] += of_direction * y;
            slope[3].x[l] += of_direction * z;
        }
    }
    return error;
}

/* Two networks' outputs for one of the examples, as the rule has them. */
static void outputs_join(const network_pass *opened, const network_pass *closing, float cone_cos, int l, float *output)
{
    for (int i = 0; i < FIT_OUTPUTS; ++i) {
        output[i] = opened ? opened->unit[FIT_LAYERS][i].x[l] : 0.0f;
        output[i] += closing ? cone_cos * closing->unit[FIT_LAYERS][i].x[l] : 0.0f;
    }
}

/* Forward through the rule, and, with `sum`, back again: to the network that is being fitted, which is `closing` where
 * there is one. */
static lanes rule_pass(const fit_rule *rule, const fit_example *const example[LANES], gradient *sum)
{
    network_pass opened, closing;
    fit_moments moments[LANES];
    lanes light[4], slope[4];
    inputs_fill(example, &opened);
    closing = opened;
    if (rule->opened) {
        network_forward(rule->opened, &opened);
    }
    if (rule->closing) {
        network_forward(rule->closing, &closing);
    }
    for (int l = 0; l < LANES; ++l) {
        const fit_sh3 *sh = &example[l]->sh;
        float output[FIT_OUTPUTS];
        outputs_join(rule->opened ? &opened : NULL, rule->closing ? &closing : NULL, sh->cone_cos, l, output);
        moments[l] = fit_moments_of(sh, output);
        const fit_light solved = fit_solve(&moments[l]);
        light[0].x[l] = solved.ambient;
        for (int i = 0; i < 3; ++i) {
            light[1 + i].x[l] = solved.directional[i];
        }
    }
    const lanes error = errors_and_slopes(example, light, slope);
    if (!sum) {
        return error;
    }
    network_pass *const fitted = rule->closing ? &closing : &opened;
    for (int l = 0; l < LANES; ++l) {
        const fit_sh3 *sh = &example[l]->sh;
        const fit_light of_light = {slope[0].x[l], {slope[1].x[l], slope[2].x[l], slope[3].x[l]}};
        float of_output[FIT_OUTPUTS];
        fit_slopes(sh, &moments[l], &of_light, of_output);
        for (int i = 0; i < FIT_OUTPUTS; ++i) {
            fitted->slope[FIT_LAYERS][i].x[l] = of_output[i] * (rule->closing ? sh->cone_cos : 1.0f);
        }
    }
    network_backward(rule->closing ? rule->closing : rule->opened, fitted, sum);
    return error;
}

float fit_error(const fit_rule *rule, const fit_example *example)
{
    const fit_example *same[LANES];
    for (int l = 0; l < LANES; ++l) {
        same[l] = example;
    }
    return rule_pass(rule, same, NULL).x[0];
}

static float network_weight_start(uint64_t *random, int layer, int from, int i)
{
    const float reach = (layer == FIT_LAYERS - 1 ? 0.1f : 1.0f) * sqrtf(6.0f / (float)from);
    const float variate = (float)(2.0 * fit_variate(random) - 1.0);
    return layer == FIT_LAYERS - 1 && i == from ? 0.0f : reach * variate;
}

/* Uniform, so wide that sums keep their size from layer to layer (He et al. 2015), but the last, which starts as next
 * to nothing: Gram's answer. */
static void network_start(uint64_t *random, fit_network *network)
{
    memset(network, 0, sizeof *network);
    for (int layer = 0; layer < FIT_LAYERS; ++layer) {
        const int from = fit_layer_from(layer);
        for (int to = 0; to < fit_layer_to(layer); ++to) {
            for (int i = 0; i <= from; ++i) {
                network->weight[layer][to][i] = network_weight_start(random, layer, from, i);
            }
        }
    }
}

/* Mean and inverse spread of each input: what is fitted are weights of inputs without mean and with a spread of 1,
 * whose slopes are alike. */
typedef struct input_scales {
    float mean[FIT_INPUTS], scale[FIT_INPUTS];
} input_scales;

static input_scales input_scales_of(const fit_example *examples, size_t count)
{
    double sum[FIT_INPUTS] = {0.0}, squares[FIT_INPUTS] = {0.0};
    for (size_t k = 0; k < count; ++k) {
        float x[FIT_INPUTS];
        inputs_of(&examples[k].sh, x);
        for (int i = 0; i < FIT_INPUTS; ++i) {
            sum[i] += (double)x[i];
            squares[i] += (double)x[i] * (double)x[i];
        }
    }
    input_scales scales;
    for (int i = 0; i < FIT_INPUTS; ++i) {
        const double mean = sum[i] / (double)count, variance = squares[i] / (double)count - mean * mean;
        scales.mean[i] = (float)mean;
        scales.scale[i] = variance > 1e-9 ? (float)(1.0 / sqrt(variance)) : 0.0f; /* 0: the cone of a hemisphere */
    }
    return scales;
}

/* The network of plain inputs that does the same. */
static fit_network network_scaled(const fit_network *fitted, const input_scales *scales)
{
    fit_network network = *fitted;
    for (int to = 0; to < FIT_FIRST; ++to) {
        float *weight = network.weight[0][to];
        for (int i = 0; i < FIT_INPUTS; ++i) {
            weight[i] *= scales->scale[i];
            weight[FIT_INPUTS] -= weight[i] * scales->mean[i];
        }
    }
    return network;
}

/* The slopes of a fitted network's weights, by those of the plain one's. */
static void slopes_scale(const input_scales *scales, fit_network *slope)
{
    for (int to = 0; to < FIT_FIRST; ++to) {
        float *weight = slope->weight[0][to];
        for (int i = 0; i < FIT_INPUTS; ++i) {
            weight[i] = scales->scale[i] * (weight[i] - scales->mean[i] * weight[FIT_INPUTS]);
        }
    }
}

/* The mean error of a batch of random examples, and the mean slopes of the plain network's weights. */
static double batch_slopes(const fit_settings *settings, const fit_rule *rule, const fit_example *examples,
                           size_t count, uint64_t *random, fit_network *slope)
{
    static gradient sum;
    memset(&sum, 0, sizeof sum);
    double error = 0.0;
    for (int i = 0; i < settings->batch; i += LANES) {
        const fit_example *chosen[LANES];
        for (int l = 0; l < LANES; ++l) {
            chosen[l] = &examples[(size_t)(fit_variate(random) * (double)count)];
        }
        const lanes off = rule_pass(rule, chosen, &sum);
        for (int l = 0; l < LANES; ++l) {
            error += (double)off.x[l];
        }
    }
    const lanes *from = &sum.weight[0][0][0];
    float *to = &slope->weight[0][0][0];
    for (size_t i = 0; i < sizeof *slope / sizeof *to; ++i) {
        float total = 0.0f;
        for (int l = 0; l < LANES; ++l) {
            total += from[i].x[l];
        }
        to[i] = total / (float)settings->batch;
    }
    return error / settings->batch;
}

typedef struct adam {
    fit_network first, second; /* moments of the slopes */
    double first_power, second_power;
} adam;

/* Rises over 50 steps, so that the moments are known before it counts, and falls by half a cosine to nothing. */
static double learning_rate(int step, int steps)
{
    const double rise = step < 50 ? step / 50.0 : 1.0;
    return 0.005 * rise * (1.0 + cos(LMB_PI * step / steps));
}

static void adam_step(adam *a, double rate, const fit_network *slope, fit_network *network)
{
    const float *g = &slope->weight[0][0][0];
    float *first = &a->first.weight[0][0][0], *second = &a->second.weight[0][0][0], *w = &network->weight[0][0][0];
    a->first_power *= 0.9;
    a->second_power *= 0.999;
    const float first_known = (float)(1.0 - a->first_power), second_known = (float)(1.0 - a->second_power);
    for (size_t i = 0; i < sizeof *slope / sizeof *g; ++i) {
        first[i] = 0.9f * first[i] + 0.1f * g[i];
        second[i] = 0.999f * second[i] + 0.001f * g[i] * g[i];
        w[i] -= (float)rate * (first[i] / first_known) / (sqrtf(second[i] / second_known) + 1e-8f);
    }
}

void fit_network_fit(const fit_settings *settings, const fit_example *examples, size_t count, const fit_network *opened,
                     fit_network *network)
{
    const input_scales scales = input_scales_of(examples, count);
    const fit_rule rule = {opened ? opened : network, opened ? network : NULL};
    uint64_t random = settings->seed;
    fit_network fitted, slope;
    network_start(&random, &fitted);
    adam a = {.first_power = 1.0, .second_power = 1.0};
    double error = 0.0;
    for (int step = 1; step <= settings->steps; ++step) {
        *network = network_scaled(&fitted, &scales);
        error += batch_slopes(settings, &rule, examples, count, &random, &slope);
        slopes_scale(&scales, &slope);
        adam_step(&a, learning_rate(step, settings->steps), &slope, &fitted);
        if (step % 1000 == 0) {
            printf("step %d: weighted root mean square error %.4f\n", step, sqrt(error / 1000.0));
            fflush(stdout);
            error = 0.0;
        }
    }
    *network = network_scaled(&fitted, &scales);
}
