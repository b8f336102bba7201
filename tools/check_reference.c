#include "check_reference.h"

#include <math.h>

#include "check_statistics.h"
#include "replicates.h"

/* Adds `count` samples after the first `done` to the means of both halves. */
static void reference_add(const check_reference *reference, const lmb_gather_point *point, const lmb_vec3 *normals,
                          uint32_t done, uint32_t count, irradiance_set half[2])
{
    const float share = (float)count / (float)(done + count);
    uint64_t unused = 0;
    for (uint32_t i = 0; i < 2; ++i) {
        const lmb_gather_samples samples = {.points = point,
                                            .point_count = 1,
                                            .replicate = REPLICATES_CHECK + i,
                                            .first = done,
                                            .count = count,
                                            .without_keys = reference->without_keys};
        irradiance_set more;
        lmb_gather_irradiance(reference->transport, &samples, normals, CHECK_NORMALS, more.at, &unused);
        for (int k = 0; k < CHECK_NORMALS; ++k) {
            for (int c = 0; c < 3; ++c) {
                const float mean = done > 0 ? half[i].at[k].c[c] : 0.0f;
                half[i].at[k].c[c] = mean + share * (more.at[k].c[c] - mean);
            }
        }
    }
}

/* Whether the halves differ by less than their mean may err. */
static bool reference_is_known(const check_reference *reference, const irradiance_set half[2])
{
    double noise = 0.0, light = 0.0;
    for (int k = 0; k < CHECK_NORMALS; ++k) {
        for (int c = 0; c < 3; ++c) {
            const double a = (double)half[0].at[k].c[c], b = (double)half[1].at[k].c[c];
            noise += 0.25 * (a - b) * (a - b);
            light += 0.25 * (a + b) * (a + b);
        }
    }
    const double count = 3.0 * CHECK_NORMALS;
    const double own = fmax(sqrt(light / count), CHECK_DARK_SHARE * reference->mean_light);
    return sqrt(noise / count) <= CHECK_REFERENCE_NOISE * own;
}

void check_reference_gather(const check_reference *reference, const lmb_gather_point *point, const lmb_vec3 *normals,
                            irradiance_set half[2])
{
    const uint64_t most = (uint64_t)CHECK_MORE_SAMPLES * reference->samples;
    uint32_t done = 0, count = reference->samples;
    do {
        reference_add(reference, point, normals, done, count, half);
        done += count;
        count = done;
    } while (done + (uint64_t)count <= most && !reference_is_known(reference, half));
}
