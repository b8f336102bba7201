/* What a bake has gathered, kept in its folder, so that the next one gathers anew in a part of the level alone.
 *
 * An element of a list is the same in two bakes when it is gathered at the same points in the same way, wherever it
 * stands in the list. What is kept is as it was gathered, before denoising and finishing. */
#ifndef LMB_KEPT_H
#define LMB_KEPT_H

#include <lambent/bake_phases.h>

#include "run/parts.h"

/* The file of a list of elements, by the list's name. */
#define LMB_KEPT_PROBES "gathered-probes.bin"
#define LMB_KEPT_LIGHTMAPS "gathered-lightmaps.bin"

/* How a bake's lists are gathered. */
typedef struct lmb_kept {
    const char *read_from; /* the folder of the earlier bake; NULL: all is gathered */
    lmb_vec3d box[2];      /* least and greatest coordinates in the world: what lies in it is gathered anew */
    const char *write_to;  /* a folder; NULL: nothing is kept */
    uint64_t settings;     /* hash of those that decide what is gathered, but for the level's own contents */
    uint64_t suns;         /* hash of the key lights */
} lmb_kept;

/* What became of a list. */
typedef struct lmb_kept_stats {
    uint64_t taken;   /* from the earlier bake */
    uint64_t missing; /* outside the box, and gathered: the earlier bake did not have them */
} lmb_kept_stats;

/* Of these settings, of whatever level under whatever light, and of a level's key lights. 0: out of memory. */
uint64_t lmb_kept_settings(const lmb_bake_settings *settings);
uint64_t lmb_kept_suns(const lmb_bake_record *record);

/* Whether the folder has what is needed: by the beginning of its files alone. `*suns_differ`: nothing can be taken.
 * @return LMB_ERROR_UNSUPPORTED (it has nothing kept, or of other settings), _FORMAT, _MEMORY */
lmb_result lmb_kept_check(const lmb_kept *kept, bool probes, bool lightmaps, bool *suns_differ, lmb_error *error);

/* lmb_parts_gather of the whole of a list, in the way that the bake's `kept` says; NULL: that alone. The stats' samples
 * are those of all elements, its rays those that were traced. @return likewise, and LMB_ERROR_IO, _FORMAT, _TRUNCATED,
 * _CHECKSUM (of what is kept), _WRITE */
lmb_result lmb_kept_gather(const lmb_bake *bake, const lmb_gather_job *job, lmb_gathered *gathered,
                           lmb_gather_stats *stats, lmb_kept_stats *what, lmb_error *error);

#endif
