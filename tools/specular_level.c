/* What layers of specular reflection get right of a baked level:
 *
 *     lambent_specular_level LEVEL DIR [--maps FOLDER] [--model NAME] [--points N] [--samples N]
 *
 * Of surfaces that are seen from random points of the volume's free space in random directions: what the layers reflect
 * of the bake's light, beside the path tracer's (glossy.h), as materials say, and by one roughness everywhere. Errors
 * of radiance, all colours: relative root mean square, free of the reference's own noise, and the points' own, as
 * `lambent check` has them. One line for each, tabs between. */
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/baked.h>
#include <lambent/sequence.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

#include "bake_arguments.h"
#include "check_points.h"
#include "check_statistics.h"
#include "shade_specular.h"

static const char usage[] = "usage: lambent_specular_level LEVEL DIR [options]\n"
                            "\n"
                            "  --maps FOLDER    what `lambent cube` wrote of that bake\n"
                            "  --model NAME     the lightmaps' model whose harmonics reflect (bake --models)\n"
                            "  --points N       default 2000\n"
                            "  --samples N      of each half of the reference, at each point (default 256)\n"
                            "  --threads N      default: all processors\n";

enum { STREAM_POINTS = 1, STREAM_HALF };

/* 0: as materials say. */
static const float slopes[] = {0.0f, 0.05f, 0.1f, 0.2f, 0.4f, 0.7f};
enum { SLOPES = sizeof slopes / sizeof slopes[0] };

static const char *const layer_name[LAYERS_COUNT] = {
    "none", "analytic", "analytic + area", "lampless", "dominant", "analytic + map", "all"};

/* Whose harmonics the layers have. */
enum { BY_PROBES, BY_TEXELS, SOURCES };
static const char *const source_name[SOURCES] = {"probes", "lightmap"};

typedef struct level_options {
    lmb_shared_arguments shared;
    const char *maps;
    const lmb_model *model;
    uint32_t points, samples;
} level_options;

typedef struct measured {
    const lmb_baked *baked;
    const environment_maps *maps; /* NULL: none */
    uint32_t points, samples;
    float slope;                               /* of this round; 0: as materials say */
    point_error *error[SOURCES][LAYERS_COUNT]; /* [point] */
    bool *has[SOURCES];
} measured;

/* Tries of a point to find an opaque surface. */
enum { TRIES = 64 };

/* What is seen from somewhere in free space. @return false where it is no opaque surface's front */
static bool hit_find(const measured *work, uint64_t stream, lmb_hit *hit, lmb_vec3 *view)
{
    const lmb_tracer *tracer = work->baked->level.tracer;
    lmb_vec3 eye, direction;
    if (!free_point(tracer, work->baked->volume, true, stream, &eye)) {
        return false;
    }
    sphere_directions(stream, 1, &direction);
    if (!lmb_trace_nearest(tracer, eye, direction, 0.0f, FLT_MAX, hit) || !hit->front) {
        return false;
    }
    const lmb_mesh_point point = lmb_trace_mesh_point(tracer, hit);
    *view = lmb_vec3_scale(direction, -1.0f);
    return lmb_material_is_opaque(lmb_material_at(&point)) && !lmb_material_at(&point)->unlit;
}

static void place_make(const measured *work, const lmb_hit *hit, lmb_vec3 view, specular_place *place)
{
    const lmb_tracer *tracer = work->baked->level.tracer;
    const lmb_lightmap *lightmap = work->baked->lightmap;
    const lmb_place at = lmb_trace_place(tracer, hit);
    const lmb_mesh_point point = lmb_trace_mesh_point(tracer, hit);
    const lmb_reflection reflection = lmb_material_reflection(&point);
    const bool mapped = lightmap && lightmap->region[hit->instance].image >= 0;
    bool pushed_out;
    place->point =
        lmb_surface_gather_point(tracer, &at, mapped ? lightmap->region[hit->instance].texel_size : 0.1f, &pushed_out);
    place->normal = lmb_trace_mapped_normal(tracer, hit, &at);
    place->view = view;
    place->specular = (lmb_specular){reflection.slope, reflection.f0};
    if (work->slope > 0.0f) {
        place->specular = (lmb_specular){work->slope, {{0.04f, 0.04f, 0.04f}}};
    }
}

static void point_task(void *context, size_t task, int worker)
{
    (void)worker;
    measured *work = context;
    const lmb_baked *baked = work->baked;
    const uint32_t index = (uint32_t)task;
    lmb_hit hit;
    specular_place place;
    work->has[BY_PROBES][index] = work->has[BY_TEXELS][index] = false;
    lmb_vec3 view;
    bool found = false;
    for (uint64_t i = 0; i < TRIES && !found; ++i) {
        found = hit_find(work, lmb_mix(lmb_mix(STREAM_POINTS, index), i), &hit, &view);
    }
    if (!found) {
        return;
    }
    place_make(work, &hit, view, &place);
    lmb_rgb half[2];
    for (uint64_t i = 0; i < 2; ++i) {
        half[i] = glossy_radiance(&baked->level.transport, &place, work->samples, STREAM_HALF + i);
    }
    map_here map;
    if (work->maps) {
        map = environment_maps_find(work->maps, baked->level.tracer, place.point.position);
    }
    const lmb_lightmap *lightmap = baked->lightmap;
    specular_light_here light[SOURCES];
    const lmb_transport *transport = &baked->level.transport;
    light[BY_PROBES] = specular_light_of_volume(transport, baked->volume, &place.point);
    work->has[BY_PROBES][index] = true;
    if (lightmap && lightmap->model->radiance && lightmap->region[hit.instance].image >= 0) {
        light[BY_TEXELS] = specular_light_of_lightmap(transport, baked->volume, lightmap, &hit, &place.point);
        work->has[BY_TEXELS][index] = true;
    }
    for (int source = 0; source < SOURCES; ++source) {
        for (int layers = 0; layers < LAYERS_COUNT && work->has[source][index]; ++layers) {
            const lmb_rgb reflected =
                specular_reflected((specular_layers)layers, &light[source], &place, work->maps ? &map : NULL);
            work->error[source][layers][index] = point_error_of(&reflected, &half[0], &half[1], 1);
        }
    }
}

static void round_print(const measured *work)
{
    for (int source = 0; source < SOURCES; ++source) {
        for (int layers = 0; layers < LAYERS_COUNT; ++layers) {
            error_summary summary;
            if (error_summarize(work->error[source][layers], work->has[source], work->points, &summary) != LMB_OK ||
                isnan(summary.rel_rmse)) {
                continue;
            }
            if (work->slope > 0.0f) {
                printf("%g", (double)work->slope);
            } else {
                printf("materials");
            }
            printf("\t%s\t%s\t%.3f\t%.3f\t%.3f\t%.3f\n", source_name[source], layer_name[layers], summary.rel_rmse,
                   summary.median, summary.p95, summary.share_over_10pct);
        }
    }
    fflush(stdout);
}

static bool work_allocate(measured *work)
{
    bool all = true;
    for (int source = 0; source < SOURCES; ++source) {
        work->has[source] = calloc(work->points, sizeof *work->has[source]);
        all = all && work->has[source];
        for (int layers = 0; layers < LAYERS_COUNT; ++layers) {
            work->error[source][layers] = calloc(work->points, sizeof *work->error[source][layers]);
            all = all && work->error[source][layers];
        }
    }
    return all;
}

static void work_free(measured *work)
{
    for (int source = 0; source < SOURCES; ++source) {
        free(work->has[source]);
        for (int layers = 0; layers < LAYERS_COUNT; ++layers) {
            free(work->error[source][layers]);
        }
    }
}

static lmb_result measure(const level_options *options, const lmb_baked *baked, const environment_maps *maps)
{
    measured work = {.baked = baked, .maps = maps, .points = options->points, .samples = options->samples};
    lmb_result result = work_allocate(&work) ? LMB_OK : LMB_ERROR_MEMORY;
    printf("slopes\tharmonics of\tlayers\trel_rmse\tmedian\tp95\tshare_over_10pct\n");
    for (int i = 0; i < SLOPES && result == LMB_OK; ++i) {
        work.slope = slopes[i];
        result = lmb_pool_run(baked->level.pool, work.points, point_task, &work, "points", NULL);
        if (result == LMB_OK) {
            round_print(&work);
        }
    }
    work_free(&work);
    return result;
}

static bool options_read(lmb_arguments *arguments, level_options *options)
{
    for (const char *next; (next = arguments_next(arguments));) {
        if (strcmp(next, "--maps") == 0) {
            options->maps = arguments_text(arguments, next);
        } else if (strcmp(next, "--model") == 0) {
            options->model = lightmap_model_argument(arguments, next);
        } else if (strcmp(next, "--points") == 0) {
            options->points = (uint32_t)arguments_integer(arguments, next, 1, 1000000);
        } else if (strcmp(next, "--samples") == 0) {
            options->samples = (uint32_t)arguments_integer(arguments, next, 1, 1 << 20);
        } else {
            arguments_shared(arguments, next, &options->shared);
        }
    }
    return arguments_complete(arguments, &options->shared);
}

int main(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "specular_level", usage);
    level_options options = {
        .shared = {.path_name = {"LEVEL", "DIR"}, .takes = ARGUMENTS_THREADS}, .points = 2000, .samples = 256};
    if (!options_read(&arguments, &options)) {
        return arguments_status(&arguments);
    }
    const lmb_baked_view view = {NULL, true};
    const char *const folder = options.shared.path[1];
    lmb_error error = {""};
    lmb_baked baked;
    environment_maps maps = {NULL, 0};
    lmb_result result = lmb_baked_open(options.shared.path[0], folder, options.shared.threads, &view, &baked, &error);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    result = lmb_baked_need_probes(&baked, folder, &error);
    if (result == LMB_OK && options.model) {
        result = lmb_baked_read_model(&baked, folder, options.model, &error);
    }
    if (result == LMB_OK && options.maps) {
        result = environment_maps_read(options.maps, &maps, &error);
    }
    if (result == LMB_OK) {
        result = measure(&options, &baked, options.maps ? &maps : NULL);
        lmb_error_set(&error, result, "specular_level: %s", lmb_result_text(result));
    }
    environment_maps_free(&maps);
    lmb_baked_close(&baked);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
