/* A glTF file, opened and checked. */
#ifndef LMB_GLTF_OPEN_H
#define LMB_GLTF_OPEN_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads and checks everything but what the accessors' elements say. */
lmb_result lmb_gltf_file_open(const char *path, const lmb_gltf_options *options, lmb_gltf_file **file,
                              lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
