/* A level made ready for tracing, as every command that takes LEVEL needs it. */
#ifndef LMB_TOOLS_LEVEL_H
#define LMB_TOOLS_LEVEL_H

#include <lambent/emitters.h>
#include <lambent/gltf.h>
#include <lambent/pool.h>
#include <lambent/surface_solve.h>
#include <lambent/trace.h>
#include <lambent/transport.h>

/* What the command line says about the level and how to trace it. */
typedef struct lmb_level_options {
    const char *path;
    const char *environment; /* NULL: none given */
    lmb_gltf_options gltf;
    const char *isa; /* NULL: Embree's choice */
    int threads;     /* 0: all processors */
    int bounces;     /* negative: no limit */
    uint64_t seed;
    bool quiet;
} lmb_level_options;

lmb_level_options level_options_default(void);

/* Prints warnings as console_warning does. `options` must outlive it. */
lmb_warnings level_warnings(const lmb_level_options *options);

/* Level options as they come from the command line: the options, and room for the patterns they point to. */
enum { LEVEL_MAX_EXCLUDE = 64 };
typedef struct lmb_level_arguments {
    lmb_level_options options;
    const char *exclude[LEVEL_MAX_EXCLUDE];
} lmb_level_arguments;

/* Takes `option` and its value when it is one of --env, --exclude, --light-scale, --emission-scale,
 * --allow-outside-uris, --threads, --isa, --bounces,
 * --seed, --quiet. LEVEL_USAGE describes them. */
struct lmb_arguments;
bool level_argument(lmb_level_arguments *level, struct lmb_arguments *arguments, const char *option);
#define LEVEL_USAGE                                                                                                    \
    "  --env FILE|#rrggbb[,rotation=DEG][,strength=X]\n"                                                               \
    "                        environment: an equirectangular .hdr or .exr, or a constant colour\n"                     \
    "  --exclude PATTERN     leave out nodes by name, with their children (* and ?; repeatable)\n"                     \
    "  --light-scale X       multiply lamps (KHR_lights_punctual) by this\n"                                           \
    "  --emission-scale X    multiply what materials emit by this\n"                                                   \
    "  --bounces N           reflections at most (default: no limit)\n"                                                \
    "  --seed N              of the random numbers (default 0)\n"                                                      \
    "  --threads N           (default: one for each processor)\n"                                                      \
    "  --isa NAME            pin Embree's instruction set: sse2, sse4.2, avx, avx2, avx512\n"                          \
    "  --allow-outside-uris  let the level refer to files outside its folder\n"                                        \
    "  --quiet               no progress and no warnings\n"

/* How light is found. */
typedef enum lmb_estimator { ESTIMATOR_CACHED, ESTIMATOR_REFERENCE } lmb_estimator;

const char *estimator_name(lmb_estimator estimator);

/* Takes `option` and its value when it is --estimator. */
bool estimator_argument(lmb_estimator *estimator, struct lmb_arguments *arguments, const char *option);

typedef struct lmb_level {
    lmb_level_options options;
    lmb_scene *scene;
    lmb_tracer *tracer;
    lmb_emitters *emitters;
    lmb_pool *pool;
    lmb_transport transport;    /* ready to gather with */
    lmb_surface_light *surface; /* what `transport` gathers from; NULL: reference */
    lmb_surface_light_stats surface_stats;
    double mean_light; /* lmb_surface_light_mean; 0 without surface light */
    double seconds_load;
    double seconds_bvh;
    double seconds_surface;
} lmb_level;

/* Loads, sets the environment, builds; the estimator is the reference. A level without any light gets a constant sky of
 * 1, and a warning that says so unless quiet. On failure `opened` needs no closing. */
lmb_result level_open(const lmb_level_options *options, lmb_level *opened, lmb_error *error);
void level_close(lmb_level *closed);

/* Solves the light on the level's surfaces, anew if it was before, and lets `transport` gather from it, for
 * ESTIMATOR_CACHED. A level with too many triangles for that stays with the reference, with a warning unless quiet. */
lmb_result level_solve(lmb_level *level, lmb_estimator estimator, const lmb_progress *progress, lmb_error *error);

#endif
