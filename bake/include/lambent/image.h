/* Images: environments and lightmaps in float, pictures out. Row 0 is the top; pixels are interleaved. */
#ifndef LAMBENT_IMAGE_H
#define LAMBENT_IMAGE_H

#include <stddef.h>
#include <stdint.h>

#include <lambent/error.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Linear float RGB, 3 floats a pixel, malloc'ed. */
typedef struct lmb_image {
    int32_t width;
    int32_t height;
    float *rgb;
} lmb_image;

/* How a latitude-longitude image lies around the scene. */
typedef enum lmb_latlong_axes {
    LMB_LATLONG_GLTF,   /* row 0 is +Y, u = 0.5 is +X, u = 0.75 is +Z: as three.js has it; .hdr and plain .exr */
    LMB_LATLONG_OPENEXR /* the axes of OpenEXR's `envmap` attribute: row 0 is +Y, u = 0.5 is +Z, u = 0.25 is +X */
} lmb_latlong_axes;

/* Reads a Radiance .hdr (scanlines in any order) or an OpenEXR .exr (the first part, scanline or tiled, level 0,
 * half/float/uint, any compression; channels R G B, else Y, else those of the first layer `Combined`, else those of the
 * only layer that has R G B). Told apart by content, not by extension. NaN, infinite and negative values are set to 0;
 * pixels that had one are counted in `*bad_pixels` (may be NULL). An EXR's data window must be its display window;
 * chromaticities and EXPOSURE are not applied.
 * `*axes` (may be NULL) is set from the `envmap` attribute. A cube-map EXR is refused.
 * @return LMB_ERROR_IO, _FORMAT (broken, whatever the decoder calls it), _UNSUPPORTED, _MEMORY */
lmb_result lmb_image_read(const char *path, lmb_image *image, lmb_latlong_axes *axes, size_t *bad_pixels,
                          lmb_error *error);

/* Frees the pixels; the struct may then be reused. */
void lmb_image_free(lmb_image *image);

/* 8-bit sRGB PNG of 3 bytes a pixel. Writes beside, then renames. @return LMB_ERROR_WRITE, _MEMORY, _ARGUMENT */
lmb_result lmb_png_write(const char *path, int32_t width, int32_t height, const uint8_t *srgb, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
