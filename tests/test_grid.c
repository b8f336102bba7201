/* Grids: what they hold, what the walker finds, and dilation against a version written from its definition. */
#include "grid_fixture.h"
#include "harness.h"

#include <float.h>
#include <limits.h>

static void test_create_limits(void)
{
    static const struct {
        float spacing;
        int32_t min[3];
        int32_t size[3];
        lmb_result expected;
    } cases[] = {
        {1.0f, {0, 0, 0}, {1, 1, 1}, LMB_OK},
        {1e-30f, {INT32_MAX, 0, INT32_MIN}, {1, 2, 3}, LMB_OK},
        {1.0f, {INT32_MAX, 0, 0}, {2, 1, 1}, LMB_ERROR_ARGUMENT},
        {1.0f, {0, 0, 0}, {0, 1, 1}, LMB_ERROR_ARGUMENT},
        {1.0f, {0, 0, 0}, {1, -1, -1}, LMB_ERROR_ARGUMENT},
        {1.0f, {0, 0, 0}, {65536, 65536, 1}, LMB_ERROR_ARGUMENT},
        {1.0f, {INT32_MIN, INT32_MIN, INT32_MIN}, {INT32_MAX, INT32_MAX, INT32_MAX}, LMB_ERROR_ARGUMENT},
        {0.0f, {0, 0, 0}, {1, 1, 1}, LMB_ERROR_ARGUMENT},
        {-1.0f, {0, 0, 0}, {1, 1, 1}, LMB_ERROR_ARGUMENT},
        {NAN, {0, 0, 0}, {1, 1, 1}, LMB_ERROR_ARGUMENT},
        {INFINITY, {0, 0, 0}, {1, 1, 1}, LMB_ERROR_ARGUMENT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_grid *grid = NULL;
        const lmb_result result = lmb_grid_create(cases[i].spacing, cases[i].min, cases[i].size, &grid);
        CHECK(result == cases[i].expected, "case %zu: result %d", i, result);
        CHECK((grid != NULL) == (result == LMB_OK), "case %zu: output", i);
        if (grid) {
            CHECK(lmb_grid_validate(grid, NULL) == LMB_OK, "case %zu: a grid without probes is valid", i);
            CHECK(lmb_grid_dilate(grid) == LMB_OK, "case %zu: nothing to dilate", i);
        }
        lmb_grid_destroy(grid);
    }
    lmb_grid_destroy(NULL);
}

static void test_probes(void)
{
    const int32_t min[3] = {-3, 5, -1}, size[3] = {4, 2, 3};
    lmb_grid *grid = NULL;
    uint8_t wanted[24] = {0};
    wanted[1] = 1;
    wanted[7] = 255;
    wanted[23] = 2;
    CHECK(lmb_grid_create(0.5f, min, size, &grid) == LMB_OK, "create");
    CHECK(lmb_grid_add_probes(grid, wanted) == LMB_OK, "add");
    CHECK(lmb_grid_add_probes(grid, wanted) == LMB_ERROR_ARGUMENT, "added twice");
    CHECK(grid->probe_count == 3, "%d probes", grid->probe_count);
    CHECK(lmb_grid_validate(grid, NULL) == LMB_OK, "valid");

    static const struct {
        int32_t at[3];
        int32_t expected;
    } cases[] = {
        {{-2, 5, -1}, 0},
        {{0, 6, -1}, 1},
        {{0, 6, 1}, 2},
        {{-3, 5, -1}, -1},
        {{1, 6, 1}, -1},
        {{-4, 6, 0}, -1},
        {{0, 7, 1}, -1},
        {{0, 6, 2}, -1},
        {{0, 4, 2}, -1},
        {{INT32_MIN, INT32_MAX, INT32_MIN}, -1},
        {{INT32_MAX, INT32_MIN, INT32_MAX}, -1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const int32_t probe = lmb_grid_probe_at(grid, cases[i].at[0], cases[i].at[1], cases[i].at[2]);
        CHECK(probe == cases[i].expected, "case %zu: probe %d", i, probe);
    }
    const lmb_vec3 position = lmb_grid_position(grid, 0);
    CHECK(position.x == -1.0f && position.y == 2.5f && position.z == -0.5f, "(%g, %g, %g)", (double)position.x,
          (double)position.y, (double)position.z);
    grid->origin = (lmb_vec3d){-1e8 - 0.25, 2.0, 1e8};
    const lmb_vec3 moved = lmb_grid_position(grid, 0);
    CHECK(moved.x == 1e8f && moved.y == 0.5f && moved.z == -1e8f, "(%g, %g, %g)", (double)moved.x, (double)moved.y,
          (double)moved.z);
    CHECK(grid->validity[2] == 0.0f && grid->radiance[2].channel[2].c[8] == 0.0f, "probes start dark");
    lmb_grid_destroy(grid);
}

/* ------------------------------------------------------------------------------------------ the walker */

static void break_spacing(lmb_grid *grid)
{
    grid->spacing = 0.0f;
}
static void break_size(lmb_grid *grid)
{
    grid->size[1] = 0;
}
static void break_min(lmb_grid *grid)
{
    grid->min[0] = INT32_MAX;
}
static void break_shift(lmb_grid *grid)
{
    ++grid->min[2];
}
static void break_count_up(lmb_grid *grid)
{
    grid->probe_at[0] = -1;
}
static void break_count_down(lmb_grid *grid)
{
    --grid->probe_count;
}
static void break_count_negative(lmb_grid *grid)
{
    grid->probe_count = -1;
}
static void break_number_high(lmb_grid *grid)
{
    grid->probe_at[5] = grid->probe_count;
}
static void break_number_low(lmb_grid *grid)
{
    grid->probe_at[5] = -2;
}
static void break_number_twice(lmb_grid *grid)
{
    grid->probe_at[5] = grid->probe_at[6];
}
static void break_lattice(lmb_grid *grid)
{
    ++grid->lattice[3][1];
}
static void break_radiance_nan(lmb_grid *grid)
{
    grid->radiance[4].channel[1].c[7] = NAN;
}
static void break_radiance_infinite(lmb_grid *grid)
{
    grid->radiance[grid->probe_count - 1].channel[2].c[8] = -INFINITY;
}
static void break_validity_high(lmb_grid *grid)
{
    grid->validity[2] = 1.0001f;
}
static void break_validity_low(lmb_grid *grid)
{
    grid->validity[2] = -0.0001f;
}
static void break_validity_nan(lmb_grid *grid)
{
    grid->validity[0] = NAN;
}

static void test_validate(void)
{
    static const struct {
        const char *name;
        void (*break_it)(lmb_grid *grid);
        const char *expected; /* in the message */
    } cases[] = {
        {"spacing", break_spacing, "spacing"},
        {"size", break_size, "box"},
        {"min", break_min, "box"},
        {"shifted box", break_shift, "which is at"},
        {"a probe without a point", break_count_up, "points with one"},
        {"a point without a probe", break_count_down, "names probe"},
        {"negative count", break_count_negative, "arrays"},
        {"number too high", break_number_high, "names probe"},
        {"number too low", break_number_low, "names probe"},
        {"two points, one probe", break_number_twice, "names probe"},
        {"lattice", break_lattice, "names probe 3"},
        {"NaN", break_radiance_nan, "probe 4: coefficient 7 of channel 1"},
        {"infinity", break_radiance_infinite, "coefficient 8 of channel 2"},
        {"validity above 1", break_validity_high, "probe 2: validity"},
        {"validity below 0", break_validity_low, "probe 2: validity"},
        {"validity NaN", break_validity_nan, "probe 0: validity"},
    };
    const int32_t min[3] = {-2, 0, 3}, size[3] = {3, 4, 5};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_grid *const grid = fixture_grid(0.25f, min, size, 1.0, 0.5, 3.0, i);
        lmb_error error = {""};
        CHECK(lmb_grid_validate(grid, &error) == LMB_OK, "%s: before: %s", cases[i].name, error.message);
        cases[i].break_it(grid);
        CHECK(lmb_grid_validate(grid, &error) == LMB_ERROR_FORMAT, "%s is not found", cases[i].name);
        CHECK(strstr(error.message, cases[i].expected), "%s: '%s'", cases[i].name, error.message);
        lmb_grid_destroy(grid);
    }
}

/* -------------------------------------------------------------------------------------------- dilation */

/* The definition, point by point: pass after pass over a copy, until a pass changes nothing. Works on arrays over the
 * box, not on probes. */
typedef struct oracle {
    int size[3];
    bool *exists;
    bool *has_light;
    double (*value)[27];
} oracle;

static size_t oracle_point(const oracle *o, int x, int y, int z)
{
    return (size_t)x + (size_t)o->size[0] * ((size_t)y + (size_t)o->size[1] * (size_t)z);
}

static bool oracle_fill(const oracle *o, const bool *lit_before, int x, int y, int z, double filled[27])
{
    double weights = 0.0;
    for (int i = 0; i < 27; ++i) {
        filled[i] = 0.0;
    }
    for (int c = z - 1; c <= z + 1; ++c) {
        for (int b = y - 1; b <= y + 1; ++b) {
            for (int a = x - 1; a <= x + 1; ++a) {
                if (a < 0 || b < 0 || c < 0 || a >= o->size[0] || b >= o->size[1] || c >= o->size[2] ||
                    !lit_before[oracle_point(o, a, b, c)]) {
                    continue;
                }
                const double weight = 1.0 / ((a - x) * (a - x) + (b - y) * (b - y) + (c - z) * (c - z));
                weights += weight;
                for (int i = 0; i < 27; ++i) {
                    filled[i] += weight * o->value[oracle_point(o, a, b, c)][i];
                }
            }
        }
    }
    for (int i = 0; i < 27 && weights > 0.0; ++i) {
        filled[i] /= weights;
    }
    return weights > 0.0;
}

static void oracle_dilate(oracle *o)
{
    const size_t points = oracle_point(o, 0, 0, o->size[2]);
    bool *const before = malloc(points);
    for (bool changed = true; changed;) {
        changed = false;
        memcpy(before, o->has_light, points);
        for (int z = 0; z < o->size[2]; ++z) {
            for (int y = 0; y < o->size[1]; ++y) {
                for (int x = 0; x < o->size[0]; ++x) {
                    const size_t point = oracle_point(o, x, y, z);
                    double filled[27];
                    if (o->exists[point] && !before[point] && oracle_fill(o, before, x, y, z, filled)) {
                        memcpy(o->value[point], filled, sizeof filled);
                        o->has_light[point] = true;
                        changed = true;
                    }
                }
            }
        }
    }
    free(before);
}

static void check_dilation(const int32_t size[3], double density, double valid_share, uint64_t seed)
{
    const int32_t min[3] = {-7, 100, 3};
    lmb_grid *const grid = fixture_grid(1.0f, min, size, density, valid_share, 10.0, seed);
    const size_t points = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
    oracle o = {{size[0], size[1], size[2]}, calloc(points, 1), calloc(points, 1), calloc(points, sizeof(double[27]))};
    for (int32_t probe = 0; probe < grid->probe_count; ++probe) {
        const int32_t *const at = grid->lattice[probe];
        const size_t point = oracle_point(&o, at[0] - min[0], at[1] - min[1], at[2] - min[2]);
        o.exists[point] = true;
        o.has_light[point] = grid->validity[probe] >= 0.5f;
        for (int i = 0; i < 27; ++i) {
            o.value[point][i] = o.has_light[point] ? (double)grid->radiance[probe].channel[i / 9].c[i % 9] : 0.0;
        }
    }
    oracle_dilate(&o);
    CHECK(lmb_grid_dilate(grid) == LMB_OK, "dilate");
    CHECK(lmb_grid_validate(grid, NULL) == LMB_OK, "valid afterwards");
    for (int32_t probe = 0; probe < grid->probe_count; ++probe) {
        const int32_t *const at = grid->lattice[probe];
        const size_t point = oracle_point(&o, at[0] - min[0], at[1] - min[1], at[2] - min[2]);
        for (int i = 0; i < 27; ++i) {
            /* Probes round to float in every pass, the oracle never does. */
            CHECK_NEAR(grid->radiance[probe].channel[i / 9].c[i % 9], o.value[point][i], 2e-5,
                       "density %g, valid %g, seed %llu, probe %d, coefficient %d", density, valid_share,
                       (unsigned long long)seed, probe, i);
        }
    }
    free(o.exists);
    free(o.has_light);
    free(o.value);
    lmb_grid_destroy(grid);
}

static void test_dilation(void)
{
    static const struct {
        int32_t size[3];
        double density;
        double valid_share;
    } cases[] = {
        {{7, 6, 5}, 1.0, 0.5},  {{9, 9, 9}, 1.0, 0.01}, {{12, 3, 4}, 0.5, 0.1},
        {{20, 1, 1}, 1.0, 0.1}, {{8, 8, 8}, 0.2, 0.05}, {{5, 5, 5}, 1.0, 0.0},
        {{5, 5, 5}, 1.0, 1.0},  {{1, 1, 1}, 1.0, 1.0},  {{1, 16, 16}, 0.35, 0.1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        check_dilation(cases[i].size, cases[i].density, cases[i].valid_share, i);
    }
}

/* The same probes numbered backwards dilate to the same bits. */
static void test_dilation_order(void)
{
    const int32_t min[3] = {0, 0, 0}, size[3] = {9, 8, 7};
    lmb_grid *const forward = fixture_grid(1.0f, min, size, 0.7, 0.1, 5.0, 42);
    lmb_grid *const backward = fixture_grid(1.0f, min, size, 0.7, 0.1, 5.0, 42);
    const int32_t count = forward->probe_count;
    for (int32_t probe = 0; probe < count; ++probe) {
        const int32_t other = count - 1 - probe;
        memcpy(backward->lattice[other], forward->lattice[probe], sizeof forward->lattice[probe]);
        backward->radiance[other] = forward->radiance[probe];
        backward->validity[other] = forward->validity[probe];
    }
    for (size_t point = 0; point < 9 * 8 * 7; ++point) {
        const int32_t probe = forward->probe_at[point];
        backward->probe_at[point] = probe < 0 ? -1 : count - 1 - probe;
    }
    CHECK(lmb_grid_validate(backward, NULL) == LMB_OK, "the renumbered grid is valid");
    CHECK(lmb_grid_dilate(forward) == LMB_OK && lmb_grid_dilate(backward) == LMB_OK, "dilate");
    for (int32_t probe = 0; probe < count; ++probe) {
        CHECK(memcmp(&forward->radiance[probe], &backward->radiance[count - 1 - probe], sizeof(lmb_sh3_rgb)) == 0,
              "probe %d", probe);
    }
    lmb_grid_destroy(forward);
    lmb_grid_destroy(backward);
}

static const test_case cases[] = {
    {"limits of a box", test_create_limits},
    {"probes and their places", test_probes},
    {"every broken invariant is found", test_validate},
    {"dilation follows its definition", test_dilation},
    {"dilation does not depend on the order of probes", test_dilation_order},
};
TEST_MAIN(cases)
