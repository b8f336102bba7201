/* What a way of interpolating probes gets wrong in a scene of rooms: what leaks, what it makes of a room's own light,
 * and the steps that it leaves. */
#ifndef LMB_TOOLS_LEAKS_MEASURE_H
#define LMB_TOOLS_LEAKS_MEASURE_H

#include "leaks_methods.h"

/* Where it is measured: at so many centimetres from surfaces that divide, or anywhere in a room. */
typedef enum leaks_kind { LEAKS_1_CM, LEAKS_10_CM, LEAKS_ANYWHERE, LEAKS_KINDS } leaks_kind;

typedef struct leaks_point {
    lmb_vec3 position;
    lmb_vec3 normal; /* of the surface nearby; 0 anywhere */
    leaks_kind kind;
    int home;          /* channel of the room's own light, 0 or 1 */
    lmb_sh3_rgb truth; /* gathered there */
} leaks_point;

/* A straight way within a room. */
typedef struct leaks_line {
    lmb_vec3 from, to;
    int home;
} leaks_line;

typedef struct leaks_places {
    leaks_point *point;
    size_t point_count;
    leaks_line *line;
    size_t line_count;
    double home_mean[2]; /* mean radiance of each channel where it is at home, anywhere, times 2 sqrt(pi) */
    bool open;           /* the foreign light of the truth is no leak */
} leaks_places;

/* Finds `points` points at each distance, a power of two, four times as many anywhere, and lines, and gathers the truth
 * with `samples` samples at each point.
 * @return LMB_ERROR_MEMORY; then there is nothing to free */
lmb_result leaks_places_make(const leaks_level *level, uint32_t points, uint32_t samples, leaks_places *places);
void leaks_places_free(leaks_places *places);

/* `home_mean` of points whose truth is known. */
void leaks_home_means(leaks_places *places);

/* Mean radiance is meant, or l0: what arrives from all sides. Of the two channels, or the rooms of either home, each
 * has the one that is worst. */
typedef struct leaks_errors {
    double leak;          /* mean of the foreign channel beyond its truth, over the mean that it has at home */
    double of_own;        /* the same over the own channel's mean there */
    double own_mean;      /* mean of the own channel over its truth, less 1 */
    double own_std_error; /* of that, from the spread between points */
    double own_rmse;      /* of the own channel's irradiance on six normals, relative to its truth */
} leaks_errors;

typedef struct leaks_figures {
    leaks_errors at[LEAKS_KINDS];
    double step; /* the largest along a line, over the room's own mean */
} leaks_figures;

/* A way of interpolating, made ready for a field. */
typedef struct leaks_sampler {
    const leaks_method *method;
    const void *state;
} leaks_sampler;

leaks_figures leaks_measure(const leaks_sampler *sampler, const leaks_places *places);

/* The largest step of any channel's mean radiance, times 2 sqrt(pi), between two ends of a line: what is left between
 * neighbouring points however near they are. */
double leaks_step(const leaks_sampler *sampler, lmb_vec3 from, lmb_vec3 to);

/* Nanoseconds of CPU time for a sample, the median of repeats over the points in their order, which is none. */
double leaks_time(const leaks_sampler *sampler, const leaks_places *places);

#endif
