/* Objects lit by a level's volume, by a few probes taken from it, and by probes that were baked for them:
 *
 *     lambent_local_sets LEVEL [bake options] [--node PATTERN]... [--points N] [--truth N] [--places N] [--each]
 *
 * bakes a volume with the options, once with the objects where they stand and once without them, and compares light at
 * points on each object with the path tracer's there, the object being in its place:
 *
 *     standing    the bake has it
 *     there       the bake has it not, and it is where it stands in the level
 *     moved       the bake has it not, and it is elsewhere, turned
 *
 * each by
 *
 *     volume      the volume at every point
 *     middle      the volume at the object's middle
 *     resampled   lmb_local_set_resample in the object's frame
 *     local set   the one that was baked for it: not once it has moved
 *
 * One line for each, tabs between: points that have light, and of irradiance there, by the default model of surfaces,
 * relative RMSE, median, 95th percentile and the share beyond a tenth; points in the dark, and the leak there: all as
 * `lambent check` defines them. Points that nobody sees, because they are in solids or because something touches the
 * object there, are left out. --each has lines for each object too. Then nanoseconds: of filling a set, for a probe and
 * for all of one, and of a sample from a set and from the volume. Its table is in docs/sampling.md. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/bake_phases.h>
#include <lambent/lightmap.h>
#include <lambent/pack.h>
#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "bake_arguments.h"
#include "check_points.h"
#include "check_reference.h"
#include "check_statistics.h"
#include "local_sets_objects.h"
#include "probe_light.h"

static const char usage[] =
    "usage: lambent_local_sets LEVEL [options]\n"
    "\n"
    "  --node PATTERN        nodes that are objects, beside those that the level marks (repeatable)\n"
    "  --points N            on each (default 64)\n"
    "  --truth N             samples of each half of the truth (default 256)\n"
    "  --places N            that each is moved to (default 2)\n"
    "  --each                a line for each object too\n" BAKE_USAGE LEVEL_USAGE;

enum { MOST_OBJECTS = 256, MOST_PATTERNS = 16, MOST_PLACES = 16 };
enum { STANDING, THERE, MOVED, KINDS };
enum { BY_VOLUME, BY_MIDDLE, RESAMPLED, BY_SET, SOURCES };
static const char *const kind_names[KINDS] = {"standing", "there", "moved"};
static const char *const source_names[SOURCES] = {"volume", "middle", "resampled", "local set"};

/* Points are hidden by what is so near, in longest steps of an object's frame. */
#define HIDDEN_STEPS 0.02f

/* Streams of variates. */
enum { STREAM_POSE = 1, STREAM_POINTS, STREAM_NORMALS };

typedef struct objects_work {
    lmb_bake_settings settings;
    const char *pattern[MOST_PATTERNS];
    uint32_t pattern_count, points, truth, places;
    bool each;
    lmb_level level;
    uint32_t count; /* of objects */
    uint32_t instance[MOST_OBJECTS];
    lmb_local_frame frame[MOST_OBJECTS];
    bool has_pose[MOST_OBJECTS][MOST_PLACES];
    object_pose pose[MOST_OBJECTS][MOST_PLACES];
    unsigned char *packed;
    lmb_volume *volume;
    size_t most; /* points of all */
    point_error *error[KINDS][SOURCES];
    point_light *light[KINDS][SOURCES];
    bool *shown[KINDS]; /* [point] whether it was measured */
    bool *lit;          /* room for a choice of them */
} objects_work;

/* ---------------------------------------------------------------------------------------- one object's points */

/* Probes of a set, read. */
typedef struct set_light {
    bool known;
    lmb_local_frame frame;
    lmb_sh3_rgb radiance[LMB_LOCAL_SET_MOST];
    float visibility[LMB_LOCAL_SET_MOST][LMB_KEY_LIGHTS_MOST];
} set_light;

typedef struct object_work {
    objects_work *all;
    int kind;
    uint32_t object;
    size_t first; /* of its points */
    float radius, reach;
    lmb_transport transport;
    lmb_opaque_surface surface;
    probe_light middle;
    set_light resampled, baked;
} object_work;

static void set_evaluate(const set_light *set, const probe_light *like, lmb_vec3d position, probe_light *light)
{
    *light = *like;
    lmb_local_set_sample_with_keys(&set->frame, set->radiance, (const float(*)[LMB_KEY_LIGHTS_MOST])set->visibility,
                                   position, &light->radiance, light->keys.visibility);
}

static void point_record(const object_work *work, size_t index, int source, const probe_light *light,
                         const object_point *point, const lmb_vec3 *normals, const irradiance_set truth[2])
{
    irradiance_set x;
    probe_light_evaluate(LMB_MODEL_FOR_SURFACE, light, point->at.normal, 0.0f, normals, &x);
    work->all->error[work->kind][source][index] = point_error_of(x.at, truth[0].at, truth[1].at, CHECK_NORMALS);
    work->all->light[work->kind][source][index] = point_light_of(x.at, truth[0].at, truth[1].at, CHECK_NORMALS);
}

static void point_task(void *context, size_t task, int worker)
{
    (void)worker;
    const object_work *const work = context;
    objects_work *const all = work->all;
    const uint64_t stream = lmb_mix(STREAM_POINTS, work->first);
    const size_t index = work->first + task;
    object_point point;
    object_point_make(&work->surface, stream, (uint32_t)task, all->points, work->radius, work->reach, &point);
    if (point.hidden) {
        return;
    }
    lmb_vec3 normals[CHECK_NORMALS];
    irradiance_set truth[2];
    shading_normals(point.at.normal, lmb_mix(STREAM_NORMALS, index), CHECK_NORMALS, normals);
    const check_reference reference = {
        .transport = &work->transport, .samples = all->truth, .mean_light = all->level.mean_light};
    check_reference_gather(&reference, &point.at, normals, truth);
    const lmb_vec3d position = lmb_scene_to_world(all->level.scene, point.at.position);
    probe_light light = probe_light_of_volume(all->volume, position);
    point_record(work, index, BY_VOLUME, &light, &point, normals, truth);
    point_record(work, index, BY_MIDDLE, &work->middle, &point, normals, truth);
    set_evaluate(&work->resampled, &work->middle, position, &light);
    point_record(work, index, RESAMPLED, &light, &point, normals, truth);
    if (work->baked.known) {
        set_evaluate(&work->baked, &work->middle, position, &light);
        point_record(work, index, BY_SET, &light, &point, normals, truth);
    }
    all->shown[work->kind][index] = true;
}

static void baked_set_read(const lmb_volume *volume, const lmb_instance *instance, set_light *set)
{
    for (uint32_t i = 0; i < lmb_volume_local_set_count(volume) && !set->known; ++i) {
        const lmb_local_set found = lmb_volume_local_set_get(volume, i);
        if (found.node == instance->node && found.place == instance->place) {
            set->known = true;
            set->frame = found.frame;
            lmb_volume_local_set_light(volume, i, set->radiance, set->visibility);
        }
    }
}

static float longest_step(const lmb_local_frame *frame)
{
    float longest = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        longest = fmaxf(longest, lmb_vec3_length(frame->step[axis]));
    }
    return longest;
}

static lmb_vec3d frame_middle(const lmb_local_frame *frame)
{
    const uint32_t last = lmb_local_frame_count(frame) - 1;
    const lmb_vec3d a = lmb_local_frame_position(frame, 0), b = lmb_local_frame_position(frame, last);
    return (lmb_vec3d){0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z)};
}

/* The object as it is now in the level, its frame with it. */
static lmb_result object_measure(objects_work *all, int kind, uint32_t object, uint32_t place,
                                 const lmb_local_frame *frame)
{
    static object_work work;
    work = (object_work){.all = all, .kind = kind, .object = object, .transport = all->level.transport};
    work.first = ((size_t)object * all->places + place) * all->points;
    work.radius = 1.0f / lmb_lightmap_settings_default(all->level.scene).texels_per_m;
    work.reach = HIDDEN_STEPS * longest_step(frame);
    work.transport.surface = NULL;
    work.middle = probe_light_of_volume(all->volume, frame_middle(frame));
    work.resampled.frame = *frame;
    lmb_local_set_resample(all->volume, frame, work.resampled.radiance, work.resampled.visibility);
    if (kind != MOVED) {
        baked_set_read(all->volume, &all->level.scene->instances[all->instance[object]], &work.baked);
    }
    lmb_result result = lmb_opaque_surface_create_of(all->level.tracer, all->instance[object], &work.surface);
    if (result == LMB_OK && lmb_opaque_surface_area(&work.surface) > 0.0) {
        result = lmb_pool_run(all->level.pool, all->points, point_task, &work, kind_names[kind], NULL);
    }
    lmb_opaque_surface_free(&work.surface);
    return result;
}

/* -------------------------------------------------------------------------------------------------- bakes */

static lmb_result volume_bake(objects_work *work, lmb_error *error)
{
    lmb_bake bake = lmb_bake_begin(&work->settings, &work->level, NULL);
    size_t size = 0;
    lmb_result result = lmb_bake_place(&bake, error);
    result = result == LMB_OK ? lmb_bake_surface(&bake, error) : result;
    result = result == LMB_OK ? lmb_bake_levels(&bake, error) : result;
    result = result == LMB_OK ? lmb_bake_probes(&bake, error) : result;
    if (result == LMB_OK) {
        result = lmb_pack(bake.probes, &work->packed, &size, NULL);
    }
    if (result == LMB_OK) {
        result = lmb_volume_open_memory(work->packed, size, &work->volume);
    }
    lmb_bake_end(&bake);
    return result;
}

static void volume_close(objects_work *work)
{
    lmb_volume_close(work->volume);
    free(work->packed);
    work->volume = NULL;
    work->packed = NULL;
}

static lmb_result standing_measure(objects_work *work, lmb_error *error)
{
    lmb_result result = volume_bake(work, error);
    for (uint32_t i = 0; i < work->count && result == LMB_OK; ++i) {
        result = object_measure(work, STANDING, i, 0, &work->frame[i]);
    }
    return result;
}

/* One object put into the level that has none of them. */
static lmb_result movable_measure(objects_work *work, int kind, uint32_t object, uint32_t place, lmb_error *error)
{
    lmb_instance *const instance = &work->level.scene->instances[work->instance[object]];
    const lmb_instance was = *instance;
    lmb_local_frame frame = work->frame[object];
    if (kind == MOVED) {
        const object_pose *const pose = &work->pose[object][place];
        object_pose_apply(pose, instance);
        frame = object_pose_frame(pose, work->level.scene, &frame);
    }
    instance->dynamic = false;
    lmb_result result = level_retrace(&work->level, error);
    if (result == LMB_OK) {
        result = object_measure(work, kind, object, place, &frame);
    }
    *instance = was;
    return result;
}

static lmb_result movables_measure(objects_work *work, lmb_error *error)
{
    for (uint32_t i = 0; i < work->count; ++i) {
        work->level.scene->instances[work->instance[i]].dynamic = true;
    }
    lmb_result result = level_retrace(&work->level, error);
    result = result == LMB_OK ? volume_bake(work, error) : result;
    for (uint32_t i = 0; i < work->count * work->places && result == LMB_OK; ++i) {
        const uint32_t object = i / work->places, place = i % work->places;
        work->has_pose[object][place] = object_pose_find(work->level.tracer, &work->frame[object],
                                                         lmb_mix(STREAM_POSE, i), &work->pose[object][place]);
    }
    for (uint32_t i = 0; i < work->count && result == LMB_OK; ++i) {
        result = movable_measure(work, THERE, i, 0, error);
        for (uint32_t place = 0; place < work->places && result == LMB_OK; ++place) {
            result = work->has_pose[i][place] ? movable_measure(work, MOVED, i, place, error) : LMB_OK;
        }
    }
    return result;
}

/* ------------------------------------------------------------------------------------------------- reports */

/* Of `count` points from `first` on. */
static lmb_result row_print(const objects_work *work, const char *name, int kind, int source, size_t first,
                            size_t count)
{
    const bool *const shown = work->shown[kind] + first;
    const point_light *const light = work->light[kind][source] + first;
    const leak_summary leak = leak_summarize(light, shown, count);
    size_t lit = 0;
    for (size_t i = 0; i < count; ++i) {
        work->lit[i] = shown[i] && light[i].reference >= LEAK_DARK_SHARE * leak.reference_mean;
        lit += work->lit[i];
    }
    error_summary error;
    if (lit == 0) {
        return LMB_OK;
    }
    const lmb_result result = error_summarize(work->error[kind][source] + first, work->lit, count, &error);
    if (result == LMB_OK) {
        printf("%s\t%s\t%s\t%zu\t%.3f\t%.3f\t%.3f\t%.3f\t%zu\t%.4f\n", name, kind_names[kind], source_names[source],
               lit, error.rel_rmse, error.median, error.p95, error.share_over_10pct, leak.dark_points, leak.leak);
    }
    return result;
}

static lmb_result rows_print(const objects_work *work, const char *name, size_t first, size_t count)
{
    lmb_result result = LMB_OK;
    for (int row = 0; row < KINDS * SOURCES && result == LMB_OK; ++row) {
        const int kind = row / SOURCES, source = row % SOURCES;
        if (kind != MOVED || source != BY_SET) {
            result = row_print(work, name, kind, source, first, count);
        }
    }
    return result;
}

static int doubles_compare(const void *a, const void *b)
{
    const double *const p = a, *const q = b;
    return (*p > *q) - (*p < *q);
}

enum { ROUNDS = 9, TIMES = 200 };
enum { TIME_RESAMPLE, TIME_SET, TIME_VOLUME, TIMINGS };

/* Seconds of each, over all objects, TIMES times, at the places of their probes; for sums, so that nothing is left out.
 */
static float round_time(const objects_work *work, double seconds[TIMINGS])
{
    static set_light set;
    lmb_sh3_rgb light;
    float seen[LMB_KEY_LIGHTS_MOST], sum = 0.0f;
    for (uint32_t i = 0; i < work->count; ++i) {
        const lmb_local_frame *const frame = &work->frame[i];
        const uint32_t probes = lmb_local_frame_count(frame);
        double start = seconds_now();
        for (int k = 0; k < TIMES; ++k) {
            lmb_local_set_resample(work->volume, frame, set.radiance, set.visibility);
            sum += set.radiance[k % (int)probes].channel[0].c[0];
        }
        seconds[TIME_RESAMPLE] += seconds_now() - start;
        start = seconds_now();
        for (int k = 0; k < TIMES; ++k) {
            for (uint32_t p = 0; p < probes; ++p) {
                lmb_local_set_sample_with_keys(frame, set.radiance, (const float(*)[LMB_KEY_LIGHTS_MOST])set.visibility,
                                               lmb_local_frame_position(frame, p), &light, seen);
                sum += light.channel[0].c[0];
            }
        }
        seconds[TIME_SET] += seconds_now() - start;
        start = seconds_now();
        for (int k = 0; k < TIMES; ++k) {
            for (uint32_t p = 0; p < probes; ++p) {
                lmb_volume_sample_with_keys(work->volume, lmb_local_frame_position(frame, p), &light, seen);
                sum += light.channel[0].c[0];
            }
        }
        seconds[TIME_VOLUME] += seconds_now() - start;
    }
    return sum;
}

static void times_print(const objects_work *work)
{
    double seconds[TIMINGS][ROUNDS] = {{0.0}}, probes = 0.0;
    float sum = 0.0f;
    for (uint32_t i = 0; i < work->count; ++i) {
        probes += (double)lmb_local_frame_count(&work->frame[i]);
    }
    for (int round = 0; round < ROUNDS; ++round) {
        double taken[TIMINGS] = {0.0};
        sum += round_time(work, taken);
        for (int t = 0; t < TIMINGS; ++t) {
            seconds[t][round] = taken[t] / TIMES;
        }
    }
    for (int t = 0; t < TIMINGS; ++t) {
        qsort(seconds[t], ROUNDS, sizeof seconds[t][0], doubles_compare);
    }
    printf("# %u objects of %.1f probes: a set filled in %.0f ns, %.1f a probe; a sample of it %.1f ns, of the volume "
           "%.1f (%g)\n",
           work->count, probes / work->count, 1e9 * seconds[TIME_RESAMPLE][ROUNDS / 2] / work->count,
           1e9 * seconds[TIME_RESAMPLE][ROUNDS / 2] / probes, 1e9 * seconds[TIME_SET][ROUNDS / 2] / probes,
           1e9 * seconds[TIME_VOLUME][ROUNDS / 2] / probes, (double)sum);
}

static lmb_result report(const objects_work *work)
{
    printf("object\tas it is\tlit by\tlit points\trel_rmse\tmedian\tp95\tover_10pct\tdark points\tleak\n");
    lmb_result result = LMB_OK;
    for (uint32_t i = 0; i < work->count && work->each && result == LMB_OK; ++i) {
        const size_t points = (size_t)work->places * work->points;
        result = rows_print(work, work->level.scene->instances[work->instance[i]].name, i * points, points);
    }
    return result == LMB_OK ? rows_print(work, "all", 0, work->most) : result;
}

/* -------------------------------------------------------------------------------------------------- program */

static bool work_allocate(objects_work *work)
{
    work->most = (size_t)work->count * work->places * work->points;
    work->lit = calloc(work->most, sizeof *work->lit);
    bool good = work->lit != NULL;
    for (int kind = 0; kind < KINDS; ++kind) {
        work->shown[kind] = calloc(work->most, sizeof *work->shown[kind]);
        good = good && work->shown[kind];
        for (int source = 0; source < SOURCES; ++source) {
            work->error[kind][source] = calloc(work->most, sizeof *work->error[kind][source]);
            work->light[kind][source] = calloc(work->most, sizeof *work->light[kind][source]);
            good = good && work->error[kind][source] && work->light[kind][source];
        }
    }
    return good;
}

static void work_free(objects_work *work)
{
    volume_close(work);
    free(work->lit);
    for (int kind = 0; kind < KINDS; ++kind) {
        free(work->shown[kind]);
        for (int source = 0; source < SOURCES; ++source) {
            free(work->error[kind][source]);
            free(work->light[kind][source]);
        }
    }
}

static lmb_result measure(objects_work *work, lmb_error *error)
{
    work->count =
        objects_find(work->level.scene, work->pattern, work->pattern_count, MOST_OBJECTS, work->instance, work->frame);
    if (work->count == 0) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: no object is marked or named", work->level.scene->path);
    }
    lmb_result result = work_allocate(work) ? LMB_OK : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    result = result == LMB_OK ? standing_measure(work, error) : result;
    if (result == LMB_OK) {
        times_print(work);
        volume_close(work);
        result = movables_measure(work, error);
    }
    result = result == LMB_OK ? report(work) : result;
    work_free(work);
    return result;
}

static void option_read(objects_work *work, lmb_arguments *arguments, const char *argument)
{
    if (strcmp(argument, "--points") == 0) {
        work->points = (uint32_t)arguments_integer(arguments, argument, 1, 1 << 20);
    } else if (strcmp(argument, "--truth") == 0) {
        work->truth = (uint32_t)arguments_integer(arguments, argument, 4, 1 << 24);
    } else if (strcmp(argument, "--places") == 0) {
        work->places = (uint32_t)arguments_integer(arguments, argument, 1, MOST_PLACES);
    } else if (strcmp(argument, "--each") == 0) {
        work->each = true;
    } else if (strcmp(argument, "--node") == 0 && work->pattern_count < MOST_PATTERNS) {
        work->pattern[work->pattern_count++] = arguments_text(arguments, argument);
    } else {
        arguments_error(arguments, "unexpected argument", argument);
    }
}

int main(int count, char **values)
{
    static objects_work work;
    work = (objects_work){.settings = lmb_bake_settings_default(), .points = 64, .truth = 256, .places = 2};
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "lambent_local_sets", usage);
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (!bake_argument(&work.settings, &arguments, argument)) {
            option_read(&work, &arguments, argument);
        }
    }
    if (arguments.failed || arguments.help) {
        return arguments_status(&arguments);
    }
    if (!work.settings.level.path) {
        fputs(usage, stderr);
        return EXIT_USAGE;
    }
    lmb_error error = {{0}};
    const lmb_warnings warnings = console_warnings(arguments.quiet);
    lmb_result result = lmb_level_open(&work.settings.level, &warnings, NULL, &work.level, &error);
    if (result == LMB_OK) {
        result = measure(&work, &error);
        lmb_level_close(&work.level);
    }
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
