/* Filtering must not make light.
 *
 * Of models that have a direction (lmb_model_direction), C_d = (1 - w) I_z / (n_v.d) is exact for the normal that a
 * texel was encoded for. Where it is decoded at another, in a chart that bends within a texel or between charts that
 * share one, n_v.d may be far smaller, and C_d far larger, than any light there is. So every piece of surface between
 * texel centres is tried here as it will be seen: filtered, decoded at its own normal, and its brightest direction
 * compared with those of the texels around it. Where it is too bright, d is stored short in the texels that it reads.
 * decoding trusts a d less whose n_v.d is below the model's `min_height`, so a length of min_height / (n_v.d) leaves a
 * texel's own decode as it is and lets no lower normal get more of C_d. What then still shines is taken off the
 * directional share 1 - w. I_z stays as it is. */
#include "lightmap/lightmap_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/surface.h>
#include <lambent/vector.h>

/* Rounding and the curve of a smooth surface may add this much. */
#define SLACK 1.002f

/* Texels around the four of a piece that tell, with them, how bright it may be. */
enum { AROUND = 1 };

/* What is known of a texel by itself, and what is to be done to it. */
typedef struct limit_texel {
    float height; /* n_v.d */
    float peak;   /* its brightest direction over I_z, >= 1 */
    bool shine;   /* it was part of a place that is too bright */
    float stored; /* length of d in the image */
    float length; /* and what it is to be, <= 1 */
    float lower;  /* what is taken off 1 - w */
} limit_texel;

/* What the looks at all pieces are for: lengths of d, twice since they change the filtered d too; then weights. */
typedef enum limit_stage { LIMIT_LENGTHS, LIMIT_LENGTHS_AGAIN, LIMIT_WEIGHTS } limit_stage;

/* One instance's texels with their gutter, row by row, and what is at hand of them. */
typedef struct limit_area {
    const lmb_tracer *tracer;
    const lmb_lightmap_image *image;
    const float *held; /* [pixel] */
    const lmb_model *model;
    const lmb_lightmap_region *region;
    uint32_t instance;
    int32_t padding; /* texels of the region's rim */
    int32_t stride;
    limit_texel *texel;
    limit_stage stage;
    uint32_t triangle;
    bool flat; /* the triangle has one normal, and that is */
    lmb_vec3 flat_normal;
    lmb_rgb brightest; /* direction of the texels around the piece */
} limit_area;

static limit_texel *area_limit(const limit_area *area, int32_t x, int32_t y)
{
    return &area->texel[(size_t)(y + area->padding) * (size_t)area->stride + (size_t)(x + area->padding)];
}

static bool area_has(const limit_area *area, int32_t x, int32_t y)
{
    return x >= -area->padding && y >= -area->padding && x < area->region->width + area->padding &&
           y < area->region->height + area->padding;
}

/* One channel of the texel. */
static float *area_value(const limit_area *area, int channel, int32_t x, int32_t y)
{
    const int32_t column = area->region->x + x;
    const int32_t row = area->region->y + y;
    return &lmb_lightmap_plane(area->image, channel)[(size_t)row * (size_t)area->image->width + (size_t)column];
}

static lmb_rgb area_light(const limit_area *area, int32_t x, int32_t y)
{
    return lmb_rgb_of(*area_value(area, 0, x, y), *area_value(area, 1, x, y), *area_value(area, 2, x, y));
}

/* A light of irradiance 1 at n_v. */
typedef struct unit_light {
    float ambient, directional;
    float height; /* n_v.d */
} unit_light;

static unit_light unit_light_decode(const limit_area *area, const float *channel, lmb_vec3 normal)
{
    unit_light unit;
    area->model->direction->decode(channel, normal, &unit.ambient, &unit.directional, &unit.height);
    return unit;
}

static unit_light texel_decode(const limit_area *area, int32_t x, int32_t y, lmb_vec3 normal)
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    for (int c = 0; c < area->model->channel_count; ++c) {
        channel[c] = *area_value(area, c, x, y);
    }
    return unit_light_decode(area, channel, normal);
}

/* The irradiance of the brightest direction: C_a (1 + n_v.n)/2 + C_d n.d is C_a/2 + n.(C_a/2 n_v + C_d d). */
static float unit_light_peak(const unit_light *light)
{
    const float half = 0.5f * light->ambient;
    return half + sqrtf(half * half + light->ambient * light->directional * light->height +
                        light->directional * light->directional);
}

/* The C_d at which the brightest direction has irradiance `peak` >= 1 and n_v still 1, with C_a = 1 - C_d (n_v.d): the
 * positive root of (1 - h^2) C_d^2 - (peak - 1) h C_d - peak (peak - 1) = 0. */
static float directional_at_peak(float peak, float height)
{
    const float squared_sine = 1.0f - height * height;
    if (!(squared_sine > 1e-6f)) {
        return INFINITY; /* all light along n_v: nothing is brighter than I_z */
    }
    const float excess = lmb_larger(peak - 1.0f, 0.0f);
    const float linear = excess * height;
    return (linear + sqrtf(linear * linear + 4.0f * squared_sine * peak * excess)) / (2.0f * squared_sine);
}

/* The four texels that one point reads. */
typedef struct limit_filter {
    float channel[LMB_MODEL_MOST_CHANNELS]; /* filtered */
    float weight[4];
} limit_filter;

static void filter_make(const limit_area *area, const lmb_texel_piece *piece, float x, float y, limit_filter *filter)
{
    const float weight[4] = {(1.0f - x) * (1.0f - y), x * (1.0f - y), (1.0f - x) * y, x * y};
    const float *upper = area_value(area, 0, piece->x, piece->y);
    const float *lower = upper + area->image->width;
    const size_t plane = (size_t)area->image->width * (size_t)area->image->height;
    for (int c = 0; c < area->model->channel_count; ++c, upper += plane, lower += plane) {
        filter->channel[c] = weight[0] * upper[0] + weight[1] * upper[1] + weight[2] * lower[0] + weight[3] * lower[1];
    }
    memcpy(filter->weight, weight, sizeof weight);
}

/* Per channel, the brightest direction of the texels around a piece. */
static lmb_rgb piece_brightest(const limit_area *area, const lmb_texel_piece *piece)
{
    lmb_rgb brightest = {{0.0f, 0.0f, 0.0f}};
    for (int32_t y = piece->y - AROUND; y <= piece->y + 1 + AROUND; ++y) {
        for (int32_t x = piece->x - AROUND; x <= piece->x + 1 + AROUND; ++x) {
            if (!area_has(area, x, y)) {
                continue;
            }
            const float peak = area_limit(area, x, y)->peak;
            const lmb_rgb i_z = area_light(area, x, y);
            for (int c = 0; c < 3; ++c) {
                brightest.c[c] = lmb_larger(brightest.c[c], peak * i_z.c[c]);
            }
        }
    }
    return brightest;
}

/* How much brighter than I_z the brightest direction may be. */
static float peak_allowed(lmb_rgb brightest, lmb_rgb i_z)
{
    float allowed = INFINITY;
    for (int c = 0; c < 3; ++c) {
        if (i_z.c[c] > 0.0f) {
            allowed = lmb_smaller(allowed, brightest.c[c] / i_z.c[c]);
        }
    }
    return lmb_larger(allowed, 1.0f);
}

static lmb_vec3 area_normal(const limit_area *area, double u, double v)
{
    if (area->flat) {
        return area->flat_normal;
    }
    return lmb_trace_place(
               area->tracer,
               &(lmb_hit){.instance = area->instance, .triangle = area->triangle, .u = (float)u, .v = (float)v})
        .shading_normal;
}

/* Takes off the texels' 1 - w what their filtered one has above `share` of it, from each in proportion to its weight:
 * the least change, in squares, that does. What a texel has not is taken off the others. */
static void directional_lower(limit_area *area, const lmb_texel_piece *piece, const limit_filter *filter, float share)
{
    float own[4], lower[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    float total = 0.0f;
    for (int k = 0; k < 4; ++k) {
        own[k] = 1.0f - *area_value(area, area->model->direction->weight, piece->x + (k & 1), piece->y + (k >> 1));
        total += filter->weight[k] * own[k];
    }
    float left = (1.0f - share) * total;
    for (int round = 0; round < 4 && left > 0.0f; ++round) {
        float squares = 0.0f, taken = 0.0f;
        for (int k = 0; k < 4; ++k) {
            squares += lower[k] < own[k] ? filter->weight[k] * filter->weight[k] : 0.0f;
        }
        for (int k = 0; k < 4 && squares > 0.0f; ++k) {
            const float before = lower[k];
            lower[k] = lmb_smaller(before + left * filter->weight[k] / squares, own[k]);
            taken += filter->weight[k] * (lower[k] - before);
        }
        left -= taken;
    }
    for (int k = 0; k < 4; ++k) {
        limit_texel *texel = area_limit(area, piece->x + (k & 1), piece->y + (k >> 1));
        texel->lower = lmb_larger(texel->lower, lower[k]);
    }
}

/* A d is shortened as if its height were at most this often the lowest around it: among much longer ones it would no
 * longer count in what they give together. */
#define EVEN_HEIGHTS 1.5f

/* The lowest n_v.d of a texel and those around it. */
static float lowest_height(const limit_area *area, int32_t x, int32_t y)
{
    float lowest = 1.0f;
    for (int k = 0; k < 9; ++k) {
        const int32_t column = x + k % 3 - 1, row = y + k / 3 - 1;
        if (area_has(area, column, row)) {
            lowest = lmb_smaller(lowest, area_limit(area, column, row)->height);
        }
    }
    return lowest;
}

/* Shortens d of the texels so that decoding trusts it less for normals as low as this one, down to `share` of C_d
 * there; never so far that it would be trusted less for the texel's own normal. */
static void directions_shorten(limit_area *area, const lmb_texel_piece *piece, float height, float share)
{
    const float trusted = area->model->direction->min_height;
    const float edge = trusted / lmb_larger(height, trusted);
    for (int k = 0; k < 4; ++k) {
        limit_texel *texel = area_limit(area, piece->x + (k & 1), piece->y + (k >> 1));
        texel->shine = true;
        if (area->model->direction->first == LMB_MODEL_NO_LENGTH) {
            continue; /* the weights alone can help */
        }
        const float lowest = lowest_height(area, piece->x + (k & 1), piece->y + (k >> 1));
        const float least = trusted / lmb_larger(lmb_smaller(texel->height, EVEN_HEIGHTS * lowest), trusted);
        texel->length = lmb_smaller(texel->length, lmb_larger(texel->stored * edge * sqrtf(share), least));
    }
}

/* A point of a piece that was tried. */
typedef struct tried_point {
    lmb_texel_vertex at;
    float height; /* n_v.d of the filtered d, which is not unit */
    bool shines;
} tried_point;

/* Where n_v.d is higher than this, it changes little enough within a texel for the corners and the middle of a piece to
 * tell of the rest. */
#define SAFE_HEIGHT 0.25f

static tried_point point_try(limit_area *area, const lmb_texel_piece *piece, lmb_texel_vertex at)
{
    limit_filter filter;
    filter_make(area, piece, (float)at.x, (float)at.y, &filter);
    const lmb_vec3 normal = area_normal(area, at.u, at.v);
    const unit_light light = unit_light_decode(area, filter.channel, normal);
    tried_point tried = {at, light.height, false};
    if (area->model->direction->first != LMB_MODEL_NO_LENGTH) {
        const float *d = &filter.channel[area->model->direction->first];
        tried.height = lmb_vec3_dot(normal, lmb_vec3_of(d[0], d[1], d[2]));
    }
    const float allowed =
        peak_allowed(area->brightest, lmb_rgb_of(filter.channel[0], filter.channel[1], filter.channel[2]));
    if (!(unit_light_peak(&light) > SLACK * allowed)) {
        return tried;
    }
    const float share = directional_at_peak(allowed, light.height) / light.directional;
    tried.shines = true;
    if (share < 1.0f && area->stage != LIMIT_WEIGHTS) {
        directions_shorten(area, piece, tried.height, share);
    } else if (share < 1.0f) {
        directional_lower(area, piece, &filter, share);
    }
    return tried;
}

static lmb_texel_vertex vertex_between(const lmb_texel_vertex *a, const lmb_texel_vertex *b, double t)
{
    return (lmb_texel_vertex){a->x + t * (b->x - a->x), a->y + t * (b->y - a->y), a->u + t * (b->u - a->u),
                              a->v + t * (b->v - a->v)};
}

/* The brightest place between two is where n_v.d falls through area->model->direction->min_height: looked for by regula
 * falsi. */
static void crossing_try(limit_area *area, const lmb_texel_piece *piece, tried_point low, tried_point high)
{
    enum { STEPS = 4 };
    for (int step = 0; step < STEPS; ++step) {
        const float below = low.height - area->model->direction->min_height;
        const float above = high.height - area->model->direction->min_height;
        if (!(below < 0.0f && above > 0.0f)) {
            return;
        }
        const double t = (double)(below / (below - above));
        const tried_point between = point_try(area, piece, vertex_between(&low.at, &high.at, t));
        if (between.height < area->model->direction->min_height) {
            low = between;
        } else {
            high = between;
        }
    }
}

/* Tries the middle of a line between two points that were tried, and what lies between. Returns the middle. */
static tried_point line_try(limit_area *area, const lmb_texel_piece *piece, const tried_point *a, const tried_point *b)
{
    const tried_point middle = point_try(area, piece, vertex_between(&a->at, &b->at, 0.5));
    crossing_try(area, piece, *a, middle);
    crossing_try(area, piece, middle, *a);
    crossing_try(area, piece, *b, middle);
    crossing_try(area, piece, middle, *b);
    return middle;
}

static bool piece_shines(const limit_area *area, const lmb_texel_piece *piece)
{
    bool any = false;
    for (int k = 0; k < 4; ++k) {
        any = any || area_limit(area, piece->x + (k & 1), piece->y + (k >> 1))->shine;
    }
    return any;
}

/* Tries a piece along its sides, and along the lines from its middle to its corners and to the middles of its sides. */
static void piece_limit(void *context, const lmb_texel_piece *piece)
{
    limit_area *area = context;
    if (area->stage != LIMIT_LENGTHS && !piece_shines(area, piece)) {
        return;
    }
    lmb_texel_vertex sum = {0.0, 0.0, 0.0, 0.0};
    for (int i = 0; i < piece->count; ++i) {
        const lmb_texel_vertex *at = &piece->vertex[i];
        const double part = 1.0 / piece->count;
        sum =
            (lmb_texel_vertex){sum.x + part * at->x, sum.y + part * at->y, sum.u + part * at->u, sum.v + part * at->v};
    }
    area->brightest = piece_brightest(area, piece);
    tried_point corner[LMB_TEXEL_PIECE_MAX];
    const tried_point middle = point_try(area, piece, sum);
    bool safe = middle.height > SAFE_HEIGHT && !middle.shines;
    for (int i = 0; i < piece->count; ++i) {
        corner[i] = point_try(area, piece, piece->vertex[i]);
        safe = safe && corner[i].height > SAFE_HEIGHT && !corner[i].shines;
    }
    for (int i = 0; i < piece->count && !safe; ++i) {
        const tried_point side = line_try(area, piece, &corner[i], &corner[i + 1 < piece->count ? i + 1 : 0]);
        line_try(area, piece, &middle, &corner[i]);
        line_try(area, piece, &middle, &side);
    }
}

static bool vec3_equals(lmb_vec3 a, lmb_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static void triangle_limit(limit_area *area, const lmb_mesh *mesh, const lmb_vec2 *corner_uv,
                           const lmb_texel_grid *grid, uint32_t triangle)
{
    const uint32_t *vertex = mesh->triangle[triangle];
    area->triangle = triangle;
    area->flat = false;
    area->flat_normal = area_normal(area, 1.0 / 3.0, 1.0 / 3.0);
    area->flat = vec3_equals(mesh->normal[vertex[0]], mesh->normal[vertex[1]]) &&
                 vec3_equals(mesh->normal[vertex[0]], mesh->normal[vertex[2]]);
    lmb_texels_pieces(mesh, corner_uv, grid, triangle, piece_limit, area);
}

/* The normal that a texel was gathered for; zero for a dilated one. */
static lmb_vec3 covered_normal(const limit_area *area, const lmb_texel_source *source, int32_t x, int32_t y)
{
    const int32_t width = area->region->width;
    if (x < 0 || y < 0 || x >= width || y >= area->region->height) {
        return (lmb_vec3){0.0f, 0.0f, 0.0f};
    }
    const lmb_texel_source *from = &source[(size_t)y * (size_t)width + (size_t)x];
    return from->triangle == LMB_TEXEL_UNCOVERED
               ? (lmb_vec3){0.0f, 0.0f, 0.0f}
               : lmb_trace_place(
                     area->tracer,
                     &(lmb_hit){.instance = area->instance, .triangle = from->triangle, .u = from->u, .v = from->v})
                     .shading_normal;
}

static bool has_direction(lmb_vec3 a)
{
    return lmb_vec3_dot(a, a) > 0.0f;
}

/* What is known of a covered texel by itself. Its brightest direction is that of the light that it held. */
static void covered_start(const limit_area *area, int32_t x, int32_t y, lmb_vec3 normal)
{
    const unit_light light = texel_decode(area, x, y, normal);
    const size_t pixel = (size_t)(area->region->y + y) * (size_t)area->image->width + (size_t)(area->region->x + x);
    const float now = lmb_luminance(area_light(area, x, y)), held = area->held[pixel];
    area_limit(area, x, y)->height = light.height;
    area_limit(area, x, y)->peak = unit_light_peak(&light);
    if (now != held && now > 0.0f) {
        area_limit(area, x, y)->peak = lmb_larger(unit_light_peak(&light) * held / now, 1.0f);
    }
}

/* The same of a dilated one: for the mean normal of the covered texels around it, and no brighter than they. */
static void dilated_start(const limit_area *area, const lmb_texel_source *source, int32_t x, int32_t y)
{
    lmb_vec3 sum = {0.0f, 0.0f, 0.0f};
    float brightest = 0.0f;
    for (int k = 0; k < 9; ++k) {
        const int32_t column = x + k % 3 - 1, row = y + k / 3 - 1;
        const lmb_vec3 normal = covered_normal(area, source, column, row);
        if (has_direction(normal)) {
            sum = lmb_vec3_add(sum, normal);
            brightest = lmb_larger(brightest,
                                   area_limit(area, column, row)->peak * lmb_luminance(area_light(area, column, row)));
        }
    }
    const float luminance = lmb_luminance(area_light(area, x, y));
    if (has_direction(sum) && luminance > 0.0f) {
        const unit_light light = texel_decode(area, x, y, lmb_vec3_unit_or(sum, sum));
        area_limit(area, x, y)->height = light.height;
        area_limit(area, x, y)->peak = lmb_larger(lmb_smaller(unit_light_peak(&light), brightest / luminance), 1.0f);
    }
}

static void area_start(const limit_area *area, const lmb_texel_source *source)
{
    const int32_t right = area->region->width + area->padding;
    const int32_t bottom = area->region->height + area->padding;
    for (int32_t y = -area->padding; y < bottom; ++y) {
        for (int32_t x = -area->padding; x < right; ++x) {
            *area_limit(area, x, y) = (limit_texel){.height = 1.0f, .peak = 1.0f, .stored = 1.0f, .length = 1.0f};
            const lmb_vec3 normal = covered_normal(area, source, x, y);
            if (has_direction(normal)) {
                covered_start(area, x, y, normal);
            }
        }
    }
    for (int32_t y = -area->padding; y < bottom; ++y) {
        for (int32_t x = -area->padding; x < right; ++x) {
            if (!has_direction(covered_normal(area, source, x, y))) {
                dilated_start(area, source, x, y);
            }
        }
    }
}

/* Does what the stage has found. */
static void area_change(const limit_area *area)
{
    const lmb_model_direction *direction = area->model->direction;
    for (int32_t y = -area->padding; y < area->region->height + area->padding; ++y) {
        for (int32_t x = -area->padding; x < area->region->width + area->padding; ++x) {
            limit_texel *limit = area_limit(area, x, y);
            if (area->stage != LIMIT_WEIGHTS && limit->length < limit->stored) {
                for (int axis = 0; axis < 3; ++axis) {
                    *area_value(area, direction->first + axis, x, y) *= limit->length / limit->stored;
                }
                limit->stored = limit->length;
            } else if (area->stage == LIMIT_WEIGHTS && limit->lower > 0.0f) {
                float *const weight = area_value(area, direction->weight, x, y);
                *weight = lmb_smaller(*weight + limit->lower, 1.0f);
            }
        }
    }
}

typedef struct limit_work {
    lmb_lightmap *lightmap;
    const lmb_tracer *tracer;
    float *const *held;     /* [image][pixel] */
    uint8_t *out_of_memory; /* [instance] */
} limit_work;

static void limit_task(void *context, size_t task, int worker)
{
    (void)worker;
    const limit_work *work = context;
    const lmb_lightmap *lightmap = work->lightmap;
    const lmb_lightmap_region *region = &lightmap->region[task];
    if (region->image < 0) {
        return;
    }
    const uint32_t number = lightmap->scene->instances[task].mesh;
    const lmb_mesh *mesh = &lightmap->scene->meshes[number];
    const lmb_texel_grid grid = lmb_lightmap_grid(lightmap, (uint32_t)task);
    limit_area area = {.tracer = work->tracer,
                       .image = &lightmap->image[region->image],
                       .held = work->held[region->image],
                       .model = lightmap->model,
                       .region = region,
                       .instance = (uint32_t)task,
                       .padding = lightmap->settings.padding,
                       .stride = grid.width + 2 * lightmap->settings.padding};
    const size_t count = (size_t)area.stride * (size_t)(grid.height + 2 * area.padding);
    lmb_texel_source *source = malloc((size_t)grid.width * (size_t)grid.height * sizeof *source);
    area.texel = malloc(count * sizeof *area.texel);
    if (source && area.texel) {
        lmb_texels_cover(mesh, lightmap->corner_uv[number], &grid, source);
        area_start(&area, source);
        for (int stage = LIMIT_LENGTHS; stage <= LIMIT_WEIGHTS; ++stage) {
            area.stage = (limit_stage)stage;
            for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
                triangle_limit(&area, mesh, lightmap->corner_uv[number], &grid, t);
            }
            area_change(&area);
        }
    } else {
        work->out_of_memory[task] = 1;
    }
    free(source);
    free(area.texel);
}

lmb_result lmb_lightmap_limit(lmb_lightmap *lightmap, float *const *held, const lmb_tracer *tracer, lmb_pool *pool)
{
    if (!lightmap->model->direction) {
        return LMB_OK;
    }
    const size_t instances = lightmap->scene->instance_count;
    limit_work work = {lightmap, tracer, held, calloc(instances + 1u, 1)};
    if (!work.out_of_memory) {
        return LMB_ERROR_MEMORY;
    }
    lmb_result result = lmb_pool_run(pool, instances, limit_task, &work, "lightmaps", NULL);
    for (size_t i = 0; i < instances; ++i) {
        result = work.out_of_memory[i] ? LMB_ERROR_MEMORY : result;
    }
    free(work.out_of_memory);
    return result;
}
