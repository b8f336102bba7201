/* The sun in an environment's picture: the brightest pixel and those around it that are nearly as bright, where they
 * are few and give much of the light. What these have more than the pixels around them becomes a disc that gives a
 * surface the same irradiance. */
#include <lambent/environment.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/key_lights.h>
#include <lambent/vector.h>

#include "base/trig.h"

/* Pixels of the sun have this share of the brightest one's luminance. */
#define SUN_LUMINANCE 0.1f

/* And none is farther from that one: cosine of half of LMB_KEY_MOST_ANGLE_DEG. */
#define MOST_COSINE 0.99619469809174553
#define MOST_SINE 0.08715574274765818

/* Of the irradiance of a surface that faces it, the sun gives at least this share. */
#define LEAST_SHARE 0.1

/* A pixel is cut into so many parts along each side. */
enum { PARTS = 8 };

typedef struct vec3_sum {
    double x, y, z;
} vec3_sum;

/* How a picture lies in the world. */
typedef struct picture_axes {
    const lmb_environment *environment;
    double turned_sine, turned_cosine;
} picture_axes;

static picture_axes axes_of(const lmb_environment *environment)
{
    picture_axes axes = {.environment = environment};
    lmb_sincos((double)environment->rotation_rad, &axes.turned_sine, &axes.turned_cosine);
    return axes;
}

/* World direction of the polar angle of cosine `y` and an azimuth in turns, as light/sky.c has them. */
static vec3_sum direction_of(const picture_axes *axes, double y, double turn)
{
    const bool openexr = axes->environment->axes == LMB_LATLONG_OPENEXR;
    const double r = sqrt(fmax((1.0 - y) * (1.0 + y), 0.0));
    double sine, cosine;
    lmb_sincos(2.0 * LMB_PI * turn, &sine, &cosine);
    const double x = openexr ? r * sine : -r * cosine;
    const double z = openexr ? -r * cosine : -r * sine;
    return (vec3_sum){axes->turned_cosine * x + axes->turned_sine * z, y,
                      axes->turned_cosine * z - axes->turned_sine * x};
}

static double row_cosine(const lmb_environment *environment, double row)
{
    double sine, cosine;
    lmb_sincos(LMB_PI * row / environment->image.height, &sine, &cosine);
    return cosine;
}

static double dot(vec3_sum a, vec3_sum b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vec3_sum pixel_direction(const picture_axes *axes, uint32_t pixel)
{
    const uint32_t width = (uint32_t)axes->environment->image.width;
    const double row = pixel / width, column = pixel % width;
    return direction_of(axes, row_cosine(axes->environment, row + 0.5), (column + 0.5) / width);
}

static lmb_rgb pixel_radiance(const lmb_environment *environment, uint32_t pixel)
{
    const float *rgb = &environment->image.rgb[3 * (size_t)pixel];
    return lmb_rgb_of(rgb[0], rgb[1], rgb[2]);
}

static uint32_t brightest_find(const lmb_environment *environment)
{
    const size_t count = (size_t)environment->image.width * (size_t)environment->image.height;
    uint32_t brightest = 0;
    float most = -1.0f;
    for (size_t i = 0; i < count; ++i) {
        const float luminance = lmb_luminance(pixel_radiance(environment, (uint32_t)i));
        if (luminance > most) {
            most = luminance;
            brightest = (uint32_t)i;
        }
    }
    return brightest;
}

/* The k-th of the eight pixels around one, across the picture's sides; UINT32_MAX beyond a pole. */
static uint32_t pixel_beside(const lmb_image *image, uint32_t pixel, int k)
{
    const int step = k < 4 ? k : k + 1;
    const int32_t width = image->width;
    const int32_t row = (int32_t)(pixel / (uint32_t)width) + step / 3 - 1;
    const int32_t column = ((int32_t)(pixel % (uint32_t)width) + step % 3 - 1 + width) % width;
    return row >= 0 && row < image->height ? (uint32_t)row * (uint32_t)width + (uint32_t)column : UINT32_MAX;
}

static int pixel_compare(const void *a, const void *b)
{
    const uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
    return (p > q) - (p < q);
}

/* What growing knows of a pixel. */
enum { PIXEL_UNSEEN, PIXEL_OF_SUN, PIXEL_AROUND };

/* The sun's pixels while they are found, first come first. */
typedef struct sun_growth {
    lmb_environment_sun *sun;
    uint8_t *seen; /* [pixel] */
    uint32_t room;
    double around[3];
    uint32_t around_count;
} sun_growth;

static bool growth_add(sun_growth *growth, uint32_t pixel)
{
    lmb_environment_sun *sun = growth->sun;
    if (sun->count == growth->room) {
        const uint32_t room = growth->room > 0 ? 2 * growth->room : 64;
        uint32_t *const more = realloc(sun->pixel, room * sizeof *more);
        if (!more) {
            return false;
        }
        sun->pixel = more;
        growth->room = room;
    }
    growth->seen[pixel] = PIXEL_OF_SUN;
    sun->pixel[sun->count++] = pixel;
    return true;
}

/* Of a pixel beside the sun that is darker. */
static void growth_surround(sun_growth *growth, uint32_t pixel, lmb_rgb radiance)
{
    growth->seen[pixel] = PIXEL_AROUND;
    ++growth->around_count;
    for (int c = 0; c < 3; ++c) {
        growth->around[c] += (double)radiance.c[c];
    }
}

/* From the brightest pixel outwards. One that is too far off ends it, without any. */
static lmb_result growth_run(sun_growth *growth, const picture_axes *axes)
{
    const lmb_environment *environment = axes->environment;
    lmb_environment_sun *sun = growth->sun;
    const uint32_t brightest = brightest_find(environment);
    const vec3_sum middle = pixel_direction(axes, brightest);
    const float least = SUN_LUMINANCE * lmb_luminance(pixel_radiance(environment, brightest));
    if (!(least > 0.0f)) {
        return LMB_OK;
    }
    if (!growth_add(growth, brightest)) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < sun->count; ++i) {
        for (int k = 0; k < 8; ++k) {
            const uint32_t beside = pixel_beside(&environment->image, sun->pixel[i], k);
            if (beside == UINT32_MAX || growth->seen[beside] != PIXEL_UNSEEN) {
                continue;
            }
            const lmb_rgb radiance = pixel_radiance(environment, beside);
            if (lmb_luminance(radiance) < least) {
                growth_surround(growth, beside, radiance);
            } else if (dot(pixel_direction(axes, beside), middle) < MOST_COSINE) {
                sun->count = 0;
                return LMB_OK;
            } else if (!growth_add(growth, beside)) {
                return LMB_ERROR_MEMORY;
            }
        }
    }
    for (int c = 0; c < 3 && growth->around_count > 0; ++c) {
        sun->around.c[c] = (float)(growth->around[c] / growth->around_count);
    }
    qsort(sun->pixel, sun->count, sizeof *sun->pixel, pixel_compare);
    return LMB_OK;
}

/* What stays of a pixel of the sun. */
static lmb_rgb pixel_rest(const lmb_environment_sun *sun, lmb_rgb radiance)
{
    for (int c = 0; c < 3; ++c) {
        radiance.c[c] = lmb_smaller(sun->around.c[c], radiance.c[c]);
    }
    return radiance;
}

static lmb_rgb pixel_excess(const lmb_environment *environment, const lmb_environment_sun *sun, uint32_t pixel)
{
    const lmb_rgb radiance = pixel_radiance(environment, pixel);
    return lmb_rgb_add(radiance, lmb_rgb_scale(pixel_rest(sun, radiance), -1.0f));
}

/* Calls `visit` with the direction and solid angle of each part of a pixel. */
typedef void (*part_function)(void *context, vec3_sum direction, double solid_angle);
static void pixel_parts(const picture_axes *axes, uint32_t pixel, part_function visit, void *context)
{
    const lmb_environment *environment = axes->environment;
    const uint32_t width = (uint32_t)environment->image.width;
    const double row = pixel / width, column = pixel % width;
    const double top = row_cosine(environment, row), bottom = row_cosine(environment, row + 1.0);
    const double solid_angle = (top - bottom) * 2.0 * LMB_PI / width / (PARTS * PARTS);
    for (int k = 0; k < PARTS * PARTS; ++k) {
        const double down = (k / PARTS + 0.5) / PARTS, across = (k % PARTS + 0.5) / PARTS;
        visit(context, direction_of(axes, top + (bottom - top) * down, (column + across) / width), solid_angle);
    }
}

static void vector_add(void *context, vec3_sum direction, double solid_angle)
{
    vec3_sum *sum = context;
    sum->x += direction.x * solid_angle;
    sum->y += direction.y * solid_angle;
    sum->z += direction.z * solid_angle;
}

/* About the sun's direction. */
typedef struct spread_sum {
    vec3_sum axis;
    double cosine, squared_sine; /* their sums by solid angle, the latter by cosine too */
} spread_sum;

static void spread_add(void *context, vec3_sum direction, double solid_angle)
{
    spread_sum *sum = context;
    const double cosine = dot(direction, sum->axis);
    sum->cosine += cosine * solid_angle;
    sum->squared_sine += (1.0 - cosine) * (1.0 + cosine) * cosine * solid_angle;
}

/* Direction, irradiance and extent: the vector irradiance of the excess, and its second moment, which of a disc of sine
 * s is s^2/2. Returns the luminance of the irradiance, for strength 1; 0 where it is too wide, as a pixel of a small
 * picture is. */
static double sun_measure(const picture_axes *axes, lmb_environment_sun *sun)
{
    const lmb_environment *environment = axes->environment;
    vec3_sum light[3] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    for (uint32_t i = 0; i < sun->count; ++i) {
        const lmb_rgb excess = pixel_excess(environment, sun, sun->pixel[i]);
        vec3_sum sum = {0.0, 0.0, 0.0};
        pixel_parts(axes, sun->pixel[i], vector_add, &sum);
        for (int c = 0; c < 3; ++c) {
            light[c].x += (double)excess.c[c] * sum.x;
            light[c].y += (double)excess.c[c] * sum.y;
            light[c].z += (double)excess.c[c] * sum.z;
        }
    }
    const double weight[3] = {0.2126, 0.7152, 0.0722};
    vec3_sum axis = {0.0, 0.0, 0.0};
    for (int c = 0; c < 3; ++c) {
        axis.x += weight[c] * light[c].x;
        axis.y += weight[c] * light[c].y;
        axis.z += weight[c] * light[c].z;
    }
    const double length = sqrt(dot(axis, axis));
    if (!(length > 0.0)) {
        return 0.0;
    }
    spread_sum spread = {.axis = {axis.x / length, axis.y / length, axis.z / length}};
    double whole = 0.0, squared_sine = 0.0;
    for (uint32_t i = 0; i < sun->count; ++i) {
        const double excess = (double)lmb_luminance(pixel_excess(environment, sun, sun->pixel[i]));
        spread.cosine = spread.squared_sine = 0.0;
        pixel_parts(axes, sun->pixel[i], spread_add, &spread);
        whole += excess * spread.cosine;
        squared_sine += excess * spread.squared_sine;
    }
    for (int c = 0; c < 3; ++c) {
        const double irradiance = dot(light[c], spread.axis) * (double)environment->strength;
        sun->irradiance.c[c] = (float)fmax(irradiance, 0.0);
    }
    sun->direction = lmb_vec3_of((float)spread.axis.x, (float)spread.axis.y, (float)spread.axis.z);
    const double s = sqrt(2.0 * squared_sine / whole);
    sun->angle_rad = (float)(2.0 * s * (1.0 + s * s * (1.0 / 6.0 + s * s * (3.0 / 40.0)))); /* twice the arc sine */
    return s <= MOST_SINE ? length : 0.0;
}

/* Luminance of the irradiance that the whole picture gives a surface facing that way, for strength 1. `level` has room
 * for a row. */
static double picture_irradiance(const picture_axes *axes, lmb_vec3 towards, double *level)
{
    const lmb_environment *environment = axes->environment;
    const vec3_sum normal = {(double)towards.x, (double)towards.y, (double)towards.z};
    const uint32_t width = (uint32_t)environment->image.width, height = (uint32_t)environment->image.height;
    for (uint32_t column = 0; column < width; ++column) {
        level[column] = dot(direction_of(axes, 0.0, (column + 0.5) / width), normal);
    }
    double sum = 0.0;
    for (uint32_t row = 0; row < height; ++row) {
        const double top = row_cosine(environment, row), bottom = row_cosine(environment, row + 1.0);
        const double y = 0.5 * (top + bottom), r = sqrt((1.0 - y) * (1.0 + y));
        double across = 0.0;
        for (uint32_t column = 0; column < width; ++column) {
            const double cosine = y * normal.y + r * level[column];
            const double luminance = (double)lmb_luminance(pixel_radiance(environment, row * width + column));
            across += luminance * fmax(cosine, 0.0);
        }
        sum += across * (top - bottom) * 2.0 * LMB_PI / width;
    }
    return sum;
}

lmb_result lmb_environment_find_sun(const lmb_environment *environment, lmb_environment_sun *sun)
{
    *sun = (lmb_environment_sun){.count = 0};
    if (!environment->present || !environment->image.rgb || !(environment->strength > 0.0f) || environment->has_sun) {
        return LMB_OK;
    }
    const picture_axes axes = axes_of(environment);
    const size_t pixels = (size_t)environment->image.width * (size_t)environment->image.height;
    sun_growth growth = {.sun = sun, .seen = calloc(pixels, 1)};
    double *const row = malloc((size_t)environment->image.width * sizeof *row);
    const lmb_result result = growth.seen && row ? growth_run(&growth, &axes) : LMB_ERROR_MEMORY;
    const double light = result == LMB_OK && sun->count > 0 ? sun_measure(&axes, sun) : 0.0;
    if (!(light > 0.0) || light < LEAST_SHARE * picture_irradiance(&axes, sun->direction, row)) {
        lmb_environment_sun_free(sun);
    }
    free(growth.seen);
    free(row);
    return result;
}

lmb_result lmb_environment_take_sun(lmb_environment *environment, const lmb_environment_sun *sun)
{
    lmb_environment_pixel *const taken = malloc((sun->count + 1u) * sizeof *taken);
    if (!taken) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < sun->count; ++i) {
        const lmb_rgb radiance = pixel_radiance(environment, sun->pixel[i]);
        const lmb_rgb rest = pixel_rest(sun, radiance);
        taken[i] = (lmb_environment_pixel){sun->pixel[i], radiance};
        memcpy(&environment->image.rgb[3 * (size_t)sun->pixel[i]], rest.c, sizeof rest.c);
    }
    free(environment->taken);
    environment->taken = taken;
    environment->taken_count = sun->count;
    return LMB_OK;
}

void lmb_environment_sun_free(lmb_environment_sun *sun)
{
    free(sun->pixel);
    *sun = (lmb_environment_sun){.count = 0};
}
