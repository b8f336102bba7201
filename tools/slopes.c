/* Radiosity normal mapping as it was printed and as it is right, and light for self-shadowed bump maps:
 *
 *     lambent_slopes ENV... [--turns N]
 *
 * First, of the light itself, for each variant: relative root mean square error of irradiance over the hemisphere as
 * `lambent models` has it, mean and maximum over environments, and the median.
 *
 *     right               clamped cosines; squares over their sum
 *     printed basis       the same with B1 as the note prints it
 *     unclamped           light from behind a slope is taken off it, as the note's encode line has it
 *     cosines             weights max(0, n.B) as the talk of 2004 has them, not over their sum
 *     cosines over sum    the same over their sum
 *     squares, unclamped  squares of cosines of either sign, not over their sum
 *     one light x cosine  one lightmap, darkened by n.n_v: without directions
 *
 * Then, for each model of lightmaps: the same error on the three slopes alone, about a tangent that is turned against
 * the lightmap's own frame by any angle: what a self-shadowed bump map in a mesh's tangent space is lit by. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

#include "command.h"
#include "models.h"

static const char usage[] = "usage: lambent_slopes ENV... [--turns N]\n";

enum { SLOPES = 3, COLOURS = 3, ANGLES = 12, MOST_TURNS = 4096 };
static const lmb_vec3 up = {0.0f, 0.0f, 1.0f};

static const lmb_vec3 right_basis[SLOPES] = {{0.81649658f, 0.0f, 0.57735027f},
                                             {-0.40824829f, 0.70710678f, 0.57735027f},
                                             {-0.40824829f, -0.70710678f, 0.57735027f}};
static const lmb_vec3 printed_basis[SLOPES] = {
    {0.904534f, 0.0f, 0.426401f}, {-0.408248f, 0.707107f, 0.57735f}, {-0.408248f, -0.707107f, 0.57735f}};

static void light_encode(const lmb_directed_light *light, size_t count, const lmb_vec3 *basis, float least,
                         float *channel)
{
    memset(channel, 0, SLOPES * COLOURS * sizeof *channel);
    for (size_t i = 0; i < count; ++i) {
        for (int k = 0; k < SLOPES && light[i].direction.z > 0.0f; ++k) {
            const float cosine = lmb_larger(lmb_vec3_dot(light[i].direction, basis[k]), least) * (1.0f / LMB_PI_F);
            for (int c = 0; c < COLOURS; ++c) {
                channel[COLOURS * k + c] += cosine * light[i].weight.c[c];
            }
        }
    }
}

static void right_encode(const lmb_directed_light *light, size_t count, lmb_vec3 n_v, float *channel)
{
    (void)n_v;
    light_encode(light, count, right_basis, 0.0f, channel);
}

static void printed_encode(const lmb_directed_light *light, size_t count, lmb_vec3 n_v, float *channel)
{
    (void)n_v;
    light_encode(light, count, printed_basis, 0.0f, channel);
}

static void unclamped_encode(const lmb_directed_light *light, size_t count, lmb_vec3 n_v, float *channel)
{
    (void)n_v;
    light_encode(light, count, right_basis, -1.0f, channel);
}

/* How weights are made of cosines. */
typedef struct blend {
    const lmb_vec3 *basis;
    float least; /* of a cosine */
    bool squares, over_sum;
} blend;

static void blend_evaluate(const blend *how, const float *channel, const lmb_vec3 *normal, int count, lmb_rgb *found)
{
    for (int i = 0; i < count; ++i) {
        float sum[COLOURS] = {0.0f}, total = 0.0f;
        for (int k = 0; k < SLOPES; ++k) {
            const float cosine = lmb_larger(lmb_vec3_dot(normal[i], how->basis[k]), how->least);
            const float weight = how->squares ? cosine * cosine : cosine;
            total += weight;
            for (int c = 0; c < COLOURS; ++c) {
                sum[c] += weight * channel[COLOURS * k + c];
            }
        }
        for (int c = 0; c < COLOURS; ++c) {
            found[i].c[c] = lmb_light_clamped(how->over_sum && total > 0.0f ? sum[c] / total : sum[c]);
        }
    }
}

#define BLEND(name, ...)                                                                                               \
    static void name(const float *channel, lmb_vec3 n_v, const lmb_vec3 *normal, int count, lmb_rgb *found)            \
    {                                                                                                                  \
        (void)n_v;                                                                                                     \
        blend_evaluate(&(blend){__VA_ARGS__}, channel, normal, count, found);                                          \
    }
BLEND(right_evaluate, right_basis, 0.0f, true, true)
BLEND(printed_evaluate, printed_basis, 0.0f, true, true)
BLEND(cosines_evaluate, right_basis, 0.0f, false, false)
BLEND(cosines_over_sum_evaluate, right_basis, 0.0f, false, true)
BLEND(squares_unclamped_evaluate, right_basis, -1.0f, true, false)

static void one_encode(const lmb_directed_light *light, size_t count, lmb_vec3 n_v, float *channel)
{
    memset(channel, 0, COLOURS * sizeof *channel);
    for (size_t i = 0; i < count; ++i) {
        const float cosine = lmb_larger(lmb_vec3_dot(light[i].direction, n_v), 0.0f) * (1.0f / LMB_PI_F);
        for (int c = 0; c < COLOURS; ++c) {
            channel[c] += cosine * light[i].weight.c[c];
        }
    }
}

static void one_evaluate(const float *channel, lmb_vec3 n_v, const lmb_vec3 *normal, int count, lmb_rgb *found)
{
    for (int i = 0; i < count; ++i) {
        const float cosine = lmb_larger(lmb_vec3_dot(normal[i], n_v), 0.0f);
        found[i] = lmb_rgb_scale(lmb_rgb_of(channel[0], channel[1], channel[2]), cosine);
    }
}

#define VARIANT(text, encoder, evaluator)                                                                              \
    {                                                                                                                  \
        .name = text, .title = text, .channel_count = SLOPES * COLOURS, .bytes = 2 * SLOPES * COLOURS,                 \
        .encode_light = encoder, .evaluate = evaluator                                                                 \
    }
static const lmb_model variants[] = {
    VARIANT("right", right_encode, right_evaluate),
    VARIANT("printed basis", printed_encode, printed_evaluate),
    VARIANT("unclamped", unclamped_encode, right_evaluate),
    VARIANT("cosines", right_encode, cosines_evaluate),
    VARIANT("cosines over sum", right_encode, cosines_over_sum_evaluate),
    VARIANT("squares, unclamped", right_encode, squares_unclamped_evaluate),
    VARIANT("one light x cosine", one_encode, one_evaluate),
};
enum { VARIANTS = sizeof variants / sizeof variants[0] };

static lmb_result variants_measure(const models_map *map, size_t count, uint32_t turns)
{
    const lmb_model *row[VARIANTS];
    for (int i = 0; i < VARIANTS; ++i) {
        row[i] = &variants[i];
    }
    models_settings settings = models_settings_default();
    settings.turns = turns;
    settings.model = row;
    settings.model_count = VARIANTS;
    models_report report = {NULL, 0};
    lmb_pool *pool = NULL;
    lmb_result result = lmb_pool_create(0, &pool);
    if (result == LMB_OK) {
        result = models_measure(&settings, map, count, pool, NULL, &report);
    }
    printf("# variant\trmse\tmax\tmedian\n");
    for (size_t i = 0; result == LMB_OK && i < report.row_count; ++i) {
        const models_row *measured = &report.row[i];
        printf("%s\t%.4f\t%.4f\t%.4f\n", measured->model->name, measured->luminance.mean, measured->luminance.max,
               measured->median);
    }
    models_report_free(&report);
    lmb_pool_destroy(pool);
    return result;
}

/* The slopes about tangents that are turned by a twelfth of what brings them back. */
static void turned_slopes(lmb_vec3 slope[ANGLES * SLOPES])
{
    for (int i = 0; i < ANGLES * SLOPES; ++i) {
        const double turn = 2.0 * LMB_PI / SLOPES * (i % SLOPES + (double)(i / SLOPES) / ANGLES);
        slope[i] = lmb_vec3_of((float)(sqrt(2.0 / 3.0) * cos(turn)), (float)(sqrt(2.0 / 3.0) * sin(turn)),
                               (float)sqrt(1.0 / 3.0));
    }
}

/* Squared error and squared light on them, of a model in luminance. */
static void slopes_add(const lmb_model *model, const models_turn *turn, const lmb_vec3 slope[ANGLES * SLOPES],
                       double sum[2])
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    lmb_rgb found[ANGLES * SLOPES];
    model->encode(&turn->sh3[MODELS_LIGHTMAP], up, 0.0f, channel);
    model->evaluate(channel, up, slope, ANGLES * SLOPES, found);
    for (int i = 0; i < ANGLES * SLOPES; ++i) {
        double truth = 0.0;
        for (size_t k = 0; k < turn->light_count; ++k) {
            const float cosine = lmb_larger(lmb_vec3_dot(turn->light[k].direction, slope[i]), 0.0f);
            truth += (double)(cosine * lmb_luminance(turn->light[k].weight)) / LMB_PI;
        }
        const double off = (double)lmb_luminance(found[i]) - truth;
        sum[0] += off * off;
        sum[1] += truth * truth;
    }
}

/* Each environment's own error, and of those the mean. */
static lmb_result slopes_measure(const models_map *map, size_t count, uint32_t turns)
{
    lmb_vec3 slope[ANGLES * SLOPES];
    turned_slopes(slope);
    models_turn *turn = malloc(sizeof *turn);
    double(*sum)[2] = calloc(count * lmb_model_count(), sizeof *sum);
    for (size_t m = 0; turn && sum && m < count; ++m) {
        for (uint32_t k = 0; k < turns; ++k) {
            models_turn_fill(turn, &map[m], NULL, k, 0);
            for (size_t i = 0; i < lmb_model_count(); ++i) {
                if (lmb_model_at(i)->uses & LMB_MODEL_FOR_LIGHTMAP) {
                    slopes_add(lmb_model_at(i), turn, slope, sum[m * lmb_model_count() + i]);
                }
            }
        }
    }
    printf("# model\tbytes\trmse_on_slopes\n");
    for (size_t i = 0; turn && sum && i < lmb_model_count(); ++i) {
        double mean = 0.0;
        for (size_t m = 0; m < count; ++m) {
            const double *one = sum[m * lmb_model_count() + i];
            mean += sqrt(one[0] / one[1]) / (double)count;
        }
        if (lmb_model_at(i)->uses & LMB_MODEL_FOR_LIGHTMAP) {
            printf("%s\t%d\t%.4f\n", lmb_model_full_name(lmb_model_at(i)), lmb_model_at(i)->bytes, mean);
        }
    }
    const lmb_result result = turn && sum ? LMB_OK : LMB_ERROR_MEMORY;
    free(turn);
    free(sum);
    return result;
}

int main(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "slopes", usage);
    models_map *map = malloc((size_t)count * sizeof *map);
    lmb_error error = {""};
    lmb_result result = map ? LMB_OK : LMB_ERROR_MEMORY;
    uint32_t turns = 64;
    size_t maps = 0;
    for (const char *next; result == LMB_OK && (next = arguments_next(&arguments));) {
        if (strcmp(next, "--turns") == 0) {
            turns = (uint32_t)arguments_integer(&arguments, next, 1, MOST_TURNS);
        } else {
            result = models_map_read(next, &map[maps++], &error);
        }
    }
    if (result == LMB_OK && !arguments.failed && !arguments.help && maps == 0) {
        arguments_error(&arguments, "missing argument", "ENV");
    }
    if (result == LMB_OK && (arguments.failed || arguments.help)) {
        free(map);
        return arguments_status(&arguments);
    }
    if (result == LMB_OK) {
        result = variants_measure(map, maps, turns);
    }
    if (result == LMB_OK) {
        result = slopes_measure(map, maps, turns);
    }
    free(map);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
