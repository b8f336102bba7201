#include "leaks_picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/image.h>
#include <lambent/vector.h>

#define PIXEL_M 0.04f
#define HEIGHT_M 1.0f
#define GREY 96

/* A display's power law is near enough to sRGB here. */
#define DISPLAY_GAMMA 2.2

/* Coefficient 0 of light that is even: its normalised irradiance times 2 sqrt(pi). */
#define EVEN_LIGHT 3.5449077

static void pixel_draw(const leaks_sampler *sampler, const double home_mean[2], lmb_vec3 at, uint8_t srgb[3])
{
    lmb_sh3_rgb found;
    sampler->method->sample(sampler->state, at, NULL, &found);
    const lmb_rgb light = lmb_sh3_rgb_irradiance(&found, lmb_vec3_of(0, 1, 0));
    for (int c = 0; c < 3; ++c) {
        const double mean = c < 2 ? home_mean[c] / EVEN_LIGHT : 0.0;
        const double shown = mean > 0.0 ? fmin(0.5 * (double)light.c[c] / mean, 1.0) : 0.0;
        srgb[c] = (uint8_t)lrint(255.0 * pow(shown, 1.0 / DISPLAY_GAMMA));
    }
}

lmb_result leaks_picture_write(const char *path, const leaks_level *level, const leaks_sampler *sampler,
                               const leaks_places *places, lmb_error *error)
{
    const lmb_vec3 low = level->level.scene->bounds_min, high = level->level.scene->bounds_max;
    const int32_t width = (int32_t)ceilf((high.x - low.x) / PIXEL_M),
                  height = (int32_t)ceilf((high.z - low.z) / PIXEL_M);
    uint8_t *const srgb = malloc(3 * (size_t)width * (size_t)height);
    if (!srgb) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for a picture");
    }
    lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
    lmb_leak_scene_rooms(level->scene, room);
    const lmb_vec3 floor = lmb_leak_scene_to_world(level->scene, lmb_vec3_of(0, room[0].min.y, 0));
    for (int32_t i = 0; i < width * height; ++i) {
        const lmb_vec3 at = {low.x + ((float)(i % width) + 0.5f) * PIXEL_M, floor.y + HEIGHT_M,
                             low.z + ((float)(i / width) + 0.5f) * PIXEL_M};
        if (lmb_leak_scene_room_at(level->scene, at) >= 0) {
            pixel_draw(sampler, places->home_mean, at, &srgb[3 * i]);
        } else {
            memset(&srgb[3 * i], GREY, 3);
        }
    }
    const lmb_result result = lmb_png_write(path, width, height, srgb, error);
    free(srgb);
    return result;
}
