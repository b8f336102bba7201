/* How a bake is done in pieces: where its parts lie, and what a shard leaves. */
#ifndef LMB_BAKE_WORK_H
#define LMB_BAKE_WORK_H

#include <lambent/bake.h>

#include "run/parts.h"

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
