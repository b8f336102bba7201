/* What levels of probes save: probes and error of interpolation beside even lattices of the same level.
 *
 *     lambent_levels LEVEL [bake options] [--points N] [--truth N] [--even M,...] [--tolerances E,...]
 *
 * solves the level's light once, gathers the truth at random places of free space, and bakes in memory, with the bake
 * options, an even lattice of each spacing and levels of each tolerance. One line for each, tabs between:
 *
 *     "even" and its spacing, or "levels" and their tolerance; probes; of these baked; places outside;
 *     relative RMSE; RMS (none counted as more than 1), median and 95th percentile of the places' own relative errors;
 *     the share beyond a tenth;
 *     seconds of placing, of choosing levels and of gathering
 *
 * and for levels, by RMS, median and 95th percentile, how many times as many probes an even lattice of the same error
 * has, by interpolation between the even ones on logarithmic axes; beyond them by the slope of the last two, "~" before
 * it. The error is of irradiance, over all normals, by SH3 and key lights, relative to the light at the place or to 1 %
 * of the mean. Noise of truth and probes is taken out by their independent halves; denoising is off. Its table is in
 * docs/baking.md. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/bake_phases.h>
#include <lambent/key_lights.h>
#include <lambent/sequence.h>

#include "bake_arguments.h"

static const char usage[] =
    "usage: lambent_levels LEVEL [options]\n"
    "\n"
    "  --points N            places in free space (default 2000)\n"
    "  --truth N             samples at each (default 4096)\n"
    "  --even M,...          spacings of even lattices\n"
    "  --tolerances E,...    of levels between --spacing and --min-spacing\n" BAKE_USAGE LEVEL_USAGE;

enum { MOST_RUNS = 16, MOST_TRIES = 1000, ERRORS = 3 };
#define PI 3.14159265358979323846
#define DARK_SHARE 0.01

/* Light of one place: its mean, and half of what its halves differ by. */
typedef struct place_light {
    lmb_sh3_rgb mean, difference;
    double key_visibility[LMB_KEY_LIGHTS_MOST];
} place_light;

typedef struct place {
    lmb_vec3 position;
    place_light truth;
    double squared_light;
} place;

typedef struct run_record {
    const char *kind;
    double setting;
    double probes, baked, outside;
    double rel_rmse, error[ERRORS], over; /* RMS, median, 95th percentile */
    double seconds[3];
} run_record;

typedef struct levels_work {
    lmb_level *level;
    lmb_bake_settings settings;
    uint32_t place_count, truth_samples;
    place *place;
    double dark_squared;
    uint32_t key_count;
    double key_weight[LMB_KEY_LIGHTS_MOST];
    double spacing[MOST_RUNS], tolerance[MOST_RUNS];
    int spacing_count, tolerance_count, even_count;
    run_record even[MOST_RUNS];
} levels_work;

/* Squared norm of what an object gets: mean over normals of squared normalised irradiance. */
static double light_squared(const levels_work *work, const lmb_sh3_rgb *light, const double *key_visibility)
{
    static const double band[3] = {1.0, 2.0 / 3.0, 0.25};
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            const double part = band[k == 0 ? 0 : k < 4 ? 1 : 2] * (double)light->channel[c].c[k];
            sum += part * part / (4.0 * PI);
        }
    }
    for (uint32_t key = 0; key < work->key_count; ++key) {
        sum += work->key_weight[key] * key_visibility[key] * key_visibility[key];
    }
    return sum;
}

static lmb_sh3_rgb light_less(const lmb_sh3_rgb *a, const lmb_sh3_rgb *b)
{
    lmb_sh3_rgb less;
    for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
        const int c = i / LMB_SH3_COUNT, k = i % LMB_SH3_COUNT;
        less.channel[c].c[k] = a->channel[c].c[k] - b->channel[c].c[k];
    }
    return less;
}

/* ------------------------------------------------------------------------------------------------ places */

static bool place_find(const levels_work *work, const lmb_probes *covered, uint32_t number, lmb_vec3 *position)
{
    const lmb_scene *scene = work->level->scene;
    const float low[3] = {scene->bounds_min.x, scene->bounds_min.y, scene->bounds_min.z};
    const float high[3] = {scene->bounds_max.x, scene->bounds_max.y, scene->bounds_max.z};
    for (uint32_t attempt = 0; attempt < MOST_TRIES; ++attempt) {
        float across[2], height[2];
        uint64_t rays = 0;
        lmb_sequence_2d(UINT64_C(77) + number, attempt, 0, across);
        lmb_sequence_2d(UINT64_C(77) + number, attempt, 1, height);
        const lmb_vec3 at = {low[0] + across[0] * (high[0] - low[0]), low[1] + height[0] * (high[1] - low[1]),
                             low[2] + across[1] * (high[2] - low[2])};
        int32_t around[8];
        double fraction[3];
        bool near_free = false;
        if (lmb_probes_around(covered, lmb_scene_to_world(scene, at), around, fraction)) {
            for (int i = 0; i < 8; ++i) {
                near_free = near_free || covered->validity[around[i]] >= LMB_PROBES_MIN_VALIDITY;
            }
        }
        if (near_free && lmb_placement_is_free(work->level->tracer, at, &rays)) {
            *position = at;
            return true;
        }
    }
    return false;
}

static void place_site(const void *context, size_t element, lmb_gather_site *site)
{
    const levels_work *work = context;
    site->point[0] = (lmb_gather_point){.position = work->place[element].position};
    site->count = 1;
}

static lmb_result truth_gather(levels_work *work)
{
    const lmb_gather_list list = {
        .name = "truth", .count = work->place_count, .most_points = 1, .find_site = place_site, .context = work};
    const lmb_gather_effort effort = {.samples = work->truth_samples};
    lmb_transport transport = work->level->transport;
    transport.seed += 1000000;
    const lmb_gather_job job = lmb_gather_job_all(&transport, &list, &effort);
    lmb_gathered *const gathered = malloc((work->place_count + (size_t)1) * sizeof *gathered);
    lmb_gather_stats stats;
    const lmb_result result =
        gathered ? lmb_gather_elements(&job, work->level->pool, NULL, gathered, &stats) : LMB_ERROR_MEMORY;
    double mean = 0.0;
    for (uint32_t i = 0; i < work->place_count && result == LMB_OK; ++i) {
        place *const to = &work->place[i];
        to->truth = (place_light){.mean = gathered[i].moments, .difference = gathered[i].difference};
        for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
            to->truth.key_visibility[key] = (double)gathered[i].key_visibility[key];
        }
        to->squared_light = light_squared(work, &to->truth.mean, to->truth.key_visibility);
        mean += sqrt(to->squared_light) / work->place_count;
    }
    work->dark_squared = DARK_SHARE * DARK_SHARE * mean * mean;
    free(gathered);
    return result;
}

/* Places in the free space of an even lattice. */
static lmb_result places_make(levels_work *work, lmb_error *error)
{
    lmb_bake bake = lmb_bake_begin(&work->settings, work->level, NULL);
    bake.record.settings.min_spacing = 0.0f;
    bake.record.settings.spacing = (float)work->spacing[0];
    for (int i = 1; i < work->spacing_count; ++i) {
        bake.record.settings.spacing = fminf(bake.record.settings.spacing, (float)work->spacing[i]);
    }
    lmb_result result = lmb_bake_place(&bake, error);
    const uint32_t wanted = work->place_count;
    work->place = calloc(wanted + (size_t)1, sizeof *work->place);
    work->place_count = 0;
    for (uint32_t i = 0; i < wanted && result == LMB_OK && work->place; ++i) {
        work->place_count += place_find(work, bake.probes, i, &work->place[work->place_count].position);
    }
    lmb_bake_end(&bake);
    return result == LMB_OK && work->place ? truth_gather(work) : result == LMB_OK ? LMB_ERROR_MEMORY : result;
}

/* ------------------------------------------------------------------------------------------------ errors */

static int doubles_compare(const void *a, const void *b)
{
    const double *const p = a, *const q = b;
    return (*p > *q) - (*p < *q);
}

static bool place_sample(const lmb_probes *probes, const lmb_scene *scene, const place *at, place_light *light)
{
    const lmb_vec3d world = lmb_scene_to_world(scene, at->position);
    int32_t around[8];
    double t[3];
    if (!lmb_probes_around(probes, world, around, t)) {
        return false;
    }
    *light =
        (place_light){.mean = lmb_probes_light(probes, 0, world), .difference = lmb_probes_light(probes, 1, world)};
    for (int i = 0; i < 8; ++i) {
        const double weight = (i & 1 ? t[0] : 1.0 - t[0]) * (i & 2 ? t[1] : 1.0 - t[1]) * (i & 4 ? t[2] : 1.0 - t[2]);
        for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
            light->key_visibility[key] += weight * (double)probes->key_visibility[around[i]][key];
        }
    }
    return true;
}

static double place_error_squared(const levels_work *work, const place_light *light, const place_light *truth)
{
    static const double no_key[LMB_KEY_LIGHTS_MOST] = {0.0};
    double keys[LMB_KEY_LIGHTS_MOST];
    for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
        keys[key] = light->key_visibility[key] - truth->key_visibility[key];
    }
    const lmb_sh3_rgb off = light_less(&light->mean, &truth->mean);
    const lmb_sh3_rgb noise = light_less(&light->difference, &truth->difference);
    return light_squared(work, &off, keys) - light_squared(work, &noise, no_key);
}

static void errors_measure(const levels_work *work, const lmb_probes *probes, run_record *run)
{
    double *const own = malloc((work->place_count + (size_t)1) * sizeof *own);
    double squared = 0.0, light_sum = 0.0, relative = 0.0;
    uint32_t count = 0, over = 0;
    for (uint32_t i = 0; i < work->place_count && own; ++i) {
        const place *const at = &work->place[i];
        place_light light;
        if (!place_sample(probes, work->level->scene, at, &light)) {
            continue;
        }
        const double error = place_error_squared(work, &light, &at->truth);
        squared += error;
        light_sum += at->squared_light;
        const double share = error / fmax(at->squared_light, work->dark_squared);
        relative += fmin(share, 1.0);
        over += share > 0.01;
        own[count++] = sqrt(fmax(share, 0.0));
    }
    run->outside = work->place_count - count;
    if (count > 0) {
        qsort(own, count, sizeof *own, doubles_compare);
        run->rel_rmse = sqrt(fmax(squared, 0.0) / light_sum);
        run->error[0] = sqrt(fmax(relative, 0.0) / count);
        run->error[1] = own[count / 2];
        run->error[2] = own[count * 95 / 100];
        run->over = (double)over / count;
    }
    free(own);
}

/* -------------------------------------------------------------------------------------------------- bakes */

/* Set 0 is the light, set 1 what its halves differ by. */
static lmb_result probes_gather(lmb_bake *bake)
{
    lmb_probe_list list;
    lmb_result result = lmb_probe_list_create(bake->probes, bake->regions, bake->level->tracer, &list);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_gather_effort effort = lmb_bake_effort(&bake->record.settings, bake->level);
    const lmb_gather_list all = lmb_probe_list_elements(&list);
    const lmb_gather_job job = lmb_gather_job_all(&bake->level->transport, &all, &effort);
    lmb_gathered *const gathered = malloc((list.count + 1) * sizeof *gathered);
    result = gathered ? lmb_gather_elements(&job, bake->level->pool, NULL, gathered, &bake->record.gathered)
                      : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = lmb_probe_list_finish(&list, gathered, bake->level->pool, bake->probes);
    }
    if (result == LMB_OK) {
        result = lmb_probes_add_set(bake->probes, &list.set);
    }
    if (result == LMB_OK) {
        for (size_t i = 0; i < list.count; ++i) {
            gathered[i].moments = gathered[i].difference;
        }
        result = lmb_probe_list_finish(&list, gathered, bake->level->pool, bake->probes);
    }
    free(gathered);
    lmb_probe_list_free(&list);
    return result;
}

static lmb_result run_bake(const levels_work *work, const lmb_bake_settings *settings, run_record *run,
                           lmb_error *error)
{
    lmb_bake bake = lmb_bake_begin(settings, work->level, NULL);
    lmb_result result = lmb_bake_place(&bake, error);
    if (result == LMB_OK) {
        result = lmb_bake_levels(&bake, error);
    }
    const double start = seconds_now();
    if (result == LMB_OK) {
        result = probes_gather(&bake);
    }
    if (result == LMB_OK) {
        run->probes = bake.probes->count;
        run->baked = bake.record.placement.probes_valid;
        run->seconds[0] = bake.record.seconds[LMB_PHASE_PLACE];
        run->seconds[1] = bake.record.seconds[LMB_PHASE_LEVELS];
        run->seconds[2] = seconds_now() - start;
        errors_measure(work, bake.probes, run);
    }
    lmb_bake_end(&bake);
    return result;
}

/* How many probes an even lattice of that error has, and whether that lies beyond those that were measured. */
static double even_probes(const levels_work *work, int which, double error, bool *beyond)
{
    int at = 0;
    while (at + 2 < work->even_count && work->even[at + 1].error[which] > error) {
        ++at;
    }
    if (work->even_count < 2) {
        return NAN;
    }
    const run_record *const a = &work->even[at], *const b = &work->even[at + 1];
    const double slope = log(b->probes / a->probes) / log(b->error[which] / a->error[which]);
    *beyond = error > a->error[which] || error < b->error[which];
    return a->probes * exp(slope * log(error / a->error[which]));
}

static void run_print(const levels_work *work, const run_record *run)
{
    printf("%s\t%g\t%.0f\t%.0f\t%.0f\t%.4f\t%.4f\t%.4f\t%.4f\t%.4f\t%.1f\t%.1f\t%.1f", run->kind, run->setting,
           run->probes, run->baked, run->outside, run->rel_rmse, run->error[0], run->error[1], run->error[2], run->over,
           run->seconds[0], run->seconds[1], run->seconds[2]);
    for (int which = 0; which < ERRORS && strcmp(run->kind, "levels") == 0; ++which) {
        bool beyond = false;
        const double probes = even_probes(work, which, run->error[which], &beyond);
        printf("\t%s%.2f", beyond ? "~" : "", probes / run->probes);
    }
    printf("\n");
    fflush(stdout);
}

static lmb_result runs_make(levels_work *work, lmb_error *error)
{
    lmb_result result = LMB_OK;
    for (int i = 0; i < work->spacing_count && result == LMB_OK; ++i) {
        lmb_bake_settings settings = work->settings;
        settings.min_spacing = 0.0f;
        settings.spacing = (float)work->spacing[i];
        run_record *const run = &work->even[work->even_count];
        *run = (run_record){.kind = "even", .setting = work->spacing[i]};
        result = run_bake(work, &settings, run, error);
        if (result == LMB_OK) {
            ++work->even_count;
            run_print(work, run);
        }
    }
    for (int i = 0; i < work->tolerance_count && result == LMB_OK; ++i) {
        lmb_bake_settings settings = work->settings;
        settings.tolerance = work->tolerance[i];
        run_record run = {.kind = "levels", .setting = work->tolerance[i]};
        result = run_bake(work, &settings, &run, error);
        if (result == LMB_OK) {
            run_print(work, &run);
        }
    }
    return result;
}

static lmb_result levels_measure(levels_work *work, lmb_error *error)
{
    lmb_bake solved = lmb_bake_begin(&work->settings, work->level, NULL);
    lmb_result result = lmb_bake_surface(&solved, error);
    lmb_bake_end(&solved);
    lmb_key_light key[LMB_KEY_LIGHTS_MOST];
    work->key_count = lmb_scene_key_lights(work->level->scene, key);
    for (uint32_t i = 0; i < work->key_count; ++i) {
        for (int c = 0; c < 3; ++c) {
            const double normalised = (double)key[i].irradiance.c[c] / PI;
            work->key_weight[i] += normalised * normalised / 6.0;
        }
    }
    if (result == LMB_OK) {
        result = places_make(work, error);
    }
    return result == LMB_OK ? runs_make(work, error) : result;
}

/* A,B,... */
static int numbers_take(lmb_arguments *arguments, const char *option, double number[MOST_RUNS])
{
    const char *text = arguments_text(arguments, option);
    int count = 0;
    while (*text && count < MOST_RUNS) {
        char *end;
        number[count] = strtod(text, &end);
        if (end == text || !(number[count] > 0.0) || (*end != ',' && *end != '\0')) {
            arguments_error(arguments, "no list of numbers", text);
            return 0;
        }
        ++count;
        text = *end == ',' ? end + 1 : end;
    }
    return count;
}

int main(int count, char **values)
{
    levels_work work = {.place_count = 2000, .truth_samples = 4096, .settings = lmb_bake_settings_default()};
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "lambent_levels", usage);
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (bake_argument(&work.settings, &arguments, argument)) {
            continue;
        }
        if (strcmp(argument, "--points") == 0) {
            work.place_count = (uint32_t)arguments_integer(&arguments, argument, 1, 1 << 24);
        } else if (strcmp(argument, "--truth") == 0) {
            work.truth_samples = (uint32_t)arguments_integer(&arguments, argument, 4, 1 << 28);
        } else if (strcmp(argument, "--even") == 0) {
            work.spacing_count = numbers_take(&arguments, argument, work.spacing);
        } else if (strcmp(argument, "--tolerances") == 0) {
            work.tolerance_count = numbers_take(&arguments, argument, work.tolerance);
        } else {
            arguments_error(&arguments, "unexpected argument", argument);
        }
    }
    if (arguments.failed || arguments.help || !work.settings.level.path || work.spacing_count == 0) {
        fputs(usage, stderr);
        return 2;
    }
    lmb_error error = {{0}};
    lmb_level level;
    const lmb_warnings warnings = console_warnings(arguments.quiet);
    lmb_result result = lmb_level_open(&work.settings.level, &warnings, NULL, &level, &error);
    if (result == LMB_OK) {
        work.level = &level;
        result = levels_measure(&work, &error);
        free(work.place);
        lmb_level_close(&level);
    }
    return result == LMB_OK ? 0 : command_fail(result, &error);
}
