#include "run/bake_phases_record.h"

void lmb_bake_record_surface(lmb_bake *bake)
{
    const lmb_level *level = bake->level;
    lmb_bake_record *record = &bake->record;
    if (level->surface) {
        record->surface_solved = true;
        record->surface = level->surface_stats;
        record->surface_bytes = lmb_surface_light_bytes(level->surface);
        record->surface_cell_size = lmb_surface_light_cell_size(level->surface);
        record->rays[LMB_PHASE_SURFACE] = level->surface_stats.rays;
    }
    record->seconds[LMB_PHASE_SURFACE] = level->seconds_surface;
}

void lmb_bake_record_levels(lmb_bake *bake)
{
    lmb_bake_record *record = &bake->record;
    const lmb_probes *probes = bake->probes;
    record->probes = probes->count - probes->ghost_count;
    record->level_count = 0;
    for (uint32_t level = 0; level < probes->level_count && record->level_count < LMB_BAKE_LEVELS_MOST; ++level) {
        record->level[record->level_count++] =
            (lmb_level_record){probes->level[level].lattice.spacing, probes->level[level].count};
    }
}
