#include "levels_places.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/key_lights.h>
#include <lambent/sequence.h>

enum { MOST_TRIES = 1000 };
#define PI 3.14159265358979323846
#define DARK_SHARE 0.01

/* Squared norm of what an object gets: mean over normals of squared normalised irradiance. */
static double light_squared(const level_places *places, const lmb_sh3_rgb *light, const double *key_visibility)
{
    static const double band[3] = {1.0, 2.0 / 3.0, 0.25};
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            const double part = band[k == 0 ? 0 : k < 4 ? 1 : 2] * (double)light->channel[c].c[k];
            sum += part * part / (4.0 * PI);
        }
    }
    for (uint32_t key = 0; key < places->key_count; ++key) {
        sum += places->key_weight[key] * key_visibility[key] * key_visibility[key];
    }
    return sum;
}

static lmb_sh3_rgb light_less(const lmb_sh3_rgb *a, const lmb_sh3_rgb *b)
{
    lmb_sh3_rgb less;
    for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
        const int c = i / LMB_SH3_COUNT, k = i % LMB_SH3_COUNT;
        less.channel[c].c[k] = a->channel[c].c[k] - b->channel[c].c[k];
    }
    return less;
}

/* ------------------------------------------------------------------------------------------------ places */

static bool place_find(const level_places *places, const lmb_probes *covered, uint32_t number, lmb_vec3 *position)
{
    const lmb_scene *scene = places->level->scene;
    const float low[3] = {scene->bounds_min.x, scene->bounds_min.y, scene->bounds_min.z};
    const float high[3] = {scene->bounds_max.x, scene->bounds_max.y, scene->bounds_max.z};
    for (uint32_t attempt = 0; attempt < MOST_TRIES; ++attempt) {
        float across[2], height[2];
        uint64_t rays = 0;
        lmb_sequence_2d(UINT64_C(77) + number, attempt, 0, across);
        lmb_sequence_2d(UINT64_C(77) + number, attempt, 1, height);
        const lmb_vec3 at = {low[0] + across[0] * (high[0] - low[0]), low[1] + height[0] * (high[1] - low[1]),
                             low[2] + across[1] * (high[2] - low[2])};
        int32_t around[8];
        double fraction[3];
        bool near_free = false;
        if (lmb_probes_around(covered, lmb_scene_to_world(scene, at), around, fraction)) {
            for (int i = 0; i < 8; ++i) {
                near_free = near_free || covered->validity[around[i]] >= LMB_PROBES_MIN_VALIDITY;
            }
        }
        if (near_free && lmb_placement_is_free(places->level->tracer, at, &rays)) {
            *position = at;
            return true;
        }
    }
    return false;
}

static void place_site(const void *context, size_t element, lmb_gather_site *site)
{
    const level_places *places = context;
    site->point[0] = (lmb_gather_point){.position = places->place[element].position};
    site->count = 1;
}

static lmb_result truth_gather(level_places *places)
{
    const lmb_gather_list list = {
        .name = "truth", .count = places->count, .most_points = 1, .find_site = place_site, .context = places};
    const lmb_gather_effort effort = {.samples = places->truth_samples};
    lmb_transport transport = places->level->transport;
    transport.seed += 1000000;
    const lmb_gather_job job = lmb_gather_job_all(&transport, &list, &effort);
    lmb_gathered *const gathered = malloc((places->count + (size_t)1) * sizeof *gathered);
    lmb_gather_stats stats;
    const lmb_result result =
        gathered ? lmb_gather_elements(&job, places->level->pool, NULL, gathered, &stats) : LMB_ERROR_MEMORY;
    double mean = 0.0;
    for (uint32_t i = 0; i < places->count && result == LMB_OK; ++i) {
        place *const to = &places->place[i];
        to->truth = (place_light){.mean = gathered[i].moments, .difference = gathered[i].difference};
        for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
            to->truth.key_visibility[key] = (double)gathered[i].key_visibility[key];
        }
        to->squared_light = light_squared(places, &to->truth.mean, to->truth.key_visibility);
        mean += sqrt(to->squared_light) / places->count;
    }
    places->dark_squared = DARK_SHARE * DARK_SHARE * mean * mean;
    free(gathered);
    return result;
}

static void key_weights_set(level_places *places)
{
    lmb_key_light key[LMB_KEY_LIGHTS_MOST];
    places->key_count = lmb_scene_key_lights(places->level->scene, key);
    for (uint32_t i = 0; i < places->key_count; ++i) {
        for (int c = 0; c < 3; ++c) {
            const double normalised = (double)key[i].irradiance.c[c] / PI;
            places->key_weight[i] += normalised * normalised / 6.0;
        }
    }
}

lmb_result places_make(level_places *places, double spacing, lmb_error *error)
{
    lmb_bake bake = lmb_bake_begin(&places->settings, places->level, NULL);
    bake.record.settings.min_spacing = 0.0f;
    bake.record.settings.spacing = (float)spacing;
    lmb_result result = lmb_bake_surface(&bake, error);
    key_weights_set(places);
    if (result == LMB_OK) {
        result = lmb_bake_place(&bake, error);
    }
    places->place = calloc(places->wanted + (size_t)1, sizeof *places->place);
    places->count = 0;
    for (uint32_t i = 0; i < places->wanted && result == LMB_OK && places->place; ++i) {
        places->count += place_find(places, bake.probes, i, &places->place[places->count].position);
    }
    lmb_bake_end(&bake);
    if (result == LMB_OK) {
        result = places->place ? truth_gather(places) : LMB_ERROR_MEMORY;
    }
    return result;
}

/* ------------------------------------------------------------------------------------------------ errors */

static bool place_sample(const lmb_probes *probes, const lmb_scene *scene, const place *at, place_light *light)
{
    const lmb_vec3d world = lmb_scene_to_world(scene, at->position);
    lmb_probe_cell cell;
    if (!lmb_probes_cell(probes, world, &cell)) {
        return false;
    }
    const double *const t = cell.fraction;
    *light =
        (place_light){.mean = lmb_probes_light(probes, 0, world), .difference = lmb_probes_light(probes, 1, world)};
    for (int i = 0; i < 8; ++i) {
        const double weight = (i & 1 ? t[0] : 1.0 - t[0]) * (i & 2 ? t[1] : 1.0 - t[1]) * (i & 4 ? t[2] : 1.0 - t[2]);
        for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
            const double own = (double)probes->key_visibility[cell.probe[i]][key];
            const double other = (double)probes->key_visibility[cell.other[i]][key];
            light->key_visibility[key] += weight * (own + cell.share * (other - own));
        }
    }
    return true;
}

static double error_squared(const level_places *places, const place_light *light, const place_light *truth)
{
    static const double no_key[LMB_KEY_LIGHTS_MOST] = {0.0};
    double keys[LMB_KEY_LIGHTS_MOST];
    for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
        keys[key] = light->key_visibility[key] - truth->key_visibility[key];
    }
    const lmb_sh3_rgb off = light_less(&light->mean, &truth->mean);
    const lmb_sh3_rgb noise = light_less(&light->difference, &truth->difference);
    return light_squared(places, &off, keys) - light_squared(places, &noise, no_key);
}

bool place_error(const level_places *places, const lmb_probes *probes, const place *at, double *squared, double *share)
{
    place_light light;
    if (!place_sample(probes, places->level->scene, at, &light)) {
        return false;
    }
    *squared = error_squared(places, &light, &at->truth);
    *share = *squared / fmax(at->squared_light, places->dark_squared);
    return true;
}

/* ------------------------------------------------------------------------------------------------- bakes */

lmb_result places_gather(lmb_bake *bake)
{
    lmb_probe_list list;
    lmb_result result = lmb_probe_list_create(bake->probes, bake->regions, bake->level->tracer, &list);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_gather_effort effort = lmb_bake_effort(&bake->record.settings, bake->level);
    const lmb_gather_list all = lmb_probe_list_elements(&list);
    const lmb_gather_job job = lmb_gather_job_all(&bake->level->transport, &all, &effort);
    lmb_gathered *const gathered = malloc((list.count + 1) * sizeof *gathered);
    result = gathered ? lmb_gather_elements(&job, bake->level->pool, NULL, gathered, &bake->record.gathered)
                      : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = lmb_probe_list_finish(&list, gathered, bake->level->pool, bake->probes);
    }
    if (result == LMB_OK) {
        result = lmb_probes_add_set(bake->probes, &list.set);
    }
    if (result == LMB_OK) {
        for (size_t i = 0; i < list.count; ++i) {
            gathered[i].moments = gathered[i].difference;
        }
        result = lmb_probe_list_finish(&list, gathered, bake->level->pool, bake->probes);
    }
    free(gathered);
    lmb_probe_list_free(&list);
    return result;
}

lmb_result places_bake(const level_places *places, const lmb_bake_settings *settings, lmb_bake *bake, lmb_error *error)
{
    *bake = lmb_bake_begin(settings, places->level, NULL);
    lmb_result result = lmb_bake_place(bake, error);
    if (result == LMB_OK) {
        result = lmb_bake_levels(bake, error);
    }
    return result == LMB_OK ? places_gather(bake) : result;
}
