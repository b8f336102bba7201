#include "scene/environment_daylight.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

#include "base/trig.h"
#include "scene/daylight.h"

/* Pixels of 0.7 degrees; an even number of rows, so that the horizon lies between two. */
enum { WIDTH = 512, HEIGHT = 256 };

/* A row of the picture: what its pixels have in common. */
typedef struct picture_row {
    double up, flat;    /* sine and cosine of the elevation of their middles */
    double solid_angle; /* of a pixel */
    double up_mean;     /* times that is the integral of the elevation's sine */
} picture_row;

static picture_row row_of(int row)
{
    double sine, top, bottom;
    picture_row found;
    lmb_sincos(LMB_PI * row / HEIGHT, &sine, &top);
    lmb_sincos(LMB_PI * (row + 1) / HEIGHT, &sine, &bottom);
    lmb_sincos(LMB_PI * (row + 0.5) / HEIGHT, &found.flat, &found.up);
    found.solid_angle = (top - bottom) * 2.0 * LMB_PI / WIDTH;
    found.up_mean = 0.5 * (top + bottom);
    return found;
}

/* The direction of a pixel's middle, by the axes of LMB_LATLONG_GLTF. */
static void pixel_direction(const picture_row *row, int column, double direction[3])
{
    double sine, cosine;
    lmb_sincos(2.0 * LMB_PI * (column + 0.5) / WIDTH, &sine, &cosine);
    direction[0] = -row->flat * cosine;
    direction[1] = row->up;
    direction[2] = -row->flat * sine;
}

/* The rows above the horizon, and the irradiance that they give to the ground. */
static void sky_fill(const lmb_daylight *daylight, float *rgb, double irradiance[3])
{
    for (int y = 0; y < HEIGHT / 2; ++y) {
        const picture_row row = row_of(y);
        for (int x = 0; x < WIDTH; ++x) {
            double direction[3], radiance[3];
            pixel_direction(&row, x, direction);
            lmb_daylight_radiance(daylight, direction, radiance);
            for (int c = 0; c < 3; ++c) {
                rgb[3 * (y * WIDTH + x) + c] = (float)radiance[c];
                irradiance[c] += radiance[c] * row.solid_angle * row.up_mean;
            }
        }
    }
}

static void ground_fill(const double radiance[3], float *rgb)
{
    for (int i = WIDTH * HEIGHT / 2; i < WIDTH * HEIGHT; ++i) {
        for (int c = 0; c < 3; ++c) {
            rgb[3 * i + c] = (float)radiance[c];
        }
    }
}

/* The pixels whose middles are nearest to the sun's: at least one, whatever the latitude. */
static uint32_t disc_find(const double to_sun[3], uint32_t *pixel, double *solid_angle)
{
    const double half_pixel = LMB_PI / HEIGHT * 0.75; /* a little more than the half diagonal */
    uint32_t count = 0;
    *solid_angle = 0.0;
    for (int y = 0; y < HEIGHT; ++y) {
        const picture_row row = row_of(y);
        for (int x = 0; x < WIDTH && fabs(row.up - to_sun[1]) < half_pixel; ++x) {
            double d[3];
            pixel_direction(&row, x, d);
            const double apart[3] = {d[0] - to_sun[0], d[1] - to_sun[1], d[2] - to_sun[2]};
            if (apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2] < half_pixel * half_pixel) {
                pixel[count++] = (uint32_t)(y * WIDTH + x);
                *solid_angle += row.solid_angle;
            }
        }
    }
    return count;
}

/* Shows the sun's disc to who looks at the picture: pixels that together give its irradiance. */
static lmb_result disc_show(const double to_sun[3], const double irradiance[3], lmb_environment *environment)
{
    double solid_angle;
    uint32_t *const pixel = malloc((size_t)WIDTH * HEIGHT * sizeof *pixel);
    if (!pixel) {
        return LMB_ERROR_MEMORY;
    }
    const uint32_t count = disc_find(to_sun, pixel, &solid_angle);
    environment->taken = malloc((count + 1) * sizeof *environment->taken);
    for (uint32_t i = 0; environment->taken && i < count; ++i) {
        lmb_environment_pixel *shown = &environment->taken[environment->taken_count++];
        shown->pixel = pixel[i];
        for (int c = 0; c < 3; ++c) {
            shown->radiance.c[c] =
                environment->image.rgb[3 * pixel[i] + (uint32_t)c] + (float)(irradiance[c] / solid_angle);
        }
    }
    free(pixel);
    return environment->taken ? LMB_OK : LMB_ERROR_MEMORY;
}

/* Turned about +Y as the picture is. */
static lmb_vec3 turned(const double direction[3], float rotation_rad)
{
    double sine, cosine;
    lmb_sincos((double)rotation_rad, &sine, &cosine);
    return lmb_vec3_of((float)(cosine * direction[0] + sine * direction[2]), (float)direction[1],
                       (float)(cosine * direction[2] - sine * direction[0]));
}

lmb_result lmb_environment_daylight(const lmb_environment_description *described, lmb_environment *environment,
                                    lmb_environment_sun *sun)
{
    const double *const to_sun = described->to_sun;
    const lmb_daylight daylight = lmb_daylight_of(described->turbidity, to_sun);
    float *const rgb = malloc((size_t)WIDTH * HEIGHT * 3 * sizeof *rgb);
    double radiance[3] = {0.0, 0.0, 0.0};
    if (!rgb) {
        return LMB_ERROR_MEMORY;
    }
    environment->image = (lmb_image){WIDTH, HEIGHT, rgb};
    environment->axes = LMB_LATLONG_GLTF;
    sky_fill(&daylight, rgb, radiance);
    *sun = (lmb_environment_sun){.direction = turned(to_sun, described->rotation_rad),
                                 .angle_rad = (float)(LMB_SUN_ANGLE_DEG * LMB_PI / 180.0)};
    for (int c = 0; c < 3; ++c) {
        radiance[c] = (radiance[c] + daylight.sun_irradiance[c] * fmax(to_sun[1], 0.0)) * described->ground / LMB_PI;
        sun->irradiance.c[c] = (float)daylight.sun_irradiance[c] * described->strength;
    }
    ground_fill(radiance, rgb);
    const lmb_result result =
        lmb_rgb_max(sun->irradiance) > 0.0f ? disc_show(to_sun, daylight.sun_irradiance, environment) : LMB_OK;
    if (result != LMB_OK) {
        lmb_image_free(&environment->image);
    }
    return result;
}
