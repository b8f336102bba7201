/* A dynamic object in a picture: a scene of its own, moved to a place in the level. It is lit by the level and does not
 * shade it. */
#ifndef LMB_TOOLS_RENDER_OBJECT_H
#define LMB_TOOLS_RENDER_OBJECT_H

#include <lambent/gltf.h>
#include <lambent/trace.h>

typedef struct lmb_render_object {
    lmb_scene *scene;
    lmb_tracer *tracer;
    lmb_vec3 position; /* of its scene's own space, in that of the level's */
} lmb_render_object;

/* Opens a glTF file, or with `path` NULL makes a white sphere (albedo 0.8) of `radius` metres around its origin. What
 * the file calls its origin goes to `position` of the level's scene. @return as lmb_gltf_load and lmb_tracer_create */
lmb_result render_object_open(const char *path, float radius, lmb_vec3d position, lmb_render_object *object,
                              lmb_error *error);
void render_object_close(lmb_render_object *object);

#endif
