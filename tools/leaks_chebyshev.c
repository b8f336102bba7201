#include "leaks_methods.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "check_points.h"

/* An octahedral map a probe of the mean of the distance to what it sees and of its square, as RTXGI 1.3 keeps them;
 * rays about a texel's direction weigh by cos^64. */
enum { SIDE = 16, TEXELS = SIDE * SIDE, RAYS = 512, SHARPNESS_DOUBLINGS = 6 };

/* Distances are clamped to a cell's diagonal and a half of it. */
#define FARTHEST_SPACINGS 2.6f

/* The point that is looked from is off its surface, so that the surface does not hide it. */
#define BIAS_SPACINGS 0.05f

typedef struct depth {
    float mean, square;
} depth;

typedef struct depth_maps {
    const leaks_field *field;
    float spacing;
    lmb_vec3 texel[TEXELS]; /* directions of their middles */
    lmb_vec3 ray[RAYS];
    depth map[]; /* [probe][texel] */
} depth_maps;

/* Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors". */
static void octahedral_from(lmb_vec3 v, float *x, float *y)
{
    const float length = fabsf(v.x) + fabsf(v.y) + fabsf(v.z);
    *x = v.x / length;
    *y = v.y / length;
    if (v.z < 0.0f) {
        const float folded = copysignf(1.0f - fabsf(*y), *x);
        *y = copysignf(1.0f - fabsf(*x), *y);
        *x = folded;
    }
}

static lmb_vec3 octahedral_to(float x, float y)
{
    lmb_vec3 v = {x, y, 1.0f - fabsf(x) - fabsf(y)};
    if (v.z < 0.0f) {
        v.x = copysignf(1.0f - fabsf(y), x);
        v.y = copysignf(1.0f - fabsf(x), y);
    }
    return lmb_vec3_unit_or(v, lmb_vec3_of(0, 0, 1));
}

static void maps_fill(void *context, size_t probe, int worker)
{
    (void)worker;
    depth_maps *const all = context;
    float distance[RAYS];
    for (int i = 0; i < RAYS; ++i) {
        lmb_hit hit;
        const float farthest = FARTHEST_SPACINGS * all->spacing;
        const bool met =
            lmb_trace_nearest(all->field->level->tracer, all->field->place[probe], all->ray[i], 0.0f, farthest, &hit);
        distance[i] = met ? hit.distance : farthest;
    }
    for (int texel = 0; texel < TEXELS; ++texel) {
        double total = 0.0, mean = 0.0, square = 0.0;
        for (int i = 0; i < RAYS; ++i) {
            float weight = lmb_larger(lmb_vec3_dot(all->texel[texel], all->ray[i]), 0.0f);
            for (int k = 0; k < SHARPNESS_DOUBLINGS; ++k) {
                weight *= weight;
            }
            total += (double)weight;
            mean += (double)(weight * distance[i]);
            square += (double)(weight * distance[i] * distance[i]);
        }
        all->map[probe * TEXELS + (size_t)texel] = (depth){(float)(mean / total), (float)(square / total)};
    }
}

static lmb_result chebyshev_prepare(const leaks_field *field, void **state, size_t *bytes)
{
    const size_t probes = (size_t)field->probes->count;
    depth_maps *const all = malloc(sizeof *all + probes * TEXELS * sizeof *all->map);
    if (!all) {
        return LMB_ERROR_MEMORY;
    }
    all->field = field;
    all->spacing = field->probes->level[0].lattice.spacing;
    for (int i = 0; i < TEXELS; ++i) {
        all->texel[i] = octahedral_to((2.0f * (float)(i % SIDE) + 1.0f) / SIDE - 1.0f,
                                      (2.0f * (float)(i / SIDE) + 1.0f) / SIDE - 1.0f);
    }
    sphere_directions(0, RAYS, all->ray);
    *state = all;
    *bytes = field->packed_bytes + probes * TEXELS * 2 * sizeof(uint16_t); /* halfs */
    return lmb_pool_run(field->level->pool, probes, maps_fill, all, "depth", NULL);
}

/* A texel, beyond an edge of the map the one that it is folded to. */
static const depth *texel_at(const depth *map, int x, int y)
{
    if (x < 0 || x >= SIDE) {
        x = x < 0 ? 0 : SIDE - 1;
        y = SIDE - 1 - y;
    }
    if (y < 0 || y >= SIDE) {
        y = y < 0 ? 0 : SIDE - 1;
        x = SIDE - 1 - x;
    }
    return &map[x + SIDE * y];
}

static depth depth_at(const depth *map, lmb_vec3 direction)
{
    float x, y;
    octahedral_from(direction, &x, &y);
    x = (x + 1.0f) * 0.5f * SIDE - 0.5f;
    y = (y + 1.0f) * 0.5f * SIDE - 0.5f;
    const int left = (int)floorf(x), low = (int)floorf(y);
    depth sum = {0.0f, 0.0f};
    for (int i = 0; i < 4; ++i) {
        const float across = x - (float)left, up = y - (float)low;
        const float weight = (i & 1 ? across : 1.0f - across) * (i & 2 ? up : 1.0f - up);
        const depth *texel = texel_at(map, left + (i & 1), low + (i >> 1));
        sum.mean += weight * texel->mean;
        sum.square += weight * texel->square;
    }
    return sum;
}

/* Chebyshev's bound on the share of what is seen that is farther than `distance`, cubed and with a floor as RTXGI has
 * it. */
static float depth_weight(depth seen, float distance)
{
    if (distance <= seen.mean) {
        return 1.0f;
    }
    const float variance = fabsf(seen.square - seen.mean * seen.mean), beyond = distance - seen.mean;
    const float bound = variance / (variance + beyond * beyond);
    return lmb_larger(bound * bound * bound, 0.05f);
}

static void chebyshev_sample(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance)
{
    const depth_maps *all = state;
    const leaks_cell cell = leaks_cell_of(all->field, position);
    const lmb_vec3 from = normal ? lmb_vec3_mad(position, *normal, BIAS_SPACINGS * all->spacing) : position;
    float weight[8];
    leaks_weights(cell.t, weight);
    for (int i = 0; i < 8; ++i) {
        if (!leaks_probe_is_valid(all->field, cell.probe[i])) {
            weight[i] = 0.0f;
            continue;
        }
        const lmb_vec3 place = all->field->place[cell.probe[i]];
        float share = 1.0f;
        if (normal) { /* probes in front of the surface weigh more */
            const lmb_vec3 towards = lmb_vec3_unit_or(lmb_vec3_sub(place, position), *normal);
            const float facing = 0.5f * (lmb_vec3_dot(towards, *normal) + 1.0f);
            share = facing * facing + 0.2f;
        }
        const lmb_vec3 way = lmb_vec3_sub(from, place);
        const lmb_vec3 direction = lmb_vec3_unit_or(way, lmb_vec3_of(0, 1, 0));
        share *= depth_weight(depth_at(&all->map[(size_t)cell.probe[i] * TEXELS], direction), lmb_vec3_length(way));
        share = lmb_larger(share, 1e-6f);
        share *= share < 0.2f ? share * share / 0.04f : 1.0f;
        weight[i] *= share;
    }
    if (!leaks_blend(all->field, cell.probe, weight, radiance)) {
        lmb_volume_sample(all->field->volume, position, radiance);
    }
}

const leaks_method leaks_chebyshev = {
    .name = "chebyshev",
    .about = "DDGI's: Chebyshev's bound by 16 x 16 depths a probe, smooth backface weight",
    .prepare = chebyshev_prepare,
    .sample = chebyshev_sample,
    .release = free,
};
