#include "bump_truth.h"

#include <math.h>

#include <lambent/vector.h>

#define STEP 0.5f /* along a ray, texels */

/* Between four texels. */
static float height_at(const bump_floor *bumps, float x, float y)
{
    const lmb_height_map *map = &bumps->map;
    const float left = floorf(x), top = floorf(y), across = x - left, down = y - top;
    float sum = 0.0f;
    for (int corner = 0; corner < 4; ++corner) {
        const int right = corner & 1, below = corner >> 1;
        const int column = (((int)left + right) % map->width + map->width) % map->width;
        const int row = (((int)top + below) % map->height + map->height) % map->height;
        const float share = (right ? across : 1.0f - across) * (below ? down : 1.0f - down);
        sum += share * map->value[column + map->width * row];
    }
    return bumps->scale_texels * sum;
}

lmb_vec3 bump_normal(const bump_floor *bumps, int x, int y)
{
    const float column = (float)x, row = (float)y;
    const float right = height_at(bumps, column + 1.0f, row) - height_at(bumps, column - 1.0f, row);
    const float down = height_at(bumps, column, row + 1.0f) - height_at(bumps, column, row - 1.0f);
    return lmb_vec3_unit_or(lmb_vec3_of(-0.5f * right, 1.0f, -0.5f * down), lmb_vec3_of(0.0f, 1.0f, 0.0f));
}

/* The elevation up to which a texel sees nothing towards `direction`'s azimuth. */
static double horizon_rad(const bump_floor *bumps, int x, int y, lmb_vec3 direction)
{
    const float own = height_at(bumps, (float)x, (float)y), above = bumps->scale_texels - own;
    const float length = hypotf(direction.x, direction.z);
    const float right = direction.x / length, down = direction.z / length;
    float steepest = 0.0f;
    for (float distance = STEP; above > steepest * distance; distance += STEP) {
        const float there = height_at(bumps, (float)x + right * distance, (float)y + down * distance);
        steepest = lmb_larger(steepest, (there - own) / distance);
        if (distance > 4.0f * (float)bumps->map.width) {
            break; /* flat all around */
        }
    }
    return atan((double)steepest);
}

/* The share of elevations from `low` to `high` that is above a horizon. */
static double share_open(double low, double high, double horizon)
{
    return fmin(fmax((high - horizon) / (high - low), 0.0), 1.0);
}

static double elevation_rad(lmb_vec3 direction)
{
    return asin(fmin((double)direction.y, 1.0));
}

lmb_rgb bump_irradiance(const bump_floor *bumps, const specular_light *light, int x, int y, bool shadows)
{
    const double half_row = 0.5 * LMB_PI / SPECULAR_ROWS, half_sun = 0.00465;
    const lmb_vec3 normal = bump_normal(bumps, x, y);
    double sum[3] = {0.0, 0.0, 0.0};
    for (int column = 0; column < SPECULAR_COLUMNS; ++column) {
        const double horizon = shadows ? horizon_rad(bumps, x, y, light->cell_direction[column]) : 0.0;
        for (int row = 0; row < SPECULAR_ROWS / 2; ++row) {
            const int cell = row * SPECULAR_COLUMNS + column;
            const lmb_vec3 direction = light->cell_direction[cell];
            const double middle = elevation_rad(direction);
            const double cosine = fmax((double)lmb_vec3_dot(normal, direction), 0.0) *
                                  share_open(middle - half_row, middle + half_row, horizon) / LMB_PI;
            for (int c = 0; c < 3; ++c) {
                sum[c] += cosine * (double)light->cell_light[cell].c[c];
            }
        }
    }
    const double sun = elevation_rad(light->sun.direction);
    const double horizon = shadows ? horizon_rad(bumps, x, y, light->sun.direction) : 0.0;
    const double cosine = fmax((double)lmb_vec3_dot(normal, light->sun.direction), 0.0) *
                          share_open(sun - half_sun, sun + half_sun, horizon);
    for (int c = 0; c < 3; ++c) {
        sum[c] += cosine * (double)light->sun.irradiance.c[c];
    }
    return lmb_rgb_of((float)sum[0], (float)sum[1], (float)sum[2]);
}

lmb_rnm bump_slope_light(const specular_light *light, lmb_vec3 slope[LMB_RNM_SLOPES])
{
    const lmb_vec3 axes[3] = {{1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -1.0f}, {0.0f, 1.0f, 0.0f}};
    lmb_rnm found = {{{{0.0f, 0.0f, 0.0f}}}};
    lmb_rnm_slopes_in_axes(axes, slope);
    for (int i = 0; i < SPECULAR_CELLS / 2; ++i) {
        lmb_rnm_add_light(&found, axes[2], slope, light->cell_direction[i], light->cell_light[i]);
    }
    lmb_rnm_add_light(&found, axes[2], slope, light->sun.direction, lmb_rgb_scale(light->sun.irradiance, LMB_PI_F));
    return found;
}
