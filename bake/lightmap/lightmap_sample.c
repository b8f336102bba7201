/* Looking up stored texels. */
#include <math.h>

#include "base/vec3.h"
#include "lightmap/lightmap_internal.h"

static lmb_irradz irradz_mad(lmb_irradz sum, const lmb_irradz *texel, float weight)
{
    for (int c = 0; c < 3; ++c) {
        sum.irradiance_z.c[c] += weight * texel->irradiance_z.c[c];
    }
    sum.ambient_weight += weight * texel->ambient_weight;
    sum.direction = vec3_mad(sum.direction, texel->direction, weight);
    return sum;
}

lmb_irradz lmb_lightmap_sample(const lmb_lightmap *lightmap, uint32_t instance, uint32_t triangle, float u, float v)
{
    lmb_irradz sum = {{{0.0f, 0.0f, 0.0f}}, 0.0f, {0.0f, 0.0f, 0.0f}};
    const lmb_lightmap_region *region = &lightmap->region[instance];
    if (region->image < 0) {
        return sum;
    }
    const lmb_lightmap_image *image = &lightmap->image[region->image];
    const uint32_t number = lightmap->scene->instances[instance].mesh;
    const lmb_mesh *mesh = &lightmap->scene->meshes[number];
    const lmb_vec2 *own = lightmap->corner_uv[number];
    const lmb_vec2 a = lmb_texels_corner_uv(mesh, own, triangle, 0);
    const lmb_vec2 b = lmb_texels_corner_uv(mesh, own, triangle, 1);
    const lmb_vec2 c = lmb_texels_corner_uv(mesh, own, triangle, 2);
    const float w = 1.0f - u - v;
    const lmb_texel_grid grid = lmb_lightmap_grid(lightmap, instance);
    const double x = (double)(w * a.x + u * b.x + v * c.x) * grid.density - grid.shift_x + region->x - 0.5;
    const double y = (double)(w * a.y + u * b.y + v * c.y) * grid.density - grid.shift_y + region->y - 0.5;
    const double left = floor(x);
    const double top = floor(y);
    for (int k = 0; k < 4; ++k) {
        const int right = k & 1;
        const int below = k >> 1;
        const double column = fmin(fmax(left + right, 0.0), image->width - 1);
        const double row = fmin(fmax(top + below, 0.0), image->height - 1);
        const double weight = (right ? x - left : 1.0 - (x - left)) * (below ? y - top : 1.0 - (y - top));
        sum = irradz_mad(sum, &image->texel[(size_t)row * (size_t)image->width + (size_t)column], (float)weight);
    }
    return sum;
}
