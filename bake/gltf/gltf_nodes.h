/* What the file says of its nodes, apart from where they are. */
#ifndef LMB_GLTF_NODES_H
#define LMB_GLTF_NODES_H

#include <lambent/gltf.h>

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The vertical angle of view of a camera in radians; 0 of an orthographic one, or none (negative). */
float lmb_gltf_view_angle(const lmb_gltf_file *file, int32_t camera);

/* A warning for each pattern of the options that matches no node: it is mistyped, or the level has changed. */
void lmb_gltf_excludes_warn(const lmb_gltf_file *file, const lmb_gltf_options *options);

#ifdef __cplusplus
}
#endif

#endif
