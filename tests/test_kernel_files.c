/* The kernels of this build give the bits of plain C on the golden volumes: for builds that have the sampler alone.
 * test_sample_kernels has more volumes. */
#include "harness.h"

#include <lambent/volume.h>

#include "volume_internal.h"

enum { POSITIONS = 3000 };

/* All over the box and a little beyond. */
static lmb_vec3d position_at(const lmb_volume_info *info, int i)
{
    const double x = i * 0.754877666, y = i * 0.569840291, z = i * 0.362745098; /* no lattice of few points */
    const lmb_vec3d low = info->bounds_min, high = info->bounds_max;
    return (lmb_vec3d){low.x + (1.1 * (x - floor(x)) - 0.05) * (high.x - low.x),
                       low.y + (1.1 * (y - floor(y)) - 0.05) * (high.y - low.y),
                       low.z + (1.1 * (z - floor(z)) - 0.05) * (high.z - low.z)};
}

static void file_check(const lmb_volume_kernel *kernel, const char *path)
{
    static lmb_vec3d position[POSITIONS];
    static lmb_sh3_rgb radiance[POSITIONS];
    static float visibility[POSITIONS][LMB_KEY_LIGHTS_MOST];
    static bool inside[POSITIONS];
    lmb_volume *volume = NULL;
    CHECK(lmb_volume_open_file(path, &volume) == LMB_OK, "%s", path);
    if (!volume) {
        return;
    }
    const lmb_volume_info info = lmb_volume_get_info(volume);
    for (int i = 0; i < POSITIONS; ++i) {
        position[i] = position_at(&info, i);
    }
    const lmb_volume_calls *const plain = lmb_volume_kernel_calls(&lmb_volume_kernel_scalar, volume->header);
    const lmb_volume_calls *const fast = lmb_volume_kernel_calls(kernel, volume->header);
    fast->batch(volume, position, POSITIONS, radiance, visibility, inside);
    int found = 0;
    for (int i = 0; i < POSITIONS; ++i) {
        const lmb_vec3d at = position[i];
        lmb_sh3_rgb light;
        float seen[LMB_KEY_LIGHTS_MOST];
        const bool is_inside = plain->sample_with_keys(volume, at.x, at.y, at.z, &light, seen);
        CHECK(is_inside == inside[i] && memcmp(&light, &radiance[i], sizeof light) == 0 &&
                  memcmp(seen, visibility[i], sizeof seen) == 0,
              "%s, %s at (%.9g, %.9g, %.9g)", path, kernel->name, at.x, at.y, at.z);
        found += is_inside;
    }
    CHECK(found > POSITIONS / 20 && found < POSITIONS, "%s: %d positions are inside", path, found);
    lmb_volume_close(volume);
}

static void golden_files(void)
{
    const lmb_volume_kernel *const kernel = lmb_volume_kernel_choose();
    printf("     this processor: %s\n", kernel->name);
    file_check(kernel, LMB_GOLDEN_DIR "/small.lmb");
    file_check(kernel, LMB_GOLDEN_DIR "/small_keys.lmb");
    file_check(kernel, LMB_GOLDEN_DIR "/levels_3.lmb");
    file_check(kernel, LMB_GOLDEN_DIR "/levels_4.lmb");
    file_check(kernel, LMB_GOLDEN_DIR "/levels_5.lmb");
}

static const test_case table[] = {{"golden_files", golden_files}};
TEST_MAIN(table)
