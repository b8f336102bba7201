/* How a bake is done in pieces: by which key its parts are known, where they lie, and what a shard leaves. */
#ifndef LMB_BAKE_WORK_H
#define LMB_BAKE_WORK_H

#include <lambent/bake.h>

#include "run/parts.h"

/* Of everything that decides the bytes of a bake: settings, the level's and environment's content, this program's
 * version. Not of the level's path. 0: out of memory. */
uint64_t lmb_bake_key(const lmb_bake_settings *settings, uint64_t content_hash);

/* Of a bake with that key, of a box alone. */
uint64_t lmb_bake_part_key(uint64_t key, const lmb_vec3d box[2]);

static inline bool lmb_bake_work_is_shard(const lmb_bake_work *work)
{
    return work->shard_count > 1;
}

/* Whether there is nothing to do: the folder holds what is asked for, of the bake of that key. */
bool lmb_bake_work_is_done(const lmb_bake_work *work, const lmb_bake_folder *folder, uint64_t key);

/* The parts of a bake into `folder`. @return LMB_ERROR_MEMORY */
lmb_result lmb_bake_parts_make(const lmb_bake_work *work, const lmb_bake_folder *folder, uint64_t key,
                               lmb_parts *parts);
void lmb_bake_parts_free(lmb_parts *parts);

/* Writes what lmb_bake_shard_settings reads: the settings as they were asked for. @return LMB_ERROR_WRITE, _MEMORY */
lmb_result lmb_bake_shard_write(const lmb_bake_settings *settings, const lmb_bake_work *work,
                                const lmb_bake_folder *folder, uint64_t content_hash, lmb_error *error);

#endif
