/* Ghosts and cut cells among probes in memory: what is taken and what is refused, what the walker finds, and the light
 * between them against answers worked out by hand. */
#include "cut_fixture.h"
#include "harness.h"
#include "probes_fixture.h"

#include <limits.h>

static void test_ghosts(void)
{
    const lmb_lattice fine = {.spacing = 0.5f, .min = {0, 0, 0}, .size = {3, 3, 3}};
    const lmb_lattice coarse = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {2, 2, 2}};
    lmb_probes *const probes = fixture_probes(&fine, NULL);
    static const int32_t of_fine[3][3] = {{1, 1, 1}, {1, 1, 1}, {2, 0, 2}}, of_coarse[1][3] = {{0, 1, 1}};
    static const int32_t corner[1][3] = {{1, 0, 0}}, outside[2][3] = {{0, 0, 0}, {0, 2, 0}};
    CHECK(lmb_probes_add_level(probes, &coarse, of_coarse, 1) == LMB_OK, "a level");
    probes->radiance[0][27].channel[0].c[0] = 5.0f;
    int32_t first = -7;
    CHECK(lmb_probes_add_ghosts(probes, 1, outside, 2, &first) == LMB_ERROR_ARGUMENT, "outside of the level's box");
    CHECK(lmb_probes_add_ghosts(probes, 1, outside, -1, &first) == LMB_ERROR_ARGUMENT, "less than none");
    CHECK(first == -7 && probes->count == 28 && probes->ghost_count == 0, "%d, %d probes", first, probes->count);
    /* The coarse level's first: levels have them in the order in which they were given them. */
    CHECK(lmb_probes_add_ghosts(probes, 1, of_coarse, 1, &first) == LMB_OK && first == 28, "%d", first);
    CHECK(lmb_probes_add_ghosts(probes, 0, of_fine, 3, &first) == LMB_OK && first == 29, "%d", first);
    CHECK(probes->count == 32 && probes->ghost_count == 4, "%d probes, %d ghosts", probes->count, probes->ghost_count);
    CHECK(lmb_probes_validate(probes, NULL) == LMB_OK, "valid");
    CHECK(lmb_probes_add_ghosts(probes, 0, of_fine, 1, &first) == LMB_ERROR_ARGUMENT, "a second time");
    CHECK(lmb_probes_add_level(probes, &coarse, corner, 1) == LMB_ERROR_ARGUMENT, "a level after ghosts");
    CHECK(probes->count == 32 && probes->level_count == 2, "%d probes", probes->count);
    CHECK(lmb_probes_level_of(probes, 28) == &probes->level[1] && lmb_probes_level_of(probes, 29) == probes->level &&
              lmb_probes_level_of(probes, 31) == probes->level && lmb_probes_level_of(probes, 27) == &probes->level[1],
          "levels");
    CHECK(lmb_probes_footprint(probes, 28) == 1.0f && lmb_probes_footprint(probes, 30) == 0.5f, "footprints");
    const lmb_vec3 at = lmb_probes_position(probes, 31);
    CHECK(at.x == 1.0f && at.y == 0.0f && at.z == 1.0f, "(%g, %g, %g)", (double)at.x, (double)at.y, (double)at.z);
    CHECK(lmb_probes_find(probes, 0, 1, 1, 1) == 13, "a point's probe is not its ghost");
    CHECK(probes->radiance[0][27].channel[0].c[0] == 5.0f && probes->radiance[0][30].channel[2].c[8] == 0.0f &&
              probes->validity[30] == 0.0f && probes->key_visibility[30][0] == 0.0f,
          "ghosts start dark, and others keep their light");
    lmb_probes_destroy(probes);
}

/* Dilation neither changes ghosts nor takes from them, whatever their validity. */
static void test_dilation_leaves_ghosts(void)
{
    lmb_probes *const with = cut_fixture_probes();
    const lmb_lattice *const lattice = &with->level[0].lattice;
    const int32_t ghosts = with->ghost_count;
    const int32_t solid = lmb_probes_find(with, 0, -2, 1, 1);
    with->validity[solid] = 0.2f;
    with->radiance[0][solid] = (lmb_sh3_rgb){0};
    for (int32_t ghost = with->count - ghosts; ghost < with->count; ++ghost) {
        with->validity[ghost] = ghost % 2 ? 0.0f : 1.0f;
    }
    const lmb_sh3_rgb odd = with->radiance[0][with->count - 1], even = with->radiance[0][with->count - 2];
    CHECK(lmb_probes_dilate(with) == LMB_OK, "dilate");
    CHECK(memcmp(&odd, &with->radiance[0][with->count - 1], sizeof odd) == 0 &&
              memcmp(&even, &with->radiance[0][with->count - 2], sizeof even) == 0,
          "a ghost's light has changed");
    /* All 26 neighbours are there and their light is linear: the mean is the light of the middle. */
    const lmb_vec3d at = lmb_lattice_position(lattice, (const int32_t[3]){-2, 1, 1});
    CHECK_NEAR(with->radiance[0][solid].channel[1].c[2], cut_fixture_light(11, at), 1e-5, "from its level's probes");
    lmb_probes_destroy(with);
}

/* ---------------------------------------------------------------------------------------------- refusals */

typedef struct cut_case {
    const char *name;
    int32_t point[3];
    uint32_t plane_count, region_count;
    lmb_cell_plane plane[3];
    int wrong_corner; /* of region 0, or -1 */
    int32_t wrong;
} cut_case;

/* Of one region, all probes but for the wrong one. */
static lmb_result cut_try(lmb_probes *probes, const cut_case *c)
{
    lmb_cell_plane plane[LMB_CELL_PLANES_MOST + 1];
    int32_t corner[LMB_CELL_REGIONS_MOST + 1][8];
    for (int k = 0; k < 8 * (LMB_CELL_REGIONS_MOST + 1); ++k) {
        const int at = k % 8;
        int32_t point[3];
        for (int axis = 0; axis < 3; ++axis) { /* the last of all points has no next one */
            point[axis] = c->point[axis] < INT32_MAX ? c->point[axis] + (at >> axis & 1) : INT32_MAX;
        }
        corner[k / 8][at] = lmb_probes_find(probes, 0, point[0], point[1], point[2]);
    }
    for (uint32_t i = 0; i < c->plane_count; ++i) {
        plane[i] = i < 3 ? c->plane[i] : (lmb_cell_plane){{1, 0, 0}, 0, {CUT_REGION(0), CUT_REGION(0)}};
    }
    if (c->wrong_corner >= 0) {
        corner[0][c->wrong_corner] = c->wrong;
    }
    return lmb_probes_cut(probes, 0, c->point, c->plane_count > 0 ? plane : NULL, c->plane_count,
                          (const int32_t(*)[8])corner, c->region_count);
}

#define SPLIT(low, high)                                                                                               \
    {                                                                                                                  \
        {16383, 0, 0}, 100,                                                                                            \
        {                                                                                                              \
            low, high                                                                                                  \
        }                                                                                                              \
    }

/* The lattice has 3 x 3 x 3 points: probes 0 to 26, x fastest, and 27 of the coarse level. Ghost 28 is of point (0, 0,
 * 0), 29 of (1, 1, 1), and 30 of the coarse level's (0, 0, 0). */
static const cut_case refused[] = {
    {"beyond the last cell", {2, 0, 0}, 0, 1, CUT_NO_PLANES, -1, 0},
    {"before the first cell", {0, -1, 0}, 0, 1, CUT_NO_PLANES, -1, 0},
    {"far outside", {INT32_MAX, INT32_MIN, 0}, 0, 1, CUT_NO_PLANES, 0, 0},
    {"no region", {0, 0, 0}, 0, 0, CUT_NO_PLANES, -1, 0},
    {"too many regions", {0, 0, 0}, 0, LMB_CELL_REGIONS_MOST + 1, CUT_NO_PLANES, -1, 0},
    {"too many planes", {0, 0, 0}, LMB_CELL_PLANES_MOST + 1, 2, {SPLIT(1, 2), SPLIT(128, 129), SPLIT(128, 129)}, -1, 0},
    {"a plane leads to itself", {0, 0, 0}, 1, 2, {SPLIT(CUT_REGION(0), 0)}, -1, 0},
    {"a plane leads backwards", {0, 0, 0}, 2, 2, {SPLIT(1, CUT_REGION(1)), SPLIT(0, CUT_REGION(0))}, -1, 0},
    {"a plane that is not there", {0, 0, 0}, 2, 2, {SPLIT(1, 2), SPLIT(CUT_REGION(0), CUT_REGION(1))}, -1, 0},
    {"a region that is not there", {0, 0, 0}, 1, 2, {SPLIT(CUT_REGION(0), CUT_REGION(2))}, -1, 0},
    {"a wedge beside itself", {0, 0, 0}, 2, 2, {SPLIT(1, CUT_REGION(1)), SPLIT(CUT_REGION(0), CUT_BLEND(1))}, -1, 0},
    {"a wedge of no plane", {0, 0, 0}, 2, 2, {SPLIT(1, CUT_REGION(1)), SPLIT(CUT_REGION(0), CUT_BLEND(2))}, -1, 0},
    {"a wedge of the last number", {0, 0, 0}, 2, 2, {SPLIT(1, CUT_REGION(1)), SPLIT(CUT_REGION(0), 255)}, -1, 0},
    {"two wedges of a plane", {0, 0, 0}, 2, 2, {SPLIT(1, CUT_REGION(1)), SPLIT(CUT_BLEND(0), CUT_BLEND(0))}, -1, 0},
    {"a wedge beside a plane",
     {0, 0, 0},
     3,
     2,
     {SPLIT(1, CUT_BLEND(2)), SPLIT(CUT_REGION(0), CUT_REGION(1)), SPLIT(CUT_REGION(0), CUT_BLEND(1))},
     -1,
     0},
    {"a wedge of two regions",
     {0, 0, 0},
     3,
     2,
     {SPLIT(1, 2), SPLIT(CUT_REGION(0), CUT_REGION(1)), SPLIT(CUT_REGION(0), CUT_BLEND(1))},
     -1,
     0},
    {"a wedge of no region", {0, 0, 0}, 3, 2, {SPLIT(1, 2), SPLIT(2, 2), SPLIT(CUT_REGION(0), CUT_BLEND(1))}, -1, 0},
    {"no probe", {0, 0, 0}, 0, 1, CUT_NO_PLANES, 3, -1},
    {"a probe that is not there", {0, 0, 0}, 0, 1, CUT_NO_PLANES, 3, 31},
    {"another corner's probe", {0, 0, 0}, 0, 1, CUT_NO_PLANES, 0, 1},
    {"another corner's ghost", {0, 0, 0}, 0, 1, CUT_NO_PLANES, 0, 29},
    {"another level's probe", {0, 0, 0}, 0, 1, CUT_NO_PLANES, 0, 27},
    {"another level's ghost", {0, 0, 0}, 0, 1, CUT_NO_PLANES, 0, 30},
};

static const cut_case taken[] = {
    {"a corner's ghost", {0, 0, 0}, 0, 1, CUT_NO_PLANES, 0, 28},
    {"another corner's", {1, 1, 1}, 1, 2, {SPLIT(CUT_REGION(1), CUT_REGION(0))}, 0, 29},
    {"a wedge",
     {0, 1, 0},
     3,
     2,
     {SPLIT(1, 2), SPLIT(CUT_REGION(0), CUT_BLEND(2)), SPLIT(CUT_BLEND(1), CUT_REGION(1))},
     -1,
     0},
    {"as many planes as may be",
     {1, 0, 0},
     LMB_CELL_PLANES_MOST,
     LMB_CELL_REGIONS_MOST,
     {SPLIT(1, 30), SPLIT(CUT_REGION(31), CUT_REGION(0)), SPLIT(CUT_REGION(0), CUT_REGION(0))},
     -1,
     0},
};

static lmb_probes *two_levels_with_ghosts(void)
{
    const lmb_lattice fine = {.spacing = 0.5f, .min = {0, 0, 0}, .size = {3, 3, 3}};
    const lmb_lattice coarse = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {2, 2, 2}};
    static const int32_t of_fine[2][3] = {{0, 0, 0}, {1, 1, 1}}, of_coarse[1][3] = {{0, 0, 0}};
    lmb_probes *const probes = fixture_probes(&fine, NULL);
    int32_t first;
    CHECK(lmb_probes_add_level(probes, &coarse, of_coarse, 1) == LMB_OK &&
              lmb_probes_add_ghosts(probes, 0, of_fine, 2, &first) == LMB_OK &&
              lmb_probes_add_ghosts(probes, 1, of_coarse, 1, &first) == LMB_OK && probes->count == 31,
          "%d probes", probes->count);
    return probes;
}

static void test_cutting(void)
{
    lmb_probes *const probes = two_levels_with_ghosts();
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; ++i) {
        CHECK(cut_try(probes, &refused[i]) == LMB_ERROR_ARGUMENT, "%s is not refused", refused[i].name);
        CHECK(probes->cut.count == 0 && probes->cut.plane_count == 0 && probes->cut.region_count == 0,
              "%s left something", refused[i].name);
    }
    for (size_t i = 0; i < sizeof taken / sizeof taken[0]; ++i) {
        const lmb_cut_cells before = probes->cut;
        CHECK(cut_try(probes, &taken[i]) == LMB_OK, "%s is refused", taken[i].name);
        CHECK(probes->cut.count == before.count + 1 && probes->cut.cell[i].plane_first == before.plane_count &&
                  probes->cut.cell[i].region_first == before.region_count,
              "%s", taken[i].name);
        CHECK(cut_try(probes, &taken[i]) == LMB_ERROR_ARGUMENT, "%s a second time", taken[i].name);
        CHECK(probes->cut.count == before.count + 1, "%s a second time", taken[i].name);
    }
    lmb_error error = {""};
    CHECK(lmb_probes_validate(probes, &error) == LMB_OK, "%s", error.message);
    lmb_probes_destroy(probes);
}

/* -------------------------------------------------------------------------------------------- the walker */

static void break_ghost_point(lmb_probes *probes)
{
    ++probes->point[probes->count - 1][0];
}
static void break_ghost_outside(lmb_probes *probes)
{
    probes->point[probes->level[0].ghost_first][1] = 3;
}
static void break_ghost_count(lmb_probes *probes)
{
    --probes->level[0].ghost_count;
}
static void break_ghost_first(lmb_probes *probes)
{
    probes->level[1].ghost_first = INT32_MAX - 1;
}
static void break_ghost_light(lmb_probes *probes)
{
    probes->radiance[0][probes->count - 1].channel[1].c[3] = NAN;
}
static void break_cell_point(lmb_probes *probes)
{
    ++probes->cut.cell[0].point[2];
}
static void break_cell_level(lmb_probes *probes)
{
    probes->cut.cell[2].level = 2;
}
static void break_cell_index(lmb_probes *probes)
{
    probes->level[1].cut.block[0].probe[0] = 3;
}
static void break_child(lmb_probes *probes)
{
    probes->cut.plane[2].child[1] = 1;
}
static void break_region(lmb_probes *probes)
{
    probes->cut.plane[0].child[0] = CUT_REGION(2);
}
static void break_regions(lmb_probes *probes)
{
    probes->cut.cell[1].region_count = 0;
}
static void break_corner(lmb_probes *probes)
{
    probes->cut.corner[probes->cut.region_count - 1][7] = 0;
}
static void break_plane_range(lmb_probes *probes)
{
    probes->cut.cell[0].plane_first = probes->cut.plane_count;
}
static void break_region_range(lmb_probes *probes)
{
    probes->cut.cell[0].region_first = UINT32_MAX;
}

static void test_validate(void)
{
    static const struct {
        const char *name;
        void (*break_it)(lmb_probes *probes);
        const char *expected;
    } cases[] = {
        {"a ghost's point", break_ghost_point, "cut cell"},
        {"a ghost outside", break_ghost_outside, "cut cell"},
        {"ghosts of levels", break_ghost_count, "cut cell"},
        {"a level's first ghost", break_ghost_first, "cut cell"},
        {"a ghost's light", break_ghost_light, "coefficient 3 of channel 1"},
        {"a cell's point", break_cell_point, "cut cell"},
        {"a cell's level", break_cell_level, "cut cell"},
        {"the index of cells", break_cell_index, "cut cell"},
        {"a plane's child", break_child, "cut cell"},
        {"a plane's region", break_region, "cut cell"},
        {"no regions", break_regions, "cut cell"},
        {"a corner", break_corner, "cut cell"},
        {"planes of nobody", break_plane_range, "cut cell"},
        {"regions of nobody", break_region_range, "cut cell"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_probes *const probes = cut_fixture_probes();
        lmb_error error = {""};
        CHECK(lmb_probes_validate(probes, &error) == LMB_OK, "before: %s", error.message);
        cases[i].break_it(probes);
        CHECK(lmb_probes_validate(probes, &error) == LMB_ERROR_FORMAT, "%s is not found", cases[i].name);
        CHECK(strstr(error.message, cases[i].expected), "%s: '%s'", cases[i].name, error.message);
        lmb_probes_destroy(probes);
    }
}

/* ---------------------------------------------------------------------------------------------- the light */

/* What ghosts add at a place of cell (x, y, z) of the finest level: their jump, times the sum of their weights. */
static double fine_ghosts(const int cell[3], double x, double y, double z)
{
    if (cell[0] == -4 && cell[1] == 0 && cell[2] == 0) {
        return x <= 4096.0 / 16383.0 ? cut_fixture_jump(0, 0) * x : cut_fixture_jump(0, 1) * (1.0 - x);
    }
    if (cell[0] == -3 && cell[1] == 0 && cell[2] == 0) {
        return cut_fixture_jump(1, 0) * (1.0 - x) * (1.0 - y) * (1.0 - z);
    }
    if (cell[0] == -2 && cell[1] == 0 && cell[2] == 0) {
        const double half = 8192.0 / 16383.0;
        return x <= half   ? cut_fixture_jump(2, 0) * x
               : y <= half ? cut_fixture_jump(2, 1) * (1.0 - x * (1.0 - y))
                           : cut_fixture_jump(2, 2) * (1.0 - x * y);
    }
    if (cell[0] == -4 && cell[1] == 3 && cell[2] == 3) {
        return cut_fixture_jump(3, 0) * (1.0 - x) * y * z;
    }
    return 0.0;
}

/* Of coefficient 0, for a place in -2 .. 2 by 0 .. 2 by 0 .. 2. @return false where there is no cell */
static bool expected_light(lmb_vec3d at, double *expected)
{
    const double plain = cut_fixture_light(0, at);
    if (at.x < 0.0) {
        const int cell[3] = {(int)floor(2.0 * at.x), (int)floor(2.0 * at.y), (int)floor(2.0 * at.z)};
        *expected = plain + fine_ghosts(cell, 2.0 * at.x - cell[0], 2.0 * at.y - cell[1], 2.0 * at.z - cell[2]);
        return cell[0] != -1 || cell[1] != 0 || cell[2] != 3;
    }
    double ghosts = 0.0;
    if (at.x >= 1.0 && at.y < 1.0 && at.z < 1.0) { /* the wall that ends, and what is beyond */
        const double x = at.x - 1.0, above = x + at.z - 1.0, below = x - at.z;
        const double low = cut_fixture_jump(5, 0) * at.z, high = cut_fixture_jump(5, 1) * (1.0 - at.z);
        const double share = above > 0.0 && below > 0.0 ? above / (above + below) : at.z <= 0.5 ? 0.0 : 1.0;
        ghosts = low + share * (high - low);
    }
    if (at.x < 1.0 && at.y < 1.0 && at.z < 1.0) {
        ghosts = at.x + at.y <= 1.0 ? cut_fixture_jump(4, 0) * at.x * at.y
                                    : cut_fixture_jump(4, 1) * (1.0 - at.x) * (1.0 - at.y);
    }
    *expected = plain + CUT_FIXTURE_COARSE_MORE + ghosts;
    return true;
}

static void check_light(const lmb_probes *probes, lmb_vec3d at)
{
    const lmb_sh3_rgb light = lmb_probes_light(probes, 0, at);
    double expected = 0.0;
    const bool has_cell = expected_light(at, &expected);
    CHECK_NEAR(light.channel[0].c[0], has_cell ? expected : 0.0, 1e-3, "at (%.9g, %.9g, %.9g)", at.x, at.y, at.z);
    /* Coefficients differ by a constant, which weights of sum 1 keep. */
    CHECK_NEAR(light.channel[2].c[8], has_cell ? expected + 26.0 : 0.0, 1e-3, "at (%.9g, %.9g, %.9g)", at.x, at.y,
               at.z);
}

static void test_light(void)
{
    lmb_probes *const probes = cut_fixture_probes();
    uint64_t state = 5;
    for (int i = 0; i < 20000; ++i) {
        const lmb_vec3d at = {-2.0 + 4.0 * fixture_random(&state), 2.0 * fixture_random(&state),
                              2.0 * fixture_random(&state)};
        if (fabs(at.x + at.y - 1.0) > 1e-4) { /* the oblique plane is in 16383ths */
            check_light(probes, at);
        }
    }
    /* Low sides belong to a cell, a plane to the region below it. */
    static const lmb_vec3d edges[] = {
        {-2.0, 0.0, 0.0},       {-1.5, 0.0, 0.0},     {-1.0, 0.0, 0.0}, {-1.0, 0.5, 0.5},
        {-0.5, 0.0, 0.5},       {-0.00001, 0.0, 0.5}, {0.0, 0.0, 0.0},  {0.0, 1.0, 1.0},
        {-2.0, 1.9999, 1.9999}, {-2.0, 1.0, 1.0},     {-0.2, 0.2, 1.7},
    };
    for (size_t i = 0; i < sizeof edges / sizeof edges[0]; ++i) {
        check_light(probes, edges[i]);
    }
    lmb_probes_destroy(probes);
}

/* Which cell, region and probes a place has. */
static void test_cells(void)
{
    static const struct {
        lmb_vec3d at;
        uint32_t level;
        int32_t point[3];
        int32_t cut; /* -1: a plain cell */
        uint32_t region;
    } cases[] = {
        {{-1.9, 0.1, 0.1}, 0, {-4, 0, 0}, 0, 0},    {{-1.6, 0.1, 0.1}, 0, {-4, 0, 0}, 0, 1},
        {{-1.25, 0.25, 0.25}, 0, {-3, 0, 0}, 1, 0}, {{-0.9, 0.4, 0.1}, 0, {-2, 0, 0}, 2, 0},
        {{-0.6, 0.1, 0.1}, 0, {-2, 0, 0}, 2, 1},    {{-0.6, 0.4, 0.1}, 0, {-2, 0, 0}, 2, 2},
        {{-0.4, 0.2, 0.2}, 0, {-1, 0, 0}, -1, 0},   {{-0.4, 1.2, 1.7}, 0, {-1, 2, 3}, -1, 0},
        {{0.8, 0.8, 0.1}, 1, {0, 0, 0}, 4, 1},      {{1.8, 1.8, 0.1}, 1, {1, 1, 0}, -1, 0},
    };
    lmb_probes *const probes = cut_fixture_probes();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_probe_cell cell = {0};
        CHECK(lmb_probes_cell(probes, cases[i].at, &cell), "case %zu: no cell", i);
        CHECK(cell.level == cases[i].level && memcmp(cell.point, cases[i].point, sizeof cell.point) == 0 &&
                  cell.cut == cases[i].cut && cell.region == cases[i].region,
              "case %zu: level %u, (%d, %d, %d), cut %d, region %u", i, cell.level, cell.point[0], cell.point[1],
              cell.point[2], cell.cut, cell.region);
        const double spacing = (double)probes->level[cell.level].lattice.spacing;
        CHECK_NEAR((cell.point[2] + cell.fraction[2]) * spacing, cases[i].at.z, 1e-12, "case %zu", i);
        CHECK(probes->point[cell.probe[5]][0] == cell.point[0] + 1 &&
                  probes->point[cell.probe[5]][1] == cell.point[1] &&
                  probes->point[cell.probe[5]][2] == cell.point[2] + 1,
              "case %zu: corner 5 is elsewhere", i);
    }
    lmb_probes_destroy(probes);
}

static void test_no_light(void)
{
    lmb_probes *const probes = cut_fixture_probes();
    static const lmb_vec3d outside[] = {{-2.001, 0.5, 0.5}, {-0.2, 0.2, 1.7}, {2.0, 0.5, 0.5}, {0.5, 2.0, 0.5},
                                        {0.5, 0.5, -0.001}, {NAN, 0.5, 0.5},  {1e300, 0, 0},   {0, -INFINITY, 0}};
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; ++i) {
        int32_t probe[8] = {-7};
        double fraction[3] = {-7.0};
        CHECK(!lmb_probes_around(probes, outside[i], probe, fraction) && probe[0] == -7 && fraction[0] == -7.0,
              "place %zu", i);
        CHECK(lmb_probes_light(probes, 0, outside[i]).channel[1].c[4] == 0.0f, "place %zu", i);
    }
    lmb_probes_destroy(probes);
}

/* A set that is added has light of its own, in ghosts too. */
static void test_light_of_sets(void)
{
    lmb_probes *const probes = cut_fixture_probes();
    uint32_t set;
    CHECK(lmb_probes_add_set(probes, &set) == LMB_OK, "a set");
    for (int32_t ghost = probes->count - probes->ghost_count; ghost < probes->count; ++ghost) {
        probes->radiance[set][ghost].channel[0].c[0] = 8.0f;
    }
    const lmb_vec3d at = {-1.875, 0.2, 0.3}; /* a quarter of the way, on the plane's low side but for rounding */
    CHECK_NEAR(lmb_probes_light(probes, set, at).channel[0].c[0], 8.0 * 0.25, 1e-6, "of four ghosts at x = 1");
    check_light(probes, at);
    lmb_probes_destroy(probes);
}

static const test_case cases[] = {
    {"ghosts", test_ghosts},
    {"dilation leaves ghosts alone", test_dilation_leaves_ghosts},
    {"cutting cells", test_cutting},
    {"every broken invariant is found", test_validate},
    {"light in cut cells and levels", test_light},
    {"the cell of a place", test_cells},
    {"no light where there is no cell", test_no_light},
    {"each set has its light", test_light_of_sets},
};
TEST_MAIN(cases)
