/* Directions as points of the disc: there and back, the frame's properties, and what the map promises to filtering. */
#include "harness.h"
#include "variates.h"

#include <lambent/direction_disc.h>
#include <lambent/hhd.h>

enum { TRIES = 200000 };

static lmb_vec3 direction_of(uint64_t *random)
{
    const double z = 2.0 * variate_next(random) - 1.0, turn = 6.283185307179586 * variate_next(random);
    const double radius = sqrt(1.0 - z * z);
    return lmb_vec3_of((float)(radius * cos(turn)), (float)(radius * sin(turn)), (float)z);
}

/* One that is at least `height` above the horizon of n. */
static lmb_vec3 above(uint64_t *random, lmb_vec3 n, float height)
{
    lmb_vec3 d;
    do {
        d = direction_of(random);
        d = lmb_vec3_dot(d, n) < 0.0f ? lmb_vec3_scale(d, -1.0f) : d;
    } while (lmb_vec3_dot(d, n) < height);
    return d;
}

static float apart(lmb_vec3 a, lmb_vec3 b)
{
    return lmb_vec3_length(lmb_vec3_sub(a, b));
}

static void there_and_back(void)
{
    uint64_t random = 1;
    for (int i = 0; i < TRIES; ++i) {
        const lmb_vec3 n = direction_of(&random), d = above(&random, n, LMB_DISC_MIN_COS);
        float x, y;
        lmb_disc_from_direction(d, n, &x, &y);
        const lmb_vec3 back = lmb_disc_to_direction(x, y, n);
        const double axis = 1.0 - 0.36 * (double)n.x + 0.8 * (double)n.y - 0.48 * (double)n.z;
        CHECK_NEAR(x * x + y * y, 1.0f - lmb_vec3_dot(d, n), axis > 0.03 ? 3e-5 : 1e-2, "try %d", i);
        CHECK(apart(d, back) < (axis > 0.03 ? 3e-5f : 1e-2f), "try %d: n %g %g %g: %g", i, (double)n.x, (double)n.y,
              (double)n.z, (double)apart(d, back));
    }
}

/* T, B and n are orthonormal and right-handed; the normal itself is the disc's centre. */
static void frames_are_frames(void)
{
    uint64_t random = 2;
    static const lmb_vec3 axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (int i = 0; i < 1000; ++i) {
        const lmb_vec3 n = i < 6 ? axes[i] : direction_of(&random);
        lmb_vec3 t, b;
        lmb_disc_frame(n, &t, &b);
        CHECK_NEAR(lmb_vec3_dot(t, t), 1.0, 1e-4, "normal %d", i);
        CHECK_NEAR(lmb_vec3_dot(b, b), 1.0, 1e-4, "normal %d", i);
        CHECK_NEAR(lmb_vec3_dot(t, b), 0.0, 1e-4, "normal %d", i);
        CHECK(apart(lmb_vec3_cross(t, b), n) < 1e-4f, "normal %d", i);
        float x, y;
        lmb_disc_from_direction(n, n, &x, &y);
        CHECK_NEAR(x, 0.0, 1e-5, "normal %d", i);
        CHECK_NEAR(y, 0.0, 1e-5, "normal %d", i);
    }
}

/* Normals an angle apart have frames that are apart by no more than the tangent of half the angle from A says: the same
 * light keeps its point, nearly. Away from -A, by 90 degrees, that is the angle itself, and the turn about n another.
 */
static void near_normals_agree(void)
{
    uint64_t random = 3;
    const lmb_vec3 axis = {-0.36f, 0.8f, -0.48f};
    for (int i = 0; i < TRIES; ++i) {
        const lmb_vec3 n = direction_of(&random),
                       other = lmb_vec3_unit_or(lmb_vec3_mad(n, direction_of(&random), 0.02f), n);
        lmb_vec3 t, b, t2, b2;
        lmb_disc_frame(n, &t, &b);
        lmb_disc_frame(other, &t2, &b2);
        const double c = fmin((double)lmb_vec3_dot(axis, n), (double)lmb_vec3_dot(axis, other));
        const double turn = (double)apart(n, other) * (1.0 + sqrt((1.0 - c) / fmax(1.0 + c, 1e-6)));
        CHECK((double)apart(t, t2) < 1.01 * turn + 1e-4 && (double)apart(b, b2) < 1.01 * turn + 1e-4,
              "try %d: %g for %g", i, (double)apart(t, t2), turn);
    }
}

/* The mean of two points is a unit direction that is no lower than the mean of both. */
static void filtering_does_not_lower(void)
{
    uint64_t random = 4;
    for (int i = 0; i < TRIES; ++i) {
        const lmb_vec3 n = {0.0f, 0.0f, 1.0f};
        const lmb_vec3 a = above(&random, n, LMB_DISC_MIN_COS), b = above(&random, n, LMB_DISC_MIN_COS);
        const float share = (float)variate_next(&random);
        float ax, ay, bx, by;
        lmb_disc_from_direction(a, n, &ax, &ay);
        lmb_disc_from_direction(b, n, &bx, &by);
        const lmb_vec3 d = lmb_disc_to_direction(ax + share * (bx - ax), ay + share * (by - ay), n);
        CHECK_NEAR(lmb_vec3_length(d), 1.0, 1e-5, "try %d", i);
        CHECK(d.z > a.z + share * (b.z - a.z) - 1e-5f, "try %d: %g and %g give %g", i, (double)a.z, (double)b.z,
              (double)d.z);
    }
}

/* Points that rounding has moved out of the disc's lowest ring still are directions above the horizon, and light of
 * them stays finite. */
static void any_point_is_a_direction(void)
{
    CHECK(LMB_DISC_MIN_COS == LMB_IRRADZ_MIN_COS, "%g", (double)LMB_DISC_MIN_COS);
    for (int i = 0; i < 256 * 256; ++i) {
        const float x = 2.0f * (float)(i % 256) / 255.0f - 1.0f, y = 2.0f * (float)(i / 256) / 255.0f - 1.0f;
        const lmb_vec3 n = {0.0f, -1.0f, 0.0f};
        const lmb_irradz texel = {{{1.0f, 1.0f, 1.0f}}, 0.0f, lmb_disc_to_direction(x, y, n)};
        CHECK(lmb_vec3_dot(texel.direction, n) >= 0.999f * LMB_DISC_MIN_COS, "%g, %g", (double)x, (double)y);
        CHECK_NEAR(lmb_irradz_evaluate(&texel, n, n).c[0], 1.0, 1e-5, "%g, %g", (double)x, (double)y);
    }
}

static const test_case cases[] = {
    {"there_and_back", there_and_back},
    {"frames_are_frames", frames_are_frames},
    {"near_normals_agree", near_normals_agree},
    {"filtering_does_not_lower", filtering_does_not_lower},
    {"any_point_is_a_direction", any_point_is_a_direction},
};

TEST_MAIN(cases)
