/* Whether floats are fine enough for the texels. */
#include "lightmap/lightmap_internal.h"

#include <stdio.h>

/* Rays start 8 steps of floats off their surfaces (lmb_trace_epsilon): that must not be as far as a texel is wide. */
#define MOST_STEPS_OF_TEXEL 0.125f

void lmb_lightmap_warn_of_steps(const lmb_lightmap *lightmap)
{
    const lmb_scene *scene = lightmap->scene;
    uint32_t worst = 0, count = 0;
    float worst_share = MOST_STEPS_OF_TEXEL;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const float texel = lightmap->region[i].texel_size;
        const float share = texel > 0.0f ? scene->instances[i].position_step / texel : 0.0f;
        count += share > MOST_STEPS_OF_TEXEL;
        if (share > worst_share) {
            worst_share = share;
            worst = i;
        }
    }
    if (count == 0) {
        return;
    }
    char more[32] = "";
    if (count > 1) {
        snprintf(more, sizeof more, ", and %u more", count - 1);
    }
    lmb_warn(&lightmap->settings.warnings,
             "%s: floats tell positions apart by %.3g m only on '%s', whose texels are %.3g m wide%s: so far from the "
             "origin its light is not to be trusted",
             scene->path, (double)scene->instances[worst].position_step, scene->instances[worst].name,
             (double)lightmap->region[worst].texel_size, more);
}
