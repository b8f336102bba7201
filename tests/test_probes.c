/* Probes: what they hold, what the walker finds, and dilation against a version written from its definition. */
#include "probes_fixture.h"
#include "harness.h"
#include "turned_lattice.h"

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
        {1.0f, {0, 0, 0}, {65536, 65536, 1}, LMB_OK}, /* nothing is held for points without probes */
        {1.0f, {INT32_MIN, INT32_MIN, INT32_MIN}, {INT32_MAX, INT32_MAX, INT32_MAX}, LMB_OK},
        {0.0f, {0, 0, 0}, {1, 1, 1}, LMB_ERROR_ARGUMENT},
        {-1.0f, {0, 0, 0}, {1, 1, 1}, LMB_ERROR_ARGUMENT},
        {NAN, {0, 0, 0}, {1, 1, 1}, LMB_ERROR_ARGUMENT},
        {INFINITY, {0, 0, 0}, {1, 1, 1}, LMB_ERROR_ARGUMENT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_probes *probes = NULL;
        CHECK(lmb_probes_create(&probes) == LMB_OK, "case %zu: memory", i);
        lmb_lattice lattice = {.spacing = cases[i].spacing};
        memcpy(lattice.min, cases[i].min, sizeof lattice.min);
        memcpy(lattice.size, cases[i].size, sizeof lattice.size);
        const lmb_result result = lmb_probes_add_level(probes, &lattice, NULL, 0);
        CHECK(result == cases[i].expected, "case %zu: result %d", i, result);
        CHECK((probes->level_count == 1) == (result == LMB_OK), "case %zu: output", i);
        CHECK(lmb_probes_validate(probes, NULL) == LMB_OK, "case %zu: no probes at all are valid", i);
        CHECK(lmb_probes_dilate(probes) == LMB_OK, "case %zu: nothing to dilate", i);
        lmb_probes_destroy(probes);
    }
    lmb_probes_destroy(NULL);
}

/* Axes of a level: a rotation, or none told. */
static void test_axes_limits(void)
{
    static const struct {
        const char *name;
        lmb_vec3d axis[3];
        lmb_result expected;
    } cases[] = {
        {"none", {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, LMB_OK},
        {"the world's", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, LMB_OK},
        {"a rotation", {{0.6, 0, -0.8}, {0, 1, 0}, {0.8, 0, 0.6}}, LMB_OK},
        {"a reflection", {{0.6, 0, -0.8}, {0, -1, 0}, {0.8, 0, 0.6}}, LMB_ERROR_ARGUMENT},
        {"left-handed", {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, LMB_ERROR_ARGUMENT},
        {"skewed", {{0.6, 0, -0.8}, {0, 1, 0}, {0, 0, 1}}, LMB_ERROR_ARGUMENT},
        {"scaled", {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, LMB_ERROR_ARGUMENT},
        {"of floats",
         {{(double)0.6f, 0, (double)-0.8f}, {0, 1, 0}, {(double)0.8f, 0, (double)0.6f}},
         LMB_ERROR_ARGUMENT},
        {"one missing", {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}, LMB_ERROR_ARGUMENT},
        {"NaN", {{1, 0, 0}, {0, NAN, 0}, {0, 0, 1}}, LMB_ERROR_ARGUMENT},
        {"all NaN", {{NAN, NAN, NAN}, {NAN, NAN, NAN}, {NAN, NAN, NAN}}, LMB_ERROR_ARGUMENT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_probes *grid = NULL;
        CHECK(lmb_probes_create(&grid) == LMB_OK, "%s: memory", cases[i].name);
        lmb_lattice lattice = {.spacing = 1.0f, .size = {2, 2, 2}};
        memcpy(lattice.axis, cases[i].axis, sizeof lattice.axis);
        const lmb_result result = lmb_probes_add_level(grid, &lattice, NULL, 0);
        CHECK(result == cases[i].expected, "%s: result %d", cases[i].name, result);
        CHECK((grid->level_count == 1) == (result == LMB_OK), "%s: output", cases[i].name);
        lmb_probes_destroy(grid);
    }
}

static void test_probes(void)
{
    const lmb_lattice lattice = {.spacing = 0.5f, .min = {-3, 5, -1}, .size = {4, 2, 3}};
    static const int32_t points[3][3] = {{-2, 5, -1}, {0, 6, -1}, {0, 6, 1}};
    static const int32_t twice[2][3] = {{-2, 5, 0}, {-2, 5, 0}}, beyond[1][3] = {{-2, 7, 0}};
    lmb_probes *probes = NULL;
    CHECK(lmb_probes_create(&probes) == LMB_OK, "create");
    CHECK(lmb_probes_add_level(probes, &lattice, points, 3) == LMB_OK, "add");
    CHECK(lmb_probes_add_level(probes, &lattice, twice, 2) == LMB_ERROR_ARGUMENT, "a point twice");
    CHECK(lmb_probes_add_level(probes, &lattice, beyond, 1) == LMB_ERROR_ARGUMENT, "a point outside");
    CHECK(probes->count == 3, "%d probes", probes->count);
    CHECK(lmb_probes_validate(probes, NULL) == LMB_OK, "valid");

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
        const int32_t probe = lmb_probes_find(probes, 0, cases[i].at[0], cases[i].at[1], cases[i].at[2]);
        CHECK(probe == cases[i].expected, "case %zu: probe %d", i, probe);
    }
    const lmb_vec3 position = lmb_probes_position(probes, 0);
    CHECK(position.x == -1.0f && position.y == 2.5f && position.z == -0.5f, "(%g, %g, %g)", (double)position.x,
          (double)position.y, (double)position.z);
    probes->origin = (lmb_vec3d){-1e8 - 0.25, 2.0, 1e8};
    const lmb_vec3 moved = lmb_probes_position(probes, 0);
    CHECK(moved.x == 1e8f && moved.y == 0.5f && moved.z == -1e8f, "(%g, %g, %g)", (double)moved.x, (double)moved.y,
          (double)moved.z);
    CHECK(probes->validity[2] == 0.0f && probes->radiance[0][2].channel[2].c[8] == 0.0f, "probes start dark");
    lmb_probes_destroy(probes);
}

/* ------------------------------------------------------------------------------------------ the walker */

static void break_spacing(lmb_probes *probes)
{
    probes->level[0].lattice.spacing = 0.0f;
}
static void break_size(lmb_probes *probes)
{
    probes->level[0].lattice.size[1] = 0;
}
static void break_min(lmb_probes *probes)
{
    probes->level[0].lattice.min[0] = INT32_MAX;
}
static void break_shift(lmb_probes *probes)
{
    ++probes->level[0].lattice.min[2];
}
static void break_axes(lmb_probes *grid)
{
    grid->level[0].lattice.axis[1].z = 0.5;
}
static void break_mirror(lmb_probes *grid)
{
    grid->level[0].lattice.axis[0].x = grid->level[0].lattice.axis[1].y = 1.0;
    grid->level[0].lattice.axis[2].z = -1.0;
}
/* The n-th entry of the index that holds a probe. */
static int32_t *entry(lmb_probes *probes, int n)
{
    const lmb_probe_index *index = &probes->level[0].index;
    for (uint32_t i = 0; i < index->block_count; ++i) {
        for (int k = 0; k < LMB_PROBE_BLOCK_POINTS; ++k) {
            if (index->block[i].probe[k] >= 0 && n-- == 0) {
                return &index->block[i].probe[k];
            }
        }
    }
    return NULL;
}
static void break_count_up(lmb_probes *probes)
{
    *entry(probes, 0) = -1;
}
static void break_count_down(lmb_probes *probes)
{
    --probes->level[0].count;
    --probes->count;
}
static void break_count_negative(lmb_probes *probes)
{
    probes->count = -1;
}
static void break_index_high(lmb_probes *probes)
{
    *entry(probes, 5) = probes->count;
}
static void break_index_low(lmb_probes *probes)
{
    *entry(probes, 5) = -2;
}
static void break_index_twice(lmb_probes *probes)
{
    *entry(probes, 5) = *entry(probes, 6);
}
static void break_level(lmb_probes *probes)
{
    ++probes->level[0].first;
}
static void break_levels(lmb_probes *probes)
{
    probes->level_count = 0;
}
static void break_lattice(lmb_probes *probes)
{
    ++probes->point[3][1];
}
static void break_radiance_nan(lmb_probes *probes)
{
    probes->radiance[0][4].channel[1].c[7] = NAN;
}
static void break_radiance_infinite(lmb_probes *probes)
{
    probes->radiance[0][probes->count - 1].channel[2].c[8] = -INFINITY;
}
static void break_second_set(lmb_probes *probes)
{
    uint32_t set;
    CHECK(lmb_probes_add_set(probes, &set) == LMB_OK, "a set");
    probes->radiance[set][3].channel[0].c[2] = NAN;
}
static void break_no_set(lmb_probes *probes)
{
    free(probes->radiance[0]);
    probes->set_count = 0;
}
static void break_set_missing(lmb_probes *probes)
{
    uint32_t set;
    CHECK(lmb_probes_add_set(probes, &set) == LMB_OK, "a set");
    free(probes->radiance[set]);
    probes->radiance[set] = NULL;
}
static void break_validity_high(lmb_probes *probes)
{
    probes->validity[2] = 1.0001f;
}
static void break_validity_low(lmb_probes *probes)
{
    probes->validity[2] = -0.0001f;
}
static void break_validity_nan(lmb_probes *probes)
{
    probes->validity[0] = NAN;
}

static void test_validate(void)
{
    static const struct {
        const char *name;
        void (*break_it)(lmb_probes *probes);
        const char *expected; /* in the message */
    } cases[] = {
        {"spacing", break_spacing, "spacing"},
        {"size", break_size, "box"},
        {"min", break_min, "box"},
        {"shifted box", break_shift, "which is at"},
        {"axes", break_axes, "axes"},
        {"axes that mirror", break_mirror, "axes"},
        {"a probe without a point", break_count_up, "points with one"},
        {"a point without a probe", break_count_down, "names probe"},
        {"negative count", break_count_negative, "arrays"},
        {"index too high", break_index_high, "names probe"},
        {"index too low", break_index_low, "names probe"},
        {"two points, one probe", break_index_twice, "names probe"},
        {"first probe of a level", break_level, "level 0 has probes"},
        {"no level", break_levels, "of levels"},
        {"lattice", break_lattice, "names probe 3"},
        {"NaN", break_radiance_nan, "probe 4: coefficient 7 of channel 1"},
        {"infinity", break_radiance_infinite, "coefficient 8 of channel 2"},
        {"NaN in another set", break_second_set, "set 1, probe 3: coefficient 2 of channel 0"},
        {"no set", break_no_set, "arrays"},
        {"a set without radiance", break_set_missing, "arrays"},
        {"validity above 1", break_validity_high, "probe 2: validity"},
        {"validity below 0", break_validity_low, "probe 2: validity"},
        {"validity NaN", break_validity_nan, "probe 0: validity"},
    };
    const lmb_lattice lattice = {.spacing = 0.25f, .min = {-2, 0, 3}, .size = {3, 4, 5}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 0.5, 3.0, i);
        lmb_error error = {""};
        CHECK(lmb_probes_validate(probes, &error) == LMB_OK, "%s: before: %s", cases[i].name, error.message);
        const uint32_t levels = probes->level_count;
        cases[i].break_it(probes);
        CHECK(lmb_probes_validate(probes, &error) == LMB_ERROR_FORMAT, "%s is not found", cases[i].name);
        CHECK(strstr(error.message, cases[i].expected), "%s: '%s'", cases[i].name, error.message);
        probes->level_count = levels; /* that what they hold is freed */
        lmb_probes_destroy(probes);
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
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {-7, 100, 3}, .size = {size[0], size[1], size[2]}};
    const int32_t *const min = lattice.min;
    lmb_probes *const probes = fixture_random_probes(&lattice, density, valid_share, 10.0, seed);
    const size_t points = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
    oracle o = {{size[0], size[1], size[2]}, calloc(points, 1), calloc(points, 1), calloc(points, sizeof(double[27]))};
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        const int32_t *const at = probes->point[probe];
        const size_t point = oracle_point(&o, at[0] - min[0], at[1] - min[1], at[2] - min[2]);
        o.exists[point] = true;
        o.has_light[point] = probes->validity[probe] >= 0.5f;
        for (int i = 0; i < 27; ++i) {
            o.value[point][i] = o.has_light[point] ? (double)probes->radiance[0][probe].channel[i / 9].c[i % 9] : 0.0;
        }
    }
    oracle_dilate(&o);
    CHECK(lmb_probes_dilate(probes) == LMB_OK, "dilate");
    CHECK(lmb_probes_validate(probes, NULL) == LMB_OK, "valid afterwards");
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        const int32_t *const at = probes->point[probe];
        const size_t point = oracle_point(&o, at[0] - min[0], at[1] - min[1], at[2] - min[2]);
        for (int i = 0; i < 27; ++i) {
            /* Probes round to float in every pass, the oracle never does. */
            CHECK_NEAR(probes->radiance[0][probe].channel[i / 9].c[i % 9], o.value[point][i], 2e-5,
                       "density %g, valid %g, seed %llu, probe %d, coefficient %d", density, valid_share,
                       (unsigned long long)seed, probe, i);
        }
    }
    free(o.exists);
    free(o.has_light);
    free(o.value);
    lmb_probes_destroy(probes);
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
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {9, 8, 7}};
    lmb_probes *const forward = fixture_random_probes(&lattice, 0.7, 0.1, 5.0, 42);
    lmb_probes *const backward = fixture_random_probes(&lattice, 0.7, 0.1, 5.0, 42);
    const int32_t count = forward->count;
    for (int32_t probe = 0; probe < count; ++probe) {
        const int32_t other = count - 1 - probe;
        memcpy(backward->point[other], forward->point[probe], sizeof forward->point[probe]);
        backward->radiance[0][other] = forward->radiance[0][probe];
        backward->validity[other] = forward->validity[probe];
    }
    for (int32_t n = 0; n < count; ++n) {
        int32_t *const at = entry(backward, n);
        *at = count - 1 - *at;
    }
    CHECK(lmb_probes_validate(backward, NULL) == LMB_OK, "the renumbered probes are valid");
    CHECK(lmb_probes_dilate(forward) == LMB_OK && lmb_probes_dilate(backward) == LMB_OK, "dilate");
    for (int32_t probe = 0; probe < count; ++probe) {
        CHECK(memcmp(&forward->radiance[0][probe], &backward->radiance[0][count - 1 - probe], sizeof(lmb_sh3_rgb)) == 0,
              "probe %d", probe);
    }
    lmb_probes_destroy(forward);
    lmb_probes_destroy(backward);
}

/* A lattice of 10^12 points holds what its few probes take, and finds them; a second level lies over it. */
static void test_sparse(void)
{
    enum { COUNT = 3000 };
    static int32_t points[COUNT][3];
    uint64_t state = 11;
    for (int i = 0; i < COUNT; ++i) {
        points[i][0] = 3 * i - 5000;
        points[i][1] = (int32_t)(fixture_random(&state) * 9999.0) - 5000;
        points[i][2] = (int32_t)(fixture_random(&state) * 9999.0) - 5000;
    }
    const lmb_lattice fine = {.spacing = 0.5f, .min = {-5000, -5000, -5000}, .size = {10000, 10000, 10000}};
    const lmb_lattice coarse = {.spacing = 1.0f, .min = {-5000, -5000, -5000}, .size = {10000, 10000, 10000}};
    lmb_probes *probes = NULL;
    CHECK(lmb_probes_create(&probes) == LMB_OK && lmb_probes_add_level(probes, &fine, points, COUNT) == LMB_OK &&
              lmb_probes_add_level(probes, &coarse, points + 1000, 500) == LMB_OK,
          "two levels");
    CHECK(probes->count == COUNT + 500 && lmb_probes_validate(probes, NULL) == LMB_OK, "%d", probes->count);
    const size_t blocks = probes->level[0].index.block_count;
    CHECK(blocks <= COUNT, "%zu blocks", blocks);
    int lost = 0, found = 0;
    for (int i = 0; i < COUNT; ++i) {
        lost += lmb_probes_find(probes, 0, points[i][0], points[i][1], points[i][2]) != i;
        found += lmb_probes_find(probes, 0, points[i][0] + 1, points[i][1], points[i][2]) >= 0;
    }
    CHECK(lost == 0 && found == 0, "%d lost, %d found where none is", lost, found);
    CHECK(lmb_probes_find(probes, 1, points[1000][0], points[1000][1], points[1000][2]) == COUNT, "the second level");
    CHECK(lmb_probes_footprint(probes, COUNT - 1) == 0.5f && lmb_probes_footprint(probes, COUNT) == 1.0f, "footprints");
    const lmb_vec3 at = lmb_probes_position(probes, COUNT);
    CHECK(at.x == (float)points[1000][0], "%g", (double)at.x);
    probes->validity[0] = 1.0f;
    CHECK(lmb_probes_dilate(probes) == LMB_OK, "dilate");
    lmb_probes_destroy(probes);
}

/* Another value for every set, probe and coefficient. */
static float set_value(uint32_t set, int32_t probe, int i)
{
    return (float)(100000 * (int32_t)set + 100 * probe + i);
}

static void set_fill(lmb_probes *probes, uint32_t set)
{
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        for (int i = 0; i < 27; ++i) {
            probes->radiance[set][probe].channel[i / 9].c[i % 9] = set_value(set, probe, i);
        }
    }
}

/* Coefficients of probes first .. last - 1 that are not as set_fill left them; 0 * set_value where they are dark. */
static int set_differences(const lmb_probes *probes, uint32_t set, int32_t first, int32_t last, float factor)
{
    int differences = 0;
    for (int32_t probe = first; probe < last; ++probe) {
        for (int i = 0; i < 27; ++i) {
            differences += probes->radiance[set][probe].channel[i / 9].c[i % 9] != factor * set_value(set, probe, i);
        }
    }
    return differences;
}

/* Sets come before, between and after probes; each keeps what it was given, and new probes are dark in all. */
static void test_sets(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .size = {4, 3, 2}};
    lmb_probes *empty = NULL;
    uint32_t set = 7;
    CHECK(lmb_probes_create(&empty) == LMB_OK && lmb_probes_add_set(empty, &set) == LMB_OK, "a set of no probes");
    CHECK(set == 1 && empty->set_count == 2 && lmb_probes_validate(empty, NULL) == LMB_OK, "set %u of %u", set,
          empty->set_count);
    lmb_probes_destroy(empty);

    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 4.0, 1);
    const int32_t before = probes->count;
    set_fill(probes, 0);
    CHECK(lmb_probes_add_set(probes, &set) == LMB_OK && set == 1 && probes->set_count == 2, "set %u", set);
    CHECK(set_differences(probes, 0, 0, before, 1.0f) == 0 && set_differences(probes, 1, 0, before, 0.0f) == 0,
          "the first is as it was, the second dark");
    set_fill(probes, 1);
    const int32_t points[3][3] = {{5, 5, 5}, {6, 5, 5}, {7, 7, 7}};
    const lmb_lattice coarse = {.spacing = 2.0f, .size = {8, 8, 8}};
    CHECK(lmb_probes_add_level(probes, &coarse, points, 3) == LMB_OK && probes->count == before + 3, "more probes");
    CHECK(lmb_probes_add_set(probes, &set) == LMB_OK && set == 2, "set %u", set);
    for (uint32_t i = 0; i < 3; ++i) {
        CHECK(set_differences(probes, i, 0, before, i < 2 ? 1.0f : 0.0f) == 0, "set %u: earlier probes", i);
        CHECK(set_differences(probes, i, before, before + 3, 0.0f) == 0, "set %u: new probes", i);
    }
    CHECK(lmb_probes_validate(probes, NULL) == LMB_OK, "valid");
    lmb_probes_destroy(probes);
}

/* A set beside another dilates to what it does alone. */
static void test_dilation_of_sets(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .size = {7, 6, 5}};
    lmb_probes *const first = fixture_random_probes(&lattice, 0.8, 0.2, 5.0, 5);
    lmb_probes *const other = fixture_random_probes(&lattice, 0.8, 0.2, 5.0, 5);
    lmb_probes *const both = fixture_random_probes(&lattice, 0.8, 0.2, 5.0, 5);
    uint32_t set = 0;
    CHECK(lmb_probes_add_set(both, &set) == LMB_OK, "a set");
    set_fill(other, 0);
    const size_t bytes = (size_t)both->count * sizeof *both->radiance[0];
    memcpy(both->radiance[set], other->radiance[0], bytes);
    CHECK(lmb_probes_dilate(first) == LMB_OK && lmb_probes_dilate(other) == LMB_OK && lmb_probes_dilate(both) == LMB_OK,
          "dilate");
    CHECK(memcmp(both->radiance[0], first->radiance[0], bytes) == 0, "the first set");
    CHECK(memcmp(both->radiance[set], other->radiance[0], bytes) == 0, "the second set");
    CHECK(set_differences(both, 0, 0, both->count, 1.0f) > 0 &&
              memcmp(both->radiance[0], both->radiance[1], bytes) != 0,
          "they differ");
    lmb_probes_destroy(first);
    lmb_probes_destroy(other);
    lmb_probes_destroy(both);
}

/* Two levels, the second one turned: each finds its probes by their points, and a place of the world by its cell. */
static void test_turned_level(void)
{
    enum { SIDE = 6, COUNT = SIDE * SIDE * SIDE };
    static int32_t points[COUNT][3];
    for (int i = 0; i < COUNT; ++i) {
        points[i][0] = i % SIDE - 3;
        points[i][1] = i / SIDE % SIDE - 3;
        points[i][2] = i / SIDE / SIDE - 3;
    }
    uint64_t state = 77;
    rotation turn;
    const lmb_lattice straight = {.spacing = 0.5f, .min = {-3, -3, -3}, .size = {SIDE, SIDE, SIDE}};
    const lmb_lattice turned = turned_lattice(&state, 0.75f, &turn);
    lmb_probes *probes = NULL;
    CHECK(lmb_probes_create(&probes) == LMB_OK &&
              lmb_probes_add_level(probes, &straight, (const int32_t(*)[3])points, COUNT) == LMB_OK &&
              lmb_probes_add_level(probes, &turned, (const int32_t(*)[3])points, COUNT) == LMB_OK,
          "two levels");
    probes->origin = (lmb_vec3d){100.0, -20.0, 3.0};
    CHECK(lmb_probes_validate(probes, NULL) == LMB_OK, "valid");
    for (int i = 0; i < COUNT; ++i) {
        const int32_t *const at = points[i];
        CHECK(lmb_probes_find(probes, 0, at[0], at[1], at[2]) == i &&
                  lmb_probes_find(probes, 1, at[0], at[1], at[2]) == COUNT + i,
              "point %d", i);
        const lmb_vec3 found = lmb_probes_position(probes, COUNT + i);
        const lmb_vec3d expected = rotation_point(&turn, 0.75, at);
        CHECK_NEAR(found.x, expected.x - 100.0, 1e-5, "probe %d", COUNT + i);
        CHECK_NEAR(found.y, expected.y + 20.0, 1e-5, "probe %d", COUNT + i);
        CHECK_NEAR(found.z, expected.z - 3.0, 1e-5, "probe %d", COUNT + i);
        CHECK(lmb_probes_position(probes, i).x == 0.5f * (float)at[0] - 100.0f, "probe %d", i);
        /* From the world, at a place within the cell that the point is the first of. */
        const lmb_vec3d near = {at[0] + 0.2, at[1] + 0.3, at[2] + 0.4};
        int32_t cell[3] = {0};
        double fraction[3];
        CHECK(lmb_lattice_cell(&turned, rotation_place(&turn, 0.75, near), cell, fraction) &&
                  lmb_probes_find(probes, 1, cell[0], cell[1], cell[2]) == COUNT + i,
              "point %d: cell (%d, %d, %d)", i, cell[0], cell[1], cell[2]);
    }
    CHECK(lmb_probes_footprint(probes, COUNT) == 0.75f, "footprint");
    lmb_probes_destroy(probes);
}

static const test_case cases[] = {
    {"a sparse lattice", test_sparse},
    {"limits of a box", test_create_limits},
    {"limits of axes", test_axes_limits},
    {"a turned level beside another", test_turned_level},
    {"sets of lights", test_sets},
    {"each set dilates by itself", test_dilation_of_sets},
    {"probes and their places", test_probes},
    {"every broken invariant is found", test_validate},
    {"dilation follows its definition", test_dilation},
    {"dilation does not depend on the order of probes", test_dilation_order},
};
TEST_MAIN(cases)
