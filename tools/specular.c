/* What specular layers get right of the light around a point:
 *
 *     lambent_specular ENV... [--f0 X] [--samples N] [--picture FILE.png]
 *
 * ENV as --env takes it, a picture or daylight. Its sun, if it has one, is kept apart first: that is a key light, whose
 * highlight is exact. Of what remains each layer is compared with Monte Carlo over half vectors, for normals all over
 * the sphere and views at several angles, pooled over all environments: the root of the mean squared error of luminance
 * over that of the truth, and the median of each error relative to its own truth or 1 % of the mean. Then CPU ns of one
 * call. The picture has spheres under the first environment. Tables of it are in docs/testing.md. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "cpu_time.h"
#include "machine.h"
#include "specular_picture.h"

enum { MOST_LIGHTS = 16, NORMALS = 96 };

static const float ROUGHNESS[] = {0.05f, 0.1f, 0.2f, 0.3f, 0.4f, 0.6f, 0.8f, 1.0f};
static const float VIEW_COSINE[] = {1.0f, 0.8f, 0.5f, 0.2f};
static const float ROUGHNESS_BY_VIEW[] = {0.1f, 0.4f, 0.8f};
static const char *const LAYER_NAME[SPECULAR_LAYERS] = {"area",          "env. map", "env. split",   "Phong's area",
                                                        "key",           "key+area", "key+env. map", "dominant+rest",
                                                        "dominant+area", "area"};

enum {
    ROUGHNESSES = sizeof ROUGHNESS / sizeof ROUGHNESS[0],
    VIEWS = sizeof VIEW_COSINE / sizeof VIEW_COSINE[0],
    BY_VIEW = sizeof ROUGHNESS_BY_VIEW / sizeof ROUGHNESS_BY_VIEW[0],
    SURFACES = NORMALS * VIEWS
};

typedef struct specular_options {
    const char *env[MOST_LIGHTS];
    int env_count;
    float f0;
    uint32_t samples;
    const char *picture;
} specular_options;

/* Errors of one roughness, or of one view. */
typedef struct pooled {
    double squares[SPECULAR_LAYERS], truth[2]; /* of the picture, of all light */
    float own[SPECULAR_LAYERS][MOST_LIGHTS * SURFACES];
    int count;
} pooled;

static int float_compare(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Normals are spread evenly (Fibonacci), and the view turns about each. */
static specular_surface surface_of(int index, lmb_specular specular)
{
    const double golden = 2.399963229728653;
    const int i = index / VIEWS;
    const double y = 1.0 - 2.0 * (i + 0.5) / NORMALS, radius = sqrt(1.0 - y * y);
    const lmb_vec3 normal = lmb_vec3_of((float)(radius * cos(golden * i)), (float)y, (float)(radius * sin(golden * i)));
    lmb_vec3 tangent, bitangent;
    lmb_vec3_frame(normal, &tangent, &bitangent);
    const float cosine = VIEW_COSINE[index % VIEWS], sine = sqrtf(1.0f - cosine * cosine);
    const lmb_vec3 across =
        lmb_vec3_mad(lmb_vec3_scale(tangent, (float)cos(1.7 * index)), bitangent, (float)sin(1.7 * index));
    const lmb_vec3 view = lmb_vec3_unit_or(lmb_vec3_mad(lmb_vec3_scale(normal, cosine), across, sine), normal);
    return (specular_surface){specular, normal, view};
}

/* Truths and layers of one light. */
typedef struct compared {
    float truth[2][SURFACES];
    float found[SPECULAR_LAYERS][SURFACES];
    int count;
} compared;

/* All lights count the same. */
static void compared_add(const compared *light, pooled *sum)
{
    double mean[2] = {0.0, 0.0};
    for (int i = 0; i < 2 * light->count; ++i) {
        mean[i % 2] += (double)light->truth[i % 2][i / 2] / light->count;
    }
    for (int i = 0; i < light->count; ++i) {
        for (int whole = 0; whole < 2; ++whole) {
            sum->truth[whole] += pow((double)light->truth[whole][i] / mean[whole], 2.0);
        }
        for (int layer = 0; layer < SPECULAR_LAYERS; ++layer) {
            const int whole = !specular_layer_is_of_picture((specular_layer)layer);
            const double truth = (double)light->truth[whole][i], off = (double)light->found[layer][i] - truth;
            sum->squares[layer] += pow(off / mean[whole], 2.0);
            sum->own[layer][sum->count + i] = (float)(fabs(off) / fmax(truth, 0.01 * mean[whole]));
        }
    }
    sum->count += light->count;
}

/* Adds a light's surfaces of one roughness; `only_view` < 0: all views. */
static void light_compare(const specular_light *light, const specular_options *options, float roughness, int only_view,
                          pooled *sum)
{
    static compared all;
    const lmb_specular specular = {roughness, {{options->f0, options->f0, options->f0}}};
    all.count = 0;
    for (int i = 0; i < SURFACES; ++i) {
        if (only_view >= 0 && i % VIEWS != only_view) {
            continue;
        }
        const specular_surface surface = surface_of(i, specular);
        const lmb_rgb sun =
            lmb_specular_light(&light->sun, 1.0f, &specular, surface.normal, surface.normal, surface.view);
        const lmb_rgb picture = specular_traced(light, &surface, options->samples, (uint64_t)i);
        all.truth[0][all.count] = lmb_luminance(picture);
        all.truth[1][all.count] = lmb_luminance(lmb_rgb_add(picture, sun));
        for (int layer = 0; layer < SPECULAR_LAYERS; ++layer) {
            const lmb_rgb found =
                specular_layer_of(light, (specular_layer)layer, &surface, options->samples, (uint64_t)(i + SURFACES));
            all.found[layer][all.count] = lmb_luminance(found);
        }
        ++all.count;
    }
    compared_add(&all, sum);
}

static void lights_compare(const specular_light *lights, const specular_options *options, float roughness, int view,
                           pooled *sum)
{
    *sum = (pooled){.count = 0};
    for (int k = 0; k < options->env_count; ++k) {
        light_compare(&lights[k], options, roughness, view, sum);
    }
}

static void row_print(const char *name, float value, pooled *sum)
{
    printf("%-9s%5.2f", name, (double)value);
    for (int layer = 0; layer < SPECULAR_LAYERS; ++layer) {
        qsort(sum->own[layer], (size_t)sum->count, sizeof sum->own[layer][0], float_compare);
        const double truth = sum->truth[!specular_layer_is_of_picture((specular_layer)layer)];
        printf("   %6.3f %6.3f", sqrt(sum->squares[layer] / truth), (double)sum->own[layer][sum->count / 2]);
    }
    printf("\n");
}

static void tables_print(const specular_light *lights, const specular_options *options)
{
    static pooled sum;
    printf("f0 %g; rel. RMSE and median: four of the picture without its sun, the rest of all light\n%-14s",
           (double)options->f0, "");
    for (int layer = 0; layer < SPECULAR_LAYERS; ++layer) {
        printf("%16s", LAYER_NAME[layer]);
    }
    printf("\n");
    for (int i = 0; i < ROUGHNESSES; ++i) {
        lights_compare(lights, options, ROUGHNESS[i], -1, &sum);
        row_print("roughness", ROUGHNESS[i], &sum);
    }
    for (int i = 0; i < BY_VIEW * VIEWS; ++i) {
        const float roughness = ROUGHNESS_BY_VIEW[i / VIEWS];
        if (i % VIEWS == 0) {
            printf("by N.V, at a roughness of %g\n", (double)roughness);
        }
        lights_compare(lights, options, roughness, i % VIEWS, &sum);
        row_print("N.V", VIEW_COSINE[i % VIEWS], &sum);
    }
}

typedef enum timed_call {
    CALL_AREA,
    CALL_ENVIRONMENT,
    CALL_LIGHT,
    CALL_PHONG,
    CALL_PHONG_AREA,
    CALL_DOMINANT,
    CALL_VISIBILITY,
    CALLS
} timed_call;

static const char *const CALL_NAME[CALLS] = {
    "lmb_specular_area",       "lmb_specular_environment",   "lmb_specular_light",          "lmb_specular_light_phong",
    "lmb_specular_area_phong", "lmb_sh3_rgb_dominant_light", "lmb_sh3_rgb_light_visibility"};

/* Another surface for each `turn`, so that nothing is found once for all. */
static float call_make(timed_call call, const specular_light *light, float turn)
{
    const lmb_vec3 normal = lmb_vec3_of(0.6f, 0.8f, 0.0f);
    const lmb_vec3 view = {0.6f - 0.3f * turn * 0.1f, 0.8f, 0.0f};
    const lmb_specular specular = {0.1f + 0.1f * turn, {{0.04f, 0.04f, 0.04f}}};
    const lmb_rgb weight = {{0.2f + 0.1f * turn, 0.3f, 0.9f - 0.1f * turn}};
    switch (call) {
    case CALL_AREA:
        return lmb_specular_area(&light->radiance, &specular, normal, view).c[0];
    case CALL_ENVIRONMENT:
        return lmb_specular_environment(weight, &light->radiance, &specular, normal, view).c[0];
    case CALL_LIGHT:
        return lmb_specular_light(&light->dominant, 1.0f, &specular, normal, normal, view).c[0];
    case CALL_PHONG:
        return lmb_specular_light_phong(&light->dominant, 1.0f, &specular, normal, normal, view).c[0];
    case CALL_PHONG_AREA:
        return lmb_specular_area_phong(&light->radiance, &specular, normal, view).c[0];
    case CALL_DOMINANT:
        return lmb_sh3_rgb_dominant_light(&light->radiance).irradiance.c[0] + turn;
    default: {
        const lmb_key_light lamp = {view, light->dominant.irradiance};
        return lmb_sh3_rgb_light_visibility(&light->radiance, &lamp);
    }
    }
}

static void call_time(timed_call call, const specular_light *light)
{
    enum { REPEATS = 5, COUNT = 200000 };
    double best = 1e30;
    volatile float sink = 0.0f;
    for (int repeat = 0; repeat < REPEATS; ++repeat) {
        const double start = cpu_time_of_thread();
        float sum = 0.0f;
        for (int i = 0; i < COUNT; ++i) {
            sum += call_make(call, light, (float)(i & 1023) * 0.006f);
        }
        const double seconds = cpu_time_of_thread() - start;
        sink = sink + sum;
        best = seconds < best ? seconds : best;
    }
    printf("%-30s%6.1f ns\n", CALL_NAME[call], 1e9 * best / COUNT);
}

static bool options_read(int count, char **values, specular_options *options)
{
    for (int i = 1; i < count; ++i) {
        const char *const value = i + 1 < count ? values[i + 1] : NULL;
        if (strcmp(values[i], "--f0") == 0 && value) {
            options->f0 = (float)atof(value);
            ++i;
        } else if (strcmp(values[i], "--samples") == 0 && value) {
            options->samples = (uint32_t)atoi(value);
            ++i;
        } else if (strcmp(values[i], "--picture") == 0 && value) {
            options->picture = value;
            ++i;
        } else if (values[i][0] == '-' || options->env_count == MOST_LIGHTS) {
            return false;
        } else {
            options->env[options->env_count++] = values[i];
        }
    }
    return options->env_count > 0 && options->samples > 3;
}

int main(int count, char **values)
{
    static specular_light lights[MOST_LIGHTS];
    specular_options options = {.f0 = 0.04f, .samples = 4096};
    lmb_error error = {""};
    if (!options_read(count, values, &options)) {
        fprintf(stderr, "usage: lambent_specular ENV... [--f0 X] [--samples N] [--picture FILE.png]\n");
        return 2;
    }
    lmb_result result = LMB_OK;
    for (int i = 0; i < options.env_count && result == LMB_OK; ++i) {
        result = specular_light_open(options.env[i], &lights[i], &error);
    }
    if (result == LMB_OK && options.picture) {
        const lmb_rgb f0 = {{options.f0, options.f0, options.f0}};
        result = specular_picture_write(options.picture, &lights[0], f0, &error);
    }
    if (result == LMB_OK) {
        char machine[512];
        machine_text(machine);
        printf("%s\n", machine);
        tables_print(lights, &options);
        for (int call = 0; call < CALLS; ++call) {
            call_time((timed_call)call, &lights[0]);
        }
    } else {
        fprintf(stderr, "lambent_specular: %s\n", error.message);
    }
    for (int i = 0; i < options.env_count; ++i) {
        specular_light_close(&lights[i]);
    }
    return result == LMB_OK ? 0 : 1;
}
