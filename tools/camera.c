#include "camera.h"

#include <float.h>

#include <lambent/surface.h>
#include <lambent/vector.h>

static float half_height_of(float fov_deg)
{
    return tanf(0.5f * fov_deg * LMB_PI_F / 180.0f);
}

lmb_camera camera_look_at(lmb_vec3 position, lmb_vec3 target, float fov_deg)
{
    const lmb_vec3 north = {0.0f, 0.0f, -1.0f};
    lmb_camera camera = {.position = position};
    camera.forward = lmb_vec3_unit_or(lmb_vec3_sub(target, position), north);
    lmb_vec3 upwards = {0.0f, 1.0f, 0.0f};
    if (fabsf(camera.forward.y) > 0.9999f) {
        upwards = camera.forward.y < 0.0f ? north : lmb_vec3_scale(north, -1.0f);
    }
    camera.right = lmb_vec3_unit_or(lmb_vec3_cross(camera.forward, upwards), (lmb_vec3){1.0f, 0.0f, 0.0f});
    camera.up = lmb_vec3_cross(camera.right, camera.forward);
    camera.half_height = half_height_of(fov_deg);
    return camera;
}

static lmb_vec3 column_of(const lmb_affine *transform, int column)
{
    return (lmb_vec3){(float)transform->m[0][column], (float)transform->m[1][column], (float)transform->m[2][column]};
}

bool camera_of_scene(const lmb_scene_camera *source, float fov_deg, lmb_camera *camera)
{
    const lmb_vec3 none = {0.0f, 0.0f, 0.0f};
    camera->position = column_of(&source->to_world, 3);
    camera->half_height = half_height_of(fov_deg);
    camera->forward = lmb_vec3_unit_or(lmb_vec3_scale(column_of(&source->to_world, 2), -1.0f), none);
    /* A node that is scaled unevenly below a turned one is skewed: its +Y is upwards as far as that may be. */
    const lmb_vec3 upwards = lmb_vec3_unit_or(column_of(&source->to_world, 1), none);
    camera->right = lmb_vec3_unit_or(lmb_vec3_cross(camera->forward, upwards), none);
    camera->up = lmb_vec3_cross(camera->right, camera->forward);
    return lmb_vec3_dot(camera->right, camera->right) > 0.0f;
}

lmb_vec3 camera_direction(const lmb_camera *camera, int32_t width, int32_t height, float x, float y)
{
    const float pixel = 2.0f * camera->half_height / (float)height;
    const float across = (x - 0.5f * (float)width) * pixel;
    const float upwards = (0.5f * (float)height - y) * pixel;
    const lmb_vec3 direction = lmb_vec3_mad(lmb_vec3_mad(camera->forward, camera->right, across), camera->up, upwards);
    return lmb_vec3_unit_or(direction, camera->forward);
}

/* How much a view shows: over a coarse grid of rays, the mean share of `size` up to the first surface, where that
 * surface faces the camera. Sky and backs count nothing. */
static float view_score(const lmb_tracer *tracer, const lmb_camera *camera, float size)
{
    enum { COLUMNS = 16, ROWS = 9 };
    float score = 0.0f;
    for (int32_t y = 0; y < ROWS; ++y) {
        for (int32_t x = 0; x < COLUMNS; ++x) {
            const lmb_vec3 direction = camera_direction(camera, COLUMNS, ROWS, (float)x + 0.5f, (float)y + 0.5f);
            lmb_hit hit;
            if (!lmb_trace_nearest(tracer, camera->position, direction, 0.0f, FLT_MAX, &hit)) {
                continue;
            }
            const lmb_place place = lmb_trace_place(tracer, &hit);
            if (lmb_vec3_dot(place.geometric_normal, direction) < 0.0f) {
                score += fminf(hit.distance / size, 1.0f);
            }
        }
    }
    return score / (float)(COLUMNS * ROWS);
}

static void camera_better(const lmb_tracer *tracer, lmb_camera camera, float size, lmb_camera *best, float *best_score)
{
    const float score = view_score(tracer, &camera, size);
    if (score > *best_score) {
        *best = camera;
        *best_score = score;
    }
}

lmb_camera camera_default(const lmb_tracer *tracer, float fov_deg)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    const lmb_vec3 low = scene->bounds_min, high = scene->bounds_max;
    if (!(low.x <= high.x)) {
        return camera_look_at((lmb_vec3){0.0f, 0.0f, 1.0f}, (lmb_vec3){0.0f, 0.0f, 0.0f}, fov_deg);
    }
    const lmb_vec3 size = lmb_vec3_sub(high, low);
    const float diagonal = fmaxf(lmb_vec3_length(size), FLT_MIN);
    static const float heights[] = {0.3f, 0.6f, 0.9f};
    static const float insets[] = {0.05f, 0.2f};
    const lmb_vec3 middle = lmb_vec3_mad(low, size, 0.5f);
    const lmb_vec3 target = {middle.x, low.y + 0.4f * size.y, middle.z};
    /* From outside, in front: what is left when nothing inside faces the camera. */
    lmb_camera best = camera_look_at(lmb_vec3_mad(middle, (lmb_vec3){0.3f, 0.25f, 0.6f}, diagonal), middle, fov_deg);
    float best_score = 0.0f;
    for (int corner = 0; corner < 4; ++corner) {
        for (size_t h = 0; h < sizeof heights / sizeof heights[0]; ++h) {
            for (size_t i = 0; i < sizeof insets / sizeof insets[0]; ++i) {
                const lmb_vec3 position = {low.x + size.x * (corner & 1 ? 1.0f - insets[i] : insets[i]),
                                           low.y + size.y * heights[h],
                                           low.z + size.z * (corner & 2 ? insets[i] : 1.0f - insets[i])};
                camera_better(tracer, camera_look_at(position, target, fov_deg), diagonal, &best, &best_score);
            }
        }
    }
    for (uint32_t i = 0; i < scene->seed_point_count; ++i) {
        camera_better(tracer, camera_look_at(scene->seed_points[i], target, fov_deg), diagonal, &best, &best_score);
    }
    return best;
}
