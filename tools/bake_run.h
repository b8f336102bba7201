/* Running a bake from a level in memory to files in a folder. */
#ifndef LMB_TOOLS_BAKE_RUN_H
#define LMB_TOOLS_BAKE_RUN_H

#include <lambent/grid_bake.h>

#include "bake_settings.h"

/* What a bake did, for bake.json and the closing lines. */
typedef struct lmb_bake_record {
    lmb_placement_stats placement;
    lmb_grid_bake_stats probes;
    lmb_lightmap_stats lightmap;
    double seconds_place, seconds_probes, seconds_lightmaps, seconds_write;
    uint64_t bytes_vdb, bytes_lmb, bytes_lightmaps;
    uint64_t fp16_overflow_count;
} lmb_bake_record;

/* Places, bakes and writes; prints what it found unless quiet. */
lmb_result bake_run(const lmb_bake_settings *settings, lmb_level *level, const lmb_progress *progress,
                    lmb_error *error);

#endif
