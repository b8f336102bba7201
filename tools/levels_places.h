/* Places in the free space of a level, their light, and how far probes are from it: of what measures levels. The error
 * is of irradiance, over all normals, by SH3 and key lights. Noise of truth and probes is taken out by their
 * independent halves. */
#ifndef LMB_LEVELS_PLACES_H
#define LMB_LEVELS_PLACES_H

#include <lambent/bake_phases.h>

/* Light of one place: its mean, and half of what its halves differ by. */
typedef struct place_light {
    lmb_sh3_rgb mean, difference;
    double key_visibility[LMB_KEY_LIGHTS_MOST];
} place_light;

typedef struct place {
    lmb_vec3 position; /* in the scene */
    place_light truth;
    double squared_light;
} place;

typedef struct level_places {
    lmb_level *level; /* open, its surface light solved by places_make */
    lmb_bake_settings settings;
    uint32_t wanted, truth_samples;
    uint32_t count; /* of those found */
    place *place;
    double dark_squared; /* places that are darker count as this dark */
    uint32_t key_count;
    double key_weight[LMB_KEY_LIGHTS_MOST];
} level_places;

/* Solves the level's light and finds places, in the free space of an even lattice of this spacing, and their light.
 * `level` to `truth_samples` are the caller's; `place` is to be freed. @return what phases of a bake return */
lmb_result places_make(level_places *places, double spacing, lmb_error *error);

/* The squared error of what probes of places_bake give at a place, and `*share` that over the place's squared light,
 * which can be below 0 by noise. @return false, and nothing is set, where they have no cell */
bool place_error(const level_places *places, const lmb_probes *probes, const place *at, double *squared, double *share);

/* Places probes of these settings on the level, and levels of them where the settings ask for some, in memory, and
 * gathers at them. `*bake` is to be ended, whatever is returned. */
lmb_result places_bake(const level_places *places, const lmb_bake_settings *settings, lmb_bake *bake, lmb_error *error);

/* Gathers at what is placed: set 0 is the light, set 1 what its halves differ by. No denoising. */
lmb_result places_gather(lmb_bake *bake);

#endif
