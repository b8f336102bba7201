#include "irradiance_error.h"

#include <math.h>
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

/* Squares of what a place is off and of its light, summed over normals and colours. */
static void place_measure(const lmb_sh3_rgb *truth, const lmb_sh3_rgb *made, const lmb_vec3 normal[NORMALS],
                          double *off, double *light)
{
    *off = *light = 0.0;
    for (int n = 0; n < NORMALS; ++n) {
        const lmb_rgb a = lmb_sh3_rgb_irradiance(made, normal[n]);
        const lmb_rgb b = lmb_sh3_rgb_irradiance(truth, normal[n]);
        for (int c = 0; c < 3; ++c) {
            *off += pow((double)a.c[c] - (double)b.c[c], 2.0);
            *light += pow((double)b.c[c], 2.0);
        }
    }
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

lmb_result irradiance_error_find(const lmb_sh3_rgb *truth, const lmb_sh3_rgb *made, size_t count,
                                 irradiance_error *error)
{
    double *const share = malloc((count + 1) * sizeof *share);
    if (!share) {
        return LMB_ERROR_MEMORY;
    }
    lmb_vec3 normal[NORMALS];
    normals_make(normal);
    double all_off = 0.0, all = 0.0;
    size_t lit = 0;
    for (size_t i = 0; i < count; ++i) {
        double off, light;
        place_measure(&truth[i], &made[i], normal, &off, &light);
        all_off += off;
        all += light;
        if (light > 0.0) {
            share[lit++] = sqrt(off / light);
        }
    }
    qsort(share, lit, sizeof *share, by_size);
    error->rms = all > 0.0 ? sqrt(all_off / all) : 0.0;
    error->median = lit > 0 ? share[lit / 2] : 0.0;
    error->p95 = lit > 0 ? share[lit * 95 / 100] : 0.0;
    free(share);
    return LMB_OK;
}
