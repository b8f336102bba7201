#include "bake_settings.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

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
    cJSON_AddBoolToObject(json, "allow_outside_uris", options->gltf.allow_outside_uris);
    cJSON_AddItemToObject(json, "isa", text_or_null(options->isa));
    cJSON_AddNumberToObject(json, "bounces", options->bounces);
    cJSON_AddNumberToObject(json, "seed", (double)options->seed);
    cJSON_AddNumberToObject(json, "samples", settings->samples);
    cJSON_AddStringToObject(json, "estimator", estimator_name(settings->estimator));
    cJSON_AddNumberToObject(json, "spacing", (double)spacing);
    cJSON_AddNumberToObject(json, "max_probes", settings->placement.max_probes);
    cJSON *seeds = cJSON_AddArrayToObject(json, "seed_points");
    for (uint32_t i = 0; i < settings->placement.seed_count; ++i) {
        const lmb_vec3 seed = settings->seeds[i];
        cJSON_AddItemToArray(seeds, cJSON_CreateFloatArray((const float[3]){seed.x, seed.y, seed.z}, 3));
    }
    cJSON_AddBoolToObject(json, "lightmaps", lightmap != NULL);
    if (lightmap) {
        cJSON_AddNumberToObject(json, "texels_per_m", (double)lightmap->texels_per_m);
        cJSON_AddNumberToObject(json, "max_image_size", lightmap->max_image_size);
    }
    return json;
}

static const char *text_of(const cJSON *json, const char *key)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);
    return cJSON_IsString(item) ? item->valuestring : NULL;
}

bool bake_settings_level(const cJSON *json, lmb_level_arguments *level)
{
    *level = (lmb_level_arguments){.options = level_options_default()};
    lmb_level_options *options = &level->options;
    options->path = text_of(json, "level");
    options->environment = text_of(json, "env");
    options->isa = text_of(json, "isa");
    options->gltf.allow_outside_uris = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "allow_outside_uris"));
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
