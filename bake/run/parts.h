/* What was gathered, kept on disk part by part, as it is before denoising and finishing: what a bake that was cut off
 * goes on from, and what shards of one are put together from. */
#ifndef LMB_PARTS_H
#define LMB_PARTS_H

#include <lambent/error.h>
#include <lambent/gather_elements.h>

/* Groups of elements in a part: some four thousand elements. */
enum { LMB_PART_GROUPS = 64 };

/* The folder in a bake's folder that they lie in. */
#define LMB_PARTS_NAME ".lambent-parts"

typedef struct lmb_parts {
    uint64_t key;                 /* of all that decides what is gathered; files of another are not looked at */
    const char *const *read_from; /* folders that parts are taken from, in any order; they may be missing */
    uint32_t read_count;          /* 0: none is */
    const char *write_to;         /* a folder, made when the first is written; NULL: nothing is kept */
    double seconds;               /* between writing; the rest is not kept where all is done sooner */
    uint32_t shard, shard_count;  /* gathers part `shard`, `shard` + shard_count, ... alone; 0, 1: all */
    bool read_only;               /* gathers nothing: a part that is missing is an error */
} lmb_parts;

/* Whether others gather the rest. NULL: no. */
static inline bool lmb_parts_are_a_shard(const lmb_parts *parts)
{
    return parts && parts->shard_count > 1;
}

/* Gathers all of a list as lmb_gather_elements does, or takes parts of it from files; the bytes are the same. What is
 * not of the shard is zero. `parts` NULL: no files.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED, _WRITE (of a shard), _UNSUPPORTED (a part is missing) */
lmb_result lmb_parts_gather(const lmb_parts *parts, const lmb_gather_job *job, lmb_pool *pool,
                            const lmb_progress *progress, lmb_gathered *gathered, lmb_gather_stats *stats,
                            lmb_error *error);

#endif
