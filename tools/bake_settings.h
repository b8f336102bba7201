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
    lmb_vec3d seeds[BAKE_MAX_SEEDS];
    uint32_t samples; /* at each probe and texel; at least, if max_samples is more */
    uint32_t max_samples;
    double tolerance; /* relative standard error that ends an element's sampling */
    lmb_estimator estimator;
    bool lightmaps;
    float texels_per_m; /* 0: lmb_lightmap_settings_default */
    int32_t padding;    /* 0: likewise */
    bool dry_run;
    bool json_progress;
} lmb_bake_settings;

/* Medium quality, no lightmaps, the level's own spacing and density; no level. */
lmb_bake_settings bake_settings_default(void);

/* Samples and tolerance of draft, medium or high; false for any other name. */
bool bake_settings_quality(lmb_bake_settings *settings, const char *name);

/* Takes `argument` when it is the level, one of level_argument's options, or one of those of BAKE_USAGE: what decides
 * what a bake makes. */
bool bake_settings_argument(lmb_bake_settings *settings, struct lmb_arguments *arguments, const char *argument);
#define BAKE_USAGE                                                                                                     \
    "  --spacing M           metres between probes (default: from the level's size)\n"                                 \
    "  --max-probes N        the spacing grows until there are no more (default 262144)\n"                             \
    "  --seed-point X,Y,Z    bake only free space connected to this point (repeatable)\n"                              \
    "  --texels-per-m N      lightmap density (default: from the level's size)\n"                                      \
    "  --padding N           texels filled around lightmap charts and nodes, for mip levels (default 1)\n"             \
    "  --quality NAME        draft, medium or high: noise of 12, 6 or 3 %, by at most 256, 1024 or\n"                  \
    "                        4096 samples at each probe and texel (default medium)\n"                                  \
    "  --tolerance E         the noise as a share of the light, in place of the quality's\n"                           \
    "  --samples N           just so many samples everywhere, in place of both\n"                                      \
    "  --estimator NAME      cached: solve the light on surfaces first, then gather it (default);\n"                   \
    "                        reference: trace every path to its end, unbiased and slower\n"

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
