/* Error against samples and against time of both estimators, what each ingredient of the cached one is worth, and the
 * cache's bias against its resolution:
 *
 *     convergence LEVEL [level options] [--points N] [--truth N]
 *
 * Probes and texels are taken evenly from the level's own, traced on one thread, and timed by its CPU time. One line
 * for each measurement, tabs between: kind, estimator, cells of the cache, samples, CPU seconds (the solve apart),
 * relative RMSE of the SH3 moments over all points. The estimator is `reference`, `cached`, `cached without` an
 * ingredient, in the solve too, or `cells`: `cached` with caches of several sizes. The truth is the reference's, by
 * many more samples; its own standard error is printed first. tools/plot_convergence draws it. */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/lightmap.h>
#include <lambent/placement.h>
#include <lambent/gather_sh3.h>
#include <lambent/sequence.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

#include "command.h"
#include "cpu_time.h"
#include "level_arguments.h"
#include "light/emitters_internal.h"

static const char usage[] =
    "usage: convergence LEVEL [options]\n"
    "\n"
    "  --points N            probes, and as many texels (default 64)\n"
    "  --truth N             samples of the truth (default 65536)\n"
    "  --spacing M           metres between the lattice points that probes are taken from\n" LEVEL_USAGE;

enum { MOST_POINTS = 4096, KINDS = 2, MOST_SAMPLES = 16384 };
static const char *const kind_names[KINDS] = {"probes", "texels"};

typedef struct point_set {
    lmb_gather_point point[MOST_POINTS];
    lmb_gathered truth[MOST_POINTS];
    int count;
} point_set;

/* An estimator, and what it goes without. */
typedef struct variant {
    const char *name;
    bool reference;
    unsigned without; /* light/ablation.h */
    bool near_hits_looked_up;
} variant;

static const variant variants[] = {
    {.name = "reference", .reference = true},
    {.name = "cached"},
    {.name = "cached without Sobol", .without = LMB_WITHOUT_SEQUENCE},
    {.name = "cached without aimed sky", .without = LMB_WITHOUT_ENVIRONMENT_AIM},
    {.name = "cached without aimed triangles", .without = LMB_WITHOUT_TRIANGLE_AIM},
    {.name = "cached without light tree", .without = LMB_WITHOUT_TRIANGLE_TREE},
    {.name = "cached without aimed cells", .without = LMB_WITHOUT_CELL_AIM},
    {.name = "cached without near hits", .near_hits_looked_up = true},
};

typedef struct convergence {
    lmb_level level;
    point_set *set[KINDS];
    int points;
    uint32_t truth_samples;
    float spacing;
} convergence;

static lmb_result probes_take(convergence *work, lmb_error *error)
{
    lmb_probes *probes = NULL;
    lmb_placement_settings settings = lmb_placement_settings_default();
    settings.spacing = work->spacing;
    lmb_placement_stats stats;
    const lmb_result result =
        lmb_placement_make(work->level.tracer, &settings, work->level.pool, &probes, &stats, error);
    if (result != LMB_OK) {
        return result;
    }
    point_set *set = work->set[0];
    const int32_t valid = stats.probes_valid;
    int32_t passed = 0;
    for (int32_t i = 0; i < probes->count; ++i) {
        if (probes->validity[i] < LMB_PROBES_MIN_VALIDITY) {
            continue;
        }
        if (set->count < work->points && (int64_t)passed * work->points >= (int64_t)set->count * valid) {
            uint64_t rays = 0;
            set->point[set->count++] = (lmb_gather_point){
                .position = lmb_placement_relocate(work->level.tracer, lmb_probes_position(probes, i),
                                                   probes->level[0].lattice.spacing, &rays),
                .min_light_distance = 0.5f * probes->level[0].lattice.spacing};
        }
        ++passed;
    }
    lmb_probes_destroy(probes);
    return LMB_OK;
}

static double level_area(const lmb_level *level)
{
    double area = 0.0;
    for (uint32_t i = 0; i < level->scene->instance_count; ++i) {
        const lmb_instance *instance = &level->scene->instances[i];
        for (uint32_t t = 0; t < level->scene->meshes[instance->mesh].triangle_count && !instance->dynamic; ++t) {
            area += (double)lmb_trace_triangle_area(level->tracer, i, t);
        }
    }
    return area;
}

/* A point on the front of a triangle, by the index of the point. */
static lmb_gather_point texel_point(const lmb_level *level, uint32_t instance, uint32_t triangle, uint32_t index)
{
    float u[2];
    lmb_sequence_2d(level->settings.seed, index, 0, u);
    lmb_hit hit = {.instance = instance, .triangle = triangle};
    lmb_triangle_point(u, &hit.u, &hit.v);
    const lmb_place place = lmb_trace_place(level->tracer, &hit);
    bool pushed_out;
    return lmb_surface_gather_point(level->tracer, &place, 0.0f, &pushed_out);
}

/* Points on triangles, evenly by area. */
static void texels_take(convergence *work)
{
    const lmb_scene *scene = work->level.scene;
    const double total = level_area(&work->level);
    point_set *set = work->set[1];
    double passed = 0.0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const uint32_t count = scene->meshes[scene->instances[i].mesh].triangle_count;
        for (uint32_t t = 0; t < count && !scene->instances[i].dynamic; ++t) {
            passed += (double)lmb_trace_triangle_area(work->level.tracer, i, t);
            for (; set->count < work->points && passed * work->points > (set->count + 0.5) * total; ++set->count) {
                set->point[set->count] = texel_point(&work->level, i, t, (uint32_t)set->count);
            }
        }
    }
}

typedef struct truth_work {
    convergence *work;
    int kind;
} truth_work;

static void truth_task(void *context, size_t task, int worker)
{
    (void)worker;
    const truth_work *truth = context;
    point_set *set = truth->work->set[truth->kind];
    lmb_transport reference = truth->work->level.transport;
    reference.surface = NULL;
    reference.seed += 1;
    lmb_gather_sh3(&reference, &set->point[task], truth->work->truth_samples, &set->truth[task]);
}

/* Error and CPU seconds of both kinds of points. */
static void measure(const convergence *work, const lmb_transport *transport, const char *name, uint32_t cells,
                    uint32_t samples)
{
    for (int kind = 0; kind < KINDS; ++kind) {
        const point_set *set = work->set[kind];
        double off = 0.0;
        double all = 0.0;
        const double start = cpu_time_of_thread();
        for (int i = 0; i < set->count; ++i) {
            lmb_gathered found;
            lmb_gather_sh3(transport, &set->point[i], samples, &found);
            for (int c = 0; c < 3; ++c) {
                for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                    const double truth = (double)set->truth[i].moments.channel[c].c[k];
                    off += pow((double)found.moments.channel[c].c[k] - truth, 2.0);
                    all += truth * truth;
                }
            }
        }
        printf("%s\t%s\t%u\t%u\t%.6f\t%.6f\n", kind_names[kind], name, cells, samples, cpu_time_of_thread() - start,
               sqrt(off / all));
        fflush(stdout);
    }
}

/* Measures with `samples` and four times as many again and again. `max_cells` 0: the default. */
static lmb_result variant_measure(const convergence *work, const variant *with, uint32_t max_cells, uint32_t samples,
                                  const char *name, lmb_error *error)
{
    const lmb_level *level = &work->level;
    lmb_emitters *emitters = NULL;
    lmb_surface_light *surface = NULL;
    lmb_surface_light_stats stats = {0};
    lmb_transport transport = level->transport;
    lmb_result result = lmb_emitters_create_without(level->tracer, with->without, &emitters);
    transport.emitters = emitters;
    if (result == LMB_OK && !with->reference) {
        lmb_surface_light_settings settings = lmb_surface_light_settings_default();
        settings.max_cells = max_cells ? max_cells : settings.max_cells;
        result = lmb_surface_light_solve(&transport, &settings, level->pool, &surface, &stats, error);
        transport.surface = surface;
    }
    if (with->near_hits_looked_up) {
        transport.bounces = INT_MAX; /* where reflections are counted, near hits are not traced on */
    }
    for (; samples <= MOST_SAMPLES && result == LMB_OK; samples *= 4) {
        measure(work, &transport, name, stats.cells, samples);
    }
    lmb_surface_light_destroy(surface);
    lmb_emitters_destroy(emitters);
    return result;
}

/* Whether there is anything in the level that the variant goes without. */
static bool variant_differs(const convergence *work, const variant *with)
{
    const uint32_t triangles = lmb_emitters_triangle_count(work->level.emitters);
    return (with->without != LMB_WITHOUT_ENVIRONMENT_AIM || lmb_emitters_environment_sampled(work->level.emitters)) &&
           (with->without != LMB_WITHOUT_TRIANGLE_AIM || triangles > 0) &&
           (with->without != LMB_WITHOUT_TRIANGLE_TREE || triangles > 1) &&
           (!with->near_hits_looked_up || work->level.transport.bounces < 0);
}

static void truth_print(const convergence *work, int kind)
{
    double squared_error = 0.0;
    double squared_length = 0.0;
    for (int i = 0; i < work->set[kind]->count; ++i) {
        squared_error += work->set[kind]->truth[i].squared_error;
        squared_length += work->set[kind]->truth[i].squared_length;
    }
    printf("# %d %s, standard error of the truth %.5f\n", work->set[kind]->count, kind_names[kind],
           lmb_relative_error(squared_error, squared_length));
}

static lmb_result convergence_run(convergence *work, lmb_error *error)
{
    lmb_result result = probes_take(work, error);
    texels_take(work);
    for (int kind = 0; kind < KINDS && result == LMB_OK; ++kind) {
        truth_work truth = {work, kind};
        result = lmb_pool_run(work->level.pool, (size_t)work->set[kind]->count, truth_task, &truth, "truth", NULL);
        truth_print(work, kind);
    }
    for (size_t i = 0; i < sizeof variants / sizeof variants[0] && result == LMB_OK; ++i) {
        if (variant_differs(work, &variants[i])) {
            result = variant_measure(work, &variants[i], 0, 16, variants[i].name, error);
        }
    }
    for (uint32_t cells = 2048; cells <= 524288 && result == LMB_OK; cells *= 4) {
        result = variant_measure(work, &(variant){0}, cells, MOST_SAMPLES, "cells", error);
    }
    return result;
}

int main(int count, char **values)
{
    static convergence work = {.points = 64, .truth_samples = 65536};
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "convergence", usage);
    lmb_level_settings level = lmb_level_settings_default();
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (level_argument(&level, &arguments, argument)) {
            continue;
        }
        if (strcmp(argument, "--points") == 0) {
            work.points = (int)arguments_integer(&arguments, argument, 1, MOST_POINTS);
        } else if (strcmp(argument, "--truth") == 0) {
            work.truth_samples = (uint32_t)arguments_integer(&arguments, argument, 1, 1 << 28);
        } else if (strcmp(argument, "--spacing") == 0) {
            work.spacing = (float)arguments_number(&arguments, argument, 1e-6, 1e6);
        } else if (argument[0] != '-' && !level.path) {
            level.path = argument;
        } else {
            arguments_error(&arguments, "unexpected argument", argument);
        }
    }
    if (arguments.failed || arguments.help || !level.path) {
        fputs(usage, stderr);
        return 2;
    }
    lmb_error error = {{0}};
    const lmb_warnings warnings = console_warnings(arguments.quiet);
    lmb_result result = lmb_level_open(&level, &warnings, NULL, &work.level, &error);
    for (int kind = 0; kind < KINDS && result == LMB_OK; ++kind) {
        work.set[kind] = calloc(1, sizeof *work.set[kind]);
        result = work.set[kind] ? LMB_OK : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        result = convergence_run(&work, &error);
        lmb_level_close(&work.level);
    }
    free(work.set[0]);
    free(work.set[1]);
    return result == LMB_OK ? 0 : command_fail(result, &error);
}
