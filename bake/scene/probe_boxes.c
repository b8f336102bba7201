#include <lambent/probe_boxes.h>

#include <math.h>

/* Rounding of a position on a face: so much of the box's half width counts as inside. */
#define FACE_ROUNDING 1e-6

bool lmb_probe_box_has(const lmb_probe_box *box, lmb_vec3 position)
{
    bool inside = true;
    for (int row = 0; row < 3; ++row) {
        const double *const m = box->from_world.m[row];
        const double at = m[0] * (double)position.x + m[1] * (double)position.y + m[2] * (double)position.z + m[3];
        inside = inside && fabs(at) <= 1.0 + FACE_ROUNDING;
    }
    return inside;
}

int32_t lmb_scene_probe_box(const lmb_scene *scene, lmb_vec3 position)
{
    int32_t found = -1;
    for (uint32_t i = 0; i < scene->probe_box_count; ++i) {
        const lmb_probe_box *const box = &scene->probe_boxes[i];
        if ((found < 0 || box->priority >= scene->probe_boxes[found].priority) && lmb_probe_box_has(box, position)) {
            found = (int32_t)i;
        }
    }
    return found;
}
