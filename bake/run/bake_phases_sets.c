/* Phases of a bake that is one of several, of the level's sets of lights. */
#include <lambent/bake_phases.h>

#include <lambent/light_sets.h>

#include "run/bake_phases_levels.h"

lmb_result lmb_bake_levels_by_all(lmb_bake *bake, lmb_error *error)
{
    lmb_level *const level = bake->level;
    const lmb_level_plan plan = lmb_bake_level_plan(&bake->record.settings, level->scene);
    if (!bake->probes || plan.coarser + plan.finer == 0) {
        return LMB_OK;
    }
    const uint32_t shown = level->scene->light_set_hides_others ? level->scene->light_set_shown : LMB_LIGHT_SETS_ALL;
    lmb_bake_record *const record = &bake->record;
    lmb_result result = lmb_level_show_light_set(level, LMB_LIGHT_SETS_ALL, error);
    if (result == LMB_OK) {
        result = lmb_level_solve(level, record->settings.estimator, bake->progress, error);
    }
    const double seconds = level->seconds_surface;
    const uint64_t rays = level->surface ? level->surface_stats.rays : 0;
    if (result == LMB_OK) {
        result = lmb_bake_levels(bake, error);
    }
    record->seconds[LMB_PHASE_LEVELS] += seconds;
    record->rays[LMB_PHASE_LEVELS] += rays;
    return result == LMB_OK ? lmb_level_show_light_set(level, shown, error) : result;
}

lmb_result lmb_bake_show_light_set(lmb_bake *bake, uint32_t set, const lmb_bake_record *record, lmb_error *error)
{
    const lmb_result result = lmb_level_show_light_set(bake->level, set, error);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_scene *const scene = bake->level->scene;
    bake->record = *record;
    bake->record.key_light_count = lmb_scene_key_lights(scene, bake->record.key_light);
    if (bake->probes) {
        lmb_probes_clear_light(bake->probes);
    }
    if (bake->lightmap) { /* it was laid out for all of the level's, which are no fewer */
        bake->lightmap->key_light_count = lmb_scene_key_lights(scene, bake->lightmap->key_light);
    }
    return LMB_OK;
}
