/* A level loaded and made ready for tracing, for the tests of everything that follows light. */
#ifndef LMB_TESTS_LEVEL_FIXTURE_H
#define LMB_TESTS_LEVEL_FIXTURE_H

#include <lambent/emitters.h>
#include <lambent/environment.h>
#include <lambent/gltf.h>
#include <lambent/key_lights.h>
#include <lambent/pool.h>
#include <lambent/gather_sh3.h>
#include <lambent/trace.h>
#include <lambent/transport.h>

#include "harness.h"

typedef struct level_fixture {
    lmb_scene *scene;
    lmb_tracer *tracer;
    lmb_emitters *emitters;
    lmb_pool *pool;
    lmb_transport transport;
} level_fixture;

static inline void level_fixture_close(level_fixture *level)
{
    lmb_pool_destroy(level->pool);
    lmb_emitters_destroy(level->emitters);
    lmb_tracer_destroy(level->tracer);
    lmb_scene_destroy(level->scene);
    memset(level, 0, sizeof *level);
}

/* Loads the level at `path`, with up to so many key lights. `environment` NULL: none. A failure is a failed check, and
 * false. */
static inline bool level_fixture_load_with_keys(level_fixture *level, const char *path, const char *environment,
                                                int threads, uint32_t key_lights)
{
    lmb_error error = {{0}};
    memset(level, 0, sizeof *level);
    lmb_result result = lmb_gltf_load(path, NULL, &level->scene, &error);
    if (result == LMB_OK && environment) {
        result = lmb_scene_set_environment(level->scene, environment, &error);
    }
    if (result == LMB_OK) {
        result = lmb_scene_choose_key_lights(level->scene, key_lights);
    }
    if (result == LMB_OK) {
        result = lmb_tracer_create(level->scene, NULL, threads, &level->tracer, &error);
    }
    if (result == LMB_OK) {
        result = lmb_emitters_create(level->tracer, &level->emitters);
    }
    if (result == LMB_OK) {
        result = lmb_pool_create(threads, &level->pool);
    }
    CHECK(result == LMB_OK, "%s: %s", path, error.message);
    if (result != LMB_OK) {
        level_fixture_close(level);
        return false;
    }
    level->transport = (lmb_transport){.tracer = level->tracer, .emitters = level->emitters, .bounces = -1};
    return true;
}

/* The same without key lights. */
static inline bool level_fixture_load(level_fixture *level, const char *path, const char *environment, int threads)
{
    return level_fixture_load_with_keys(level, path, environment, threads, 0);
}

/* The same for a level that was just written to `path`; `written` and `error` say how that went. */
static inline bool level_fixture_open(level_fixture *level, const char *path, lmb_result written,
                                      const lmb_error *error, int threads)
{
    CHECK(written == LMB_OK, "%s: %s", path, error->message);
    memset(level, 0, sizeof *level);
    return written == LMB_OK && level_fixture_load(level, path, NULL, threads);
}

/* A position in the world, as levels' own space has it. */
static inline lmb_vec3 scene_position(const level_fixture *level, lmb_vec3 world)
{
    return lmb_scene_from_world(level->scene, (lmb_vec3d){(double)world.x, (double)world.y, (double)world.z});
}

/* Normalised irradiance on `normal` at a point in the air, by `samples` samples. */
static inline lmb_rgb traced_irradiance(const level_fixture *level, lmb_vec3 position, lmb_vec3 normal,
                                        uint32_t samples)
{
    const lmb_gather_point point = {.position = scene_position(level, position), .hemisphere = true, .normal = normal};
    lmb_rgb irradiance;
    uint64_t rays = 0;
    const lmb_gather_samples taken = {.points = &point, .point_count = 1, .count = samples};
    lmb_gather_irradiance(&level->transport, &taken, &normal, 1, &irradiance, &rays);
    return irradiance;
}

#endif
