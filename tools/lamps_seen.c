#include "lamps_seen.h"

#include <lambent/specular.h>

/* Keeps the strongest in order. */
static void lamp_insert(const lmb_key_light *lamp, lamps_seen *lamps)
{
    const float light = lmb_luminance(lamp->irradiance);
    uint32_t at = lamps->count;
    while (at > 0 && lmb_luminance(lamps->light[at - 1].irradiance) < light) {
        --at;
    }
    if (at == LAMPS_MOST) {
        return;
    }
    lamps->count += lamps->count < LAMPS_MOST;
    for (uint32_t i = lamps->count - 1; i > at; --i) {
        lamps->light[i] = lamps->light[i - 1];
    }
    lamps->light[at] = *lamp;
}

void lamps_take(const lmb_emitters *emitters, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance,
                lamps_seen *lamps)
{
    static const float choice[2] = {0.5f, 0.5f};
    const lmb_punctual_query query = {
        .position = position, .normal = normal, .skip_indirect_only = true, .skip_keys = true, .point = {0.5f, 0.5f}};
    lmb_punctual_sample sample[2 * LMB_PUNCTUAL_MAX];
    *lamps = (lamps_seen){.present = lmb_emitters_have_punctual(emitters, true)};
    const int count = lamps->present ? lmb_emitters_punctual(emitters, &query, choice, LMB_PUNCTUAL_MAX, sample) : 0;
    for (int i = 0; i < count; ++i) {
        /* Of many each stands for others too, which have their highlights elsewhere. */
        const float own = 1.0f / (LMB_PI_F * sample[i].weight);
        lamp_insert(&(lmb_key_light){sample[i].direction, lmb_rgb_scale(sample[i].irradiance, own)}, lamps);
    }
    for (uint32_t i = 0; i < lamps->count; ++i) {
        lamps->visibility[i] = lmb_sh3_rgb_light_visibility(radiance, &lamps->light[i]);
        lmb_key_light_add_to_sh3(&lamps->light[i], -lamps->visibility[i], radiance);
    }
}
