/* What tinygltf gets to see of a file. */
#ifndef LMB_GLTF_SHOWN_H
#define LMB_GLTF_SHOWN_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The checked JSON as text for tinygltf, for cJSON_free; NULL when out of memory. tinygltf takes wrong types for absent
 * ones, and indexes buffers without looking: it sees nothing but what passed the checks. */
char *lmb_gltf_text_for_tinygltf(const lmb_gltf_file *file);

#ifdef __cplusplus
}
#endif

#endif
