#include "cube_map.h"

#include <float.h>
#include <stdlib.h>

#include <lambent/sequence.h>
#include <lambent/specular.h>
#include <lambent/vector.h>

#include "half_vector.h"
#include "shade_specular.h"

/* Half vectors of a blurred texel. */
enum { LOBE_SAMPLES = 512 };

/* What a direction says of the box around. */
typedef struct box_point {
    int side;     /* that it is of: the face's axis that the surface faces against, or of the sky the direction's */
    float depth;  /* along that axis; FLT_MAX: the sky */
    float weight; /* a solid angle */
} box_point;

enum { BOX_POINTS = CUBE_FACES * CUBE_SIDE * CUBE_SIDE };

typedef struct cube_work {
    const lmb_transport *transport;
    const cube_place *place;
    uint32_t samples;
    box_point *box;                 /* [texel of the first level] */
    const float *seen[CUBE_LEVELS]; /* what is seen, not blurred, as wide as the level */
    cube_map *map;
} cube_work;

float cube_roughness(int level)
{
    return CUBE_LEAST_ROUGHNESS * (float)(1 << level);
}

lmb_vec3 cube_direction(int face, float s, float t)
{
    const float x = 2.0f * s - 1.0f, y = 2.0f * t - 1.0f;
    const lmb_vec3 directions[CUBE_FACES] = {{1, -y, -x}, {-1, -y, x}, {x, 1, y},
                                             {x, -1, -y}, {x, -y, 1},  {-x, -y, -1}};
    return lmb_vec3_unit_or(directions[face], directions[face]);
}

/* Where a direction goes through the cube. */
typedef struct cube_place_on_face {
    int face;
    float s, t; /* in [0, 1] */
} cube_place_on_face;

static cube_place_on_face face_of(lmb_vec3 d)
{
    const float ax = fabsf(d.x), ay = fabsf(d.y), az = fabsf(d.z);
    float across, down, along;
    int face;
    if (ax >= ay && ax >= az) {
        face = d.x > 0.0f ? 0 : 1;
        along = ax, across = d.x > 0.0f ? -d.z : d.z, down = -d.y;
    } else if (ay >= az) {
        face = d.y > 0.0f ? 2 : 3;
        along = ay, across = d.x, down = d.y > 0.0f ? d.z : -d.z;
    } else {
        face = d.z > 0.0f ? 4 : 5;
        along = az, across = d.z > 0.0f ? d.x : -d.x, down = -d.y;
    }
    return (cube_place_on_face){face, 0.5f * (across / along + 1.0f), 0.5f * (down / along + 1.0f)};
}

static int clamped_index(float coordinate, int side)
{
    const int index = (int)(coordinate * (float)side);
    return index < 0 ? 0 : index < side ? index : side - 1;
}

static size_t texel_at(int side, int face, int row, int column)
{
    return 3 * (((size_t)face * (size_t)side + (size_t)row) * (size_t)side + (size_t)column);
}

size_t cube_texel(int side, lmb_vec3 direction)
{
    const cube_place_on_face at = face_of(direction);
    return texel_at(side, at.face, clamped_index(at.t, side), clamped_index(at.s, side));
}

/* The two texels that a coordinate lies between, within the face, and the share of the second. */
static float between(float coordinate, int side, int index[2])
{
    const float at = lmb_larger(lmb_smaller(coordinate * (float)side - 0.5f, (float)(side - 1)), 0.0f);
    index[0] = (int)at;
    index[1] = index[0] + 1 < side ? index[0] + 1 : index[0];
    return at - (float)index[0];
}

static lmb_rgb level_look(const cube_map *map, int level, const cube_place_on_face *at)
{
    const int side = cube_side(level);
    int column[2], row[2];
    const float right = between(at->s, side, column), below = between(at->t, side, row);
    lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
    for (int i = 0; i < 4; ++i) {
        const float *const rgb = map->rgb[level] + texel_at(side, at->face, row[i / 2], column[i % 2]);
        const float weight = (i % 2 ? right : 1.0f - right) * (i / 2 ? below : 1.0f - below);
        sum = lmb_rgb_add(sum, lmb_rgb_scale(lmb_rgb_of(rgb[0], rgb[1], rgb[2]), weight));
    }
    return sum;
}

lmb_rgb cube_map_look(const cube_map *map, lmb_vec3 direction, float roughness)
{
    const cube_place_on_face at = face_of(direction);
    const float least = lmb_larger(roughness, CUBE_LEAST_ROUGHNESS);
    const float level = lmb_smaller(log2f(least / CUBE_LEAST_ROUGHNESS), (float)(CUBE_LEVELS - 1));
    const int first = (int)level, second = first + 1 < CUBE_LEVELS ? first + 1 : first;
    const float share = level - (float)first;
    return lmb_rgb_add(lmb_rgb_scale(level_look(map, first, &at), 1.0f - share),
                       lmb_rgb_scale(level_look(map, second, &at), share));
}

/* The face that a vector points to most. */
static int axis_of(lmb_vec3 v)
{
    return face_of(v).face;
}

static float along_axis(lmb_vec3 v, int face)
{
    const float along = face / 2 == 0 ? v.x : face / 2 == 1 ? v.y : v.z;
    return face % 2 == 0 ? along : -along;
}

static box_point box_look(const cube_work *work, lmb_vec3 direction)
{
    const lmb_tracer *tracer = work->transport->tracer;
    const int face = axis_of(direction);
    const float cosine = along_axis(direction, face);
    box_point seen = {face, FLT_MAX, cosine * cosine * cosine};
    lmb_hit hit;
    if (lmb_trace_nearest(tracer, work->place->position, direction, 0.0f, FLT_MAX, &hit)) {
        const lmb_vec3 normal = lmb_trace_place(tracer, &hit).geometric_normal;
        const bool front = lmb_vec3_dot(normal, direction) < 0.0f;
        seen.side = axis_of(front ? lmb_vec3_scale(normal, -1.0f) : normal);
        seen.depth = lmb_larger(hit.distance * along_axis(direction, seen.side), 0.0f);
    }
    return seen;
}

/* A row of the first level. */
static void trace_task(void *context, size_t task, int worker)
{
    (void)worker;
    const cube_work *work = context;
    float *rgb = work->map->rgb[0] + task * CUBE_SIDE * 3;
    const uint64_t around = lmb_stream_of_position(work->transport->seed, work->place->position);
    for (int x = 0; x < CUBE_SIDE; ++x) {
        const uint64_t stream = lmb_mix(around, task * CUBE_SIDE + (size_t)x);
        lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
        for (uint32_t i = 0; i < work->samples; ++i) {
            float at[2];
            lmb_sequence_2d(~stream, i, 0, at);
            const lmb_vec3 direction = cube_direction((int)(task / CUBE_SIDE), ((float)x + at[0]) / CUBE_SIDE,
                                                      ((float)(task % CUBE_SIDE) + at[1]) / CUBE_SIDE);
            sum = lmb_rgb_add(sum, radiance_without_keys(work->transport, work->place->position, direction, stream, i));
        }
        for (int c = 0; c < 3; ++c) {
            rgb[3 * x + c] = sum.c[c] / (float)work->samples;
        }
        const lmb_vec3 middle = cube_direction((int)(task / CUBE_SIDE), ((float)x + 0.5f) / CUBE_SIDE,
                                               ((float)(task % CUBE_SIDE) + 0.5f) / CUBE_SIDE);
        work->box[task * CUBE_SIDE + (size_t)x] = box_look(work, middle);
    }
}

/* By side, then by depth. */
static int box_compare(const void *a, const void *b)
{
    const box_point *x = a, *y = b;
    const int by_depth = (x->depth > y->depth) - (x->depth < y->depth);
    return x->side != y->side ? x->side - y->side : by_depth;
}

/* The median of points of one side; FLT_MAX where there are none. */
static float side_find(const box_point *point, size_t count)
{
    double all = 0.0, nearer = 0.0;
    for (size_t i = 0; i < count; ++i) {
        all += (double)point[i].weight;
    }
    for (size_t i = 0; i < count; ++i) {
        nearer += (double)point[i].weight;
        if (2.0 * nearer >= all) {
            return point[i].depth;
        }
    }
    return FLT_MAX;
}

/* Orders the points. */
static void sides_find(box_point *box, float side[CUBE_FACES])
{
    float farthest = 1.0f;
    size_t first = 0;
    qsort(box, BOX_POINTS, sizeof *box, box_compare);
    for (int face = 0; face < CUBE_FACES; ++face) {
        size_t end = first;
        while (end < BOX_POINTS && box[end].side == face) {
            ++end;
        }
        side[face] = side_find(&box[first], end - first);
        farthest = side[face] < FLT_MAX ? lmb_larger(farthest, side[face]) : farthest;
        first = end;
    }
    for (int face = 0; face < CUBE_FACES; ++face) {
        side[face] = lmb_smaller(side[face], CUBE_SKY_SIDES * farthest);
    }
}

/* A lobe about +Z, looked at along it; what cannot arrive has no weight. */
static void lobe_make(float roughness, half_vector_sample lobe[LOBE_SAMPLES])
{
    const lmb_vec3 axis = {0.0f, 0.0f, 1.0f};
    for (uint32_t i = 0; i < LOBE_SAMPLES; ++i) {
        float u[2];
        lmb_sequence_2d(0, i, 0, u);
        if (!half_vector_pick(roughness, axis, axis, u, &lobe[i])) {
            lobe[i].arrives = 0.0;
        }
    }
}

/* What a mirror with that lobe shows of what is seen, looked at along its normal. */
static lmb_rgb blurred(const float *seen, int side, const half_vector_sample lobe[LOBE_SAMPLES], lmb_vec3 direction)
{
    lmb_vec3 tangent, bitangent;
    lmb_vec3_frame(direction, &tangent, &bitangent);
    double sum[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < LOBE_SAMPLES; ++i) {
        const lmb_vec3 local = lobe[i].towards;
        const lmb_vec3 across = lmb_vec3_mad(lmb_vec3_scale(tangent, local.x), bitangent, local.y);
        const float *rgb = seen + cube_texel(side, lmb_vec3_mad(across, direction, local.z));
        for (int c = 0; c < 3; ++c) {
            sum[c] += lobe[i].arrives / LOBE_SAMPLES * (double)rgb[c];
        }
    }
    return lmb_rgb_of((float)sum[0], (float)sum[1], (float)sum[2]);
}

/* A row of a level: tasks are numbered through all levels. */
static void blur_task(void *context, size_t task, int worker)
{
    (void)worker;
    const cube_work *work = context;
    int level = 0;
    while (task >= (size_t)(CUBE_FACES * cube_side(level))) {
        task -= (size_t)(CUBE_FACES * cube_side(level++));
    }
    const int side = cube_side(level), face = (int)task / side, row = (int)task % side;
    const float roughness = cube_roughness(level);
    half_vector_sample lobe[LOBE_SAMPLES];
    lobe_make(roughness, lobe);
    for (int x = 0; x < side; ++x) {
        const lmb_vec3 direction =
            cube_direction(face, ((float)x + 0.5f) / (float)side, ((float)row + 0.5f) / (float)side);
        const lmb_rgb light = blurred(work->seen[level], side, lobe, direction);
        const lmb_rgb divisor = lmb_specular_environment_divisor(&work->place->radiance, roughness, direction);
        float *rgb = work->map->rgb[level] + 3 * (task * (size_t)side + (size_t)x);
        for (int c = 0; c < 3; ++c) {
            rgb[c] = divisor.c[c] > 0.0f ? lmb_light_clamped(light.c[c] / divisor.c[c]) : 0.0f;
        }
    }
}

static size_t level_floats(int level)
{
    return (size_t)CUBE_FACES * (size_t)cube_side(level) * (size_t)cube_side(level) * 3;
}

/* Means of four texels; a face's rows follow each other, so that six faces are one tall picture. */
static void halve(const float *from, int side, float *to)
{
    for (int i = 0; i < CUBE_FACES * side / 2 * (side / 2) * 3; ++i) {
        const int c = i % 3, x = i / 3 % (side / 2), y = i / 3 / (side / 2);
        const float *corner = from + 3 * (2 * y * side + 2 * x) + c;
        to[i] = 0.25f * (corner[0] + corner[3] + corner[3 * side] + corner[3 * side + 3]);
    }
}

bool cube_map_allocate(cube_map *map)
{
    bool all = true;
    for (int i = 0; i < CUBE_LEVELS; ++i) {
        map->rgb[i] = malloc(level_floats(i) * sizeof *map->rgb[i]);
        all = all && map->rgb[i];
    }
    return all;
}

void cube_map_free(cube_map *freed)
{
    for (int i = 0; i < CUBE_LEVELS; ++i) {
        free(freed->rgb[i]);
        freed->rgb[i] = NULL;
    }
}

lmb_result cube_map_make(const lmb_transport *transport, const cube_place *place, uint32_t samples, lmb_pool *pool,
                         const lmb_progress *progress, cube_map *made)
{
    cube_map seen;
    cube_work work = {.transport = transport, .place = place, .samples = samples, .map = &seen};
    const bool first = cube_map_allocate(&seen), second = cube_map_allocate(made);
    work.box = malloc(BOX_POINTS * sizeof *work.box);
    lmb_result result = first && second && work.box ? LMB_OK : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = lmb_pool_run(pool, (size_t)CUBE_FACES * CUBE_SIDE, trace_task, &work, "trace", progress);
    }
    if (result == LMB_OK) {
        size_t rows = 0;
        for (int i = 0; i < CUBE_LEVELS; ++i) {
            if (i > 0) {
                halve(seen.rgb[i - 1], cube_side(i - 1), seen.rgb[i]);
            }
            work.seen[i] = seen.rgb[i];
            rows += (size_t)(CUBE_FACES * cube_side(i));
        }
        sides_find(work.box, made->side);
        work.map = made;
        result = lmb_pool_run(pool, rows, blur_task, &work, "blur", progress);
    }
    free(work.box);
    cube_map_free(&seen);
    if (result != LMB_OK) {
        cube_map_free(made);
    }
    return result;
}
