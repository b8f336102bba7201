#include "bake_phases.h"

#include <math.h>

#include "command.h"

/* Probes farther apart than so many steps between floats are told apart well enough. */
#define STEPS_OF_SPACING 8.0

/* The grid's largest coordinate in the world. */
static double grid_reach(const lmb_grid *grid)
{
    double reach = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double first = (double)grid->min[axis], last = first + (grid->size[axis] - 1);
        reach = fmax(reach, fmax(fabs(first), fabs(last)) * (double)grid->spacing);
    }
    return reach;
}

static void warn_of_coarse_floats(const lmb_bake *bake)
{
    const lmb_warnings *warnings = &bake->level->options.gltf.warnings;
    const lmb_scene *scene = bake->level->scene;
    const double spacing = (double)bake->grid->spacing;
    const double step = (double)lmb_scene_position_step(scene);
    if (step * STEPS_OF_SPACING > spacing && !bake->settings->lightmaps) {
        lmb_warn(warnings,
                 "%s: floats tell positions of its surfaces apart by %.3g m only, and its probes are %.3g m "
                 "apart: so far from the origin its light is not to be trusted",
                 scene->path, step, spacing);
    }
    const double reach = grid_reach(bake->grid);
    const double run_time_step = (double)(nextafterf((float)reach, INFINITY) - (float)reach);
    if (run_time_step * STEPS_OF_SPACING > spacing) {
        lmb_warn(warnings,
                 "%s: lies up to %.6g m from the world's origin, where floats are %.3g m apart, and its probes "
                 "%.3g m: sample its volume at positions in double (lmb_volume_sample_at)",
                 scene->path, reach, run_time_step, spacing);
    }
}

lmb_result bake_place(lmb_bake *bake, lmb_error *error)
{
    const double start = seconds_now();
    lmb_placement_settings settings = bake->settings->placement;
    settings.warnings = bake->level->options.gltf.warnings;
    const lmb_result result = lmb_placement_make(bake->level->tracer, &settings, bake->level->pool, bake->progress,
                                                 &bake->grid, &bake->record.placement, error);
    bake->record.seconds_place = seconds_now() - start;
    if (result != LMB_OK) {
        return result;
    }
    const lmb_warnings *warnings = &bake->level->options.gltf.warnings;
    if (bake->record.placement.everything_solid) {
        lmb_warn(warnings, "%s: all faces look away from all free space; baking everywhere in its bounds",
                 bake->level->scene->path);
    }
    warn_of_coarse_floats(bake);
    return LMB_OK;
}

lmb_result bake_layout(lmb_bake *bake, lmb_error *error)
{
    if (!bake->settings->lightmaps) {
        return LMB_OK;
    }
    lmb_lightmap_settings settings = lmb_lightmap_settings_default(bake->level->scene);
    if (bake->settings->texels_per_m > 0.0f) {
        settings.texels_per_m = bake->settings->texels_per_m;
    }
    if (bake->settings->padding > 0) {
        settings.padding = bake->settings->padding;
    }
    settings.warnings = bake->level->options.gltf.warnings;
    const double start = seconds_now();
    const lmb_result result = lmb_lightmap_create(bake->level->scene, &settings, &bake->lightmap, error);
    bake->record.seconds_layout = seconds_now() - start;
    return result;
}

lmb_result bake_surface(lmb_bake *bake, lmb_error *error)
{
    return level_solve(bake->level, bake->settings->estimator, bake->progress, error);
}

/* What is darker than this share of the level's mean light is held to that. */
#define DARK_SHARE 0.01

/* Length of the SH3 moments of three channels of radiance 1 over a hemisphere: sqrt(3 pi + 9 pi / 4). */
#define UNIT_LENGTH 4.06

lmb_gather_effort bake_effort(const lmb_bake *bake)
{
    const lmb_bake_settings *settings = bake->settings;
    return (lmb_gather_effort){.samples = settings->samples,
                               .max_samples = settings->max_samples,
                               .tolerance = settings->tolerance,
                               .floor = DARK_SHARE * UNIT_LENGTH * bake->level->mean_light};
}

lmb_result bake_probes(lmb_bake *bake, lmb_error *error)
{
    const double start = seconds_now();
    const lmb_gather_effort effort = bake_effort(bake);
    const lmb_result result = lmb_grid_bake(bake->grid, &bake->level->transport, &effort, bake->level->pool,
                                            bake->progress, &bake->record.probes);
    bake->record.seconds_probes = seconds_now() - start;
    return result == LMB_OK ? LMB_OK : lmb_error_set(error, result, "probes: %s", lmb_result_text(result));
}

lmb_result bake_lightmaps(lmb_bake *bake, lmb_error *error)
{
    if (!bake->lightmap) {
        return LMB_OK;
    }
    const double start = seconds_now();
    const lmb_gather_effort effort = bake_effort(bake);
    const lmb_result result = lmb_lightmap_bake(bake->lightmap, &bake->level->transport, &effort, bake->level->pool,
                                                bake->progress, &bake->record.lightmap);
    bake->record.seconds_lightmaps = seconds_now() - start;
    return result == LMB_OK ? LMB_OK : lmb_error_set(error, result, "lightmaps: %s", lmb_result_text(result));
}

void bake_close(lmb_bake *bake)
{
    lmb_lightmap_destroy(bake->lightmap);
    lmb_grid_destroy(bake->grid);
    bake->lightmap = NULL;
    bake->grid = NULL;
}

const char *bake_phase_name(lmb_bake_phase phase)
{
    static const char *const names[PHASE_COUNT] = {"place", "surface", "probes", "lightmaps"};
    return names[phase];
}

uint64_t bake_phase_rays(const lmb_bake *bake, lmb_bake_phase phase)
{
    const uint64_t rays[PHASE_COUNT] = {bake->record.placement.rays, bake->level->surface_stats.rays,
                                        bake->record.probes.rays, bake->record.lightmap.rays};
    return rays[phase];
}

double bake_phase_seconds(const lmb_bake *bake, lmb_bake_phase phase)
{
    const double seconds[PHASE_COUNT] = {bake->record.seconds_place, bake->level->seconds_surface,
                                         bake->record.seconds_probes, bake->record.seconds_lightmaps};
    return seconds[phase];
}
