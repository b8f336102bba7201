/* Regions of levels beside each other. A corner of a finer region that touches a coarser one has no light of its own,
 * but that region's interpolation: there is no step between, and no wall is crossed. */
#include "probes/regions_internal.h"

#include <stdlib.h>
#include <string.h>

enum { UNASKED = LMB_REGION_NONE - 1 };

/* A face of a cell, and what lies beyond: a coarser cell. */
typedef struct border {
    const lmb_region_cell *fine, *coarse;
    int axis, side;
    uint8_t beyond[LMB_REGION_LINES]; /* [line] the coarser cell's region there, or UNASKED */
} border;

static const lmb_region_look *look_of(const lmb_region_work *work, const lmb_region_cell *cell)
{
    return cell->look == UINT32_MAX ? NULL : &work->look[cell->look];
}

/* Whether a place is on a region's side of what divides it from another one. */
static bool is_on_side(const lmb_region_look *look, uint8_t label, const float t[3])
{
    bool is = true;
    for (uint32_t i = 0; i < look->extension_count; ++i) {
        const lmb_region_extension *const extension = &look->extension[i];
        const bool is_above = lmb_region_above(&extension->plane, t) > 0.0f;
        is = is && label != extension->label[is_above ? 0 : 1];
    }
    return is;
}

/* The region of a cell at a place in it: that of a node nearby that sees it. */
static uint8_t region_at(lmb_region_work *work, const lmb_region_cell *cell, lmb_vec3 place)
{
    enum { TRIED = 4 };
    const lmb_region_look *const look = look_of(work, cell);
    if (!look) {
        return 0;
    }
    const lmb_region_frame frame = lmb_region_frame_of(work->probes, cell);
    const lmb_vec3 own = lmb_region_coordinates(&frame, place);
    bool left[LMB_REGION_NODES];
    lmb_vec3 point = place;
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        const uint8_t label = look->label[node];
        left[node] = label != LMB_REGION_NONE && is_on_side(look, label, (const float[3]){own.x, own.y, own.z});
    }
    for (int i = 0; i < TRIED; ++i) {
        const int node = lmb_region_node_next(&frame, place, left, &point);
        if (node < 0) {
            return LMB_REGION_NONE;
        }
        if (lmb_rgb_max(lmb_trace_transmittance(work->tracer, point, place, &work->stats->rays)) > 0.0f) {
            return look->label[node];
        }
    }
    return LMB_REGION_NONE;
}

/* The regions on both sides of a face at a line; false where it is closed. */
static bool line_regions(lmb_region_work *work, border *at, int line, uint8_t *fine, uint8_t *coarse)
{
    const lmb_region_look *const look = look_of(work, at->fine);
    const int node = lmb_region_line_node(at->axis, line, at->side * (LMB_REGION_SIDE - 1));
    *fine = look ? look->label[node] : 0;
    if (*fine == LMB_REGION_NONE || (look && (look->open[2 * at->axis + at->side] >> line & 1u) == 0)) {
        return false;
    }
    if (at->beyond[line] == UNASKED) {
        const lmb_region_frame frame = lmb_region_frame_of(work->probes, at->fine);
        float t[3];
        lmb_region_node_at(node, t);
        t[at->axis] = at->side != 0 ? 1.0f + LMB_REGION_INSET : -LMB_REGION_INSET;
        at->beyond[line] = region_at(work, at->coarse, lmb_region_position(&frame, t));
    }
    *coarse = at->beyond[line];
    return *coarse != LMB_REGION_NONE;
}

static lmb_result link_add(lmb_region_work *work, const lmb_region_link *link)
{
    if (work->link_count == work->link_room) {
        const size_t room = work->link_room > 0 ? 2 * (size_t)work->link_room : 256;
        lmb_region_link *const more = room < UINT32_MAX ? realloc(work->link, room * sizeof *more) : NULL;
        if (!more) {
            return LMB_ERROR_MEMORY;
        }
        work->link = more;
        work->link_room = (uint32_t)room;
    }
    work->link[work->link_count++] = *link;
    return LMB_OK;
}

/* Where a corner of the finer cell lies in the coarser one. */
static void corner_place(const border *at, int corner, float t[3])
{
    const int64_t step = (int64_t)1 << (at->coarse->level - at->fine->level);
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t point = (int64_t)at->fine->point[axis] + (corner >> axis & 1);
        t[axis] = (float)(point - step * at->coarse->point[axis]) / (float)step;
    }
}

/* Links the finer cell's regions at a corner of the face, each by the line nearest to the corner that is open. */
static lmb_result corner_link(lmb_region_work *work, border *at, int corner)
{
    bool done[LMB_CELL_REGIONS_MOST] = {false};
    const int first = at->axis == 0 ? 1 : 0, last = at->axis == 2 ? 1 : 2;
    lmb_result result = LMB_OK;
    for (int steps = 0; steps <= 2 * (LMB_REGION_SIDE - 1); ++steps) {
        for (int a = 0; a < LMB_REGION_SIDE && a <= steps; ++a) {
            const int b = steps - a, low = LMB_REGION_SIDE - 1;
            uint8_t fine, coarse;
            if (b > low) {
                continue;
            }
            const int line = ((corner >> first & 1) != 0 ? low - a : a) +
                             LMB_REGION_SIDE * ((corner >> last & 1) != 0 ? low - b : b);
            if (!line_regions(work, at, line, &fine, &coarse) || done[fine] || result != LMB_OK) {
                continue;
            }
            done[fine] = true;
            lmb_region_link link = {.fine = at->fine->first + fine,
                                    .corner = (uint8_t)corner,
                                    .level = at->fine->level,
                                    .coarse = at->coarse->first + coarse,
                                    .steps = at->coarse->level - at->fine->level};
            corner_place(at, corner, link.t);
            result = link_add(work, &link);
        }
    }
    return result;
}

/* The coarser cell that holds the place of a finer one, or NULL. */
static const lmb_region_cell *coarser_cell(const lmb_region_work *work, uint32_t level, const int32_t point[3])
{
    for (uint32_t above = level + 1; above < work->probes->level_count && above - level < 31; ++above) {
        int32_t at[3];
        for (int axis = 0; axis < 3; ++axis) {
            const int64_t step = (int64_t)1 << (above - level), rest = point[axis] & (step - 1);
            at[axis] = (int32_t)((point[axis] - rest) / step);
        }
        const int32_t found = lmb_probe_index_find(&work->index[above], at);
        if (found >= 0) {
            return &work->cell[found];
        }
    }
    return NULL;
}

lmb_result lmb_region_levels_link(lmb_region_work *work)
{
    lmb_result result = LMB_OK;
    for (uint32_t i = 0; i < work->cell_count && work->probes->level_count > 1; ++i) {
        const lmb_region_cell *const cell = &work->cell[i];
        for (int face = 0; face < 6 && cell->count > 0 && result == LMB_OK; ++face) {
            int32_t next[3] = {cell->point[0], cell->point[1], cell->point[2]};
            next[face / 2] += face % 2 != 0 ? 1 : -1;
            if (lmb_probe_index_find(&work->index[cell->level], next) >= 0) {
                continue;
            }
            border at = {
                .fine = cell, .coarse = coarser_cell(work, cell->level, next), .axis = face / 2, .side = face % 2};
            memset(at.beyond, UNASKED, sizeof at.beyond);
            for (int corner = 0; corner < 8 && at.coarse && at.coarse->count > 0 && result == LMB_OK; ++corner) {
                if ((corner >> at.axis & 1) == at.side) {
                    result = corner_link(work, &at, corner);
                }
            }
        }
    }
    return result;
}

/* --- what hangs --------------------------------------------------------------------------------------------------- */

static void hanging_add(lmb_regions *made, uint32_t level, int32_t value, const int32_t parent[8],
                        const float weight[8])
{
    lmb_region_hanging *const hanging = &made->hanging[made->hanging_count];
    *hanging = (lmb_region_hanging){.value = value, .level = level};
    memcpy(hanging->parent, parent, sizeof hanging->parent);
    memcpy(hanging->weight, weight, sizeof hanging->weight);
    made->hangs[value] = 1;
    ++made->hanging_count;
}

/* The coarsest first; then in the order of links. */
static int links_compare(const void *left, const void *right)
{
    const lmb_region_link *const a = left, *const b = right;
    if (a->steps != b->steps) {
        return a->steps > b->steps ? -1 : 1;
    }
    return a->fine != b->fine ? (a->fine < b->fine ? -1 : 1) : (int)a->corner - (int)b->corner;
}

/* Values of coarser levels first: finer ones hang on them. */
static int hanging_compare(const void *left, const void *right)
{
    const lmb_region_hanging *const a = left, *const b = right;
    if (a->level != b->level) {
        return a->level > b->level ? -1 : 1;
    }
    return a->value < b->value ? -1 : a->value > b->value;
}

lmb_result lmb_region_hanging_find(lmb_region_work *work)
{
    lmb_regions *const made = work->regions;
    made->hangs = calloc((size_t)work->probes->count + 1, 1);
    made->hanging = malloc(((size_t)work->probes->count + 1) * sizeof *made->hanging);
    if (!made->hangs || !made->hanging) {
        return LMB_ERROR_MEMORY;
    }
    if (work->link_count > 0) {
        qsort(work->link, work->link_count, sizeof *work->link, links_compare);
    }
    for (uint32_t i = 0; i < work->link_count; ++i) {
        const lmb_region_link *const link = &work->link[i];
        const int32_t value = work->corner[link->fine][link->corner];
        if (value >= 0 && work->corner[link->coarse][0] >= 0 && !made->hangs[value]) {
            float weight[8];
            lmb_region_weights(link->t, weight);
            hanging_add(made, link->level, value, work->corner[link->coarse], weight);
        }
    }
    qsort(made->hanging, made->hanging_count, sizeof *made->hanging, hanging_compare);
    return LMB_OK;
}
