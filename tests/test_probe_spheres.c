/* Probes as spheres: what a ray meets, against all spheres one by one. */
#include "cut_fixture.h"
#include "harness.h"
#include "probes_fixture.h"

#include "probe_spheres.h"

#include <float.h>

#include <lambent/vector.h>

/* Where a ray first meets a sphere, or FLT_MAX. */
static double meet(const double centre[3], double radius, const double origin[3], const double direction[3],
                   double start)
{
    double b = 0.0, c = -radius * radius;
    for (int i = 0; i < 3; ++i) {
        b += (origin[i] - centre[i]) * direction[i];
        c += (origin[i] - centre[i]) * (origin[i] - centre[i]);
    }
    const double under = b * b - c;
    const double distance = under > 0.0 ? -b - sqrt(under) : (double)FLT_MAX;
    return distance > start ? distance : (double)FLT_MAX;
}

static double meet_all(const probe_spheres *spheres, const double origin[3], const double direction[3], double start)
{
    const lmb_probes *const probes = spheres->probes;
    const int32_t ghosts = probes->count - probes->ghost_count;
    double nearest = (double)FLT_MAX;
    for (int32_t i = 0; i < probes->count; ++i) {
        const double spacing = (double)lmb_probes_footprint(probes, i);
        const lmb_vec3d shift = i >= ghosts ? spheres->shift[i - ghosts] : (lmb_vec3d){0, 0, 0};
        const double centre[3] = {spacing * (probes->point[i][0] + shift.x), spacing * (probes->point[i][1] + shift.y),
                                  spacing * (probes->point[i][2] + shift.z)};
        const double radius = spacing * (i >= ghosts ? GHOST_SPHERE_RADIUS : PROBE_SPHERE_RADIUS);
        nearest = fmin(nearest, meet(centre, radius, origin, direction, start));
    }
    return nearest;
}

static void test_rays(void)
{
    lmb_probes *const probes = cut_fixture_probes();
    probe_spheres spheres;
    CHECK(probe_spheres_make(probes, &spheres) == LMB_OK, "make");
    uint64_t state = 31;
    int met = 0;
    for (int i = 0; i < 20000; ++i) {
        double origin[3], toward[3], direction[3], length = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            origin[axis] = 8.0 * fixture_random(&state) - 3.0;
            toward[axis] = 4.0 * fixture_random(&state) - 2.0;
            direction[axis] = i % 5 == axis ? 0.0 : toward[axis] - origin[axis];
            length += direction[axis] * direction[axis];
        }
        const lmb_vec3 unit =
            lmb_vec3_unit_or((lmb_vec3){(float)(direction[0] / sqrt(length)), (float)(direction[1] / sqrt(length)),
                                        (float)(direction[2] / sqrt(length))},
                             (lmb_vec3){1, 0, 0});
        const double one = sqrt((double)unit.x * (double)unit.x + (double)unit.y * (double)unit.y +
                                (double)unit.z * (double)unit.z); /* but for rounding, which grazing rays magnify */
        const double used[3] = {(double)unit.x / one, (double)unit.y / one, (double)unit.z / one};
        const float start = i % 3 == 0 ? 1.0f : 0.0f;
        const double expected = meet_all(&spheres, origin, used, (double)start);
        float distance = FLT_MAX;
        lmb_rgb colour;
        const bool found = probe_spheres_nearest(&spheres, (lmb_vec3d){origin[0], origin[1], origin[2]}, unit, start,
                                                 &distance, &colour);
        CHECK(found == (expected < (double)FLT_MAX), "ray %d: %d, expected at %g", i, found, expected);
        CHECK_NEAR(distance, expected, found ? 1e-4 : 0.0, "ray %d", i);
        met += found;
        if (found) { /* nothing is there before a limit */
            float nearer = 0.99f * distance;
            CHECK(!probe_spheres_nearest(&spheres, (lmb_vec3d){origin[0], origin[1], origin[2]}, unit, start, &nearer,
                                         &colour),
                  "ray %d: something at %g of %g", i, (double)nearer, (double)distance);
        }
    }
    CHECK(met > 1000 && met < 18000, "%d of 20000 rays meet a sphere", met);
    probe_spheres_free(&spheres);
    lmb_probes_destroy(probes);
}

/* Ghosts lie towards the region that they stand for. */
static void test_ghosts(void)
{
    lmb_probes *const probes = cut_fixture_probes();
    probe_spheres spheres;
    CHECK(probe_spheres_make(probes, &spheres) == LMB_OK, "make");
    /* The first are those of cell (-4, 0, 0): of its region 0, below x = 1/4, at corner 1, then 3, 5, 7. Its middle as
     * a grid of six sees it is (1/6, 1/2, 1/2). */
    const lmb_vec3d first = spheres.shift[0];
    const double length = sqrt((5.0 / 6.0) * (5.0 / 6.0) + 0.5);
    CHECK_NEAR(first.x, -GHOST_SPHERE_DISTANCE * (5.0 / 6.0) / length, 1e-6, "x");
    CHECK_NEAR(first.y, GHOST_SPHERE_DISTANCE * 0.5 / length, 1e-6, "y");
    CHECK_NEAR(first.z, GHOST_SPHERE_DISTANCE * 0.5 / length, 1e-6, "z");
    for (int32_t i = 0; i < probes->ghost_count; ++i) {
        const lmb_vec3d s = spheres.shift[i];
        CHECK_NEAR(sqrt(s.x * s.x + s.y * s.y + s.z * s.z), GHOST_SPHERE_DISTANCE, 1e-9, "ghost %d", i);
    }
    probe_spheres_free(&spheres);
    lmb_probes_destroy(probes);
}

/* A sphere shows its probe's light; belts say what else it is. */
static void test_colours(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {2, 2, 2}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 0.0, 3);
    probes->radiance[0][0].channel[1].c[0] = 2.0f * sqrtf(LMB_PI_F); /* radiance 1 all around: irradiance 1 */
    probes->radiance[0][1].channel[0].c[0] = 2.0f * sqrtf(LMB_PI_F);
    probes->validity[1] = 0.1f;
    probes->key_light_count = 1;
    probes->key_light[0] = (lmb_key_light){{0.0f, 1.0f, 0.0f}, {{0.0f, 0.0f, 3.0f}}};
    probes->key_visibility[0][0] = 0.5f;
    probe_spheres spheres;
    CHECK(probe_spheres_make(probes, &spheres) == LMB_OK, "make");
    float distance = FLT_MAX;
    lmb_rgb colour;
    CHECK(probe_spheres_nearest(&spheres, (lmb_vec3d){0, 5, 0}, (lmb_vec3){0, -1, 0}, 0.0f, &distance, &colour), "top");
    CHECK_NEAR(distance, 4.0 - PROBE_SPHERE_RADIUS, 1e-5, "of the probe above, which is dark");
    CHECK(colour.c[1] == 0.0f, "%g", (double)colour.c[1]);
    distance = FLT_MAX;
    CHECK(probe_spheres_nearest(&spheres, (lmb_vec3d){0, 0.5, 0}, (lmb_vec3){0, -1, 0}, 0.0f, &distance, &colour),
          "top");
    CHECK_NEAR(distance, 0.5 - PROBE_SPHERE_RADIUS, 1e-5, "from between");
    CHECK_NEAR(colour.c[1], 1.0, 1e-5, "its own light");
    CHECK_NEAR(colour.c[2], 1.5, 1e-5, "half of the key light");
    distance = FLT_MAX;
    CHECK(probe_spheres_nearest(&spheres, (lmb_vec3d){1, 0, -3}, (lmb_vec3){0, 0, 1}, 0.0f, &distance, &colour),
          "belt");
    CHECK(colour.c[0] > 4.0f * colour.c[1] && colour.c[1] > 0.0f, "a red belt: %g %g", (double)colour.c[0],
          (double)colour.c[1]);
    distance = 2.5f;
    CHECK(!probe_spheres_nearest(&spheres, (lmb_vec3d){1, 0, -3}, (lmb_vec3){0, 0, 1}, 0.0f, &distance, &colour),
          "behind a wall");
    CHECK(distance == 2.5f, "%g", (double)distance);
    probe_spheres_free(&spheres);
    lmb_probes_destroy(probes);
}

static const test_case cases[] = {
    {"rays meet the nearest sphere", test_rays},
    {"ghosts lie towards their regions", test_ghosts},
    {"colours", test_colours},
};
TEST_MAIN(cases)
