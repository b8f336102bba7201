/* Levels beside each other: which cells are leaves, which probes hang, and that light has no step between levels. */
#include <lambent/probes.h>

#include <stdlib.h>

#include "harness.h"
#include "probes_fixture.h"

enum { COARSE_CELLS = 8 };

/* Points of the corners of some cells, as the cells come: once each. */
typedef struct cell_points {
    int32_t count;
    int32_t point[4096][3];
    lmb_probe_index index;
} cell_points;

static void cell_add(cell_points *points, int32_t x, int32_t y, int32_t z)
{
    for (int i = 0; i < 8; ++i) {
        const int32_t at[3] = {x + (i & 1), y + (i >> 1 & 1), z + (i >> 2)};
        if (lmb_probe_index_add(&points->index, at, points->count) == LMB_OK) {
            memcpy(points->point[points->count++], at, sizeof at);
        }
    }
}

static void level_add(lmb_probes *probes, cell_points *points, float spacing)
{
    const lmb_lattice lattice = {.spacing = spacing, .min = {-64, -64, -64}, .size = {129, 129, 129}};
    CHECK(lmb_probes_add_level(probes, &lattice, (const int32_t(*)[3])points->point, points->count) == LMB_OK,
          "%d points", points->count);
    lmb_probe_index_free(&points->index);
    points->count = 0;
}

/* Whether the cube around a cell of 2 m is that of `level`: cells of 1 m fill cube (0, 0, 0) and (1, 0, 0), cells of
 * half a metre cube (3, 2, 1) of those of 1 m, at the face that coarse cells begin beyond. */
static bool is_divided(int32_t x, int32_t y, int32_t z, bool second)
{
    return second ? x == 3 && y == 1 && z == 1 : (x == 0 || x == 1) && y == 0 && z == 0;
}

static int32_t half_of(int32_t cell)
{
    return (cell - (cell & 1)) / 2;
}

/* Cells of 2 m in [-8, 8]^3 m, of 1 m in [0, 8] x [0, 4] x [0, 4] m, of 0.5 m in [6, 8] x [2, 4] x [2, 4] m: these
 * touch both others. All are valid; light is random. */
static lmb_probes *levels_make(void)
{
    static cell_points points;
    lmb_probes *probes = NULL;
    CHECK(lmb_probes_create(&probes) == LMB_OK, "create");
    for (int32_t level = 0; level < 3; ++level) {
        const int32_t cells = COARSE_CELLS << (2 - level), first = level == 2 ? -COARSE_CELLS / 2 : 0;
        for (int32_t i = 0; i < cells * cells * cells; ++i) {
            const int32_t x = first + i % cells, y = first + i / cells % cells, z = first + i / cells / cells;
            const int32_t parent[3] = {half_of(half_of(x)), half_of(half_of(y)), half_of(half_of(z))};
            const bool there = level == 2 || is_divided(parent[0], parent[1], parent[2], level == 0);
            const bool divided = level > 0 && is_divided(half_of(x), half_of(y), half_of(z), level == 1);
            if (there && !divided) {
                cell_add(&points, x, y, z);
            }
        }
        level_add(probes, &points, 0.5f * (float)(1 << level));
    }
    probes->key_light_count = 1;
    probes->key_light[0] = (lmb_key_light){.direction = {0.0f, 1.0f, 0.0f}, .irradiance = {{1.0f, 1.0f, 1.0f}}};
    uint64_t state = 12345;
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        probes->validity[probe] = 1.0f;
        for (int i = 0; i < 27; ++i) {
            probes->radiance[0][probe].channel[i / 9].c[i % 9] = (float)fixture_random(&state);
        }
        probes->key_visibility[probe][0] = (float)fixture_random(&state);
    }
    lmb_probes_find_hanging(probes, 0, probes->count, NULL, NULL);
    return probes;
}

static void leaves_are_the_finest_cells(void)
{
    lmb_probes *probes = levels_make();
    static const struct {
        uint32_t level;
        int32_t cell[3];
        bool is_leaf;
    } table[] = {
        {2, {-1, 0, 0}, true}, {2, {0, 0, 0}, false},  {2, {1, 1, 1}, false},  {2, {3, 1, 1}, false},
        {2, {0, 2, 0}, true},  {2, {4, 0, 0}, false},  {1, {0, 0, 0}, true},   {1, {5, 3, 3}, true},
        {1, {6, 2, 2}, false}, {1, {7, 3, 3}, false},  {1, {-1, 0, 0}, false}, {0, {12, 4, 4}, true},
        {0, {15, 7, 7}, true}, {0, {11, 4, 4}, false},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        CHECK(lmb_probes_cell_is_leaf(probes, table[i].level, table[i].cell) == table[i].is_leaf, "case %zu", i);
    }
    lmb_error error = {{0}};
    CHECK(lmb_probes_validate(probes, &error) == LMB_OK, "%s", error.message);
    lmb_probes_destroy(probes);
}

/* Whether a place, by its coordinates in metres, lies on the closed cells of 2 m, or on those of 1 m and on no such. */
static bool is_on_coarser(uint32_t level, const double at[3])
{
    const bool in_fine = at[0] > 0.0 && at[0] < 8.0 && at[1] > 0.0 && at[1] < 4.0 && at[2] > 0.0 && at[2] < 4.0;
    const bool at_end = at[0] == 8.0 && at[1] > 0.0 && at[1] < 4.0 && at[2] > 0.0 && at[2] < 4.0; /* no cell beyond */
    const bool in_finest = at[0] > 6.0 && at[0] <= 8.0 && at[1] > 2.0 && at[2] > 2.0;
    return level == 1 ? !(in_fine || at_end) : level == 0 && !((in_fine || at_end) && in_finest);
}

static void probes_on_coarser_leaves_hang(void)
{
    lmb_probes *probes = levels_make();
    int hanging = 0;
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        const lmb_probe_level *level = lmb_probes_level_of(probes, probe);
        const lmb_vec3d at = lmb_lattice_position(&level->lattice, probes->point[probe]);
        lmb_probe_parents parents;
        const bool hangs = lmb_probes_hangs(probes, probe, &parents);
        CHECK(hangs == is_on_coarser((uint32_t)(level - probes->level), (const double[3]){at.x, at.y, at.z}),
              "%g %g %g of %g m", at.x, at.y, at.z, (double)level->lattice.spacing);
        hanging += hangs;
        lmb_vec3d middle = {0.0, 0.0, 0.0};
        for (int i = 0; i < 8 && hangs; ++i) {
            const lmb_probe_level *coarser = lmb_probes_level_of(probes, parents.probe[i]);
            const lmb_vec3d corner = lmb_lattice_position(&coarser->lattice, probes->point[parents.probe[i]]);
            CHECK(coarser > level, "a parent of its own level");
            middle.x += parents.weight[i] * corner.x;
            middle.y += parents.weight[i] * corner.y;
            middle.z += parents.weight[i] * corner.z;
        }
        CHECK(!hangs || (middle.x == at.x && middle.y == at.y && middle.z == at.z), "%g %g %g", at.x, at.y, at.z);
    }
    CHECK(hanging > 100, "%d", hanging);
    lmb_probes_destroy(probes);
}

/* What trilinear interpolation reproduces: of the place in metres. */
static float field_of(lmb_vec3d at)
{
    return (float)(1.0 + 0.3 * at.x - 0.2 * at.y + 0.5 * at.z);
}

static void linear_light_is_exact(void)
{
    lmb_probes *probes = levels_make();
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        lmb_probe_parents parents;
        const lmb_lattice *lattice = &lmb_probes_level_of(probes, probe)->lattice;
        const float light = field_of(lmb_lattice_position(lattice, probes->point[probe]));
        probes->radiance[0][probe].channel[1].c[0] = lmb_probes_hangs(probes, probe, &parents) ? 1000.0f : light;
    }
    lmb_probes_hang(probes);
    uint64_t state = 7;
    for (int i = 0; i < 2000; ++i) {
        const lmb_vec3d at = {16.0 * fixture_random(&state) - 8.0, 16.0 * fixture_random(&state) - 8.0,
                              16.0 * fixture_random(&state) - 8.0};
        CHECK_NEAR(lmb_probes_light(probes, 0, at).channel[1].c[0], field_of(at), 1e-5, "%g %g %g", at.x, at.y, at.z);
    }
    lmb_probes_destroy(probes);
}

/* The largest change of a coefficient over short steps across faces of cells. */
static double largest_step(const lmb_probes *probes)
{
    const double step = 1e-6;
    uint64_t state = 99;
    double largest = 0.0;
    for (int line = 0; line < 300; ++line) {
        const int axis = line % 3;
        double at[3];
        for (int i = 0; i < 3; ++i) {
            at[i] = 12.0 * fixture_random(&state) - 3.0;
        }
        for (int cut = 0; cut < 16; ++cut) {
            at[axis] = 0.5 * cut - 0.5 * step; /* all faces of cells of 0.5 m along it */
            const lmb_vec3d before = {at[0], at[1], at[2]};
            at[axis] += step;
            const lmb_vec3d after = {at[0], at[1], at[2]};
            const lmb_sh3_rgb a = lmb_probes_light(probes, 0, before), b = lmb_probes_light(probes, 0, after);
            for (int i = 0; i < 27; ++i) {
                largest = fmax(largest, fabs((double)a.channel[i / 9].c[i % 9] - (double)b.channel[i / 9].c[i % 9]));
            }
        }
    }
    return largest;
}

static void there_is_no_step_between_levels(void)
{
    lmb_probes *probes = levels_make();
    CHECK(largest_step(probes) > 0.1, "before it hangs: %g", largest_step(probes));
    lmb_probes_hang(probes);
    CHECK(largest_step(probes) < 1e-4, "%g", largest_step(probes));
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        lmb_probe_parents parents;
        double seen = 0.0;
        if (lmb_probes_hangs(probes, probe, &parents)) {
            for (int i = 0; i < 8; ++i) {
                seen += parents.weight[i] * (double)probes->key_visibility[parents.probe[i]][0];
            }
            CHECK_NEAR(probes->key_visibility[probe][0], seen, 1e-6, "probe %d", probe);
        }
    }
    lmb_probes_destroy(probes);
}

/* Light of a probe that is not valid comes from its own level, through hanging neighbours too. */
static void dilation_goes_through_hanging_probes(void)
{
    lmb_probes *probes = levels_make();
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        const bool coarsest = lmb_probes_level_of(probes, probe) == &probes->level[2];
        probes->validity[probe] = coarsest ? 1.0f : 0.0f;
        probes->radiance[0][probe].channel[0].c[0] = coarsest ? 5.0f : -1.0f;
    }
    CHECK(lmb_probes_dilate(probes) == LMB_OK, "dilate");
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        CHECK_NEAR(probes->radiance[0][probe].channel[0].c[0], 5.0, 1e-5, "probe %d", probe);
    }
    lmb_probes_destroy(probes);
}

/* A wall on x = 0, of which probes on the face that the coarser cells before it begin at see the other side. */
static bool sees_from_behind(void *context, int32_t probe, lmb_vec3d place)
{
    const lmb_probes *probes = context;
    const lmb_probe_level *level = lmb_probes_level_of(probes, probe);
    const double x = lmb_lattice_position(&level->lattice, probes->point[probe]).x;
    return !(x == 0.0 && place.x < 0.0);
}

static void walls_part_levels(void)
{
    lmb_probes *probes = levels_make();
    lmb_probes_find_hanging(probes, 0, probes->count, sees_from_behind, probes);
    int standing = 0, hanging = 0;
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        const lmb_probe_level *level = lmb_probes_level_of(probes, probe);
        const lmb_vec3d at = lmb_lattice_position(&level->lattice, probes->point[probe]);
        lmb_probe_parents parents;
        const bool hangs = lmb_probes_hangs(probes, probe, &parents);
        const bool at_wall = level == &probes->level[1] && at.x == 0.0;
        /* At its rim other coarse cells are seen, beyond y and z. */
        const bool at_rim = at.y == 0.0 || at.y == 4.0 || at.z == 0.0 || at.z == 4.0;
        CHECK(!at_wall || hangs == at_rim, "%g %g %g", at.x, at.y, at.z);
        standing += at_wall && !hangs;
        hanging += hangs;
        for (int i = 0; i < 8 && hangs && at_wall; ++i) {
            const lmb_vec3d corner = lmb_lattice_position(&probes->level[2].lattice, probes->point[parents.probe[i]]);
            CHECK(corner.x >= 0.0, "%g %g %g hangs through the wall", at.x, at.y, at.z);
        }
    }
    CHECK(standing == 9 && hanging > 100, "%d, %d", standing, hanging);
    lmb_probes_destroy(probes);
}

static const test_case cases[] = {
    {"leaves are the finest cells", leaves_are_the_finest_cells},
    {"probes on coarser leaves hang", probes_on_coarser_leaves_hang},
    {"linear light is exact", linear_light_is_exact},
    {"walls part levels", walls_part_levels},
    {"there is no step between levels", there_is_no_step_between_levels},
    {"dilation goes through hanging probes", dilation_goes_through_hanging_probes},
};

TEST_MAIN(cases)
