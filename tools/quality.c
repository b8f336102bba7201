/* What each quality gets right of a level's light, and how well it knows its own noise:
 *
 *     lambent_quality LEVEL [bake options] [--truth N] [--seeds N] [--efforts NAME,...]
 *
 * bakes the level's probes and texels in memory with each effort (draft, medium, high, or a number of samples) and
 * each seed, and for the truth with `--truth` samples, a quarter of them by each of four other seeds, all from one
 * solution of the light on surfaces. One line for each effort, tabs between:
 *
 *     effort, samples of an element, CPU seconds of gathering for one bake, those of denoising it,
 *     of probes: mean of l0 / truth - 1, its standard error, estimated noise, true noise, that of each by itself, the
 *         share of probes whose light is right,
 *     of denoised probes: the same,
 *     of texels: the same of I_z,
 *     of denoised texels: the same
 *
 * Noise is that of all SH moments, relative to their length, as lmb_relative_error has it. The true one is the root of
 * the mean squared difference to the truth, whose own noise, from the spread of its seeds, is taken out. The last is
 * the root of the mean squared difference relative to each element's own light, or to 1 % of the level's mean light.
 * Light is right within 3 % of the truth, or of 1 % of its mean where that is more.
 * Its table is in docs/baking.md. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/bake_phases.h>

#include "bake_arguments.h"
#include "cpu_time.h"

static const char usage[] =
    "usage: lambent_quality LEVEL [options]\n"
    "\n"
    "  --truth N             samples of the truth (default 4096)\n"
    "  --seeds N             bakes of each effort (default 1)\n"
    "  --efforts NAME,...    draft, medium, high or samples (default draft,medium,high,64,256)\n" BAKE_USAGE
        LEVEL_USAGE;

enum { PROBES, DENOISED_PROBES, TEXELS, DENOISED_TEXELS, KINDS, TRUTH_SEEDS = 4 };
#define FIRST_TRUTH_SEED UINT64_C(1000000)
#define RIGHT_LIGHT 0.03
#define RIGHT_FLOOR 0.01

/* Probes or texels of one bake. */
typedef struct elements {
    size_t count;
    lmb_sh3_rgb *moments;
    float *light; /* l0 or I_z, of the mean of the channels */
    double squared_error, squared_length;
} elements;

typedef struct baked_light {
    elements kind[KINDS];
    double samples;         /* of an element */
    double seconds;         /* of CPU, to gather */
    double denoise_seconds; /* of CPU */
} baked_light;

/* Sums over elements and seeds. */
typedef struct comparison {
    double off, squared_off; /* of light */
    double truth;
    double squared_distance; /* of moments; the truth's noise is in it */
    double squared_relative; /* of each element, relative to its own light */
    double count;
    double estimated, length;
    double right; /* elements */
} comparison;

typedef struct quality_work {
    lmb_bake bake;
    baked_light truth;
    uint32_t truth_samples;
    int seeds;
    char *efforts;
} quality_work;

static float rgb_mean(const lmb_rgb *light)
{
    return (light->c[0] + light->c[1] + light->c[2]) / 3.0f;
}

static void light_free(baked_light *light)
{
    for (int kind = 0; kind < KINDS; ++kind) {
        free(light->kind[kind].moments);
        free(light->kind[kind].light);
    }
}

static bool elements_allocate(elements *of, size_t count)
{
    of->count = 0;
    of->moments = calloc(count + 1, sizeof *of->moments);
    of->light = calloc(count + 1, sizeof *of->light);
    return of->moments && of->light;
}

static void probes_keep(const lmb_bake *bake, elements *probes)
{
    const lmb_probes *from = bake->probes;
    for (int32_t i = 0; i < from->count; ++i) {
        if (from->validity[i] >= LMB_PROBES_MIN_VALIDITY) {
            const lmb_sh3_rgb *radiance = &from->radiance[0][i];
            const lmb_rgb light = {{radiance->channel[0].c[0], radiance->channel[1].c[0], radiance->channel[2].c[0]}};
            probes->moments[probes->count] = *radiance;
            probes->light[probes->count++] = rgb_mean(&light);
        }
    }
    probes->squared_error = bake->record.gathered.squared_error;
    probes->squared_length = bake->record.gathered.squared_light;
}

static void texels_keep(const lmb_bake *bake, elements *texels)
{
    for (int32_t i = 0; i < bake->lightmap->image_count; ++i) {
        const lmb_lightmap_image *image = &bake->lightmap->image[i];
        for (size_t k = 0; k < (size_t)image->width * (size_t)image->height; ++k) {
            if (image->state[k] == LMB_TEXEL_GATHERED) {
                const lmb_rgb light = {{lmb_lightmap_plane(image, 0)[k], lmb_lightmap_plane(image, 1)[k],
                                        lmb_lightmap_plane(image, 2)[k]}};
                texels->light[texels->count++] = rgb_mean(&light);
            }
        }
    }
    texels->squared_error = bake->record.lightmap.squared_error;
    texels->squared_length = bake->record.lightmap.squared_light;
}

/* Gathers at all probes and denoises them. */
static lmb_result probes_bake(lmb_bake *bake, const lmb_transport *transport, const lmb_gather_effort *effort,
                              baked_light *light)
{
    const double start = cpu_time_of_process();
    lmb_probe_list list;
    lmb_result result = lmb_probe_list_create(bake->probes, bake->regions, transport->tracer, &list);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_gather_list all = lmb_probe_list_elements(&list);
    const lmb_gather_job job = lmb_gather_job_all(transport, &all, effort);
    lmb_gathered *gathered = malloc((all.count + 1) * sizeof *gathered);
    result = gathered ? lmb_gather_elements(&job, bake->level->pool, NULL, gathered, &bake->record.gathered)
                      : LMB_ERROR_MEMORY;
    light->seconds += cpu_time_of_process() - start;
    if (result == LMB_OK) {
        result = lmb_probe_list_finish(&list, gathered, bake->level->pool, bake->probes);
        probes_keep(bake, &light->kind[PROBES]);
    }
    const double kept_at = cpu_time_of_process();
    if (result == LMB_OK) {
        result = lmb_probe_list_denoise(&list, bake->level->pool, NULL, gathered);
        light->denoise_seconds += cpu_time_of_process() - kept_at;
    }
    if (result == LMB_OK) {
        lmb_gather_stats_renew(&bake->record.gathered, gathered, list.count);
        result = lmb_probe_list_finish(&list, gathered, bake->level->pool, bake->probes);
        probes_keep(bake, &light->kind[DENOISED_PROBES]);
    }
    free(gathered);
    lmb_probe_list_free(&list);
    return result;
}

/* Finishes all texels and keeps what they have. */
static lmb_result texels_finish(lmb_bake *bake, const lmb_texel_list *list, const lmb_gathered *gathered,
                                elements *texels)
{
    const size_t count = lmb_texel_list_elements(list).count;
    for (size_t i = 0; i < count; ++i) {
        texels->moments[i] = gathered[i].moments;
    }
    const lmb_result result = lmb_texel_list_finish(list, gathered, bake->level->pool, bake->lightmap);
    texels_keep(bake, texels);
    return result;
}

/* Gathers at all texels and denoises them. */
static lmb_result texels_bake(lmb_bake *bake, const lmb_transport *transport, const lmb_gather_effort *effort,
                              baked_light *light)
{
    const double start = cpu_time_of_process();
    lmb_texel_list *list;
    lmb_result result = lmb_texel_list_create(bake->lightmap, transport, effort, &list);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_gather_list all = lmb_texel_list_elements(list);
    const lmb_gather_job job = lmb_gather_job_all(transport, &all, effort);
    lmb_gathered *gathered = malloc((all.count + 1) * sizeof *gathered);
    result = gathered ? lmb_gather_elements(&job, bake->level->pool, NULL, gathered, &bake->record.lightmap)
                      : LMB_ERROR_MEMORY;
    const double gathered_at = cpu_time_of_process();
    if (result == LMB_OK) {
        result = texels_finish(bake, list, gathered, &light->kind[TEXELS]);
    }
    const double finished_at = cpu_time_of_process();
    if (result == LMB_OK) {
        result = lmb_texel_list_denoise(list, bake->level->pool, NULL, gathered);
        light->denoise_seconds += cpu_time_of_process() - finished_at;
    }
    light->seconds += gathered_at - start;
    if (result == LMB_OK) {
        lmb_gather_stats_renew(&bake->record.lightmap, gathered, all.count);
        result = texels_finish(bake, list, gathered, &light->kind[DENOISED_TEXELS]);
    }
    free(gathered);
    lmb_texel_list_destroy(list);
    return result;
}

static bool light_allocate(const lmb_bake *bake, baked_light *light)
{
    bool good = true;
    *light = (baked_light){.samples = 0.0};
    for (int kind = 0; kind < KINDS; ++kind) {
        const size_t count = kind < TEXELS ? (size_t)bake->probes->count : (size_t)bake->lightmap->covered_texel_count;
        good = elements_allocate(&light->kind[kind], count) && good;
    }
    return good;
}

/* One bake of probes and texels. */
static lmb_result light_bake(lmb_bake *bake, const lmb_gather_effort *effort, uint64_t seed, baked_light *light)
{
    lmb_transport transport = bake->level->transport;
    transport.seed = seed;
    if (!light_allocate(bake, light)) {
        return LMB_ERROR_MEMORY;
    }
    lmb_result result = probes_bake(bake, &transport, effort, light);
    if (result == LMB_OK) {
        result = texels_bake(bake, &transport, effort, light);
    }
    if (result != LMB_OK) {
        return result;
    }
    light->samples = (double)(bake->record.gathered.samples + bake->record.lightmap.samples) /
                     (double)(light->kind[PROBES].count + light->kind[TEXELS].count);
    return LMB_OK;
}

static double moments_distance_squared(const lmb_sh3_rgb *a, const lmb_sh3_rgb *b)
{
    double squared = 0.0;
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            const double off = (double)a->channel[c].c[k] - (double)b->channel[c].c[k];
            squared += off * off;
        }
    }
    return squared;
}

static void elements_compare(const elements *found, const elements *truth, double floor, comparison *sum)
{
    const lmb_sh3_rgb dark = {.channel = {{.c = {0.0f}}}};
    double mean = 0.0;
    for (size_t i = 0; i < truth->count; ++i) {
        mean += (double)truth->light[i] / (double)truth->count;
    }
    for (size_t i = 0; i < found->count; ++i) {
        const double off = (double)found->light[i] - (double)truth->light[i];
        sum->off += off;
        sum->squared_off += off * off;
        sum->truth += (double)truth->light[i];
        sum->right += fabs(off) <= RIGHT_LIGHT * fmax((double)truth->light[i], RIGHT_FLOOR * mean) ? 1.0 : 0.0;
        const double distance = moments_distance_squared(&found->moments[i], &truth->moments[i]);
        const double length = moments_distance_squared(&truth->moments[i], &dark);
        sum->squared_distance += distance;
        sum->squared_relative += distance > 0.0 ? distance / fmax(length, floor * floor) : 0.0;
    }
    sum->squared_distance -= truth->squared_error;
    sum->count += (double)found->count;
    sum->estimated += found->squared_error;
    sum->length += truth->squared_length - truth->squared_error;
}

static void comparison_print(const comparison *sum)
{
    const double count = sum->count > 0.0 ? sum->count : 1.0;
    const double spread = sum->squared_off / count - (sum->off / count) * (sum->off / count);
    const double mean = sum->truth / count;
    printf("\t%+.5f\t%.5f\t%.5f\t%.5f\t%.5f\t%.4f", sum->off / count / mean, sqrt(spread / count) / mean,
           sqrt(sum->estimated / sum->length), sqrt(sum->squared_distance / sum->length),
           sqrt(sum->squared_relative / count), sum->right / count);
}

/* Adds one of the truth's bakes to their mean. */
static void truth_add(elements *mean, const elements *one)
{
    mean->count = one->count;
    for (size_t i = 0; i < one->count; ++i) {
        mean->light[i] += one->light[i] / TRUTH_SEEDS;
        for (int c = 0; c < 3; ++c) {
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                mean->moments[i].channel[c].c[k] += one->moments[i].channel[c].c[k] / TRUTH_SEEDS;
            }
        }
    }
}

/* The mean's squared length, and its squared error from how far each of its bakes is from it. */
static void truth_finish(elements *mean, const baked_light one[TRUTH_SEEDS], int kind)
{
    const lmb_sh3_rgb dark = {.channel = {{.c = {0.0f}}}};
    for (size_t i = 0; i < mean->count; ++i) {
        mean->squared_length += moments_distance_squared(&mean->moments[i], &dark);
        for (int seed = 0; seed < TRUTH_SEEDS; ++seed) {
            mean->squared_error += moments_distance_squared(&mean->moments[i], &one[seed].kind[kind].moments[i]) /
                                   (TRUTH_SEEDS * (TRUTH_SEEDS - 1));
        }
    }
}

static lmb_result truth_bake(quality_work *work)
{
    baked_light one[TRUTH_SEEDS] = {{.samples = 0.0}};
    lmb_bake *bake = &work->bake;
    const lmb_gather_effort effort = {.samples = work->truth_samples / TRUTH_SEEDS};
    lmb_result result = light_allocate(bake, &work->truth) ? LMB_OK : LMB_ERROR_MEMORY;
    for (int seed = 0; seed < TRUTH_SEEDS && result == LMB_OK; ++seed) {
        result = light_bake(bake, &effort, FIRST_TRUTH_SEED + (uint64_t)seed, &one[seed]);
    }
    for (int kind = 0; kind < KINDS && result == LMB_OK; kind += TEXELS) {
        for (int seed = 0; seed < TRUTH_SEEDS; ++seed) {
            truth_add(&work->truth.kind[kind], &one[seed].kind[kind]);
        }
        truth_finish(&work->truth.kind[kind], one, kind);
    }
    for (int seed = 0; seed < TRUTH_SEEDS; ++seed) {
        light_free(&one[seed]);
    }
    return result;
}

static bool effort_of(const lmb_bake *bake, const char *name, lmb_gather_effort *effort)
{
    lmb_bake_settings settings = bake->record.settings;
    char *end;
    const unsigned long samples = strtoul(name, &end, 10);
    if (end != name && *end == '\0' && samples > 0 && samples < 1u << 28) {
        settings.samples = settings.max_samples = (uint32_t)samples;
    } else if (!lmb_bake_settings_quality(&settings, name)) {
        return false;
    }
    *effort = lmb_bake_effort(&settings, bake->level);
    return true;
}

static lmb_result effort_measure(quality_work *work, const char *name, const lmb_gather_effort *effort)
{
    comparison sum[KINDS] = {{.off = 0.0}};
    double samples = 0.0, seconds = 0.0, denoise_seconds = 0.0;
    lmb_result result = LMB_OK;
    for (int seed = 0; seed < work->seeds && result == LMB_OK; ++seed) {
        baked_light light;
        result = light_bake(&work->bake, effort, work->bake.level->transport.seed + (uint64_t)seed, &light);
        for (int kind = 0; kind < KINDS && result == LMB_OK; ++kind) {
            const int plain = kind < TEXELS ? PROBES : TEXELS;
            elements_compare(&light.kind[kind], &work->truth.kind[plain], effort->floor, &sum[kind]);
        }
        samples += light.samples / work->seeds;
        seconds += light.seconds / work->seeds;
        denoise_seconds += light.denoise_seconds / work->seeds;
        light_free(&light);
    }
    if (result == LMB_OK) {
        printf("%s\t%.1f\t%.3f\t%.3f", name, samples, seconds, denoise_seconds);
        for (int kind = 0; kind < KINDS; ++kind) {
            comparison_print(&sum[kind]);
        }
        printf("\n");
        fflush(stdout);
    }
    return result;
}

static lmb_result quality_run(quality_work *work, lmb_error *error)
{
    lmb_bake *bake = &work->bake;
    lmb_result result = lmb_bake_place(bake, error);
    if (result == LMB_OK) {
        result = lmb_bake_layout(bake, error);
    }
    if (result == LMB_OK) {
        result = lmb_bake_surface(bake, error);
    }
    if (result == LMB_OK) {
        result = truth_bake(work);
    }
    if (result == LMB_OK) {
        printf("# %zu probes, %zu texels, standard error of the truth %.5f and %.5f\n", work->truth.kind[PROBES].count,
               work->truth.kind[TEXELS].count,
               lmb_relative_error(work->truth.kind[PROBES].squared_error, work->truth.kind[PROBES].squared_length),
               lmb_relative_error(work->truth.kind[TEXELS].squared_error, work->truth.kind[TEXELS].squared_length));
    }
    char *rest = NULL;
    for (char *name = strtok_r(work->efforts, ",", &rest); name && result == LMB_OK;
         name = strtok_r(NULL, ",", &rest)) {
        lmb_gather_effort effort;
        result = effort_of(bake, name, &effort)
                     ? effort_measure(work, name, &effort)
                     : lmb_error_set(error, LMB_ERROR_ARGUMENT, "--efforts: '%s' is no quality and no number", name);
    }
    return result;
}

int main(int count, char **values)
{
    quality_work work = {.truth_samples = 4096, .seeds = 1};
    char efforts[256] = "draft,medium,high,64,256";
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "lambent_quality", usage);
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.lightmaps = true;
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (bake_argument(&settings, &arguments, argument)) {
            continue;
        }
        if (strcmp(argument, "--truth") == 0) {
            work.truth_samples = (uint32_t)arguments_integer(&arguments, argument, 4, 1 << 28);
        } else if (strcmp(argument, "--seeds") == 0) {
            work.seeds = (int)arguments_integer(&arguments, argument, 1, 1000);
        } else if (strcmp(argument, "--efforts") == 0) {
            snprintf(efforts, sizeof efforts, "%s", arguments_text(&arguments, argument));
        } else {
            arguments_error(&arguments, "unexpected argument", argument);
        }
    }
    if (arguments.failed || arguments.help || !settings.level.path) {
        fputs(usage, stderr);
        return 2;
    }
    work.efforts = efforts;
    lmb_error error = {{0}};
    lmb_level level;
    const lmb_warnings warnings = console_warnings(arguments.quiet);
    lmb_result result = lmb_level_open(&settings.level, &warnings, NULL, &level, &error);
    if (result == LMB_OK) {
        work.bake = lmb_bake_begin(&settings, &level, NULL);
        result = quality_run(&work, &error);
        lmb_bake_end(&work.bake);
        light_free(&work.truth);
        lmb_level_close(&level);
    }
    return result == LMB_OK ? 0 : command_fail(result, &error);
}
