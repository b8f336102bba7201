#include "irradiance_error.h"

#include <stdlib.h>

#include <lambent/vector.h>

enum { NORMALS = 14 };

static void normals_make(lmb_vec3 normal[NORMALS])
{
    const float corner = 0.57735027f;
    for (int i = 0; i < 8; ++i) {
        normal[i] = lmb_vec3_of(i & 1 ? corner : -corner, i & 2 ? corner : -corner, i & 4 ? corner : -corner);
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            const float length = side ? -1.0f : 1.0f;
            normal[8 + 2 * axis + side] =
                lmb_vec3_of(axis == 0 ? length : 0.0f, axis == 1 ? length : 0.0f, axis == 2 ? length : 0.0f);
        }
    }
}

lmb_result irradiance_error_find(const lmb_sh3_rgb *truth, const lmb_sh3_rgb *made, size_t count,
                                 error_summary *summary)
{
    point_error *const error = malloc((count + 1) * sizeof *error);
    if (!error) {
        return LMB_ERROR_MEMORY;
    }
    lmb_vec3 normal[NORMALS];
    normals_make(normal);
    for (size_t i = 0; i < count; ++i) {
        lmb_rgb found[NORMALS], right[NORMALS];
        for (int n = 0; n < NORMALS; ++n) {
            found[n] = lmb_sh3_rgb_irradiance(&made[i], normal[n]);
            right[n] = lmb_sh3_rgb_irradiance(&truth[i], normal[n]);
        }
        error[i] = point_error_of(found, right, right, NORMALS);
    }
    const lmb_result result = error_summarize(error, NULL, count, summary);
    free(error);
    return result;
}
