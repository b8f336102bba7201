/* A level made ready for tracing, as every command that takes LEVEL needs it. */
#ifndef LMB_TOOLS_LEVEL_H
#define LMB_TOOLS_LEVEL_H

#include <lambent/emitters.h>
#include <lambent/gltf.h>
#include <lambent/pool.h>
#include <lambent/trace.h>
#include <lambent/transport.h>

/* What the command line says about the level and how to trace it. */
typedef struct level_options {
    const char *path;
    const char *environment;      /* NULL: none given */
    lmb_gltf_options gltf;
    const char *isa;              /* NULL: Embree's choice */
    int threads;                  /* 0: all processors */
    int bounces;                  /* negative: no limit */
    uint64_t seed;
    bool quiet;
} level_options;

level_options level_options_default(void);

typedef struct level {
    level_options options;
    lmb_scene *scene;
    lmb_tracer *tracer;
    lmb_emitters *emitters;
    lmb_pool *pool;
    lmb_transport transport;      /* ready to gather with */
    double seconds_load;
    double seconds_bvh;
} level;

/* Loads, sets the environment, builds. A level without any light gets a constant sky of 1, and a warning that says so
 * unless quiet. On failure `opened` needs no closing. */
lmb_result level_open(const level_options *options, level *opened, lmb_error *error);
void level_close(level *closed);

#endif
