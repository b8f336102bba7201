/* A bake's folder, which holds the old bake or the new one.
 *
 *     DIR/.lambent-lock       while a bake is at work; the kernel gives it up with the process
 *     DIR/.lambent-new/...    what it has written so far
 *     DIR/.lambent-old/...    what that replaces, while it moves in
 *
 * A folder that has a bake.json holds the whole bake that it describes, at any moment. */
#ifndef LMB_TOOLS_OUTPUT_FOLDER_H
#define LMB_TOOLS_OUTPUT_FOLDER_H

#include <stdbool.h>

#include <cjson/cJSON.h>

#include <lambent/error.h>

typedef struct lmb_output_folder lmb_output_folder;

/* Makes `directory` where it is missing, takes its lock, and sees that a bake (with lightmaps, if so) can be written
 * there. An interruption leaves the folder as it was. @return LMB_ERROR_WRITE (also when another bake has the lock),
 * _MEMORY */
lmb_result output_folder_open(const char *directory, bool lightmaps, lmb_output_folder **folder, lmb_error *error);

/* Makes the empty folder to write the new files into, under the names that they are to have: probes.lmb, probes.vdb,
 * lightmap/..., bake.json. `*path` lives as long as the folder. */
lmb_result output_folder_stage(lmb_output_folder *folder, const char **path, lmb_error *error);

/* Names of what lies there, but for bake.json: in order, relative to the folder. NULL when out of memory. */
cJSON *output_folder_files(const lmb_output_folder *folder);

/* Moves the new files to their places, bake.json last, and removes those that an earlier bake's `files` names and this
 * one does not have; other files stay. On failure all is as it was. An interruption comes too late from here on. */
lmb_result output_folder_commit(lmb_output_folder *folder, lmb_error *error);

/* Completes the line of an error in writing: under the name that the file was to have, and with what is there now. */
void output_folder_explain(const lmb_output_folder *folder, lmb_error *error);

/* Gives up the lock; without a commit nothing is left of what was made here. NULL is allowed. */
void output_folder_close(lmb_output_folder *folder);

#endif
