/* Daylight as an environment: the sky as a picture, and the sun as a light beside it. */
#ifndef LMB_ENVIRONMENT_DAYLIGHT_H
#define LMB_ENVIRONMENT_DAYLIGHT_H

#include <lambent/environment.h>

#include "scene/environment_description.h"

/* Fills the picture, in kcd/m2: below the horizon is a ground of the albedo that is said, lit by sky and sun. `sun` is
 * what the description's rotation and strength make of it; its irradiance is 0 where it is below the horizon. Who looks
 * at the picture sees its disc. @return LMB_ERROR_MEMORY */
lmb_result lmb_environment_daylight(const lmb_environment_description *described, lmb_environment *environment,
                                    lmb_environment_sun *sun);

#endif
