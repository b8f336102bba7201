#include "run/bake_level_internal.h"

#include <stdio.h>
#include <string.h>

#include <lambent/environment.h>
#include <lambent/key_lights.h>
#include <lambent/light_sets.h>

#include "base/clock.h"
#include "run/step.h"

lmb_level_settings lmb_level_settings_default(void)
{
    return (lmb_level_settings){.light_scale = 1.0, .emission_scale = 1.0, .bounces = -1, .key_lights = 1};
}

static const char *const estimator_names[] = {
    [LMB_ESTIMATOR_CACHED] = "cached", [LMB_ESTIMATOR_REFERENCE] = "reference"};

const char *lmb_estimator_name(lmb_estimator estimator)
{
    return estimator_names[estimator];
}

bool lmb_estimator_find(const char *name, lmb_estimator *estimator)
{
    for (size_t i = 0; i < sizeof estimator_names / sizeof estimator_names[0]; ++i) {
        if (strcmp(name, estimator_names[i]) == 0) {
            *estimator = (lmb_estimator)i;
            return true;
        }
    }
    return false;
}

lmb_gltf_options lmb_level_gltf_options(const lmb_level_settings *settings, const lmb_warnings *warnings)
{
    return (lmb_gltf_options){.exclude = settings->exclude,
                              .exclude_count = settings->exclude_count,
                              .view_node = settings->view_node,
                              .reflection = settings->reflection,
                              .light_scale = settings->light_scale,
                              .emission_scale = settings->emission_scale,
                              .allow_outside_uris = settings->allow_outside_uris,
                              .warnings = warnings ? *warnings : (lmb_warnings){NULL, NULL}};
}

static lmb_result environment_set(lmb_level *level, lmb_error *error)
{
    const lmb_level_settings *settings = &level->settings;
    if (settings->environment) {
        return lmb_scene_set_environment(level->scene, settings->environment, error);
    }
    if (lmb_scene_has_light(level->scene)) {
        return LMB_OK;
    }
    lmb_warn(&level->warnings,
             "%s has no light of any kind that is read; baking under a constant sky of 1 (give one with --env)",
             settings->path);
    return lmb_scene_set_environment(level->scene, "#ffffff", error);
}

/* Which sets there are, for a message. */
static void sets_list(const lmb_scene *scene, char *text, size_t size)
{
    size_t length = 0;
    text[0] = '\0';
    for (uint32_t set = 1; set <= scene->light_set_count && length < size; ++set) {
        length += (size_t)snprintf(text + length, size - length, "%s%s", set > 1 ? ", " : "",
                                   lmb_scene_light_set_name(scene, set));
    }
}

lmb_result lmb_level_find_light_set(const lmb_level *level, const char *name, uint32_t *set, lmb_error *error)
{
    const lmb_scene *const scene = level->scene;
    uint32_t found = scene->light_set_count;
    while (found > 0 && strcmp(lmb_scene_light_set_name(scene, found), name) != 0) {
        --found;
    }
    if (found == 0 && strcmp(name, LMB_LIGHT_SET_BASE) != 0) {
        char known[256];
        sets_list(scene, known, sizeof known);
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: no light is of the set '%s'; there %s %s%s%s%s",
                             scene->path, name, scene->light_set_count > 0 ? "are" : "is no other than", known,
                             scene->light_set_count > 0 ? " and '" : "'", LMB_LIGHT_SET_BASE, "'");
    }
    *set = found;
    return LMB_OK;
}

static lmb_result light_set_show(lmb_level *level, lmb_error *error)
{
    uint32_t set;
    if (!level->settings.light_set) {
        return LMB_OK;
    }
    const lmb_result result = lmb_level_find_light_set(level, level->settings.light_set, &set, error);
    if (result != LMB_OK) {
        return result;
    }
    return lmb_scene_show_light_set(level->scene, set) == LMB_OK
               ? LMB_OK
               : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
}

static lmb_result level_load(lmb_level *level, const lmb_progress *progress, lmb_error *error)
{
    const double start = lmb_clock_seconds();
    const lmb_gltf_options options = lmb_level_gltf_options(&level->settings, &level->warnings);
    lmb_result result = step_report(progress, "load", 0.0, error);
    if (result == LMB_OK) {
        result = lmb_gltf_load(level->settings.path, &options, &level->scene, error);
    }
    if (result == LMB_OK) {
        result = environment_set(level, error);
    }
    if (result == LMB_OK && lmb_scene_choose_key_lights(level->scene, level->settings.key_lights) != LMB_OK) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    if (result == LMB_OK) {
        result = light_set_show(level, error);
    }
    level->seconds_load = lmb_clock_seconds() - start;
    return result == LMB_OK ? step_report(progress, "load", 1.0, error) : result;
}

static lmb_result level_build(lmb_level *level, const lmb_progress *progress, lmb_error *error)
{
    const double start = lmb_clock_seconds();
    const lmb_level_settings *settings = &level->settings;
    lmb_result result = step_report(progress, "bvh", 0.0, error);
    if (result == LMB_OK) {
        result = lmb_tracer_create(level->scene, settings->isa, settings->threads, &level->tracer, error);
    }
    if (result == LMB_OK && (lmb_emitters_create(level->tracer, &level->emitters) != LMB_OK ||
                             lmb_pool_create(settings->threads, &level->pool) != LMB_OK)) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    level->seconds_bvh = lmb_clock_seconds() - start;
    return result == LMB_OK ? step_report(progress, "bvh", 1.0, error) : result;
}

lmb_result lmb_level_open(const lmb_level_settings *settings, const lmb_warnings *warnings,
                          const lmb_progress *progress, lmb_level *level, lmb_error *error)
{
    *level = (lmb_level){.settings = *settings, .warnings = warnings ? *warnings : (lmb_warnings){NULL, NULL}};
    lmb_result result = level_load(level, progress, error);
    if (result == LMB_OK) {
        result = level_build(level, progress, error);
    }
    if (result != LMB_OK) {
        lmb_level_close(level);
        return result;
    }
    lmb_tracer_warn(level->tracer, &level->warnings);
    level->transport = (lmb_transport){
        .tracer = level->tracer, .emitters = level->emitters, .bounces = settings->bounces, .seed = settings->seed};
    return LMB_OK;
}

void lmb_level_close(lmb_level *level)
{
    lmb_pool_destroy(level->pool);
    lmb_surface_light_destroy(level->surface);
    lmb_emitters_destroy(level->emitters);
    lmb_tracer_destroy(level->tracer);
    lmb_scene_destroy(level->scene);
    *level = (lmb_level){.scene = NULL};
}

lmb_result lmb_level_show_light_set(lmb_level *level, uint32_t set, lmb_error *error)
{
    lmb_emitters *emitters = NULL;
    if (lmb_scene_show_light_set(level->scene, set) != LMB_OK ||
        lmb_emitters_create(level->tracer, &emitters) != LMB_OK) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    lmb_surface_light_destroy(level->surface);
    lmb_emitters_destroy(level->emitters);
    level->surface = NULL;
    level->emitters = emitters;
    level->transport.emitters = emitters;
    level->transport.surface = NULL;
    return LMB_OK;
}

void lmb_level_take_surface(lmb_level *level, lmb_surface_light *surface)
{
    level->surface = surface;
    level->transport.surface = surface;
    level->mean_light = lmb_surface_light_mean(surface, level->tracer);
}

lmb_result lmb_level_solve(lmb_level *level, lmb_estimator estimator, const lmb_progress *progress, lmb_error *error)
{
    lmb_surface_light_destroy(level->surface);
    level->surface = NULL;
    level->transport.surface = NULL;
    if (estimator == LMB_ESTIMATOR_REFERENCE) {
        return LMB_OK;
    }
    lmb_error reason;
    error = error ? error : &reason; /* a warning needs it */
    const double start = lmb_clock_seconds();
    lmb_surface_light_settings settings = lmb_surface_light_settings_default();
    settings.progress = progress;
    lmb_surface_light *surface;
    const lmb_result result =
        lmb_surface_light_solve(&level->transport, &settings, level->pool, &surface, &level->surface_stats, error);
    level->seconds_surface = lmb_clock_seconds() - start;
    if (result == LMB_OK) {
        lmb_level_take_surface(level, surface);
    }
    if (result != LMB_ERROR_UNSUPPORTED) {
        return result;
    }
    lmb_warn(&level->warnings, "%s; tracing every path to its end", error->message);
    return LMB_OK;
}
