/* How long the rest of a bake will take, over all its phases: from a trial of some probes and texels, and from how the
 * phase at hand gets on. */
#ifndef LMB_FORECAST_H
#define LMB_FORECAST_H

#include <stdbool.h>

#include <lambent/bake_phases.h>

typedef struct lmb_forecast {
    bool known;                      /* false: nothing is forecast yet */
    double seconds[LMB_PHASE_COUNT]; /* wall-clock, of each as a whole, from LMB_PHASE_PILOT on */
} lmb_forecast;

/* Traces probes and texels spread over the level, for a placed and laid out bake: the first time before its surfaces
 * are solved, roughly, and better after. @return LMB_ERROR_MEMORY */
lmb_result lmb_forecast_make(const lmb_bake *bake, lmb_forecast *forecast);

/* Seconds left of all when `phase` is done in part after `elapsed` seconds. -1: not known. */
double lmb_forecast_left(const lmb_forecast *forecast, lmb_bake_phase phase, double done, double elapsed);

#endif
