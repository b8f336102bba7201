/* Spheres under every layer of specular reflection, a row for each roughness. */
#ifndef LMB_TOOLS_SPECULAR_PICTURE_H
#define LMB_TOOLS_SPECULAR_PICTURE_H

#include "specular_light.h"

/* From left to right: the sun's highlight, the dominant light's, the area layer, the environment's, the sun with the
 * environment's, and the reference. @return LMB_ERROR_WRITE, _MEMORY */
lmb_result specular_picture_write(const char *path, const specular_light *light, lmb_rgb f0, lmb_error *error);

#endif
