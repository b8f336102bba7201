/* Reading OpenEXR from memory. */
#ifndef LMB_EXR_INTERNAL_H
#define LMB_EXR_INTERNAL_H

#include <stdbool.h>

#include <lambent/exr.h>
#include <lambent/image.h>

#include "image/image_bytes.h"

#ifdef __cplusplus
extern "C" {
#endif

bool lmb_exr_is(const lmb_image_bytes *file);

/* A picture; pixels come as the file has them, NaN and negative ones too. @return as lmb_image_read */
lmb_result lmb_exr_decode(const lmb_image_bytes *file, lmb_image *image, lmb_latlong_axes *axes, lmb_error *error);

/* As lmb_exr_read_channels. */
lmb_result lmb_exr_decode_channels(const lmb_image_bytes *file, const char *const *names, size_t count, float **values,
                                   lmb_exr_header *header, lmb_error *error);

/* Where a channel's pixels go: value (x, y) at base[(y width + x) stride]. */
typedef struct lmb_exr_target {
    const char *channel;
    float *base;
    int32_t stride;
} lmb_exr_target;

typedef struct lmb_exr_targets {
    const lmb_exr_target *target;
    size_t count;
    int32_t width, height; /* of the picture */
} lmb_exr_targets;

/* Whether the attributes of all headers lie within the file, and are as long as their types. */
bool lmb_exr_attributes_fit(const lmb_image_bytes *file);

/* The pixels of a file's first part, whose header is known to be good and whose attributes fit. @return
 * LMB_ERROR_FORMAT, or LMB_ERROR_MEMORY, which a broken file may also bring about */
lmb_result lmb_exr_decode_dwa(const lmb_image_bytes *file, const lmb_exr_targets *targets, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
