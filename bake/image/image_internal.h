/* Images from memory, so that a file is read once and what was hashed is what was decoded. */
#ifndef LMB_IMAGE_INTERNAL_H
#define LMB_IMAGE_INTERNAL_H

#include <stdbool.h>

#include <lambent/image.h>

#ifdef __cplusplus
extern "C" {
#endif

/* More than any environment or lightmap has; keeps every size below in 32 bits for one channel. */
enum { LMB_IMAGE_MAX_SIDE = 1 << 16, LMB_IMAGE_MAX_PIXELS = 1 << 28 };

/* As lmb_image_read, from the file's bytes; `name` is for messages. */
lmb_result lmb_image_decode(const char *name, const unsigned char *data, size_t size, lmb_image *image,
                            lmb_latlong_axes *axes, size_t *bad_pixels, lmb_error *error);

bool lmb_radiance_is(const unsigned char *data, size_t size);
bool lmb_exr_is(const unsigned char *data, size_t size);

/* The decoders behind lmb_image_decode; pixels come as the file has them, NaN and negative ones too. */
lmb_result lmb_radiance_decode(const char *name, const unsigned char *data, size_t size, lmb_image *image,
                               lmb_error *error);
lmb_result lmb_exr_decode(const char *name, const unsigned char *data, size_t size, lmb_image *image,
                          lmb_latlong_axes *axes, lmb_error *error);

/* Where a channel's pixels go: value (x, y) at base[(y width + x) stride]. */
typedef struct lmb_exr_target {
    const char *channel;
    float *base;
    int32_t stride;
} lmb_exr_target;

/* The pixels of a file's first part, whose header is known to be good, `width` pixels wide. @return LMB_ERROR_FORMAT,
 * or LMB_ERROR_MEMORY, which a broken file may also bring about */
lmb_result lmb_exr_decode_dwa(const char *name, const unsigned char *data, size_t size, const lmb_exr_target *targets,
                              size_t count, int32_t width, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
