/* Moves an object along a line through a baked volume and prints the light on it: moving_object FILE.lmb */
#include <stdio.h>

#include <lambent/hhd.h>
#include <lambent/hlsh.h>
#include <lambent/key_light.h>
#include <lambent/occlusion.h>
#include <lambent/volume.h>

int main(int count, char **values)
{
    lmb_volume *volume;
    const lmb_result opened = count == 2 ? lmb_volume_open_file(values[1], &volume) : LMB_ERROR_ARGUMENT;
    if (opened != LMB_OK) {
        fprintf(stderr, "moving_object: %s: %s\n", count == 2 ? values[1] : "FILE.lmb", lmb_result_text(opened));
        return 1;
    }
    lmb_key_light suns[LMB_KEY_LIGHTS_MOST]; /* kept apart from the harmonics, which blur */
    const uint32_t sun_count = lmb_volume_key_lights(volume, suns);
    const lmb_volume_info info = lmb_volume_get_info(volume);
    const lmb_vec3d low = info.bounds_min, high = info.bounds_max;
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};                /* the surface's own normal, n_v */
    const lmb_vec3 bump = {0.6f, 0.8f, 0.0f};              /* the normal from the normal map, n */
    const float cone = lmb_cone_cos_from_visibility(0.7f); /* ambient occlusion: 70 % is open */
    for (int step = 0; step <= 10; ++step) {
        const double t = step / 10.0;
        const lmb_vec3d position = {low.x + t * (high.x - low.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z)};

        lmb_sh3_rgb radiance;            /* once a frame for each object, */
        float seen[LMB_KEY_LIGHTS_MOST]; /* with the share of each sun that is seen from there */
        const bool inside = lmb_volume_sample_with_keys(volume, position, &radiance, seen);

        /* Full quality: occlusion by the surface's hemisphere and an AO cone, for each pixel. */
        const lmb_hlsh_rgb occluded = lmb_hlsh_rgb_from_probe(&radiance, up, cone);
        const lmb_rgb pixel = lmb_hlsh_rgb_evaluate(&occluded, up, bump);

        /* Low end: solve for each vertex to a hemisphere and a highlight direction, as the lightmaps hold it. */
        const lmb_irradz vertex = lmb_irradz_from_probe(&radiance, up, cone);
        const lmb_hhd_rgb light = lmb_irradz_decode(&vertex, up);
        const lmb_rgb cheap = lmb_hhd_rgb_evaluate(&light, up, bump);

        /* Beside either: the suns, for each pixel, unless the game lights with its own. */
        lmb_rgb sunlight = {{0.0f, 0.0f, 0.0f}};
        for (uint32_t i = 0; i < sun_count; ++i) {
            sunlight = lmb_rgb_add(sunlight, lmb_key_light_irradiance(&suns[i], seen[i], up, bump));
        }

        printf("x %7.2f %s  HLSH %.4f %.4f %.4f  HHD %.4f %.4f %.4f  suns %.4f %.4f %.4f\n", position.x,
               inside ? "inside " : "outside", (double)pixel.c[0], (double)pixel.c[1], (double)pixel.c[2],
               (double)cheap.c[0], (double)cheap.c[1], (double)cheap.c[2], (double)sunlight.c[0], (double)sunlight.c[1],
               (double)sunlight.c[2]);
    }
    lmb_volume_close(volume);
    return 0;
}
