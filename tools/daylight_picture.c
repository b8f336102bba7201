/* The clear sky of `--env preetham:...`, all of it at once:
 *
 *     lambent_daylight_picture OUT.png
 *
 * Each disc is the upper hemisphere as an upward eye sees it, the zenith in the middle, the horizon around it,
 * distances from the middle in proportion to angles; the sun is towards the lower side. From left to right it stands
 * 60, 25 and 4 degrees high, a row for each turbidity: 2.5 and 6. Each disc has an exposure of its own; the sun's disc,
 * which is no part of the sky's picture, has a ring. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <lambent/image.h>
#include <lambent/vector.h>

#include "specular_light.h"
#include "tonemap.h"

static const int ELEVATION_DEG[] = {60, 25, 4};
static const double TURBIDITY[] = {2.5, 6.0};

enum {
    SIDE = 256, /* pixels of a disc with its margin */
    COLUMNS = sizeof ELEVATION_DEG / sizeof ELEVATION_DEG[0],
    ROWS = sizeof TURBIDITY / sizeof TURBIDITY[0],
    WIDTH = SIDE * COLUMNS,
    HEIGHT = SIDE * ROWS
};

#define MARGIN 1.03       /* over a disc's radius */
#define RING_COSINE 0.998 /* of the sun's ring: 3.6 degrees */
#define RING_WIDTH 0.0008

static void disc_draw(const specular_light *light, float *rgb)
{
    for (int i = 0; i < SIDE * SIDE; ++i) {
        const double x = MARGIN * (2.0 * (i % SIDE + 0.5) / SIDE - 1.0);
        const double y = MARGIN * (1.0 - 2.0 * (i / SIDE + 0.5) / SIDE);
        const double radius = hypot(x, y), polar = 0.5 * LMB_PI * radius, scale = sin(polar) / fmax(radius, 1e-9);
        const lmb_vec3 direction = lmb_vec3_of((float)(scale * x), (float)cos(polar), (float)(-scale * y));
        const double ring = (double)lmb_vec3_dot(direction, light->sun.direction) - RING_COSINE;
        const lmb_rgb colour = radius >= 1.0 || fabs(ring) < RING_WIDTH ? lmb_rgb_of(0.0f, 0.0f, 0.0f)
                                                                        : specular_light_look(light, direction);
        for (int c = 0; c < 3; ++c) {
            rgb[3 * i + c] = colour.c[c];
        }
    }
}

/* Its place in the picture. */
static void disc_put(float *rgb, int place, uint8_t *srgb)
{
    static uint8_t disc[3 * SIDE * SIDE];
    picture_tonemap(rgb, (size_t)SIDE * SIDE, exposure_of_picture(rgb, (size_t)SIDE * SIDE) + 1.0f, disc);
    for (int i = 0; i < 3 * SIDE * SIDE; ++i) {
        const int x = 3 * SIDE * (place % COLUMNS) + i % (3 * SIDE), y = SIDE * (place / COLUMNS) + i / (3 * SIDE);
        srgb[3 * WIDTH * y + x] = disc[i];
    }
}

int main(int count, char **values)
{
    static float rgb[3 * SIDE * SIDE];
    static uint8_t srgb[3 * WIDTH * HEIGHT];
    static specular_light light;
    lmb_error error = {""};
    if (count != 2) {
        fprintf(stderr, "usage: lambent_daylight_picture OUT.png\n");
        return 2;
    }
    lmb_result result = LMB_OK;
    for (int i = 0; i < COLUMNS * ROWS && result == LMB_OK; ++i) {
        char description[64];
        snprintf(description, sizeof description, "preetham:sun=180/%d,turbidity=%g", ELEVATION_DEG[i % COLUMNS],
                 TURBIDITY[i / COLUMNS]);
        result = specular_light_open(description, &light, &error);
        if (result == LMB_OK) {
            disc_draw(&light, rgb);
            disc_put(rgb, i, srgb);
            specular_light_close(&light);
        }
    }
    if (result == LMB_OK) {
        result = lmb_png_write(values[1], WIDTH, HEIGHT, srgb, &error);
    }
    if (result != LMB_OK) {
        fprintf(stderr, "lambent_daylight_picture: %s\n", error.message);
    }
    return result == LMB_OK ? 0 : 1;
}
