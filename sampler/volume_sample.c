#include "volume_internal.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Halfs read at once from a probe: its 27 and 5 of what follows, so that the loop has a round number of turns. */
enum { LANES = 32 };

/* The cell along one axis and the position in it, 0 to 1. @return false when the position was outside and clamped */
static inline bool locate(const lmb_volume *volume, int axis, double position, int32_t *cell, float *t)
{
    const double last = volume->last[axis];
    const double at = position * volume->inverse_spacing - volume->min[axis];
    const double clamped = at > 0.0 ? (at < last ? at : last) : 0.0;
    const int32_t whole = (int32_t)clamped;
    *cell = whole < volume->last_cell[axis] ? whole : volume->last_cell[axis];
    *t = (float)(clamped - *cell);
    return at >= -volume->slack && at <= last + volume->slack;
}

/* Gives the weight of missing corners to the others.
 * @return true when no missing corner had any weight to speak of */
static bool reweigh_corners(const lmb_volume_brick *brick, uint32_t first, const float t[3], double slack,
                            float weight[8])
{
    double share[8];
    double held = 0.0;
    double missing = 0.0;
    uint32_t held_count = 0;
    for (uint32_t i = 0; i < 8; ++i) {
        const double x = i & 1u ? (double)t[0] : 1.0 - (double)t[0];
        const double y = i & 2u ? (double)t[1] : 1.0 - (double)t[1];
        const double z = i & 4u ? (double)t[2] : 1.0 - (double)t[2];
        share[i] = x * y * z;
        if (lmb_brick_holds(brick, first + lmb_brick_corner(i))) {
            held += share[i];
            ++held_count;
        } else {
            missing += share[i];
            share[i] = -1.0;
        }
    }
    for (uint32_t i = 0; i < 8; ++i) {
        if (share[i] < 0.0) {
            weight[i] = 0.0f;
        } else {
            weight[i] = (float)(held > 0.0 ? share[i] / held : 1.0 / held_count);
        }
    }
    return missing <= 3.0 * slack;
}

/* The bits of a finite half, moved to their places in a float, are its value times 2^-112 (denormals too). */
static inline float half_bits_as_float(uint16_t half)
{
    const uint32_t bits = (uint32_t)(half & 0x7fffu) << 13 | (uint32_t)(half & 0x8000u) << 16;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Weighted sum over the corners. A weight of 0 is harmless: every stored half is finite. */
static void blend_corners(const lmb_volume_brick *brick, uint32_t first, const float weight[8], float scale,
                          lmb_sh3_rgb *radiance)
{
    float sum[LANES] = {0.0f};
    for (uint32_t i = 0; i < 8; i += 2) {
        const uint16_t *const a = &brick->sh[(first + lmb_brick_corner(i)) * LMB_BRICK_COEFFICIENTS];
        const uint16_t *const b = a + LMB_BRICK_COEFFICIENTS;
        const float weight_a = weight[i] * 0x1p112f;
        const float weight_b = weight[i + 1] * 0x1p112f;
        for (int k = 0; k < LANES; ++k) {
            sum[k] += weight_a * half_bits_as_float(a[k]) + weight_b * half_bits_as_float(b[k]);
        }
    }
    for (int k = 0; k < LANES; ++k) {
        sum[k] *= scale;
    }
    memcpy(radiance, sum, sizeof *radiance);
}

static void blend_visibility(const lmb_volume *volume, const lmb_volume_brick *brick, uint32_t first,
                             const float weight[8], float *visibility)
{
    const lmb_brick_visibility *const stored = lmb_volume_brick_visibility(brick);
    for (uint32_t key = 0; volume->keys && key < volume->keys->count; ++key) {
        float sum = 0.0f;
        for (uint32_t i = 0; i < 8; ++i) {
            sum += weight[i] * (float)stored[key].seen[first + lmb_brick_corner(i)];
        }
        visibility[key] = sum < 255.0f ? sum / 255.0f : 1.0f;
    }
}

/* The one body of all samples. `visibility` may be NULL. */
static inline bool sample_at(const lmb_volume *volume, double px, double py, double pz, lmb_sh3_rgb *radiance,
                             float *visibility)
{
    int32_t cell[3];
    float t[3];
    bool inside = locate(volume, 0, px, &cell[0], &t[0]);
    inside &= locate(volume, 1, py, &cell[1], &t[1]);
    inside &= locate(volume, 2, pz, &cell[2], &t[2]);
    const size_t entry =
        lmb_lattice_brick(volume->bricks_along, (size_t)(cell[0] >> 2), (size_t)(cell[1] >> 2), (size_t)(cell[2] >> 2));
    const uint32_t brick_index = volume->directory[entry];
    const bool is_nan = px != px || py != py || pz != pz; /* mingw-w64's isnan() narrows, and warns */
    if (brick_index == LMB_VOLUME_NO_BRICK || is_nan) {
        *radiance = (lmb_sh3_rgb){{{{0.0f}}}};
        return false;
    }
    const lmb_volume_brick *const brick = lmb_volume_brick_at(volume, brick_index);
    const uint32_t x = (uint32_t)cell[0] & 3u, y = (uint32_t)cell[1] & 3u, z = (uint32_t)cell[2] & 3u;
    const uint32_t first = lmb_brick_point(x, y, z);

    const float u[2] = {1.0f - t[0], t[0]}, v[2] = {1.0f - t[1], t[1]}, w[2] = {1.0f - t[2], t[2]};
    float weight[8];
    for (uint32_t i = 0; i < 8; ++i) {
        weight[i] = u[i & 1u] * v[i >> 1 & 1u] * w[i >> 2];
    }
    if (!(brick->complete_cells >> lmb_brick_cell(x, y, z) & 1u)) {
        inside &= reweigh_corners(brick, first, t, volume->slack, weight);
    }
    blend_corners(brick, first, weight, volume->scale, radiance);
    if (visibility) {
        blend_visibility(volume, brick, first, weight, visibility);
    }
    return inside;
}

bool lmb_volume_sample(const lmb_volume *volume, lmb_vec3 position, lmb_sh3_rgb *radiance)
{
    assert(volume && radiance);
    return sample_at(volume, (double)position.x, (double)position.y, (double)position.z, radiance, NULL);
}

bool lmb_volume_sample_at(const lmb_volume *volume, lmb_vec3d position, lmb_sh3_rgb *radiance)
{
    assert(volume && radiance);
    return sample_at(volume, position.x, position.y, position.z, radiance, NULL);
}

bool lmb_volume_sample_with_keys(const lmb_volume *volume, lmb_vec3d position, lmb_sh3_rgb *radiance,
                                 float visibility[LMB_KEY_LIGHTS_MOST])
{
    assert(volume && radiance && visibility);
    memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
    return sample_at(volume, position.x, position.y, position.z, radiance, visibility);
}
