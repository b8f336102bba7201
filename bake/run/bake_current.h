/* Whether a folder holds the very bake that is asked for. */
#ifndef LMB_BAKE_CURRENT_H
#define LMB_BAKE_CURRENT_H

#include <stdbool.h>
#include <stdint.h>

#include <cjson/cJSON.h>

#include <lambent/bake_record.h>

/* FNV-1a hashes of files in a folder, a list of names, by these names; NULL when out of memory, or one cannot be read.
 */
cJSON *lmb_bake_hashes(const char *directory, const cJSON *files);

/* Whether its bake.json has that key, and its files the hashes that are there. `kept`: there has to be what was
 * gathered, too. */
bool lmb_bake_is_current(const char *directory, uint64_t key, bool kept);

/* Which parts of the level have changed since the folder's bake of it, by their names: "materials, lights". Empty:
 * none, or it holds no bake of a level of that path. */
void lmb_bake_changes(const char *directory, const lmb_bake_record *record, char *text, size_t size);

#endif
