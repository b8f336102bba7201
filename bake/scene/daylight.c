#include "scene/daylight.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/exponential.h"
#include "base/trig.h"

static const double RAD_PER_DEG = LMB_PI / 180.0;

/* Appendix A.2: A to E of Perez' formula for Y, x and y as slope x turbidity + offset. */
static const double PEREZ[3][5][2] = {
    {{0.1787, -1.4630}, {-0.3554, 0.4275}, {-0.0227, 5.3251}, {0.1206, -2.5771}, {-0.0670, 0.3703}},
    {{-0.0193, -0.2592}, {-0.0665, 0.0008}, {-0.0004, 0.2125}, {-0.0641, -0.8989}, {-0.0033, 0.0452}},
    {{-0.0167, -0.2608}, {-0.0950, 0.0092}, {-0.0079, 0.2102}, {-0.0441, -1.6537}, {-0.0109, 0.0529}},
};

/* The zenith's x and y: rows by turbidity^2, turbidity, 1; columns by the sun's polar angle, cubed to constant. */
static const double ZENITH[2][3][4] = {
    {{0.00166, -0.00375, 0.00209, 0.0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}},
    {{0.00275, -0.00610, 0.00317, 0.0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}},
};

/* Appendix A.1, every 10 nm from 380: the sun's radiance above the air in W/(m2 sr nm), absorption by ozone in 1/cm and
 * by water vapour in 1/cm. (Mixed gases absorb from 759 nm on alone.) Then the CIE 1931 observer. */
static const struct {
    double radiance, ozone, water;
    double observer[3];
} SPECTRUM[] = {
    {16559.0, 0.0, 0.0, {0.001368, 0.000039, 0.006450}},   {16233.7, 0.0, 0.0, {0.004243, 0.000120, 0.020050}},
    {21127.5, 0.0, 0.0, {0.014310, 0.000396, 0.067850}},   {25888.2, 0.0, 0.0, {0.043510, 0.001210, 0.207400}},
    {25829.1, 0.0, 0.0, {0.134380, 0.004000, 0.645600}},   {24232.3, 0.0, 0.0, {0.283900, 0.011600, 1.385600}},
    {26760.5, 0.0, 0.0, {0.348280, 0.023000, 1.747060}},   {29658.3, 0.003, 0.0, {0.336200, 0.038000, 1.772110}},
    {30545.4, 0.006, 0.0, {0.290800, 0.060000, 1.669200}}, {30057.5, 0.009, 0.0, {0.195360, 0.090980, 1.287640}},
    {30663.7, 0.014, 0.0, {0.095640, 0.139020, 0.812950}}, {28830.4, 0.021, 0.0, {0.032010, 0.208020, 0.465180}},
    {28712.1, 0.030, 0.0, {0.004900, 0.323000, 0.272000}}, {27825.0, 0.040, 0.0, {0.009300, 0.503000, 0.158200}},
    {27100.6, 0.048, 0.0, {0.063270, 0.710000, 0.078250}}, {27233.6, 0.063, 0.0, {0.165500, 0.862000, 0.042160}},
    {26361.3, 0.075, 0.0, {0.290400, 0.954000, 0.020300}}, {25503.8, 0.085, 0.0, {0.433450, 0.994950, 0.008750}},
    {25060.2, 0.103, 0.0, {0.594500, 0.995000, 0.003900}}, {25311.6, 0.120, 0.0, {0.762100, 0.952000, 0.002100}},
    {25355.9, 0.120, 0.0, {0.916300, 0.870000, 0.001650}}, {25134.2, 0.115, 0.0, {1.026300, 0.757000, 0.001100}},
    {24631.5, 0.125, 0.0, {1.062200, 0.631000, 0.000800}}, {24173.2, 0.120, 0.0, {1.002600, 0.503000, 0.000340}},
    {23685.3, 0.105, 0.0, {0.854450, 0.381000, 0.000190}}, {23212.1, 0.090, 0.0, {0.642400, 0.265000, 0.000050}},
    {22827.7, 0.079, 0.0, {0.447900, 0.175000, 0.000020}}, {22339.8, 0.067, 0.0, {0.283500, 0.107000, 0.0}},
    {21970.2, 0.057, 0.0, {0.164900, 0.061000, 0.0}},      {21526.7, 0.048, 0.0, {0.087400, 0.032000, 0.0}},
    {21097.9, 0.036, 0.0, {0.046770, 0.017000, 0.0}},      {20728.3, 0.028, 0.016, {0.022700, 0.008210, 0.0}},
    {20240.4, 0.023, 0.024, {0.011359, 0.004102, 0.0}},    {19870.8, 0.018, 0.0125, {0.005790, 0.002091, 0.0}},
    {19427.2, 0.014, 1.0, {0.002899, 0.001047, 0.0}},      {19072.4, 0.011, 0.87, {0.001440, 0.000520, 0.0}},
    {18628.9, 0.010, 0.061, {0.000690, 0.000249, 0.0}},    {18259.2, 0.009, 0.001, {0.000332, 0.000120, 0.0}},
};

/* Of CIE XYZ, colours of a white at D65. What lies outside of Rec. 709 is cut off. */
static void rec709_of_xyz(const double xyz[3], double rgb[3])
{
    static const double ROWS[3][3] = {
        {3.2404542, -1.5371385, -0.4985314}, {-0.9692660, 1.8760108, 0.0415560}, {0.0556434, -0.2040259, 1.0572252}};
    for (int c = 0; c < 3; ++c) {
        const double value = ROWS[c][0] * xyz[0] + ROWS[c][1] * xyz[1] + ROWS[c][2] * xyz[2];
        rgb[c] = value > 0.0 ? value : 0.0;
    }
}

/* What is left of the sun's light of a wavelength after the air, at relative optical mass `mass` (appendix A.1). */
static double transmittance(size_t band, double turbidity, double mass)
{
    const double micrometres = 0.38 + 0.01 * (double)band;
    const double aerosol = 0.04608 * turbidity - 0.04586; /* Angstrom's beta */
    const double ozone_cm = 0.35, water_cm = 2.0;
    const double water = SPECTRUM[band].water * water_cm * mass;
    const double depth = 0.008735 * lmb_pow(micrometres, -4.08) * mass + aerosol * lmb_pow(micrometres, -1.3) * mass +
                         SPECTRUM[band].ozone * ozone_cm * mass + 0.2385 * water / lmb_pow(1.0 + 20.07 * water, 0.45);
    return lmb_exp(-depth);
}

/* The share of the disc that is above the horizon: a smooth step over its height, in place of the segment of a circle.
 */
static double disc_share(double elevation_deg)
{
    const double step = fmin(fmax(0.5 + elevation_deg / LMB_SUN_ANGLE_DEG, 0.0), 1.0);
    return step * step * (3.0 - 2.0 * step);
}

static void sun_irradiance_find(double turbidity, double elevation_deg, double irradiance[3])
{
    const double klx_of_watts = 0.683 * 10.0; /* lm/W at 555 nm; 10 nm a band */
    const double radius = 0.5 * LMB_SUN_ANGLE_DEG * RAD_PER_DEG;
    const double share = disc_share(elevation_deg);
    double xyz[3] = {0.0, 0.0, 0.0};
    if (share > 0.0) {
        double sine, cosine;
        lmb_sincos(elevation_deg * RAD_PER_DEG, &sine, &cosine);
        const double mass = 1.0 / (sine + 0.15 * lmb_pow(elevation_deg + 3.885, -1.253)); /* Kasten 1966 */
        for (size_t i = 0; i < sizeof SPECTRUM / sizeof SPECTRUM[0]; ++i) {
            const double watts = SPECTRUM[i].radiance * transmittance(i, turbidity, mass);
            for (int c = 0; c < 3; ++c) {
                xyz[c] += watts * SPECTRUM[i].observer[c] * klx_of_watts * LMB_PI * radius * radius * share;
            }
        }
    }
    rec709_of_xyz(xyz, irradiance);
}

/* Perez' formula at the polar angle of cosine `up` > 0 and `from_sun` away from the sun. */
static double perez(const double coefficient[5], double up, double from_sun, double from_sun_cosine)
{
    return (1.0 + coefficient[0] * lmb_exp(coefficient[1] / up)) *
           (1.0 + coefficient[2] * lmb_exp(coefficient[3] * from_sun) +
            coefficient[4] * from_sun_cosine * from_sun_cosine);
}

/* Y, x and y at the zenith with the sun at a polar angle of at most pi/2 (appendix A.2). */
static void zenith_find(double turbidity, double sun_polar, double zenith[3])
{
    const double by_turbidity[3] = {turbidity * turbidity, turbidity, 1.0};
    double sine, cosine;
    lmb_sincos((4.0 / 9.0 - turbidity / 120.0) * (LMB_PI - 2.0 * sun_polar), &sine, &cosine);
    zenith[0] = (4.0453 * turbidity - 4.9710) * sine / cosine - 0.2155 * turbidity + 2.4192;
    for (int c = 0; c < 2; ++c) {
        zenith[1 + c] = 0.0;
        for (int k = 0; k < 3; ++k) {
            const double *row = ZENITH[c][k];
            zenith[1 + c] +=
                by_turbidity[k] * (((row[0] * sun_polar + row[1]) * sun_polar + row[2]) * sun_polar + row[3]);
        }
    }
}

/* The paper ends where the sun sets. From there its sky of the horizon is dimmed by a power of ten each 2.7 degrees:
 * civil twilight, from some hundred lux to three at -6 degrees. */
static double dusk_of(double elevation_deg)
{
    return elevation_deg < 0.0 ? lmb_exp(elevation_deg * (2.30258509299404568402 / 2.7)) : 1.0;
}

lmb_daylight lmb_daylight_of(double turbidity, const double to_sun[3])
{
    const double flat = sqrt(to_sun[0] * to_sun[0] + to_sun[2] * to_sun[2]);
    const double elevation_deg = lmb_angle_of(flat, to_sun[1]) / RAD_PER_DEG;
    const bool up = to_sun[1] > 0.0;
    const double polar = up ? lmb_angle_of(to_sun[1], flat) : LMB_PI / 2.0;
    lmb_daylight daylight = {.dusk = dusk_of(elevation_deg)};
    if (up) {
        daylight.sky_sun[0] = to_sun[0], daylight.sky_sun[1] = to_sun[1], daylight.sky_sun[2] = to_sun[2];
    } else {
        daylight.sky_sun[0] = flat > 0.0 ? to_sun[0] / flat : 0.0;
        daylight.sky_sun[2] = flat > 0.0 ? to_sun[2] / flat : -1.0;
    }
    zenith_find(turbidity, polar, daylight.zenith);
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < 5; ++k) {
            daylight.perez[c][k] = PEREZ[c][k][0] * turbidity + PEREZ[c][k][1];
        }
        daylight.zenith[c] /= perez(daylight.perez[c], 1.0, polar, daylight.sky_sun[1]);
    }
    sun_irradiance_find(turbidity, elevation_deg, daylight.sun_irradiance);
    return daylight;
}

void lmb_daylight_radiance(const lmb_daylight *daylight, const double direction[3], double radiance[3])
{
    const double least_up = 1e-6;
    const double *sun = daylight->sky_sun;
    const double up = direction[1] > least_up ? direction[1] : least_up;
    const double cosine = direction[0] * sun[0] + direction[1] * sun[1] + direction[2] * sun[2];
    const double from_sun = lmb_angle_of(cosine, sqrt(fmax((1.0 - cosine) * (1.0 + cosine), 0.0)));
    double found[3];
    for (int c = 0; c < 3; ++c) {
        found[c] = daylight->zenith[c] * perez(daylight->perez[c], up, from_sun, cosine);
    }
    const double luminance = found[0] * daylight->dusk;
    const double xyz[3] = {luminance * found[1] / found[2], luminance,
                           luminance * (1.0 - found[1] - found[2]) / found[2]};
    rec709_of_xyz(xyz, radiance);
}

void lmb_sun_direction(double azimuth_deg, double elevation_deg, double to_sun[3])
{
    double azimuth_sine, azimuth_cosine, sine, cosine;
    lmb_sincos(azimuth_deg * RAD_PER_DEG, &azimuth_sine, &azimuth_cosine);
    lmb_sincos(elevation_deg * RAD_PER_DEG, &sine, &cosine);
    to_sun[0] = cosine * azimuth_sine;
    to_sun[1] = sine;
    to_sun[2] = -cosine * azimuth_cosine;
}

void lmb_sun_direction_at(double solar_hours, double latitude_deg, double day, double to_sun[3])
{
    double season, unused, tilt_sine, tilt_cosine, latitude_sine, latitude_cosine, hour_sine, hour_cosine;
    lmb_sincos(2.0 * LMB_PI * (day - 81.0) / 368.0, &season, &unused);
    lmb_sincos(0.4093 * season, &tilt_sine, &tilt_cosine); /* the declination of appendix A.6 */
    lmb_sincos(latitude_deg * RAD_PER_DEG, &latitude_sine, &latitude_cosine);
    lmb_sincos((solar_hours - 12.0) * LMB_PI / 12.0, &hour_sine, &hour_cosine);
    to_sun[0] = -tilt_cosine * hour_sine;
    to_sun[1] = latitude_sine * tilt_sine + latitude_cosine * tilt_cosine * hour_cosine;
    to_sun[2] = -(latitude_cosine * tilt_sine - latitude_sine * tilt_cosine * hour_cosine);
}
