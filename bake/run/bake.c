#include <lambent/bake.h>

#include <lambent/bake_phases.h>

#include "base/clock.h"
#include "run/bake_write.h"
#include "run/forecast.h"

/* Between the work, which names what it does, and who listens to the bake. */
typedef struct bake_report {
    lmb_bake_listener listener;
    lmb_forecast forecast;
    lmb_bake_phase phase;
    double phase_start;
} bake_report;

static bool report_progress(void *context, const char *name, double done)
{
    bake_report *report = context;
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

static lmb_result forecast_renew(const lmb_bake *bake, bake_report *report, lmb_error *error)
{
    const lmb_result result = lmb_forecast_make(bake, &report->forecast);
    return result == LMB_OK ? LMB_OK : lmb_error_set(error, result, "trial: %s", lmb_result_text(result));
}

/* All that comes before light is gathered. */
static lmb_result bake_prepare(lmb_bake *bake, bake_report *report, lmb_error *error)
{
    lmb_result result = lmb_bake_place(bake, error);
    if (result == LMB_OK) {
        result = lmb_bake_layout(bake, error);
    }
    if (result == LMB_OK) {
        result = forecast_renew(bake, report, error);
    }
    if (result == LMB_OK) {
        result = lmb_bake_surface(bake, error);
    }
    if (result == LMB_OK) {
        result = lmb_bake_levels(bake, error);
    }
    if (result == LMB_OK) {
        result = forecast_renew(bake, report, error);
    }
    return result;
}

static lmb_result bake_finish(lmb_bake *bake, lmb_bake_folder *folder, lmb_error *error)
{
    lmb_result result = lmb_bake_probes(bake, error);
    if (result == LMB_OK) {
        result = lmb_bake_lightmaps(bake, error);
    }
    if (result == LMB_OK) {
        result = lmb_bake_write(bake, folder, error);
    }
    return result;
}

/* `folder` NULL: a plan. */
static lmb_result bake_level(const lmb_bake_settings *settings, lmb_bake_folder *folder,
                             const lmb_bake_listener *listener, lmb_bake_record *record, lmb_error *error)
{
    bake_report report = {.phase = LMB_PHASE_LOAD, .phase_start = lmb_clock_seconds()};
    report.listener = listener ? *listener : (lmb_bake_listener){.progress = NULL};
    const lmb_progress progress = {report_progress, &report};
    lmb_level level;
    lmb_result result = lmb_level_open(&settings->level, &report.listener.warnings, &progress, &level, error);
    if (result != LMB_OK) {
        return result;
    }
    lmb_bake bake = lmb_bake_begin(settings, &level, &progress);
    result = bake_prepare(&bake, &report, error);
    if (result == LMB_OK && folder) {
        result = bake_finish(&bake, folder, error);
    } else if (result == LMB_OK) {
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
    if (!folder || lmb_bake_folder_lightmaps(folder) != settings->lightmaps) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "the folder was not opened for this bake");
    }
    if (!settings->level.path) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "no level");
    }
    return bake_level(settings, folder, listener, record, error);
}

lmb_result lmb_bake_plan(const lmb_bake_settings *settings, const lmb_bake_listener *listener, lmb_bake_record *record,
                         lmb_error *error)
{
    return settings->level.path ? bake_level(settings, NULL, listener, record, error)
                                : lmb_error_set(error, LMB_ERROR_ARGUMENT, "no level");
}
