/* How well lighting models do: their error over turned environments, and their speed.
 *
 * Irradiance is compared on normals spread evenly over the hemisphere that the surface owns, with the truth that the
 * light above its horizon gives, in luminance and in colour. */
#ifndef LMB_TOOLS_MODELS_H
#define LMB_TOOLS_MODELS_H

#include <stdbool.h>

#include <lambent/pool.h>

#include "models_turn.h"

typedef struct models_settings {
    uint32_t turns;                /* of each environment */
    uint64_t seed;                 /* of turns; 0: the published ones */
    const lmb_model *const *model; /* NULL: the table */
    size_t model_count;
} models_settings;

models_settings models_settings_default(void);

/* Relative root mean square errors are pooled over turns and normals of one environment; `mean` and `max` are over
 * environments. */
typedef struct models_error {
    double mean;
    double max;
} models_error;

/* One model with one input. */
typedef struct models_row {
    const lmb_model *model;
    models_input input;
    bool is_default; /* what `bake` or `sample` takes of this input */
    models_error luminance;
    models_error colour; /* over the three channels */
    /* Of each normal's own error in luminance over the larger of its own reference and 1 % of the turn's mean one, over
     * all environments: median, 95th percentile, and the share above a tenth. */
    double median;
    double p95;
    double share_over_10pct;
    double ns_encode; /* of a colour, single thread */
    double ns_eval;   /* of a colour on one normal */
} models_row;

typedef struct models_report {
    models_row *row; /* input by input */
    size_t row_count;
} models_report;

/* Measures the errors, in parallel; the same for any number of threads. Speeds are left 0.
 * @return LMB_ERROR_MEMORY, LMB_ERROR_INTERRUPTED */
lmb_result models_measure(const models_settings *settings, const models_map *map, size_t map_count, lmb_pool *pool,
                          const lmb_progress *progress, models_report *report);
void models_report_free(models_report *report);

/* Measures the speeds of the same rows on light of `map`, on this thread: medians of repeats over many inputs.
 * @return LMB_ERROR_MEMORY, LMB_ERROR_INTERRUPTED */
lmb_result models_measure_speed(const models_settings *settings, const models_map *map, size_t map_count,
                                const lmb_progress *progress, models_report *report);

/* Whether a model is measured with an input: every one that is made of SH3, others with the light above the horizon. A
 * texel's SH3 means nothing below the horizon: rows with a use have that of lightmaps, others clip what they are given.
 */
bool models_row_exists(const lmb_model *model, models_input input);

/* What a model gives of one input of a turn; `normal`: models_normals. */
void models_apply(const lmb_model *model, models_input input, const models_turn *turn,
                  const lmb_vec3 normal[MODELS_NORMAL_COUNT], lmb_rgb irradiance[MODELS_NORMAL_COUNT]);

#endif
