/* Sets of lattice points. */
#include "probes/placement_internal.h"

#include <stdlib.h>
#include <string.h>

lmb_result lmb_point_set_add(lmb_point_set *set, const int32_t point[3])
{
    if (set->count == set->room) {
        if (set->room == LMB_POINT_SET_MOST) {
            const bool is_there = lmb_probe_index_find(&set->index, point) >= 0;
            return is_there ? LMB_OK : LMB_ERROR_UNSUPPORTED;
        }
        const int32_t room = set->room > 0 ? 2 * set->room : 64;
        int32_t(*const more)[3] = realloc(set->point, (size_t)room * sizeof *more);
        if (!more) {
            return LMB_ERROR_MEMORY;
        }
        set->point = more;
        set->room = room;
    }
    const lmb_result result = lmb_probe_index_add(&set->index, point, set->count);
    if (result == LMB_OK) {
        memcpy(set->point[set->count++], point, sizeof *set->point);
    }
    return result == LMB_ERROR_ARGUMENT ? LMB_OK : result;
}

void lmb_point_set_free(lmb_point_set *set)
{
    free(set->point);
    lmb_probe_index_free(&set->index);
    *set = (lmb_point_set){0};
}

/* x fastest. */
static int points_compare(const void *a, const void *b)
{
    const int32_t *const p = a, *const q = b;
    for (int axis = 2; axis >= 0; --axis) {
        if (p[axis] != q[axis]) {
            return p[axis] < q[axis] ? -1 : 1;
        }
    }
    return 0;
}

void lmb_point_set_sort(lmb_point_set *set)
{
    if (set->count > 0) {
        qsort(set->point, (size_t)set->count, sizeof *set->point, points_compare);
    }
}

lmb_lattice lmb_point_set_box(const lmb_point_set *set, float spacing)
{
    lmb_lattice box = {.spacing = spacing, .size = {1, 1, 1}};
    for (int axis = 0; axis < 3 && set->count > 0; ++axis) {
        int32_t low = set->point[0][axis], high = low;
        for (int32_t i = 1; i < set->count; ++i) {
            low = set->point[i][axis] < low ? set->point[i][axis] : low;
            high = set->point[i][axis] > high ? set->point[i][axis] : high;
        }
        box.min[axis] = low;
        box.size[axis] = high - low + 1;
    }
    return box;
}
