/* Images from memory, so that a file is read once and what was hashed is what was decoded. */
#ifndef LMB_IMAGE_INTERNAL_H
#define LMB_IMAGE_INTERNAL_H

#include <lambent/image.h>

#include "image/image_bytes.h"

/* As lmb_image_read. */
lmb_result lmb_image_decode(const lmb_image_bytes *file, lmb_image *image, lmb_latlong_axes *axes, size_t *bad_pixels,
                            lmb_error *error);

#endif
