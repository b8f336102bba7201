#include "image/image_internal.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>
#include <lambent/environment.h>
#include <lambent/light_sets.h>
#include <lambent/texture.h>
#include <lambent/vector.h>

#include "base/hex_digit.h"
#include "scene/environment_daylight.h"
#include "scene/environment_description.h"
#include "scene/environment_sky_basis.h"
#include "scene/scene_internal.h"

/* Of #rrggbb. */
static void colour_bytes(const char *text, unsigned char bytes[3])
{
    for (int c = 0; c < 3; ++c) {
        bytes[c] = (unsigned char)(16 * lmb_hex_digit(text[1 + 2 * c]) + lmb_hex_digit(text[2 + 2 * c]));
    }
}

static uint64_t float_hash(uint64_t hash, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    const unsigned char bytes[4] = {(unsigned char)bits, (unsigned char)(bits >> 8), (unsigned char)(bits >> 16),
                                    (unsigned char)(bits >> 24)};
    return lmb_hash(hash, bytes, sizeof bytes);
}

/* Shapes that other pictures of surroundings have. */
static const struct {
    int32_t across, down;
    const char *what;
} OTHER_SHAPES[] = {
    {1, 1, "one face of a cube, or a mirror ball"},
    {4, 3, "a horizontal cross of cube faces"},
    {3, 4, "a vertical cross of cube faces"},
    {6, 1, "a strip of cube faces"},
    {1, 6, "a strip of cube faces"},
    {1, 2, "two pictures above each other, or one that was turned"},
};

/* Whether a picture is across : down, within 1 % of its height: renderers and resizing round. */
static bool shape_is(const lmb_image *image, int32_t across, int32_t down)
{
    const int64_t difference = (int64_t)image->width * down - (int64_t)image->height * across;
    return 100 * (difference < 0 ? -difference : difference) <= (int64_t)image->height * down;
}

/* A picture of another shape than an equirectangular one's would be stretched over the sphere all the same. */
static lmb_result shape_check(const char *source, const lmb_image *image, lmb_error *error)
{
    if (shape_is(image, 2, 1)) {
        return LMB_OK;
    }
    char found[96] = "";
    for (size_t i = 0; i < sizeof OTHER_SHAPES / sizeof OTHER_SHAPES[0]; ++i) {
        if (shape_is(image, OTHER_SHAPES[i].across, OTHER_SHAPES[i].down)) {
            snprintf(found, sizeof found, "; %d : %d is %s", OTHER_SHAPES[i].across, OTHER_SHAPES[i].down,
                     OTHER_SHAPES[i].what);
            break;
        }
    }
    return lmb_error_set(error, LMB_ERROR_UNSUPPORTED,
                         "%s: an environment is an equirectangular picture, twice as wide as high, not %d x %d%s",
                         source, image->width, image->height, found);
}

static void constant_set(const char *source, lmb_environment *environment, uint64_t *hash)
{
    unsigned char bytes[3];
    colour_bytes(source, bytes);
    for (int c = 0; c < 3; ++c) {
        environment->constant.c[c] = lmb_srgb_to_linear(bytes[c]);
    }
    *hash = lmb_hash(*hash, bytes, sizeof bytes);
}

static lmb_result picture_read(const char *source, lmb_environment *environment, uint64_t *hash, lmb_error *error)
{
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_result result = lmb_file_read(source, &data, &size, error);
    if (result == LMB_OK) {
        result = lmb_image_decode(&(lmb_image_bytes){source, data, size}, &environment->image, &environment->axes, NULL,
                                  error);
        *hash = lmb_hash(*hash, data, size);
        free(data);
    }
    if (result == LMB_OK) {
        result = shape_check(source, &environment->image, error);
        if (result != LMB_OK) {
            lmb_image_free(&environment->image);
        }
    }
    return result;
}

static lmb_result daylight_make(const lmb_environment_description *described, lmb_environment *environment,
                                lmb_environment_sun *sun, uint64_t *hash)
{
    const lmb_result result = lmb_environment_daylight(described, environment, sun);
    const lmb_image *image = &environment->image;
    for (int32_t i = 0; result == LMB_OK && i < 3 * image->width * image->height; ++i) {
        *hash = float_hash(*hash, image->rgb[i]);
    }
    const float numbers[6] = {sun->direction.x,     sun->direction.y,     sun->direction.z,
                              sun->irradiance.c[0], sun->irradiance.c[1], sun->irradiance.c[2]};
    for (int i = 0; result == LMB_OK && i < 6; ++i) {
        *hash = float_hash(*hash, numbers[i]);
    }
    return result;
}

/* Fills what depends on the source; `hash` is continued with what was read or made. */
static lmb_result source_take(const lmb_environment_description *described, lmb_environment *environment,
                              lmb_environment_sun *sun, uint64_t *hash, lmb_error *error)
{
    environment->present = true;
    if (!described->source) {
        const lmb_result result = daylight_make(described, environment, sun, hash);
        return result == LMB_OK ? LMB_OK : lmb_error_set(error, result, "environment: no memory");
    }
    if (described->source[0] == '#') {
        constant_set(described->source, environment, hash);
        return LMB_OK;
    }
    const int function = lmb_sky_basis_find(described->source);
    if (function >= 0) {
        *hash = lmb_hash(*hash, described->source, strlen(described->source));
        const lmb_result result = lmb_environment_sky_basis(function, environment);
        return result == LMB_OK ? LMB_OK : lmb_error_set(error, result, "environment: no memory");
    }
    return picture_read(described->source, environment, hash, error);
}

/* Puts the environment in the place of the one before, whose sun was the scene's last light if it had one. */
static lmb_result environment_replace(lmb_scene *scene, lmb_environment *environment, const lmb_environment_sun *sun)
{
    if (lmb_rgb_max(sun->irradiance) > 0.0f) {
        const lmb_result result = lmb_scene_add_sun(scene, sun);
        if (result != LMB_OK) {
            return result;
        }
        scene->lights[scene->light_count - 1].set = environment->set;
        environment->has_sun = true;
    }
    if (scene->environment.has_sun) {
        const uint32_t old = scene->light_count - 1 - environment->has_sun;
        free(scene->lights[old].name);
        scene->lights[old] = scene->lights[scene->light_count - 1];
        --scene->light_count;
    }
    lmb_image_free(&scene->environment.image);
    free(scene->environment.taken);
    scene->environment = *environment;
    return LMB_OK;
}

lmb_result lmb_scene_set_environment(lmb_scene *scene, const char *text, lmb_error *error)
{
    assert(scene && text);
    lmb_environment_description described;
    lmb_result result = lmb_environment_describe(text, &described, error);
    if (result != LMB_OK) {
        return result;
    }
    lmb_environment environment = {.rotation_rad = described.rotation_rad, .strength = described.strength};
    if (described.set[0] != '\0' && lmb_scene_light_set(scene, described.set, &environment.set) != LMB_OK) {
        lmb_environment_description_free(&described);
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' names no set of lights, or there are too many",
                             described.set);
    }
    lmb_environment_sun sun = {.count = 0};
    uint64_t hash = scene->content_hash;
    if (!described.source || strcmp(described.source, "none") != 0) {
        result = source_take(&described, &environment, &sun, &hash, error);
        hash = float_hash(float_hash(hash, described.rotation_rad), described.strength);
    }
    lmb_environment_description_free(&described);
    if (result != LMB_OK) {
        return result;
    }
    if (environment_replace(scene, &environment, &sun) != LMB_OK) {
        lmb_image_free(&environment.image);
        free(environment.taken);
        return lmb_error_set(error, LMB_ERROR_MEMORY, "environment: no memory");
    }
    scene->content_hash = hash;
    return LMB_OK;
}
