/* The phases of a bake one by one, in memory: what lmb_bake_run (lambent/bake.h) runs and writes, and measurements
 * take apart. */
#ifndef LAMBENT_BAKE_PHASES_H
#define LAMBENT_BAKE_PHASES_H

#include <lambent/bake_record.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Everything a bake holds in memory. */
typedef struct lmb_bake {
    lmb_level *level;
    const lmb_progress *progress;  /* NULL: silent */
    const struct lmb_parts *parts; /* where what is gathered is kept until all is; NULL: in memory alone */
    const struct lmb_kept *kept;   /* what of it is taken from an earlier bake, and kept for the next; NULL: nothing */
    lmb_probes *probes;            /* once placed, if wanted */
    lmb_regions *regions;          /* likewise */
    lmb_lightmap *lightmap;        /* once laid out, if wanted */
    lmb_texel_list *texels;        /* its texels, likewise */
    lmb_bake_record record;        /* of the phases that have run */
} lmb_bake;

/* A bake of an open level, which is the caller's and must outlive it. `settings->level` is for the record alone: how
 * the level is traced was decided when it was opened. */
lmb_bake lmb_bake_begin(const lmb_bake_settings *settings, lmb_level *level, const lmb_progress *progress);

/* The phases, in the order in which they run: each needs those before it. Warnings go to the level's listener. A bake
 * that failed is to be ended too. @return what lmb_placement_make, lmb_lightmap_create, lmb_level_solve,
 * lmb_placement_levels, lmb_probes_bake and lmb_lightmap_bake return */
lmb_result lmb_bake_place(lmb_bake *bake, lmb_error *error); /* where the settings want probes, as others do */
lmb_result lmb_bake_layout(lmb_bake *bake, lmb_error *error);
lmb_result lmb_bake_surface(lmb_bake *bake, lmb_error *error);
lmb_result lmb_bake_levels(lmb_bake *bake, lmb_error *error); /* of probes, where the settings ask for some */
lmb_result lmb_bake_probes(lmb_bake *bake, lmb_error *error);
lmb_result lmb_bake_lightmaps(lmb_bake *bake, lmb_error *error);

/* lmb_bake_levels by the light of all of the level's sets, where the settings ask for levels: solves that first, and
 * shows the set again that was shown. */
lmb_result lmb_bake_levels_by_all(lmb_bake *bake, lmb_error *error);

/* Shows another set of lights, and makes the bake one of that set alone, placed and laid out as it is, which has yet to
 * solve the light on surfaces. `record` is what it was after the phases that all sets share. */
lmb_result lmb_bake_show_light_set(lmb_bake *bake, uint32_t set, const lmb_bake_record *record, lmb_error *error);

/* Frees what the bake holds, but not the level; its record stays. */
void lmb_bake_end(lmb_bake *bake);

#ifdef __cplusplus
}
#endif

#endif
