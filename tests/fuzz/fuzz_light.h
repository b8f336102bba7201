/* What a volume may give, and where the fuzz targets ask. */
#ifndef LMB_TESTS_FUZZ_LIGHT_H
#define LMB_TESTS_FUZZ_LIGHT_H

#include <math.h>
#include <stdbool.h>

#include <lambent/key_light.h>
#include <lambent/sh.h>
#include <lambent/vector.h>

static inline bool light_is_finite(const lmb_sh3_rgb *light)
{
    bool finite = true;
    for (int i = 0; i < 27; ++i) {
        finite = finite && isfinite(light->channel[i / 9].c[i % 9]);
    }
    return finite;
}

static inline bool seen_is_a_share(const float seen[LMB_KEY_LIGHTS_MOST])
{
    bool good = true;
    for (int i = 0; i < LMB_KEY_LIGHTS_MOST; ++i) {
        good = good && seen[i] >= 0.0f && seen[i] <= 1.0f;
    }
    return good;
}

/* Within the bounds, around them, and at places that no level has. */
static inline lmb_vec3d fuzz_position(lmb_vec3d low, lmb_vec3d high, int i)
{
    static const double odd[] = {0.0, NAN, INFINITY, -INFINITY, 1e300, -1e30, 1e-310, 0.5};
    if (i < 8) {
        return (lmb_vec3d){odd[i], odd[(i + 1) % 8], odd[(i + 3) % 8]};
    }
    const double x = fmod(0.754877666 * i, 1.0), y = fmod(0.569840291 * i, 1.0), z = fmod(0.438579021 * i, 1.0);
    return (lmb_vec3d){low.x + (1.2 * x - 0.1) * (high.x - low.x), low.y + (1.2 * y - 0.1) * (high.y - low.y),
                       low.z + (1.2 * z - 0.1) * (high.z - low.z)};
}

#endif
