#include "sky.h"

#include <stdlib.h>

#include "bake_internal.h"

/* Below this share of the light, what stands out is not worth a ray of its own. */
#define MIN_EXCESS_SHARE 1e-3

static lmb_rgb image_pixel(const lmb_image *image, size_t pixel)
{
    return rgb(image->rgb[3 * pixel], image->rgb[3 * pixel + 1], image->rgb[3 * pixel + 2]);
}

static double row_solid_angle(const lmb_sky *sky, size_t row)
{
    const double width = sky->environment->image.width;
    return (sky->row_cosine[row] - sky->row_cosine[row + 1]) * 2.0 * LMB_PI / width;
}

/* How far a pixel stands out. */
static float pixel_excess(const lmb_sky *sky, lmb_rgb pixel)
{
    const float excess = lmb_luminance(pixel) - sky->mean;
    return excess > 0.0f ? excess : 0.0f;
}

static void rows_make(lmb_sky *sky)
{
    const size_t height = (size_t)sky->environment->image.height;
    for (size_t row = 0; row <= height; ++row) {
        double sine;
        lmb_sincos(LMB_PI * (double)row / (double)height, &sine, &sky->row_cosine[row]);
    }
}

/* Sum over all pixels of luminance x solid angle. */
static double image_power(const lmb_sky *sky)
{
    const lmb_image *image = &sky->environment->image;
    const size_t width = (size_t)image->width;
    double power = 0.0;
    for (size_t row = 0; row < (size_t)image->height; ++row) {
        for (size_t column = 0; column < width; ++column) {
            power += (double)lmb_luminance(image_pixel(image, row * width + column)) * row_solid_angle(sky, row);
        }
    }
    return power;
}

static void cumulative_make(lmb_sky *sky)
{
    const lmb_image *image = &sky->environment->image;
    const size_t width = (size_t)image->width;
    double total = 0.0;
    for (size_t row = 0; row < (size_t)image->height; ++row) {
        for (size_t column = 0; column < width; ++column) {
            const size_t pixel = row * width + column;
            total += (double)pixel_excess(sky, image_pixel(image, pixel)) * row_solid_angle(sky, row);
            sky->cumulative[pixel] = total;
        }
    }
    sky->total = total;
}

/* For each of equal shares of the total, the first pixel whose running sum exceeds it. */
static void guide_make(lmb_sky *sky, size_t pixels)
{
    size_t pixel = 0;
    for (size_t i = 0; i < pixels; ++i) {
        const double target = (double)i / (double)pixels * sky->total;
        while (pixel + 1 < pixels && !(sky->cumulative[pixel] > target)) {
            ++pixel;
        }
        sky->guide[i] = (uint32_t)pixel;
    }
}

static lmb_result distribution_create(lmb_sky *sky)
{
    const lmb_image *image = &sky->environment->image;
    const size_t pixels = (size_t)image->width * (size_t)image->height;
    sky->cumulative = malloc(pixels * sizeof *sky->cumulative);
    sky->guide = malloc(pixels * sizeof *sky->guide);
    sky->row_cosine = malloc(((size_t)image->height + 1) * sizeof *sky->row_cosine);
    if (!sky->cumulative || !sky->guide || !sky->row_cosine) {
        lmb_sky_free(sky);
        return LMB_ERROR_MEMORY;
    }
    rows_make(sky);
    const double power = image_power(sky);
    sky->mean = (float)(power / (4.0 * LMB_PI));
    cumulative_make(sky);
    if (sky->total > MIN_EXCESS_SHARE * power) {
        guide_make(sky, pixels);
    } else {
        lmb_sky_free(sky);
    }
    return LMB_OK;
}

lmb_result lmb_sky_create(const lmb_environment *environment, lmb_sky *created)
{
    double sine, cosine;
    lmb_sincos((double)environment->rotation_rad, &sine, &cosine);
    *created = (lmb_sky){.environment = environment, .rotation_sine = (float)sine, .rotation_cosine = (float)cosine};
    return environment->present && environment->image.rgb ? distribution_create(created) : LMB_OK;
}

void lmb_sky_free(lmb_sky *freed)
{
    free(freed->cumulative);
    free(freed->guide);
    free(freed->row_cosine);
    freed->cumulative = NULL;
    freed->guide = NULL;
    freed->row_cosine = NULL;
}

static size_t share_to_index(float share, int32_t size)
{
    const int32_t index = (int32_t)(share * (float)size);
    return (size_t)(index < 0 ? 0 : index < size ? index : size - 1);
}

/* World direction -> pixel. Azimuth runs from u = 0 (glTF: -X, through -Z, +X, +Z; OpenEXR: -Z, through +X, +Z, -X). */
static size_t pixel_of_direction(const lmb_sky *sky, lmb_vec3 direction)
{
    const lmb_image *image = &sky->environment->image;
    /* Turning the environment by +a is looking it up turned by -a. */
    const float x = sky->rotation_cosine * direction.x - sky->rotation_sine * direction.z;
    const float z = sky->rotation_sine * direction.x + sky->rotation_cosine * direction.z;
    const float azimuth = sky->environment->axes == LMB_LATLONG_OPENEXR ? lmb_turn_of(z, -x) : lmb_turn_of(x, z);
    const float polar = lmb_turn_of(direction.y, sqrtf(x * x + z * z));
    const size_t row = share_to_index(2.0f * polar, image->height);
    return row * (size_t)image->width + share_to_index(0.5f + azimuth, image->width);
}

lmb_rgb lmb_sky_radiance(const lmb_sky *sky, lmb_vec3 direction, float *density)
{
    const lmb_environment *environment = sky->environment;
    *density = 0.0f;
    if (!environment->present) {
        return rgb(0.0f, 0.0f, 0.0f);
    }
    if (!environment->image.rgb) {
        return rgb_scale(environment->constant, environment->strength);
    }
    const lmb_rgb pixel = image_pixel(&environment->image, pixel_of_direction(sky, direction));
    if (sky->cumulative) {
        *density = (float)((double)pixel_excess(sky, pixel) / sky->total);
    }
    return rgb_scale(pixel, environment->strength);
}

bool lmb_sky_sample(const lmb_sky *sky, const float point[2], lmb_light_sample *sample)
{
    if (!sky->cumulative) {
        return false;
    }
    const lmb_image *image = &sky->environment->image;
    const size_t width = (size_t)image->width;
    const size_t pixels = width * (size_t)image->height;
    const double target = (double)point[0] * sky->total;
    size_t found = sky->guide[(size_t)((double)point[0] * (double)pixels)];
    while (found + 1 < pixels && !(sky->cumulative[found] > target)) {
        ++found;
    }
    const double before = found > 0 ? sky->cumulative[found - 1] : 0.0;
    const double mass = sky->cumulative[found] - before;
    if (!(mass > 0.0)) {
        return false;
    }
    /* What is left of the first number within the pixel's share is again uniform. */
    const double across = fmin(fmax((target - before) / mass, 0.0), 1.0);
    const size_t row = found / width;
    const float u = (float)(((double)(found % width) + across) / (double)width);
    const double y = sky->row_cosine[row] + (sky->row_cosine[row + 1] - sky->row_cosine[row]) * (double)point[1];
    const float r = (float)sqrt(fmax(0.0, (1.0 - y) * (1.0 + y)));
    float sine, cosine;
    lmb_turn_sincos(u, &sine, &cosine); /* of the azimuth and half a turn */
    const bool openexr = sky->environment->axes == LMB_LATLONG_OPENEXR;
    const float x = r * (openexr ? sine : -cosine);
    const float z = r * (openexr ? -cosine : -sine);
    sample->direction = vec3(sky->rotation_cosine * x + sky->rotation_sine * z, (float)y,
                             sky->rotation_cosine * z - sky->rotation_sine * x);
    sample->end = sample->direction;
    const lmb_rgb pixel = image_pixel(image, found);
    sample->radiance = rgb_scale(pixel, sky->environment->strength);
    sample->density = (float)((double)pixel_excess(sky, pixel) / sky->total);
    return sample->density > 0.0f;
}
