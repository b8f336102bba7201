/* How far light at places is from what it should be, for measurements: by irradiance over normals all around. */
#ifndef LMB_TOOLS_IRRADIANCE_ERROR_H
#define LMB_TOOLS_IRRADIANCE_ERROR_H

#include <lambent/sh.h>

#include "check_statistics.h"

/* Of `made` at `count` places, over 14 normals: those of a cube's faces and corners. @return LMB_ERROR_MEMORY */
lmb_result irradiance_error_find(const lmb_sh3_rgb *truth, const lmb_sh3_rgb *made, size_t count,
                                 error_summary *summary);

#endif
