/* How well a changing sky's light is made of bakes under a few fixed ones (lambent/sky.h):
 *
 *     lambent_sky_transfer LEVEL SKY... [--points N] [--samples N] [--spacing M] [level options]
 *
 * SKY as --env takes it: a picture, without rotation, or daylight. Its sun is taken out, as one that is kept apart
 * would be; so are the level's own lights. Probes are taken evenly from the level's own. At each, the light is gathered
 * under every function of the basis and under every sky, by the same samples; and under every sky once more by others,
 * which tells what of the errors is noise.
 *
 * One line for each sky and way, tabs between: the sky, how it was made, and relative errors of irradiance over 14
 * normals: root of the mean square over all places, the median place's and that of the 95th in 100. Ways: `1`, its mean
 * alone; `4` and `9`, its linear and quadratic harmonics; `noise`, the sky itself by other samples. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/environment.h>
#include <lambent/gather_sh3.h>
#include <lambent/light_sets.h>
#include <lambent/placement.h>
#include <lambent/sky.h>
#include <lambent/vector.h>

#include "command.h"
#include "irradiance_error.h"
#include "level_arguments.h"

static const char usage[] =
    "usage: lambent_sky_transfer LEVEL SKY... [options]\n"
    "\n"
    "  --points N            probes (default 256)\n"
    "  --samples N           at each (default 4096)\n"
    "  --spacing M           metres between the lattice points that probes are taken from\n" LEVEL_USAGE;

enum { MOST_POINTS = 4096, MOST_SKIES = 16 };

/* `sky-basis:K` and a sky belong to it: it is shown alone. */
#define SET_OF_SKY "transfer_sky"

typedef struct transfer {
    lmb_level level;
    lmb_gather_point point[MOST_POINTS];
    size_t count, wanted;
    uint32_t samples;
    float spacing;
    lmb_sh3_rgb *basis[LMB_SKY_QUADRATIC]; /* [point] */
    lmb_sh3_rgb *truth, *again, *made;
} transfer;

static lmb_result points_take(transfer *work, lmb_error *error)
{
    lmb_probes *probes = NULL;
    lmb_placement_settings settings = lmb_placement_settings_default();
    settings.spacing = work->spacing;
    lmb_placement_stats stats;
    const lmb_result result =
        lmb_placement_make(work->level.tracer, &settings, work->level.pool, &probes, &stats, error);
    if (result != LMB_OK) {
        return result;
    }
    size_t passed = 0;
    for (int32_t i = 0; i < probes->count; ++i) {
        if (probes->validity[i] < LMB_PROBES_MIN_VALIDITY) {
            continue;
        }
        if (work->count < work->wanted && passed * work->wanted >= work->count * (size_t)stats.probes_valid) {
            uint64_t rays = 0;
            const lmb_vec3 at = lmb_placement_relocate(work->level.tracer, lmb_probes_position(probes, i),
                                                       probes->level[0].lattice.spacing, &rays);
            work->point[work->count++] = (lmb_gather_point){.position = at};
        }
        ++passed;
    }
    lmb_probes_destroy(probes);
    return LMB_OK;
}

typedef struct gather_work {
    const transfer *work;
    lmb_transport transport;
    lmb_sh3_rgb *light;
} gather_work;

static void gather_task(void *context, size_t task, int worker)
{
    (void)worker;
    const gather_work *gather = context;
    lmb_gathered found;
    lmb_gather_sh3(&gather->transport, &gather->work->point[task], gather->work->samples, &found);
    gather->light[task] = found.moments;
}

static lmb_result light_gather(const transfer *work, uint64_t seed, lmb_sh3_rgb *light, lmb_error *error)
{
    gather_work gather = {work, work->level.transport, light};
    gather.transport.seed += seed;
    const lmb_result result = lmb_pool_run(work->level.pool, work->count, gather_task, &gather, "gather", NULL);
    return result == LMB_OK ? LMB_OK : lmb_error_set(error, result, "gather: %s", lmb_result_text(result));
}

/* Lights the level by a sky alone, without its sun, and solves it. */
static lmb_result sky_show(transfer *work, const char *description, lmb_error *error)
{
    lmb_scene *const scene = work->level.scene;
    char text[1024];
    snprintf(text, sizeof text, "%s,set=%s", description, SET_OF_SKY);
    lmb_result result = lmb_scene_set_environment(scene, text, error);
    lmb_environment_sun sun = {.count = 0};
    if (result == LMB_OK && lmb_environment_find_sun(&scene->environment, &sun) != LMB_OK) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    if (result == LMB_OK && sun.count > 0 && lmb_environment_take_sun(&scene->environment, &sun) != LMB_OK) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    lmb_environment_sun_free(&sun);
    if (result == LMB_OK && scene->environment.has_sun) {
        scene->lights[scene->light_count - 1].intensity = lmb_rgb_of(0.0f, 0.0f, 0.0f);
    }
    if (result == LMB_OK) {
        result = lmb_level_show_light_set(&work->level, scene->environment.set, error);
    }
    return result == LMB_OK ? lmb_level_solve(&work->level, LMB_ESTIMATOR_CACHED, NULL, error) : result;
}

/* What a game would know of the sky. */
static lmb_sh3_rgb sky_harmonics(const lmb_environment *environment)
{
    double sum[3][LMB_SH3_COUNT] = {{0.0}};
    const lmb_image *const image = &environment->image;
    for (int y = 0; y < image->height; ++y) {
        const double polar = LMB_PI * (y + 0.5) / image->height;
        const double band = cos(LMB_PI * y / image->height) - cos(LMB_PI * (y + 1) / image->height);
        for (int x = 0; x < image->width; ++x) {
            const double turn = 2.0 * LMB_PI * (x + 0.5) / image->width;
            const float a = (float)(-sin(polar) * cos(turn)), b = (float)(-sin(polar) * sin(turn));
            const bool is_gltf = environment->axes == LMB_LATLONG_GLTF;
            const lmb_sh3 basis = lmb_sh3_basis(lmb_vec3_of(is_gltf ? a : -b, (float)cos(polar), is_gltf ? b : a));
            const float *rgb = &image->rgb[3 * ((size_t)y * (size_t)image->width + (size_t)x)];
            for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
                sum[i % 3][i / 3] += (double)rgb[i % 3] * (double)environment->strength * (double)basis.c[i / 3] *
                                     band * 2.0 * LMB_PI / image->width;
            }
        }
    }
    lmb_sh3_rgb sky;
    for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
        sky.channel[i % 3].c[i / 3] = (float)sum[i % 3][i / 3];
    }
    return sky;
}

static void light_make(const transfer *work, const lmb_rgb *weight, uint32_t count)
{
    for (size_t i = 0; i < work->count; ++i) {
        memset(&work->made[i], 0, sizeof work->made[i]);
        for (uint32_t k = 0; k < count; ++k) {
            for (int n = 0; n < 3 * LMB_SH3_COUNT; ++n) {
                work->made[i].channel[n % 3].c[n / 3] += weight[k].c[n % 3] * work->basis[k][i].channel[n % 3].c[n / 3];
            }
        }
    }
}

static lmb_result errors_print(const transfer *work, const char *sky, const char *way, const lmb_sh3_rgb *made)
{
    error_summary error;
    const lmb_result result = irradiance_error_find(work->truth, made, work->count, &error);
    if (result == LMB_OK) {
        printf("%s\t%s\t%.4f\t%.4f\t%.4f\n", sky, way, error.rel_rmse, error.median, error.p95);
        fflush(stdout);
    }
    return result;
}

static lmb_result sky_measure(transfer *work, const char *description, lmb_error *error)
{
    static const struct {
        const char *name;
        uint32_t count;
    } ways[] = {{"4", LMB_SKY_LINEAR}, {"9", LMB_SKY_QUADRATIC}};
    lmb_result result = sky_show(work, description, error);
    if (result == LMB_OK && !work->level.scene->environment.image.rgb) {
        result = lmb_error_set(error, LMB_ERROR_ARGUMENT, "%s: a picture or daylight", description);
    }
    if (result == LMB_OK) {
        result = light_gather(work, 0, work->truth, error);
    }
    if (result == LMB_OK) {
        result = light_gather(work, 1, work->again, error);
    }
    if (result != LMB_OK) {
        return result;
    }
    const lmb_sh3_rgb sky = sky_harmonics(&work->level.scene->environment);
    lmb_rgb weight[LMB_SKY_QUADRATIC];
    for (int c = 0; c < 3; ++c) {
        weight[0].c[c] = sky.channel[c].c[0] * 0.28209479f; /* its mean */
    }
    light_make(work, weight, 1);
    result = errors_print(work, description, "1", work->made);
    for (size_t i = 0; i < sizeof ways / sizeof ways[0] && result == LMB_OK; ++i) {
        lmb_sky_weights(&sky, ways[i].count, weight);
        light_make(work, weight, ways[i].count);
        result = errors_print(work, description, ways[i].name, work->made);
    }
    return result == LMB_OK ? errors_print(work, description, "noise", work->again) : result;
}

static lmb_result basis_gather(transfer *work, lmb_error *error)
{
    lmb_result result = LMB_OK;
    for (int k = 0; k < LMB_SKY_QUADRATIC && result == LMB_OK; ++k) {
        char text[32];
        snprintf(text, sizeof text, "sky-basis:%d", k);
        result = sky_show(work, text, error);
        if (result == LMB_OK) {
            result = light_gather(work, 0, work->basis[k], error);
        }
    }
    return result;
}

static lmb_result transfer_run(transfer *work, const char *const *sky, int skies, lmb_error *error)
{
    lmb_result result = points_take(work, error);
    lmb_sh3_rgb *const memory = malloc((LMB_SKY_QUADRATIC + 3) * (work->count + 1) * sizeof *memory);
    if (result == LMB_OK && !memory) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    if (result == LMB_OK) {
        for (size_t k = 0; k < LMB_SKY_QUADRATIC; ++k) {
            work->basis[k] = memory + k * work->count;
        }
        work->truth = memory + LMB_SKY_QUADRATIC * work->count;
        work->again = work->truth + work->count;
        work->made = work->again + work->count;
        result = basis_gather(work, error);
    }
    for (int i = 0; i < skies && result == LMB_OK; ++i) {
        result = sky_measure(work, sky[i], error);
    }
    free(memory);
    return result;
}

int main(int count, char **values)
{
    static transfer work = {.wanted = 256, .samples = 4096};
    const char *sky[MOST_SKIES];
    int skies = 0;
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "lambent_sky_transfer", usage);
    lmb_level_settings level = lmb_level_settings_default();
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (level_argument(&level, &arguments, argument)) {
            continue;
        }
        if (strcmp(argument, "--points") == 0) {
            work.wanted = (size_t)arguments_integer(&arguments, argument, 1, MOST_POINTS);
        } else if (strcmp(argument, "--samples") == 0) {
            work.samples = (uint32_t)arguments_integer(&arguments, argument, 1, 1 << 24);
        } else if (strcmp(argument, "--spacing") == 0) {
            work.spacing = (float)arguments_number(&arguments, argument, 1e-6, 1e6);
        } else if (argument[0] != '-' && !level.path) {
            level.path = argument;
        } else if (argument[0] != '-' && skies < MOST_SKIES) {
            sky[skies++] = argument;
        } else {
            arguments_error(&arguments, "unexpected argument", argument);
        }
    }
    if (arguments.failed || arguments.help || skies == 0) {
        fputs(usage, stderr);
        return EXIT_USAGE;
    }
    level.environment = "sky-basis:0,set=" SET_OF_SKY;
    level.light_set = SET_OF_SKY;
    level.key_lights = 0;
    lmb_error error = {{0}};
    const lmb_warnings warnings = console_warnings(arguments.quiet);
    lmb_result result = lmb_level_open(&level, &warnings, NULL, &work.level, &error);
    if (result == LMB_OK) {
        result = transfer_run(&work, sky, skies, &error);
        lmb_level_close(&work.level);
    }
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
