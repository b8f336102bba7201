#include "image/image_internal.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>
#include <lambent/environment.h>
#include <lambent/light_sets.h>
#include <lambent/texture.h>

#include "base/hex_digit.h"

static const double RAD_PER_DEG = 0.017453292519943295769;

/* What a description says, apart from the pixels. */
typedef struct description {
    char *source; /* path, #rrggbb or none */
    float rotation_rad;
    float strength;
    char set[LMB_LIGHT_SET_NAME]; /* of lights; empty: none is named */
} description;

static bool number_parse(const char *text, double *value)
{
    char *end = NULL;
    if (*text == '\0' || strspn(text, "+-.0123456789eE") != strlen(text)) {
        return false; /* strtod would take hexadecimal, infinity and leading blanks */
    }
    *value = strtod(text, &end);
    return *end == '\0' && isfinite(*value);
}

static lmb_result set_parse(const char *name, description *parsed, lmb_error *error)
{
    if (strlen(name) >= sizeof parsed->set) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' is too long a name of a set of lights", name);
    }
    strcpy(parsed->set, name);
    return LMB_OK;
}

/* Takes "name=value", which is NUL-terminated. `seen` has a bit for each option met so far. */
static lmb_result option_parse(const char *option, description *parsed, unsigned *seen, lmb_error *error)
{
    const bool rotation = strncmp(option, "rotation=", 9) == 0;
    const bool strength = strncmp(option, "strength=", 9) == 0;
    const bool set = strncmp(option, "set=", 4) == 0;
    const unsigned bit = rotation ? 1U : strength ? 2U : 4U;
    double value = 0.0;
    if (!rotation && !strength && !set) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: unknown option '%s' (rotation=, strength= or set=)",
                             option);
    }
    if (*seen & bit) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: option '%s' comes twice", option);
    }
    *seen |= bit;
    if (set) {
        return set_parse(option + 4, parsed, error);
    }
    if (!number_parse(option + 9, &value) || fabs(value) > 1e30 || (strength && value < 0.0)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' is no %s", option,
                             rotation ? "angle in degrees" : "number from 0 up");
    }
    if (rotation) {
        parsed->rotation_rad = (float)(fmod(value, 360.0) * RAD_PER_DEG + 0.0);
    } else {
        parsed->strength = (float)value;
    }
    return LMB_OK;
}

/* The last ",name=value" of the text, or NULL. Only lower-case names count, so that most paths may have commas. */
static char *option_find_last(char *text)
{
    char *const comma = strrchr(text, ',');
    if (!comma) {
        return NULL;
    }
    const size_t name_length = strspn(comma + 1, "abcdefghijklmnopqrstuvwxyz");
    return name_length > 0 && comma[1 + name_length] == '=' ? comma : NULL;
}

static lmb_result description_parse(const char *text, description *parsed, lmb_error *error)
{
    unsigned seen = 0;
    *parsed = (description){malloc(strlen(text) + 1), 0.0f, 1.0f, ""};
    if (!parsed->source) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "environment: no memory");
    }
    strcpy(parsed->source, text);
    lmb_result result = LMB_OK;
    for (char *option = option_find_last(parsed->source); option && result == LMB_OK;
         option = option_find_last(parsed->source)) {
        *option = '\0';
        result = option_parse(option + 1, parsed, &seen, error);
    }
    if (result == LMB_OK && parsed->source[0] == '\0') {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' names no picture or colour", text);
    }
    if (result != LMB_OK) {
        free(parsed->source);
        parsed->source = NULL;
    }
    return result;
}

static lmb_result colour_parse(const char *text, unsigned char bytes[3], lmb_error *error)
{
    bool good = strlen(text) == 7;
    for (int c = 0; c < 3 && good; ++c) {
        const int high = lmb_hex_digit(text[1 + 2 * c]);
        const int low = lmb_hex_digit(text[2 + 2 * c]);
        good = high >= 0 && low >= 0;
        bytes[c] = good ? (unsigned char)(16 * high + low) : 0;
    }
    return good ? LMB_OK : lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' is not #rrggbb", text);
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

/* Fills what depends on the source; `hash` is continued with what was read. */
static lmb_result source_read(const char *source, lmb_environment *environment, uint64_t *hash, lmb_error *error)
{
    environment->present = true;
    if (source[0] == '#') {
        unsigned char bytes[3];
        const lmb_result result = colour_parse(source, bytes, error);
        for (int c = 0; c < 3 && result == LMB_OK; ++c) {
            environment->constant.c[c] = lmb_srgb_to_linear(bytes[c]);
        }
        *hash = result == LMB_OK ? lmb_hash(*hash, bytes, sizeof bytes) : *hash;
        return result;
    }
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

lmb_result lmb_scene_set_environment(lmb_scene *scene, const char *text, lmb_error *error)
{
    assert(scene && text);
    description parsed;
    lmb_result result = description_parse(text, &parsed, error);
    if (result != LMB_OK) {
        return result;
    }
    lmb_environment environment = {.rotation_rad = parsed.rotation_rad, .strength = parsed.strength};
    if (parsed.set[0] != '\0' && lmb_scene_light_set(scene, parsed.set, &environment.set) != LMB_OK) {
        free(parsed.source);
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' names no set of lights, or there are too many",
                             parsed.set);
    }
    uint64_t hash = scene->content_hash;
    if (strcmp(parsed.source, "none") != 0) {
        result = source_read(parsed.source, &environment, &hash, error);
        hash = float_hash(float_hash(hash, parsed.rotation_rad), parsed.strength);
    }
    free(parsed.source);
    if (result == LMB_OK) {
        lmb_image_free(&scene->environment.image);
        free(scene->environment.taken);
        scene->environment = environment;
        scene->content_hash = hash;
    }
    return result;
}
