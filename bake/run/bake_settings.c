#include "run/bake_settings_internal.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include <lambent/placement.h>

enum { MIN_SAMPLES = 64 };
#define INTERPOLATION_TOLERANCE 0.05

typedef struct bake_quality {
    const char *name;
    double noise;
    uint32_t max_samples;
    float detail;
} bake_quality;

static const bake_quality qualities[] = {
    {"draft", 0.12, 256, 0.5f}, {"medium", 0.06, 1024, 1.0f}, {"high", 0.03, 4096, 1.0f}};

static void quality_use(lmb_bake_settings *settings, const bake_quality *quality)
{
    settings->samples = MIN_SAMPLES;
    settings->max_samples = quality->max_samples;
    settings->noise = quality->noise;
    settings->detail = quality->detail;
}

lmb_bake_settings lmb_bake_settings_default(void)
{
    lmb_bake_settings settings = {.level = lmb_level_settings_default(),
                                  .tolerance = INTERPOLATION_TOLERANCE,
                                  .max_probes = lmb_placement_settings_default().max_probes,
                                  .denoise = true};
    quality_use(&settings, &qualities[1]);
    return settings;
}

bool lmb_bake_settings_quality(lmb_bake_settings *settings, const char *name)
{
    for (size_t i = 0; i < sizeof qualities / sizeof qualities[0]; ++i) {
        if (strcmp(name, qualities[i].name) == 0) {
            quality_use(settings, &qualities[i]);
            return true;
        }
    }
    return false;
}

void lmb_bake_settings_hash_text(uint64_t hash, char text[17])
{
    snprintf(text, 17, "%016" PRIx64, hash);
}

static cJSON *text_or_null(const char *text)
{
    return text ? cJSON_CreateString(text) : cJSON_CreateNull();
}

static void json_add_level(cJSON *json, const lmb_level_settings *level, uint64_t content_hash)
{
    char hash[17];
    lmb_bake_settings_hash_text(content_hash, hash);
    cJSON_AddStringToObject(json, "level", level->path);
    cJSON_AddItemToObject(json, "env", text_or_null(level->environment));
    cJSON_AddStringToObject(json, "content_hash", hash);
    cJSON *exclude = cJSON_AddArrayToObject(json, "exclude");
    for (uint32_t i = 0; i < level->exclude_count; ++i) {
        cJSON_AddItemToArray(exclude, cJSON_CreateString(level->exclude[i]));
    }
    cJSON_AddNumberToObject(json, "light_scale", level->light_scale);
    cJSON_AddNumberToObject(json, "emission_scale", level->emission_scale);
    cJSON_AddBoolToObject(json, "allow_outside_uris", level->allow_outside_uris);
    cJSON_AddItemToObject(json, "isa", text_or_null(level->isa));
    cJSON_AddNumberToObject(json, "bounces", level->bounces);
    cJSON_AddNumberToObject(json, "seed", (double)level->seed);
    if (level->light_set) {
        cJSON_AddStringToObject(json, "light_set", level->light_set);
    }
    if (level->key_lights != 0) { /* what a record without it has */
        cJSON_AddNumberToObject(json, "key_lights", level->key_lights);
    }
}

const lmb_model *lmb_bake_settings_model(const lmb_bake_settings *settings)
{
    return lmb_model_default(settings->lightmap_format == LMB_LIGHTMAP_EXR ? LMB_MODEL_FOR_LIGHTMAP
                                                                           : LMB_MODEL_FOR_TEXTURE);
}

/* The default model first; nothing where there is no other. */
static void json_add_models(cJSON *json, const lmb_bake_settings *settings)
{
    if (settings->models[0]) {
        cJSON *models = cJSON_AddArrayToObject(json, "models");
        cJSON_AddItemToArray(models, cJSON_CreateString(lmb_bake_settings_model(settings)->name));
        for (int i = 0; i < LMB_LIGHTMAP_MOST_MODELS && settings->models[i]; ++i) {
            cJSON_AddItemToArray(models, cJSON_CreateString(settings->models[i]->name));
        }
    }
}

cJSON *lmb_bake_settings_json(const lmb_bake_settings *settings, uint64_t content_hash)
{
    cJSON *json = cJSON_CreateObject();
    json_add_level(json, &settings->level, content_hash);
    cJSON_AddNumberToObject(json, "samples", settings->samples);
    cJSON_AddNumberToObject(json, "max_samples", settings->max_samples);
    cJSON_AddNumberToObject(json, "noise", settings->noise);
    cJSON_AddStringToObject(json, "estimator", lmb_estimator_name(settings->estimator));
    cJSON_AddNumberToObject(json, "spacing", (double)settings->spacing);
    if (settings->min_spacing > 0.0f) { /* what a record without them has: one even level */
        cJSON_AddNumberToObject(json, "min_spacing", (double)settings->min_spacing);
        cJSON_AddNumberToObject(json, "tolerance", settings->tolerance);
    }
    if (settings->placed_by_all) {
        cJSON_AddTrueToObject(json, "placed_by_all");
    }
    cJSON_AddNumberToObject(json, "max_probes", settings->max_probes);
    cJSON *seeds = cJSON_AddArrayToObject(json, "seed_points");
    for (uint32_t i = 0; i < settings->seed_count; ++i) {
        const lmb_vec3d *seed = &settings->seeds[i];
        cJSON_AddItemToArray(seeds, cJSON_CreateDoubleArray((const double[3]){seed->x, seed->y, seed->z}, 3));
    }
    if (settings->no_probes) {
        cJSON_AddFalseToObject(json, "probes");
    }
    if (settings->compact) {
        cJSON_AddTrueToObject(json, "compact");
    }
    if (settings->tile_size > 0.0) {
        cJSON_AddNumberToObject(json, "tile_size", settings->tile_size);
    }
    cJSON_AddBoolToObject(json, "lightmaps", settings->lightmaps);
    if (settings->lightmaps) {
        cJSON_AddNumberToObject(json, "texels_per_m", (double)settings->texels_per_m);
        cJSON_AddNumberToObject(json, "max_image_size", settings->max_image_size);
        if (settings->padding != 1) { /* what a record without it has */
            cJSON_AddNumberToObject(json, "padding", settings->padding);
        }
        if (settings->lightmap_format != LMB_LIGHTMAP_EXR) {
            cJSON_AddStringToObject(json, "lightmap_format", lmb_lightmap_format_name(settings->lightmap_format));
        }
        json_add_models(json, settings);
        if (settings->texel_error) {
            cJSON_AddTrueToObject(json, "texel_error");
        }
    }
    cJSON_AddBoolToObject(json, "denoise", settings->denoise);
    const bool is_open = settings->spacing <= 0.0f || (settings->lightmaps && settings->texels_per_m <= 0.0f);
    if (is_open && settings->detail > 0.0f && settings->detail != 1.0f) { /* what a record of a bake never has */
        cJSON_AddNumberToObject(json, "detail", (double)settings->detail);
    }
    return json;
}

static const char *text_of(const cJSON *json, const char *key)
{
    return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, key));
}

static double number_or(const cJSON *json, const char *key, double missing)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);
    return cJSON_IsNumber(item) ? item->valuedouble : missing;
}

/* Whole numbers outside the range are at its end. */
static int32_t integer_or(const cJSON *json, const char *key, int32_t missing)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);
    return cJSON_IsNumber(item) ? item->valueint : missing;
}

static uint32_t count_or(const cJSON *json, const char *key, uint32_t missing)
{
    const int32_t count = integer_or(json, key, -1);
    return count >= 0 ? (uint32_t)count : missing;
}

static uint64_t seed_of(const cJSON *json)
{
    const double seed = number_or(json, "seed", 0.0);
    return seed >= 0.0 && seed < 0x1p63 ? (uint64_t)seed : 0;
}

static bool exclude_read(const cJSON *json, lmb_level_settings *level)
{
    const cJSON *pattern;
    cJSON_ArrayForEach(pattern, cJSON_GetObjectItemCaseSensitive(json, "exclude"))
    {
        if (!cJSON_IsString(pattern) || level->exclude_count == LMB_LEVEL_MAX_EXCLUDE) {
            return false;
        }
        level->exclude[level->exclude_count++] = pattern->valuestring;
    }
    return true;
}

static bool level_read(const cJSON *json, lmb_level_settings *level)
{
    level->path = text_of(json, "level");
    level->environment = text_of(json, "env");
    level->isa = text_of(json, "isa");
    level->light_set = text_of(json, "light_set");
    level->allow_outside_uris = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "allow_outside_uris"));
    level->light_scale = number_or(json, "light_scale", level->light_scale);
    level->emission_scale = number_or(json, "emission_scale", level->emission_scale);
    level->bounces = integer_or(json, "bounces", level->bounces);
    level->seed = seed_of(json);
    level->key_lights = count_or(json, "key_lights", 0);
    return level->path && text_of(json, "content_hash") &&
           cJSON_IsNumber(cJSON_GetObjectItemCaseSensitive(json, "bounces")) &&
           level->key_lights <= LMB_KEY_LIGHTS_MOST && exclude_read(json, level);
}

static bool seeds_read(const cJSON *json, lmb_bake_settings *settings)
{
    const cJSON *seed;
    cJSON_ArrayForEach(seed, cJSON_GetObjectItemCaseSensitive(json, "seed_points"))
    {
        double place[3];
        if (cJSON_GetArraySize(seed) != 3 || settings->seed_count == LMB_BAKE_MAX_SEEDS) {
            return false;
        }
        for (int axis = 0; axis < 3; ++axis) {
            place[axis] = cJSON_GetNumberValue(cJSON_GetArrayItem(seed, axis));
        }
        settings->seeds[settings->seed_count++] = (lmb_vec3d){place[0], place[1], place[2]};
    }
    return true;
}

bool lmb_bake_settings_add_model(lmb_bake_settings *settings, const char *name)
{
    const lmb_model *model = lmb_model_for_lightmap(name);
    if (!model) {
        return false;
    }
    int count = 0;
    while (count < LMB_LIGHTMAP_MOST_MODELS && settings->models[count] && settings->models[count] != model) {
        ++count;
    }
    if (model != lmb_bake_settings_model(settings) && count < LMB_LIGHTMAP_MOST_MODELS) {
        settings->models[count] = model;
    }
    return count < LMB_LIGHTMAP_MOST_MODELS;
}

/* Takes the model that the format brings out of the others. */
static void models_trim(lmb_bake_settings *settings)
{
    int kept = 0;
    for (int i = 0; i < LMB_LIGHTMAP_MOST_MODELS; ++i) {
        const lmb_model *model = settings->models[i];
        settings->models[i] = NULL;
        if (model && model != lmb_bake_settings_model(settings)) {
            settings->models[kept++] = model;
        }
    }
}

bool lmb_bake_settings_lightmap_format(lmb_bake_settings *settings, const char *name)
{
    for (int i = 0; i < LMB_LIGHTMAP_FORMATS; ++i) {
        if (strcmp(name, lmb_lightmap_format_name((lmb_lightmap_format)i)) == 0) {
            settings->lightmap_format = (lmb_lightmap_format)i;
            models_trim(settings);
            return true;
        }
    }
    return false;
}

static bool models_read(const cJSON *json, lmb_bake_settings *settings)
{
    const cJSON *name;
    cJSON_ArrayForEach(name, cJSON_GetObjectItemCaseSensitive(json, "models"))
    {
        if (!cJSON_IsString(name) || !lmb_bake_settings_add_model(settings, name->valuestring)) {
            return false;
        }
    }
    return true;
}

bool lmb_bake_settings_read(const cJSON *json, lmb_bake_settings *settings)
{
    lmb_bake_settings read = lmb_bake_settings_default();
    const char *format = text_of(json, "lightmap_format");
    if ((format && !lmb_bake_settings_lightmap_format(&read, format)) || !level_read(json, &read.level) ||
        !seeds_read(json, &read) || !models_read(json, &read)) {
        return false;
    }
    const char *estimator = text_of(json, "estimator");
    read.estimator = LMB_ESTIMATOR_CACHED;
    if (estimator && !lmb_estimator_find(estimator, &read.estimator)) {
        return false;
    }
    read.spacing = (float)number_or(json, "spacing", 0.0);
    read.max_probes = integer_or(json, "max_probes", read.max_probes);
    read.samples = count_or(json, "samples", read.samples);
    read.max_samples = count_or(json, "max_samples", read.max_samples);
    read.noise = number_or(json, "noise", read.noise);
    read.min_spacing = (float)number_or(json, "min_spacing", 0.0);
    read.tolerance = number_or(json, "tolerance", read.tolerance);
    read.placed_by_all = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "placed_by_all"));
    read.no_probes = cJSON_IsFalse(cJSON_GetObjectItemCaseSensitive(json, "probes"));
    read.compact = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "compact"));
    read.tile_size = number_or(json, "tile_size", 0.0);
    read.lightmaps = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "lightmaps"));
    read.texels_per_m = (float)number_or(json, "texels_per_m", 0.0);
    read.max_image_size = integer_or(json, "max_image_size", 0);
    read.padding = integer_or(json, "padding", 1);
    read.texel_error = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "texel_error"));
    read.detail = (float)number_or(json, "detail", 1.0);
    read.denoise = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "denoise"));
    *settings = read;
    return true;
}
