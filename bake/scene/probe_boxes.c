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

/* Boxes that overlap by less than this share of their widths only touch. */
#define TOUCH_ROUNDING 1e-6

/* Whether both boxes' shadows on an axis lie beside each other. `edge` are halves of the box's edges. */
static bool axis_separates(const double axis[3], const double between[3], const double half[3], const double edge[3][3])
{
    double apart = 0.0, reach = 0.0;
    for (int i = 0; i < 3; ++i) {
        apart += axis[i] * between[i];
        reach += fabs(axis[i]) * half[i] + fabs(axis[0] * edge[i][0] + axis[1] * edge[i][1] + axis[2] * edge[i][2]);
    }
    return reach > 0.0 && fabs(apart) >= reach * (1.0 - TOUCH_ROUNDING);
}

static void cross(const double a[3], const double b[3], double product[3])
{
    for (int i = 0; i < 3; ++i) {
        const int k = (i + 1) % 3, l = (i + 2) % 3;
        product[i] = a[k] * b[l] - a[l] * b[k];
    }
}

/* Two convex bodies are apart when a plane along a face of either, or along an edge of each, lies between (Gottschalk,
 * Lin and Manocha 1996). */
bool lmb_probe_box_touches(const lmb_probe_box *box, const double low[3], const double high[3])
{
    static const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double between[3], half[3], edge[3][3];
    for (int i = 0; i < 3; ++i) {
        between[i] = box->to_world.m[i][3] - 0.5 * (low[i] + high[i]);
        half[i] = 0.5 * (high[i] - low[i]);
        for (int k = 0; k < 3; ++k) {
            edge[k][i] = box->to_world.m[i][k];
        }
    }
    bool apart = false;
    for (int i = 0; i < 3 && !apart; ++i) {
        double axis[3];
        cross(edge[i], edge[(i + 1) % 3], axis);
        apart = axis_separates(unit[i], between, half, edge) || axis_separates(axis, between, half, edge);
        for (int k = 0; k < 3 && !apart; ++k) {
            cross(unit[i], edge[k], axis);
            apart = axis_separates(axis, between, half, edge);
        }
    }
    return !apart;
}

bool lmb_probe_box_holds(const lmb_probe_box *box, const double low[3], const double high[3])
{
    bool holds = true;
    for (int row = 0; row < 3; ++row) {
        const double *const m = box->from_world.m[row];
        double at = m[3], reach = 0.0;
        for (int i = 0; i < 3; ++i) {
            at += m[i] * 0.5 * (low[i] + high[i]);
            reach += fabs(m[i]) * 0.5 * (high[i] - low[i]);
        }
        holds = holds && fabs(at) + reach <= 1.0 + TOUCH_ROUNDING;
    }
    return holds;
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

bool lmb_scene_probes_excluded(const lmb_scene *scene, lmb_vec3 position)
{
    const int32_t box = lmb_scene_probe_box(scene, position);
    return box >= 0 && scene->probe_boxes[box].exclude;
}
