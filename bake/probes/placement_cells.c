/* Cells of a grid, and which of them geometry crosses. */
#include "probes/placement_internal.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/surface.h>

#include "base/scalar.h"
#include "base/vec3.h"

/* Whether a triangle, given relative to the centre of a cube of half side 1, touches the cube: separating axes after
 * Akenine-Moeller 2001 (three cube normals, the triangle's normal, nine cross products of edges). */
static bool triangle_touches_cube(const lmb_vec3 corner[3])
{
    const lmb_vec3 edge[3] = {vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[1]),
                              vec3_sub(corner[0], corner[2])};
    const lmb_vec3 unit[3] = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    lmb_vec3 axis[13];
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        axis[count++] = unit[i];
        for (int k = 0; k < 3; ++k) {
            axis[count++] = vec3_cross(unit[i], edge[k]);
        }
    }
    axis[count++] = vec3_cross(edge[0], edge[1]);
    for (int i = 0; i < count; ++i) {
        const float reach = fabsf(axis[i].x) + fabsf(axis[i].y) + fabsf(axis[i].z);
        const float a = vec3_dot(axis[i], corner[0]);
        const float b = vec3_dot(axis[i], corner[1]);
        const float c = vec3_dot(axis[i], corner[2]);
        if (float_smaller(a, float_smaller(b, c)) > reach || float_larger(a, float_larger(b, c)) < -reach) {
            return false;
        }
    }
    return true;
}

/* First and last cell along an axis that the range [low, high] touches, clipped to the grid. */
static bool cell_range(const lmb_grid *grid, int axis, float low, float high, int32_t *first, int32_t *last)
{
    const double origin = axis == 0 ? grid->origin.x : axis == 1 ? grid->origin.y : grid->origin.z;
    const double scale = 1.0 / (double)grid->spacing;
    const double from = floor(((double)low + origin) * scale) - (double)grid->min[axis];
    const double to = floor(((double)high + origin) * scale) - (double)grid->min[axis];
    const double cells = (double)grid->size[axis] - 1.0;
    if (!(to >= 0.0) || !(from < cells)) {
        return false;
    }
    *first = from > 0.0 ? (int32_t)from : 0;
    *last = to < cells ? (int32_t)to : grid->size[axis] - 2;
    return *first <= *last;
}

static size_t cell_index(const lmb_grid *grid, int32_t x, int32_t y, int32_t z)
{
    return (size_t)x + (size_t)grid->size[0] * ((size_t)y + (size_t)grid->size[1] * (size_t)z);
}

static void triangle_mark(const lmb_grid *grid, const lmb_vec3 corner[3], uint8_t *crossed)
{
    const float low[3] = {float_smaller(corner[0].x, float_smaller(corner[1].x, corner[2].x)),
                          float_smaller(corner[0].y, float_smaller(corner[1].y, corner[2].y)),
                          float_smaller(corner[0].z, float_smaller(corner[1].z, corner[2].z))};
    const float high[3] = {float_larger(corner[0].x, float_larger(corner[1].x, corner[2].x)),
                           float_larger(corner[0].y, float_larger(corner[1].y, corner[2].y)),
                           float_larger(corner[0].z, float_larger(corner[1].z, corner[2].z))};
    int32_t first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
        if (!cell_range(grid, axis, low[axis], high[axis], &first[axis], &last[axis])) {
            return;
        }
    }
    const double spacing = (double)grid->spacing;
    const float half = 0.5f * grid->spacing;
    for (int32_t z = first[2]; z <= last[2]; ++z) {
        for (int32_t y = first[1]; y <= last[1]; ++y) {
            for (int32_t x = first[0]; x <= last[0]; ++x) {
                const lmb_vec3 centre = vec3((float)((grid->min[0] + x) * spacing - grid->origin.x) + half,
                                             (float)((grid->min[1] + y) * spacing - grid->origin.y) + half,
                                             (float)((grid->min[2] + z) * spacing - grid->origin.z) + half);
                lmb_vec3 local[3];
                for (int k = 0; k < 3; ++k) {
                    local[k] = vec3_scale(vec3_sub(corner[k], centre), 1.0f / half);
                }
                uint8_t *mark = &crossed[cell_index(grid, x, y, z)];
                *mark = *mark || triangle_touches_cube(local);
            }
        }
    }
}

static bool cell_is_complete(const lmb_grid *grid, int32_t x, int32_t y, int32_t z)
{
    for (int k = 0; k < 8; ++k) {
        if (grid->probe_at[cell_index(grid, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))] < 0) {
            return false;
        }
    }
    return true;
}

lmb_result lmb_grid_count_cells(const lmb_grid *grid, const lmb_tracer *tracer, int64_t *cells, int64_t *crossed)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    uint8_t *mark = calloc((size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2], 1);
    if (!mark) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_instance *instance = &scene->instances[i];
        for (uint32_t t = 0; t < scene->meshes[instance->mesh].triangle_count && !instance->dynamic; ++t) {
            lmb_vec3 corner[3];
            lmb_trace_corners(tracer, i, t, corner);
            triangle_mark(grid, corner, mark);
        }
    }
    *cells = 0;
    *crossed = 0;
    for (int32_t z = 0; z + 1 < grid->size[2]; ++z) {
        for (int32_t y = 0; y + 1 < grid->size[1]; ++y) {
            for (int32_t x = 0; x + 1 < grid->size[0]; ++x) {
                const bool complete = cell_is_complete(grid, x, y, z);
                *cells += complete;
                *crossed += complete && mark[cell_index(grid, x, y, z)];
            }
        }
    }
    free(mark);
    return LMB_OK;
}
