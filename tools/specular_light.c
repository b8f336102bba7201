#include "specular_light.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/key_lights.h>
#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "half_vector.h"

/* Direction of a pixel's middle, for strength 1 and no rotation. */
static lmb_vec3 pixel_direction(const lmb_environment *environment, double x, double y)
{
    const double polar = LMB_PI * (y + 0.5) / environment->image.height;
    const double turn = 2.0 * LMB_PI * (x + 0.5) / environment->image.width;
    const float a = (float)(-sin(polar) * cos(turn)), b = (float)(-sin(polar) * sin(turn));
    return environment->axes == LMB_LATLONG_GLTF ? lmb_vec3_of(a, (float)cos(polar), b)
                                                 : lmb_vec3_of(-b, (float)cos(polar), a);
}

/* A pixel counts as bright from so many times the picture's mean on. */
#define BRIGHT 4.0f

static double pixel_solid_angle(const lmb_image *image, int y)
{
    const double band = cos(LMB_PI * y / image->height) - cos(LMB_PI * (y + 1) / image->height);
    return band * 2.0 * LMB_PI / image->width;
}

static lmb_rgb pixel_radiance(const lmb_image *image, int x, int y)
{
    const float *rgb = &image->rgb[3 * ((size_t)y * (size_t)image->width + (size_t)x)];
    return lmb_rgb_of(rgb[0], rgb[1], rgb[2]);
}

/* The share of a pixel's light that is above the most that samples are to meet. */
static float bright_share(const specular_light *light, lmb_rgb radiance)
{
    const float luminance = lmb_luminance(radiance);
    return luminance > light->most ? 1.0f - light->most / luminance : 0.0f;
}

static lmb_result bright_pixels_find(specular_light *light)
{
    const lmb_environment *environment = &light->scene.environment;
    const lmb_image *image = &environment->image;
    const size_t pixels = (size_t)image->width * (size_t)image->height;
    light->most = BRIGHT * lmb_sh3_rgb_luminance(&light->radiance).c[0] * 0.28209479f;
    light->bright_direction = malloc(pixels * sizeof *light->bright_direction);
    light->bright_light = malloc(pixels * sizeof *light->bright_light);
    for (int y = 0; light->bright_direction && light->bright_light && y < image->height; ++y) {
        for (int x = 0; x < image->width; ++x) {
            const lmb_rgb radiance = pixel_radiance(image, x, y);
            const float share = bright_share(light, radiance);
            if (share > 0.0f) {
                light->bright_direction[light->bright_count] = pixel_direction(environment, (double)x, (double)y);
                light->bright_light[light->bright_count++] =
                    lmb_rgb_scale(radiance, share * (float)pixel_solid_angle(image, y));
            }
        }
    }
    return light->bright_direction && light->bright_light ? LMB_OK : LMB_ERROR_MEMORY;
}

/* The picture's harmonics and its cells. */
static void picture_sum(specular_light *light)
{
    double sum[3][LMB_SH3_COUNT] = {{0.0}};
    const lmb_environment *environment = &light->scene.environment;
    const lmb_image *image = &environment->image;
    for (int y = 0; y < image->height; ++y) {
        const double solid_angle = pixel_solid_angle(image, y);
        for (int x = 0; x < image->width; ++x) {
            const lmb_sh3 basis = lmb_sh3_basis(pixel_direction(environment, (double)x, (double)y));
            const float *rgb = &image->rgb[3 * ((size_t)y * (size_t)image->width + (size_t)x)];
            const int cell = y * SPECULAR_ROWS / image->height * SPECULAR_COLUMNS + x * SPECULAR_COLUMNS / image->width;
            for (int c = 0; c < 3; ++c) {
                light->cell_light[cell].c[c] += (float)((double)rgb[c] * solid_angle);
                for (int i = 0; i < LMB_SH3_COUNT; ++i) {
                    sum[c][i] += (double)rgb[c] * (double)basis.c[i] * solid_angle;
                }
            }
        }
    }
    for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
        light->radiance.channel[i % 3].c[i / 3] = (float)sum[i % 3][i / 3];
    }
    for (int i = 0; i < SPECULAR_CELLS; ++i) {
        const double x = (i % SPECULAR_COLUMNS + 0.5) * image->width / SPECULAR_COLUMNS - 0.5;
        const double y = (i / SPECULAR_COLUMNS + 0.5) * image->height / SPECULAR_ROWS - 0.5;
        light->cell_direction[i] = pixel_direction(environment, x, y);
    }
}

lmb_result specular_light_open(const char *description, specular_light *light, lmb_error *error)
{
    *light = (specular_light){.sun = {.direction = {0.0f, 1.0f, 0.0f}}};
    lmb_result result = lmb_scene_set_environment(&light->scene, description, error);
    if (result == LMB_OK && (!light->scene.environment.image.rgb || light->scene.environment.rotation_rad != 0.0f ||
                             light->scene.environment.strength != 1.0f)) {
        result = lmb_error_set(error, LMB_ERROR_ARGUMENT, "%s: a picture or daylight, without rotation and strength",
                               description);
    }
    if (result == LMB_OK) {
        result = lmb_scene_choose_key_lights(&light->scene, 1);
    }
    if (result != LMB_OK) {
        specular_light_close(light);
        return result;
    }
    lmb_key_light keys[LMB_KEY_LIGHTS_MOST];
    if (lmb_scene_key_lights(&light->scene, keys) > 0) {
        light->sun = keys[0];
    }
    picture_sum(light);
    light->all = light->radiance;
    lmb_key_light_add_to_sh3(&light->sun, 1.0f, &light->all);
    light->dominant = lmb_sh3_rgb_dominant_light(&light->all);
    light->rest = light->all;
    lmb_key_light_add_to_sh3(&light->dominant, -1.0f, &light->rest);
    result = bright_pixels_find(light);
    if (result != LMB_OK) {
        specular_light_close(light);
        lmb_error_set(error, result, "%s: out of memory", description);
    }
    return result;
}

void specular_light_close(specular_light *light)
{
    for (uint32_t i = 0; i < light->scene.light_count; ++i) {
        free(light->scene.lights[i].name);
    }
    free(light->scene.lights);
    free(light->scene.environment.taken);
    free(light->bright_direction);
    free(light->bright_light);
    light->bright_direction = NULL;
    light->bright_light = NULL;
    lmb_image_free(&light->scene.environment.image);
    light->scene = (lmb_scene){.path = NULL};
}

lmb_rgb specular_light_look(const specular_light *light, lmb_vec3 direction)
{
    const lmb_environment *environment = &light->scene.environment;
    const lmb_image *image = &environment->image;
    const bool gltf = environment->axes == LMB_LATLONG_GLTF;
    const float x = gltf ? direction.x : direction.z, z = gltf ? direction.z : -direction.x;
    const float u = 0.5f + atan2f(z, x) / (2.0f * LMB_PI_F);
    const float v = acosf(lmb_larger(lmb_smaller(direction.y, 1.0f), -1.0f)) / LMB_PI_F;
    const int column = (int)(u * (float)image->width), row = (int)(v * (float)image->height);
    const int inside_column = column < image->width ? column : image->width - 1;
    const int inside_row = row < image->height ? row : image->height - 1;
    return pixel_radiance(image, inside_column, inside_row);
}

/* The reflectance times N.L, by its definition, of so many lights: radiance times solid angle. */
static lmb_rgb lights_reflected(const lmb_vec3 *direction, const lmb_rgb *weight, size_t count,
                                const specular_surface *surface)
{
    const lmb_specular *specular = &surface->specular;
    const lmb_vec3 normal = surface->normal, view = surface->view;
    const double m2 = (double)specular->roughness * (double)specular->roughness;
    const double nv = fmax((double)lmb_vec3_dot(normal, view), 1e-6);
    double sum[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < count; ++i) {
        const double nl = (double)lmb_vec3_dot(normal, direction[i]);
        if (!(nl > 0.0)) {
            continue;
        }
        const double along = sqrt(0.5 + 0.5 * (double)lmb_vec3_dot(view, direction[i]));
        const double up = fmin((nl + nv) / (2.0 * along), 1.0), up2 = up * up;
        const double slopes = exp((up2 - 1.0) / (up2 * m2)) / (LMB_PI * m2 * up2 * up2);
        const double lobe = slopes * fmin(1.0, 2.0 * up * fmin(nv, nl) / along) / (4.0 * nv);
        for (int c = 0; c < 3; ++c) {
            sum[c] +=
                lobe * dielectric_reflectance((double)specular->f0.c[c], fmin(along, 1.0)) * (double)weight[i].c[c];
        }
    }
    return lmb_rgb_of((float)sum[0], (float)sum[1], (float)sum[2]);
}

lmb_rgb specular_traced(const specular_light *light, const specular_surface *surface, uint32_t samples, uint64_t stream)
{
    const lmb_specular *specular = &surface->specular;
    if (specular->roughness >= SPECULAR_WIDE) {
        return lights_reflected(light->cell_direction, light->cell_light, SPECULAR_CELLS, surface);
    }
    double sum[3] = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < samples; ++i) {
        float u[2];
        half_vector_sample picked;
        lmb_sequence_2d(stream, i, 0, u);
        if (half_vector_pick(specular->roughness, surface->normal, surface->view, u, &picked)) {
            const lmb_rgb there = specular_light_look(light, picked.towards);
            const lmb_rgb seen = lmb_rgb_scale(there, 1.0f - bright_share(light, there));
            for (int c = 0; c < 3; ++c) {
                const double f0 = (double)specular->f0.c[c];
                sum[c] += picked.arrives * dielectric_reflectance(f0, picked.along) * (double)seen.c[c];
            }
        }
    }
    return lmb_rgb_add(lights_reflected(light->bright_direction, light->bright_light, light->bright_count, surface),
                       lmb_rgb_of((float)(sum[0] / samples), (float)(sum[1] / samples), (float)(sum[2] / samples)));
}

/* The picture of a mirroring surface that is looked at along its normal, which a cube map holds for each roughness. */
static lmb_rgb mirrored_picture(const specular_light *light, float roughness, lmb_vec3 mirrored, uint32_t samples,
                                uint64_t stream)
{
    const specular_surface mirror = {{roughness, {{1.0f, 1.0f, 1.0f}}}, mirrored, mirrored};
    return specular_traced(light, &mirror, samples, stream);
}

/* As it is stored in a map, and taken from there. */
static lmb_rgb environment_layer(const specular_light *light, const specular_surface *surface, lmb_vec3 mirrored,
                                 lmb_rgb picture)
{
    const lmb_rgb divisor = lmb_specular_environment_divisor(&light->radiance, surface->specular.roughness, mirrored);
    for (int c = 0; c < 3; ++c) {
        picture.c[c] /= lmb_larger(divisor.c[c], 1e-20f);
    }
    return lmb_specular_environment(picture, &light->radiance, &surface->specular, surface->normal, surface->view);
}

/* That as a mean of the light that it sees, times what a white sky sends on. */
static lmb_rgb split_layer(const specular_surface *surface, lmb_rgb picture)
{
    const lmb_sh3_rgb white = {{{{3.5449077f}}, {{3.5449077f}}, {{3.5449077f}}}};
    const lmb_specular mirror = {surface->specular.roughness, {{1.0f, 1.0f, 1.0f}}};
    const float kept = lmb_specular_area(&white, &mirror, surface->normal, surface->normal).c[0];
    const lmb_rgb sent = lmb_specular_area(&white, &surface->specular, surface->normal, surface->view);
    return lmb_rgb_scale(lmb_rgb_mul(picture, sent), 1.0f / kept);
}

static lmb_rgb picture_layer(const specular_light *light, specular_layer layer, const specular_surface *surface,
                             uint32_t samples, uint64_t stream)
{
    const lmb_vec3 normal = surface->normal, back = lmb_vec3_scale(surface->view, -1.0f);
    const lmb_vec3 mirrored =
        lmb_vec3_unit_or(lmb_vec3_mad(back, normal, 2.0f * lmb_vec3_dot(normal, surface->view)), normal);
    const lmb_rgb picture = mirrored_picture(light, surface->specular.roughness, mirrored, samples, stream);
    return layer == SPECULAR_ENVIRONMENT ? environment_layer(light, surface, mirrored, picture)
                                         : split_layer(surface, picture);
}

lmb_rgb specular_layer_of(const specular_light *light, specular_layer layer, const specular_surface *surface,
                          uint32_t samples, uint64_t stream)
{
    const lmb_sh3_rgb *harmonics = layer == SPECULAR_DOMINANT                              ? &light->rest
                                   : layer == SPECULAR_PAPER || layer == SPECULAR_ALL_AREA ? &light->all
                                                                                           : &light->radiance;
    if (layer == SPECULAR_ENVIRONMENT || layer == SPECULAR_SPLIT) {
        return picture_layer(light, layer, surface, samples, stream);
    }
    const lmb_vec3 normal = surface->normal, view = surface->view;
    if (layer == SPECULAR_PHONG) {
        const lmb_specular as_wide = {2.0f * surface->specular.roughness, surface->specular.f0};
        return lmb_specular_area_phong(harmonics, &as_wide, normal, view);
    }
    const lmb_rgb sun = lmb_specular_light(&light->sun, 1.0f, &surface->specular, normal, normal, view);
    if (layer == SPECULAR_SUN) {
        return sun;
    }
    if (layer == SPECULAR_KEY_MAP) {
        return lmb_rgb_add(sun, picture_layer(light, SPECULAR_ENVIRONMENT, surface, samples, stream));
    }
    const lmb_rgb area = lmb_specular_area(harmonics, &surface->specular, normal, view);
    if (layer == SPECULAR_AREA || layer == SPECULAR_ALL_AREA) {
        return area;
    }
    return lmb_rgb_add(area, layer == SPECULAR_KEY ? sun
                                                   : lmb_specular_light(&light->dominant, 1.0f, &surface->specular,
                                                                        normal, normal, view));
}
