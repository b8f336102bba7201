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

static inline void weights_store(fraction at, float weight[8])
{
    const float u[2] = {1.0f - at.t[0], at.t[0]}, v[2] = {1.0f - at.t[1], at.t[1]}, w[2] = {1.0f - at.t[2], at.t[2]};
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
static inline void blend_corners(const unsigned char *const corner[8], fraction at, float scale, lmb_sh3_rgb *radiance)
{
    float sum[LANES] = {0.0f}, weight[8];
    weights_store(at, weight);
    for (uint32_t i = 0; i < 8; i += 2) {
        const float weight_a = weight[i] * 0x1p112f;
        const float weight_b = weight[i + 1] * 0x1p112f;
        float a[LANES], b[LANES];
        halfs_expand(corner[i], a);
        halfs_expand(corner[i + 1], b);
        for (int k = 0; k < LANES; ++k) {
            const float pair = weight_a * a[k] + weight_b * b[k];
            sum[k] = i == 0 ? pair : sum[k] + pair;
        }
    }
    for (int k = 0; k < LANES; ++k) {
        sum[k] *= scale;
    }
    memcpy(radiance, sum, sizeof *radiance);
}

#include "volume_sample_body.h"

const lmb_volume_kernel lmb_volume_kernel_scalar = LMB_VOLUME_KERNEL("C");
