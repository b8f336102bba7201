/* Models behind cones of visibility, as ambient occlusion gives them: the multiply by a cone beside what games have
 * done with the same knowledge. */
#ifndef LMB_TOOLS_MODELS_CONES_H
#define LMB_TOOLS_MODELS_CONES_H

#include "models.h"

/* What is made of a cone about an axis b that lets V of the surface's cosine-weighted visibility through. */
typedef enum models_cone_method {
    MODELS_CONE_OWN,  /* the model encoded behind the cone, about b */
    MODELS_CONE_AO,   /* the model of the hemisphere, times V */
    MODELS_CONE_BENT, /* the same where the normal is turned as the surface's is to b; of models of all light */
    MODELS_CONE_METHOD_COUNT
} models_cone_method;

const char *models_cone_method_name(models_cone_method method);

enum { MODELS_CONE_COSINES = 5, MODELS_CONE_TILTS = 3 };

extern const float models_cone_cosine[MODELS_CONE_COSINES]; /* of the half angle */
extern const float models_cone_tilt_deg[MODELS_CONE_TILTS]; /* of b from the surface's normal */

/* Median over environments, turns and shading normals of the error of luminance relative to the irradiance of the light
 * in the cone and above the horizon. The input is the whole sphere's SH3. */
typedef struct models_cone_row {
    const lmb_model *model;
    models_cone_method method;
    double median[MODELS_CONE_TILTS][MODELS_CONE_COSINES];
} models_cone_row;

typedef struct models_cone_report {
    models_cone_row *row;
    size_t row_count;
} models_cone_report;

/* As models_measure. */
lmb_result models_cones_measure(const models_settings *settings, const models_map *map, size_t map_count,
                                lmb_pool *pool, const lmb_progress *progress, models_cone_report *report);
void models_cones_free(models_cone_report *report);

#endif
