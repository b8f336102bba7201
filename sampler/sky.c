#include <lambent/sky.h>

#include <assert.h>

#include "sh_internal.h"

void lmb_sky_basis(lmb_vec3 d, float radiance[LMB_SKY_QUADRATIC])
{
    radiance[0] = 1.0f;
    radiance[1] = 1.0f - d.y;
    radiance[2] = 1.0f + d.z;
    radiance[3] = 1.0f - d.x;
    radiance[4] = 1.0f + 2.0f * d.x * d.y;
    radiance[5] = 1.0f - 2.0f * d.y * d.z;
    radiance[6] = 3.0f * d.z * d.z;
    radiance[7] = 1.0f - 2.0f * d.x * d.z;
    radiance[8] = 1.0f + d.x * d.x - d.y * d.y;
    for (int k = 0; k < LMB_SKY_QUADRATIC; ++k) {
        radiance[k] = radiance[k] > 0.0f ? radiance[k] : 0.0f; /* directions are a few roundings longer than 1 */
    }
}

bool lmb_sky_weights(const lmb_sh3_rgb *sky, uint32_t count, lmb_rgb *weight)
{
    /* Function k of the basis is 1 + Y_k / LOWEST[k]. */
    static const float LOWEST[LMB_SKY_QUADRATIC] = {
        (float)LMB_SH_N0,  (float)LMB_SH_N1,         (float)LMB_SH_N1,
        (float)LMB_SH_N1,  (float)(0.5 * LMB_SH_N2), (float)(0.5 * LMB_SH_N2),
        (float)LMB_SH_N20, (float)(0.5 * LMB_SH_N2), (float)LMB_SH_N22};
    assert(sky && weight);
    if (count != LMB_SKY_LINEAR && count != LMB_SKY_QUADRATIC) {
        return false;
    }
    for (int channel = 0; channel < 3; ++channel) {
        const float *const c = sky->channel[channel].c;
        weight[0].c[channel] = c[0] * LOWEST[0];
        for (uint32_t k = 1; k < count; ++k) {
            weight[k].c[channel] = c[k] * LOWEST[k];
            weight[0].c[channel] -= weight[k].c[channel];
        }
    }
    return true;
}
