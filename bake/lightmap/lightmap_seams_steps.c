/* How far the two sides of seams are apart. */
#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "lightmap/lightmap_seams.h"

/* Steps are relative to the light there, or to this share of the mean over all seams. */
#define DARK_SHARE 0.01

static double side_light(const lmb_lightmap *lightmap, const lmb_seam_point *point, int side)
{
    float channel[LMB_MODEL_MOST_CHANNELS], visibility[LMB_KEY_LIGHTS_MOST];
    lmb_rgb light;
    lmb_lightmap_footprint_read(lightmap, &point->side[side], channel);
    lightmap->model->evaluate(channel, point->normal, &point->normal, 1, &light);
    lmb_lightmap_footprint_keys(lightmap, &point->side[side], visibility);
    for (uint32_t key = 0; key < lightmap->key_light_count; ++key) {
        light = lmb_rgb_add(
            light, lmb_key_light_irradiance(&lightmap->key_light[key], visibility[key], point->normal, point->normal));
    }
    return (double)(light.c[0] + light.c[1] + light.c[2]) / 3.0;
}

static int number_compare(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

lmb_result lmb_seams_measure(const lmb_seams *seams, const lmb_lightmap *lightmap, lmb_seam_steps *steps)
{
    const size_t count = seams->count;
    double *const step = malloc((count + 1) * sizeof *step), *const light = malloc((count + 1) * sizeof *light);
    *steps = (lmb_seam_steps){.edges = seams->edge_count};
    if (!step || !light) {
        free(step);
        free(light);
        return LMB_ERROR_MEMORY;
    }
    double mean = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const double a = side_light(lightmap, &seams->point[i], 0), b = side_light(lightmap, &seams->point[i], 1);
        step[i] = fabs(a - b);
        light[i] = 0.5 * (a + b);
        mean += light[i] / (double)count;
    }
    for (size_t i = 0; i < count && mean > 0.0; ++i) {
        step[i] /= fmax(light[i], DARK_SHARE * mean);
    }
    qsort(step, count, sizeof *step, number_compare);
    if (count > 0) {
        steps->median = step[count / 2];
        steps->p95 = step[count - 1 - count / 20];
    }
    free(step);
    free(light);
    return LMB_OK;
}

lmb_result lmb_lightmap_seam_steps(const lmb_lightmap *lightmap, const lmb_tracer *tracer, lmb_seam_steps *steps)
{
    lmb_seams seams;
    lmb_result result = lmb_seams_find(lightmap, tracer, &seams);
    if (result == LMB_OK) {
        result = lmb_seams_measure(&seams, lightmap, steps);
        lmb_seams_free(&seams);
    }
    return result;
}
