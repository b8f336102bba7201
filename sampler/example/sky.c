/* Light under a sky that changes, from volumes that were baked under the basis of skies:
 *
 *     sky X Y Z FILE.lmb FILE.lmb FILE.lmb FILE.lmb [five more]
 *
 * bakes of `--env sky-basis:0` to `sky-basis:3`, or to `sky-basis:8`, in this order. The sky of this program turns from
 * noon to an evening that is red in the west, -X. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <lambent/hlsh.h>
#include <lambent/sky.h>

/* Radiance of the sky in a direction, `evening` from 0 to 1. */
static lmb_rgb sky_radiance(lmb_vec3 d, float evening)
{
    const float up = d.y > 0.0f ? d.y : 0.0f, west = d.x < 0.0f ? d.x * d.x : 0.0f;
    const lmb_rgb day = {{0.3f + 0.1f * (1.0f - up), 0.5f + 0.1f * (1.0f - up), 1.0f}};
    const lmb_rgb dusk = {{0.1f + 1.0f * west, 0.1f + 0.4f * west, 0.2f + 0.1f * west}};
    lmb_rgb radiance;
    for (int c = 0; c < 3; ++c) {
        radiance.c[c] = day.c[c] + evening * (dusk.c[c] - day.c[c]);
    }
    return radiance;
}

/* Once for each new sky: what it is in harmonics. */
static lmb_sh3_rgb sky_harmonics(float evening)
{
    enum { COUNT = 512 };
    lmb_sh3_rgb sky = {{{{0.0f}}}};
    for (int i = 0; i < COUNT; ++i) { /* directions of equal shares of the sphere */
        const float y = 1.0f - (2.0f * (float)i + 1.0f) / COUNT, turn = 2.39996323f * (float)i;
        const float flat = sqrtf(1.0f - y * y);
        const lmb_vec3 d = {flat * cosf(turn), y, flat * sinf(turn)};
        lmb_rgb light = sky_radiance(d, evening);
        for (int c = 0; c < 3; ++c) {
            light.c[c] *= 12.5663706f / COUNT;
        }
        lmb_sh3_rgb_add_light(&sky, d, light);
    }
    return sky;
}

static void evenings_print(const lmb_volume *const *volume, uint32_t count, lmb_vec3d position)
{
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    for (int hour = 0; hour <= 4; ++hour) {
        const lmb_sh3_rgb sky = sky_harmonics(0.25f * (float)hour);
        lmb_rgb weight[LMB_SKY_QUADRATIC];
        lmb_sky_weights(&sky, count, weight);

        lmb_sh3_rgb radiance; /* for each object, with the weights of the sky */
        const bool inside = lmb_volume_blend_rgb(volume, weight, count, position, &radiance);
        const lmb_hlsh_rgb model = lmb_hlsh_rgb_from_probe(&radiance, up, 0.0f);
        const lmb_rgb light = lmb_hlsh_rgb_evaluate(&model, up, up);
        printf("evening %.2f %s  %.4f %.4f %.4f\n", 0.25 * hour, inside ? "inside " : "outside", (double)light.c[0],
               (double)light.c[1], (double)light.c[2]);
    }
}

int main(int count, char **values)
{
    lmb_volume *opened[LMB_SKY_QUADRATIC];
    const lmb_volume *volume[LMB_SKY_QUADRATIC];
    const uint32_t volumes = count > 4 ? (uint32_t)count - 4 : 0;
    if (volumes != LMB_SKY_LINEAR && volumes != LMB_SKY_QUADRATIC) {
        fprintf(stderr, "usage: sky X Y Z FILE.lmb... (4 or 9 of them)\n");
        return 2;
    }
    for (uint32_t k = 0; k < volumes; ++k) {
        const lmb_result result = lmb_volume_open_file(values[4 + k], &opened[k]);
        if (result != LMB_OK) {
            fprintf(stderr, "sky: %s: %s\n", values[4 + k], lmb_result_text(result));
            return 1;
        }
        volume[k] = opened[k];
    }
    evenings_print(volume, volumes, (lmb_vec3d){atof(values[1]), atof(values[2]), atof(values[3])});
    for (uint32_t k = 0; k < volumes; ++k) {
        lmb_volume_close(opened[k]);
    }
    return 0;
}
