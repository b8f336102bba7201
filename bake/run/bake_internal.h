/* A whole bake's steps, and what they report: of one (bake.c) and of several of one level (bake_sets.c). */
#ifndef LMB_BAKE_INTERNAL_H
#define LMB_BAKE_INTERNAL_H

#include <lambent/bake.h>
#include <lambent/bake_phases.h>

#include "run/forecast.h"

/* Between the work, which names what it does, and who listens to the bake. */
typedef struct lmb_bake_report {
    lmb_bake_listener listener;
    lmb_forecast forecast;
    lmb_bake_phase phase;
    double phase_start;
} lmb_bake_report;

/* From the first phase on; what the phases report to, which points to `report`. */
lmb_progress lmb_bake_report_begin(lmb_bake_report *report, const lmb_bake_listener *listener);

/* What sets of lights share: all up to the light on surfaces. `report` NULL, here and below: without the layout of
 * lightmaps and a forecast. */
lmb_result lmb_bake_geometry(lmb_bake *bake, lmb_bake_report *report, lmb_error *error);

/* The light on surfaces, and what it decides before light is gathered. */
lmb_result lmb_bake_light(lmb_bake *bake, lmb_bake_report *report, lmb_error *error);

/* Gathers, and writes; a shard leaves its part. `asked`: the settings as they were given. */
lmb_result lmb_bake_finish(lmb_bake *bake, const lmb_bake_settings *asked, const lmb_bake_work *work,
                           lmb_bake_folder *folder, lmb_error *error);

#endif
