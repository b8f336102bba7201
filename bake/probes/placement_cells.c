/* Cells between probes, and which of them geometry crosses. */
#include "probes/placement_internal.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/surface.h>
#include <lambent/vector.h>

/* Separating axes after Akenine-Moeller 2001: three cube normals, the triangle's normal, nine cross products of edges.
 */
bool lmb_triangle_touches_cube(const lmb_vec3 corner[3])
{
    const lmb_vec3 edge[3] = {lmb_vec3_sub(corner[1], corner[0]), lmb_vec3_sub(corner[2], corner[1]),
                              lmb_vec3_sub(corner[0], corner[2])};
    const lmb_vec3 unit[3] = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    lmb_vec3 axis[13];
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        axis[count++] = unit[i];
        for (int k = 0; k < 3; ++k) {
            axis[count++] = lmb_vec3_cross(unit[i], edge[k]);
        }
    }
    axis[count++] = lmb_vec3_cross(edge[0], edge[1]);
    for (int i = 0; i < count; ++i) {
        const float reach = fabsf(axis[i].x) + fabsf(axis[i].y) + fabsf(axis[i].z);
        const float a = lmb_vec3_dot(axis[i], corner[0]);
        const float b = lmb_vec3_dot(axis[i], corner[1]);
        const float c = lmb_vec3_dot(axis[i], corner[2]);
        if (lmb_smaller(a, lmb_smaller(b, c)) > reach || lmb_larger(a, lmb_larger(b, c)) < -reach) {
            return false;
        }
    }
    return true;
}

/* Cells of a level that a triangle's box may touch. */
typedef struct cell_range {
    int32_t first[3], last[3]; /* relative to the lattice's first point */
} cell_range;

/* Clipped to the lattice; false when there are none. */
static bool cells_find(const lmb_probes *probes, const lmb_lattice *lattice, const lmb_vec3 corner[3],
                       cell_range *range)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int k = 0; k < 3; ++k) {
        const lmb_vec3d world = {(double)corner[k].x + probes->origin.x, (double)corner[k].y + probes->origin.y,
                                 (double)corner[k].z + probes->origin.z};
        const lmb_vec3d local = lmb_lattice_coordinates(lattice, world);
        const double at[3] = {local.x, local.y, local.z};
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = fmin(low[axis], at[axis]);
            high[axis] = fmax(high[axis], at[axis]);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double from = floor(low[axis]) - (double)lattice->min[axis];
        const double to = floor(high[axis]) - (double)lattice->min[axis];
        const double cells = (double)lattice->size[axis] - 1.0;
        if (!(to >= 0.0) || !(from < cells)) {
            return false;
        }
        range->first[axis] = from > 0.0 ? (int32_t)from : 0;
        range->last[axis] = to < cells ? (int32_t)to : lattice->size[axis] - 2;
        if (range->first[axis] > range->last[axis]) {
            return false;
        }
    }
    return true;
}

/* The same vector in the lattice's axes. */
static lmb_vec3 vector_to_lattice(const lmb_lattice *lattice, lmb_vec3 v)
{
    const lmb_vec3d local = lmb_lattice_vector_from_world(lattice, (lmb_vec3d){(double)v.x, (double)v.y, (double)v.z});
    return lmb_vec3_of((float)local.x, (float)local.y, (float)local.z);
}

/* Marks the cell whose first corner is a probe's point when a triangle touches it. */
static void cell_mark(const lmb_probes *probes, const lmb_lattice *lattice, int32_t probe, const lmb_vec3 corner[3],
                      uint8_t *crossed)
{
    if (crossed[probe]) {
        return;
    }
    const float half = 0.5f * lattice->spacing;
    const lmb_vec3d first = lmb_lattice_position(lattice, probes->point[probe]);
    const lmb_vec3d inwards =
        lmb_lattice_vector_to_world(lattice, (lmb_vec3d){(double)half, (double)half, (double)half});
    const lmb_vec3 centre = lmb_vec3_of((float)(first.x - probes->origin.x) + (float)inwards.x,
                                        (float)(first.y - probes->origin.y) + (float)inwards.y,
                                        (float)(first.z - probes->origin.z) + (float)inwards.z);
    lmb_vec3 local[3];
    for (int k = 0; k < 3; ++k) {
        local[k] = lmb_vec3_scale(vector_to_lattice(lattice, lmb_vec3_sub(corner[k], centre)), 1.0f / half);
    }
    crossed[probe] = lmb_triangle_touches_cube(local);
}

static double range_cells(const cell_range *range)
{
    double cells = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        cells *= (double)range->last[axis] - range->first[axis] + 1.0;
    }
    return cells;
}

static void range_mark(const lmb_probes *probes, uint32_t level, const cell_range *range, const lmb_vec3 corner[3],
                       uint8_t *crossed)
{
    const lmb_lattice *lattice = &probes->level[level].lattice;
    for (int32_t z = range->first[2]; z <= range->last[2]; ++z) {
        for (int32_t y = range->first[1]; y <= range->last[1]; ++y) {
            for (int32_t x = range->first[0]; x <= range->last[0]; ++x) {
                const int32_t probe =
                    lmb_probes_find(probes, level, lattice->min[0] + x, lattice->min[1] + y, lattice->min[2] + z);
                if (probe >= 0) {
                    cell_mark(probes, lattice, probe, corner, crossed);
                }
            }
        }
    }
}

/* Marks, by their first corners' probes, the cells that a triangle touches. Looks at the cells of the triangle's box,
 * or at all probes where these are fewer. */
static void triangle_mark(const lmb_probes *probes, uint32_t level, const lmb_vec3 corner[3], uint8_t *crossed)
{
    const lmb_probe_level *own = &probes->level[level];
    cell_range range;
    if (!cells_find(probes, &own->lattice, corner, &range)) {
        return;
    }
    if (range_cells(&range) <= own->count) {
        range_mark(probes, level, &range, corner, crossed);
        return;
    }
    for (int32_t probe = own->first; probe < own->first + own->count; ++probe) {
        bool in_range = true;
        for (int axis = 0; axis < 3; ++axis) {
            const int32_t at = probes->point[probe][axis] - own->lattice.min[axis];
            in_range = in_range && at >= range.first[axis] && at <= range.last[axis];
        }
        if (in_range) {
            cell_mark(probes, &own->lattice, probe, corner, crossed);
        }
    }
}

lmb_result lmb_placement_count_cells(const lmb_probes *probes, uint32_t level, const lmb_tracer *tracer, int64_t *cells,
                                     int64_t *crossed)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    uint8_t *mark = calloc((size_t)probes->count + 1, 1);
    if (!mark) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_instance *instance = &scene->instances[i];
        for (uint32_t t = 0; t < scene->meshes[instance->mesh].triangle_count && !instance->dynamic; ++t) {
            lmb_vec3 corner[3];
            lmb_trace_corners(tracer, i, t, corner);
            triangle_mark(probes, level, corner, mark);
        }
    }
    *cells = 0;
    *crossed = 0;
    const lmb_probe_level *own = &probes->level[level];
    for (int32_t probe = own->first; probe < own->first + own->count; ++probe) {
        const bool is_leaf = lmb_probes_cell_is_leaf(probes, level, probes->point[probe]);
        *cells += is_leaf;
        *crossed += is_leaf && mark[probe];
    }
    free(mark);
    return LMB_OK;
}
