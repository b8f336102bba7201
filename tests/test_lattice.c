/* Where a lattice's points lie, turned or not, and which cell holds a place: against a rotation of the test's own. */
#include <lambent/lattice.h>

#include "harness.h"
#include "probes_fixture.h"
#include "turned_lattice.h"

#include <limits.h>

/* A frame from columns that are scaled and skewed, as an object's transform may have them, is the rotation alone. */
static void points_lie_where_a_rotation_puts_them(void)
{
    uint64_t state = 5;
    for (int round = 0; round < 200; ++round) {
        rotation turn;
        lmb_lattice lattice = turned_lattice(&state, 0.05f + (float)fixture_random(&state), &turn);
        CHECK(lmb_lattice_is_turned(&lattice), "round %d", round);
        for (int i = 0; i < 20; ++i) {
            int32_t point[3];
            for (int axis = 0; axis < 3; ++axis) {
                point[axis] = (int32_t)((fixture_random(&state) - 0.5) * 2e6);
            }
            const lmb_vec3d at = lmb_lattice_position(&lattice, point);
            const lmb_vec3d expected = rotation_point(&turn, (double)lattice.spacing, point);
            CHECK(places_distance(at, expected) < 1e-8 * (double)lattice.spacing,
                  "round %d: (%d, %d, %d) is at (%.12g, %.12g, %.12g), not (%.12g, %.12g, %.12g)", round, point[0],
                  point[1], point[2], at.x, at.y, at.z, expected.x, expected.y, expected.z);
        }
    }
}

static void world_to_cell_to_world(void)
{
    static const int32_t least[] = {0, -40, 1000000, -30000000};
    uint64_t state = 9;
    for (int round = 0; round < 400; ++round) {
        rotation turn;
        lmb_lattice lattice = turned_lattice(&state, 0.01f + 2.0f * (float)fixture_random(&state), &turn);
        double inside[3];
        for (int axis = 0; axis < 3; ++axis) {
            lattice.min[axis] = least[(round + axis) % 4];
            lattice.size[axis] = 2 + round % 60;
            inside[axis] = (lattice.size[axis] - 1) * (0.001 + 0.998 * fixture_random(&state));
        }
        const lmb_vec3d local = {lattice.min[0] + inside[0], lattice.min[1] + inside[1], lattice.min[2] + inside[2]};
        const lmb_vec3d world = rotation_place(&turn, (double)lattice.spacing, local);
        int32_t cell[3];
        double fraction[3];
        if (!lmb_lattice_cell(&lattice, world, cell, fraction)) {
            CHECK(false, "round %d: no cell", round);
            continue;
        }
        const double expected[3] = {local.x, local.y, local.z};
        for (int axis = 0; axis < 3; ++axis) {
            CHECK(fraction[axis] >= 0.0 && fraction[axis] < 1.0, "round %d: axis %d: %g", round, axis, fraction[axis]);
            CHECK_NEAR(cell[axis] + fraction[axis], expected[axis], 1e-6, "round %d: axis %d", round, axis);
        }
        const double spacing = (double)lattice.spacing;
        const lmb_vec3d first = lmb_lattice_position(&lattice, cell);
        const lmb_vec3d from_first = lmb_lattice_vector_to_world(
            &lattice, (lmb_vec3d){fraction[0] * spacing, fraction[1] * spacing, fraction[2] * spacing});
        const lmb_vec3d back = {first.x + from_first.x, first.y + from_first.y, first.z + from_first.z};
        CHECK(places_distance(back, world) < 1e-6 * spacing, "round %d: %g m away", round,
              places_distance(back, world));
        const lmb_vec3d beyond = rotation_place(&turn, spacing, (lmb_vec3d){local.x, local.y, lattice.min[2] - 0.01});
        CHECK(!lmb_lattice_cell(&lattice, beyond, cell, fraction), "round %d: a cell outside of the box", round);
    }
}

/* Axes that are the world's, however they are told, change no bit: -0 and what rounds included. */
static void the_worlds_axes_change_nothing(void)
{
    const lmb_lattice plain = {.spacing = 0.1f, .min = {-50, -50, -50}, .size = {101, 101, 101}};
    lmb_lattice told = plain;
    CHECK(lmb_lattice_turn(&told, (lmb_vec3d){3.0, 0.0, 0.0}, (lmb_vec3d){-7.0, 0.3, 0.0}), "turn");
    CHECK(told.axis[0].x == 1.0 && told.axis[1].y == 1.0 && told.axis[2].z == 1.0, "(%g, %g, %g)", told.axis[0].x,
          told.axis[1].y, told.axis[2].z);
    CHECK(!lmb_lattice_is_turned(&plain) && !lmb_lattice_is_turned(&told), "turned");
    static const lmb_vec3d vectors[] = {{-0.0, 1.0, -0.0}, {0.1, -0.0, 1e300}, {INFINITY, 1.0, 0.0}};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; ++i) {
        const lmb_vec3d to = lmb_lattice_vector_to_world(&told, vectors[i]);
        const lmb_vec3d from = lmb_lattice_vector_from_world(&told, vectors[i]);
        CHECK(memcmp(&to, &vectors[i], sizeof to) == 0 && memcmp(&from, &vectors[i], sizeof from) == 0, "vector %zu",
              i);
    }
    /* A place found by a product with 1 / 49 m would miss the point (1, 1, 1). */
    const lmb_lattice odd = {.spacing = 49.0f, .size = {9, 9, 9}};
    const lmb_vec3d one = lmb_lattice_coordinates(&odd, (lmb_vec3d){49.0, 49.0, 49.0});
    CHECK(one.x == 1.0 && one.y == 1.0 && one.z == 1.0, "(%.17g, %.17g, %.17g)", one.x, one.y, one.z);
    uint64_t state = 3;
    for (int i = 0; i < 1000; ++i) {
        int32_t point[3];
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = (int32_t)(fixture_random(&state) * 99.0) - 50;
        }
        const lmb_vec3d at = lmb_lattice_position(&plain, point), again = lmb_lattice_position(&told, point);
        const double spacing = (double)plain.spacing;
        const lmb_vec3d expected = {point[0] * spacing, point[1] * spacing, point[2] * spacing};
        CHECK(memcmp(&at, &expected, sizeof at) == 0 && memcmp(&again, &expected, sizeof at) == 0,
              "(%d, %d, %d) is at (%.17g, %.17g, %.17g)", point[0], point[1], point[2], at.x, at.y, at.z);
        int32_t cell[3] = {INT_MIN, INT_MIN, INT_MIN};
        double fraction[3];
        CHECK(lmb_lattice_cell(&plain, at, cell, fraction) && memcmp(cell, point, sizeof cell) == 0 &&
                  fraction[0] == 0.0 && fraction[1] == 0.0 && fraction[2] == 0.0,
              "(%d, %d, %d) lies in (%d, %d, %d)", point[0], point[1], point[2], cell[0], cell[1], cell[2]);
    }
}

/* Diagonal axes that are not the world's, and axes that only change places. */
static void half_and_quarter_turns(void)
{
    static const struct {
        lmb_vec3d x, y, expected; /* of point (1, 2, 3) */
    } cases[] = {
        {{-1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {-1.0, 2.0, -3.0}}, {{-1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}, {-1.0, -2.0, 3.0}},
        {{1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}, {1.0, -2.0, -3.0}}, {{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {-2.0, 1.0, 3.0}},
        {{0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {3.0, 1.0, 2.0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_lattice lattice = {.spacing = 1.0f, .size = {9, 9, 9}};
        CHECK(lmb_lattice_turn(&lattice, cases[i].x, cases[i].y) && lmb_lattice_is_turned(&lattice), "case %zu", i);
        const lmb_vec3d at = lmb_lattice_position(&lattice, (const int32_t[3]){1, 2, 3});
        CHECK(places_distance(at, cases[i].expected) == 0.0, "case %zu: (%g, %g, %g)", i, at.x, at.y, at.z);
        const lmb_vec3d point = lmb_lattice_coordinates(&lattice, at);
        CHECK(point.x == 1.0 && point.y == 2.0 && point.z == 3.0, "case %zu: (%g, %g, %g)", i, point.x, point.y,
              point.z);
    }
}

static void turns_that_are_none(void)
{
    static const struct {
        lmb_vec3d x, y;
        bool good;
    } cases[] = {
        {{0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, false},      {{1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, false},
        {{1.0, 2.0, 3.0}, {-2.0, -4.0, -6.0}, false},   {{1.0, 0.0, 0.0}, {1.0, 1e-7, 0.0}, false},
        {{1.0, 2.0, 3.0}, {1.0, 2.00001, 3.0}, true},   {{NAN, 0.0, 0.0}, {0.0, 1.0, 0.0}, false},
        {{1.0, 0.0, 0.0}, {0.0, INFINITY, 0.0}, false}, {{1e-101, 0.0, 0.0}, {0.0, 1.0, 0.0}, false},
        {{1.0, 0.0, 0.0}, {0.0, 1e101, 0.0}, false},    {{1e-99, 0.0, 1e-99}, {0.0, 1e99, 0.0}, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_lattice lattice = {.spacing = 2.0f, .min = {1, 2, 3}, .size = {4, 5, 6}};
        const lmb_lattice before = lattice;
        CHECK(lmb_lattice_turn(&lattice, cases[i].x, cases[i].y) == cases[i].good, "case %zu", i);
        CHECK(cases[i].good || memcmp(&lattice, &before, sizeof before) == 0, "case %zu: changed", i);
        for (int a = 0; a < 3 && cases[i].good; ++a) {
            for (int b = 0; b < 3; ++b) {
                const lmb_vec3d p = lattice.axis[a], q = lattice.axis[b];
                CHECK_NEAR(p.x * q.x + p.y * q.y + p.z * q.z, a == b ? 1.0 : 0.0, 1e-15, "case %zu: %d, %d", i, a, b);
            }
        }
    }
}

static void cells_have_their_low_sides(void)
{
    static const struct {
        lmb_vec3d at;
        int32_t size;
        bool inside;
        int32_t cell[3];
    } cases[] = {
        {{-1.0, 0.0, 0.5}, 3, true, {-2, 0, 1}},   {{0.0, 0.99, 1.0}, 3, false, {0, 0, 0}},
        {{-0.01, 0.99, 1.0}, 3, true, {-1, 1, 2}}, {{-1.01, 0.0, 0.5}, 3, false, {0, 0, 0}},
        {{-0.6, 1.0, 0.6}, 3, false, {0, 0, 0}},   {{-1.0, 0.0, 0.5}, 1, false, {0, 0, 0}},
        {{-1.0, NAN, 0.5}, 3, false, {0, 0, 0}},   {{-1.0, 0.0, INFINITY}, INT32_MAX - 1, false, {0, 0, 0}},
        {{-1.0, 0.0, 1e30}, 3, false, {0, 0, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const int32_t size = cases[i].size;
        const lmb_lattice lattice = {.spacing = 0.5f, .min = {-2, 0, 1}, .size = {size, size, size}};
        int32_t cell[3] = {INT_MIN, INT_MIN, INT_MIN};
        double fraction[3] = {-1.0, -1.0, -1.0};
        const bool inside = lmb_lattice_cell(&lattice, cases[i].at, cell, fraction);
        CHECK(inside == cases[i].inside, "case %zu", i);
        if (cases[i].inside) {
            CHECK(memcmp(cell, cases[i].cell, sizeof cell) == 0, "case %zu: (%d, %d, %d)", i, cell[0], cell[1],
                  cell[2]);
        } else {
            CHECK(cell[0] == INT_MIN && cell[2] == INT_MIN && fraction[1] == -1.0, "case %zu: outputs", i);
        }
    }
}

static const test_case cases[] = {
    {"points_lie_where_a_rotation_puts_them", points_lie_where_a_rotation_puts_them},
    {"world_to_cell_to_world", world_to_cell_to_world},
    {"the_worlds_axes_change_nothing", the_worlds_axes_change_nothing},
    {"half_and_quarter_turns", half_and_quarter_turns},
    {"turns_that_are_none", turns_that_are_none},
    {"cells_have_their_low_sides", cells_have_their_low_sides},
};
TEST_MAIN(cases)
