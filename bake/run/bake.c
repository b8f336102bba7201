#include <lambent/bake.h>

#include <string.h>

#include <lambent/bake_phases.h>

#include "base/clock.h"
#include "run/bake_current.h"
#include "run/bake_folder_internal.h"
#include "run/bake_internal.h"
#include "run/bake_key.h"
#include "run/bake_work.h"
#include "run/bake_write.h"
#include "run/kept.h"
#include "run/prepared.h"

static bool report_progress(void *context, const char *name, double done)
{
    lmb_bake_report *report = context;
    const lmb_bake_phase phase = lmb_bake_phase_find(name);
    const double now = lmb_clock_seconds();
    if (phase < LMB_PHASE_COUNT && phase != report->phase) {
        report->phase = phase;
        report->phase_start = now;
    }
    const lmb_bake_progress progress = {
        .phase = report->phase,
        .done = done,
        .seconds_left = lmb_forecast_left(&report->forecast, report->phase, done, now - report->phase_start)};
    return !report->listener.progress || report->listener.progress(report->listener.context, &progress);
}

lmb_progress lmb_bake_report_begin(lmb_bake_report *report, const lmb_bake_listener *listener)
{
    *report = (lmb_bake_report){.phase = LMB_PHASE_LOAD, .phase_start = lmb_clock_seconds()};
    report->listener = listener ? *listener : (lmb_bake_listener){.progress = NULL};
    return (lmb_progress){report_progress, report};
}

static lmb_result forecast_renew(const lmb_bake *bake, lmb_bake_report *report, lmb_error *error)
{
    const lmb_result result = lmb_forecast_make(bake, &report->forecast);
    return result == LMB_OK ? LMB_OK : lmb_error_set(error, result, "trial: %s", lmb_result_text(result));
}

lmb_result lmb_bake_geometry(lmb_bake *bake, lmb_bake_report *report, lmb_error *error)
{
    lmb_result result = lmb_bake_place(bake, error);
    if (result == LMB_OK && report) {
        result = lmb_bake_layout(bake, error);
    }
    if (result == LMB_OK && report) {
        result = forecast_renew(bake, report, error);
    }
    if (result == LMB_OK && bake->record.settings.placed_by_all) {
        result = lmb_bake_levels_by_all(bake, error);
    }
    return result;
}

lmb_result lmb_bake_light(lmb_bake *bake, lmb_bake_report *report, lmb_error *error)
{
    lmb_result result = lmb_bake_surface(bake, error);
    if (result == LMB_OK && !bake->record.settings.placed_by_all) {
        result = lmb_bake_levels(bake, error);
    }
    return result == LMB_OK && report ? forecast_renew(bake, report, error) : result;
}

static lmb_result bake_solve(lmb_bake *bake, lmb_bake_report *report, lmb_error *error)
{
    const lmb_result result = lmb_bake_geometry(bake, report, error);
    return result == LMB_OK ? lmb_bake_light(bake, report, error) : result;
}

/* All that comes before light is gathered; `prepared` as lmb_bake_work has it. */
static lmb_result bake_prepare(lmb_bake *bake, const char *prepared, lmb_bake_report *report, lmb_error *error)
{
    if (!prepared) {
        return bake_solve(bake, report, error);
    }
    lmb_result result = lmb_bake_prepared_read(bake, prepared, error);
    result = result == LMB_OK ? lmb_bake_layout(bake, error) : result;
    return result == LMB_OK ? forecast_renew(bake, report, error) : result;
}

static lmb_result bake_gather(lmb_bake *bake, lmb_error *error)
{
    lmb_result result = lmb_bake_probes(bake, error);
    return result == LMB_OK ? lmb_bake_lightmaps(bake, error) : result;
}

lmb_result lmb_bake_finish(lmb_bake *bake, const lmb_bake_settings *asked, const lmb_bake_work *work,
                           lmb_bake_folder *folder, lmb_error *error)
{
    if (!work->resume && !work->merge && !lmb_bake_work_is_shard(work)) {
        lmb_bake_folder_drop_parts(folder);
    }
    lmb_parts parts;
    if (lmb_bake_parts_make(work, folder, bake->record.key, &parts) != LMB_OK) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    bake->parts = &parts;
    lmb_result result = bake_gather(bake, error);
    bake->parts = NULL;
    bake->kept = NULL;
    lmb_bake_parts_free(&parts);
    if (result == LMB_ERROR_WRITE && !lmb_bake_work_is_shard(work)) { /* of what is kept */
        lmb_bake_folder_explain(folder, error);
    }
    if (result == LMB_OK && lmb_bake_work_is_shard(work)) {
        return lmb_bake_shard_write(asked, work, folder, bake->record.content_hash, error);
    }
    if (result != LMB_OK) {
        return result;
    }
    result = lmb_bake_write(bake, folder, error);
    if (result == LMB_ERROR_WRITE) { /* a full disk may have room without them */
        lmb_bake_folder_drop_parts(folder);
        result = lmb_bake_write(bake, folder, error);
    }
    if (result == LMB_OK) {
        lmb_bake_folder_drop_parts(folder);
    }
    return result;
}

/* What is to be taken from the folder's bake, and kept there: for lmb_bake_finish, once the level is prepared. */
static lmb_result kept_find(lmb_bake *bake, const lmb_bake_settings *asked, const lmb_bake_work *work,
                            const char *directory, lmb_kept *kept, lmb_error *error)
{
    bool suns_differ;
    *kept = (lmb_kept){.settings = lmb_kept_settings(asked), .suns = lmb_kept_suns(&bake->record)};
    if (!work->only) {
        return LMB_OK;
    }
    kept->read_from = directory;
    memcpy(kept->box, work->only, sizeof kept->box);
    const lmb_result result = lmb_kept_check(kept, !asked->no_probes, asked->lightmaps, &suns_differ, error);
    if (result == LMB_OK && suns_differ) {
        lmb_warn(&bake->level->warnings, "%s: the sun is not that of the earlier bake: all is baked anew",
                 bake->level->scene->path);
        kept->read_from = NULL;
    }
    return result;
}

static lmb_result kept_begin(lmb_bake *bake, lmb_bake_folder *folder, lmb_kept *kept, lmb_error *error)
{
    lmb_bake_record *const record = &bake->record;
    bake->kept = kept;
    if (kept->read_from) {
        record->is_part = true;
        memcpy(record->only, kept->box, sizeof record->only);
        record->key = lmb_bake_part_key(record->key, kept->box);
    }
    return lmb_bake_folder_stage(folder, &kept->write_to, error);
}

/* Says what of the level is not as in the folder's bake, and whether a part of that stays. */
static void changes_say(const lmb_bake *bake, const char *directory, bool stays)
{
    char changed[128];
    lmb_bake_changes(directory, &bake->record, changed, sizeof changed);
    if (changed[0]) {
        lmb_warn(&bake->level->warnings, "%s: changed since it was baked into %s (%s): %s", bake->level->scene->path,
                 directory, changed,
                 stays ? "what lies outside of the box stays as it was"
                       : "all is baked anew; --only bakes a part, after a bake with --keep-gathered");
    }
}

/* All of an open level's bake. */
static lmb_result bake_whole(lmb_bake *bake, const lmb_bake_settings *asked, const lmb_bake_work *work,
                             lmb_bake_folder *folder, lmb_bake_report *report, lmb_error *error)
{
    const char *const directory = lmb_bake_folder_directory(folder);
    const bool keeps = work->keep || work->only;
    lmb_kept kept = {.read_from = NULL};
    bake->record.is_current = lmb_bake_work_is_done(work, folder, bake->record.key);
    if (bake->record.is_current) {
        /* Parts of a bake that was killed when all was written; beside what is prepared they are another's. */
        if (!work->prepare) {
            lmb_bake_folder_drop_parts(folder);
        }
        return LMB_OK;
    }
    if (work->prepare) {
        const lmb_result result = bake_solve(bake, NULL, error);
        return result == LMB_OK ? lmb_bake_prepared_write(bake, directory, error) : result;
    }
    lmb_result result = keeps ? kept_find(bake, asked, work, directory, &kept, error) : LMB_OK;
    if (result == LMB_OK) {
        lmb_scene_part_hashes(bake->level->scene, bake->record.content);
        changes_say(bake, directory, kept.read_from != NULL);
        result = bake_prepare(bake, work->prepared, report, error);
    }
    if (result == LMB_OK && keeps) {
        result = kept_begin(bake, folder, &kept, error);
    }
    return result == LMB_OK ? lmb_bake_finish(bake, asked, work, folder, error) : result;
}

/* `folder` NULL: a plan. */
static lmb_result bake_level(const lmb_bake_settings *settings, const lmb_bake_work *work, lmb_bake_folder *folder,
                             const lmb_bake_listener *listener, lmb_bake_record *record, lmb_error *error)
{
    lmb_bake_report report;
    const lmb_progress progress = lmb_bake_report_begin(&report, listener);
    lmb_level level;
    lmb_result result = lmb_level_open(&settings->level, &report.listener.warnings, &progress, &level, error);
    if (result != LMB_OK) {
        return result;
    }
    lmb_bake bake = lmb_bake_begin(settings, &level, &progress);
    bake.record.key = lmb_bake_key(settings, level.scene->content_hash);
    result =
        folder ? bake_whole(&bake, settings, work, folder, &report, error) : bake_prepare(&bake, NULL, &report, error);
    if (result == LMB_OK && !folder) {
        bake.record.expected_seconds = lmb_forecast_left(&report.forecast, LMB_PHASE_PROBES, 0.0, 0.0);
    }
    if (result == LMB_OK && record) {
        *record = bake.record;
    }
    lmb_bake_end(&bake);
    lmb_level_close(&level);
    return result;
}

lmb_result lmb_bake_run(const lmb_bake_settings *settings, lmb_bake_folder *folder, const lmb_bake_listener *listener,
                        lmb_bake_record *record, lmb_error *error)
{
    static const lmb_bake_work all = {.again = true};
    return lmb_bake_run_as(settings, &all, folder, listener, record, error);
}

lmb_result lmb_bake_run_as(const lmb_bake_settings *settings, const lmb_bake_work *work, lmb_bake_folder *folder,
                           const lmb_bake_listener *listener, lmb_bake_record *record, lmb_error *error)
{
    if (!folder || lmb_bake_folder_lightmaps(folder) != settings->lightmaps) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "the folder was not opened for this bake");
    }
    if (!settings->level.path) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "no level");
    }
    if (work->only && (work->merge || lmb_bake_work_is_shard(work))) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "a part of a level is baked as a whole");
    }
    return bake_level(settings, work, folder, listener, record, error);
}

lmb_result lmb_bake_plan(const lmb_bake_settings *settings, const lmb_bake_listener *listener, lmb_bake_record *record,
                         lmb_error *error)
{
    return settings->level.path ? bake_level(settings, NULL, NULL, listener, record, error)
                                : lmb_error_set(error, LMB_ERROR_ARGUMENT, "no level");
}
