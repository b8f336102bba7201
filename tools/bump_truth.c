#include "bump_truth.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/sequence.h>
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

/* The texel that a ray from one ends at, -1: none. */
static int hit_find(const bump_floor *bumps, int x, int y, lmb_vec3 direction)
{
    const float step = STEP / lmb_larger(hypotf(direction.x, direction.z), fabsf(direction.y) + 1e-6f);
    const float own = height_at(bumps, (float)x, (float)y);
    for (float distance = step; distance < 4.0f * (float)bumps->map.width; distance += step) {
        const float right = (float)x + direction.x * distance, down = (float)y + direction.z * distance;
        const float height = own + direction.y * distance;
        if (height > bumps->scale_texels) {
            return -1;
        }
        if (height_at(bumps, right, down) > height) {
            const int column = (int)lrintf(right) % bumps->map.width, row = (int)lrintf(down) % bumps->map.height;
            return (column + bumps->map.width) % bumps->map.width +
                   bumps->map.width * ((row + bumps->map.height) % bumps->map.height);
        }
    }
    return -1;
}

/* By rays in proportion to the cosine: their mean. */
static lmb_rgb bounce_gather(const bump_floor *bumps, int texel, uint32_t samples, const lmb_rgb *irradiance)
{
    const int x = texel % bumps->map.width, y = texel / bumps->map.width;
    const lmb_vec3 normal = bump_normal(bumps, x, y);
    lmb_vec3 tangent, bitangent;
    lmb_vec3_frame(normal, &tangent, &bitangent);
    lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
    for (uint32_t i = 0; i < samples; ++i) {
        float u[2];
        lmb_sequence_2d((uint64_t)texel, i, 0, u);
        const float radius = sqrtf(u[0]), turn = 2.0f * LMB_PI_F * u[1];
        const lmb_vec3 across =
            lmb_vec3_mad(lmb_vec3_scale(tangent, radius * cosf(turn)), bitangent, radius * sinf(turn));
        const int hit = hit_find(bumps, x, y, lmb_vec3_mad(across, normal, sqrtf(1.0f - u[0])));
        if (hit >= 0) {
            sum = lmb_rgb_add(sum, irradiance[hit]);
        }
    }
    return lmb_rgb_scale(sum, 1.0f / (float)samples);
}

lmb_result bump_bounces_add(const bump_floor *bumps, float albedo, uint32_t samples, int bounces, lmb_rgb *irradiance)
{
    const int texels = bumps->map.width * bumps->map.height;
    lmb_rgb *const direct = malloc(2 * (size_t)texels * sizeof *direct);
    if (!direct) {
        return LMB_ERROR_MEMORY;
    }
    lmb_rgb *const next = direct + texels;
    for (int i = 0; i < texels; ++i) {
        direct[i] = irradiance[i];
    }
    for (int bounce = 0; bounce < bounces; ++bounce) {
        for (int i = 0; i < texels; ++i) {
            next[i] = lmb_rgb_scale(bounce_gather(bumps, i, samples, irradiance), albedo);
        }
        for (int i = 0; i < texels; ++i) {
            irradiance[i] = lmb_rgb_add(direct[i], next[i]);
        }
    }
    free(direct);
    return LMB_OK;
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
