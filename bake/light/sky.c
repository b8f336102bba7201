#include "light/sky.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "base/trig.h"
#include "base/vectorised.h"

/* Below this share of the light, what stands out is not worth a ray of its own. */
#define MIN_EXCESS_SHARE 1e-3

static lmb_rgb image_pixel(const lmb_image *image, size_t pixel)
{
    return lmb_rgb_of(image->rgb[3 * pixel], image->rgb[3 * pixel + 1], image->rgb[3 * pixel + 2]);
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
            const float excess = pixel_excess(sky, image_pixel(image, pixel));
            if (excess > 0.0f) {
                total += (double)excess * row_solid_angle(sky, row);
                sky->aimed[sky->aimed_count] = (uint32_t)pixel;
                sky->cumulative[sky->aimed_count++] = total;
            }
        }
    }
    sky->total = total;
}

/* For each of equal shares of the total, the first entry in `aimed` whose running sum exceeds it. */
static void guide_make(lmb_sky *sky)
{
    uint32_t entry = 0;
    for (uint32_t i = 0; i < sky->aimed_count; ++i) {
        const double target = (double)i / (double)sky->aimed_count * sky->total;
        while (entry + 1 < sky->aimed_count && !(sky->cumulative[entry] > target)) {
            ++entry;
        }
        sky->guide[i] = entry;
    }
}

static void pixels_make(lmb_sky *sky, size_t pixels)
{
    for (size_t i = 0; i < pixels; ++i) {
        const lmb_rgb pixel = image_pixel(&sky->environment->image, i);
        sky->pixel[i].radiance = lmb_rgb_scale(pixel, sky->environment->strength);
        sky->pixel[i].density = sky->aimed_count > 0 ? (float)((double)pixel_excess(sky, pixel) / sky->total) : 0.0f;
    }
}

static void distribution_free(lmb_sky *sky)
{
    free(sky->aimed);
    free(sky->cumulative);
    free(sky->guide);
    free(sky->row_cosine);
    sky->aimed_count = 0;
    sky->aimed = NULL;
    sky->cumulative = NULL;
    sky->guide = NULL;
    sky->row_cosine = NULL;
}

static lmb_result distribution_create(lmb_sky *sky, bool aimed)
{
    const lmb_image *image = &sky->environment->image;
    const size_t pixels = (size_t)image->width * (size_t)image->height;
    sky->pixel = malloc(pixels * sizeof *sky->pixel);
    sky->aimed = malloc(pixels * sizeof *sky->aimed);
    sky->cumulative = malloc(pixels * sizeof *sky->cumulative);
    sky->guide = malloc(pixels * sizeof *sky->guide);
    sky->row_cosine = malloc(((size_t)image->height + 1) * sizeof *sky->row_cosine);
    if (!sky->pixel || !sky->aimed || !sky->cumulative || !sky->guide || !sky->row_cosine) {
        lmb_sky_free(sky);
        return LMB_ERROR_MEMORY;
    }
    rows_make(sky);
    const double power = image_power(sky);
    sky->mean = (float)(power / (4.0 * LMB_PI));
    cumulative_make(sky);
    if (aimed && sky->total > MIN_EXCESS_SHARE * power) {
        guide_make(sky);
    } else {
        distribution_free(sky);
    }
    pixels_make(sky, pixels);
    return LMB_OK;
}

lmb_result lmb_sky_create(const lmb_environment *environment, bool aimed, lmb_sky *created)
{
    double sine, cosine;
    lmb_sincos((double)environment->rotation_rad, &sine, &cosine);
    *created = (lmb_sky){.environment = environment, .rotation_sine = (float)sine, .rotation_cosine = (float)cosine};
    return environment->present && environment->image.rgb ? distribution_create(created, aimed) : LMB_OK;
}

void lmb_sky_free(lmb_sky *freed)
{
    distribution_free(freed);
    free(freed->pixel);
    freed->pixel = NULL;
}

static inline uint32_t share_to_index(float share, int32_t size)
{
    const int32_t index = (int32_t)(share * (float)size);
    return (uint32_t)(index < 0 ? 0 : index < size ? index : size - 1);
}

/* World direction -> pixel. Azimuth runs from u = 0 (glTF: -X, through -Z, +X, +Z; OpenEXR: -Z, through +X, +Z, -X). */
static inline uint32_t pixel_of_direction(const lmb_sky *sky, float from_x, float from_y, float from_z)
{
    const lmb_image *image = &sky->environment->image;
    /* Turning the environment by +a is looking it up turned by -a. */
    const float x = sky->rotation_cosine * from_x - sky->rotation_sine * from_z;
    const float z = sky->rotation_sine * from_x + sky->rotation_cosine * from_z;
    const bool openexr = sky->environment->axes == LMB_LATLONG_OPENEXR;
    const float azimuth = lmb_turn_of(openexr ? z : x, openexr ? -x : z);
    const float polar = lmb_turn_of(from_y, sqrtf(x * x + z * z));
    const uint32_t row = share_to_index(2.0f * polar, image->height);
    return row * (uint32_t)image->width + share_to_index(0.5f + azimuth, image->width);
}

lmb_environment_seen lmb_sky_look(const lmb_sky *sky, lmb_vec3 direction)
{
    const float *const axes[3] = {&direction.x, &direction.y, &direction.z};
    lmb_environment_seen seen;
    lmb_sky_look_batch(sky, axes, 1, &seen);
    return seen;
}

static int taken_compare(const void *key, const void *element)
{
    const uint32_t pixel = *(const uint32_t *)key, other = ((const lmb_environment_pixel *)element)->pixel;
    return (pixel > other) - (pixel < other);
}

lmb_rgb lmb_sky_shown(const lmb_sky *sky, lmb_vec3 direction)
{
    const lmb_environment *environment = sky->environment;
    const lmb_environment_pixel *taken = NULL;
    if (environment->taken_count > 0) {
        const uint32_t pixel = pixel_of_direction(sky, direction.x, direction.y, direction.z);
        taken = bsearch(&pixel, environment->taken, environment->taken_count, sizeof *taken, taken_compare);
    }
    return taken ? lmb_rgb_scale(taken->radiance, environment->strength) : lmb_sky_look(sky, direction).radiance;
}

enum { BATCH = 64 };

LMB_VECTORISED
static void pixels_of_directions(const lmb_sky *sky, const float *restrict x, const float *restrict y,
                                 const float *restrict z, uint32_t count, uint32_t *restrict pixel)
{
    for (uint32_t i = 0; i < count; ++i) {
        pixel[i] = pixel_of_direction(sky, x[i], y[i], z[i]);
    }
}

void lmb_sky_look_batch(const lmb_sky *sky, const float *const direction[3], uint32_t count, lmb_environment_seen *seen)
{
    const lmb_environment *environment = sky->environment;
    if (!sky->pixel) {
        const lmb_rgb constant = environment->present ? lmb_rgb_scale(environment->constant, environment->strength)
                                                      : lmb_rgb_of(0.0f, 0.0f, 0.0f);
        for (uint32_t i = 0; i < count; ++i) {
            seen[i] = (lmb_environment_seen){constant, 0.0f};
        }
        return;
    }
    uint32_t pixel[BATCH];
    for (uint32_t first = 0; first < count; first += BATCH) {
        const uint32_t some = count - first < BATCH ? count - first : BATCH;
        pixels_of_directions(sky, direction[0] + first, direction[1] + first, direction[2] + first, some, pixel);
        for (uint32_t i = 0; i < some; ++i) {
            seen[first + i] = sky->pixel[pixel[i]];
        }
    }
}

static uint32_t guide_entry(const lmb_sky *sky, float u)
{
    return (uint32_t)((double)u * (double)sky->aimed_count);
}

/* The pixel that u in [0, 1) picks, where the guide sends it to `found`, and how far into its share of the total it is,
 * in [0, 1]. */
static uint32_t pixel_pick(const lmb_sky *sky, float u, uint32_t found, float *across)
{
    const double target = (double)u * sky->total;
    while (found + 1 < sky->aimed_count && !(sky->cumulative[found] > target)) {
        ++found;
    }
    const double before = found > 0 ? sky->cumulative[found - 1] : 0.0;
    const double mass = sky->cumulative[found] - before;
    const double share = mass > 0.0 ? (target - before) / mass : 0.0;
    *across = (float)(share > 0.0 ? share < 1.0 ? share : 1.0 : 0.0);
    return sky->aimed[found];
}

/* Points of picked pixels: their share of a turn about the vertical, and the cosine of the polar angle. */
typedef struct pixel_points {
    float turn[BATCH];
    double cosine[BATCH];
} pixel_points;

static void pixel_points_find(const lmb_sky *sky, const uint32_t *picked, const float *across, const float *down,
                              uint32_t count, pixel_points *points)
{
    const uint32_t width = (uint32_t)sky->environment->image.width;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t row = picked[i] / width;
        points->turn[i] = (float)(((double)(picked[i] - row * width) + (double)across[i]) / (double)width);
        points->cosine[i] = sky->row_cosine[row] + (sky->row_cosine[row + 1] - sky->row_cosine[row]) * (double)down[i];
    }
}

LMB_VECTORISED
static void points_directions(const lmb_sky *sky, const pixel_points *restrict points, uint32_t count,
                              float *restrict to_x, float *restrict to_y, float *restrict to_z)
{
    /* Of the turn and half a turn more (glTF), or a quarter: see pixel_of_direction. */
    const bool openexr = sky->environment->axes == LMB_LATLONG_OPENEXR;
    const float x_of_sine = openexr ? 1.0f : 0.0f, x_of_cosine = openexr ? 0.0f : -1.0f;
    const float turned_cosine = sky->rotation_cosine, turned_sine = sky->rotation_sine;
    for (uint32_t i = 0; i < count; ++i) {
        const double y = points->cosine[i];
        const double square = (1.0 - y) * (1.0 + y);
        const float r = sqrtf((float)(square > 0.0 ? square : 0.0));
        float sine, cosine;
        lmb_turn_sincos(points->turn[i], &sine, &cosine);
        const float x = r * (x_of_sine * sine + x_of_cosine * cosine);
        const float z = r * (x_of_cosine * sine - x_of_sine * cosine);
        to_x[i] = turned_cosine * x + turned_sine * z;
        to_y[i] = (float)y;
        to_z[i] = turned_cosine * z - turned_sine * x;
    }
}

/* Picks pixels by up to BATCH variates: each table is asked for all of them before any answer is needed. */
static void pixels_pick(const lmb_sky *sky, const float *u, uint32_t count, uint32_t *picked, float *across)
{
    for (uint32_t i = 0; i < count; ++i) {
        __builtin_prefetch(&sky->guide[guide_entry(sky, u[i])]);
    }
    for (uint32_t i = 0; i < count; ++i) {
        picked[i] = sky->guide[guide_entry(sky, u[i])];
        __builtin_prefetch(&sky->cumulative[picked[i]]);
        __builtin_prefetch(&sky->aimed[picked[i]]);
    }
    for (uint32_t i = 0; i < count; ++i) {
        picked[i] = pixel_pick(sky, u[i], picked[i], &across[i]);
        __builtin_prefetch(&sky->pixel[picked[i]]);
    }
}

static void batch_sample(const lmb_sky *sky, const float *x, const float *y, uint32_t count, lmb_light_sample *sample)
{
    uint32_t picked[BATCH];
    float across[BATCH], to_x[BATCH], to_y[BATCH], to_z[BATCH];
    pixel_points points;
    pixels_pick(sky, x, count, picked, across);
    pixel_points_find(sky, picked, across, y, count, &points);
    points_directions(sky, &points, count, to_x, to_y, to_z);
    for (uint32_t i = 0; i < count; ++i) {
        const lmb_environment_seen *pixel = &sky->pixel[picked[i]];
        sample[i].direction = lmb_vec3_of(to_x[i], to_y[i], to_z[i]);
        sample[i].radiance = pixel->radiance;
        sample[i].density = pixel->density;
    }
}

void lmb_sky_sample_batch(const lmb_sky *sky, const float *x, const float *y, uint32_t count, lmb_light_sample *sample)
{
    for (uint32_t first = 0; first < count; first += BATCH) {
        const uint32_t some = count - first < BATCH ? count - first : BATCH;
        batch_sample(sky, x + first, y + first, some, sample + first);
    }
}
