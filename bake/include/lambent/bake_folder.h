/* A bake's folder, which holds the old bake or the new one.
 *
 *     DIR/.lambent-lock       while a bake is at work; the kernel gives it up with the process
 *     DIR/.lambent-new/...    what it has written so far
 *     DIR/.lambent-old/...    what that replaces, while it moves in
 *
 * A folder that has a bake.json holds the whole bake that it describes, at any moment. */
#ifndef LAMBENT_BAKE_FOLDER_H
#define LAMBENT_BAKE_FOLDER_H

#include <stdbool.h>

#include <lambent/error.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_bake_folder lmb_bake_folder;

/* Makes `directory` where it is missing, takes its lock, and sees that a bake (with lightmaps, if so) can be written
 * there: one that cannot is found before there is anything to write. `directory` is copied.
 * @return LMB_ERROR_WRITE (also when another bake has the lock), _MEMORY */
lmb_result lmb_bake_folder_open(const char *directory, bool lightmaps, lmb_bake_folder **folder, lmb_error *error);

/* Gives up the lock; without a whole new bake nothing is left of what was made here. NULL is allowed. */
void lmb_bake_folder_close(lmb_bake_folder *folder);

/* For a process that must end while a bake is at work: takes back what it has made in the folder, so that the old bake
 * is as it was. May be called from another thread than the bake's, once, at any time but while the folder is opened or
 * closed and after the bake has said that all is written (LMB_PHASE_WRITE, done); the bake must not go on long after,
 * for what it writes from then on may be left behind. */
void lmb_bake_folder_abandon(lmb_bake_folder *folder);

#ifdef __cplusplus
}
#endif

#endif
