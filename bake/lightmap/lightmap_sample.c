/* Looking up stored texels. */
#include <math.h>
#include <string.h>

#include <lambent/vector.h>

#include "lightmap/lightmap_internal.h"

/* Where a hit lies in its image: in texels, from the first one's centre. */
static void hit_find(const lmb_lightmap *lightmap, const lmb_hit *hit, double *x, double *y)
{
    const lmb_lightmap_region *region = &lightmap->region[hit->instance];
    const uint32_t number = lightmap->scene->instances[hit->instance].mesh;
    const lmb_mesh *mesh = &lightmap->scene->meshes[number];
    const lmb_vec2 *own = lightmap->corner_uv[number];
    const lmb_vec2 a = lmb_texels_corner_uv(mesh, own, hit->triangle, 0);
    const lmb_vec2 b = lmb_texels_corner_uv(mesh, own, hit->triangle, 1);
    const lmb_vec2 c = lmb_texels_corner_uv(mesh, own, hit->triangle, 2);
    const float u = hit->u, v = hit->v, w = 1.0f - u - v;
    const lmb_texel_grid grid = lmb_lightmap_grid(lightmap, hit->instance);
    *x = (double)(w * a.x + u * b.x + v * c.x) * grid.density - grid.shift_x + region->x - 0.5;
    *y = (double)(w * a.y + u * b.y + v * c.y) * grid.density - grid.shift_y + region->y - 0.5;
}

void lmb_lightmap_footprint_find(const lmb_lightmap *lightmap, const lmb_hit *hit, lmb_lightmap_footprint *footprint)
{
    const int32_t number = lightmap->region[hit->instance].image;
    const lmb_lightmap_image *image = &lightmap->image[number];
    double x, y;
    hit_find(lightmap, hit, &x, &y);
    const double left = floor(x);
    const double top = floor(y);
    footprint->image = number;
    for (int k = 0; k < LMB_FOOTPRINT; ++k) {
        const int right = k & 1;
        const int below = k >> 1;
        const double column = fmin(fmax(left + right, 0.0), image->width - 1);
        const double row = fmin(fmax(top + below, 0.0), image->height - 1);
        const double weight = (right ? x - left : 1.0 - (x - left)) * (below ? y - top : 1.0 - (y - top));
        footprint->pixel[k] = (uint32_t)row * (uint32_t)image->width + (uint32_t)column;
        footprint->weight[k] = (float)weight;
    }
}

void lmb_lightmap_footprint_read(const lmb_lightmap *lightmap, const lmb_lightmap_footprint *footprint,
                                 float channel[LMB_MODEL_MOST_CHANNELS])
{
    const lmb_lightmap_image *image = &lightmap->image[footprint->image];
    memset(channel, 0, LMB_MODEL_MOST_CHANNELS * sizeof *channel);
    for (int k = 0; k < LMB_FOOTPRINT; ++k) {
        for (int c = 0; c < lightmap->model->channel_count; ++c) {
            channel[c] += footprint->weight[k] * lmb_lightmap_plane(image, c)[footprint->pixel[k]];
        }
    }
}

bool lmb_lightmap_sample(const lmb_lightmap *lightmap, const lmb_hit *hit, float channel[LMB_MODEL_MOST_CHANNELS])
{
    if (lightmap->region[hit->instance].image < 0) {
        memset(channel, 0, LMB_MODEL_MOST_CHANNELS * sizeof *channel);
        return false;
    }
    lmb_lightmap_footprint footprint;
    lmb_lightmap_footprint_find(lightmap, hit, &footprint);
    lmb_lightmap_footprint_read(lightmap, &footprint, channel);
    return true;
}

void lmb_lightmap_footprint_keys(const lmb_lightmap *lightmap, const lmb_lightmap_footprint *footprint,
                                 float visibility[LMB_KEY_LIGHTS_MOST])
{
    const lmb_lightmap_image *image = &lightmap->image[footprint->image];
    memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
    for (uint32_t key = 0; key < lightmap->key_light_count; ++key) {
        const float *plane = lmb_lightmap_plane(image, lightmap->model->channel_count + (int)key);
        for (int k = 0; k < LMB_FOOTPRINT; ++k) {
            visibility[key] += footprint->weight[k] * plane[footprint->pixel[k]];
        }
        visibility[key] = lmb_saturate(visibility[key]);
    }
}

bool lmb_lightmap_sample_keys(const lmb_lightmap *lightmap, const lmb_hit *hit, float visibility[LMB_KEY_LIGHTS_MOST])
{
    if (lightmap->region[hit->instance].image < 0) {
        memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
        return false;
    }
    lmb_lightmap_footprint footprint;
    lmb_lightmap_footprint_find(lightmap, hit, &footprint);
    lmb_lightmap_footprint_keys(lightmap, &footprint, visibility);
    return true;
}

bool lmb_lightmap_texel(const lmb_lightmap *lightmap, const lmb_hit *hit, int32_t *column, int32_t *row)
{
    if (lightmap->region[hit->instance].image < 0) {
        return false;
    }
    double x, y;
    hit_find(lightmap, hit, &x, &y);
    *column = (int32_t)floor(x + 0.5);
    *row = (int32_t)floor(y + 0.5);
    return true;
}
