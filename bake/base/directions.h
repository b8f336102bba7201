/* Directions with the densities that light is gathered by. */
#ifndef LMB_DIRECTIONS_H
#define LMB_DIRECTIONS_H

#include <stdint.h>

#include <lambent/types.h>
#include <lambent/vector.h>

typedef enum lmb_lobe {
    LMB_LOBE_SPHERE,     /* uniform: 1 / (4 pi) */
    LMB_LOBE_HEMISPHERE, /* lmb_hemisphere_density: half uniform, half cosine */
    LMB_LOBE_COSINE      /* cosine / pi */
} lmb_lobe;

/* Directions about unit `axis` (any for the sphere) for points (x, y) of [0, 1)^2, of length 1 within 3e-7. */
void lmb_directions_make(lmb_lobe lobe, lmb_vec3 axis, const float *x, const float *y, uint32_t count,
                         float *const direction[3]);

/* One of them. */
lmb_vec3 lmb_direction_make(lmb_lobe lobe, lmb_vec3 axis, const float point[2]);

/* Density of the hemisphere's directions, cosine / pi mixed with uniform: half and half, so that neither irradiance nor
 * the scalar moment has unbounded weights. `cosine` is of the angle to the axis. */
static inline float lmb_hemisphere_density(float cosine)
{
    return cosine > 0.0f ? (0.5f + cosine) / (2.0f * LMB_PI_F) : 0.0f;
}

#endif
