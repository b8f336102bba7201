/* Probes in an object's own frame, where a light that is linear in space is known everywhere. */
#include <lambent/local_set.h>

#include "harness.h"
#include "probes_fixture.h"

#include <lambent/pack.h>
#include <lambent/vector.h>

#include <math.h>
#include <stdlib.h>

/* The first coefficient of each channel: linear, so that interpolation is exact. */
static double light_at(lmb_vec3d p, int channel)
{
    return 5.0 + (channel + 1) * (0.25 * p.x - 0.5 * p.y + 0.125 * p.z);
}

/* A box of 2 x 1 x 3 m, turned by 30 degrees about +Y. */
static lmb_local_frame frame_make(const uint32_t size[3])
{
    const float c = 0.8660254f, s = 0.5f;
    const lmb_vec3 half[3] = {{c, 0.0f, -s}, {0.0f, 0.5f, 0.0f}, {1.5f * s, 0.0f, 1.5f * c}};
    return lmb_local_frame_of_box((lmb_vec3d){0.3, 0.2, -0.1}, half, size);
}

static lmb_volume *volume_make(unsigned char **data)
{
    const lmb_lattice lattice = {.spacing = 0.5f, .min = {-6, -6, -6}, .size = {13, 13, 13}};
    lmb_probes *const probes = fixture_probes(&lattice, NULL);
    lmb_volume *volume = NULL;
    size_t bytes = 0;
    for (int32_t i = 0; probes && i < probes->count; ++i) {
        probes->validity[i] = 1.0f;
        for (int channel = 0; channel < 3; ++channel) {
            probes->radiance[0][i].channel[channel].c[0] =
                (float)light_at(lmb_lattice_position(&lattice, probes->point[i]), channel);
        }
    }
    CHECK(probes && lmb_pack(probes, data, &bytes, NULL) == LMB_OK &&
              lmb_volume_open_memory(*data, bytes, &volume) == LMB_OK,
          "volume");
    lmb_probes_destroy(probes);
    return volume;
}

static void probes_stand_at_corners(void)
{
    const uint32_t size[3] = {3, 1, 2};
    const lmb_local_frame frame = frame_make(size);
    CHECK(lmb_local_frame_count(&frame) == 6, "%u", lmb_local_frame_count(&frame));
    lmb_vec3d sum = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < 6; ++i) {
        const lmb_vec3d p = lmb_local_frame_position(&frame, i);
        sum = (lmb_vec3d){sum.x + p.x / 6, sum.y + p.y / 6, sum.z + p.z / 6};
    }
    CHECK_NEAR(sum.x, 0.3, 1e-6, "their mean is the box's middle");
    CHECK_NEAR(sum.y, 0.2, 1e-6, "their mean is the box's middle");
    CHECK_NEAR(sum.z, -0.1, 1e-6, "their mean is the box's middle");
    const lmb_vec3d last = lmb_local_frame_position(&frame, 5);
    CHECK_NEAR(last.x, 0.3 + 0.8660254 + 0.75, 1e-6, "the far corner");
    CHECK_NEAR(last.z, -0.1 - 0.5 + 1.5 * 0.8660254, 1e-6, "the far corner");
}

static void linear_light_is_kept(void)
{
    unsigned char *data = NULL;
    lmb_volume *const volume = volume_make(&data);
    const uint32_t sizes[2][3] = {{2, 2, 2}, {4, 3, 5}};
    for (int s = 0; volume && s < 2; ++s) {
        const lmb_local_frame frame = frame_make(sizes[s]);
        lmb_sh3_rgb radiance[64];
        float seen[64][LMB_KEY_LIGHTS_MOST];
        const uint32_t count = lmb_local_frame_count(&frame);
        CHECK(lmb_local_set_resample(volume, &frame, radiance, seen) == count, "all inside");
        for (int i = 0; i < 100; ++i) {
            /* Within the box: centre + a half of each axis at most. */
            const double a = fmod(0.618 * i, 1.0) - 0.5, b = fmod(0.414 * i, 1.0) - 0.5, c = fmod(0.732 * i, 1.0) - 0.5;
            const lmb_vec3d p = {0.3 + a * 0.8660254 * 2 + c * 1.5, 0.2 + b, -0.1 - a * 0.5 * 2 + c * 3.0 * 0.8660254};
            lmb_sh3_rgb light;
            lmb_local_set_sample(&frame, radiance, p, &light);
            for (int channel = 0; channel < 3; ++channel) {
                CHECK_NEAR(light.channel[channel].c[0], light_at(p, channel), 0.01, "point %d", i);
            }
        }
    }
    lmb_volume_close(volume);
    free(data);
}

/* Beyond the box the light is that of its border, and no position gives NaN. */
static void outside_is_the_border(void)
{
    const uint32_t size[3] = {2, 1, 1};
    const lmb_local_frame frame = frame_make(size);
    lmb_sh3_rgb radiance[2] = {{{{{1.0f}}}}, {{{{3.0f}}}}}, light;
    lmb_local_set_sample(&frame, radiance, (lmb_vec3d){100.0, 7.0, -100.0}, &light);
    CHECK(light.channel[0].c[0] == 3.0f, "%g", (double)light.channel[0].c[0]);
    lmb_local_set_sample(&frame, radiance, (lmb_vec3d){-1e30, 7.0, 0.0}, &light);
    CHECK(light.channel[0].c[0] == 1.0f, "%g", (double)light.channel[0].c[0]);
    lmb_local_set_sample(&frame, radiance, (lmb_vec3d){(double)NAN, (double)INFINITY, 0.0}, &light);
    CHECK(light.channel[0].c[0] >= 1.0f && light.channel[0].c[0] <= 3.0f, "%g", (double)light.channel[0].c[0]);
}

static const test_case cases[] = {
    {"probes stand at corners", probes_stand_at_corners},
    {"linear light is kept", linear_light_is_kept},
    {"outside is the border", outside_is_the_border},
};

TEST_MAIN(cases)
