/* How long the rest of a bake will take, over all its phases: from a trial of some probes and texels, and from how the
 * phase at hand gets on. */
#ifndef LMB_TOOLS_FORECAST_H
#define LMB_TOOLS_FORECAST_H

#include <stdbool.h>

#include "bake_phases.h"

/* What is forecast, in the order in which it runs. */
typedef enum lmb_forecast_step {
    FORECAST_PILOT,
    FORECAST_SURFACE,
    FORECAST_BOUNCES,
    FORECAST_PROBES,
    FORECAST_LIGHTMAPS,
    FORECAST_WRITE,
    FORECAST_STEPS
} lmb_forecast_step;

typedef struct lmb_forecast {
    bool known;                     /* false: nothing is forecast yet */
    double seconds[FORECAST_STEPS]; /* wall-clock, of each as a whole */
} lmb_forecast;

/* Traces probes and texels spread over the level, for a placed and laid out bake: the first time before its surfaces
 * are solved, roughly, and better after. @return LMB_ERROR_MEMORY */
lmb_result forecast_make(const lmb_bake *bake, lmb_forecast *forecast);

/* Seconds left of all when `phase`, as progress names it, is done in part after `elapsed` seconds. -1: not known. */
double forecast_left(const lmb_forecast *forecast, const char *phase, double done, double elapsed);

#endif
