/* How far light at places is from what it should be, for measurements: by irradiance over normals all around. */
#ifndef LMB_TOOLS_IRRADIANCE_ERROR_H
#define LMB_TOOLS_IRRADIANCE_ERROR_H

#include <stddef.h>

#include <lambent/result.h>
#include <lambent/sh.h>

/* Relative errors of irradiance over 14 normals, those of a cube's faces and corners. */
typedef struct irradiance_error {
    double rms;    /* root of the mean square over all places, to that of the light */
    double median; /* of places, each relative to its own light */
    double p95;    /* 95 in 100 of them have less */
} irradiance_error;

/* Of `made` at `count` places; those where the truth is dark count in `rms` alone. @return LMB_ERROR_MEMORY */
lmb_result irradiance_error_find(const lmb_sh3_rgb *truth, const lmb_sh3_rgb *made, size_t count,
                                 irradiance_error *error);

#endif
