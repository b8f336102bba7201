/* Named groups of a level's lights, each of which is baked by itself so that a game can dim it, colour it and switch
 * it: light is additive, so the sum of all sets at weight 1 is the level's. */
#ifndef LAMBENT_LIGHT_SETS_H
#define LAMBENT_LIGHT_SETS_H

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* All of them at once, as a scene begins. */
#define LMB_LIGHT_SETS_ALL UINT32_MAX

/* The set of that name, made if there is none: the first is 1. Lights that name none are set 0, "". Names are 1 to
 * LMB_LIGHT_SET_NAME - 1 letters, digits, '-' and '_': files are called by them.
 * @return LMB_ERROR_ARGUMENT (no such name), _UNSUPPORTED (more than LMB_LIGHT_SETS_MOST) */
lmb_result lmb_scene_light_set(lmb_scene *scene, const char *name, uint32_t *set);

/* The name of a set: "" of 0. */
const char *lmb_scene_light_set_name(const lmb_scene *scene, uint32_t set);

/* Whether anything gives light in a set. */
bool lmb_scene_light_set_is_used(const lmb_scene *scene, uint32_t set);

/* Lights a set alone, or all: lights, emission, environment and key lights of the others give nothing from here on.
 * What was made from the scene's lights (lmb_emitters, surface light) is to be made anew. @return LMB_ERROR_MEMORY */
lmb_result lmb_scene_show_light_set(lmb_scene *scene, uint32_t set);

#ifdef __cplusplus
}
#endif

#endif
