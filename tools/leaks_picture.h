/* A plan of a scene as one way of interpolating lights it. */
#ifndef LMB_TOOLS_LEAKS_PICTURE_H
#define LMB_TOOLS_LEAKS_PICTURE_H

#include "leaks_measure.h"

/* A PNG of the irradiance from above, a metre over the floor of the scene's first room, 4 cm a pixel, x to the right
 * and z downwards. A room's own mean is shown as half of full light; what is no room is grey.
 * @return LMB_ERROR_WRITE, _MEMORY */
lmb_result leaks_picture_write(const char *path, const leaks_level *level, const leaks_sampler *sampler,
                               const leaks_places *places, lmb_error *error);

#endif
