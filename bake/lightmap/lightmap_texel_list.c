/* Light of the covered texels: where it is gathered, and what becomes of it. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/denoise.h>
#include <lambent/occlusion.h>
#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "lightmap/lightmap_seams.h"
#include "trace/surface_internal.h"
#include "trace/trace_internal.h"

/* Texels are listed in squares of this side: a group of neighbours. */
enum { SQUARE = 8 };
_Static_assert(SQUARE *SQUARE == LMB_GATHER_GROUP, "a square is a group");
_Static_assert((int)LMB_GATHER_MOST_POINTS <= (int)LMB_RAY_BATCH, "their rays are one batch");

/* One covered texel of an instance's image. */
typedef struct listed_texel {
    uint32_t instance;
    uint32_t pixel;
    uint32_t triangle; /* the surface point that stands for it */
    float u, v;
} listed_texel;

struct lmb_texel_list {
    const lmb_lightmap *lightmap;
    const lmb_tracer *tracer;
    uint64_t seed;
    uint32_t points_per_texel;
    size_t count;
    listed_texel *texel;
};

static void instance_list(lmb_texel_list *list, uint32_t number, lmb_texel_source *source)
{
    const lmb_lightmap *lightmap = list->lightmap;
    const lmb_lightmap_region *region = &lightmap->region[number];
    const lmb_lightmap_image *image = &lightmap->image[region->image];
    const uint32_t mesh = lightmap->scene->instances[number].mesh;
    const lmb_texel_grid grid = lmb_lightmap_grid(lightmap, number);
    lmb_texels_cover(&lightmap->scene->meshes[mesh], lightmap->corner_uv[mesh], &grid, source);
    const int32_t columns = (grid.width + SQUARE - 1) / SQUARE, rows = (grid.height + SQUARE - 1) / SQUARE;
    for (int32_t i = 0; i < columns * rows * SQUARE * SQUARE; ++i) {
        const int32_t square = i / (SQUARE * SQUARE);
        const int32_t x = square % columns * SQUARE + i % SQUARE;
        const int32_t y = square / columns * SQUARE + i / SQUARE % SQUARE;
        if (x >= grid.width || y >= grid.height) {
            continue;
        }
        const lmb_texel_source *from = &source[(size_t)y * (size_t)grid.width + (size_t)x];
        if (from->triangle != LMB_TEXEL_UNCOVERED) {
            assert(list->count < lightmap->covered_texel_count);
            const uint32_t pixel = (uint32_t)(region->y + y) * (uint32_t)image->width + (uint32_t)(region->x + x);
            list->texel[list->count++] = (listed_texel){number, pixel, from->triangle, from->u, from->v};
        }
    }
}

static lmb_result texels_list(lmb_texel_list *list)
{
    const lmb_lightmap *lightmap = list->lightmap;
    lmb_texel_source *source = malloc(lmb_lightmap_largest_region(lightmap) * sizeof *source);
    if (!source) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        if (lightmap->region[i].image >= 0) {
            instance_list(list, i, source);
        }
    }
    free(source);
    return LMB_OK;
}

/* One for each block of samples. */
static uint32_t points_per_texel(const lmb_gather_effort *effort)
{
    const uint32_t samples = effort->samples > effort->max_samples ? effort->samples : effort->max_samples;
    const uint32_t blocks = samples / LMB_GATHER_BLOCK;
    return blocks < 1 ? 1 : blocks < LMB_GATHER_MOST_POINTS ? blocks : LMB_GATHER_MOST_POINTS;
}

lmb_result lmb_texel_list_create(const lmb_lightmap *lightmap, const lmb_transport *transport,
                                 const lmb_gather_effort *effort, lmb_texel_list **list)
{
    lmb_texel_list *created = calloc(1, sizeof *created);
    if (!created) {
        return LMB_ERROR_MEMORY;
    }
    created->lightmap = lightmap;
    created->tracer = transport->tracer;
    created->seed = transport->seed;
    created->points_per_texel = points_per_texel(effort);
    created->texel = malloc(((size_t)lightmap->covered_texel_count + 1) * sizeof *created->texel);
    const lmb_result result = created->texel ? texels_list(created) : LMB_ERROR_MEMORY;
    if (result != LMB_OK) {
        lmb_texel_list_destroy(created);
        return result;
    }
    *list = created;
    return LMB_OK;
}

void lmb_texel_list_destroy(lmb_texel_list *list)
{
    if (list) {
        free(list->texel);
        free(list);
    }
}

/* Keeps those of a texel's points that are on its middle's side of all walls, rather than in what stands on its
 * triangle. Returns how many. */
static uint32_t points_keep_open(const lmb_tracer *tracer, lmb_vec3 middle,
                                 lmb_gather_point points[LMB_GATHER_MOST_POINTS], uint32_t count, uint64_t *rays_traced)
{
    lmb_ray_batch rays;
    lmb_rgb share[LMB_RAY_BATCH];
    rays.count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        lmb_ray_batch_add(&rays, middle, lmb_vec3_sub(points[i].position, middle), LMB_TRACE_UP_TO_END);
    }
    lmb_trace_transmittance_batch(tracer, &rays, share, rays_traced);
    uint32_t open = 0;
    for (uint32_t i = 0; i < count; ++i) {
        if (lmb_rgb_max(share[i]) > 0.0f) {
            points[open++] = points[i];
        }
    }
    return open;
}

/* The points that a texel's light is the mean over, spread over its area; or one, where that was pushed out of a
 * solid. */
static void texel_site(const void *context, size_t element, lmb_gather_site *site)
{
    const lmb_texel_list *list = context;
    const lmb_lightmap *lightmap = list->lightmap;
    const listed_texel *texel = &list->texel[element];
    const lmb_lightmap_region *region = &lightmap->region[texel->instance];
    const lmb_hit at = {.instance = texel->instance, .triangle = texel->triangle, .u = texel->u, .v = texel->v};
    const lmb_place place = lmb_trace_place(list->tracer, &at);
    const lmb_gather_point middle = lmb_surface_gather_point(list->tracer, &place, region->texel_size, &site->moved);
    site->point[0] = middle;
    site->count = 1;
    if (site->moved) {
        return;
    }
    const uint32_t mesh = lightmap->scene->instances[texel->instance].mesh;
    const uint32_t width = (uint32_t)lightmap->image[region->image].width;
    const lmb_texel_grid grid = lmb_lightmap_grid(lightmap, texel->instance);
    const lmb_texel_spread spread = {.mesh = &lightmap->scene->meshes[mesh],
                                     .corner_uv = lightmap->corner_uv[mesh],
                                     .grid = &grid,
                                     .x = (int32_t)(texel->pixel % width) - region->x,
                                     .y = (int32_t)(texel->pixel / width) - region->y,
                                     .triangle = texel->triangle};
    float weights[LMB_GATHER_MOST_POINTS][2];
    const uint32_t count = lmb_texel_spread_points(&spread, lmb_stream_of_position(list->seed, middle.position),
                                                   list->points_per_texel, weights);
    lmb_vec3 position[LMB_GATHER_MOST_POINTS];
    lmb_trace_positions(list->tracer, texel->instance, texel->triangle, (const float(*)[2])weights, count, position);
    for (uint32_t i = 0; i < count; ++i) {
        site->point[i] = middle;
        site->point[i].position =
            trace_offset(position[i], place.geometric_normal, place.rounding, place.geometric_normal);
    }
    const uint32_t open = points_keep_open(list->tracer, middle.position, site->point, count, &site->rays);
    if (open == 0) {
        site->point[0] = middle;
    }
    site->count = open > 0 ? open : 1;
}

lmb_gather_list lmb_texel_list_elements(const lmb_texel_list *list)
{
    return (lmb_gather_list){.name = "lightmaps",
                             .count = list->count,
                             .most_points = list->points_per_texel,
                             .find_site = texel_site,
                             .context = list};
}

/* What one task takes of the list. */
enum { TEXELS_PER_TASK = 4096 };

static size_t task_count(const lmb_texel_list *list)
{
    return (list->count + TEXELS_PER_TASK - 1) / TEXELS_PER_TASK;
}

static size_t task_end(const lmb_texel_list *list, size_t task)
{
    const size_t end = (task + 1) * TEXELS_PER_TASK;
    return end < list->count ? end : list->count;
}

typedef struct points_work {
    const lmb_texel_list *list;
    lmb_denoise_point *points;
} points_work;

static void points_task(void *context, size_t task, int worker)
{
    (void)worker;
    const points_work *work = context;
    const lmb_texel_list *list = work->list;
    for (size_t i = task * TEXELS_PER_TASK; i < task_end(list, task); ++i) {
        const listed_texel *texel = &list->texel[i];
        const lmb_hit at = {.instance = texel->instance, .triangle = texel->triangle, .u = texel->u, .v = texel->v};
        const lmb_place place = lmb_trace_place(list->tracer, &at);
        const float texel_size = list->lightmap->region[texel->instance].texel_size;
        bool moved;
        const lmb_gather_point middle = lmb_surface_gather_point(list->tracer, &place, texel_size, &moved);
        work->points[i] = (lmb_denoise_point){middle.position, place.shading_normal, texel_size};
    }
}

lmb_result lmb_texel_list_denoise(const lmb_texel_list *list, lmb_pool *pool, const lmb_progress *progress,
                                  lmb_gathered *gathered)
{
    lmb_denoise_point *const points = malloc((list->count + 1) * sizeof *points);
    if (!points) {
        return LMB_ERROR_MEMORY;
    }
    points_work work = {list, points};
    lmb_result result = lmb_pool_run(pool, task_count(list), points_task, &work, "denoise", NULL);
    if (result == LMB_OK) {
        result = lmb_denoise(points, list->count, list->tracer, pool, progress, gathered);
    }
    free(points);
    return result;
}

/* What tasks encode. */
typedef struct finish_work {
    const lmb_texel_list *list;
    const lmb_gathered *gathered;
    lmb_lightmap *lightmap;
    double dark; /* errors are relative to no less, a squared length */
} finish_work;

/* Of 1 % of the root mean square. */
static double dark_length(const lmb_gathered *gathered, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        sum += gathered[i].squared_light;
    }
    return count > 0 ? 1e-4 * sum / (double)count : 0.0;
}

static void texel_encode(const finish_work *work, const listed_texel *texel, const lmb_gathered *gathered)
{
    const lmb_texel_list *list = work->list;
    lmb_lightmap *lightmap = work->lightmap;
    const lmb_hit at = {.instance = texel->instance, .triangle = texel->triangle, .u = texel->u, .v = texel->v};
    const lmb_vec3 normal = lmb_trace_place(list->tracer, &at).shading_normal;
    lmb_sh3_rgb radiance;
    for (int c = 0; c < 3; ++c) {
        radiance.channel[c] = lmb_sh3_fit_hemisphere(&gathered->moments.channel[c], normal);
    }
    lmb_lightmap_image *image = &lightmap->image[lightmap->region[texel->instance].image];
    float channel[LMB_MODEL_MOST_CHANNELS];
    lightmap->model->encode(&radiance, normal, 0.0f, channel);
    for (int c = 0; c < lightmap->model->channel_count; ++c) {
        lmb_lightmap_plane(image, c)[texel->pixel] = channel[c];
    }
    for (uint32_t key = 0; key < lightmap->key_light_count; ++key) {
        lmb_lightmap_plane(image, lightmap->model->channel_count + (int)key)[texel->pixel] =
            gathered->key_visibility[key];
    }
    if (image->error) {
        const double length = fmax(gathered->squared_light, work->dark);
        image->error[texel->pixel] = (float)lmb_relative_error(gathered->squared_error, length);
    }
    image->state[texel->pixel] = LMB_TEXEL_GATHERED;
}

static void images_clear(lmb_lightmap *lightmap)
{
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        lmb_lightmap_image *image = &lightmap->image[i];
        const size_t texels = (size_t)image->width * (size_t)image->height;
        memset(image->plane, 0, (size_t)lmb_lightmap_plane_count(lightmap) * texels * sizeof *image->plane);
        memset(image->state, LMB_TEXEL_EMPTY, texels);
        if (image->error) {
            memset(image->error, 0, texels * sizeof *image->error);
        }
    }
}

static void encode_task(void *context, size_t task, int worker)
{
    (void)worker;
    const finish_work *work = context;
    for (size_t i = task * TEXELS_PER_TASK; i < task_end(work->list, task); ++i) {
        texel_encode(work, &work->list->texel[i], &work->gathered[i]);
    }
}

/* The luminance of all texels, [image][pixel]; NULL: no memory. */
static float **luminance_keep(const lmb_lightmap *lightmap)
{
    size_t texels = 0;
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        texels += (size_t)lightmap->image[i].width * (size_t)lightmap->image[i].height;
    }
    float **const kept = malloc(((size_t)lightmap->image_count + 1) * sizeof *kept);
    float *next = kept ? malloc((texels + 1) * sizeof *next) : NULL;
    if (!next) {
        free(kept);
        return NULL;
    }
    kept[0] = next;
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        const lmb_lightmap_image *image = &lightmap->image[i];
        const size_t count = (size_t)image->width * (size_t)image->height;
        const float *const r = lmb_lightmap_plane(image, 0), *const g = lmb_lightmap_plane(image, 1);
        const float *const b = lmb_lightmap_plane(image, 2);
        kept[i] = next;
        for (size_t k = 0; k < count; ++k) {
            *next++ = lmb_luminance(lmb_rgb_of(r[k], g[k], b[k]));
        }
    }
    return kept;
}

/* Closes seams, and sees that neither this nor filtering makes light. */
static lmb_result seams_close(lmb_lightmap *lightmap, const lmb_tracer *tracer, lmb_pool *pool)
{
    lmb_seams seams;
    float **const held = luminance_keep(lightmap);
    lmb_result result = held ? lmb_seams_find(lightmap, tracer, &seams) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = lmb_seams_measure(&seams, lightmap, &lightmap->open);
        if (result == LMB_OK) {
            result = lmb_seams_close(&seams, pool, lightmap);
        }
        if (result == LMB_OK) {
            result = lmb_lightmap_limit(lightmap, held, tracer, pool);
        }
        if (result == LMB_OK) {
            result = lmb_seams_measure(&seams, lightmap, &lightmap->closed);
        }
        lmb_seams_free(&seams);
    }
    if (held) {
        free(held[0]);
    }
    free(held);
    return result;
}

/* In the model that the lightmap has now. */
static lmb_result model_finish(finish_work *work, lmb_pool *pool)
{
    images_clear(work->lightmap);
    lmb_result result = lmb_pool_run(pool, task_count(work->list), encode_task, work, "encode", NULL);
    if (result == LMB_OK) {
        result = lmb_lightmap_dilate(work->lightmap);
    }
    return result == LMB_OK ? seams_close(work->lightmap, work->list->tracer, pool) : result;
}

/* Puts another model in the place of the lightmap's own, or that back. */
static void model_swap(lmb_lightmap *lightmap, int other, const lmb_model *model)
{
    lightmap->model = model;
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        lmb_lightmap_image *image = &lightmap->image[i];
        float *const plane = image->plane;
        image->plane = image->other[other];
        image->other[other] = plane;
    }
}

lmb_result lmb_texel_list_finish(const lmb_texel_list *list, const lmb_gathered *gathered, lmb_pool *pool,
                                 lmb_lightmap *lightmap)
{
    finish_work work = {list, gathered, lightmap, dark_length(gathered, list->count)};
    const lmb_model *const own = lightmap->model;
    const lmb_model *const *const other = lightmap->settings.other;
    lmb_result result = LMB_OK;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        lightmap->region[i].back = lmb_tracer_is_turned(list->tracer, i);
    }
    for (int k = 0; result == LMB_OK && k < LMB_LIGHTMAP_MOST_MODELS && other[k]; ++k) {
        model_swap(lightmap, k, other[k]);
        result = model_finish(&work, pool);
        model_swap(lightmap, k, own);
    }
    if (result == LMB_OK) {
        result = model_finish(&work, pool);
    }
    if (result != LMB_OK) {
        images_clear(lightmap);
    }
    return result;
}
