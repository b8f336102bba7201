#include "models_map.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/image.h>
#include <lambent/vector.h>

/* Light of the source's columns and rows within [u0, u1) x [v0, v1), fractions of its width and height; a source pixel
 * counts by the solid angle of it that is inside. */
static lmb_rgb region_light(const lmb_image *image, const double u[2], const double v[2])
{
    double sum[3] = {0.0, 0.0, 0.0};
    const int y_end = (int)ceil(v[1] * image->height - 1e-9);
    const int x_end = (int)ceil(u[1] * image->width - 1e-9);
    for (int y = (int)(v[0] * image->height + 1e-9); y < y_end; ++y) {
        const double top = fmax(v[0], (double)y / image->height);
        const double bottom = fmin(v[1], (double)(y + 1) / image->height);
        const double band = cos(LMB_PI * top) - cos(LMB_PI * bottom);
        for (int x = (int)(u[0] * image->width + 1e-9); x < x_end; ++x) {
            const double left = fmax(u[0], (double)x / image->width);
            const double right = fmin(u[1], (double)(x + 1) / image->width);
            const double solid_angle = 2.0 * LMB_PI * (right - left) * band;
            const float *rgb = &image->rgb[3 * ((size_t)y * (size_t)image->width + (size_t)x)];
            for (int c = 0; c < 3; ++c) {
                sum[c] += solid_angle * (double)rgb[c];
            }
        }
    }
    return lmb_rgb_of((float)sum[0], (float)sum[1], (float)sum[2]);
}

/* The centre of a pixel, u and v in [0, 1]: row 0 is +Y, u = 0.5 is +X, u = 0.75 is +Z; or OpenEXR's axes. */
static lmb_vec3 pixel_direction(double u, double v, lmb_latlong_axes axes)
{
    const double turn = 2.0 * LMB_PI * u, height = cos(LMB_PI * v), radius = sin(LMB_PI * v);
    const double a = -radius * cos(turn), b = -radius * sin(turn);
    return axes == LMB_LATLONG_GLTF ? lmb_vec3_of((float)a, (float)height, (float)b)
                                    : lmb_vec3_of((float)-b, (float)height, (float)a);
}

static double map_fill(models_map *map, const lmb_image *image, lmb_latlong_axes axes)
{
    double total = 0.0;
    for (int y = 0; y < MODELS_MAP_HEIGHT; ++y) {
        const double v[2] = {(double)y / MODELS_MAP_HEIGHT, (double)(y + 1) / MODELS_MAP_HEIGHT};
        for (int x = 0; x < MODELS_MAP_WIDTH; ++x) {
            const double u[2] = {(double)x / MODELS_MAP_WIDTH, (double)(x + 1) / MODELS_MAP_WIDTH};
            lmb_directed_light *light = &map->light[y * MODELS_MAP_WIDTH + x];
            light->direction = pixel_direction(0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]), axes);
            light->weight = region_light(image, u, v);
            total += (double)lmb_luminance(light->weight);
        }
    }
    return total;
}

lmb_result models_map_read(const char *path, models_map *map, lmb_error *error)
{
    lmb_image image;
    lmb_latlong_axes axes;
    lmb_result result = lmb_image_read(path, &image, &axes, NULL, error);
    if (result != LMB_OK) {
        return result;
    }
    map->name = path;
    if (abs(image.width - 2 * image.height) > image.height / 50) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %d x %d pixels, not twice as wide as high", path,
                               image.width, image.height);
    } else if (!(map_fill(map, &image, axes) > 0.0)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: there is no light in it", path);
    }
    lmb_image_free(&image);
    return result;
}
