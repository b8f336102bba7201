/* Error of stored light against a noisy reference, free of the reference's own noise.
 *
 * The reference comes as two independent halves r1 and r2. For any x that is independent of them,
 *
 *     E[(x - r1)(x - r2)] = (x - r)^2      and      E[r1 r2] = r^2,
 *
 * so the two means give the relative root mean square error without the reference's variance. Everything is kept for
 * each point apart and summed in the points' order: the figures do not depend on who computed what. */
#ifndef LMB_TOOLS_CHECK_STATISTICS_H
#define LMB_TOOLS_CHECK_STATISTICS_H

#include <stdbool.h>
#include <stddef.h>

#include <lambent/result.h>
#include <lambent/types.h>

/* One point's share: means over its normals and channels. */
typedef struct point_error {
    double product;   /* of (x - r1)(x - r2) */
    double reference; /* of r1 r2 */
    double own;       /* of ((r1 + r2)/2)^2 */
} point_error;

/* `x`, `r1`, `r2`: irradiance on each of `normal_count` normals of one point. When the reference is free of noise, r1
 * and r2 may be the same array. */
point_error point_error_of(const lmb_rgb *x, const lmb_rgb *r1, const lmb_rgb *r2, int normal_count);

/* The least that a point's own error is relative to, as a share of the mean over points of the reference's root mean
 * square there; and the share of its own light by which a point is off for an eye to see it. */
#define CHECK_DARK_SHARE 0.01
#define CHECK_VISIBLE_SHARE 0.1

/* What a few bright points decide, and what an eye would see: the latter of each point's own error,
 * sqrt(max(0, product)), relative to its own reference, sqrt(own), or to CHECK_DARK_SHARE of the mean over points of
 * that if it is more. A single point's product is free of the reference's noise only on average: it spreads p95 and
 * max, and hardly moves the median. NaN: no points, or a reference without light. */
typedef struct error_summary {
    double rel_rmse;         /* sqrt(max(0, mean product) / mean reference) */
    double std_error;        /* of rel_rmse, from the spread between points */
    double median;           /* of the points' own errors */
    double p95;              /* their 95th percentile */
    double share_over_10pct; /* share of points whose own error is above CHECK_VISIBLE_SHARE */
    double max;              /* the largest */
} error_summary;

/* Of the points that `has` marks; NULL: of all. @return LMB_ERROR_MEMORY */
lmb_result error_summarize(const point_error *errors, const bool *has, size_t count, error_summary *summary);

/* What a point tells about the reference itself and about leaks. */
typedef struct point_light {
    double reference;         /* mean of (r1 + r2)/2 over normals and channels */
    double reference_noise;   /* mean of (r1 - r2)^2 / 4: variance of (r1 + r2)/2 */
    double reference_product; /* mean of r1 r2 */
    double excess;            /* mean of max(0, x - (r1 + r2)/2) */
} point_light;

point_light point_light_of(const lmb_rgb *x, const lmb_rgb *r1, const lmb_rgb *r2, int normal_count);

/* A point counts as dark when its reference is below this share of the mean reference. */
#define LEAK_DARK_SHARE 0.01

typedef struct leak_summary {
    double leak; /* mean excess over dark points, over the mean reference; 0 when there are none */
    size_t dark_points;
    double reference_mean;      /* NaN without points */
    double reference_std_error; /* root mean square of the reference's standard error, over its root mean square */
} leak_summary;

/* Of the points that `has` marks; NULL: of all. */
leak_summary leak_summarize(const point_light *lights, const bool *has, size_t count);

#endif
