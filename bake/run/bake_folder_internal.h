/* How a bake writes into its folder. */
#ifndef LMB_BAKE_FOLDER_INTERNAL_H
#define LMB_BAKE_FOLDER_INTERNAL_H

#include <cjson/cJSON.h>

#include <lambent/bake_folder.h>

/* Whether the folder was opened for lightmaps. */
bool lmb_bake_folder_lightmaps(const lmb_bake_folder *folder);

/* As it was given. */
const char *lmb_bake_folder_directory(const lmb_bake_folder *folder);

/* Removes what a bake that did not finish has gathered. */
void lmb_bake_folder_drop_parts(const lmb_bake_folder *folder);

/* Makes the empty folder to write the new files into, under the names that they are to have: probes.lmb, probes.vdb,
 * what is kept of gathering (run/kept.h), lightmap/..., bake.json. It may be asked for again. `*path` lives as long as
 * the folder. */
lmb_result lmb_bake_folder_stage(lmb_bake_folder *folder, const char **path, lmb_error *error);

/* Names of what lies there, but for bake.json: in order, relative to the folder. NULL when out of memory. */
cJSON *lmb_bake_folder_files(const lmb_bake_folder *folder);

/* Moves the new files to their places, bake.json last, and removes those that an earlier bake's `files` names and this
 * one does not have; other files stay. On failure all is as it was. */
lmb_result lmb_bake_folder_commit(lmb_bake_folder *folder, lmb_error *error);

/* Completes the line of an error in writing: under the name that the file was to have, and with what is there now.
 * `error` may be NULL. */
void lmb_bake_folder_explain(const lmb_bake_folder *folder, lmb_error *error);

#endif
