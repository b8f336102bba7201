#include "scene/environment_sky_basis.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/sky.h>
#include <lambent/vector.h>

#include "base/trig.h"

/* Pixels of 1.4 degrees: their means differ from the functions' by less than 10^-3 of these. */
enum { WIDTH = 256, HEIGHT = 128 };

int lmb_sky_basis_find(const char *source)
{
    const size_t length = strlen(LMB_SKY_BASIS);
    if (strncmp(source, LMB_SKY_BASIS, length) != 0 || strlen(source) != length + 1) {
        return -1;
    }
    const int function = source[length] - '0';
    return function >= 0 && function < LMB_SKY_QUADRATIC ? function : -1;
}

lmb_result lmb_environment_sky_basis(int function, lmb_environment *environment)
{
    float *const rgb = malloc((size_t)WIDTH * HEIGHT * 3 * sizeof *rgb);
    if (!rgb) {
        return LMB_ERROR_MEMORY;
    }
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        double flat, up, sine, cosine;
        lmb_sincos(LMB_PI * (i / WIDTH + 0.5) / HEIGHT, &flat, &up);
        lmb_sincos(2.0 * LMB_PI * (i % WIDTH + 0.5) / WIDTH, &sine, &cosine);
        float radiance[LMB_SKY_QUADRATIC];
        lmb_sky_basis(lmb_vec3_of((float)(-flat * cosine), (float)up, (float)(-flat * sine)), radiance);
        for (int c = 0; c < 3; ++c) {
            rgb[3 * i + c] = radiance[function];
        }
    }
    environment->image = (lmb_image){WIDTH, HEIGHT, rgb};
    environment->axes = LMB_LATLONG_GLTF;
    return LMB_OK;
}
