#include "light/emitter_points.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "base/vectorised.h"

/* Cosine below which a triangle counts as seen edge-on. */
#define EDGE_ON 1e-6f

enum { SHAPE_FLOATS = sizeof(lmb_emitter_shape) / sizeof(float) };

lmb_emitter_shape lmb_emitter_shape_of(const lmb_vec3 corner[3], lmb_vec3 normal, float rounding)
{
    const lmb_vec3 u = lmb_vec3_sub(corner[1], corner[0]), v = lmb_vec3_sub(corner[2], corner[0]);
    const lmb_vec3 middle = lmb_vec3_scale(lmb_vec3_add(lmb_vec3_add(corner[0], corner[1]), corner[2]), 1.0f / 3.0f);
    return (lmb_emitter_shape){.corner = {corner[0].x, corner[0].y, corner[0].z},
                               .edge_u = {u.x, u.y, u.z},
                               .edge_v = {v.x, v.y, v.z},
                               .middle = {middle.x, middle.y, middle.z},
                               .normal = {normal.x, normal.y, normal.z},
                               .rounding = rounding,
                               .area = 0.5f * lmb_vec3_length(lmb_vec3_cross(u, v))};
}

static inline float density_of(float per_area, float distance, float cosine)
{
    const float density = cosine > EDGE_ON ? per_area * distance * distance / cosine : 0.0f;
    return density <= FLT_MAX ? density : 0.0f;
}

float lmb_emitter_density(const lmb_emitter_shape *shape, float probability, float distance, lmb_vec3 direction)
{
    const lmb_vec3 normal = lmb_vec3_of(shape->normal[0], shape->normal[1], shape->normal[2]);
    return density_of(probability / shape->area, distance, fabsf(lmb_vec3_dot(direction, normal)));
}

/* The chosen triangles' shapes, one array for each float. */
typedef union picked_shapes {
    float value[SHAPE_FLOATS][LMB_EMITTER_POINTS];
    struct {
        float corner[3][LMB_EMITTER_POINTS], edge_u[3][LMB_EMITTER_POINTS], edge_v[3][LMB_EMITTER_POINTS];
        float middle[3][LMB_EMITTER_POINTS], normal[3][LMB_EMITTER_POINTS];
        float rounding[LMB_EMITTER_POINTS], area[LMB_EMITTER_POINTS];
    };
} picked_shapes;
_Static_assert(sizeof(picked_shapes) == sizeof(lmb_emitter_shape) * LMB_EMITTER_POINTS, "one array for each float");

static void shapes_pick(const lmb_emitter_shape *shapes, const lmb_emitter_points *points, picked_shapes *picked)
{
    for (uint32_t i = 0; i < points->count; ++i) {
        float value[SHAPE_FLOATS];
        memcpy(value, &shapes[points->emitter[i]], sizeof value);
        for (uint32_t k = 0; k < SHAPE_FLOATS; ++k) {
            picked->value[k][i] = value[k];
        }
    }
}

LMB_VECTORISED
void lmb_emitter_points_even(lmb_emitter_points *restrict points, const float *restrict x, const float *restrict y)
{
    for (uint32_t i = 0; i < points->count; ++i) {
        const float point[2] = {x[i], y[i]};
        lmb_triangle_point(point, &points->u[i], &points->v[i]);
    }
}

LMB_VECTORISED
static void points_find(const picked_shapes *restrict from, lmb_emitter_points *restrict points)
{
    for (uint32_t i = 0; i < points->count; ++i) {
        const float u = points->u[i], v = points->v[i];
        float x = from->corner[0][i] + from->edge_u[0][i] * u + from->edge_v[0][i] * v;
        float y = from->corner[1][i] + from->edge_u[1][i] * u + from->edge_v[1][i] * v;
        float z = from->corner[2][i] + from->edge_u[2][i] * u + from->edge_v[2][i] * v;

        /* A rounding step towards the middle, like every point of a surface: see surface.c. */
        const float in_x = from->middle[0][i] - x, in_y = from->middle[1][i] - y, in_z = from->middle[2][i] - z;
        const float inward = sqrtf(in_x * in_x + in_y * in_y + in_z * in_z);
        const float rounding = from->rounding[i];
        const float pull = inward > 0.0f ? lmb_smaller(rounding / inward, 0.5f) : 0.0f;
        x += in_x * pull;
        y += in_y * pull;
        z += in_z * pull;

        const float to_x = x - points->position[0][i], to_y = y - points->position[1][i];
        const float to_z = z - points->position[2][i];
        const float distance = sqrtf(to_x * to_x + to_y * to_y + to_z * to_z);
        const float inverse = 1.0f / distance;
        points->direction[0][i] = to_x * inverse;
        points->direction[1][i] = to_y * inverse;
        points->direction[2][i] = to_z * inverse;

        const float along = to_x * from->normal[0][i] + to_y * from->normal[1][i] + to_z * from->normal[2][i];
        const float before = along > 0.0f ? -rounding : rounding;
        points->end[0][i] = x + from->normal[0][i] * before;
        points->end[1][i] = y + from->normal[1][i] * before;
        points->end[2][i] = z + from->normal[2][i] * before;

        const float density = density_of(points->probability[i] / from->area[i], distance, fabsf(along) * inverse);
        points->density[i] = distance > 0.0f ? density : 0.0f;
    }
}

void lmb_emitter_points_find(const lmb_emitter_shape *shapes, lmb_emitter_points *points)
{
    picked_shapes picked;
    shapes_pick(shapes, points, &picked);
    points_find(&picked, points);
}
