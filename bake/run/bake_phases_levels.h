/* Which levels of probes the settings ask for. */
#ifndef LMB_BAKE_PHASES_LEVELS_H
#define LMB_BAKE_PHASES_LEVELS_H

#include <lambent/bake_phases.h>

typedef struct lmb_level_plan {
    float even_spacing;      /* metres, of the level that is placed first */
    uint32_t coarser, finer; /* levels beside it */
    uint32_t own;            /* the level's own coarsest one, where no box says otherwise, by number: 0 is the finest */
} lmb_level_plan;

lmb_level_plan lmb_bake_level_plan(const lmb_bake_settings *settings, const lmb_scene *scene);

/* Cuts the cells of the bake's probes, in what is left of a phase. */
lmb_result lmb_bake_regions(lmb_bake *bake, lmb_bake_phase phase, lmb_error *error);

#endif
