#include <lambent/bake_phases.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/probe_locals.h>

#include "base/clock.h"
#include "run/bake_phases_levels.h"
#include "run/bake_phases_record.h"
#include "run/kept.h"
#include "run/step.h"

/* Probes farther apart than so many steps between floats are told apart well enough. */
#define STEPS_OF_SPACING 8.0

/* The largest coordinate of probes in the world: a corner of their box has it. */
static double probes_reach(const lmb_probes *probes)
{
    const lmb_lattice *lattice = &probes->level[0].lattice;
    double reach = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        int32_t point[3];
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = lattice->min[axis] + ((corner >> axis & 1) != 0 ? lattice->size[axis] - 1 : 0);
        }
        const lmb_vec3d at = lmb_lattice_position(lattice, point);
        reach = fmax(reach, fmax(fabs(at.x), fmax(fabs(at.y), fabs(at.z))));
    }
    return reach;
}

static void warn_of_coarse_floats(const lmb_bake *bake, uint32_t finer)
{
    const lmb_warnings *warnings = &bake->level->warnings;
    const lmb_scene *scene = bake->level->scene;
    const double spacing = ldexp((double)bake->probes->level[0].lattice.spacing, -(int)finer);
    const double step = (double)lmb_scene_position_step(scene);
    if (step * STEPS_OF_SPACING > spacing && !bake->record.settings.lightmaps) {
        lmb_warn(warnings,
                 "%s: floats tell positions of its surfaces apart by %.3g m only, and its probes are %.3g m "
                 "apart: so far from the origin its light is not to be trusted",
                 scene->path, step, spacing);
    }
    const double reach = probes_reach(bake->probes);
    const double run_time_step = (double)(nextafterf((float)reach, INFINITY) - (float)reach);
    if (run_time_step * STEPS_OF_SPACING > spacing) {
        lmb_warn(warnings,
                 "%s: lies up to %.6g m from the world's origin, where floats are %.3g m apart, and its probes "
                 "%.3g m: sample its volume at positions in double (lmb_volume_sample_at)",
                 scene->path, reach, run_time_step, spacing);
    }
}

lmb_bake lmb_bake_begin(const lmb_bake_settings *settings, lmb_level *level, const lmb_progress *progress)
{
    lmb_bake bake = {.level = level, .progress = progress};
    lmb_bake_record *record = &bake.record;
    record->settings = *settings;
    record->settings.denoise = settings->denoise && settings->estimator != LMB_ESTIMATOR_REFERENCE;
    record->content_hash = level->scene->content_hash;
    record->threads = lmb_pool_threads(level->pool);
    record->triangles_dropped = level->scene->dropped_triangle_count;
    record->key_light_count = lmb_scene_key_lights(level->scene, record->key_light);
    record->seconds[LMB_PHASE_LOAD] = level->seconds_load;
    record->seconds[LMB_PHASE_BVH] = level->seconds_bvh;
    return bake;
}

/* What placement made of the settings: the spacing that it chose, seeds rounded to where floats are. */
static void record_placed(lmb_bake *bake, bool has_levels)
{
    lmb_bake_record *record = &bake->record;
    const lmb_scene *scene = bake->level->scene;
    if (!has_levels) {
        record->settings.spacing = bake->probes->level[0].lattice.spacing;
    }
    for (uint32_t i = 0; i < record->settings.seed_count; ++i) {
        const lmb_vec3 used = lmb_scene_from_world(scene, record->settings.seeds[i]);
        record->settings.seeds[i] = lmb_scene_to_world(scene, used);
    }
    lmb_bake_record_levels(bake);
    record->rays[LMB_PHASE_PLACE] = record->placement.rays;
}

static float detail_of(const lmb_bake_settings *settings)
{
    return settings->detail > 0.0f ? settings->detail : 1.0f;
}

lmb_result lmb_bake_place(lmb_bake *bake, lmb_error *error)
{
    if (bake->record.settings.no_probes) {
        return LMB_OK;
    }
    const double start = lmb_clock_seconds();
    lmb_bake_record *record = &bake->record;
    const lmb_warnings *warnings = &bake->level->warnings;
    const lmb_level_plan plan = lmb_bake_level_plan(&record->settings, bake->level->scene);
    const lmb_placement_settings settings = {.spacing = plan.even_spacing,
                                             .max_probes = record->settings.max_probes,
                                             .seeds = record->settings.seeds,
                                             .seed_count = record->settings.seed_count,
                                             .for_levels = plan.coarser + plan.finer > 0,
                                             .warnings = *warnings,
                                             .progress = bake->progress};
    lmb_result result =
        lmb_placement_make(bake->level->tracer, &settings, bake->level->pool, &bake->probes, &record->placement, error);
    if (result == LMB_OK) {
        record_placed(bake, settings.for_levels);
        result = !settings.for_levels ? lmb_bake_regions(bake, LMB_PHASE_PLACE, error) : LMB_OK;
    }
    record->seconds[LMB_PHASE_PLACE] = lmb_clock_seconds() - start;
    if (result != LMB_OK) {
        return result;
    }
    if (record->placement.everything_solid) {
        lmb_warn(warnings, "%s: all faces look away from all free space; baking everywhere in its bounds",
                 bake->level->scene->path);
    }
    warn_of_coarse_floats(bake, plan.finer);
    return LMB_OK;
}

/* What the settings say, in place of the level's own. */
static lmb_lightmap_settings lightmap_settings(const lmb_bake *bake)
{
    const lmb_bake_settings *wanted = &bake->record.settings;
    lmb_lightmap_settings settings = lmb_lightmap_settings_default(bake->level->scene);
    settings.texels_per_m =
        wanted->texels_per_m > 0.0f ? wanted->texels_per_m : detail_of(wanted) * settings.texels_per_m;
    settings.max_image_size = wanted->max_image_size > 0 ? wanted->max_image_size : settings.max_image_size;
    settings.padding = wanted->padding > 0 ? wanted->padding : settings.padding;
    settings.warnings = bake->level->warnings;
    settings.format = wanted->lightmap_format;
    memcpy(settings.other, wanted->models, sizeof settings.other);
    settings.error = wanted->texel_error;
    settings.pool = bake->level->pool;
    return settings;
}

static void record_laid_out(lmb_bake *bake)
{
    const lmb_lightmap *lightmap = bake->lightmap;
    lmb_bake_record *record = &bake->record;
    record->settings.texels_per_m = lightmap->settings.texels_per_m;
    record->settings.max_image_size = lightmap->settings.max_image_size;
    record->settings.padding = lightmap->settings.padding;
    record->images = lightmap->image_count;
    record->texels_covered = lightmap->covered_texel_count;
    record->texels_used = lmb_lightmap_texels_used(lightmap);
    record->charts = lightmap->chart_count;
}

lmb_result lmb_bake_layout(lmb_bake *bake, lmb_error *error)
{
    if (!bake->record.settings.lightmaps) {
        return LMB_OK;
    }
    const double start = lmb_clock_seconds();
    const char *name = lmb_bake_phase_name(LMB_PHASE_LAYOUT);
    const lmb_lightmap_settings settings = lightmap_settings(bake);
    lmb_result result = step_report(bake->progress, name, 0.0, error);
    if (result == LMB_OK) {
        result = lmb_lightmap_create(bake->level->scene, &settings, &bake->lightmap, error);
    }
    bake->record.seconds[LMB_PHASE_LAYOUT] = lmb_clock_seconds() - start;
    if (result != LMB_OK) {
        return result;
    }
    record_laid_out(bake);
    const lmb_gather_effort effort = lmb_bake_effort(&bake->record.settings, bake->level);
    if (lmb_texel_list_create(bake->lightmap, &bake->level->transport, &effort, &bake->texels) != LMB_OK) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for the lightmap's texels");
    }
    return step_report(bake->progress, name, 1.0, error);
}

lmb_result lmb_bake_surface(lmb_bake *bake, lmb_error *error)
{
    const lmb_result result = lmb_level_solve(bake->level, bake->record.settings.estimator, bake->progress, error);
    lmb_bake_record_surface(bake);
    return result;
}

/* What is wrong with files has been said. */
static lmb_result phase_result(lmb_bake_phase phase, lmb_result result, lmb_error *error)
{
    const bool is_said = result != LMB_ERROR_MEMORY && result != LMB_ERROR_INTERRUPTED && result != LMB_ERROR_ARGUMENT;
    return is_said ? result
                   : lmb_error_set(error, result, "%s: %s", lmb_bake_phase_name(phase), lmb_result_text(result));
}

static lmb_result list_gather(lmb_bake *bake, const lmb_gather_job *job, lmb_gathered *gathered,
                              lmb_gather_stats *stats, lmb_error *error)
{
    lmb_kept_stats what;
    const lmb_result result = lmb_kept_gather(bake, job, gathered, stats, &what, error);
    bake->record.taken += what.taken;
    if (result == LMB_OK && what.missing > 0) {
        lmb_warn(&bake->level->warnings,
                 "%s: %llu of %zu outside of the box stand elsewhere than in the earlier bake: they are baked anew too",
                 job->list->name, (unsigned long long)what.missing, job->list->count);
    }
    return result;
}

static lmb_result probes_gather(lmb_bake *bake, const lmb_probe_list *list, lmb_error *error)
{
    lmb_bake_record *record = &bake->record;
    const lmb_gather_effort effort = lmb_bake_effort(&record->settings, bake->level);
    const lmb_gather_list elements = lmb_probe_list_elements(list);
    const lmb_gather_job job = lmb_gather_job_all(&bake->level->transport, &elements, &effort);
    lmb_gathered *gathered = malloc((list->count + 1) * sizeof *gathered);
    lmb_result result = LMB_ERROR_MEMORY;
    if (gathered) {
        result = list_gather(bake, &job, gathered, &record->gathered, error);
    }
    if (result == LMB_OK && lmb_parts_are_a_shard(bake->parts)) {
        free(gathered);
        return LMB_OK;
    }
    if (result == LMB_OK && record->settings.denoise) {
        result = lmb_probe_list_denoise(list, bake->level->pool, NULL, gathered);
        lmb_gather_stats_renew(&record->gathered, gathered, list->count);
    }
    if (result == LMB_OK) {
        result = lmb_probe_list_finish(list, gathered, bake->level->pool, bake->probes);
    }
    free(gathered);
    return result;
}

static void record_locals(lmb_bake *bake)
{
    bake->record.local_sets = bake->probes->local_count;
    bake->record.local_probes = 0;
    for (uint32_t i = 0; i < bake->probes->local_count; ++i) {
        bake->record.local_probes += lmb_local_frame_count(&bake->probes->local[i].frame);
    }
}

lmb_result lmb_bake_probes(lmb_bake *bake, lmb_error *error)
{
    if (!bake->probes) {
        return LMB_OK;
    }
    const double start = lmb_clock_seconds();
    lmb_bake_record *record = &bake->record;
    lmb_probe_list list;
    lmb_result result = lmb_probe_locals_place(bake->level->tracer, bake->probes, &record->rays[LMB_PHASE_PLACE]);
    if (result != LMB_OK) {
        return phase_result(LMB_PHASE_PROBES, result, error);
    }
    record_locals(bake);
    result = lmb_probe_list_create(bake->probes, bake->regions, bake->level->transport.tracer, &list);
    if (result == LMB_OK) {
        result = probes_gather(bake, &list, error);
        lmb_probe_list_free(&list);
    }
    record->seconds[LMB_PHASE_PROBES] = lmb_clock_seconds() - start;
    record->rays[LMB_PHASE_PROBES] = record->gathered.rays;
    return phase_result(LMB_PHASE_PROBES, result, error);
}

static lmb_result texels_gather(lmb_bake *bake, const lmb_gather_list *elements, const lmb_gather_effort *effort,
                                lmb_gathered *gathered, lmb_error *error)
{
    const double start = lmb_clock_seconds();
    lmb_bake_record *record = &bake->record;
    const lmb_gather_job job = lmb_gather_job_all(&bake->level->transport, elements, effort);
    const lmb_result result = list_gather(bake, &job, gathered, &record->lightmap, error);
    record->seconds[LMB_PHASE_LIGHTMAPS] = lmb_clock_seconds() - start;
    record->rays[LMB_PHASE_LIGHTMAPS] = record->lightmap.rays;
    return result;
}

static lmb_result texels_denoise(lmb_bake *bake, const lmb_texel_list *list, size_t count, lmb_gathered *gathered)
{
    const double start = lmb_clock_seconds();
    const lmb_result result = lmb_texel_list_denoise(list, bake->level->pool, bake->progress, gathered);
    lmb_gather_stats_renew(&bake->record.lightmap, gathered, count);
    bake->record.seconds[LMB_PHASE_DENOISE] = lmb_clock_seconds() - start;
    return result;
}

static lmb_result texels_finish(lmb_bake *bake, const lmb_texel_list *list, const lmb_gathered *gathered)
{
    const double start = lmb_clock_seconds();
    const lmb_result result = lmb_texel_list_finish(list, gathered, bake->level->pool, bake->lightmap);
    bake->record.seconds[LMB_PHASE_LIGHTMAPS] += lmb_clock_seconds() - start;
    bake->record.seams_open = bake->lightmap->open;
    bake->record.seams_closed = bake->lightmap->closed;
    return result;
}

lmb_result lmb_bake_lightmaps(lmb_bake *bake, lmb_error *error)
{
    if (!bake->lightmap) {
        return LMB_OK;
    }
    const lmb_bake_settings *settings = &bake->record.settings;
    const lmb_gather_effort effort = lmb_bake_effort(settings, bake->level);
    const lmb_gather_list elements = lmb_texel_list_elements(bake->texels);
    lmb_gathered *gathered = malloc((elements.count + 1) * sizeof *gathered);
    lmb_result result = gathered ? texels_gather(bake, &elements, &effort, gathered, error) : LMB_ERROR_MEMORY;
    if (result == LMB_OK && lmb_parts_are_a_shard(bake->parts)) {
        free(gathered);
        return LMB_OK;
    }
    if (result == LMB_OK && settings->denoise) {
        result = texels_denoise(bake, bake->texels, elements.count, gathered);
    }
    if (result == LMB_OK) {
        result = texels_finish(bake, bake->texels, gathered);
    }
    free(gathered);
    return phase_result(LMB_PHASE_LIGHTMAPS, result, error);
}

void lmb_bake_end(lmb_bake *bake)
{
    lmb_texel_list_destroy(bake->texels);
    lmb_lightmap_destroy(bake->lightmap);
    lmb_regions_destroy(bake->regions);
    lmb_probes_destroy(bake->probes);
    bake->regions = NULL;
    bake->texels = NULL;
    bake->lightmap = NULL;
    bake->probes = NULL;
}
