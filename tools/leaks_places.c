#include <stdlib.h>

#include <lambent/gather_elements.h>
#include <lambent/opaque_surface.h>
#include <lambent/placement.h>
#include <lambent/sequence.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

#include "leaks_measure.h"

enum { LINES = 64, TRIES_PER_POINT = 1 << 8 };

/* Points anywhere, for each at a distance. */
enum { ANYWHERE = 4 };

/* Behind a surface that divides, a foreign room is nearer than this. */
#define DIVIDES_M 0.6f

static const float distance_m[LEAKS_KINDS] = {0.01f, 0.1f, 0.0f};

static int home_at(const lmb_leak_scene *scene, lmb_vec3 at)
{
    lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
    lmb_leak_scene_rooms(scene, room);
    const int found = lmb_leak_scene_room_at(scene, at);
    return found >= 0 ? room[found].home : -1;
}

static bool is_free(const leaks_level *level, lmb_vec3 at)
{
    uint64_t rays = 0;
    return lmb_placement_is_free(level->level.tracer, at, &rays);
}

/* Whether a foreign room lies behind a surface. What divides may stand within a room (a house, a column). */
static bool divides(const leaks_level *level, lmb_vec3 surface, lmb_vec3 normal, int home)
{
    for (float depth = 0.0015f; depth < DIVIDES_M; depth += depth < 0.02f ? 0.001f : 0.02f) {
        const int behind = home_at(level->scene, lmb_vec3_mad(surface, normal, -depth));
        if (behind >= 0 && behind != home) {
            return true;
        }
    }
    return false;
}

static void find_beside_surfaces(const leaks_level *level, const lmb_opaque_surface *surface, leaks_kind kind,
                                 uint32_t points, leaks_places *places)
{
    const uint32_t tries = points * TRIES_PER_POINT;
    uint32_t found = 0;
    for (uint32_t i = 0; i < tries && found < points; ++i) {
        /* Strides through the strata, so that the first that are found lie everywhere. */
        const lmb_hit hit =
            lmb_opaque_surface_point(surface, (uint64_t)kind, (uint32_t)(UINT64_C(4057) * i % tries), tries);
        const lmb_place place = lmb_trace_place(level->level.tracer, &hit);
        const lmb_vec3 at = lmb_vec3_mad(place.position, place.geometric_normal, distance_m[kind]);
        const int home = home_at(level->scene, at);
        if (home >= 0 && divides(level, place.position, place.geometric_normal, home) &&
            leaks_sees(level->level.tracer, lmb_vec3_mad(place.position, place.geometric_normal, 1e-4f), at) &&
            is_free(level, at)) {
            places->point[places->point_count++] =
                (leaks_point){.position = at, .normal = place.geometric_normal, .kind = kind, .home = home};
            ++found;
        }
    }
}

/* The `index`-th random point of the level's bounds, if it is free space of a room. */
static bool room_point(const leaks_level *level, uint32_t index, lmb_vec3 *at, int *home)
{
    const lmb_scene *scene = level->level.scene;
    float across[2], height[2];
    lmb_sequence_2d(1, index, 0, across);
    lmb_sequence_2d(1, index, 1, height);
    const lmb_vec3 size = lmb_vec3_sub(scene->bounds_max, scene->bounds_min);
    *at = lmb_vec3_add(scene->bounds_min, lmb_vec3_of(across[0] * size.x, height[0] * size.y, across[1] * size.z));
    *home = home_at(level->scene, *at);
    return *home >= 0 && is_free(level, *at);
}

static void find_anywhere(const leaks_level *level, uint32_t points, leaks_places *places)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < points * TRIES_PER_POINT && found < points; ++i) {
        leaks_point point = {.kind = LEAKS_ANYWHERE};
        if (room_point(level, i, &point.position, &point.home)) {
            places->point[places->point_count++] = point;
            ++found;
        }
    }
}

/* Lines between points of one home that see each other: in a sealed level they are in one room. */
static void find_lines(const leaks_level *level, leaks_places *places)
{
    const leaks_point *last = NULL;
    for (size_t i = 0; i < places->point_count && places->line_count < LINES; ++i) {
        const leaks_point *next = &places->point[i];
        if (next->kind != LEAKS_ANYWHERE) {
            continue;
        }
        if (last && last->home == next->home && leaks_sees(level->level.tracer, last->position, next->position)) {
            places->line[places->line_count++] =
                (leaks_line){.from = last->position, .to = next->position, .home = last->home};
        }
        last = next;
    }
}

static void point_site(const void *context, size_t element, lmb_gather_site *site)
{
    const leaks_places *places = context;
    site->point[0] = (lmb_gather_point){.position = places->point[element].position};
    site->count = 1;
}

static lmb_result find_truth(const leaks_level *level, uint32_t samples, leaks_places *places)
{
    lmb_gathered *const gathered = malloc((places->point_count + 1) * sizeof *gathered);
    if (!gathered) {
        return LMB_ERROR_MEMORY;
    }
    lmb_transport transport = level->level.transport;
    transport.seed += 1; /* not the probes' noise */
    const lmb_gather_list list = {
        .name = "truth", .count = places->point_count, .most_points = 1, .find_site = point_site, .context = places};
    const lmb_gather_effort effort = {.samples = samples};
    const lmb_gather_job job = lmb_gather_job_all(&transport, &list, &effort);
    lmb_gather_stats stats = {0};
    const lmb_result result = lmb_gather_elements(&job, level->level.pool, NULL, gathered, &stats);
    for (size_t i = 0; i < places->point_count && result == LMB_OK; ++i) {
        places->point[i].truth = gathered[i].moments;
    }
    free(gathered);
    return result;
}

void leaks_home_means(leaks_places *places)
{
    for (int home = 0; home < 2; ++home) {
        double sum = 0.0, count = 0.0;
        for (size_t i = 0; i < places->point_count; ++i) {
            const leaks_point *point = &places->point[i];
            if (point->kind == LEAKS_ANYWHERE && point->home == home) {
                sum += (double)point->truth.channel[home].c[0];
                count += 1.0;
            }
        }
        places->home_mean[home] = count > 0.0 ? sum / count : 0.0;
    }
}

lmb_result leaks_places_make(const leaks_level *level, uint32_t points, uint32_t samples, leaks_places *places)
{
    *places = (leaks_places){.point = malloc((2 + ANYWHERE) * (size_t)points * sizeof *places->point),
                             .line = malloc(LINES * sizeof *places->line),
                             .open = level->scene->open};
    lmb_opaque_surface surface = {.tracer = NULL};
    lmb_result result =
        places->point && places->line ? lmb_opaque_surface_create(level->level.tracer, &surface) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        find_beside_surfaces(level, &surface, LEAKS_1_CM, points, places);
        find_beside_surfaces(level, &surface, LEAKS_10_CM, points, places);
        find_anywhere(level, ANYWHERE * points, places);
        find_lines(level, places);
        lmb_opaque_surface_free(&surface);
        result = find_truth(level, samples, places);
    }
    if (result != LMB_OK) {
        leaks_places_free(places);
        return result;
    }
    leaks_home_means(places);
    return LMB_OK;
}

void leaks_places_free(leaks_places *places)
{
    free(places->point);
    free(places->line);
    *places = (leaks_places){.point = NULL};
}
