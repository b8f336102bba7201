#include "specular_picture.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/image.h>
#include <lambent/vector.h>

#include "tonemap.h"

static const float ROUGHNESS[] = {0.05f, 0.1f, 0.2f, 0.4f, 0.8f};

enum {
    SIDE = 128, /* pixels of a sphere with its margin */
    ROWS = sizeof ROUGHNESS / sizeof ROUGHNESS[0],
    COLUMNS = 6,
    WIDTH = SIDE * COLUMNS,
    HEIGHT = SIDE * ROWS,
    SAMPLES = 2048
};

#define MARGIN 1.08f /* over a sphere's radius */

static lmb_rgb column_colour(const specular_light *light, int column, const specular_surface *surface)
{
    const lmb_vec3 normal = surface->normal;
    const lmb_rgb sun = lmb_specular_light(&light->sun, 1.0f, &surface->specular, normal, normal, surface->view);
    switch (column) {
    case 0:
        return sun;
    case 1:
        return lmb_specular_light(&light->dominant, 1.0f, &surface->specular, normal, normal, surface->view);
    case 2:
        return specular_layer_of(light, SPECULAR_AREA, surface, SAMPLES, 1);
    case 3:
        return specular_layer_of(light, SPECULAR_ENVIRONMENT, surface, SAMPLES, 1);
    case 4:
        return lmb_rgb_add(sun, specular_layer_of(light, SPECULAR_ENVIRONMENT, surface, SAMPLES, 1));
    default:
        return lmb_rgb_add(sun, specular_traced(light, surface, SAMPLES, 1));
    }
}

/* Beside the spheres it is black. The eye is far away and looks along the axis between -X and -Z, a little downwards.
 */
static void pixels_make(const specular_light *light, lmb_rgb f0, float *rgb)
{
    const lmb_vec3 view = lmb_vec3_unit_or(lmb_vec3_of(1.0f, 0.3f, 1.0f), lmb_vec3_of(0.0f, 0.0f, 1.0f));
    const lmb_vec3 right = lmb_vec3_unit_or(lmb_vec3_cross(lmb_vec3_of(0.0f, 1.0f, 0.0f), view), view);
    const lmb_vec3 up = lmb_vec3_cross(view, right);
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        const int row = i / WIDTH / SIDE, column = i % WIDTH / SIDE;
        const float x = MARGIN * (2.0f * ((float)(i % WIDTH % SIDE) + 0.5f) / SIDE - 1.0f);
        const float y = MARGIN * (1.0f - 2.0f * ((float)(i / WIDTH % SIDE) + 0.5f) / SIDE);
        const float square = 1.0f - x * x - y * y;
        lmb_rgb colour = {{0.0f, 0.0f, 0.0f}};
        if (square > 0.0f) {
            const lmb_vec3 across = lmb_vec3_mad(lmb_vec3_scale(right, x), up, y);
            const lmb_vec3 normal = lmb_vec3_unit_or(lmb_vec3_mad(across, view, sqrtf(square)), view);
            const specular_surface surface = {{ROUGHNESS[row], f0}, normal, view};
            colour = column_colour(light, column, &surface);
        }
        for (int c = 0; c < 3; ++c) {
            rgb[3 * i + c] = colour.c[c];
        }
    }
}

/* Of the reference alone: the layers' own tails and peaks would pull it about. */
static float exposure_of_reference(const float *rgb, float *reference)
{
    for (int y = 0; y < HEIGHT; ++y) {
        memcpy(reference + 3 * SIDE * y, rgb + 3 * (WIDTH * y + WIDTH - SIDE), 3 * SIDE * sizeof *reference);
    }
    return exposure_of_picture(reference, (size_t)SIDE * HEIGHT);
}

lmb_result specular_picture_write(const char *path, const specular_light *light, lmb_rgb f0, lmb_error *error)
{
    float *const rgb = malloc((size_t)WIDTH * HEIGHT * 3 * sizeof *rgb);
    float *const reference = malloc((size_t)SIDE * HEIGHT * 3 * sizeof *reference);
    uint8_t *const srgb = malloc((size_t)WIDTH * HEIGHT * 3);
    lmb_result result = LMB_ERROR_MEMORY;
    if (rgb && reference && srgb) {
        pixels_make(light, f0, rgb);
        picture_tonemap(rgb, (size_t)WIDTH * HEIGHT, exposure_of_reference(rgb, reference), srgb);
        result = lmb_png_write(path, WIDTH, HEIGHT, srgb, error);
    } else {
        lmb_error_set(error, result, "out of memory");
    }
    free(rgb);
    free(reference);
    free(srgb);
    return result;
}
