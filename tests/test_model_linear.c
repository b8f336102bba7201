/* Rows of the table of models that are linear in the light: each against quadrature, or least squares, of its own
 * definition, about random normals and behind cones. */
#include "model_oracle.h"

#include <lambent/rnm.h>

/* Random light that is mostly positive, about a random normal. */
typedef struct some_light {
    double c[9];
    lmb_sh3_rgb radiance;
    lmb_vec3 n_v;
    ovec axis;
} some_light;

static some_light light_random(uint64_t *random)
{
    some_light made;
    made.radiance = oracle_grey(oracle_random_sh3(random, 8.0, made.c));
    made.axis = oracle_random_normal(random, &made.n_v);
    return made;
}

enum { LIGHTS = 40, NORMALS = 5 };

/* SH of what a cone lets through, or of everything. */
static void truncated_irradiance(void)
{
    static const struct {
        const char *name;
        int bands_in, bands_out;
        bool clips;
    } table[] = {
        {"sh3.gram", 3, 3, true},        {"sh2", 3, 2, true},
        {"sh2.linear", 2, 2, true},      {"sh3.unoccluded", 3, 3, false},
        {"sh2.unoccluded", 2, 2, false}, {"sh3.halo3", 3, 3, false},
    };
    uint64_t random = 3;
    for (int k = 0; k < LIGHTS; ++k) {
        const some_light from = light_random(&random);
        const float cone_cos = k % 2 ? 0.0f : (float)oracle_random(&random);
        for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
            double clipped[9];
            oracle_clip(from.c, table[i].bands_in, from.axis, (double)cone_cos, clipped);
            for (int j = 0; j < NORMALS; ++j) {
                lmb_vec3 normal;
                const ovec n = oracle_random_normal(&random, &normal);
                const double expected =
                    fmax(oracle_irradiance(table[i].clips ? clipped : from.c, table[i].bands_out, n), 0.0);
                CHECK_NEAR(oracle_answer(oracle_row(table[i].name), &from.radiance, from.n_v, cone_cos, normal),
                           expected, 4e-6, "%s, light %d, c = %g", table[i].name, k, (double)cone_cos);
            }
        }
    }
}

/* I_z, and SH3 times what a white sky's share is. */
static void occlusion_by_numbers(void)
{
    uint64_t random = 4;
    for (int k = 0; k < LIGHTS; ++k) {
        const some_light from = light_random(&random);
        const double cone_cos = k % 2 ? 0.0 : oracle_random(&random);
        double clipped[9];
        oracle_clip(from.c, 3, from.axis, cone_cos, clipped);
        lmb_vec3 normal;
        ovec n = oracle_random_normal(&random, &normal);
        CHECK_NEAR(oracle_answer(oracle_row("scalar"), &from.radiance, from.n_v, (float)cone_cos, normal),
                   fmax(oracle_irradiance_z(clipped, from.axis), 0.0), 4e-6, "scalar, light %d", k);
        const double share = (1.0 - cone_cos * cone_cos) * 0.5 * (1.0 + ovec_dot(n, from.axis));
        CHECK_NEAR(oracle_answer(oracle_row("sh3.ao"), &from.radiance, from.n_v, (float)cone_cos, normal),
                   share * oracle_irradiance(from.c, 3, n), 1e-5, "sh3.ao, light %d", k);
        n = ovec_unit(ovec_mix(n, 1.0, from.axis, 1.0));
        CHECK_NEAR(oracle_answer(oracle_row("sh3.bent"), &from.radiance, from.n_v, (float)cone_cos, normal),
                   share * oracle_irradiance(from.c, 3, n), 1e-5, "sh3.bent, light %d", k);
    }
}

/* Six sides of the irradiance, and on a normal between them their mean by squares. */
static void ambient_cube(void)
{
    uint64_t random = 5;
    for (int k = 0; k < LIGHTS; ++k) {
        const some_light from = light_random(&random);
        double clipped[9];
        oracle_clip(from.c, 3, from.axis, 0.0, clipped);
        lmb_vec3 normal;
        const ovec n = oracle_random_normal(&random, &normal);
        for (int clips = 0; clips < 2; ++clips) {
            double expected = 0.0;
            for (int axis = 0; axis < 3; ++axis) {
                const double along = axis == 0 ? n.x : axis == 1 ? n.y : n.z, sign = along < 0.0 ? -1.0 : 1.0;
                const ovec side = {axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0};
                expected += along * along * fmax(oracle_irradiance(clips ? clipped : from.c, 3, side), 0.0);
            }
            const lmb_model *model = oracle_row(clips ? "cube.gram" : "cube.unoccluded");
            CHECK_NEAR(oracle_answer(model, &from.radiance, from.n_v, 0.0f, normal), expected, 4e-6, "%s, light %d",
                       model->name, k);
        }
    }
}

/* Functions about +z that models are sums of. */
static double one(ovec n, const void *context)
{
    (void)n;
    (void)context;
    return 1.0;
}

static double along_x(ovec n, const void *context)
{
    (void)context;
    return n.x;
}

static double along_y(ovec n, const void *context)
{
    (void)context;
    return n.y;
}

static double along_z(ovec n, const void *context)
{
    (void)context;
    return n.z;
}

static double product_xy(ovec n, const void *context)
{
    (void)context;
    return n.x * n.y;
}

static double squares_xy(ovec n, const void *context)
{
    (void)context;
    return n.x * n.x - n.y * n.y;
}

static double lobe(ovec n, double turn, double tilt)
{
    const ovec m = {sin(tilt) * cos(turn), sin(tilt) * sin(turn), cos(tilt)};
    return exp(2.0 * (ovec_dot(m, n) - 1.0));
}

static double lobe_up(ovec n, const void *context)
{
    (void)context;
    return lobe(n, 0.0, 0.0);
}

static double lobe_at(ovec n, int quarter)
{
    return lobe(n, 0.5 * ORACLE_PI * quarter, ORACLE_PI / 3.0);
}

static double lobe_0(ovec n, const void *context)
{
    (void)context;
    return lobe_at(n, 0);
}

static double lobe_1(ovec n, const void *context)
{
    (void)context;
    return lobe_at(n, 1);
}

static double lobe_2(ovec n, const void *context)
{
    (void)context;
    return lobe_at(n, 2);
}

static double lobe_3(ovec n, const void *context)
{
    (void)context;
    return lobe_at(n, 3);
}

static double clipped_irradiance(ovec n, const void *clipped)
{
    return oracle_irradiance(clipped, 3, n);
}

/* What is fitted over the hemisphere is the least squares fit there. */
static void hemispherical_fits(void)
{
    static const struct {
        const char *name;
        int count;
        oracle_function function[6];
        double tolerance;
    } table[] = {
        {"h4.gram", 4, {one, along_x, along_y, along_z}, 5e-6},
        {"h6.gram", 6, {one, along_x, along_y, along_z, product_xy, squares_xy}, 5e-6},
        {"sg5.gram", 5, {lobe_up, lobe_0, lobe_1, lobe_2, lobe_3}, 2e-5},
    };
    const ovec z = {0.0, 0.0, 1.0};
    uint64_t random = 6;
    for (int k = 0; k < LIGHTS; ++k) {
        const some_light from = light_random(&random);
        const float cone_cos = k % 2 ? 0.0f : (float)oracle_random(&random);
        double clipped[9], coefficient[6];
        oracle_clip(from.c, 3, z, (double)cone_cos, clipped);
        for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
            oracle_least_squares(z, table[i].count, table[i].function, NULL, clipped_irradiance, clipped, coefficient);
            for (int j = 0; j < NORMALS; ++j) {
                lmb_vec3 normal;
                const ovec n = oracle_random_normal(&random, &normal);
                double expected = 0.0;
                for (int f = 0; f < table[i].count; ++f) {
                    expected += coefficient[f] * table[i].function[f](n, NULL);
                }
                CHECK_NEAR(oracle_answer(oracle_row(table[i].name), &from.radiance, (lmb_vec3){0.0f, 0.0f, 1.0f},
                                         cone_cos, normal),
                           fmax(expected, 0.0), table[i].tolerance, "%s, light %d, c = %g", table[i].name, k,
                           (double)cone_cos);
            }
        }
    }
}

/* Light above the horizon of +z as nodes, and what it gives a normal, without truncation. */
typedef struct node_light {
    orule rule;
    double *weight;
} node_light;

static double node_irradiance(ovec n, const void *context)
{
    const node_light *light = context;
    double sum = 0.0;
    for (size_t i = 0; i < light->rule.count; ++i) {
        sum += light->weight[i] * fmax(ovec_dot(n, light->rule.nodes[i].direction), 0.0);
    }
    return sum / ORACLE_PI;
}

/* SH of n whose bands are scaled as irradiance's, so that least squares finds what is stored. */
static double convolved(ovec n, int i)
{
    double basis[9];
    oracle_basis(n, basis);
    return basis[i] * (i == 0 ? 1.0 : i < 4 ? 2.0 / 3.0 : 0.25);
}

/* What sh2.fit and sh3.fit give is nearer to the exact irradiance over the hemisphere than any other SH: what is left
 * is orthogonal there to every function of the basis. */
static void sh_fits_the_irradiance(void)
{
    static const struct {
        const char *name;
        int count;
    } table[] = {{"sh2.fit", 4}, {"sh3.fit", 9}};
    const ovec z = {0.0, 0.0, 1.0};
    uint64_t random = 31;
    for (int k = 0; k < 4; ++k) {
        double c[9], kept[2][9] = {{0.0}};
        const lmb_sh3_rgb radiance = oracle_grey(oracle_random_sh3(&random, 12.0, c));
        node_light light = {oracle_zone(z, 0.0, 1.0, 100, 200), NULL};
        light.weight = malloc(light.rule.count * sizeof *light.weight);
        for (size_t i = 0; light.weight && i < light.rule.count; ++i) {
            light.weight[i] = light.rule.nodes[i].weight * oracle_evaluate(c, light.rule.nodes[i].direction);
        }
        const orule normals = oracle_zone(z, 0.0, 1.0, 16, 32);
        for (size_t j = 0; light.weight && j < normals.count; ++j) {
            const ovec n = normals.nodes[j].direction;
            const double exact = node_irradiance(n, &light);
            for (int m = 0; m < 2; ++m) {
                const double found =
                    oracle_answer(oracle_row(table[m].name), &radiance, ovec_float(z), 0.0f, ovec_float(n));
                CHECK(found > 0.0, "%s, light %d: bright enough not to be clamped", table[m].name, k);
                for (int i = 0; i < table[m].count; ++i) {
                    kept[m][i] += normals.nodes[j].weight * (exact - found) * convolved(n, i);
                }
            }
        }
        for (int m = 0; m < 2; ++m) {
            for (int i = 0; i < table[m].count; ++i) {
                CHECK_NEAR(kept[m][i], 0.0, 2e-4, "%s, light %d, function %d", table[m].name, k, i);
            }
        }
        free(light.weight);
        oracle_rule_free(normals);
        oracle_rule_free(light.rule);
    }
}

/* HLSH of the clipped polynomial, projected direction by direction: what a light of each direction adds to I_z, C_a and
 * c (docs/maths.md). */
static void hlsh_without_truncation(void)
{
    uint64_t random = 7;
    for (int k = 0; k < LIGHTS; ++k) {
        const some_light from = light_random(&random);
        const double cone_cos = k % 2 ? 0.0 : 0.95 * oracle_random(&random);
        double i_z = 0.0, ambient = 0.0;
        ovec tangential = {0, 0, 0};
        const orule cone = oracle_zone(from.axis, cone_cos, 1.0, 40, 16);
        for (size_t i = 0; i < cone.count; ++i) {
            const ovec w = cone.nodes[i].direction;
            const double l = cone.nodes[i].weight * oracle_evaluate(from.c, w), cosine = ovec_dot(w, from.axis);
            const double gamma = acos(fmin(cosine, 1.0)), rest = ORACLE_PI - gamma, pi = ORACLE_PI;
            i_z += l * cosine / pi;
            ambient += l * (0.75 / pi + 0.25 * cosine / pi - (sin(gamma) + rest * cosine) / (pi * pi));
            tangential = ovec_mix(tangential, 1.0, ovec_mix(w, 1.0, from.axis, -cosine), l * rest / (pi * pi));
        }
        oracle_rule_free(cone);
        for (int j = 0; j < NORMALS; ++j) {
            lmb_vec3 normal;
            const ovec n = oracle_random_normal(&random, &normal);
            const double t = ovec_dot(n, from.axis);
            CHECK_NEAR(oracle_answer(oracle_row("hlsh.t2"), &from.radiance, from.n_v, (float)cone_cos, normal),
                       fmax(i_z * t + ambient * (1.0 - t) + ovec_dot(tangential, n), 0.0), 2e-5, "light %d, c = %g", k,
                       cone_cos);
        }
    }
}

typedef struct two_lights {
    ovec direction[2];
    double weight[2];
} two_lights;

static double lights_irradiance(ovec n, const void *context)
{
    const two_lights *lights = context;
    double sum = 0.0;
    for (int i = 0; i < 2; ++i) {
        sum += lights->weight[i] * fmax(ovec_dot(n, lights->direction[i]), 0.0) / ORACLE_PI;
    }
    return sum;
}

/* HLSH of the light itself is the best that holds I_z, by quadrature over normals; light below the horizon is nothing.
 */
static void hlsh_of_lights(void)
{
    const lmb_vec3 up = {0.0f, 0.0f, 1.0f};
    const two_lights lights = {{ovec_unit((ovec){0.6, 0.3, 0.5}), ovec_unit((ovec){-0.8, 0.1, 0.2})}, {3.0, 2.0}};
    const lmb_directed_light samples[3] = {{ovec_float(lights.direction[0]), {{0.0f, 3.0f, 0.0f}}},
                                           {ovec_float(lights.direction[1]), {{0.0f, 2.0f, 0.0f}}},
                                           {{0.6f, 0.0f, -0.8f}, {{9.0f, 9.0f, 9.0f}}}};
    double i_z = lights_irradiance((ovec){0, 0, 1}, &lights), ambient = -0.5 * i_z;
    ovec tangential = {0, 0, 0};
    const orule rule = oracle_zone((ovec){0, 0, 1}, 0.0, 1.0, 200, 400);
    for (size_t i = 0; i < rule.count; ++i) {
        const ovec n = rule.nodes[i].direction;
        const double e = rule.nodes[i].weight * lights_irradiance(n, &lights) * 1.5 / ORACLE_PI;
        ambient += e * (1.0 - n.z);
        tangential = ovec_mix(tangential, 1.0, (ovec){n.x, n.y, 0.0}, e);
    }
    oracle_rule_free(rule);
    const lmb_model *model = oracle_row("hlsh.light");
    float channel[LMB_MODEL_MOST_CHANNELS];
    model->encode_light(samples, 3, up, channel);
    uint64_t random = 8;
    for (int j = 0; j < LIGHTS; ++j) {
        lmb_vec3 normal;
        const ovec n = oracle_random_normal(&random, &normal);
        lmb_rgb found;
        model->evaluate(channel, up, &normal, 1, &found);
        CHECK_NEAR(found.c[1], fmax(i_z * n.z + ambient * (1.0 - n.z) + ovec_dot(tangential, n), 0.0), 2e-4,
                   "normal %d", j);
    }
}

/* RNM on its own slopes is their light; between them the mean by squares. Its slopes are orthogonal. */
static void radiosity_normal_mapping(void)
{
    const lmb_vec3 up = {0.0f, 0.0f, 1.0f};
    const lmb_model *model = oracle_row("rnm.light");
    const lmb_directed_light samples[3] = {{{0.6f, 0.0f, 0.8f}, {{3.0f, 1.0f, 2.0f}}},
                                           {{-0.36f, 0.48f, 0.8f}, {{0.5f, 2.0f, 1.0f}}},
                                           {{0.0f, 0.6f, -0.8f}, {{7.0f, 7.0f, 7.0f}}}};
    float channel[LMB_MODEL_MOST_CHANNELS];
    model->encode_light(samples, 3, up, channel);
    ovec slope[3];
    lmb_vec3 given[3]; /* test_rnm has their oracle */
    lmb_rnm_slopes(up, given);
    double light[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; ++k) {
        slope[k] = ovec_of(given[k]);
        for (int i = 0; i < 2; ++i) {
            const double cosine = fmax(ovec_dot(slope[k], ovec_of(samples[i].direction)), 0.0);
            light[k] += cosine * (double)samples[i].weight.c[1] / ORACLE_PI;
        }
    }
    uint64_t random = 9;
    for (int j = 0; j < LIGHTS; ++j) {
        lmb_vec3 normal = j < 3 ? ovec_float(slope[j]) : (lmb_vec3){0.0f, 0.0f, 1.0f};
        const ovec n = j < 4 ? ovec_of(normal) : oracle_random_normal(&random, &normal);
        double sum = 0.0, total = 0.0;
        for (int k = 0; k < 3; ++k) {
            const double weight = pow(fmax(ovec_dot(n, slope[k]), 0.0), 2.0);
            sum += weight * light[k];
            total += weight;
        }
        lmb_rgb found;
        model->evaluate(channel, up, &normal, 1, &found);
        CHECK_NEAR(found.c[1], total > 1e-12 ? sum / total : 0.0, 2e-5, "normal %d", j);
        if (j < 3) {
            CHECK_NEAR(found.c[1], light[j], 2e-6, "slope %d", j);
        }
    }
    const lmb_vec3 down = {0.0f, 0.0f, -1.0f};
    lmb_rgb none;
    model->evaluate(channel, up, &down, 1, &none);
    CHECK(none.c[1] == 0.0f, "%g on a normal that no slope faces", (double)none.c[1]);
}

/* A window lowers what it says of all light alike; bands are kept of light that does not ring, and of one that does
 * until no normal of the hemisphere has negative irradiance. */
static void ringing_is_taken_off(void)
{
    const lmb_model *gram = lmb_model_find("sh3.gram", 0), *window = lmb_model_find("sh3.gram.window", 0);
    const lmb_model *kept = lmb_model_find("sh3.gram.kept", 0);
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    uint64_t random = 21;
    int rang = 0;
    for (int k = 0; k < 200; ++k) {
        lmb_vec3 towards;
        oracle_random_normal(&random, &towards);
        lmb_sh3_rgb light = {{{{0.0f}}}};
        lmb_sh3_rgb_add_light(&light, towards, (lmb_rgb){{1.0f, 1.0f, 1.0f}});
        light.channel[1].c[0] += 20.0f; /* green: mostly from everywhere */
        float plain[LMB_MODEL_MOST_CHANNELS], low[LMB_MODEL_MOST_CHANNELS], held[LMB_MODEL_MOST_CHANNELS];
        gram->encode(&light, up, 0.0f, plain);
        window->encode(&light, up, 0.0f, low);
        kept->encode(&light, up, 0.0f, held);
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            const float share = i == 0 ? 1.0f : i < 4 ? 0.75f : 0.25f;
            CHECK_NEAR(low[i], share * plain[i], 1e-6, "light %d, coefficient %d", k, i);
            CHECK(held[LMB_SH3_COUNT + i] == plain[LMB_SH3_COUNT + i], "light %d: green does not ring", k);
        }
        double lowest[2] = {0.0, 0.0};
        for (int j = 0; j < 400; ++j) {
            lmb_vec3 normal;
            oracle_random_normal(&random, &normal);
            normal.y = fabsf(normal.y);
            const lmb_sh3 basis = lmb_sh3_basis(normal);
            double sum[2] = {0.0, 0.0};
            for (int i = 0; i < LMB_SH3_COUNT; ++i) {
                const double share = i == 0 ? 1.0 : i < 4 ? 2.0 / 3.0 : 0.25;
                sum[0] += share * (double)plain[i] * (double)basis.c[i];
                sum[1] += share * (double)held[i] * (double)basis.c[i];
            }
            for (int m = 0; m < 2; ++m) {
                lowest[m] = fmin(lowest[m], sum[m]);
            }
        }
        rang += lowest[0] < -1e-3;
        /* Of a light below the horizon the constant may be negative, of which nothing is left. */
        CHECK(lowest[1] > -1.5e-3 + fmin(0.2820947918 * (double)plain[0], 0.0), "light %d: %g, %g before", k, lowest[1],
              lowest[0]);
    }
    CHECK(rang > 20, "%d of 200 lights ring", rang);
}

static const test_case cases[] = {
    {"truncated_irradiance", truncated_irradiance},
    {"ringing_is_taken_off", ringing_is_taken_off},
    {"occlusion_by_numbers", occlusion_by_numbers},
    {"ambient_cube", ambient_cube},
    {"hemispherical_fits", hemispherical_fits},
    {"sh_fits_the_irradiance", sh_fits_the_irradiance},
    {"hlsh_without_truncation", hlsh_without_truncation},
    {"hlsh_of_lights", hlsh_of_lights},
    {"radiosity_normal_mapping", radiosity_normal_mapping},
};

TEST_MAIN(cases)
