/* Light of the covered texels. */
#include "lightmap/lightmap_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/occlusion.h>
#include <lambent/sequence.h>

#include "base/rgb.h"
#include "base/vec3.h"
#include "trace/surface_internal.h"
#include "trace/trace_internal.h"

/* Texels are listed in squares of this side: a group of neighbours. */
enum { SQUARE = 8 };
_Static_assert(SQUARE *SQUARE == LMB_GATHER_GROUP, "a square is a group");

/* Places that a texel's light is the mean over. */
enum { MAX_POINTS = LMB_RAY_BATCH };

/* One covered texel of an instance's image. */
typedef struct bake_texel {
    uint32_t instance;
    uint32_t pixel;
} bake_texel;

/* Until its light is known, a texel holds the surface point that stands for it: levels have many millions of them. */
_Static_assert(sizeof(lmb_texel_source) <= sizeof(lmb_irradz), "a texel's source fits its light's place");

/* What one group has counted. */
typedef struct bake_count {
    uint64_t pushed_out;
    uint64_t samples;
    uint64_t rays;
    double squared_error;
    double squared_length;
} bake_count;

typedef struct bake_work {
    lmb_lightmap *lightmap;
    const lmb_transport *transport;
    const lmb_gather_effort *effort;
    uint32_t points_per_texel;
    size_t texel_count;
    bake_texel *texels;
    bake_count *counts;       /* [group] */
    lmb_gather_point *points; /* [worker] of a group's texels */
    lmb_sh3_rgb *moments;     /* [texel] what each has gathered; NULL: that is not kept */
} bake_work;

static void instance_list(bake_work *work, uint32_t number, lmb_texel_source *source)
{
    const lmb_lightmap *lightmap = work->lightmap;
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
            assert(work->texel_count < lightmap->covered_texel_count);
            const uint32_t pixel = (uint32_t)(region->y + y) * (uint32_t)image->width + (uint32_t)(region->x + x);
            work->texels[work->texel_count++] = (bake_texel){number, pixel};
            memcpy(&image->texel[pixel], from, sizeof *from);
        }
    }
}

static size_t region_largest(const lmb_lightmap *lightmap)
{
    size_t largest = 1;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const size_t texels = (size_t)lightmap->region[i].width * (size_t)lightmap->region[i].height;
        largest = texels > largest ? texels : largest;
    }
    return largest;
}

static lmb_result texels_list(bake_work *work)
{
    lmb_texel_source *source = malloc(region_largest(work->lightmap) * sizeof *source);
    if (!source) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < work->lightmap->scene->instance_count; ++i) {
        if (work->lightmap->region[i].image >= 0) {
            instance_list(work, i, source);
        }
    }
    free(source);
    return LMB_OK;
}

/* Keeps those of a texel's points that are on its middle's side of all walls, rather than in what stands on its
 * triangle. Returns how many. */
static uint32_t points_keep_open(const lmb_tracer *tracer, lmb_vec3 middle, lmb_gather_point points[MAX_POINTS],
                                 uint32_t count, uint64_t *rays_traced)
{
    lmb_ray_batch rays;
    lmb_rgb share[LMB_RAY_BATCH];
    rays.count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        lmb_ray_batch_add(&rays, middle, vec3_sub(points[i].position, middle), LMB_TRACE_UP_TO_END);
    }
    lmb_trace_transmittance_batch(tracer, &rays, share, rays_traced);
    uint32_t open = 0;
    for (uint32_t i = 0; i < count; ++i) {
        if (rgb_max(share[i]) > 0.0f) {
            points[open++] = points[i];
        }
    }
    return open;
}

/* The places that a texel's light is the mean over, spread over its area; or one, where that was pushed out of a
 * solid. Returns how many. */
static uint32_t texel_points(const bake_work *work, const bake_texel *texel, lmb_gather_point points[MAX_POINTS],
                             bake_count *count)
{
    const lmb_lightmap *lightmap = work->lightmap;
    const lmb_lightmap_region *region = &lightmap->region[texel->instance];
    const lmb_lightmap_image *image = &lightmap->image[region->image];
    const lmb_tracer *tracer = work->transport->tracer;
    lmb_texel_source source;
    memcpy(&source, &image->texel[texel->pixel], sizeof source);
    const lmb_place place = lmb_trace_place(
        tracer, &(lmb_hit){.instance = texel->instance, .triangle = source.triangle, .u = source.u, .v = source.v});
    bool pushed_out;
    const lmb_gather_point middle = lmb_surface_gather_point(tracer, &place, region->texel_size, &pushed_out);
    count->pushed_out += pushed_out;
    if (pushed_out) {
        points[0] = middle;
        return 1;
    }
    const uint32_t mesh = lightmap->scene->instances[texel->instance].mesh;
    const uint32_t width = (uint32_t)image->width;
    const lmb_texel_grid grid = lmb_lightmap_grid(lightmap, texel->instance);
    const uint64_t stream = lmb_stream_of_position(work->transport->seed, middle.position);
    float weights[MAX_POINTS][2];
    const uint32_t spread = lmb_texel_spread(
        &lightmap->scene->meshes[mesh], lightmap->corner_uv[mesh], &grid, (int32_t)(texel->pixel % width) - region->x,
        (int32_t)(texel->pixel / width) - region->y, source.triangle, stream, work->points_per_texel, weights);
    lmb_vec3 at[MAX_POINTS];
    lmb_trace_positions(tracer, texel->instance, source.triangle, (const float(*)[2])weights, spread, at);
    for (uint32_t i = 0; i < spread; ++i) {
        points[i] = middle;
        points[i].position = trace_offset(at[i], place.geometric_normal, place.rounding, place.geometric_normal);
    }
    const uint32_t open = points_keep_open(tracer, middle.position, points, spread, &count->rays);
    if (open == 0) {
        points[0] = middle;
    }
    return open > 0 ? open : 1;
}

static void texel_store(const bake_work *work, const bake_texel *texel, const lmb_gather_element *element,
                        bake_count *count)
{
    const lmb_vec3 normal = element->points[0].normal;
    const lmb_gathered *gathered = &element->gathered;
    lmb_sh3_rgb radiance;
    for (int c = 0; c < 3; ++c) {
        radiance.channel[c] = lmb_sh3_fit_hemisphere(&gathered->moments.channel[c], normal);
    }
    lmb_lightmap_image *image = &work->lightmap->image[work->lightmap->region[texel->instance].image];
    image->texel[texel->pixel] = lmb_irradz_encode(&radiance, normal, 0.0f);
    image->state[texel->pixel] = LMB_TEXEL_GATHERED;
    count->samples += gathered->samples;
    count->rays += gathered->rays;
    count->squared_error += gathered->squared_error;
    count->squared_length += gathered->squared_length;
}

static void group_task(void *context, size_t group, int worker)
{
    const bake_work *work = context;
    const size_t first = lmb_gather_group_first(work->texel_count, group);
    const uint32_t count = (uint32_t)(lmb_gather_group_first(work->texel_count, group + 1) - first);
    lmb_gather_point *points = work->points + (size_t)worker * LMB_GATHER_GROUP_MOST * MAX_POINTS;
    lmb_gather_element elements[LMB_GATHER_GROUP_MOST];
    for (uint32_t i = 0; i < count; ++i) {
        elements[i].points = points + (size_t)i * MAX_POINTS;
        elements[i].point_count =
            texel_points(work, &work->texels[first + i], points + (size_t)i * MAX_POINTS, &work->counts[group]);
    }
    lmb_gather_sh3_group(work->transport, work->effort, elements, count);
    for (uint32_t i = 0; i < count; ++i) {
        texel_store(work, &work->texels[first + i], &elements[i], &work->counts[group]);
        if (work->moments) {
            work->moments[first + i] = elements[i].gathered.moments;
        }
    }
}

static void images_clear(lmb_lightmap *lightmap)
{
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        lmb_lightmap_image *image = &lightmap->image[i];
        const size_t texels = (size_t)image->width * (size_t)image->height;
        memset(image->texel, 0, texels * sizeof *image->texel);
        memset(image->state, LMB_TEXEL_EMPTY, texels);
    }
}

static lmb_lightmap_stats counts_sum(const bake_work *work)
{
    lmb_lightmap_stats stats = {.texels = work->texel_count};
    for (size_t i = 0; i < lmb_gather_group_count(work->texel_count); ++i) {
        stats.pushed_out += work->counts[i].pushed_out;
        stats.samples += work->counts[i].samples;
        stats.rays += work->counts[i].rays;
        stats.squared_error += work->counts[i].squared_error;
        stats.squared_length += work->counts[i].squared_length;
    }
    return stats;
}

/* One for each block of samples. */
static uint32_t points_per_texel(const lmb_gather_effort *effort)
{
    const uint32_t samples = effort->samples > effort->max_samples ? effort->samples : effort->max_samples;
    const uint32_t blocks = samples / LMB_GATHER_BLOCK;
    return blocks < 1 ? 1 : blocks < MAX_POINTS ? blocks : MAX_POINTS;
}

lmb_result lmb_lightmap_bake(lmb_lightmap *lightmap, const lmb_transport *transport, const lmb_gather_effort *effort,
                             lmb_pool *pool, const lmb_progress *progress, lmb_lightmap_stats *stats)
{
    return lmb_lightmap_bake_moments(lightmap, transport, effort, pool, progress, NULL, stats);
}

lmb_result lmb_lightmap_bake_moments(lmb_lightmap *lightmap, const lmb_transport *transport,
                                     const lmb_gather_effort *effort, lmb_pool *pool, const lmb_progress *progress,
                                     lmb_sh3_rgb *moments, lmb_lightmap_stats *stats)
{
    const size_t texels = (size_t)lightmap->covered_texel_count;
    const size_t groups = lmb_gather_group_count(texels);
    const size_t workers = (size_t)lmb_pool_threads(pool);
    bake_work work = {
        .lightmap = lightmap,
        .transport = transport,
        .effort = effort,
        .points_per_texel = points_per_texel(effort),
        .texels = malloc((texels + 1u) * sizeof(bake_texel)),
        .counts = calloc(groups + 1u, sizeof(bake_count)),
        .moments = moments,
        .points = malloc(workers * LMB_GATHER_GROUP_MOST * MAX_POINTS * sizeof(lmb_gather_point)),
    };
    lmb_result result = LMB_ERROR_MEMORY;
    images_clear(lightmap);
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        lightmap->region[i].back = lmb_tracer_is_turned(transport->tracer, i);
    }
    if (work.texels && work.counts && work.points) {
        result = texels_list(&work);
    }
    if (result == LMB_OK) {
        result = lmb_pool_run(pool, groups, group_task, &work, "lightmaps", progress);
    }
    if (result == LMB_OK) {
        result = lmb_lightmap_dilate(lightmap);
    }
    if (result == LMB_OK) {
        result = lmb_lightmap_limit(lightmap, transport->tracer, pool);
    }
    if (result == LMB_OK) {
        *stats = counts_sum(&work);
    } else {
        images_clear(lightmap);
    }
    free(work.texels);
    free(work.counts);
    free(work.points);
    return result;
}

lmb_result lmb_lightmap_mark(lmb_lightmap *lightmap)
{
    lmb_texel_source *source = malloc(region_largest(lightmap) * sizeof *source);
    if (!source) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const lmb_lightmap_region *region = &lightmap->region[i];
        if (region->image < 0) {
            continue;
        }
        const lmb_lightmap_image *image = &lightmap->image[region->image];
        const uint32_t mesh = lightmap->scene->instances[i].mesh;
        const lmb_texel_grid grid = lmb_lightmap_grid(lightmap, i);
        lmb_texels_cover(&lightmap->scene->meshes[mesh], lightmap->corner_uv[mesh], &grid, source);
        const int32_t padding = lightmap->settings.padding;
        for (int32_t y = -padding; y < grid.height + padding; ++y) {
            for (int32_t x = -padding; x < grid.width + padding; ++x) {
                const bool covered = x >= 0 && y >= 0 && x < grid.width && y < grid.height &&
                                     source[(size_t)y * (size_t)grid.width + (size_t)x].triangle != LMB_TEXEL_UNCOVERED;
                const size_t at = (size_t)(region->y + y) * (size_t)image->width + (size_t)(region->x + x);
                image->state[at] = covered ? LMB_TEXEL_GATHERED : LMB_TEXEL_DILATED;
            }
        }
    }
    free(source);
    return LMB_OK;
}

static lmb_irradz irradz_mad(lmb_irradz sum, const lmb_irradz *texel, float weight)
{
    for (int c = 0; c < 3; ++c) {
        sum.irradiance_z.c[c] += weight * texel->irradiance_z.c[c];
    }
    sum.ambient_weight += weight * texel->ambient_weight;
    sum.direction = vec3_mad(sum.direction, texel->direction, weight);
    return sum;
}

lmb_irradz lmb_lightmap_sample(const lmb_lightmap *lightmap, uint32_t instance, uint32_t triangle, float u, float v)
{
    lmb_irradz sum = {{{0.0f, 0.0f, 0.0f}}, 0.0f, {0.0f, 0.0f, 0.0f}};
    const lmb_lightmap_region *region = &lightmap->region[instance];
    if (region->image < 0) {
        return sum;
    }
    const lmb_lightmap_image *image = &lightmap->image[region->image];
    const uint32_t number = lightmap->scene->instances[instance].mesh;
    const lmb_mesh *mesh = &lightmap->scene->meshes[number];
    const lmb_vec2 *own = lightmap->corner_uv[number];
    const lmb_vec2 a = lmb_texels_corner_uv(mesh, own, triangle, 0);
    const lmb_vec2 b = lmb_texels_corner_uv(mesh, own, triangle, 1);
    const lmb_vec2 c = lmb_texels_corner_uv(mesh, own, triangle, 2);
    const float w = 1.0f - u - v;
    const lmb_texel_grid grid = lmb_lightmap_grid(lightmap, instance);
    const double x = (double)(w * a.x + u * b.x + v * c.x) * grid.density - grid.shift_x + region->x - 0.5;
    const double y = (double)(w * a.y + u * b.y + v * c.y) * grid.density - grid.shift_y + region->y - 0.5;
    const double left = floor(x);
    const double top = floor(y);
    for (int k = 0; k < 4; ++k) {
        const int right = k & 1;
        const int below = k >> 1;
        const double column = fmin(fmax(left + right, 0.0), image->width - 1);
        const double row = fmin(fmax(top + below, 0.0), image->height - 1);
        const double weight = (right ? x - left : 1.0 - (x - left)) * (below ? y - top : 1.0 - (y - top));
        sum = irradz_mad(sum, &image->texel[(size_t)row * (size_t)image->width + (size_t)column], (float)weight);
    }
    return sum;
}
