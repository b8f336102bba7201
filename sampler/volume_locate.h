/* Finding the cell of a position, and the corners' weights, in plain C. */
#ifndef LMB_VOLUME_LOCATE_H
#define LMB_VOLUME_LOCATE_H

#include "volume_cut.h"
#include "volume_internal.h"

#include <string.h>

typedef struct located {
    double at[3];
} located;

/* @return false when the position was outside and clamped */
static inline bool locate(const lmb_volume *volume, double x, double y, double z, located *found, uint32_t cell[3])
{
    const double in[3] = {x, y, z};
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) {
        const double first = volume->first[axis], last = volume->last[axis];
        const double at = in[axis] * volume->inverse_spacing - volume->origin[axis];
        const double clamped = at > first ? (at < last ? at : last) : first;
        const int32_t whole = (int32_t)clamped;
        cell[axis] = (uint32_t)(whole < volume->last_cell[axis] ? whole : volume->last_cell[axis]);
        found->at[axis] = clamped;
        inside &= at >= volume->nearest[axis] && at <= volume->farthest[axis];
    }
    return inside;
}

typedef struct fraction {
    float t[3];
} fraction;

static inline fraction fraction_find(const located *found, const uint32_t cell[3], uint32_t level)
{
    const double inverse = 1.0 / (double)(UINT32_C(1) << level);
    fraction at;
    for (uint32_t axis = 0; axis < 3; ++axis) {
        at.t[axis] = (float)(found->at[axis] * inverse - (double)(int32_t)(cell[axis] >> level));
    }
    return at;
}

static inline void fraction_store(fraction at, float t[3])
{
    memcpy(t, at.t, sizeof at.t);
}

static inline uint32_t planes_ask(const lmb_cell_plane plane[2], fraction at)
{
    return lmb_volume_plane_side(&plane[0], at.t) | lmb_volume_plane_side(&plane[1], at.t) << 1;
}

#define places_find lmb_volume_cut_places

static inline void places_point(const lmb_volume *volume, const uint32_t place[8], const unsigned char *corner[8])
{
    for (int i = 0; i < 8; ++i) {
        corner[i] = lmb_volume_probe_at(volume, place[i]);
    }
}

static inline void weights_store(fraction at, float weight[8])
{
    const float u[2] = {1.0f - at.t[0], at.t[0]}, v[2] = {1.0f - at.t[1], at.t[1]}, w[2] = {1.0f - at.t[2], at.t[2]};
    for (uint32_t i = 0; i < 8; ++i) {
        weight[i] = u[i & 1u] * v[i >> 1 & 1u] * w[i >> 2];
    }
}

#endif
