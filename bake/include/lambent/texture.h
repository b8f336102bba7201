/* Looking up textures. */
#ifndef LAMBENT_TEXTURE_H
#define LAMBENT_TEXTURE_H

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bilinear (or nearest) lookup at (u, v) before the texture's own transform; RGBA in [0, 1], colour channels decoded
 * from sRGB when `srgb`. White when the texture has no image. */
void lmb_texture_sample(const lmb_scene *scene, const lmb_texture *texture, lmb_vec2 uv, bool srgb, float rgba[4]);

/* sRGB byte to linear value, exact to float; the same on every machine. */
float lmb_srgb_to_linear(uint8_t byte);

#ifdef __cplusplus
}
#endif

#endif
