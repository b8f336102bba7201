/* The cells that have a probe, and which of them opaque triangles touch. */
#include "probes/regions_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/probe_boxes.h>
#include <lambent/surface.h>

#include "probes/placement_internal.h"
#include "trace/trace_internal.h"

/* A cell is looked at a little beyond its faces; halves of a side. */
#define GROWN_HALVES 0.02f

typedef struct cell_range {
    int32_t first[3], last[3];
} cell_range;

/* A point of the scene, in a lattice's coordinates. */
static lmb_vec3d lattice_place(const lmb_probes *probes, const lmb_lattice *lattice, lmb_vec3 at)
{
    const lmb_vec3d world = {(double)at.x + probes->origin.x, (double)at.y + probes->origin.y,
                             (double)at.z + probes->origin.z};
    return lmb_lattice_coordinates(lattice, world);
}

/* Adds a cell unless it is there. */
static lmb_result cell_add(lmb_region_work *work, uint32_t level, const int32_t point[3])
{
    if (work->cell_count == work->cell_room) {
        const size_t room = work->cell_room > 0 ? 2 * (size_t)work->cell_room : 1024;
        lmb_region_cell *const more = room < INT32_MAX ? realloc(work->cell, room * sizeof *more) : NULL;
        if (!more) {
            return LMB_ERROR_MEMORY;
        }
        work->cell = more;
        work->cell_room = (uint32_t)room;
    }
    const lmb_result result = lmb_probe_index_add(&work->index[level], point, (int32_t)work->cell_count);
    if (result == LMB_OK) {
        unsigned probes = 0;
        for (int i = 0; i < 8; ++i) {
            probes += lmb_probes_find(work->probes, level, point[0] + (i & 1), point[1] + (i >> 1 & 1),
                                      point[2] + (i >> 2)) >= 0;
        }
        work->cell[work->cell_count++] = (lmb_region_cell){
            .point = {point[0], point[1], point[2]}, .level = level, .look = UINT32_MAX, .probes = (uint8_t)probes};
    }
    return result == LMB_ERROR_ARGUMENT ? LMB_OK : result;
}

/* The cells that the level's bounds reach into, on a lattice. */
static cell_range range_of_bounds(const lmb_region_work *work, const lmb_lattice *lattice)
{
    const lmb_scene *const scene = lmb_tracer_scene(work->tracer);
    const lmb_vec3 low = scene->bounds_min, high = scene->bounds_max;
    cell_range range = {{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
    for (int corner = 0; corner < 8; ++corner) {
        const lmb_vec3 at =
            lmb_vec3_of(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
        const lmb_vec3d local = lattice_place(work->probes, lattice, at);
        const double place[3] = {local.x, local.y, local.z};
        for (int axis = 0; axis < 3; ++axis) {
            const double first = floor(place[axis] + (double)GROWN_HALVES);
            const double last = floor(place[axis] - (double)GROWN_HALVES);
            range.first[axis] = first < range.first[axis] ? (int32_t)fmax(first, INT32_MIN + 2) : range.first[axis];
            range.last[axis] = last > range.last[axis] ? (int32_t)fmin(last, INT32_MAX - 2) : range.last[axis];
        }
    }
    return range;
}

static bool range_has(const cell_range *range, const int32_t point[3])
{
    bool has = true;
    for (int axis = 0; axis < 3; ++axis) {
        has = has && point[axis] >= range->first[axis] && point[axis] <= range->last[axis];
    }
    return has;
}

/* Whether boxes without probes have all of a cell's corners. */
static bool cell_is_excluded(const lmb_region_work *work, uint32_t level, const int32_t cell[3])
{
    const lmb_scene *const scene = lmb_tracer_scene(work->tracer);
    const lmb_lattice *const lattice = &work->probes->level[level].lattice;
    bool excluded = scene->probe_box_count > 0;
    for (int i = 0; i < 8 && excluded; ++i) {
        const int32_t point[3] = {cell[0] + (i & 1), cell[1] + (i >> 1 & 1), cell[2] + (i >> 2)};
        excluded = lmb_scene_probes_excluded(scene, lmb_scene_from_world(scene, lmb_lattice_position(lattice, point)));
    }
    return excluded;
}

static bool cell_counts(const lmb_region_work *work, uint32_t level, const cell_range *bounds, const int32_t cell[3])
{
    return range_has(bounds, cell) && lmb_probes_level_has(work->probes, level, cell) &&
           !cell_is_excluded(work, level, cell);
}

/* All cells that have a probe at a corner. */
static lmb_result cells_add(lmb_region_work *work, uint32_t level, const cell_range *bounds)
{
    const lmb_probe_level *const own = &work->probes->level[level];
    lmb_result result = LMB_OK;
    for (int32_t probe = own->first; probe < own->first + own->count; ++probe) {
        for (int i = 0; i < 8 && result == LMB_OK; ++i) {
            const int32_t *const at = work->probes->point[probe];
            const int32_t point[3] = {at[0] - (i & 1), at[1] - (i >> 1 & 1), at[2] - (i >> 2)};
            if (cell_counts(work, level, bounds, point)) {
                result = cell_add(work, level, point);
            }
        }
    }
    return result;
}

/* Cells beside those that are touched: the corner of a room may have none of its probes. */
static lmb_result cells_around(lmb_region_work *work, uint32_t level, uint32_t first, const cell_range *bounds)
{
    const uint32_t count = work->cell_count;
    lmb_result result = LMB_OK;
    for (uint32_t i = first; i < count; ++i) {
        for (int n = 0; work->cell[i].look != UINT32_MAX && n < 27 && result == LMB_OK; ++n) {
            const int32_t *const at = work->cell[i].point;
            const int32_t point[3] = {at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1};
            if (cell_counts(work, level, bounds, point)) {
                result = cell_add(work, level, point);
            }
        }
    }
    return result;
}

/* --- touched ------------------------------------------------------------------------------------------------------ */

/* The cells that a triangle's box may touch, of those within bounds. */
static bool range_find(const lmb_probes *probes, const lmb_lattice *lattice, const cell_range *bounds,
                       const lmb_vec3 corner[3], cell_range *range)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int k = 0; k < 3; ++k) {
        const lmb_vec3d local = lattice_place(probes, lattice, corner[k]);
        const double at[3] = {local.x, local.y, local.z};
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = fmin(low[axis], at[axis]);
            high[axis] = fmax(high[axis], at[axis]);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double from = fmax(floor(low[axis] - (double)GROWN_HALVES), bounds->first[axis]);
        const double to = fmin(floor(high[axis] + (double)GROWN_HALVES), bounds->last[axis]);
        if (!(from <= to)) {
            return false;
        }
        range->first[axis] = (int32_t)from;
        range->last[axis] = (int32_t)to;
    }
    return true;
}

static void cell_mark(lmb_region_work *work, lmb_region_cell *cell, const lmb_vec3 corner[3])
{
    if (cell->look != UINT32_MAX) {
        return;
    }
    const lmb_region_frame frame = lmb_region_frame_of(work->probes, cell);
    const lmb_lattice *const lattice = &work->probes->level[cell->level].lattice;
    const lmb_vec3 centre = lmb_region_position(&frame, (const float[3]){0.5f, 0.5f, 0.5f});
    const float scale = 2.0f / ((1.0f + GROWN_HALVES) * frame.spacing);
    lmb_vec3 local[3];
    for (int k = 0; k < 3; ++k) {
        const lmb_vec3 from = lmb_vec3_sub(corner[k], centre);
        const lmb_vec3d turned =
            lmb_lattice_vector_from_world(lattice, (lmb_vec3d){(double)from.x, (double)from.y, (double)from.z});
        local[k] = lmb_vec3_scale(lmb_vec3_of((float)turned.x, (float)turned.y, (float)turned.z), scale);
    }
    cell->look = lmb_triangle_touches_cube(local) ? 0 : UINT32_MAX;
}

/* Looks at the cells of the triangle's box, or at all cells where these are fewer. */
static void triangle_mark(lmb_region_work *work, uint32_t level, uint32_t first, const cell_range *bounds,
                          const lmb_vec3 corner[3])
{
    cell_range range;
    if (!range_find(work->probes, &work->probes->level[level].lattice, bounds, corner, &range)) {
        return;
    }
    double cells = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        cells *= (double)range.last[axis] - range.first[axis] + 1.0;
    }
    if (cells > (double)(work->cell_count - first)) {
        for (uint32_t i = first; i < work->cell_count; ++i) {
            if (range_has(&range, work->cell[i].point)) {
                cell_mark(work, &work->cell[i], corner);
            }
        }
        return;
    }
    for (int32_t z = range.first[2]; z <= range.last[2]; ++z) {
        for (int32_t y = range.first[1]; y <= range.last[1]; ++y) {
            for (int32_t x = range.first[0]; x <= range.last[0]; ++x) {
                const int32_t cell = lmb_probe_index_find(&work->index[level], (const int32_t[3]){x, y, z});
                if (cell >= 0) {
                    cell_mark(work, &work->cell[cell], corner);
                }
            }
        }
    }
}

/* Marks the cells from `first` on, a level's, that triangles touch: those that anything is see-through in do not
 * divide. */
static void cells_mark(lmb_region_work *work, uint32_t level, uint32_t first, const cell_range *bounds)
{
    const lmb_scene *const scene = lmb_tracer_scene(work->tracer);
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_instance *const instance = &scene->instances[i];
        for (uint32_t t = 0; t < scene->meshes[instance->mesh].triangle_count && !instance->dynamic; ++t) {
            lmb_vec3 corner[3];
            if (!lmb_tracer_is_see_through(work->tracer, i, t)) {
                lmb_trace_corners(work->tracer, i, t, corner);
                triangle_mark(work, level, first, bounds, corner);
            }
        }
    }
}

lmb_result lmb_region_cells_find(lmb_region_work *work)
{
    lmb_result result = LMB_OK;
    for (uint32_t level = 0; level < work->probes->level_count && result == LMB_OK; ++level) {
        const uint32_t first = work->cell_count;
        const cell_range bounds = range_of_bounds(work, &work->probes->level[level].lattice);
        result = cells_add(work, level, &bounds);
        if (result == LMB_OK) {
            cells_mark(work, level, first, &bounds);
            result = cells_around(work, level, first, &bounds);
            cells_mark(work, level, first, &bounds);
        }
    }
    for (uint32_t i = 0; i < work->cell_count; ++i) {
        work->look_count += work->cell[i].look != UINT32_MAX;
    }
    work->look_room = work->look_count + 1;
    work->look = calloc((size_t)work->look_count + 1, sizeof *work->look);
    work->looked = malloc(((size_t)work->look_count + 1) * sizeof *work->looked);
    if (result != LMB_OK || !work->look || !work->looked) {
        return result != LMB_OK ? result : LMB_ERROR_MEMORY;
    }
    uint32_t look = 0;
    for (uint32_t i = 0; i < work->cell_count; ++i) {
        if (work->cell[i].look != UINT32_MAX) {
            work->looked[look] = i;
            work->cell[i].look = look++;
        }
    }
    return LMB_OK;
}
