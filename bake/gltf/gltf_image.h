/* The images of a glTF file. */
#ifndef LMB_GLTF_IMAGE_H
#define LMB_GLTF_IMAGE_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The still encoded bytes of an image, or why there are none. Adds external ones to file->hash; `name` (malloc'ed, may
 * be NULL) gets its URI or "image N". */
lmb_result lmb_gltf_image_read(lmb_gltf_file *file, const cJSON *image, uint32_t number, lmb_gltf_bytes *bytes,
                               char **name, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
