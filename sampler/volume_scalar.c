/* Sampling in plain C: what every processor runs, and what the others are held against. */
#include "volume_kernel.h"

#include "volume_internal.h"

#include <string.h>

/* Halfs read at once from a probe: its 27 and 5 of what follows, so that the loop has a round number of turns. */
enum { LANES = 32 };

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

/* The cell's number in its brick, and the position in it, 0 to 1. */
static inline uint32_t locate_in_brick(const located *found, const uint32_t cell[3], uint32_t level, float t[4])
{
    const double inverse = 1.0 / (double)(UINT32_C(1) << level);
    uint32_t number = 0;
    for (uint32_t axis = 0; axis < 3; ++axis) {
        const uint32_t of_level = cell[axis] >> level;
        t[axis] = (float)(found->at[axis] * inverse - (double)(int32_t)of_level);
        number |= (of_level & 3u) << 2 * axis;
    }
    t[3] = 0.0f;
    return number;
}

static inline void weights_find(const float t[4], float weight[8])
{
    const float u[2] = {1.0f - t[0], t[0]}, v[2] = {1.0f - t[1], t[1]}, w[2] = {1.0f - t[2], t[2]};
    for (uint32_t i = 0; i < 8; ++i) {
        weight[i] = u[i & 1u] * v[i >> 1 & 1u] * w[i >> 2];
    }
}

/* The bits of finite halfs, moved to their places in floats, are their values times 2^-112 (denormals too). */
static inline void halfs_expand(const unsigned char *probe, float value[LANES])
{
    uint16_t half[LANES];
    uint32_t bits[LANES];
    memcpy(half, probe, sizeof half);
    for (int k = 0; k < LANES; ++k) {
        const uint32_t wide = half[k];
        bits[k] = (wide & 0x7fffu) << 13 | (wide & 0x8000u) << 16;
    }
    memcpy(value, bits, sizeof bits);
}

/* Weighted sum over the corners. A weight of 0 is harmless: every stored half is finite. In loops so plain that
 * compilers find them to be vectors. */
static inline void blend_corners(const unsigned char *const corner[8], const float weight[8], float scale,
                                 lmb_sh3_rgb *radiance)
{
    float sum[LANES] = {0.0f};
    for (uint32_t i = 0; i < 8; i += 2) {
        const float weight_a = weight[i] * 0x1p112f;
        const float weight_b = weight[i + 1] * 0x1p112f;
        float a[LANES], b[LANES];
        halfs_expand(corner[i], a);
        halfs_expand(corner[i + 1], b);
        for (int k = 0; k < LANES; ++k) {
            sum[k] += weight_a * a[k] + weight_b * b[k];
        }
    }
    for (int k = 0; k < LANES; ++k) {
        sum[k] *= scale;
    }
    memcpy(radiance, sum, sizeof *radiance);
}

#include "volume_sample_body.h"

const lmb_volume_kernel lmb_volume_kernel_scalar = {"C", sample, sample_with_keys, sample_batch};
