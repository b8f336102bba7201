/* A game's first lines with Lambent: every part of the sampler is there, and links without help. */
#include <lambent/hhd.h>
#include <lambent/hlsh.h>
#include <lambent/occlusion.h>
#include <lambent/sh.h>
#include <lambent/version.h>
#include <lambent/volume.h>

#include <stdio.h>

int main(void)
{
    static const _Alignas(16) char not_a_volume[256] = "glTF";
    lmb_volume *volume = NULL;
    const lmb_result result = lmb_volume_open_memory(not_a_volume, sizeof not_a_volume, &volume);
    printf("opening a glTF as a volume: %s\n", lmb_result_text(result));

    /* Constant radiance 1: l00 = 2 sqrt(pi), irradiance 1 everywhere. */
    lmb_sh3_rgb sky = {{{{0.0f}}}};
    for (int channel = 0; channel < 3; ++channel) {
        sky.channel[channel].c[0] = 3.5449077f;
    }
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    const lmb_rgb open_sky = lmb_sh3_rgb_irradiance(&sky, up);
    const lmb_irradz irradz = lmb_irradz_from_probe(&sky, up, 0.0f);
    const lmb_hlsh hlsh = lmb_hlsh_from_probe(&sky.channel[0], up, lmb_cone_cos_from_visibility(1.0f));
    printf("irradiance %g, from its hemisphere %g, HLSH %g\n", (double)open_sky.c[0], (double)irradz.irradiance_z.c[0],
           (double)lmb_hlsh_evaluate(&hlsh, up, up));
    const int is_right = lmb_version() == LMB_VERSION && result == LMB_ERROR_FORMAT && open_sky.c[0] > 0.999f &&
                         open_sky.c[0] < 1.001f && irradz.irradiance_z.c[0] > 0.9f && irradz.irradiance_z.c[0] < 1.1f;
    return is_right ? 0 : 1;
}
