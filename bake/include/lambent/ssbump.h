/* Self-shadowed bump maps: for each texel of a height map, how much of the light on each slope of radiosity normal
 * mapping (lambent/rnm.h) its surface takes, so that no normal map is needed and bumps shade each other (Green,
 * "Efficient Self-Shadowed Radiosity Normal Mapping", SIGGRAPH 2007).
 *
 * A weight is max(0, n.B_i)^2 over the sum of the three, of the height map's own normal n, times the share of the cone
 * of 120 degrees about B_i that the heights around leave open, weighted by the cosine with B_i, which light on the
 * slope is weighted by. What is below the mean plane is not part of the cone, as no light on a lightmap is from there:
 * a flat map has weights of a third each.
 *
 * B1 is towards the right of the picture, B2 up and to the left: tangents as glTF has them for normal maps. */
#ifndef LAMBENT_SSBUMP_H
#define LAMBENT_SSBUMP_H

#include <stdbool.h>
#include <stdint.h>

#include <lambent/height.h>
#include <lambent/pool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_ssbump_settings {
    float scale_texels; /* height of white above black, in texels; >= 0 */
    bool wrap;          /* the map goes on at its other side; else nothing stands beyond its borders */
} lmb_ssbump_settings;

/* 16 texels, no wrap. */
lmb_ssbump_settings lmb_ssbump_settings_default(void);

/* Fills `rgb`, 3 bytes a texel: weights of B1, B2, B3 in 255ths. The bytes do not depend on the pool's threads; with
 * wrap they move with the map. @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_ssbump_make(const lmb_height_map *map, const lmb_ssbump_settings *settings, lmb_pool *pool,
                           const lmb_progress *progress, uint8_t *rgb);

#ifdef __cplusplus
}
#endif

#endif
