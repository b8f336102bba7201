/* One probe's bytes, read. */
#ifndef LMB_VOLUME_PROBE_INTERNAL_H
#define LMB_VOLUME_PROBE_INTERNAL_H

#include "volume_internal.h"

/* Its radiance, and what it sees of key lights (NULL: nobody asks). */
void lmb_volume_probe_read(const lmb_volume *volume, const unsigned char *probe, lmb_sh3_rgb *radiance,
                           float visibility[LMB_KEY_LIGHTS_MOST]);

/* Its coefficients as halfs, without the scale. */
void lmb_volume_probe_read_halfs(const lmb_volume *volume, const unsigned char *probe,
                                 uint16_t half[LMB_PROBE_COEFFICIENTS]);

/* What it sees of each of the volume's key lights, in 255ths. */
static inline const unsigned char *lmb_volume_probe_seen(const lmb_volume *volume, const unsigned char *probe)
{
    return probe + (volume->header->probe_form == LMB_VOLUME_COMPACT ? LMB_COMPACT_BYTES : LMB_HALFS_BYTES);
}

/* The nearest half, ties to even; of what is beyond halfs, the largest one. No NaN. */
static inline uint16_t lmb_volume_half_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint32_t sign = bits >> 16 & 0x8000u;
    bits &= 0x7fffffffu;
    if (bits < 0x38800000u) { /* below 2^-14: in steps of 2^-24, which are those of floats above 1/2 */
        float size, half = 0.5f;
        memcpy(&size, &bits, sizeof size);
        size += half;
        memcpy(&bits, &size, sizeof bits);
        return (uint16_t)(sign | (bits - 0x3f000000u));
    }
    const uint32_t rounded = (bits + 0xfffu + (bits >> 13 & 1u)) >> 13;
    const uint32_t half = rounded - (112u << 10);
    return (uint16_t)(sign | (half < 0x7c00u ? half : 0x7bffu));
}

#endif
