/* Two lights blended: their harmonics, of which a model is made afterwards, beside the wrong order, the channels of two
 * models blended. */
#ifndef LMB_TOOLS_MODELS_BLEND_H
#define LMB_TOOLS_MODELS_BLEND_H

#include "models.h"

/* Relative root mean square error of luminance, pooled over turns and normals of each environment, mean over
 * environments: of an environment half and half with the next one's next turn, as bright. The input is the whole
 * sphere's SH3, the truth the irradiance of both above the horizon. */
typedef struct models_blend_row {
    const lmb_model *model;
    double harmonics; /* blended, then solved */
    double channels;  /* solved, then blended */
} models_blend_row;

typedef struct models_blend_report {
    models_blend_row *row; /* of models that can be filtered */
    size_t row_count;
} models_blend_report;

/* As models_measure. */
lmb_result models_blend_measure(const models_settings *settings, const models_map *map, size_t map_count,
                                lmb_pool *pool, const lmb_progress *progress, models_blend_report *report);
void models_blend_free(models_blend_report *report);

#endif
