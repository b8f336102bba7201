/* Daylight: the clear sky and the sun of Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight",
 * SIGGRAPH 1999. Colours are linear Rec. 709; radiance is in kcd/m2, irradiance in klx. */
#ifndef LMB_DAYLIGHT_H
#define LMB_DAYLIGHT_H

/* Haze: 2 is very clear, 6 hazy: what the paper's sky was fitted to. Below 2 its zenith goes black, past 10 negative.
 */
#define LMB_TURBIDITY_LEAST 2.0
#define LMB_TURBIDITY_MOST 10.0

/* The whole angle of the sun's disc, degrees. */
#define LMB_SUN_ANGLE_DEG 0.533

/* The sky over one place at one time. */
typedef struct lmb_daylight {
    double perez[3][5];       /* A to E of luminance Y and of chromaticities x, y */
    double zenith[3];         /* Y, x, y there, over what Perez' formula has there */
    double sky_sun[3];        /* unit, towards the sun; on the horizon when it is below */
    double dusk;              /* factor of all; 1 while the sun is up */
    double sun_irradiance[3]; /* of a surface that faces the sun, without the sky */
} lmb_daylight;

/* `to_sun`: unit, +Y is up; the sun may be anywhere. */
lmb_daylight lmb_daylight_of(double turbidity, const double to_sun[3]);

/* Radiance from a direction, unit; what is below the horizon has the horizon's. Never negative. */
void lmb_daylight_radiance(const lmb_daylight *daylight, const double direction[3], double radiance[3]);

/* Unit vector towards the sun, by the azimuth as maps have it, clockwise from north = -Z (east = +X). */
void lmb_sun_direction(double azimuth_deg, double elevation_deg, double to_sun[3]);

/* The same by solar time in hours (12: the sun is highest), latitude in degrees, north positive, and the day of the
 * year from 1. */
void lmb_sun_direction_at(double solar_hours, double latitude_deg, double day, double to_sun[3]);

#endif
