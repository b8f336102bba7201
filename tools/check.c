#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/occlusion.h>
#include <lambent/opaque_surface.h>
#include <lambent/sequence.h>
#include <lambent/surface.h>

#include "check_points.h"
#include "check_reference.h"
#include "probe_light.h"
#include "replicates.h"

static const double missing = (double)NAN;

/* Of a figure, its standard error at most, if the points suffice. */
#define KNOWN_SHARE 0.1

enum { NORMALS = CHECK_NORMALS, AMBIENT_RAYS = 256, COINCIDENT_SAMPLES_FACTOR = 16 };

/* How many points, of how many samples, tell the level's mean light well enough to say what is dark. */
enum { MEAN_POINTS = 64, MEAN_SAMPLES = 64 };

/* What streams of variates are for. */
enum {
    STREAM_SURFACE = 1,
    STREAM_NORMALS,
    STREAM_AMBIENT,
    STREAM_FREE,
    STREAM_FREE_DIRECTIONS,
    STREAM_REFERENCE,
    STREAM_MEAN
};

static const struct {
    const char *name;
    bool needs_lightmap;
    const char *seen;
} pairs[CHECK_PAIR_COUNT] = {
    [CHECK_PROBE_VS_REFERENCE] = {"probe_vs_reference", false, "surfaces lit by the volume, beside the truth"},
    [CHECK_LIGHTMAP_VS_REFERENCE] = {"lightmap_vs_reference", true, "surfaces lit by lightmaps, beside the truth"},
    [CHECK_PROBE_VS_LIGHTMAP] = {"probe_vs_lightmap", true, "objects lit by the volume, beside the lightmap there"},
    [CHECK_COINCIDENT_PROBE_VS_LIGHTMAP] = {"coincident_probe_vs_lightmap", true,
                                            "the same with a probe at the very place"},
    [CHECK_COINCIDENT_PROBE_VS_REFERENCE] = {"coincident_probe_vs_reference", false,
                                             "a probe at the very place, beside the truth"},
    [CHECK_COINCIDENT_GRAM_VS_LIGHTMAP] = {"coincident_gram_vs_lightmap", true, "that probe by the papers' multiply"},
    [CHECK_COINCIDENT_PROBE_VS_TEXEL] = {"coincident_probe_vs_texel", false,
                                         "a probe at the very place, beside a texel of no extent there"},
    [CHECK_COINCIDENT_TEXEL_VS_LIGHTMAP] = {"coincident_texel_vs_lightmap", true, "such a texel, beside the lightmap"},
    [CHECK_COINCIDENT_TEXEL_VS_REFERENCE] = {"coincident_texel_vs_reference", false, "such a texel, beside the truth"},
    [CHECK_UNOCCLUDED_PROBE_VS_LIGHTMAP] = {"unoccluded_probe_vs_lightmap", true,
                                            "objects that the surface does not occlude, beside the lightmap"},
    [CHECK_OBJECT_VS_REFERENCE] = {"probe_hlsh_vs_reference", false, "moving objects at surfaces, beside the truth"},
    [CHECK_PROBE_CONE_VS_LIGHTMAP] = {"probe_cone_vs_lightmap", true,
                                      "objects with ambient occlusion, beside the lightmap"},
    [CHECK_VOLUME_VS_REFERENCE] = {"volume_vs_reference", false, "moving objects in free space, beside the truth"},
};

const char *check_pair_name(check_pair pair)
{
    return pairs[pair].name;
}

bool check_pair_needs_lightmap(check_pair pair)
{
    return pairs[pair].needs_lightmap;
}

const char *check_pair_seen(check_pair pair)
{
    return pairs[pair].seen;
}

check_settings check_settings_default(void)
{
    return (check_settings){.points = 1000, .max_points = 8000, .samples = 256, .seed = 0};
}

/* How well a coincident probe's SH3 is known. */
typedef struct coincident_noise {
    double error_squared;  /* of its standard error */
    double length_squared; /* of all its coefficients */
} coincident_noise;

/* Everything that the tasks read, and the slots that they write, one for each point. */
typedef struct check_work {
    const check_subject *subject;
    check_settings settings;
    lmb_transport baked;     /* the subject's, with a seed of the check's own */
    lmb_transport transport; /* the same as the path tracer */
    double mean_light;       /* about: of the reference on surfaces */
    lmb_opaque_surface surface;
    float default_texel; /* metres, where there are no lightmaps */
    point_error *errors[CHECK_PAIR_COUNT];
    point_light *lights;
    point_light *lightmap_lights;
    coincident_noise *coincident;
    bool any_surface; /* the level has opaque triangles */
    bool avoid_solids;
    bool *free_found;
    bool *mapped;             /* whether the surface has a lightmap there */
    bool *local;              /* whether a local set lights it */
    point_error *local_error; /* by that */
    size_t first;             /* point of this round, and how many it has */
    size_t count;
} check_work;

static void evaluate_unoccluded(const probe_light *light, const lmb_vec3 *normals, irradiance_set *set)
{
    for (int k = 0; k < NORMALS; ++k) {
        const lmb_rgb rest = lmb_sh3_rgb_irradiance(&light->radiance, normals[k]);
        set->at[k] = key_lights_add(&light->keys, normals[k], normals[k], rest);
    }
}

static void gather_reference(const check_work *work, const lmb_gather_point *point, const lmb_vec3 *normals,
                             irradiance_set half[2])
{
    const check_reference reference = {
        .transport = &work->transport, .samples = work->settings.samples, .mean_light = work->mean_light};
    check_reference_gather(&reference, point, normals, half);
}

/* One surface point, with what is known there. */
typedef struct surface_sample {
    size_t index;
    uint32_t instance;
    lmb_gather_point point;
    lmb_vec3 normals[NORMALS];
    irradiance_set reference[2];
    bool has_lightmap;
    irradiance_set lightmap; /* where there is one */
} surface_sample;

static void record(check_work *work, const surface_sample *sample, check_pair pair, const irradiance_set *x)
{
    const irradiance_set *r1 = &sample->reference[0];
    const irradiance_set *r2 = &sample->reference[1];
    switch (pair) {
    case CHECK_PROBE_VS_LIGHTMAP:
    case CHECK_COINCIDENT_PROBE_VS_LIGHTMAP:
    case CHECK_COINCIDENT_GRAM_VS_LIGHTMAP:
    case CHECK_COINCIDENT_TEXEL_VS_LIGHTMAP:
    case CHECK_UNOCCLUDED_PROBE_VS_LIGHTMAP:
    case CHECK_PROBE_CONE_VS_LIGHTMAP:
        if (!sample->has_lightmap) {
            return;
        }
        r1 = r2 = &sample->lightmap;
        break;
    default:
        break;
    }
    work->errors[pair][sample->index] = point_error_of(x->at, r1->at, r2->at, NORMALS);
}

static surface_sample sample_make(const check_work *work, size_t index)
{
    const check_subject *subject = work->subject;
    const uint64_t seed = work->settings.seed;
    const uint64_t round = lmb_mix(lmb_mix(seed, STREAM_SURFACE), work->first);
    const lmb_hit at =
        lmb_opaque_surface_point(&work->surface, round, (uint32_t)(index - work->first), (uint32_t)work->count);
    const lmb_place place = lmb_trace_place(subject->transport->tracer, &at);
    const bool has_lightmap = subject->lightmap && subject->lightmap->region[at.instance].image >= 0;
    const float texel = has_lightmap ? subject->lightmap->region[at.instance].texel_size : work->default_texel;
    surface_sample sample = {.index = index, .instance = at.instance, .has_lightmap = has_lightmap};
    bool pushed_out;
    sample.point = lmb_surface_gather_point(subject->transport->tracer, &place, texel, &pushed_out);
    shading_normals(sample.point.normal, lmb_mix(lmb_mix(seed, STREAM_NORMALS), index), NORMALS, sample.normals);
    gather_reference(work, &sample.point, sample.normals, sample.reference);
    if (has_lightmap) {
        float channel[LMB_MODEL_MOST_CHANNELS];
        key_lights_seen keys;
        keys.count = lmb_scene_key_lights(subject->lightmap->scene, keys.light);
        lmb_lightmap_sample(subject->lightmap, &at, channel);
        lmb_lightmap_sample_keys(subject->lightmap, &at, keys.visibility);
        channels_evaluate(subject->lightmap->model, channel, &keys, sample.point.normal, sample.normals,
                          &sample.lightmap);
    }
    return sample;
}

/* What is gathered at the very point: as a probe there, or, of its hemisphere alone, as a texel of no extent. */
static probe_light coincident_light(const check_work *work, const lmb_gather_point *point, coincident_noise *noise)
{
    lmb_gathered gathered;
    lmb_gather_sh3(&work->baked, point, COINCIDENT_SAMPLES_FACTOR * work->settings.samples, &gathered);
    *noise = (coincident_noise){gathered.squared_error, gathered.squared_light};
    probe_light light = {.radiance = gathered.moments};
    for (int c = 0; c < 3 && point->hemisphere; ++c) {
        light.radiance.channel[c] = lmb_sh3_fit_hemisphere(&gathered.moments.channel[c], point->normal);
    }
    light.keys.count = lmb_scene_key_lights(lmb_tracer_scene(work->transport.tracer), light.keys.light);
    memcpy(light.keys.visibility, gathered.key_visibility, sizeof gathered.key_visibility);
    return light;
}

static void record_coincident(check_work *work, const surface_sample *sample)
{
    const lmb_gather_point whole = {.position = sample->point.position, .hemisphere = false};
    coincident_noise unused;
    const probe_light at_probe = coincident_light(work, &whole, &work->coincident[sample->index]);
    const probe_light at_texel = coincident_light(work, &sample->point, &unused);
    irradiance_set probe, gram, texel;
    probe_light_evaluate(LMB_MODEL_FOR_SURFACE, &at_probe, sample->point.normal, 0.0f, sample->normals, &probe);
    probe_light_evaluate(LMB_MODEL_FOR_LIGHTMAP, &at_probe, sample->point.normal, 0.0f, sample->normals, &gram);
    probe_light_evaluate(LMB_MODEL_FOR_LIGHTMAP, &at_texel, sample->point.normal, 0.0f, sample->normals, &texel);
    record(work, sample, CHECK_COINCIDENT_PROBE_VS_REFERENCE, &probe);
    record(work, sample, CHECK_COINCIDENT_PROBE_VS_LIGHTMAP, &probe);
    record(work, sample, CHECK_COINCIDENT_GRAM_VS_LIGHTMAP, &gram);
    record(work, sample, CHECK_COINCIDENT_TEXEL_VS_REFERENCE, &texel);
    record(work, sample, CHECK_COINCIDENT_TEXEL_VS_LIGHTMAP, &texel);
    work->errors[CHECK_COINCIDENT_PROBE_VS_TEXEL][sample->index] =
        point_error_of(probe.at, texel.at, texel.at, NORMALS);
}

static void record_cone(check_work *work, const surface_sample *sample, const probe_light *light)
{
    const uint64_t stream = lmb_mix(lmb_mix(work->settings.seed, STREAM_AMBIENT), sample->index);
    const lmb_scene *scene = lmb_tracer_scene(work->subject->transport->tracer);
    const float spacing =
        lmb_volume_spacing_at(work->subject->volume, lmb_scene_to_world(scene, sample->point.position));
    const float visibility = ambient_visibility(work->transport.tracer, sample->point.position, sample->point.normal,
                                                spacing, stream, AMBIENT_RAYS);
    irradiance_set x;
    probe_light_evaluate(LMB_MODEL_FOR_SURFACE, light, sample->point.normal, lmb_cone_cos_from_visibility(visibility),
                         sample->normals, &x);
    record(work, sample, CHECK_PROBE_CONE_VS_LIGHTMAP, &x);
}

/* On a node that its local set lights. */
static void record_local(check_work *work, const surface_sample *sample)
{
    const check_subject *subject = work->subject;
    const lmb_scene *scene = lmb_tracer_scene(subject->transport->tracer);
    if (!subject->local || !local_light_has(subject->local, scene, sample->instance)) {
        return;
    }
    probe_light light;
    irradiance_set x;
    local_light_sample(subject->local, sample->instance, lmb_scene_to_world(scene, sample->point.position),
                       &light.radiance, &light.keys);
    probe_light_evaluate(LMB_MODEL_FOR_SURFACE, &light, sample->point.normal, 0.0f, sample->normals, &x);
    work->local[sample->index] = true;
    work->local_error[sample->index] = point_error_of(x.at, sample->reference[0].at, sample->reference[1].at, NORMALS);
}

static void surface_task(void *context, size_t task, int worker)
{
    (void)worker;
    check_work *work = context;
    const check_subject *subject = work->subject;
    const lmb_scene *scene = lmb_tracer_scene(subject->transport->tracer);
    const size_t index = work->first + task;
    const surface_sample sample = sample_make(work, index);
    const lmb_vec3 normal = sample.point.normal;
    const probe_light light = probe_light_of_volume(subject->volume, lmb_scene_to_world(scene, sample.point.position));

    irradiance_set x;
    probe_light_evaluate(LMB_MODEL_FOR_SURFACE, &light, normal, 0.0f, sample.normals, &x);
    record(work, &sample, CHECK_PROBE_VS_REFERENCE, &x);
    record(work, &sample, CHECK_PROBE_VS_LIGHTMAP, &x);
    work->lights[index] = point_light_of(x.at, sample.reference[0].at, sample.reference[1].at, NORMALS);
    probe_light_evaluate(LMB_MODEL_FOR_OBJECT, &light, normal, 0.0f, sample.normals, &x);
    record(work, &sample, CHECK_OBJECT_VS_REFERENCE, &x);
    record_coincident(work, &sample);
    record_local(work, &sample);
    work->mapped[index] = sample.has_lightmap;
    if (sample.has_lightmap) {
        evaluate_unoccluded(&light, sample.normals, &x);
        record(work, &sample, CHECK_UNOCCLUDED_PROBE_VS_LIGHTMAP, &x);
        record_cone(work, &sample, &light);
        record(work, &sample, CHECK_LIGHTMAP_VS_REFERENCE, &sample.lightmap);
        work->lightmap_lights[index] =
            point_light_of(sample.lightmap.at, sample.reference[0].at, sample.reference[1].at, NORMALS);
    }
}

static void free_task(void *context, size_t task, int worker)
{
    (void)worker;
    check_work *work = context;
    const uint64_t seed = work->settings.seed;
    const size_t index = work->first + task;
    lmb_gather_point point = {.hemisphere = false};
    work->free_found[index] = free_point(work->transport.tracer, work->subject->volume, work->avoid_solids,
                                         lmb_mix(lmb_mix(seed, STREAM_FREE), index), &point.position);
    if (!work->free_found[index]) {
        return;
    }
    lmb_vec3 directions[NORMALS];
    sphere_directions(lmb_mix(lmb_mix(seed, STREAM_FREE_DIRECTIONS), index), NORMALS, directions);
    irradiance_set reference[2], x;
    gather_reference(work, &point, directions, reference);
    const lmb_scene *scene = lmb_tracer_scene(work->transport.tracer);
    const probe_light light = probe_light_of_volume(work->subject->volume, lmb_scene_to_world(scene, point.position));
    evaluate_unoccluded(&light, directions, &x);
    work->errors[CHECK_VOLUME_VS_REFERENCE][index] = point_error_of(x.at, reference[0].at, reference[1].at, NORMALS);
}

static void mean_light_find(check_work *work)
{
    const lmb_tracer *tracer = work->transport.tracer;
    double sum = 0.0;
    for (uint32_t i = 0; i < MEAN_POINTS; ++i) {
        const lmb_hit at =
            lmb_opaque_surface_point(&work->surface, lmb_mix(work->settings.seed, STREAM_MEAN), i, MEAN_POINTS);
        const lmb_place place = lmb_trace_place(tracer, &at);
        bool pushed_out;
        const lmb_gather_point point = lmb_surface_gather_point(tracer, &place, work->default_texel, &pushed_out);
        const lmb_gather_samples samples = {
            .points = &point, .point_count = 1, .replicate = REPLICATES_CHECK, .count = MEAN_SAMPLES};
        lmb_rgb light;
        uint64_t unused = 0;
        lmb_gather_irradiance(&work->transport, &samples, &point.normal, 1, &light, &unused);
        sum += (double)(light.c[0] + light.c[1] + light.c[2]) / 3.0;
    }
    work->mean_light = sum / MEAN_POINTS;
}

static lmb_result work_prepare(const check_subject *subject, const check_settings *settings, check_work *work)
{
    const lmb_scene *scene = lmb_tracer_scene(subject->transport->tracer);
    *work = (check_work){.subject = subject, .settings = *settings, .baked = *subject->transport, .avoid_solids = true};
    work->baked.seed = lmb_mix(lmb_mix(subject->transport->seed, settings->seed), STREAM_REFERENCE);
    work->transport = work->baked;
    work->transport.surface = NULL;
    work->default_texel = 1.0f / lmb_lightmap_settings_default(scene).texels_per_m;
    const size_t points = settings->points > settings->max_points ? settings->points : settings->max_points;
    work->lights = calloc(points, sizeof *work->lights);
    work->lightmap_lights = calloc(points, sizeof *work->lightmap_lights);
    work->coincident = calloc(points, sizeof *work->coincident);
    work->free_found = calloc(points, sizeof *work->free_found);
    work->mapped = calloc(points, sizeof *work->mapped);
    work->local = calloc(points, sizeof *work->local);
    work->local_error = calloc(points, sizeof *work->local_error);
    bool good = work->lights && work->lightmap_lights && work->coincident && work->free_found && work->mapped &&
                work->local && work->local_error;
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        work->errors[pair] = calloc(points, sizeof *work->errors[pair]);
        good = good && work->errors[pair];
    }
    const lmb_result result =
        good ? lmb_opaque_surface_create(subject->transport->tracer, &work->surface) : LMB_ERROR_MEMORY;
    work->any_surface = result == LMB_OK && lmb_opaque_surface_area(&work->surface) > 0.0;
    if (work->any_surface) {
        mean_light_find(work);
    }
    return result;
}

static void work_free(check_work *work)
{
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        free(work->errors[pair]);
    }
    free(work->lights);
    free(work->lightmap_lights);
    free(work->coincident);
    free(work->free_found);
    free(work->mapped);
    free(work->local);
    free(work->local_error);
    lmb_opaque_surface_free(&work->surface);
}

/* Where the level's winding calls all its space solid, placement baked it nevertheless: then any point will do. */
static lmb_result free_points_run(check_work *work, const lmb_progress *progress)
{
    lmb_result result = lmb_pool_run(work->subject->pool, work->count, free_task, work, "free space", progress);
    bool any = work->first > 0;
    for (size_t i = 0; i < work->count; ++i) {
        any = any || work->free_found[i];
    }
    if (result == LMB_OK && !any) {
        work->avoid_solids = false;
        result = lmb_pool_run(work->subject->pool, work->count, free_task, work, "free space", progress);
    }
    return result;
}

/* Of the lightmap as it is stored. */
static lmb_result seams_report(const check_subject *subject, check_report *report)
{
    lmb_seam_steps steps = {.median = missing, .p95 = missing};
    const lmb_result result =
        subject->lightmap ? lmb_lightmap_seam_steps(subject->lightmap, subject->transport->tracer, &steps) : LMB_OK;
    report->seam_step_median = steps.median;
    report->seam_step_p95 = steps.p95;
    return result;
}

/* Of nodes that local sets light. */
static lmb_result locals_report(const check_work *work, size_t count, check_report *report)
{
    report->local_points = 0;
    for (size_t i = 0; i < count; ++i) {
        report->local_points += work->local[i];
    }
    const lmb_result result = error_summarize(work->local_error, work->local, count, &report->local);
    return result == LMB_OK
               ? error_summarize(work->errors[CHECK_PROBE_VS_REFERENCE], work->local, count, &report->local_field)
               : result;
}

/* The errors of the first `count` points. */
static lmb_result errors_report(check_work *work, size_t count, check_report *report)
{
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        const bool free = pair == CHECK_VOLUME_VS_REFERENCE;
        const bool *has = free ? work->free_found : pairs[pair].needs_lightmap ? work->mapped : NULL;
        const size_t points = free ? count : work->any_surface ? count : 0;
        const lmb_result result = error_summarize(work->errors[pair], has, points, &report->error[pair]);
        if (result != LMB_OK) {
            return result;
        }
    }
    return locals_report(work, work->any_surface ? count : 0, report);
}

/* Whether the standard error of every line is below a tenth of its figure. */
static bool errors_are_known(const check_report *report)
{
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        const error_summary *error = &report->error[pair];
        if (!isnan(error->rel_rmse) && !(error->std_error < KNOWN_SHARE * error->rel_rmse)) {
            return false;
        }
    }
    return isnan(report->local.rel_rmse) || report->local.std_error < KNOWN_SHARE * report->local.rel_rmse;
}

static lmb_result work_report(check_work *work, size_t count, check_report *report)
{
    report->points = work->any_surface ? count : 0;
    report->free_points = 0;
    for (size_t i = 0; i < count; ++i) {
        report->free_points += work->free_found[i];
    }
    report->leak = leak_summarize(work->lights, NULL, report->points);
    report->lightmap_leak =
        work->subject->lightmap ? leak_summarize(work->lightmap_lights, work->mapped, report->points).leak : missing;
    coincident_noise sum = {0.0, 0.0};
    for (size_t i = 0; i < report->points; ++i) {
        sum.error_squared += work->coincident[i].error_squared;
        sum.length_squared += work->coincident[i].length_squared;
    }
    report->coincident_std_error = sum.length_squared > 0.0 ? sqrt(sum.error_squared / sum.length_squared) : missing;
    return seams_report(work->subject, report);
}

/* Points `first` to `first` + `count`. */
static lmb_result round_run(check_work *work, size_t first, size_t count, const lmb_progress *progress)
{
    work->first = first;
    work->count = count;
    const lmb_result result =
        lmb_pool_run(work->subject->pool, work->any_surface ? count : 0, surface_task, work, "surfaces", progress);
    return result == LMB_OK ? free_points_run(work, progress) : result;
}

/* Each round has as many points as there were before, until enough is known. */
lmb_result check_run(const check_subject *subject, const check_settings *settings, const lmb_progress *progress,
                     check_report *report)
{
    check_work work;
    check_report made;
    size_t done = 0, count = settings->points;
    lmb_result result = work_prepare(subject, settings, &work);
    while (result == LMB_OK && count > 0) {
        result = round_run(&work, done, count, progress);
        done += count;
        if (result == LMB_OK) {
            result = errors_report(&work, done, &made);
        }
        const size_t left = settings->max_points > done ? settings->max_points - done : 0;
        count = result != LMB_OK || errors_are_known(&made) ? 0 : done < left ? done : left;
    }
    if (result == LMB_OK) {
        result = work_report(&work, done, &made);
    }
    if (result == LMB_OK) {
        *report = made;
    }
    work_free(&work);
    return result;
}
