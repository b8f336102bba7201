/* The light that comes from around a scene. */
#ifndef LAMBENT_ENVIRONMENT_H
#define LAMBENT_ENVIRONMENT_H

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Sets the environment from a description:
 *     a path to .hdr or .exr, or #rrggbb (sRGB constant colour), or "none", or daylight,
 *     "preetham:sun=AZIMUTH/ELEVATION" or "preetham:time=HOURS,latitude=DEG", or
 *     "sky-basis:K", K from 0 to 8, the K-th of the skies that changing ones are made of (lambent/sky.h);
 * each may be followed by options, ",rotation=DEG", ",strength=X" and ",set=NAME", the set of lights that it belongs to
 * (lambent/light_sets.h). A picture must be twice as wide as high, within
 * 1 % of its height. Continues scene->content_hash.
 *
 * Daylight is the clear sky of Preetham, Shirley and Smits (1999), and its sun as the scene's last light, a directional
 * one, where it is above the horizon. Radiance is in kcd/m2 and irradiance in klx: strength=1000 gives the units of
 * KHR_lights_punctual. Azimuths run clockwise from north, -Z; east is +X. Time is solar, 12 at noon, and goes with
 * ",day=" of the year (172). Further options: ",turbidity=" from 2 to 10 (3), and ",ground=", the albedo of what is
 * below the horizon, lit by sky and sun (0.2). Before key lights are chosen (lambent/key_lights.h).
 * @return LMB_ERROR_FORMAT, _IO, _UNSUPPORTED, _MEMORY */
lmb_result lmb_scene_set_environment(lmb_scene *scene, const char *description, lmb_error *error);

/* Whether a description is well formed; reads no file. @return LMB_ERROR_FORMAT, _MEMORY */
lmb_result lmb_environment_check(const char *description, lmb_error *error);

/* The sun in a picture, as a disc. */
typedef struct lmb_environment_sun {
    lmb_vec3 direction; /* unit, in the world, towards it */
    lmb_rgb irradiance; /* of a surface that faces it, not normalised, strength included */
    float angle_rad;    /* the whole angle that it takes */
    uint32_t count;     /* of its pixels; 0: there is no sun */
    uint32_t *pixel;    /* ascending */
    lmb_rgb around;     /* radiance of the pixels around these, for strength 1 */
} lmb_environment_sun;

/* Looks for it: the brightest pixel with those joined to it that have a tenth of its luminance, if they lie within 5
 * degrees of it, spread no more than a disc of 10 degrees and give a tenth or more of the irradiance of a surface that
 * faces them, by what they have more than the pixels around. Daylight, whose sun is a light already, has none. To
 * surfaces that it is wholly above of, the disc gives the irradiance of that excess. @return LMB_ERROR_MEMORY */
lmb_result lmb_environment_find_sun(const lmb_environment *environment, lmb_environment_sun *sun);

/* Takes the excess out of the picture, and notes what was there. @return LMB_ERROR_MEMORY */
lmb_result lmb_environment_take_sun(lmb_environment *environment, const lmb_environment_sun *sun);

void lmb_environment_sun_free(lmb_environment_sun *sun);

#ifdef __cplusplus
}
#endif

#endif
