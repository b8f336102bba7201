/* Blends volumes of one level, each of a set of lights, and prints the light at a point:
 *
 *     light_sets X Y Z FILE.lmb WEIGHT [FILE.lmb WEIGHT]...
 *
 * A lamp that is dimmed is its own set with a weight. A door that opens is two: what comes in through the open one,
 * with a weight that goes from 0 to 1, beside what is there when it is closed, whose weight goes to 0. */
#include <stdio.h>
#include <stdlib.h>

#include <lambent/hlsh.h>
#include <lambent/volume.h>

enum { MOST = 8 };

int main(int count, char **values)
{
    const lmb_volume *volume[MOST];
    lmb_volume *opened[MOST];
    float weight[MOST];
    uint32_t sets = 0;
    if (count < 6 || count % 2 != 0 || count > 4 + 2 * MOST) {
        fprintf(stderr, "usage: light_sets X Y Z FILE.lmb WEIGHT [FILE.lmb WEIGHT]...\n");
        return 2;
    }
    for (int i = 4; i < count; i += 2, ++sets) {
        const lmb_result result = lmb_volume_open_file(values[i], &opened[sets]);
        if (result != LMB_OK) {
            fprintf(stderr, "light_sets: %s: %s\n", values[i], lmb_result_text(result));
            return 1;
        }
        volume[sets] = opened[sets];
        weight[sets] = (float)atof(values[i + 1]);
    }
    const lmb_vec3d position = {atof(values[1]), atof(values[2]), atof(values[3])};
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};

    /* Harmonics are added first, and a model is made of the sum: never the other way round. */
    lmb_sh3_rgb radiance;
    const bool inside = lmb_volume_blend(volume, weight, sets, position, &radiance);
    const lmb_hlsh_rgb model = lmb_hlsh_rgb_from_probe(&radiance, up, 0.0f);
    const lmb_rgb light = lmb_hlsh_rgb_evaluate(&model, up, up);

    printf("%s  %.4f %.4f %.4f\n", inside ? "inside" : "outside", (double)light.c[0], (double)light.c[1],
           (double)light.c[2]);
    for (uint32_t i = 0; i < sets; ++i) {
        lmb_volume_close(opened[i]);
    }
    return 0;
}
