/* One function of the basis of changing skies (lambent/sky.h) as an environment. */
#ifndef LMB_ENVIRONMENT_SKY_BASIS_H
#define LMB_ENVIRONMENT_SKY_BASIS_H

#include <lambent/scene.h>

#define LMB_SKY_BASIS "sky-basis:"

/* The function that an environment's source is, "sky-basis:0" to "sky-basis:8"; -1: none of them. */
int lmb_sky_basis_find(const char *source);

/* Fills the picture. @return LMB_ERROR_MEMORY */
lmb_result lmb_environment_sky_basis(int function, lmb_environment *environment);

#endif
