/* The phases of a bake, in memory: what `bake` runs and writes, and `bench` measures. */
#ifndef LMB_TOOLS_BAKE_PHASES_H
#define LMB_TOOLS_BAKE_PHASES_H

#include <lambent/grid_bake.h>

#include "bake_settings.h"

/* What a bake did, for bake.json and the closing lines. */
typedef struct lmb_bake_record {
    lmb_placement_stats placement;
    lmb_grid_bake_stats probes;
    lmb_lightmap_stats lightmap;
    double seconds_place, seconds_layout, seconds_probes, seconds_lightmaps, seconds_write;
    uint64_t bytes_vdb, bytes_lmb, bytes_lightmaps;
    uint64_t fp16_overflow_count;
} lmb_bake_record;

/* Everything a bake holds in memory. */
typedef struct lmb_bake {
    const lmb_bake_settings *settings;
    lmb_level *level;
    const lmb_progress *progress;
    lmb_grid *grid;         /* once placed */
    lmb_lightmap *lightmap; /* once laid out, if wanted */
    lmb_bake_record record;
} lmb_bake;

/* The phases, in the order in which they run: each needs those before it. Warnings go to standard error unless quiet.
 * A bake that failed is to be closed too. */
lmb_result bake_place(lmb_bake *bake, lmb_error *error);
lmb_result bake_layout(lmb_bake *bake, lmb_error *error);
lmb_result bake_surface(lmb_bake *bake, lmb_error *error);
lmb_result bake_probes(lmb_bake *bake, lmb_error *error);
lmb_result bake_lightmaps(lmb_bake *bake, lmb_error *error);
void bake_close(lmb_bake *bake);

/* The effort for probes and texels, once the surface phase has run. */
lmb_gather_effort bake_effort(const lmb_bake *bake);

/* Rays and seconds of the phases that trace. */
typedef enum lmb_bake_phase { PHASE_PLACE, PHASE_SURFACE, PHASE_PROBES, PHASE_LIGHTMAPS, PHASE_COUNT } lmb_bake_phase;
const char *bake_phase_name(lmb_bake_phase phase);
uint64_t bake_phase_rays(const lmb_bake *bake, lmb_bake_phase phase);
double bake_phase_seconds(const lmb_bake *bake, lmb_bake_phase phase);

#endif
