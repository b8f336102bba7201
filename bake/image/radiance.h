/* Radiance .hdr files. */
#ifndef LMB_RADIANCE_H
#define LMB_RADIANCE_H

#include <stdbool.h>

#include <lambent/image.h>

#include "image/image_bytes.h"

bool lmb_radiance_is(const lmb_image_bytes *file);

/* Pixels come as the file has them. @return as lmb_image_read */
lmb_result lmb_radiance_decode(const lmb_image_bytes *file, lmb_image *image, lmb_error *error);

#endif
