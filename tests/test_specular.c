/* Specular layers: the reflectance by its definition and by what physics asks of it, the tables by quadrature over
 * light directions, reflections of harmonics against Monte Carlo. */
#include "harness.h"
#include "variates.h"

#include <float.h>

#include <gsl/gsl_integration.h>
#include <gsl/gsl_sf_legendre.h>

#include <lambent/specular.h>
#include <lambent/vector.h>

static const double PI = 3.14159265358979323846;
static const lmb_vec3 UP = {0.0f, 0.0f, 1.0f};

static lmb_rgb grey(float value)
{
    return lmb_rgb_of(value, value, value);
}

static lmb_vec3 direction_of(double cosine, double turn)
{
    const double sine = sqrt((1.0 - cosine) * (1.0 + cosine));
    return lmb_vec3_unit_or(lmb_vec3_of((float)(sine * cos(turn)), (float)(sine * sin(turn)), (float)cosine), UP);
}

static lmb_vec3 direction_any(uint64_t *state)
{
    const double cosine = 2.0 * variate_next(state) - 1.0;
    return direction_of(cosine, 2.0 * PI * variate_next(state));
}

/* The reflectance times N.L, without Fresnel's factor, from spherical angles: light at polar angle of cosine `l` and
 * azimuth `turn` from the view's, whose cosine is `v`. The half vector's angle by the law of cosines. `along` gets V.H.
 */
static double lobe_defined(double m, double v, double l, double turn, double *along)
{
    const double between = v * l + sqrt(1.0 - v * v) * sqrt(1.0 - l * l) * cos(turn);
    *along = sqrt(0.5 * (1.0 + between));
    const double half = fmin((v + l) / (2.0 * *along), 1.0);
    const double angle = acos(half);
    const double beckmann = exp(-pow(tan(angle) / m, 2.0)) / (PI * m * m * pow(half, 4.0));
    const double masking = fmin(1.0, fmin(2.0 * half * v / *along, 2.0 * half * l / *along));
    return beckmann * masking / (4.0 * v);
}

/* GSL's Y_lm with Condon and Shortley's signs, real, at m >= 0. */
static double harmonic(int degree, int order, double cosine, double turn)
{
    const double legendre = gsl_sf_legendre_sphPlm(degree, order, cosine); /* has the signs */
    return order == 0 ? legendre : sqrt(2.0) * legendre * cos(order * turn);
}

enum { BASES = 6 };
static const int DEGREE[BASES] = {0, 1, 1, 2, 2, 2}, ORDER[BASES] = {0, 0, 1, 0, 1, 2};
static const int PLACE[BASES] = {0, 2, 3, 6, 7, 8}; /* in an lmb_sh3 */

/* C and D by Gauss and Legendre over light directions; the lobe is even in the azimuth. */
static void lobe_projected(double m, double v, double c[BASES], double d[BASES])
{
    enum { POINTS = 160 };
    gsl_integration_glfixed_table *const table = gsl_integration_glfixed_table_alloc(POINTS);
    for (int k = 0; k < BASES; ++k) {
        c[k] = d[k] = 0.0;
    }
    for (size_t i = 0; i < POINTS; ++i) {
        double l, weight_l;
        gsl_integration_glfixed_point(0.0, 1.0, i, &l, &weight_l, table);
        for (size_t j = 0; j < POINTS; ++j) {
            double turn, weight, along;
            gsl_integration_glfixed_point(0.0, PI, j, &turn, &weight, table);
            const double lobe = lobe_defined(m, v, l, turn, &along) * 2.0 * weight_l * weight;
            for (int k = 0; k < BASES; ++k) {
                const double part = lobe * harmonic(DEGREE[k], ORDER[k], l, turn);
                c[k] += part;
                d[k] += part * pow(1.0 - along, 5.0);
            }
        }
    }
    gsl_integration_glfixed_table_free(table);
}

/* What the sampler has of one coefficient, with the view at azimuth 0 of the normal z; clamped light is asked twice. */
static double lobe_of_sampler(double m, double v, int place, float f0)
{
    const lmb_specular specular = {(float)m, grey(f0)};
    const lmb_vec3 view = direction_of(v, 0.0);
    double found = 0.0;
    for (int sign = -1; sign <= 1; sign += 2) {
        lmb_sh3_rgb unit = {{{{0}}}};
        unit.channel[1].c[place] = (float)sign;
        found += sign * (double)lmb_specular_area(&unit, &specular, UP, view).c[1];
    }
    return found;
}

static void tables_are_the_integrals(void)
{
    /* Roughness at rows of the table, and between; views at columns and between. */
    static const double rows[] = {36.0 / 225.0, 81.0 / 225.0, 144.0 / 225.0, 1.0, 0.3, 0.5, 0.93};
    static const double roots[] = {0.38742588, 0.60768259, 0.79128785, 0.95227, 0.5, 0.7, 0.89};
    double worst = 0.0;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        for (size_t j = 0; j < sizeof roots / sizeof roots[0]; ++j) {
            const bool node = i < 4 && j < 3;
            const double x = node ? (double)(2 * (j + 1)) / 7.0 : 0.0;
            const double root = node ? 0.5 * (sqrt(1.0 + 8.0 * x) - 1.0) : roots[j];
            double c[BASES], d[BASES];
            lobe_projected(rows[i], root * root, c, d);
            for (int k = 0; k < BASES; ++k) {
                const double tolerance = node ? 2e-4 : 0.012;
                const double off[2] = {lobe_of_sampler(rows[i], root * root, PLACE[k], 1.0f) - c[k],
                                       lobe_of_sampler(rows[i], root * root, PLACE[k], 0.0f) - d[k]};
                CHECK_NEAR(off[0], 0.0, tolerance, "C of %d, m %g, N.V %g", PLACE[k], rows[i], root * root);
                CHECK_NEAR(off[1], 0.0, tolerance, "D of %d, m %g, N.V %g", PLACE[k], rows[i], root * root);
                worst = fmax(worst, node ? 0.0 : fmax(fabs(off[0]), fabs(off[1])));
            }
        }
    }
    printf("     between nodes at most %.4f off\n", worst);
    for (int place = 0; place < 9; ++place) { /* sines of the azimuth see nothing */
        const bool odd = place == 1 || place == 4 || place == 5;
        CHECK(!odd || fabs(lobe_of_sampler(0.3, 0.5, place, 0.5f)) < 1e-6, "coefficient %d", place);
    }
}

/* Without roughness the harmonics are seen in a mirror. */
static void mirrors_show_the_harmonics(void)
{
    uint64_t state = 4;
    for (int i = 0; i < 200; ++i) {
        const lmb_vec3 normal = direction_any(&state);
        lmb_vec3 view = direction_any(&state);
        view = lmb_vec3_dot(view, normal) < 0.0f ? lmb_vec3_scale(view, -1.0f) : view;
        const lmb_vec3 mirrored = lmb_vec3_mad(lmb_vec3_scale(view, -1.0f), normal, 2.0f * lmb_vec3_dot(normal, view));
        lmb_sh3_rgb light = {{{{3.0f}}, {{3.0f}}, {{3.0f}}}};
        lmb_sh3_rgb_add_light(&light, direction_any(&state), lmb_rgb_of(1.0f, 2.0f, 3.0f));
        const lmb_specular specular = {0.0f, grey(1.0f)};
        const lmb_rgb got = lmb_specular_area(&light, &specular, normal, view);
        for (int c = 0; c < 3; ++c) {
            const float seen = lmb_sh3_evaluate(&light.channel[c], mirrored);
            CHECK_NEAR(got.c[c], seen > 0.0f ? seen : 0.0f, 0.03, "channel %d", c); /* between columns */
        }
    }
}

/* Highlight of a light of irradiance 1 (not over pi), along the axes above. */
static double highlight(double m, float f0, lmb_vec3 light, lmb_vec3 view)
{
    const lmb_key_light key = {light, grey((float)(1.0 / PI))};
    const lmb_specular specular = {(float)m, grey(f0)};
    return (double)lmb_specular_light(&key, 1.0f, &specular, UP, UP, view).c[0];
}

static void reflectance_is_as_defined(void)
{
    uint64_t state = 9;
    for (int i = 0; i < 2000; ++i) {
        const double m = 0.05 + 0.95 * variate_next(&state), v = 0.02 + 0.98 * variate_next(&state);
        const double l = 0.02 + 0.98 * variate_next(&state), turn = 2.0 * PI * variate_next(&state);
        double along;
        const double expected = lobe_defined(m, v, l, turn, &along);
        const lmb_vec3 light = direction_of(l, turn), view = direction_of(v, 0.0);
        CHECK_NEAR(highlight(m, 1.0f, light, view), expected, 2e-4 * (expected + 0.01), "m %g, v %g, l %g, %g", m, v, l,
                   turn);
        /* Helmholtz: view and light may change places, but for the light's cosine. */
        CHECK_NEAR(highlight(m, 0.3f, light, view) / l * v, highlight(m, 0.3f, view, light), 3e-4 * (expected + 0.01),
                   "the other way");
    }
    CHECK(highlight(0.3, 1.0f, direction_of(-0.1, 3.0), UP) == 0.0, "a light below");
    const lmb_key_light key = {direction_of(0.5, 0.0), grey(1.0f)};
    const lmb_specular specular = {0.3f, grey(0.5f)};
    CHECK(lmb_specular_light(&key, 1.0f, &specular, direction_of(-0.6, PI), UP, UP).c[0] == 0.0f, "behind n_v");
    CHECK(lmb_specular_light(&key, 0.5f, &specular, UP, UP, UP).c[0] * 2.0f ==
              lmb_specular_light(&key, 1.0f, &specular, UP, UP, UP).c[0],
          "half seen");
}

/* Fresnel's own equations, from angles by Snell's law. */
static void fresnel_is_snells(void)
{
    for (int f = 1; f < 10; ++f) {
        const double f0 = 0.1 * f * 0.1 * f, root = sqrt(f0), index = (1.0 + root) / (1.0 - root);
        for (int a = 1; a < 9; ++a) {
            const double angle = a * 0.17, inside = asin(sin(angle) / index);
            const double s = (cos(angle) - index * cos(inside)) / (cos(angle) + index * cos(inside));
            const double p = (index * cos(angle) - cos(inside)) / (index * cos(angle) + cos(inside));
            /* Light and view mirror each other at that angle. */
            const lmb_vec3 light = direction_of(cos(angle), PI), view = direction_of(cos(angle), 0.0);
            CHECK_NEAR(highlight(0.3, (float)f0, light, view) / highlight(0.3, 1.0f, light, view),
                       0.5 * (s * s + p * p), 2e-5, "f0 %g at %g", f0, angle);
        }
    }
}

/* All the light of a white furnace that a lobe sends on, by the sampler's reflectance. */
static double furnace(double m, double v, bool phong)
{
    enum { POINTS = 400 };
    double sum = 0.0;
    gsl_integration_glfixed_table *const table = gsl_integration_glfixed_table_alloc(POINTS);
    for (size_t i = 0; i < POINTS; ++i) {
        double l, weight_l;
        gsl_integration_glfixed_point(0.0, 1.0, i, &l, &weight_l, table);
        for (size_t j = 0; j < POINTS; ++j) {
            double turn, weight;
            gsl_integration_glfixed_point(0.0, PI, j, &turn, &weight, table);
            const lmb_vec3 light = direction_of(l, turn), view = direction_of(v, 0.0);
            const lmb_key_light key = {light, grey((float)(1.0 / PI))};
            const lmb_specular specular = {(float)m, grey(1.0f)};
            const lmb_rgb got = phong ? lmb_specular_light_phong(&key, 1.0f, &specular, UP, UP, view)
                                      : lmb_specular_light(&key, 1.0f, &specular, UP, UP, view);
            sum += 2.0 * weight_l * weight * (double)got.c[0];
        }
    }
    gsl_integration_glfixed_table_free(table);
    return sum;
}

/* Both layers send on the same, never more than arrives, and a smooth surface all of it. */
static void furnaces_lose_light(void)
{
    const lmb_sh3_rgb white = {{{{3.5449077f}}, {{3.5449077f}}, {{3.5449077f}}}};
    static const double roughness[] = {0.1, 0.2, 0.4, 0.7, 1.0};
    for (size_t i = 0; i < sizeof roughness / sizeof roughness[0]; ++i) {
        for (double v = 0.1; v < 1.0; v += 0.2) {
            const lmb_specular specular = {(float)roughness[i], grey(1.0f)};
            const double area = (double)lmb_specular_area(&white, &specular, UP, direction_of(v, 0.0)).c[0];
            CHECK_NEAR(furnace(roughness[i], v, false), area, 0.02, "m %g, N.V %g", roughness[i], v);
            CHECK(area <= 1.0001 && (roughness[i] > 0.1 || v < 0.25 || area > 0.97), "m %g, N.V %g: %g", roughness[i],
                  v, area);
        }
    }
    CHECK_NEAR(furnace(0.1, 0.9, true), 1.0, 1e-3, "the appendix: Phong's lobe has the integral 1");
    CHECK_NEAR(furnace(0.2, 0.8, true), 1.0, 1e-3, "also");
}

/* A sky that is nowhere negative in its own harmonics: then there is no clamp on either side. */
static lmb_sh3_rgb soft_sky(uint64_t *state)
{
    lmb_sh3_rgb sky = {{{{4.0f}}, {{4.0f}}, {{4.0f}}}};
    for (int i = 0; i < 3; ++i) {
        lmb_sh3_rgb_add_light(&sky, direction_any(state),
                              lmb_rgb_of((float)variate_next(state), (float)variate_next(state), 1.0f));
    }
    return sky;
}

/* The reflected radiance of harmonics by uniform samples of the hemisphere, with Schlick's factor. */
static double reflected_by_samples(const lmb_sh3 *sky, const lmb_specular *specular, const lmb_vec3 axes[3], double v,
                                   uint64_t *state)
{
    enum { SAMPLES = 40000 };
    double sum = 0.0;
    for (int i = 0; i < SAMPLES; ++i) {
        const double l = (i + variate_next(state)) / SAMPLES, turn = 2.0 * PI * variate_next(state);
        double along;
        const double lobe = lobe_defined((double)specular->roughness, v, l, turn, &along);
        const lmb_vec3 d = direction_of(l, turn);
        const lmb_vec3 world = lmb_vec3_mad(lmb_vec3_mad(lmb_vec3_scale(axes[0], d.x), axes[1], d.y), axes[2], d.z);
        const double f0 = (double)specular->f0.c[0], schlick = f0 + (1.0 - f0) * pow(1.0 - along, 5.0);
        sum += lobe * schlick * (double)lmb_sh3_evaluate(sky, world);
    }
    return sum * 2.0 * PI / SAMPLES;
}

static void area_is_monte_carlo(void)
{
    uint64_t state = 77;
    double squares = 0.0, errors = 0.0;
    for (int i = 0; i < 60; ++i) {
        const lmb_sh3_rgb sky = soft_sky(&state);
        lmb_vec3 axes[3];
        axes[2] = direction_any(&state);
        lmb_vec3_frame(axes[2], &axes[0], &axes[1]);
        const double v = 0.05 + 0.95 * variate_next(&state);
        const lmb_specular specular = {(float)(0.25 + 0.75 * variate_next(&state)), grey((float)variate_next(&state))};
        const lmb_vec3 local = direction_of(v, 0.0);
        const lmb_vec3 view = lmb_vec3_mad(lmb_vec3_scale(axes[0], local.x), axes[2], local.z);
        const double truth = reflected_by_samples(&sky.channel[0], &specular, axes, v, &state);
        const double got = (double)lmb_specular_area(&sky, &specular, axes[2], view).c[0];
        CHECK_NEAR(got / truth, 1.0, 0.08, "m %g, f0 %g, N.V %g", (double)specular.roughness, (double)specular.f0.c[0],
                   v);
        squares += truth * truth;
        errors += (got - truth) * (got - truth);
    }
    printf("     %.2f %% off\n", 100.0 * sqrt(errors / squares));
    CHECK(sqrt(errors / squares) < 0.015, "rel. RMSE %g", sqrt(errors / squares));
}

/* The appendix's integral of harmonics by quadrature over tan^2(a)/m^2, whose weight is exp(-t), and azimuths. */
static double phong_reflected(const lmb_sh3 *sky, double m, lmb_vec3 mirrored)
{
    enum { POINTS = 200, TURNS = 12 };
    lmb_vec3 x, y;
    lmb_vec3_frame(mirrored, &x, &y);
    double sum = 0.0;
    gsl_integration_glfixed_table *const table = gsl_integration_glfixed_table_alloc(POINTS);
    for (size_t i = 0; i < POINTS * TURNS; ++i) {
        double t, weight;
        gsl_integration_glfixed_point(0.0, 40.0, i / TURNS, &t, &weight, table);
        const double tangent = m * sqrt(t), cosine = 1.0 / sqrt(1.0 + tangent * tangent);
        const double turn = 2.0 * PI * (double)(i % TURNS) / TURNS;
        const lmb_vec3 across = lmb_vec3_mad(lmb_vec3_scale(x, (float)cos(turn)), y, (float)sin(turn));
        const lmb_vec3 d = lmb_vec3_mad(lmb_vec3_scale(mirrored, (float)cosine), across, (float)(tangent * cosine));
        sum += weight * exp(-t) * (double)lmb_sh3_evaluate(sky, d) / TURNS;
    }
    gsl_integration_glfixed_table_free(table);
    return sum;
}

static void phong_area_is_its_integral(void)
{
    uint64_t state = 78;
    for (int i = 0; i < 200; ++i) {
        const lmb_sh3_rgb sky = soft_sky(&state);
        const lmb_vec3 n = direction_any(&state), view = direction_any(&state);
        const double m = i / 199.0, f0 = variate_next(&state), v = (double)lmb_vec3_dot(n, view);
        const lmb_specular specular = {(float)m, grey((float)f0)};
        const lmb_vec3 mirrored = lmb_vec3_mad(lmb_vec3_scale(view, -1.0f), n, 2.0f * (float)v);
        const double schlick = f0 + (1.0 - f0) * pow(1.0 - fmax(v, 0.0), 5.0);
        const double expected = schlick * phong_reflected(&sky.channel[1], m, mirrored);
        CHECK_NEAR(lmb_specular_area_phong(&sky, &specular, n, view).c[1], expected, 3e-4 * expected,
                   "m %g, f0 %g, N.V %g", m, f0, v);
    }
}

/* At the place of a map, along its own directions, its picture comes back; half the light there gives half of it. */
static void environment_maps_come_back(void)
{
    uint64_t state = 63;
    for (int i = 0; i < 200; ++i) {
        lmb_sh3_rgb light = {{{{1.0f}}, {{1.0f}}, {{1.0f}}}}; /* rings */
        lmb_sh3_rgb_add_light(&light, direction_any(&state), lmb_rgb_of(3.0f, 2.0f, 1.0f));
        const lmb_vec3 direction = direction_any(&state);
        const lmb_specular mirror = {(float)variate_next(&state), grey(1.0f)};
        const lmb_rgb divisor = lmb_specular_environment_divisor(&light, mirror.roughness, direction);
        const lmb_rgb picture = lmb_rgb_of(0.5f, 0.7f, 4.0f);
        lmb_rgb map;
        for (int c = 0; c < 3; ++c) {
            CHECK(divisor.c[c] > 0.02f, "channel %d is divided by %g", c, (double)divisor.c[c]);
            map.c[c] = picture.c[c] / divisor.c[c];
        }
        const lmb_rgb back = lmb_specular_environment(map, &light, &mirror, direction, direction);
        for (int c = 0; c < 3; ++c) {
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                light.channel[c].c[k] *= 0.5f;
            }
        }
        const lmb_rgb dim = lmb_specular_environment(map, &light, &mirror, direction, direction);
        for (int c = 0; c < 3; ++c) {
            CHECK_NEAR(back.c[c], picture.c[c], 1e-5, "channel %d", c);
            CHECK_NEAR(dim.c[c], 0.5f * picture.c[c], 1e-5, "channel %d, half", c);
        }
    }
}

/* The view may pass the normal: nothing jumps, and all azimuths agree there. */
static void nothing_jumps_at_the_normal(void)
{
    uint64_t state = 5;
    const lmb_sh3_rgb sky = soft_sky(&state);
    const lmb_specular specular = {0.3f, grey(0.5f)};
    const lmb_rgb straight = lmb_specular_area(&sky, &specular, UP, UP);
    for (double turn = 0.0; turn < 6.0; turn += 0.5) {
        const lmb_rgb near_it = lmb_specular_area(&sky, &specular, UP, direction_of(cos(1e-3), turn));
        CHECK_NEAR(near_it.c[0], straight.c[0], 2e-3, "azimuth %g", turn);
    }
}

static void dominant_light_is_the_nearest(void)
{
    uint64_t state = 31;
    for (int i = 0; i < 50; ++i) {
        const lmb_vec3 d = direction_any(&state);
        lmb_sh3_rgb light = {{{{0}}}};
        lmb_sh3_rgb_add_light(&light, d, lmb_rgb_of(1.0f, 2.0f, 0.5f));
        const lmb_key_light one = lmb_sh3_rgb_dominant_light(&light);
        CHECK_NEAR(lmb_vec3_dot(one.direction, d), 1.0, 1e-6, "the direction of one light");
        CHECK_NEAR(one.irradiance.c[1], 2.0 / PI, 1e-6, "and what it gives");
        lmb_key_light_add_to_sh3(&one, -1.0f, &light);
        CHECK_NEAR(light.channel[1].c[6], 0.0, 1e-6, "nothing remains");

        /* In a sky, no other intensity along that direction is nearer. */
        light = soft_sky(&state);
        const lmb_key_light best = lmb_sh3_rgb_dominant_light(&light);
        double error[3];
        for (int step = 0; step < 3; ++step) {
            lmb_sh3_rgb rest = light;
            lmb_key_light_add_to_sh3(&best, -1.0f - 0.01f * (float)(step - 1), &rest);
            error[step] = 0.0;
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                error[step] += (double)rest.channel[2].c[k] * (double)rest.channel[2].c[k];
            }
        }
        CHECK(error[1] < error[0] && error[1] < error[2], "%g %g %g", error[0], error[1], error[2]);
    }
    const lmb_sh3_rgb even = {{{{1.0f}}, {{1.0f}}, {{1.0f}}}};
    CHECK(lmb_sh3_rgb_dominant_light(&even).irradiance.c[0] == 0.0f, "light from everywhere has none");
}

/* What is seen of a lamp comes back, alone; beside others and a sky, when it is the strongest by far; and nothing of
 * what is behind a wall. */
static void lamps_are_found_in_harmonics(void)
{
    uint64_t state = 47;
    for (int i = 0; i < 100; ++i) {
        const lmb_key_light lamp = {direction_any(&state), lmb_rgb_of(3.0f, 2.0f, 0.5f)};
        const float seen = (float)variate_next(&state);
        lmb_sh3_rgb light = {{{{0}}}};
        lmb_key_light_add_to_sh3(&lamp, seen, &light);
        CHECK_NEAR(lmb_sh3_rgb_light_visibility(&light, &lamp), seen, 1e-5, "alone");
        lmb_sh3_rgb sky = soft_sky(&state);
        for (int c = 0; c < 3; ++c) {
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                light.channel[c].c[k] += 0.01f * sky.channel[c].c[k];
            }
        }
        CHECK_NEAR(lmb_sh3_rgb_light_visibility(&light, &lamp), seen, 0.02, "beside a sky");
        const lmb_key_light other = {lmb_vec3_scale(lamp.direction, -1.0f), lamp.irradiance};
        lmb_key_light_add_to_sh3(&lamp, -seen, &light);
        CHECK(lmb_sh3_rgb_light_visibility(&light, &other) < 0.02f, "light that is not there");
        lmb_key_light_add_to_sh3(&lamp, 2.0f, &light);
        CHECK(lmb_sh3_rgb_light_visibility(&light, &lamp) == 1.0f, "no more than all");
    }
    const lmb_key_light none = {UP, grey(0.0f)};
    const lmb_sh3_rgb even = {{{{1.0f}}, {{1.0f}}, {{1.0f}}}};
    const float of_none = lmb_sh3_rgb_light_visibility(&even, &none);
    CHECK(of_none >= 0.0f && of_none <= 1.0f, "of no light: %g", (double)of_none);
}

/* Where rays leave a box, by hand; from the map's own place every direction stays. */
static void proxies_are_boxes(void)
{
    const lmb_specular_proxy box = {{1.0f, 0.0f, 0.0f}, {-2.0f, -1.0f, -3.0f}, {2.0f, 1.0f, 3.0f}};
    static const struct {
        lmb_vec3 position, mirrored, meets; /* the point of the box */
    } table[] = {
        {{0.0f, -1.0f, 0.0f}, {0.6f, 0.8f, 0.0f}, {1.5f, 1.0f, 0.0f}},
        {{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {2.0f, 0.0f, 0.0f}},
        {{-1.0f, 0.5f, 2.0f}, {0.0f, 0.0f, -1.0f}, {-1.0f, 0.5f, -3.0f}},
        {{-9.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {-2.0f, 1.0f, 0.0f}}, /* from outside */
        {{0.0f, 7.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 1.0f, 0.0f}},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        const lmb_vec3 got = lmb_specular_proxy_direction(&box, table[i].position, table[i].mirrored);
        const lmb_vec3 way = lmb_vec3_sub(table[i].meets, box.position);
        CHECK_NEAR(lmb_vec3_dot(got, lmb_vec3_unit_or(way, UP)), 1.0, 1e-6, "case %zu: %g %g %g", i, (double)got.x,
                   (double)got.y, (double)got.z);
    }
    const lmb_specular_proxy none = {{0.0f, 0.0f, 0.0f}, {-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}};
    uint64_t state = 3;
    for (int i = 0; i < 200; ++i) {
        const lmb_vec3 d = direction_any(&state), at = direction_any(&state);
        CHECK_NEAR(lmb_vec3_dot(lmb_specular_proxy_direction(&box, box.position, d), d), 1.0, 1e-6, "its own place");
        CHECK_NEAR(lmb_vec3_dot(lmb_specular_proxy_direction(&none, at, d), d), 1.0, 1e-6, "a box without end");
    }
}

static bool is_light(lmb_rgb colour)
{
    return colour.c[0] >= 0.0f && colour.c[1] >= 0.0f && colour.c[2] >= 0.0f && colour.c[0] <= FLT_MAX &&
           colour.c[1] <= FLT_MAX && colour.c[2] <= FLT_MAX;
}

static void nothing_breaks_it(void)
{
    static const float values[] = {0.0f, 1e-30f, 1e-3f, 0.02f, 0.5f, 1.0f, 2.0f, -1.0f, 1e30f, (float)NAN, INFINITY};
    enum { COUNT = sizeof values / sizeof values[0] };
    uint64_t state = 8;
    for (int i = 0; i < 20000; ++i) {
        const lmb_specular specular = {values[i % COUNT], lmb_rgb_of(values[i / COUNT % COUNT], 0.04f, 1.0f)};
        const lmb_vec3 n = direction_any(&state);
        const lmb_vec3 view = i % 5 == 0 ? n : i % 5 == 1 ? lmb_vec3_scale(n, -1.0f) : direction_any(&state);
        const lmb_vec3 towards = i % 7 == 0 ? lmb_vec3_scale(view, -1.0f) : direction_any(&state);
        const lmb_key_light key = {towards, lmb_rgb_of(values[i / 3 % COUNT], 1.0f, 3e38f)};
        lmb_sh3_rgb light = {{{{0}}}};
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            light.channel[0].c[k] = values[(i / 2 + k) % COUNT];
            light.channel[1].c[k] = (float)(variate_next(&state) - 0.5) * (i % 2 ? 1e38f : 1.0f);
        }
        CHECK(is_light(lmb_specular_light(&key, 1.0f, &specular, n, n, view)), "light, %d", i);
        CHECK(is_light(lmb_specular_light_phong(&key, 1.0f, &specular, n, n, view)), "Phong, %d", i);
        CHECK(is_light(lmb_specular_area_phong(&light, &specular, n, view)), "Phong's area layer, %d", i);
        CHECK(is_light(lmb_specular_area(&light, &specular, n, view)), "area, %d", i);
        CHECK(is_light(lmb_specular_environment(key.irradiance, &light, &specular, n, view)), "environment, %d", i);
        CHECK(is_light(lmb_sh3_rgb_dominant_light(&light).irradiance), "dominant, %d", i);
        const float seen = lmb_sh3_rgb_light_visibility(&light, &key);
        CHECK(seen >= 0.0f && seen <= 1.0f, "visibility, %d: %g", i, (double)seen);
        const float side = values[i % COUNT];
        const lmb_specular_proxy box = {n, {-side, -1.0f, -side}, {side, 1.0f, 1.0f}};
        const lmb_vec3 way = lmb_specular_proxy_direction(&box, lmb_vec3_of(side, 0.0f, 2.0f), towards);
        CHECK_NEAR(lmb_vec3_dot(way, way), 1.0, 1e-5, "proxy, %d", i);
    }
}

static const test_case CASES[] = {
    {"tables are the integrals", tables_are_the_integrals},
    {"mirrors show the harmonics", mirrors_show_the_harmonics},
    {"reflectance is as defined", reflectance_is_as_defined},
    {"fresnel is Snell's", fresnel_is_snells},
    {"furnaces lose light", furnaces_lose_light},
    {"area is Monte Carlo", area_is_monte_carlo},
    {"Phong's area is its integral", phong_area_is_its_integral},
    {"environment maps come back", environment_maps_come_back},
    {"nothing jumps at the normal", nothing_jumps_at_the_normal},
    {"dominant light is the nearest", dominant_light_is_the_nearest},
    {"lamps are found in harmonics", lamps_are_found_in_harmonics},
    {"proxies are boxes", proxies_are_boxes},
    {"nothing breaks it", nothing_breaks_it},
};

TEST_MAIN(CASES)
