/* What storing a lightmap in few bytes costs:
 *
 *     textures LEVEL -o DIR [level options] [--texels-per-m N] [--samples N] [--points N] [--reference N]
 *
 * Gathers the level's texels once, denoises them, and stores them in each way: as halfs, in 8 bits a channel, and
 * compressed, by files in DIR that are read back. What comes back is filtered and evaluated at random points of the
 * level's surfaces on 8 normals each, beside the same texels in floats, the figures of `lambent check`, of all points
 * and of those at the borders of charts; beside SH3 of each texel, filtered, which knows its colours and all of its
 * directions; and beside the path tracer, free of its noise. The direct light of key lights is in none. One line for
 * each way, tabs between. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/bake_level.h>
#include <lambent/file.h>
#include <lambent/lightmap.h>
#include <lambent/opaque_surface.h>
#include <lambent/surface.h>

#include "check_statistics.h"
#include "command.h"
#include "cpu_time.h"
#include "level_arguments.h"
#include "lightmap/lightmap_textures.h"
#include "textures_eight_bits.h"
#include "textures_reference.h"

static const char usage[] =
    "usage: textures LEVEL -o DIR [options]\n"
    "\n"
    "  -o DIR                a folder that is there, for the files\n"
    "  --texels-per-m N      lightmap density (default: from the level's size)\n"
    "  --samples N           at each texel at most (default 512)\n"
    "  --points N            on surfaces (default 8000)\n"
    "  --reference N         samples of each half of the path tracer's light (default 256)\n"
    "  --model NAME          measure this one too, in textures if they hold it (repeatable)\n" LEVEL_USAGE;

enum { NORMALS = CHECK_NORMALS };

/* Which of the lightmap's models a way stores: its own, the format's, SH3 to compare with. */
enum { OWN = -1, DISC, TRUTH, OTHERS };

typedef struct textures {
    lmb_level level;
    lmb_lightmap *lightmap;
    lmb_shared_arguments shared; /* LEVEL, and the folder that is written */
    float texels_per_m;
    uint32_t samples, points, reference;
    textures_point *point;
    const lmb_model *asked[LMB_LIGHTMAP_MOST_MODELS - OTHERS];
    int asked_count;
    lmb_rgb (*own)[NORMALS];   /* [point] by floats of the lightmap's own model */
    lmb_rgb (*truth)[NORMALS]; /* and by SH3 */
    bool *mapped, *border;     /* at the border of a chart: filtering reads a dilated texel */
} textures;

/* A way of storing: makes of an image's planes what comes back, in new ones, and counts bytes. */
typedef struct storing_way {
    const char *name;
    int model; /* OTHERS on: those that are named on the command line */
    lmb_result (*store)(textures *work, int32_t image, const struct storing_way *way, float *plane, uint64_t *bytes,
                        lmb_error *error);
    eight_bits colour;          /* of store_bytes */
    lmb_lightmap_format format; /* of store_textures */
} storing_way;

static const lmb_model *model_of(const textures *work, int which)
{
    return which == OWN ? work->lightmap->model : work->lightmap->settings.other[which];
}

static float *planes_of(const lmb_lightmap_image *image, int which)
{
    return which == OWN ? image->plane : image->other[which];
}

static size_t texels_of(const lmb_lightmap_image *image)
{
    return (size_t)image->width * (size_t)image->height;
}

static lmb_result store_floats(textures *work, int32_t image, const storing_way *way, float *plane, uint64_t *bytes,
                               lmb_error *error)
{
    (void)plane;
    (void)error;
    *bytes += 4 * texels_of(&work->lightmap->image[image]) * (uint64_t)model_of(work, way->model)->channel_count;
    return LMB_OK;
}

static lmb_result store_halfs(textures *work, int32_t image, const storing_way *way, float *plane, uint64_t *bytes,
                              lmb_error *error)
{
    (void)error;
    const size_t count = texels_of(&work->lightmap->image[image]) * (size_t)model_of(work, way->model)->channel_count;
    for (size_t i = 0; i < count; ++i) {
        plane[i] = half_rounded(plane[i]);
    }
    *bytes += 2 * count;
    return LMB_OK;
}

/* Four bytes of light, and one for each other channel, of the range that the model's parts have. */
static lmb_result store_bytes(textures *work, int32_t image, const storing_way *way, float *plane, uint64_t *bytes,
                              lmb_error *error)
{
    (void)error;
    const size_t texels = texels_of(&work->lightmap->image[image]);
    lmb_texture_part parts[LMB_TEXTURE_MOST_PARTS];
    const int count = lmb_lightmap_textures_parts(model_of(work, way->model), LMB_LIGHTMAP_KTX2, parts);
    for (int i = 0; i < count; ++i) {
        float *const first = plane + (size_t)parts[i].first * texels;
        if (parts[i].light) {
            eight_bits_light(way->colour, first, texels);
            *bytes += 4 * texels;
        } else {
            eight_bits_range(first, texels * (size_t)parts[i].count, parts[i].low[0], parts[i].high[0]);
            *bytes += texels * (uint64_t)parts[i].count;
        }
    }
    return LMB_OK;
}

static lmb_result store_textures(textures *work, int32_t image, const storing_way *way, float *plane, uint64_t *bytes,
                                 lmb_error *error)
{
    const lmb_lightmap_image *of = &work->lightmap->image[image];
    const lmb_model *model = model_of(work, way->model);
    lmb_texture_part parts[LMB_TEXTURE_MOST_PARTS];
    work->lightmap->settings.format = way->format;
    const int count = lmb_lightmap_textures_parts(model, way->format, parts);
    lmb_result result = LMB_OK;
    for (int i = 0; i < count && result == LMB_OK; ++i) {
        char name[LMB_LIGHTMAP_FILE_NAME];
        lmb_lightmap_textures_name(work->lightmap, model, &parts[i], image, name);
        char *path = lmb_file_in(work->shared.output, name);
        const float scale = lmb_lightmap_textures_scale(of, plane, &parts[i]);
        result = path ? lmb_lightmap_textures_write(work->lightmap, image, plane, &parts[i], path, error)
                      : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
        if (result == LMB_OK) {
            result = lmb_lightmap_textures_read(of, scale, &parts[i], path, plane, error);
        }
        const uint64_t per_block = parts[i].format == LMB_BLOCK_BC4 ? 8 : 16;
        *bytes += texels_of(of) * (uint64_t)parts[i].layers * per_block / 16;
        free(path);
    }
    return result;
}

static const storing_way ways[] = {
    {.name = "floats, direction in space", .model = OWN, .store = store_floats},
    {.name = "halfs, direction in space", .model = OWN, .store = store_halfs},
    {.name = "floats, direction on the disc", .model = DISC, .store = store_floats},
    {"RGBM8 and 8 bits, direction in space", OWN, store_bytes, EIGHT_BITS_MULTIPLIER, LMB_LIGHTMAP_EXR},
    {"RGBE9995 and 8 bits, direction in space", OWN, store_bytes, EIGHT_BITS_SHARED_EXPONENT, LMB_LIGHTMAP_EXR},
    {"RGBE9995 and 8 bits, direction on the disc", DISC, store_bytes, EIGHT_BITS_SHARED_EXPONENT, LMB_LIGHTMAP_EXR},
    {.name = "BC6H, BC4 and three BC4, direction in space",
     .model = OWN,
     .store = store_textures,
     .format = LMB_LIGHTMAP_KTX2},
    {.name = "BC6H, BC4 and BC5, direction on the disc",
     .model = DISC,
     .store = store_textures,
     .format = LMB_LIGHTMAP_KTX2},
    {.name = "two of ASTC, direction on the disc",
     .model = DISC,
     .store = store_textures,
     .format = LMB_LIGHTMAP_KTX2_ASTC},
};

static bool reads_dilated(const lmb_lightmap *lightmap, const lmb_hit *hit)
{
    lmb_lightmap_footprint footprint;
    lmb_lightmap_footprint_find(lightmap, hit, &footprint);
    bool dilated = false;
    for (int k = 0; k < LMB_FOOTPRINT; ++k) {
        dilated = dilated || (footprint.weight[k] > 0.0f &&
                              lightmap->image[footprint.image].state[footprint.pixel[k]] == LMB_TEXEL_DILATED);
    }
    return dilated;
}

/* The irradiance of a model's planes at every point. The lightmap takes them for its own meanwhile. */
static void light_evaluate(textures *work, const lmb_model *model, float *const *planes, lmb_rgb (*light)[NORMALS])
{
    lmb_lightmap *lightmap = work->lightmap;
    const lmb_model *own_model = lightmap->model;
    float *own[64];
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        own[i] = lightmap->image[i].plane;
        lightmap->image[i].plane = planes[i];
    }
    lightmap->model = model;
    for (uint32_t p = 0; p < work->points; ++p) {
        const lmb_hit *hit = &work->point[p].hit;
        const lmb_vec3 n_v = lmb_trace_place(work->level.tracer, hit).shading_normal;
        float channel[LMB_MODEL_MOST_CHANNELS];
        work->mapped[p] = lmb_lightmap_sample(lightmap, hit, channel);
        work->border[p] = work->mapped[p] && reads_dilated(lightmap, hit);
        model->evaluate(channel, n_v, work->point[p].normal, NORMALS, light[p]);
    }
    lightmap->model = own_model;
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        lightmap->image[i].plane = own[i];
    }
}

/* `reference` NULL: the path tracer. */
static void summary_print(const textures *work, const bool *has, lmb_rgb (*light)[NORMALS],
                          lmb_rgb (*reference)[NORMALS])
{
    point_error *const errors = calloc(work->points, sizeof *errors);
    error_summary summary = {0};
    for (uint32_t p = 0; errors && p < work->points; ++p) {
        const textures_point *at = &work->point[p];
        errors[p] = reference ? point_error_of(light[p], reference[p], reference[p], NORMALS)
                              : point_error_of(light[p], at->half[0].at, at->half[1].at, NORMALS);
    }
    if (errors && error_summarize(errors, has, work->points, &summary) == LMB_OK) {
        printf("\t%.3f\t%.3f\t%.3f\t%.3f", 100.0 * summary.rel_rmse, 100.0 * summary.median, 100.0 * summary.p95,
               100.0 * summary.share_over_10pct);
    }
    free(errors);
}

static float *planes_copy(const lmb_lightmap_image *image, int which, const lmb_model *model, int keys)
{
    const size_t count = texels_of(image) * (size_t)(model->channel_count + keys);
    float *const copy = malloc((count + 1) * sizeof *copy);
    if (copy) {
        memcpy(copy, planes_of(image, which), count * sizeof *copy);
    }
    return copy;
}

static lmb_result way_measure(textures *work, const storing_way *way, lmb_error *error)
{
    const lmb_lightmap *lightmap = work->lightmap;
    const lmb_model *model = model_of(work, way->model);
    float *planes[64] = {NULL};
    uint64_t bytes = 0, texels = 0;
    lmb_result result = LMB_OK;
    const double start = cpu_time_of_process();
    for (int32_t i = 0; i < lightmap->image_count && result == LMB_OK; ++i) {
        planes[i] = planes_copy(&lightmap->image[i], way->model, model, (int)lightmap->key_light_count);
        result = planes[i] ? way->store(work, i, way, planes[i], &bytes, error) : LMB_ERROR_MEMORY;
        texels += texels_of(&lightmap->image[i]);
    }
    const double seconds = cpu_time_of_process() - start;
    lmb_rgb(*light)[NORMALS] = calloc(work->points, sizeof *light);
    if (result == LMB_OK && light) {
        light_evaluate(work, model, planes, light);
        printf("%s\t%.3g\t%.3f\t%.3f", way->name, (double)bytes / (double)texels, seconds,
               1e-6 * (double)texels / seconds);
        summary_print(work, work->mapped, light, work->own);
        summary_print(work, work->border, light, work->own);
        summary_print(work, work->mapped, light, work->truth);
        summary_print(work, work->mapped, light, NULL);
        putchar('\n');
        fflush(stdout);
    }
    free(light);
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        free(planes[i]);
    }
    return result;
}

static lmb_result texels_bake(textures *work, lmb_error *error)
{
    lmb_lightmap_settings settings = lmb_lightmap_settings_default(work->level.scene);
    settings.texels_per_m = work->texels_per_m > 0.0f ? work->texels_per_m : settings.texels_per_m;
    settings.other[DISC] = lmb_model_default(LMB_MODEL_FOR_TEXTURE);
    settings.other[TRUTH] = lmb_model_for_lightmap("sh3");
    for (int i = 0; i < work->asked_count; ++i) {
        settings.other[OTHERS + i] = work->asked[i];
    }
    settings.pool = work->level.pool;
    lmb_result result = lmb_lightmap_create(work->level.scene, &settings, &work->lightmap, error);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_gather_effort effort = {.samples = 64, .max_samples = work->samples, .tolerance = 0.06};
    lmb_texel_list *list;
    result = lmb_texel_list_create(work->lightmap, &work->level.transport, &effort, &list);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_gather_list all = lmb_texel_list_elements(list);
    const lmb_gather_job job = lmb_gather_job_all(&work->level.transport, &all, &effort);
    lmb_gathered *gathered = malloc((all.count + 1) * sizeof *gathered);
    lmb_gather_stats stats;
    result = gathered ? lmb_gather_elements(&job, work->level.pool, NULL, gathered, &stats) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = lmb_texel_list_denoise(list, work->level.pool, NULL, gathered);
    }
    if (result == LMB_OK) {
        result = lmb_texel_list_finish(list, gathered, work->level.pool, work->lightmap);
    }
    free(gathered);
    lmb_texel_list_destroy(list);
    return result;
}

static lmb_result points_make(textures *work)
{
    lmb_opaque_surface surface;
    const lmb_result result = lmb_opaque_surface_create(work->level.tracer, &surface);
    if (result != LMB_OK) {
        return result;
    }
    for (uint32_t p = 0; p < work->points; ++p) {
        textures_point_make(&surface, p, work->points, &work->point[p]);
    }
    lmb_opaque_surface_free(&surface);
    return LMB_OK;
}

/* Once `truth` is known, whose mean says what is dark. */
static lmb_result reference_make(textures *work)
{
    double mean = 0.0;
    for (uint32_t p = 0; p < work->points; ++p) {
        const lmb_rgb light = work->truth[p][0];
        mean += (double)(light.c[0] + light.c[1] + light.c[2]) / (3.0 * work->points);
    }
    lmb_transport transport = work->level.transport;
    transport.surface = NULL;
    const check_reference reference = {
        .transport = &transport, .samples = work->reference, .mean_light = mean, .without_keys = true};
    return textures_reference_gather(work->lightmap, &reference, work->level.pool, work->point, work->points);
}

static lmb_result run(textures *work, const lmb_level_settings *settings, lmb_error *error)
{
    lmb_result result = lmb_level_open(settings, NULL, NULL, &work->level, error);
    if (result != LMB_OK) {
        return result;
    }
    result = lmb_level_solve(&work->level, LMB_ESTIMATOR_CACHED, NULL, error);
    const double start = cpu_time_of_process();
    if (result == LMB_OK) {
        result = texels_bake(work, error);
    }
    const double gathered = cpu_time_of_process() - start;
    if (result == LMB_OK) {
        result = points_make(work);
    }
    if (result == LMB_OK) {
        const lmb_lightmap *lightmap = work->lightmap;
        float *own[64], *truth[64];
        for (int32_t i = 0; i < lightmap->image_count; ++i) {
            own[i] = lightmap->image[i].plane;
            truth[i] = lightmap->image[i].other[TRUTH];
        }
        printf("%s: %llu texels covered, %.1f %% of %d images, gathered in %.1f CPU s\n", settings->path,
               (unsigned long long)lightmap->covered_texel_count, 100.0 * lmb_lightmap_texels_used(lightmap),
               (int)lightmap->image_count, gathered);
        size_t at_borders = 0;
        light_evaluate(work, lightmap->model, own, work->own);
        light_evaluate(work, lightmap->settings.other[TRUTH], truth, work->truth);
        result = reference_make(work);
        for (uint32_t p = 0; p < work->points; ++p) {
            at_borders += work->border[p];
        }
        printf("%zu of %u points at borders of charts\n", at_borders, work->points);
        printf("way\tbytes a texel\tCPU s\tMtexel/s\trel_rmse %%\tmedian\tp95\tover 10 %%\tat borders: rel_rmse "
               "%%\tmedian\tp95\tover 10 %%\tbeside SH3: rel_rmse %%\tmedian\tp95\tover 10 %%\t"
               "beside the path tracer: rel_rmse %%\tmedian\tp95\tover 10 %%\n");
    }
    for (size_t i = 0; i < sizeof ways / sizeof ways[0] && result == LMB_OK; ++i) {
        result = lmb_lightmap_textures_are_here(ways[i].format) ? way_measure(work, &ways[i], error) : LMB_OK;
    }
    for (int i = 0; i < work->asked_count && result == LMB_OK; ++i) {
        char name[96];
        const lmb_model *model = work->asked[i];
        const bool fits = lmb_lightmap_textures_hold(model);
        snprintf(name, sizeof name, "%s%s", model->name, fits ? ", textures" : ", halfs");
        const storing_way way = {.name = name,
                                 .model = OTHERS + i,
                                 .store = fits ? store_textures : store_halfs,
                                 .format = LMB_LIGHTMAP_KTX2};
        result = way_measure(work, &way, error);
    }
    lmb_lightmap_destroy(work->lightmap);
    lmb_level_close(&work->level);
    return result;
}

static void model_add(textures *work, lmb_arguments *arguments, const char *name)
{
    const lmb_model *model = arguments->failed ? NULL : lmb_model_for_lightmap(name);
    if (!model || work->asked_count == (int)(sizeof work->asked / sizeof work->asked[0])) {
        arguments_error(arguments, "no lightmap has the model", name);
        return;
    }
    work->asked[work->asked_count++] = model;
}

int main(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "textures", usage);
    lmb_level_settings settings = lmb_level_settings_default();
    textures work = {
        .shared = {.path_name = {"LEVEL"}, .output_name = "DIR"}, .samples = 512, .points = 8000, .reference = 256};
    for (const char *next; (next = arguments_next(&arguments));) {
        if (strcmp(next, "--texels-per-m") == 0) {
            work.texels_per_m = (float)arguments_number(&arguments, next, 1e-6, 1e6);
        } else if (strcmp(next, "--samples") == 0) {
            work.samples = (uint32_t)arguments_integer(&arguments, next, 64, 1 << 20);
        } else if (strcmp(next, "--points") == 0) {
            work.points = (uint32_t)arguments_integer(&arguments, next, 1, 1000000);
        } else if (strcmp(next, "--reference") == 0) {
            work.reference = (uint32_t)arguments_integer(&arguments, next, 2, 1 << 20);
        } else if (strcmp(next, "--model") == 0) {
            model_add(&work, &arguments, arguments_text(&arguments, next));
        } else if (!level_argument(&settings, &arguments, next)) {
            arguments_shared(&arguments, next, &work.shared);
        }
    }
    if (!arguments_complete(&arguments, &work.shared)) {
        return arguments_status(&arguments);
    }
    settings.path = work.shared.path[0];
    work.point = calloc(work.points, sizeof *work.point);
    work.own = calloc(work.points, sizeof *work.own);
    work.truth = calloc(work.points, sizeof *work.truth);
    work.mapped = calloc(work.points, sizeof *work.mapped);
    work.border = calloc(work.points, sizeof *work.border);
    lmb_error error = {""};
    const lmb_result result = work.point && work.own && work.truth && work.mapped && work.border
                                  ? run(&work, &settings, &error)
                                  : LMB_ERROR_MEMORY;
    free(work.point);
    free(work.own);
    free(work.truth);
    free(work.mapped);
    free(work.border);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
