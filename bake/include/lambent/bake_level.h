/* A level opened for tracing: what a bake, or a single question about its light, begins with. */
#ifndef LAMBENT_BAKE_LEVEL_H
#define LAMBENT_BAKE_LEVEL_H

#include <lambent/emitters.h>
#include <lambent/gltf.h>
#include <lambent/pool.h>
#include <lambent/surface_solve.h>
#include <lambent/trace.h>
#include <lambent/transport.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LMB_LEVEL_MAX_EXCLUDE = 64 };

/* The lights that name no set. */
#define LMB_LIGHT_SET_BASE "base"

/* Which level, and how it is traced. Values: copy them by assignment; nothing points into them. Strings are the
 * caller's, who keeps them for as long as the settings, a copy of them, or a level opened with them is used. */
typedef struct lmb_level_settings {
    const char *path;                           /* .gltf or .glb */
    const char *environment;                    /* as lmb_scene_set_environment takes it; NULL: none given */
    const char *exclude[LMB_LEVEL_MAX_EXCLUDE]; /* patterns of node names, see lmb_gltf_options */
    uint32_t exclude_count;
    const char *view_node;   /* likewise; NULL: none */
    bool reflection;         /* likewise */
    double light_scale;      /* > 0, of lamps */
    double emission_scale;   /* > 0, of what materials emit */
    bool allow_outside_uris; /* see lmb_gltf_options */
    const char *isa;         /* see lmb_tracer_create; NULL: Embree's choice */
    int threads;             /* 0: one for each processor */
    int bounces;             /* reflections at most; negative: no limit */
    uint64_t seed;           /* of the random numbers */
    const char
        *light_set;      /* which lights alone (lambent/light_sets.h): a set's name, or LMB_LIGHT_SET_BASE; NULL: all */
    uint32_t key_lights; /* suns kept apart from the harmonics at most, see lmb_scene_choose_key_lights */
} lmb_level_settings;

/* No level, scales 1, all threads, any number of bounces, seed 0, one key light. */
lmb_level_settings lmb_level_settings_default(void);

/* How light is found. */
typedef enum lmb_estimator {
    LMB_ESTIMATOR_CACHED,   /* solve the light on surfaces first, then gather it */
    LMB_ESTIMATOR_REFERENCE /* trace every path to its end: unbiased and slower */
} lmb_estimator;

/* "cached" or "reference". */
const char *lmb_estimator_name(lmb_estimator estimator);

/* The estimator of that name. False, and nothing is written, when there is none. */
bool lmb_estimator_find(const char *name, lmb_estimator *estimator);

typedef struct lmb_level {
    lmb_level_settings settings;
    lmb_warnings warnings;
    lmb_scene *scene;
    lmb_tracer *tracer;
    lmb_emitters *emitters;
    lmb_pool *pool;
    lmb_transport transport;    /* ready to gather with */
    lmb_surface_light *surface; /* what `transport` gathers from; NULL: reference */
    lmb_surface_light_stats surface_stats;
    double mean_light; /* lmb_surface_light_mean; 0 without surface light */
    double seconds_load, seconds_bvh, seconds_surface;
} lmb_level;

/* Loads the level, sets the environment, chooses key lights, lights the set that is wanted, builds; the estimator is
 * the reference. A level without any light gets a constant sky of 1, and a warning that says so. `warnings` and
 * `progress` may be NULL; progress has the phases "load" and "bvh". On failure `*level` needs no closing.
 * @return what lmb_gltf_load, lmb_scene_set_environment and lmb_tracer_create return, LMB_ERROR_UNSUPPORTED (no light
 * names that set), _MEMORY, _INTERRUPTED */
lmb_result lmb_level_open(const lmb_level_settings *settings, const lmb_warnings *warnings,
                          const lmb_progress *progress, lmb_level *level, lmb_error *error);
void lmb_level_close(lmb_level *level);

/* The set of lights of that name: LMB_LIGHT_SET_BASE is 0. @return LMB_ERROR_UNSUPPORTED (no light names it) */
lmb_result lmb_level_find_light_set(const lmb_level *level, const char *name, uint32_t *set, lmb_error *error);

/* Lights one of the level's sets of lights alone, or all (lambent/light_sets.h); the estimator is the reference again.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_level_show_light_set(lmb_level *level, uint32_t set, lmb_error *error);

/* Solves the light on the level's surfaces, anew if it was before, and lets `transport` gather from it, for
 * LMB_ESTIMATOR_CACHED. A level with too many triangles for that stays with the reference, with a warning.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_level_solve(lmb_level *level, lmb_estimator estimator, const lmb_progress *progress, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
