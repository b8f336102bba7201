#ifndef LMB_BAKE_SETTINGS_INTERNAL_H
#define LMB_BAKE_SETTINGS_INTERNAL_H

#include <cjson/cJSON.h>

#include <lambent/bake_settings.h>

/* Hexadecimal text of a hash; 17 bytes. */
void lmb_bake_settings_hash_text(uint64_t hash, char text[17]);

/* The settings of a bake as its record keeps them (docs/baking.md), with the level's content hash; what does not change
 * bytes (threads) is left out. They must be complete: what is 0 for "the level's own" is set. NULL: out of memory. */
cJSON *lmb_bake_settings_json(const lmb_bake_settings *settings, uint64_t content_hash);

/* The inverse; what is missing keeps its default. Strings of `*settings` lie in `json`.
 * False when the settings are not those of a bake. */
bool lmb_bake_settings_read(const cJSON *json, lmb_bake_settings *settings);

#endif
