#include "bake_settings.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "command.h"
#include "query.h"

enum { MIN_SAMPLES = 64 };

typedef struct bake_quality {
    const char *name;
    double tolerance;
    uint32_t max_samples;
} bake_quality;

static const bake_quality qualities[] = {{"draft", 0.12, 256}, {"medium", 0.06, 1024}, {"high", 0.03, 4096}};

static void quality_use(lmb_bake_settings *settings, const bake_quality *quality)
{
    settings->samples = MIN_SAMPLES;
    settings->max_samples = quality->max_samples;
    settings->tolerance = quality->tolerance;
}

lmb_bake_settings bake_settings_default(void)
{
    lmb_bake_settings settings = {.level = {.options = level_options_default()},
                                  .placement = lmb_placement_settings_default()};
    quality_use(&settings, &qualities[1]);
    return settings;
}

bool bake_settings_quality(lmb_bake_settings *settings, const char *name)
{
    for (size_t i = 0; i < sizeof qualities / sizeof qualities[0]; ++i) {
        if (strcmp(name, qualities[i].name) == 0) {
            quality_use(settings, &qualities[i]);
            return true;
        }
    }
    return false;
}

static void quality_set(lmb_bake_settings *settings, lmb_arguments *arguments, const char *name)
{
    if (!bake_settings_quality(settings, name)) {
        arguments_error(arguments, "--quality takes draft, medium or high, not", name);
    }
}

static void seed_point_add(lmb_bake_settings *settings, lmb_arguments *arguments, const char *option)
{
    if (settings->placement.seed_count == BAKE_MAX_SEEDS) {
        arguments_error(arguments, "too many", option);
        return;
    }
    settings->seeds[settings->placement.seed_count++] = arguments_place(arguments, option);
    settings->placement.seeds = settings->seeds;
}

bool bake_settings_argument(lmb_bake_settings *settings, lmb_arguments *arguments, const char *argument)
{
    if (level_argument(&settings->level, arguments, argument) ||
        estimator_argument(&settings->estimator, arguments, argument)) {
        return true;
    }
    if (strcmp(argument, "--spacing") == 0) {
        settings->placement.spacing = (float)arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--max-probes") == 0) {
        settings->placement.max_probes = (int32_t)arguments_integer(arguments, argument, 27, 1 << 28);
    } else if (strcmp(argument, "--seed-point") == 0) {
        seed_point_add(settings, arguments, argument);
    } else if (strcmp(argument, "--quality") == 0) {
        quality_set(settings, arguments, arguments_text(arguments, argument));
    } else if (strcmp(argument, "--samples") == 0) {
        settings->samples = (uint32_t)arguments_integer(arguments, argument, 1, 1 << 28);
        settings->max_samples = settings->samples;
    } else if (strcmp(argument, "--tolerance") == 0) {
        settings->tolerance = arguments_number(arguments, argument, 1e-6, 1.0);
    } else if (strcmp(argument, "--texels-per-m") == 0) {
        settings->texels_per_m = (float)arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--padding") == 0) {
        settings->padding = (int32_t)arguments_integer(arguments, argument, 1, LMB_LIGHTMAP_MAX_PADDING);
    } else if (argument[0] != '-' && !settings->level.options.path) {
        settings->level.options.path = argument;
    } else {
        return false;
    }
    return true;
}

void hash_text(uint64_t hash, char text[17])
{
    snprintf(text, 17, "%016" PRIx64, hash);
}

static cJSON *text_or_null(const char *text)
{
    return text ? cJSON_CreateString(text) : cJSON_CreateNull();
}

cJSON *bake_settings_json(const lmb_bake_settings *settings, const lmb_level *level, float spacing,
                          const lmb_lightmap_settings *lightmap)
{
    const lmb_level_options *options = &settings->level.options;
    char hash[17];
    hash_text(level->scene->content_hash, hash);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "level", options->path);
    cJSON_AddItemToObject(json, "env", text_or_null(options->environment));
    cJSON_AddStringToObject(json, "content_hash", hash);
    cJSON *exclude = cJSON_AddArrayToObject(json, "exclude");
    for (size_t i = 0; i < options->gltf.exclude_count; ++i) {
        cJSON_AddItemToArray(exclude, cJSON_CreateString(options->gltf.exclude[i]));
    }
    cJSON_AddNumberToObject(json, "light_scale", options->gltf.light_scale);
    cJSON_AddNumberToObject(json, "emission_scale", options->gltf.emission_scale);
    cJSON_AddBoolToObject(json, "allow_outside_uris", options->gltf.allow_outside_uris);
    cJSON_AddItemToObject(json, "isa", text_or_null(options->isa));
    cJSON_AddNumberToObject(json, "bounces", options->bounces);
    cJSON_AddNumberToObject(json, "seed", (double)options->seed);
    cJSON_AddNumberToObject(json, "samples", settings->samples);
    cJSON_AddNumberToObject(json, "max_samples", settings->max_samples);
    cJSON_AddNumberToObject(json, "tolerance", settings->tolerance);
    cJSON_AddStringToObject(json, "estimator", estimator_name(settings->estimator));
    cJSON_AddNumberToObject(json, "spacing", (double)spacing);
    cJSON_AddNumberToObject(json, "max_probes", settings->placement.max_probes);
    cJSON *seeds = cJSON_AddArrayToObject(json, "seed_points");
    for (uint32_t i = 0; i < settings->placement.seed_count; ++i) {
        /* As it was used: rounded to where floats are. */
        const lmb_vec3 used = lmb_scene_from_world(level->scene, settings->seeds[i]);
        cJSON_AddItemToArray(seeds, json_place(lmb_scene_to_world(level->scene, used)));
    }
    cJSON_AddBoolToObject(json, "lightmaps", lightmap != NULL);
    if (lightmap) {
        cJSON_AddNumberToObject(json, "texels_per_m", (double)lightmap->texels_per_m);
        cJSON_AddNumberToObject(json, "max_image_size", lightmap->max_image_size);
        if (lightmap->padding != 1) { /* what a record without it has */
            cJSON_AddNumberToObject(json, "padding", lightmap->padding);
        }
    }
    return json;
}

static const char *text_of(const cJSON *json, const char *key)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);
    return cJSON_IsString(item) ? item->valuestring : NULL;
}

static double number_or(const cJSON *json, const char *key, double missing)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);
    return cJSON_IsNumber(item) ? item->valuedouble : missing;
}

bool bake_settings_level(const cJSON *json, lmb_level_arguments *level)
{
    *level = (lmb_level_arguments){.options = level_options_default()};
    lmb_level_options *options = &level->options;
    options->path = text_of(json, "level");
    options->environment = text_of(json, "env");
    options->isa = text_of(json, "isa");
    options->gltf.allow_outside_uris = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "allow_outside_uris"));
    options->gltf.light_scale = number_or(json, "light_scale", options->gltf.light_scale);
    options->gltf.emission_scale = number_or(json, "emission_scale", options->gltf.emission_scale);
    const cJSON *bounces = cJSON_GetObjectItemCaseSensitive(json, "bounces");
    if (cJSON_IsNumber(bounces)) {
        options->bounces = bounces->valueint;
    }
    const cJSON *pattern;
    cJSON_ArrayForEach(pattern, cJSON_GetObjectItemCaseSensitive(json, "exclude"))
    {
        if (!cJSON_IsString(pattern) || options->gltf.exclude_count == LEVEL_MAX_EXCLUDE) {
            return false;
        }
        level->exclude[options->gltf.exclude_count++] = pattern->valuestring;
    }
    options->gltf.exclude = level->exclude;
    return options->path && text_of(json, "content_hash") && cJSON_IsNumber(bounces);
}
