#include "sky.h"

#include <stdlib.h>

#include "bake_internal.h"

static lmb_rgb image_pixel(const lmb_image *image, size_t pixel)
{
    return rgb(image->rgb[3 * pixel], image->rgb[3 * pixel + 1], image->rgb[3 * pixel + 2]);
}

static bool distribution_create(lmb_sky *created)
{
    const lmb_image *image = &created->environment->image;
    const size_t width = (size_t)image->width;
    const size_t height = (size_t)image->height;
    created->cumulative = malloc(width * height * sizeof *created->cumulative);
    created->row_cosine = malloc((height + 1) * sizeof *created->row_cosine);
    if (!created->cumulative || !created->row_cosine) {
        return false;
    }
    for (size_t row = 0; row <= height; ++row) {
        double sine;
        lmb_sincos(LMB_PI * (double)row / (double)height, &sine, &created->row_cosine[row]);
    }
    double total = 0.0;
    for (size_t row = 0; row < height; ++row) {
        const double solid_angle =
            (created->row_cosine[row] - created->row_cosine[row + 1]) * 2.0 * LMB_PI / (double)width;
        for (size_t column = 0; column < width; ++column) {
            total += (double)lmb_luminance(image_pixel(image, row * width + column)) * solid_angle;
            created->cumulative[row * width + column] = total;
        }
    }
    created->total = total;
    return true;
}

lmb_result lmb_sky_create(const lmb_environment *environment, lmb_sky *created)
{
    *created = (lmb_sky){.environment = environment};
    lmb_sincos((double)environment->rotation_rad, &created->rotation_sine, &created->rotation_cosine);
    if (environment->present && environment->image.rgb) {
        if (!distribution_create(created)) {
            lmb_sky_free(created);
            return LMB_ERROR_MEMORY;
        }
        if (!(created->total > 0.0)) {
            lmb_sky_free(created);
            *created = (lmb_sky){.environment = environment, .rotation_cosine = 1.0};
        }
    }
    return LMB_OK;
}

void lmb_sky_free(lmb_sky *freed)
{
    free(freed->cumulative);
    free(freed->row_cosine);
    freed->cumulative = NULL;
    freed->row_cosine = NULL;
}

/* World direction -> pixel. Azimuth runs from u = 0 (glTF: -X, through -Z, +X, +Z; OpenEXR: -Z, through +X, +Z, -X). */
static size_t pixel_of_direction(const lmb_sky *sky, lmb_vec3 direction)
{
    const lmb_image *image = &sky->environment->image;
    /* Turning the environment by +a is looking it up turned by -a. */
    const double x = sky->rotation_cosine * (double)direction.x - sky->rotation_sine * (double)direction.z;
    const double z = sky->rotation_sine * (double)direction.x + sky->rotation_cosine * (double)direction.z;
    const double azimuth = sky->environment->axes == LMB_LATLONG_OPENEXR ? lmb_atan2(-x, z) : lmb_atan2(z, x);
    const double u = 0.5 + azimuth / (2.0 * LMB_PI);
    const double v = lmb_acos((double)direction.y) / LMB_PI;
    const double column = floor(u * image->width);
    const double row = floor(v * image->height);
    const size_t last_column = (size_t)image->width - 1;
    const size_t last_row = (size_t)image->height - 1;
    const size_t c = column > 0.0 ? (size_t)column : 0;
    const size_t r = row > 0.0 ? (size_t)row : 0;
    return (r < last_row ? r : last_row) * (size_t)image->width + (c < last_column ? c : last_column);
}

lmb_rgb lmb_sky_radiance(const lmb_sky *sky, lmb_vec3 direction)
{
    const lmb_environment *environment = sky->environment;
    if (!environment->present) {
        return rgb(0.0f, 0.0f, 0.0f);
    }
    if (!environment->image.rgb) {
        return rgb_scale(environment->constant, environment->strength);
    }
    return rgb_scale(image_pixel(&environment->image, pixel_of_direction(sky, direction)), environment->strength);
}

bool lmb_sky_sample(const lmb_sky *sky, const float point[2], lmb_light_sample *sample)
{
    if (!sky->cumulative) {
        return false;
    }
    const lmb_image *image = &sky->environment->image;
    const size_t width = (size_t)image->width;
    const double target = (double)point[0] * sky->total;
    size_t low = 0;
    size_t high = width * (size_t)image->height - 1;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (sky->cumulative[middle] > target) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    const double before = low > 0 ? sky->cumulative[low - 1] : 0.0;
    const double mass = sky->cumulative[low] - before;
    if (!(mass > 0.0)) {
        return false;
    }
    /* What is left of the first number within the pixel's share is again uniform. */
    const double across = fmin(fmax((target - before) / mass, 0.0), 1.0);
    const size_t row = low / width;
    const double u = ((double)(low % width) + across) / (double)width;
    const double y = sky->row_cosine[row] + (sky->row_cosine[row + 1] - sky->row_cosine[row]) * (double)point[1];
    const double r = sqrt(fmax(0.0, (1.0 - y) * (1.0 + y)));
    double sine, cosine;
    lmb_sincos((u - 0.5) * 2.0 * LMB_PI, &sine, &cosine);
    const bool openexr = sky->environment->axes == LMB_LATLONG_OPENEXR;
    const double x = r * (openexr ? -sine : cosine);
    const double z = r * (openexr ? cosine : sine);
    sample->direction = vec3((float)(sky->rotation_cosine * x + sky->rotation_sine * z), (float)y,
                             (float)(sky->rotation_cosine * z - sky->rotation_sine * x));
    sample->end = sample->direction;
    const lmb_rgb pixel = image_pixel(image, low);
    sample->radiance = rgb_scale(pixel, sky->environment->strength);
    sample->density = (float)((double)lmb_luminance(pixel) / sky->total);
    return sample->density > 0.0f;
}

float lmb_sky_density(const lmb_sky *sky, lmb_vec3 direction)
{
    if (!sky->cumulative) {
        return 0.0f;
    }
    const lmb_rgb pixel = image_pixel(&sky->environment->image, pixel_of_direction(sky, direction));
    return (float)((double)lmb_luminance(pixel) / sky->total);
}
