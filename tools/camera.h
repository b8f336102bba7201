/* A pinhole camera. */
#ifndef LMB_TOOLS_CAMERA_H
#define LMB_TOOLS_CAMERA_H

#include <lambent/trace.h>

typedef struct lmb_camera {
    lmb_vec3 position;
    lmb_vec3 forward, right, up; /* unit, perpendicular */
    float half_height;           /* of the picture plane at distance 1 */
} lmb_camera;

#define CAMERA_DEFAULT_FOV_DEG 60.0f

/* Looks from `position` to `target` (different points) with +Y upwards; `fov_deg` is the vertical angle of view, in
 * (0, 180). Straight up or down, -Z is the picture's upper or lower side. */
lmb_camera camera_look_at(lmb_vec3 position, lmb_vec3 target, float fov_deg);

/* Looks along the -Z of a camera of the scene, its +Y upwards, as glTF's cameras do. False when it has no direction. */
bool camera_of_scene(const lmb_scene_camera *source, float fov_deg, lmb_camera *camera);

/* Unit direction through point (x, y) of a picture of width x height pixels; row 0 is the top, pixel (i, j) covers
 * [i, i + 1) x [j, j + 1). */
lmb_vec3 camera_direction(const lmb_camera *camera, int32_t width, int32_t height, float x, float y);

/* A view of the level when none is asked for: of the corners of its bounds (moved inwards) and its seed points, the one
 * that sees most of the level's front faces, farthest away, when it looks to the bounds' middle. */
lmb_camera camera_default(const lmb_tracer *tracer, float fov_deg);

#endif
