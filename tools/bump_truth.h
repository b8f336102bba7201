/* Light on a height map by its definition, which pictures of bump maps are held against. */
#ifndef LMB_TOOLS_BUMP_TRUTH_H
#define LMB_TOOLS_BUMP_TRUTH_H

#include <lambent/height.h>
#include <lambent/rnm.h>

#include "specular_light.h"

/* A floor that repeats: its picture's right is +X, its lower side +Z. */
typedef struct bump_floor {
    lmb_height_map map;
    float scale_texels; /* height of white above black */
} bump_floor;

/* Unit, by central differences. */
lmb_vec3 bump_normal(const bump_floor *bumps, int x, int y);

/* Normalised irradiance of a texel's surface by the picture's cells and the sun, without light from bump to bump.
 * `shadows`: of what heights around leave open; else of all above the horizon of the floor. */
lmb_rgb bump_irradiance(const bump_floor *bumps, const specular_light *light, int x, int y, bool shadows);

/* Adds light from bump to bump to `irradiance` of all texels, of a floor that reflects `albedo` of it, by `samples`
 * rays a texel and so many bounces. @return LMB_ERROR_MEMORY */
lmb_result bump_bounces_add(const bump_floor *bumps, float albedo, uint32_t samples, int bounces, lmb_rgb *irradiance);

/* What a lightmap's texel for the whole floor stores: light on the slopes about +X, -Z and +Y. */
lmb_rnm bump_slope_light(const specular_light *light, lmb_vec3 slope[LMB_RNM_SLOPES]);

#endif
