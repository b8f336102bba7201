/* A level built in memory, written, loaded and made ready for tracing, for the tests of what is above the baker. */
#ifndef LMB_TESTS_LEVEL_FIXTURE_H
#define LMB_TESTS_LEVEL_FIXTURE_H

#include <lambent/emitters.h>
#include <lambent/gltf.h>
#include <lambent/pool.h>
#include <lambent/transport.h>

#include "harness.h"

typedef struct level_fixture {
    lmb_scene *scene;
    lmb_tracer *tracer;
    lmb_emitters *emitters;
    lmb_pool *pool;
    lmb_transport transport;
} level_fixture;

static inline void level_fixture_close(level_fixture *fixture)
{
    lmb_pool_destroy(fixture->pool);
    lmb_emitters_destroy(fixture->emitters);
    lmb_tracer_destroy(fixture->tracer);
    lmb_scene_destroy(fixture->scene);
}

/* Opens the level at `path`, which `written` says was written; a failure counts as a failed check. */
static inline bool level_fixture_open(level_fixture *fixture, const char *path, lmb_result written, lmb_error *error,
                                      int threads)
{
    *fixture = (level_fixture){0};
    const bool opened = written == LMB_OK && lmb_gltf_load(path, NULL, &fixture->scene, error) == LMB_OK &&
                        lmb_tracer_create(fixture->scene, NULL, threads, &fixture->tracer, error) == LMB_OK &&
                        lmb_emitters_create(fixture->tracer, &fixture->emitters) == LMB_OK &&
                        lmb_pool_create(threads, &fixture->pool) == LMB_OK;
    CHECK(opened, "%s: %s", path, error->message);
    if (!opened) {
        level_fixture_close(fixture);
        return false;
    }
    fixture->transport = (lmb_transport){.tracer = fixture->tracer, .emitters = fixture->emitters, .bounces = -1};
    return true;
}

#endif
