/* Whether a folder holds the very bake that is asked for. */
#ifndef LMB_BAKE_CURRENT_H
#define LMB_BAKE_CURRENT_H

#include <stdbool.h>
#include <stdint.h>

#include <cjson/cJSON.h>

/* FNV-1a hashes of files in a folder, a list of names, by these names; NULL when out of memory, or one cannot be read.
 */
cJSON *lmb_bake_hashes(const char *directory, const cJSON *files);

/* Whether its bake.json has that key, and its files the hashes that are there. */
bool lmb_bake_is_current(const char *directory, uint64_t key);

#endif
