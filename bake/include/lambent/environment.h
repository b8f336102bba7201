/* The light that comes from around a scene. */
#ifndef LAMBENT_ENVIRONMENT_H
#define LAMBENT_ENVIRONMENT_H

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Sets the environment from a description:
 *     a path to .hdr or .exr, or #rrggbb (sRGB constant colour), or "none";
 * each may be followed by options, ",rotation=DEG" and ",strength=X". A picture must be twice as wide as high, within
 * 1 % of its height. Continues scene->content_hash.
 * @return LMB_ERROR_FORMAT, _IO, _UNSUPPORTED, _MEMORY */
lmb_result lmb_scene_set_environment(lmb_scene *scene, const char *description, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
