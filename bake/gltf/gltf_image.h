/* The pictures of a level. */
#ifndef LMB_GLTF_IMAGE_H
#define LMB_GLTF_IMAGE_H

#include <lambent/scene.h>

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The still encoded bytes of an image, or why there are none. Adds external ones to file->hash; `name` (malloc'ed, may
 * be NULL) gets its URI or "image N".
 * @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_image_read(lmb_gltf_file *file, const cJSON *image, uint32_t index, lmb_gltf_bytes *bytes,
                               char **name, lmb_error *error);

/* Image `index` of the list, read and decoded: PNG or JPEG. On failure `*image` stays as it was; else its owner frees
 * its name and pixels.
 * @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_image_decode(lmb_gltf_file *file, const cJSON *item, uint32_t index, lmb_texture_image *image,
                                 lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
