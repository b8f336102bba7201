/* Passing the planes that divide a cell beyond what ends in it on to the cells beside: an end near a face would else
 * leave its light to the far corners of that face, which both sides have. */
#include "probes/regions_internal.h"

#include <math.h>
#include <stdlib.h>

/* Planes nearer to each other than that, in spacings, and of almost one normal, are one. */
#define SAME_PLANE 0.01f
#define SAME_COSINE 0.999f

/* Whether a cell has a plane already, or no room for one. */
static bool has_plane(const lmb_region_look *look, const lmb_region_plane *plane)
{
    bool has = look->extension_count >= LMB_REGION_EXTENSIONS_MOST;
    for (uint32_t i = 0; i < look->extension_count && !has; ++i) {
        const lmb_region_plane *const own = &look->extension[i].plane;
        const float cosine = lmb_vec3_dot(own->normal, plane->normal), side = cosine < 0.0f ? -1.0f : 1.0f;
        has = fabsf(cosine) > SAME_COSINE && fabsf(own->offset - side * plane->offset) < SAME_PLANE;
    }
    return has;
}

/* The look of a cell, which is empty if it had none. @return UINT32_MAX: out of memory */
static uint32_t look_add(lmb_region_work *work, uint32_t cell)
{
    if (work->cell[cell].look != UINT32_MAX) {
        return work->cell[cell].look;
    }
    if (work->look_count == work->look_room) {
        const size_t room = 2 * (size_t)work->look_room + 64;
        lmb_region_look *const look = realloc(work->look, room * sizeof *look);
        work->look = look ? look : work->look;
        uint32_t *const looked = look ? realloc(work->looked, room * sizeof *looked) : NULL;
        if (!looked) {
            return UINT32_MAX;
        }
        work->looked = looked;
        work->look_room = (uint32_t)room;
    }
    work->look[work->look_count] = (lmb_region_look){.count = 1};
    work->looked[work->look_count] = cell;
    return work->cell[cell].look = work->look_count++;
}

/* A plane of a cell, in the coordinates of another one. */
static lmb_region_plane plane_moved(const lmb_region_plane *plane, const lmb_region_cell *from,
                                    const lmb_region_cell *to)
{
    const float n[3] = {plane->normal.x, plane->normal.y, plane->normal.z};
    const double ratio = ldexp(1.0, (int)from->level - (int)to->level);
    double offset = (double)plane->offset * ratio;
    for (int axis = 0; axis < 3; ++axis) {
        offset += (double)n[axis] * (ratio * (double)from->point[axis] - (double)to->point[axis]);
    }
    return (lmb_region_plane){plane->normal, (float)offset};
}

bool lmb_region_plane_crosses(const lmb_region_plane *plane, const lmb_region_cell *from, const lmb_region_cell *to)
{
    const lmb_region_plane moved = plane_moved(plane, from, to);
    bool below = false, above = false;
    for (int i = 0; i < 8; ++i) {
        const float t[3] = {(float)(i & 1), (float)(i >> 1 & 1), (float)(i >> 2)};
        const bool is_above = lmb_region_above(&moved, t) > 0.0f;
        above = above || is_above;
        below = below || !is_above;
    }
    return below && above;
}

int lmb_region_cells_beside(const lmb_region_work *work, const lmb_region_cell *cell, int face, uint32_t beside[4])
{
    const int axis = face / 2, one = (axis + 1) % 3, other = (axis + 2) % 3;
    int32_t next[3] = {cell->point[0], cell->point[1], cell->point[2]};
    next[axis] += face % 2 != 0 ? 1 : -1;
    for (uint32_t level = cell->level; level < work->probes->level_count; ++level) {
        const int32_t found = lmb_probe_index_find(&work->index[level], next);
        if (found >= 0) {
            beside[0] = (uint32_t)found;
            return 1;
        }
        for (int i = 0; i < 3; ++i) {
            next[i] = (next[i] - (next[i] & 1)) / 2;
        }
    }
    int count = 0;
    for (int i = 0; i < 4 && cell->level > 0; ++i) {
        int32_t at[3];
        at[axis] = 2 * cell->point[axis] + (face % 2 != 0 ? 2 : -1);
        at[one] = 2 * cell->point[one] + (i & 1);
        at[other] = 2 * cell->point[other] + (i >> 1);
        const int32_t found = lmb_probe_index_find(&work->index[cell->level - 1], at);
        if (found >= 0) {
            beside[count++] = (uint32_t)found;
        }
    }
    return count;
}

/* Passes an extension on to a cell. @return false: out of memory */
static bool extension_pass(lmb_region_work *work, uint32_t look, uint32_t index, int face, uint32_t cell,
                           uint8_t *again)
{
    const lmb_region_cell *const from = &work->cell[work->looked[look]], *const to = &work->cell[cell];
    lmb_region_extension passed = work->look[look].extension[index];
    if (!lmb_region_plane_crosses(&passed.plane, from, to)) {
        return true;
    }
    const lmb_region_frame frame = lmb_region_frame_of(work->probes, from);
    float t[3];
    lmb_region_node_at(passed.anchor[face], t);
    passed.plane = plane_moved(&passed.plane, from, to);
    passed.rim = plane_moved(&passed.rim, from, to);
    passed.reach = ldexpf(passed.reach, (int)from->level - (int)to->level);
    passed.from = lmb_region_position(&frame, t);
    passed.faces = 0;
    passed.passed = true;
    const uint32_t number = look_add(work, cell);
    if (number == UINT32_MAX) {
        return false;
    }
    lmb_region_look *const own = &work->look[number];
    if (has_plane(own, &passed.plane)) {
        return true;
    }
    lmb_region_extension *const more = realloc(own->extension, (own->extension_count + 1) * sizeof *more);
    if (!more) {
        return false;
    }
    own->extension = more;
    more[own->extension_count++] = passed;
    again[cell] = 1;
    return true;
}

/* Passes on all that goes beyond a face. @return false: out of memory */
static bool all_pass(lmb_region_work *work, uint8_t *again)
{
    const uint32_t looks = work->look_count;
    bool good = true;
    for (uint32_t i = 0; i < looks; ++i) {
        for (uint32_t k = 0; k < work->look[i].extension_count; ++k) {
            for (int face = 0; face < 6 && good; ++face) {
                uint32_t beside[4];
                const bool goes_on = (work->look[i].extension[k].faces >> face & 1) != 0;
                const int count =
                    goes_on ? lmb_region_cells_beside(work, &work->cell[work->looked[i]], face, beside) : 0;
                for (int n = 0; n < count && good; ++n) {
                    good = extension_pass(work, i, k, face, beside[n], again);
                }
            }
        }
    }
    return good;
}

/* Keeps what was passed on to a cell: it finds its own anew. */
static void passed_keep(lmb_region_look *look)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < look->extension_count; ++i) {
        if (look->extension[i].passed) {
            look->extension[kept++] = look->extension[i];
        }
    }
    look->extension_count = kept;
}

lmb_result lmb_region_extensions_pass(lmb_region_work *work, size_t *count)
{
    uint8_t *const again = calloc((size_t)work->cell_count + 1, 1);
    const bool good = again && all_pass(work, again);
    *count = 0;
    for (uint32_t i = 0; i < work->look_count && good; ++i) {
        if (again[work->looked[i]]) {
            passed_keep(&work->look[i]);
            work->looking[(*count)++] = i;
        }
    }
    free(again);
    return good ? LMB_OK : LMB_ERROR_MEMORY;
}
