#include <lambent/grid.h>

#include "volume_internal.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Spacing, box and number of points can be those of a grid. */
static bool box_is_valid(float spacing, const int32_t min[3], const int32_t size[3])
{
    uint64_t points = 1;
    for (int axis = 0; axis < 3; ++axis) {
        if (size[axis] < 1 || (int64_t)min[axis] + size[axis] - 1 > INT32_MAX) {
            return false;
        }
        points *= (uint32_t)size[axis]; /* at most 2^31 * 2^31 before the next test */
        if (points > INT32_MAX) {
            return false;
        }
    }
    return isfinite(spacing) && spacing > 0.0f;
}

size_t lmb_grid_point_count(const lmb_grid *grid)
{
    return (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
}

lmb_result lmb_grid_create(float spacing, const int32_t min[3], const int32_t size[3], lmb_grid **grid)
{
    assert(min && size && grid);
    if (!box_is_valid(spacing, min, size)) {
        return LMB_ERROR_ARGUMENT;
    }
    lmb_grid *const created = calloc(1, sizeof *created);
    if (!created) {
        return LMB_ERROR_MEMORY;
    }
    created->spacing = spacing;
    memcpy(created->min, min, sizeof created->min);
    memcpy(created->size, size, sizeof created->size);
    const size_t points = lmb_grid_point_count(created);
    created->probe_at = malloc(points * sizeof *created->probe_at);
    if (!created->probe_at) {
        free(created);
        return LMB_ERROR_MEMORY;
    }
    memset(created->probe_at, 0xff, points * sizeof *created->probe_at); /* -1 everywhere */
    *grid = created;
    return LMB_OK;
}

static void number_probes(lmb_grid *grid, const uint8_t *wanted)
{
    int32_t probe = 0;
    size_t point = 0;
    for (int32_t z = 0; z < grid->size[2]; ++z) {
        for (int32_t y = 0; y < grid->size[1]; ++y) {
            for (int32_t x = 0; x < grid->size[0]; ++x, ++point) {
                if (wanted[point]) {
                    grid->probe_at[point] = probe;
                    grid->lattice[probe][0] = grid->min[0] + x;
                    grid->lattice[probe][1] = grid->min[1] + y;
                    grid->lattice[probe][2] = grid->min[2] + z;
                    ++probe;
                }
            }
        }
    }
    grid->probe_count = probe;
}

lmb_result lmb_grid_add_probes(lmb_grid *grid, const uint8_t *wanted)
{
    assert(grid && wanted);
    if (grid->lattice) {
        return LMB_ERROR_ARGUMENT;
    }
    const size_t points = lmb_grid_point_count(grid);
    size_t count = 0;
    for (size_t point = 0; point < points; ++point) {
        count += wanted[point] != 0;
    }
    const size_t allocated = count > 0 ? count : 1; /* a lattice says that this was called */
    int32_t(*const lattice)[3] = calloc(allocated, sizeof *lattice);
    lmb_sh3_rgb *const radiance = calloc(allocated, sizeof *radiance);
    float *const validity = calloc(allocated, sizeof *validity);
    if (!lattice || !radiance || !validity) {
        free(lattice);
        free(radiance);
        free(validity);
        return LMB_ERROR_MEMORY;
    }
    grid->lattice = lattice;
    grid->radiance = radiance;
    grid->validity = validity;
    number_probes(grid, wanted);
    return LMB_OK;
}

void lmb_grid_destroy(lmb_grid *grid)
{
    if (grid) {
        free(grid->probe_at);
        free(grid->lattice);
        free(grid->radiance);
        free(grid->validity);
        free(grid);
    }
}

int32_t lmb_grid_probe_at(const lmb_grid *grid, int32_t x, int32_t y, int32_t z)
{
    assert(grid);
    const int64_t local[3] = {(int64_t)x - grid->min[0], (int64_t)y - grid->min[1], (int64_t)z - grid->min[2]};
    for (int axis = 0; axis < 3; ++axis) {
        if (local[axis] < 0 || local[axis] >= grid->size[axis]) {
            return -1;
        }
    }
    return grid->probe_at[local[0] + grid->size[0] * (local[1] + grid->size[1] * local[2])];
}

lmb_vec3 lmb_grid_position(const lmb_grid *grid, int32_t probe)
{
    assert(grid && probe >= 0 && probe < grid->probe_count);
    const int32_t *const lattice = grid->lattice[probe];
    const double spacing = (double)grid->spacing;
    return (lmb_vec3){(float)(lattice[0] * spacing - grid->origin.x), (float)(lattice[1] * spacing - grid->origin.y),
                      (float)(lattice[2] * spacing - grid->origin.z)};
}

float lmb_grid_scale(const lmb_grid *grid)
{
    float largest = 0.0f;
    for (int32_t probe = 0; probe < grid->probe_count; ++probe) {
        for (int channel = 0; channel < 3; ++channel) {
            for (int i = 0; i < LMB_SH3_COUNT; ++i) {
                largest = fmaxf(largest, fabsf(grid->radiance[probe].channel[channel].c[i]));
            }
        }
    }
    if (largest == 0.0f || (largest >= 0.0625f && largest <= LMB_HALF_MAX)) {
        return 1.0f;
    }
    int exponent;
    frexpf(largest, &exponent); /* largest = m 2^exponent, m in [1/2, 1) */
    exponent -= 15;
    return ldexpf(1.0f, exponent < -96 ? -96 : exponent > 96 ? 96 : exponent);
}

static lmb_result validate_points(const lmb_grid *grid, lmb_error *error)
{
    int64_t found = 0;
    size_t point = 0;
    for (int32_t z = 0; z < grid->size[2]; ++z) {
        for (int32_t y = 0; y < grid->size[1]; ++y) {
            for (int32_t x = 0; x < grid->size[0]; ++x, ++point) {
                const int32_t probe = grid->probe_at[point];
                if (probe == -1) {
                    continue;
                }
                if (probe < -1 || probe >= grid->probe_count) {
                    return lmb_error_set(error, LMB_ERROR_FORMAT, "grid: point %zu names probe %d of %d", point, probe,
                                         grid->probe_count);
                }
                const int32_t *const lattice = grid->lattice[probe];
                if (lattice[0] != grid->min[0] + x || lattice[1] != grid->min[1] + y ||
                    lattice[2] != grid->min[2] + z) {
                    return lmb_error_set(error, LMB_ERROR_FORMAT,
                                         "grid: point %zu names probe %d, which is at (%d, %d, %d)", point, probe,
                                         lattice[0], lattice[1], lattice[2]);
                }
                ++found;
            }
        }
    }
    /* A probe has one place, so none is found twice: an equal number means that none is lost. */
    if (found != grid->probe_count) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "grid: %d probes, but %lld points with one", grid->probe_count,
                             (long long)found);
    }
    return LMB_OK;
}

static lmb_result validate_probe(const lmb_grid *grid, int32_t probe, lmb_error *error)
{
    for (int channel = 0; channel < 3; ++channel) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            const float value = grid->radiance[probe].channel[channel].c[i];
            if (!isfinite(value)) {
                return lmb_error_set(error, LMB_ERROR_FORMAT, "grid: probe %d: coefficient %d of channel %d is %g",
                                     probe, i, channel, (double)value);
            }
        }
    }
    const float validity = grid->validity[probe];
    if (!(validity >= 0.0f && validity <= 1.0f)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "grid: probe %d: validity is %g, outside 0 to 1", probe,
                             (double)validity);
    }
    return LMB_OK;
}

lmb_result lmb_grid_validate(const lmb_grid *grid, lmb_error *error)
{
    assert(grid);
    if (!box_is_valid(grid->spacing, grid->min, grid->size)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT,
                             "grid: spacing %g, or box of %d x %d x %d at (%d, %d, %d), is out of range",
                             (double)grid->spacing, grid->size[0], grid->size[1], grid->size[2], grid->min[0],
                             grid->min[1], grid->min[2]);
    }
    const bool has_arrays = grid->lattice && grid->radiance && grid->validity;
    if (!grid->probe_at || grid->probe_count < 0 || (grid->probe_count > 0 && !has_arrays)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "grid: %d probes without all of their arrays", grid->probe_count);
    }
    const lmb_result result = validate_points(grid, error);
    if (result != LMB_OK) {
        return result;
    }
    for (int32_t probe = 0; probe < grid->probe_count; ++probe) {
        if (validate_probe(grid, probe, error) != LMB_OK) {
            return LMB_ERROR_FORMAT;
        }
    }
    return LMB_OK;
}
