/* What of a level has changed between two times that it was loaded. */
#ifndef LAMBENT_SCENE_CONTENT_H
#define LAMBENT_SCENE_CONTENT_H

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum lmb_scene_part {
    LMB_SCENE_GEOMETRY,  /* meshes, where they stand, and what is to be baked of them */
    LMB_SCENE_MATERIALS, /* with their pictures, and what they emit */
    LMB_SCENE_LIGHTS,    /* lamps and suns */
    LMB_SCENE_ENVIRONMENT,
    LMB_SCENE_PARTS
} lmb_scene_part;

/* "geometry", "materials", "lights", "environment" */
const char *lmb_scene_part_name(lmb_scene_part part);

/* A hash of each, of all that a bake reads. Names do not count. */
void lmb_scene_part_hashes(const lmb_scene *scene, uint64_t hash[LMB_SCENE_PARTS]);

#ifdef __cplusplus
}
#endif

#endif
