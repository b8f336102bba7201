/* Daylight: the sky's formula and the sun's spectrum recomputed another way, what a clear sky is known for, and what
 * becomes of it in a scene. */
#include <stdint.h>
#include <stdlib.h>

#include <lambent/environment.h>
#include <lambent/file.h>
#include <lambent/key_lights.h>

#include "base/exponential.h"
#include "base/trig.h"
#include "harness.h"
#include "scene/daylight.h"

static const double PI = 3.14159265358979323846;
static const double TURBIDITIES[] = {2.0, 3.0, 4.5, 6.0, 10.0};
enum { TURBIDITY_COUNT = sizeof TURBIDITIES / sizeof TURBIDITIES[0] };

static double luminance_of(const double rgb[3])
{
    return 0.2126729 * rgb[0] + 0.7151522 * rgb[1] + 0.0721750 * rgb[2];
}

static lmb_daylight daylight_at(double turbidity, double elevation_deg)
{
    double to_sun[3];
    lmb_sun_direction(90.0, elevation_deg, to_sun);
    return lmb_daylight_of(turbidity, to_sun);
}

/* The sun stands in the east, at azimuth 90. */
static double luminance_towards(const lmb_daylight *daylight, double azimuth_deg, double elevation_deg)
{
    double direction[3], radiance[3];
    lmb_sun_direction(azimuth_deg, elevation_deg, direction);
    lmb_daylight_radiance(daylight, direction, radiance);
    return luminance_of(radiance);
}

static void exponentials_are_those_of_libm(void)
{
    double worst_exp = 0.0, worst_log = 0.0, worst_pow = 0.0, worst_angle = 0.0;
    for (int i = -200000; i <= 200000; ++i) {
        const double x = 0.0035 * i + 1e-5;
        worst_exp = fmax(worst_exp, fabs(lmb_exp(x) / exp(x) - 1.0));
        const double y = exp(0.001 * i);
        worst_log = fmax(worst_log, fabs(lmb_log(y) - log(y)) / fmax(1.0, fabs(log(y))));
        const double base = 0.3 + 1e-5 * (i + 200000);
        worst_pow = fmax(worst_pow, fabs(lmb_pow(base, -4.08) / pow(base, -4.08) - 1.0));
        const double angle = i * (PI / 200000.5);
        worst_angle = fmax(worst_angle, fabs(lmb_angle_of(7.0 * cos(angle), 7.0 * sin(angle)) - angle));
    }
    CHECK(worst_exp < 4e-16 && worst_log < 4e-16 && worst_pow < 4e-15 && worst_angle < 2e-15, "%g %g %g %g", worst_exp,
          worst_log, worst_pow, worst_angle);
    CHECK(lmb_exp(-800.0) == 0.0 && isinf(lmb_exp(800.0)) && lmb_exp(0.0) == 1.0 && lmb_log(1.0) == 0.0, "ends");
    CHECK(lmb_exp(-740.0) > 0.0 && isnan(lmb_exp((double)NAN)), "denormal, NaN");
}

/* Luminance by the printed formula, here in degrees and libm. */
static double printed_luminance(double t, double polar, double from_sun, double sun_polar)
{
    const double a = 0.1787 * t - 1.4630, b = -0.3554 * t + 0.4275, c = -0.0227 * t + 5.3251;
    const double d = 0.1206 * t - 2.5771, e = -0.0670 * t + 0.3703;
    const double chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * sun_polar);
    const double zenith = (4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192;
    const double there = (1.0 + a * exp(b / cos(polar))) * (1.0 + c * exp(d * from_sun) + e * pow(cos(from_sun), 2.0));
    const double at_zenith = (1.0 + a * exp(b)) * (1.0 + c * exp(d * sun_polar) + e * pow(cos(sun_polar), 2.0));
    return zenith * there / at_zenith;
}

/* A row of the zenith's chromaticity by the printed matrices, at turbidity 4 and the sun 60 degrees from it, worked out
 * by hand: x = 16 (.00166 t^3 - .00375 t^2 + .00209 t) + ... with t = pi/3. */
static void sky_is_the_printed_formula(void)
{
    for (int t = 0; t < TURBIDITY_COUNT; ++t) {
        for (double elevation = 5.0; elevation <= 90.0; elevation += 17.0) {
            const lmb_daylight daylight = daylight_at(TURBIDITIES[t], elevation);
            for (double polar = 0.0; polar < 90.0; polar += 22.0) {
                /* In the plane of the sun, on its side. */
                const double expected =
                    printed_luminance(TURBIDITIES[t], polar * PI / 180.0, fabs(90.0 - elevation - polar) * PI / 180.0,
                                      (90.0 - elevation) * PI / 180.0);
                CHECK_NEAR(luminance_towards(&daylight, 90.0, 90.0 - polar) / expected, 1.0, 2e-6,
                           "turbidity %g, sun at %g, polar angle %g", TURBIDITIES[t], elevation, polar);
            }
        }
    }
    const double s = PI / 3.0;
    const double x = 16.0 * (0.00166 * s * s * s - 0.00375 * s * s + 0.00209 * s) +
                     4.0 * (-0.02903 * s * s * s + 0.06377 * s * s - 0.03202 * s + 0.00394) +
                     (0.11693 * s * s * s - 0.21196 * s * s + 0.06052 * s + 0.25886);
    const double y = 16.0 * (0.00275 * s * s * s - 0.00610 * s * s + 0.00317 * s) +
                     4.0 * (-0.04214 * s * s * s + 0.08970 * s * s - 0.04153 * s + 0.00516) +
                     (0.15346 * s * s * s - 0.26756 * s * s + 0.06670 * s + 0.26688);
    const lmb_daylight daylight = daylight_at(4.0, 30.0);
    const double up[3] = {0.0, 1.0, 0.0};
    double rgb[3];
    lmb_daylight_radiance(&daylight, up, rgb);
    /* Rec. 709 to XYZ, IEC 61966-2-1. */
    const double big_x = 0.4124564 * rgb[0] + 0.3575761 * rgb[1] + 0.1804375 * rgb[2];
    const double big_z = 0.0193339 * rgb[0] + 0.1191920 * rgb[1] + 0.9503041 * rgb[2];
    const double sum = big_x + luminance_of(rgb) + big_z;
    CHECK_NEAR(big_x / sum, x, 1e-6, "zenith x");
    CHECK_NEAR(luminance_of(rgb) / sum, y, 1e-6, "zenith y");
}

static double bell(double nm, double peak, double below, double above)
{
    const double t = (nm - peak) / (nm < peak ? below : above);
    return exp(-0.5 * t * t);
}

/* The sun's illuminance and the share of red in its light: a black body of 5778 K, the observer's curves as sums of
 * bells (Wyman, Sloan and Shirley 2013, table 1), ozone as one bell, no water. (The sun's own spectrum is bluer.) */
static void black_body_sun(double turbidity, double elevation_deg, double *illuminance, double *red_of_blue)
{
    const double beta = 0.04608 * turbidity - 0.04586;
    const double mass = 1.0 / (sin(elevation_deg * PI / 180.0) + 0.15 * pow(elevation_deg + 3.885, -1.253));
    double xyz[3] = {0.0, 0.0, 0.0};
    for (double nm = 360.0; nm < 780.0; nm += 1.0) {
        const double metres = nm * 1e-9;
        const double planck = 1.191043e-16 / (pow(metres, 5.0) * (exp(0.01438777 / (metres * 5778.0)) - 1.0));
        const double irradiance = planck * 1e-9 * PI * pow(0.533 / 2.0 * PI / 180.0, 2.0);
        const double ozone = 0.125 * exp(-0.5 * pow((nm - 590.0) / 52.0, 2.0));
        const double depth = 0.008735 * pow(nm / 1000.0, -4.08) + beta * pow(nm / 1000.0, -1.3) + 0.35 * ozone;
        const double arrives = 0.683 * irradiance * exp(-depth * mass);
        xyz[0] += arrives * (1.056 * bell(nm, 599.8, 37.9, 31.0) + 0.362 * bell(nm, 442.0, 16.0, 26.7) -
                             0.065 * bell(nm, 501.1, 20.4, 26.2));
        xyz[1] += arrives * (0.821 * bell(nm, 568.8, 46.9, 40.5) + 0.286 * bell(nm, 530.9, 16.3, 31.1));
        xyz[2] += arrives * (1.217 * bell(nm, 437.0, 11.8, 36.0) + 0.681 * bell(nm, 459.0, 26.0, 13.8));
    }
    *illuminance = xyz[1];
    *red_of_blue = (3.2404542 * xyz[0] - 1.5371385 * xyz[1] - 0.4985314 * xyz[2]) /
                   (0.0556434 * xyz[0] - 0.2040259 * xyz[1] + 1.0572252 * xyz[2]);
}

static void sun_is_a_black_body_behind_air(void)
{
    static const double elevations[] = {90.0, 60.0, 30.0, 15.0, 8.0};
    for (int t = 0; t < 3; ++t) {
        for (size_t i = 0; i < sizeof elevations / sizeof elevations[0]; ++i) {
            double illuminance, red_of_blue;
            black_body_sun(TURBIDITIES[t], elevations[i], &illuminance, &red_of_blue);
            const lmb_daylight daylight = daylight_at(TURBIDITIES[t], elevations[i]);
            const double *rgb = daylight.sun_irradiance;
            CHECK_NEAR(luminance_of(rgb) / illuminance, 1.0, 0.04, "turbidity %g, elevation %g", TURBIDITIES[t],
                       elevations[i]);
            CHECK_NEAR(rgb[0] / rgb[2] / red_of_blue, 1.0, 0.2, "turbidity %g, elevation %g", TURBIDITIES[t],
                       elevations[i]);
        }
    }
}

/* Horizontal illuminance of the sky, by rings of equal weight. */
static double sky_illuminance(const lmb_daylight *daylight)
{
    enum { RINGS = 48, AROUND = 96 };
    double sum = 0.0;
    for (int i = 0; i < RINGS; ++i) {
        const double elevation_deg = asin(sqrt((i + 0.5) / RINGS)) * 180.0 / PI;
        for (int j = 0; j < AROUND; ++j) {
            sum += luminance_towards(daylight, 360.0 * (j + 0.5) / AROUND, elevation_deg);
        }
    }
    return sum * PI / (RINGS * AROUND);
}

static void clear_skies_look_like_it(void)
{
    const lmb_daylight day = daylight_at(3.0, 45.0);
    const double zenith = luminance_towards(&day, 0.0, 90.0);
    CHECK(luminance_towards(&day, 90.0, 2.0) > 1.5 * zenith && luminance_towards(&day, 0.0, 2.0) > 1.1 * zenith,
          "the horizon is brighter than the zenith: %g, %g, %g", luminance_towards(&day, 90.0, 2.0),
          luminance_towards(&day, 0.0, 2.0), zenith);
    double before = luminance_towards(&day, 270.0, 45.0);
    for (double away = 100.0; away > 0.0; away -= 10.0) {
        const double nearer =
            luminance_towards(&day, away < 45.0 ? 90.0 : 270.0, away < 45.0 ? 45.0 + away : 135.0 - away);
        CHECK(away > 60.0 || nearer > before, "brighter towards the sun, %g degrees from it", away);
        before = nearer;
    }
    double low_red = 0.0;
    for (double elevation = 2.0; elevation < 90.0; elevation += 4.0) {
        const double *rgb = daylight_at(3.0, elevation).sun_irradiance;
        const double red = rgb[0] / rgb[1];
        CHECK(elevation == 2.0 || red < low_red, "the sun is redder below %g degrees", elevation);
        low_red = red;
    }
    /* Sun to sky on the ground: rises with the sun, and falls with haze. */
    double last = 0.0;
    for (double elevation = 5.0; elevation <= 65.0; elevation += 15.0) {
        double ratio[2];
        for (int hazy = 0; hazy < 2; ++hazy) {
            const lmb_daylight daylight = daylight_at(hazy ? 6.0 : 3.0, elevation);
            ratio[hazy] = luminance_of(daylight.sun_irradiance) * daylight.sky_sun[1] / sky_illuminance(&daylight);
        }
        CHECK(ratio[0] > last && ratio[0] > 2.0 * ratio[1] && ratio[0] < 6.0, "%g degrees: %g, hazy %g", elevation,
              ratio[0], ratio[1]);
        last = ratio[0];
    }
    CHECK(last > 1.5, "a high sun gives more than the sky: %g", last);
}

/* All elevations and hazes: finite, not negative, and no jump while the sun sets. */
static void no_sun_breaks_it(void)
{
    for (int t = 0; t < TURBIDITY_COUNT; ++t) {
        double last = 0.0;
        for (double elevation = -90.0; elevation <= 90.0;
             elevation += elevation > -2.5 && elevation < 2.0 ? 0.05 : 1.0) {
            const lmb_daylight daylight = daylight_at(TURBIDITIES[t], elevation);
            double lowest = HUGE_VAL, highest = 0.0;
            for (int i = 0; i < 64; ++i) {
                double direction[3], rgb[3];
                lmb_sun_direction(90.0 + 45.0 * (i % 8), 90.0 - 90.0 * (i / 8) / 7.0, direction);
                lmb_daylight_radiance(&daylight, direction, rgb);
                for (int c = 0; c < 3; ++c) {
                    lowest = fmin(lowest, isnan(rgb[c]) ? -1.0 : rgb[c]);
                    highest = fmax(highest, rgb[c]);
                }
            }
            CHECK(lowest >= 0.0 && highest < 3000.0, "turbidity %g, sun at %g: %g to %g", TURBIDITIES[t], elevation,
                  lowest, highest);
            const double *sun = daylight.sun_irradiance;
            CHECK(sun[0] >= 0.0 && sun[1] >= 0.0 && sun[2] >= 0.0 && sun[0] < 130.0, "sun %g %g %g", sun[0], sun[1],
                  sun[2]);
            CHECK(elevation > -0.27 || sun[0] == 0.0, "a sun below the horizon");
            const double at_horizon = luminance_towards(&daylight, 270.0, 10.0);
            CHECK(elevation < -1.97 || elevation > 2.0 || last == 0.0 || fabs(at_horizon / last - 1.0) < 0.1,
                  "a jump at %g: %g to %g", elevation, last, at_horizon);
            last = at_horizon;
        }
    }
    const double nadir[3] = {0.0, -1.0, 0.0};
    const lmb_daylight night = lmb_daylight_of(3.0, nadir);
    CHECK(luminance_towards(&night, 0.0, 30.0) >= 0.0, "the sun straight below");
}

static void sun_stands_where_clock_and_map_say(void)
{
    static const struct {
        double hours, latitude, day;
        double expected[3];
    } cases[] = {
        {12.0, 0.0, 81.0, {0.0, 1.0, 0.0}},                    /* equinox: the zenith of the equator */
        {6.0, 50.0, 81.0, {1.0, 0.0, 0.0}},                    /* rises in the east */
        {18.0, 50.0, 81.0, {-1.0, 0.0, 0.0}},                  /* sets in the west */
        {12.0, 50.0, 81.0, {0.0, 0.642787610, 0.766044443}},   /* stands in the south */
        {12.0, -50.0, 81.0, {0.0, 0.642787610, -0.766044443}}, /* in the north, seen from the south */
        {0.0, 90.0, 173.0, {0.0, 0.397967, 0.917391}},         /* midnight sun at the pole, 23.45 degrees up */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        double to_sun[3];
        lmb_sun_direction_at(cases[i].hours, cases[i].latitude, cases[i].day, to_sun);
        CHECK_NEAR(to_sun[1], cases[i].expected[1], 1e-5, "case %zu", i);
        if (i < 5) {
            CHECK_NEAR(to_sun[0], cases[i].expected[0], 1e-6, "case %zu", i);
            CHECK_NEAR(to_sun[2], cases[i].expected[2], 1e-6, "case %zu", i);
        }
    }
    double north[3], east[3];
    lmb_sun_direction(0.0, 0.0, north);
    lmb_sun_direction(90.0, 0.0, east);
    CHECK(north[2] == -1.0 && fabs(east[0] - 1.0) < 1e-15, "north is -Z, east +X");
}

static void scene_free(lmb_scene *scene)
{
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        free(scene->lights[i].name);
    }
    free(scene->lights);
    free(scene->environment.taken);
    lmb_image_free(&scene->environment.image);
}

static bool environment_take(lmb_scene *scene, const char *text)
{
    lmb_error error = {""};
    const lmb_result result = lmb_scene_set_environment(scene, text, &error);
    CHECK(result == LMB_OK, "%s: %s", text, error.message);
    return result == LMB_OK;
}

/* What the picture's pixel in a direction has; taken pixels as who looks sees them. */
static double shown_luminance(const lmb_environment *environment, const double d[3])
{
    const int row = (int)(acos(d[1]) / PI * environment->image.height);
    const int column = (int)((0.5 + atan2(d[2], d[0]) / (2.0 * PI)) * environment->image.width);
    const uint32_t pixel = (uint32_t)(row * environment->image.width + column);
    const float *rgb = &environment->image.rgb[3 * pixel];
    double found = luminance_of((const double[3]){(double)rgb[0], (double)rgb[1], (double)rgb[2]});
    for (uint32_t i = 0; i < environment->taken_count; ++i) {
        const float *seen = environment->taken[i].radiance.c;
        if (environment->taken[i].pixel == pixel) {
            found = luminance_of((const double[3]){(double)seen[0], (double)seen[1], (double)seen[2]});
        }
    }
    return found;
}

static void picture_and_sun_are_in_the_scene(void)
{
    static const char text[] = "preetham:turbidity=3,sun=120/40,strength=2,rotation=30,ground=0.5";
    lmb_scene scene = {.content_hash = LMB_HASH_SEED};
    if (!environment_take(&scene, text)) {
        return;
    }
    double to_sun[3], turned[3];
    lmb_sun_direction(120.0, 40.0, to_sun);
    lmb_sun_direction(90.0, 40.0, turned); /* counter-clockwise seen from above: azimuths fall */
    const lmb_daylight daylight = lmb_daylight_of(3.0, to_sun);
    const lmb_light *sun = scene.lights;
    CHECK(scene.light_count == 1 && sun->type == LMB_LIGHT_DIRECTIONAL && scene.environment.has_sun, "a sun");
    CHECK_NEAR(sun->direction.x, -turned[0], 1e-6, "towards the west");
    CHECK_NEAR(sun->direction.y, -turned[1], 1e-6, "downwards");
    CHECK_NEAR(sun->intensity.c[1], 2.0 * daylight.sun_irradiance[1], 1e-4, "klx, doubled");
    CHECK_NEAR(sun->angle_rad, 0.533 * PI / 180.0, 1e-7, "angle");

    const double zenith[3] = {0.01, 1.0, 0.0}, west[3] = {-0.8, 0.6, 0.0}, down[3] = {0.1, -0.99, 0.0};
    CHECK_NEAR(shown_luminance(&scene.environment, zenith), luminance_towards(&daylight, 0.0, 90.0), 0.05, "zenith");
    double rgb[3];
    lmb_daylight_radiance(&daylight, west, rgb);
    CHECK_NEAR(shown_luminance(&scene.environment, west) / luminance_of(rgb), 1.0, 0.01, "in the west");
    CHECK_NEAR(shown_luminance(&scene.environment, down) /
                   (0.5 / PI * (luminance_of(daylight.sun_irradiance) * to_sun[1] + sky_illuminance(&daylight))),
               1.0, 0.01, "the ground");
    CHECK(shown_luminance(&scene.environment, to_sun) > 1e4, "the disc is seen");

    lmb_environment_sun found;
    CHECK(lmb_environment_find_sun(&scene.environment, &found) == LMB_OK && found.count == 0, "no second sun");
    lmb_environment_sun_free(&found);
    CHECK(lmb_scene_choose_key_lights(&scene, 1) == LMB_OK && scene.key_light_count == 1 && scene.light_count == 1,
          "it is a key light");
    scene.key_light_count = 0;
    CHECK(environment_take(&scene, "preetham:sun=0/-10") && scene.light_count == 0 && !scene.environment.has_sun,
          "the next environment takes it away");
    CHECK(environment_take(&scene, text) && environment_take(&scene, "preetham:sun=0/10") && scene.light_count == 1 &&
              environment_take(&scene, "none") && scene.light_count == 0,
          "and others");
    scene_free(&scene);
}

static uint64_t hash_of(const char *text)
{
    lmb_scene scene = {.content_hash = LMB_HASH_SEED};
    environment_take(&scene, text);
    scene_free(&scene);
    return scene.content_hash;
}

static void hash_is_of_what_is_seen(void)
{
    static const char *const texts[] = {
        "preetham:sun=0/30",
        "preetham:sun=1/30",
        "preetham:sun=0/31",
        "preetham:sun=0/30,ground=0",
        "preetham:sun=0/30,turbidity=4",
        "preetham:sun=0/30,strength=2",
        "preetham:sun=0/30,rotation=3",
        "preetham:time=9,latitude=48",
        "preetham:time=9,latitude=48,day=1",
    };
    enum { COUNT = sizeof texts / sizeof texts[0] };
    uint64_t hash[COUNT];
    for (int i = 0; i < COUNT; ++i) {
        hash[i] = hash_of(texts[i]);
        for (int j = 0; j < i; ++j) {
            CHECK(hash[i] != hash[j], "'%s' and '%s'", texts[i], texts[j]);
        }
    }
    CHECK(hash[0] == hash_of("preetham:turbidity=3,sun=360/30,strength=1"), "defaults spelt out are the same");
}

static void bad_descriptions_are_refused(void)
{
    static const struct {
        const char *text, *reason;
    } cases[] = {
        {"preetham:", "sun=azimuth/elevation"},
        {"preetham:turbidity=3", "sun=azimuth/elevation"},
        {"preetham:sun=3/4,time=12,latitude=50", "either"},
        {"preetham:sun=3/4,day=5", "either"},
        {"preetham:time=12", "latitude="},
        {"preetham:sun=45", "sun=45"},
        {"preetham:sun=45/", "sun=45/"},
        {"preetham:sun=/45", "sun=/45"},
        {"preetham:sun=0/90.5", "-90 to 90"},
        {"preetham:sun=0/nan", "sun=0/nan"},
        {"preetham:sun=0/45/3", "sun=0/45/3"},
        {"preetham:sun=0/45,turbidity=1.9", "2 to 10"},
        {"preetham:sun=0/45,turbidity=10.1", "2 to 10"},
        {"preetham:sun=0/45,ground=1.5", "albedo"},
        {"preetham:sun=0/45,sun=0/45", "twice"},
        {"preetham:sun=0/45,haze=3", "unknown option 'haze=3'"},
        {"preetham:foo", "'foo'"},
        {"preetham:Foo=3,sun=0/45", "'Foo=3'"},
        {"preetham:time=25,latitude=0", "0 to 24"},
        {"preetham:time=5,latitude=91", "-90 to 90"},
        {"preetham:time=5,latitude=0,day=0", "1 to 366"},
        {"#ffffff,sun=0/45", "unknown option 'sun=0/45'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_scene scene = {.content_hash = 5};
        lmb_error error = {""};
        CHECK(lmb_scene_set_environment(&scene, cases[i].text, &error) == LMB_ERROR_FORMAT &&
                  strstr(error.message, cases[i].reason) && lmb_environment_check(cases[i].text, NULL) != LMB_OK,
              "'%s': %s", cases[i].text, error.message);
        CHECK(!scene.environment.present && !scene.lights && scene.content_hash == 5, "'%s': scene touched",
              cases[i].text);
    }
    CHECK(lmb_environment_check("nowhere.hdr", NULL) == LMB_OK, "files are not looked for");
}

static const test_case CASES[] = {
    {"exponentials are those of libm", exponentials_are_those_of_libm},
    {"sky is the printed formula", sky_is_the_printed_formula},
    {"sun is a black body behind air", sun_is_a_black_body_behind_air},
    {"clear skies look like it", clear_skies_look_like_it},
    {"no sun breaks it", no_sun_breaks_it},
    {"sun stands where clock and map say", sun_stands_where_clock_and_map_say},
    {"picture and sun are in the scene", picture_and_sun_are_in_the_scene},
    {"hash is of what is seen", hash_is_of_what_is_seen},
    {"bad descriptions are refused", bad_descriptions_are_refused},
};

TEST_MAIN(CASES)
