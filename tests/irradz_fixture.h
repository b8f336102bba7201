/* Texels of the default model of lightmaps, as the sampler knows them. */
#ifndef LMB_TESTS_IRRADZ_FIXTURE_H
#define LMB_TESTS_IRRADZ_FIXTURE_H

#include <string.h>

#include <lambent/hhd.h>
#include <lambent/lightmap.h>

static inline lmb_irradz irradz_of(const float *channel)
{
    return (lmb_irradz){{{channel[0], channel[1], channel[2]}}, channel[6], {channel[3], channel[4], channel[5]}};
}

static inline lmb_irradz image_irradz(const lmb_lightmap_image *image, size_t pixel)
{
    float channel[7];
    for (int c = 0; c < 7; ++c) {
        channel[c] = lmb_lightmap_plane(image, c)[pixel];
    }
    return irradz_of(channel);
}

static inline void image_set_irradz(const lmb_lightmap_image *image, size_t pixel, const lmb_irradz *texel)
{
    const float channel[7] = {texel->irradiance_z.c[0], texel->irradiance_z.c[1], texel->irradiance_z.c[2],
                              texel->direction.x,       texel->direction.y,       texel->direction.z,
                              texel->ambient_weight};
    for (int c = 0; c < 7; ++c) {
        lmb_lightmap_plane(image, c)[pixel] = channel[c];
    }
}

static inline lmb_irradz sample_irradz(const lmb_lightmap *lightmap, uint32_t instance, uint32_t triangle, float u,
                                       float v)
{
    const lmb_hit hit = {.instance = instance, .triangle = triangle, .u = u, .v = v};
    float channel[LMB_MODEL_MOST_CHANNELS];
    lmb_lightmap_sample(lightmap, &hit, channel);
    return irradz_of(channel);
}

/* Whether two images of a model hold the same. */
static inline bool images_equal(const lmb_model *model, const lmb_lightmap_image *a, const lmb_lightmap_image *b)
{
    const size_t texels = (size_t)a->width * (size_t)a->height;
    return a->width == b->width && a->height == b->height &&
           memcmp(a->plane, b->plane, (size_t)model->channel_count * texels * sizeof *a->plane) == 0 &&
           memcmp(a->state, b->state, texels) == 0;
}

#endif
