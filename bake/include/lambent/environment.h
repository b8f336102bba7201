/* The light that comes from around a scene. */
#ifndef LAMBENT_ENVIRONMENT_H
#define LAMBENT_ENVIRONMENT_H

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Sets the environment from a description:
 *     a path to .hdr or .exr, or #rrggbb (sRGB constant colour), or "none";
 * each may be followed by options, ",rotation=DEG", ",strength=X" and ",set=NAME", the set of lights that it belongs to
 * (lambent/light_sets.h). A picture must be twice as wide as high, within
 * 1 % of its height. Continues scene->content_hash.
 * @return LMB_ERROR_FORMAT, _IO, _UNSUPPORTED, _MEMORY */
lmb_result lmb_scene_set_environment(lmb_scene *scene, const char *description, lmb_error *error);

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
 * faces them, by what they have more than the pixels around. To surfaces that it is wholly above of, the disc gives the
 * irradiance of that excess. @return LMB_ERROR_MEMORY */
lmb_result lmb_environment_find_sun(const lmb_environment *environment, lmb_environment_sun *sun);

/* Takes the excess out of the picture, and notes what was there. @return LMB_ERROR_MEMORY */
lmb_result lmb_environment_take_sun(lmb_environment *environment, const lmb_environment_sun *sun);

void lmb_environment_sun_free(lmb_environment_sun *sun);

#ifdef __cplusplus
}
#endif

#endif
