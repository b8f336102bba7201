/* Every option of a bake, as the command line gives them and as bake.json keeps them. */
#ifndef LMB_TOOLS_BAKE_SETTINGS_H
#define LMB_TOOLS_BAKE_SETTINGS_H

#include <cjson/cJSON.h>

#include <lambent/lightmap.h>
#include <lambent/placement.h>

#include "level.h"

enum { BAKE_MAX_SEEDS = 64 };

typedef struct lmb_bake_settings {
    lmb_level_arguments level;
    const char *directory;
    lmb_placement_settings placement;
    lmb_vec3 seeds[BAKE_MAX_SEEDS];
    uint32_t samples; /* at each probe and texel */
    lmb_estimator estimator;
    bool lightmaps;
    float texels_per_m; /* 0: lmb_lightmap_settings_default */
    bool dry_run;
    bool json_progress;
} lmb_bake_settings;

/* The settings as JSON, with the level's content hash; what does not change bytes (threads, progress) is left out.
 * `spacing` and `lightmap` (NULL: none) are what was used in the end. */
cJSON *bake_settings_json(const lmb_bake_settings *settings, const lmb_level *level, float spacing,
                          const lmb_lightmap_settings *lightmap);

/* The level options that a bake was made with, from bake.json's `settings`. Strings point into `json`.
 * False when the settings are not those of a bake. */
bool bake_settings_level(const cJSON *json, lmb_level_arguments *level);

/* Hexadecimal text of a hash; 17 bytes. */
void hash_text(uint64_t hash, char text[17]);

#endif
