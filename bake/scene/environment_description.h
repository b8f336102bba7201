/* What the text that describes an environment says (lambent/environment.h). */
#ifndef LMB_ENVIRONMENT_DESCRIPTION_H
#define LMB_ENVIRONMENT_DESCRIPTION_H

#include <stdbool.h>

#include <lambent/error.h>
#include <lambent/scene.h>

typedef struct lmb_environment_description {
    char *source; /* path, #rrggbb, sky-basis:K or none; NULL for daylight */
    float rotation_rad;
    float strength;
    char set[LMB_LIGHT_SET_NAME]; /* of lights; empty: none is named */
    double turbidity;             /* from here on of daylight */
    double ground;                /* albedo */
    double to_sun[3];
} lmb_environment_description;

/* @return LMB_ERROR_FORMAT, _MEMORY */
lmb_result lmb_environment_describe(const char *text, lmb_environment_description *described, lmb_error *error);

void lmb_environment_description_free(lmb_environment_description *described);

#endif
