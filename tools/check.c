#include "check.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/occlusion.h>
#include <lambent/opaque_surface.h>
#include <lambent/sequence.h>
#include <lambent/surface.h>

#include "check_points.h"
#include "replicates.h"

static const double missing = (double)NAN;

enum { NORMALS = 8, AMBIENT_RAYS = 256, COINCIDENT_SAMPLES_FACTOR = 4 };

/* What streams of variates are for. */
enum { STREAM_SURFACE = 1, STREAM_NORMALS, STREAM_AMBIENT, STREAM_FREE, STREAM_FREE_DIRECTIONS, STREAM_REFERENCE };

static const struct {
    const char *name;
    bool needs_lightmap;
} pairs[CHECK_PAIR_COUNT] = {
    [CHECK_PROBE_VS_REFERENCE] = {"probe_vs_reference", false},
    [CHECK_LIGHTMAP_VS_REFERENCE] = {"lightmap_vs_reference", true},
    [CHECK_PROBE_VS_LIGHTMAP] = {"probe_vs_lightmap", true},
    [CHECK_COINCIDENT_PROBE_VS_LIGHTMAP] = {"coincident_probe_vs_lightmap", true},
    [CHECK_COINCIDENT_PROBE_VS_REFERENCE] = {"coincident_probe_vs_reference", false},
    [CHECK_COINCIDENT_GRAM_VS_LIGHTMAP] = {"coincident_gram_vs_lightmap", true},
    [CHECK_UNOCCLUDED_PROBE_VS_LIGHTMAP] = {"unoccluded_probe_vs_lightmap", true},
    [CHECK_OBJECT_VS_REFERENCE] = {"probe_hlsh_vs_reference", false},
    [CHECK_PROBE_CONE_VS_LIGHTMAP] = {"probe_cone_vs_lightmap", true},
    [CHECK_VOLUME_VS_REFERENCE] = {"volume_vs_reference", false},
};

const char *check_pair_name(check_pair pair)
{
    return pairs[pair].name;
}

bool check_pair_needs_lightmap(check_pair pair)
{
    return pairs[pair].needs_lightmap;
}

check_settings check_settings_default(void)
{
    return (check_settings){.points = 1000, .samples = 1024, .seed = 0};
}

/* Irradiance on the normals of one point. */
typedef struct irradiance_set {
    lmb_rgb at[NORMALS];
} irradiance_set;

/* How well a coincident probe's SH3 is known. */
typedef struct coincident_noise {
    double error_squared;  /* of its standard error */
    double length_squared; /* of all its coefficients */
} coincident_noise;

/* Everything that the tasks read, and the slots that they write, one for each point. */
typedef struct check_work {
    const check_subject *subject;
    check_settings settings;
    lmb_transport transport; /* the subject's, with a seed of the check's own */
    lmb_opaque_surface surface;
    float default_texel; /* metres, where there are no lightmaps */
    point_error *errors[CHECK_PAIR_COUNT];
    point_light *lights;
    point_light *lightmap_lights;
    coincident_noise *coincident;
    bool avoid_solids;
    bool *free_found;
    bool *mapped; /* whether the surface has a lightmap there */
} check_work;

static void evaluate_channels(const lmb_model *model, const float *channel, lmb_vec3 vertex_normal,
                              const lmb_vec3 *normals, irradiance_set *set)
{
    model->evaluate(channel, vertex_normal, normals, NORMALS, set->at);
}

/* What a probe gives by the default model of that use. */
static void evaluate_probe(lmb_model_use use, const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos,
                           const lmb_vec3 *normals, irradiance_set *set)
{
    const lmb_model *model = lmb_model_default(use);
    float channel[LMB_MODEL_MOST_CHANNELS];
    model->encode(radiance, vertex_normal, cone_cos, channel);
    evaluate_channels(model, channel, vertex_normal, normals, set);
}

static void evaluate_unoccluded(const lmb_sh3_rgb *radiance, const lmb_vec3 *normals, irradiance_set *set)
{
    for (int k = 0; k < NORMALS; ++k) {
        set->at[k] = lmb_sh3_rgb_irradiance(radiance, normals[k]);
    }
}

/* The reference at a point, as two independent halves. */
static void gather_reference(const check_work *work, const lmb_gather_point *point, const lmb_vec3 *normals,
                             irradiance_set half[2])
{
    uint64_t unused = 0;
    for (uint32_t i = 0; i < 2; ++i) {
        const lmb_gather_samples samples = {.points = point,
                                            .point_count = 1,
                                            .replicate = REPLICATES_CHECK + (uint32_t)i,
                                            .count = work->settings.samples};
        lmb_gather_irradiance(&work->transport, &samples, normals, NORMALS, half[i].at, &unused);
    }
}

/* One surface point, with what is known there. */
typedef struct surface_sample {
    size_t index;
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

static surface_sample sample_make(const check_work *work, size_t task)
{
    const check_subject *subject = work->subject;
    const uint64_t seed = work->settings.seed;
    const lmb_hit at =
        lmb_opaque_surface_point(&work->surface, lmb_mix(seed, STREAM_SURFACE), (uint32_t)task, work->settings.points);
    const lmb_place place = lmb_trace_place(subject->transport->tracer, &at);
    const bool has_lightmap = subject->lightmap && subject->lightmap->region[at.instance].image >= 0;
    const float texel = has_lightmap ? subject->lightmap->region[at.instance].texel_size : work->default_texel;
    surface_sample sample = {.index = task, .has_lightmap = has_lightmap};
    bool pushed_out;
    sample.point = lmb_surface_gather_point(subject->transport->tracer, &place, texel, &pushed_out);
    shading_normals(sample.point.normal, lmb_mix(lmb_mix(seed, STREAM_NORMALS), task), NORMALS, sample.normals);
    gather_reference(work, &sample.point, sample.normals, sample.reference);
    if (has_lightmap) {
        float channel[LMB_MODEL_MOST_CHANNELS];
        lmb_lightmap_sample(subject->lightmap, &at, channel);
        evaluate_channels(subject->lightmap->model, channel, sample.point.normal, sample.normals, &sample.lightmap);
    }
    return sample;
}

static void record_coincident(check_work *work, const surface_sample *sample)
{
    const lmb_gather_point whole = {.position = sample->point.position, .hemisphere = false};
    lmb_gathered gathered;
    lmb_gather_sh3(&work->transport, &whole, COINCIDENT_SAMPLES_FACTOR * work->settings.samples, &gathered);
    work->coincident[sample->index] = (coincident_noise){gathered.squared_error, gathered.squared_length};
    irradiance_set x;
    evaluate_probe(LMB_MODEL_FOR_SURFACE, &gathered.moments, sample->point.normal, 0.0f, sample->normals, &x);
    record(work, sample, CHECK_COINCIDENT_PROBE_VS_REFERENCE, &x);
    record(work, sample, CHECK_COINCIDENT_PROBE_VS_LIGHTMAP, &x);
    evaluate_probe(LMB_MODEL_FOR_LIGHTMAP, &gathered.moments, sample->point.normal, 0.0f, sample->normals, &x);
    record(work, sample, CHECK_COINCIDENT_GRAM_VS_LIGHTMAP, &x);
}

static void record_cone(check_work *work, const surface_sample *sample, const lmb_sh3_rgb *radiance)
{
    const uint64_t stream = lmb_mix(lmb_mix(work->settings.seed, STREAM_AMBIENT), sample->index);
    const lmb_scene *scene = lmb_tracer_scene(work->subject->transport->tracer);
    const float spacing =
        lmb_volume_spacing_at(work->subject->volume, lmb_scene_to_world(scene, sample->point.position));
    const float visibility = ambient_visibility(work->transport.tracer, sample->point.position, sample->point.normal,
                                                spacing, stream, AMBIENT_RAYS);
    irradiance_set x;
    evaluate_probe(LMB_MODEL_FOR_SURFACE, radiance, sample->point.normal, lmb_cone_cos_from_visibility(visibility),
                   sample->normals, &x);
    record(work, sample, CHECK_PROBE_CONE_VS_LIGHTMAP, &x);
}

static void surface_task(void *context, size_t task, int worker)
{
    (void)worker;
    check_work *work = context;
    const check_subject *subject = work->subject;
    const lmb_scene *scene = lmb_tracer_scene(subject->transport->tracer);
    const surface_sample sample = sample_make(work, task);
    const lmb_vec3 normal = sample.point.normal;
    lmb_sh3_rgb radiance;
    lmb_volume_sample_at(subject->volume, lmb_scene_to_world(scene, sample.point.position), &radiance);

    irradiance_set x;
    evaluate_probe(LMB_MODEL_FOR_SURFACE, &radiance, normal, 0.0f, sample.normals, &x);
    record(work, &sample, CHECK_PROBE_VS_REFERENCE, &x);
    record(work, &sample, CHECK_PROBE_VS_LIGHTMAP, &x);
    work->lights[task] = point_light_of(x.at, sample.reference[0].at, sample.reference[1].at, NORMALS);
    evaluate_probe(LMB_MODEL_FOR_OBJECT, &radiance, normal, 0.0f, sample.normals, &x);
    record(work, &sample, CHECK_OBJECT_VS_REFERENCE, &x);
    record_coincident(work, &sample);
    work->mapped[task] = sample.has_lightmap;
    if (sample.has_lightmap) {
        evaluate_unoccluded(&radiance, sample.normals, &x);
        record(work, &sample, CHECK_UNOCCLUDED_PROBE_VS_LIGHTMAP, &x);
        record_cone(work, &sample, &radiance);
        record(work, &sample, CHECK_LIGHTMAP_VS_REFERENCE, &sample.lightmap);
        work->lightmap_lights[task] =
            point_light_of(sample.lightmap.at, sample.reference[0].at, sample.reference[1].at, NORMALS);
    }
}

static void free_task(void *context, size_t task, int worker)
{
    (void)worker;
    check_work *work = context;
    const uint64_t seed = work->settings.seed;
    lmb_gather_point point = {.hemisphere = false};
    work->free_found[task] = free_point(work->transport.tracer, work->subject->volume, work->avoid_solids,
                                        lmb_mix(lmb_mix(seed, STREAM_FREE), task), &point.position);
    if (!work->free_found[task]) {
        return;
    }
    lmb_vec3 directions[NORMALS];
    sphere_directions(lmb_mix(lmb_mix(seed, STREAM_FREE_DIRECTIONS), task), NORMALS, directions);
    irradiance_set reference[2], x;
    gather_reference(work, &point, directions, reference);
    lmb_sh3_rgb radiance;
    lmb_volume_sample_at(work->subject->volume,
                         lmb_scene_to_world(lmb_tracer_scene(work->transport.tracer), point.position), &radiance);
    evaluate_unoccluded(&radiance, directions, &x);
    work->errors[CHECK_VOLUME_VS_REFERENCE][task] = point_error_of(x.at, reference[0].at, reference[1].at, NORMALS);
}

static lmb_result work_prepare(const check_subject *subject, const check_settings *settings, check_work *work)
{
    const lmb_scene *scene = lmb_tracer_scene(subject->transport->tracer);
    *work = (check_work){.subject = subject, .settings = *settings, .transport = *subject->transport};
    work->transport.seed = lmb_mix(lmb_mix(subject->transport->seed, settings->seed), STREAM_REFERENCE);
    work->default_texel = 1.0f / lmb_lightmap_settings_default(scene).texels_per_m;
    const size_t points = settings->points;
    work->lights = calloc(points, sizeof *work->lights);
    work->lightmap_lights = calloc(points, sizeof *work->lightmap_lights);
    work->coincident = calloc(points, sizeof *work->coincident);
    work->free_found = calloc(points, sizeof *work->free_found);
    work->mapped = calloc(points, sizeof *work->mapped);
    bool good = work->lights && work->lightmap_lights && work->coincident && work->free_found && work->mapped;
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        work->errors[pair] = calloc(points, sizeof *work->errors[pair]);
        good = good && work->errors[pair];
    }
    return good ? lmb_opaque_surface_create(subject->transport->tracer, &work->surface) : LMB_ERROR_MEMORY;
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
    lmb_opaque_surface_free(&work->surface);
}

/* Moves the errors of points that have one to the front. Returns how many have. */
static size_t errors_compact(point_error *errors, const bool *has, size_t count)
{
    size_t found = 0;
    for (size_t i = 0; i < count; ++i) {
        if (has[i]) {
            errors[found++] = errors[i];
        }
    }
    return found;
}

/* The same of all that is compared with lightmaps. */
static size_t mapped_compact(check_work *work, size_t count)
{
    size_t found = 0;
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        if (pairs[pair].needs_lightmap) {
            errors_compact(work->errors[pair], work->mapped, count);
        }
    }
    for (size_t i = 0; i < count; ++i) {
        if (work->mapped[i]) {
            work->lightmap_lights[found++] = work->lightmap_lights[i];
        }
    }
    return found;
}

/* Where the level's winding calls all its space solid, placement baked it nevertheless: then any point will do. */
static lmb_result free_points_run(check_work *work, const lmb_progress *progress)
{
    const size_t count = work->settings.points;
    work->avoid_solids = true;
    lmb_result result = lmb_pool_run(work->subject->pool, count, free_task, work, "free space", progress);
    bool any = false;
    for (size_t i = 0; i < count; ++i) {
        any = any || work->free_found[i];
    }
    if (result == LMB_OK && !any) {
        work->avoid_solids = false;
        result = lmb_pool_run(work->subject->pool, count, free_task, work, "free space", progress);
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

static lmb_result work_report(check_work *work, size_t surface_points, check_report *report)
{
    const bool lightmap = work->subject->lightmap != NULL;
    report->points = surface_points;
    report->free_points =
        errors_compact(work->errors[CHECK_VOLUME_VS_REFERENCE], work->free_found, work->settings.points);
    const size_t mapped = mapped_compact(work, surface_points);
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        const size_t count = pairs[pair].needs_lightmap          ? mapped
                             : pair == CHECK_VOLUME_VS_REFERENCE ? report->free_points
                                                                 : surface_points;
        const lmb_result result = error_summarize(work->errors[pair], count, &report->error[pair]);
        if (result != LMB_OK) {
            return result;
        }
    }
    report->leak = leak_summarize(work->lights, surface_points);
    report->lightmap_leak = lightmap ? leak_summarize(work->lightmap_lights, mapped).leak : missing;
    coincident_noise sum = {0.0, 0.0};
    for (size_t i = 0; i < surface_points; ++i) {
        sum.error_squared += work->coincident[i].error_squared;
        sum.length_squared += work->coincident[i].length_squared;
    }
    report->coincident_std_error = sum.length_squared > 0.0 ? sqrt(sum.error_squared / sum.length_squared) : missing;
    return seams_report(work->subject, report);
}

lmb_result check_run(const check_subject *subject, const check_settings *settings, const lmb_progress *progress,
                     check_report *report)
{
    check_work work;
    check_report made;
    lmb_result result = work_prepare(subject, settings, &work);
    if (result != LMB_OK) {
        goto cleanup;
    }
    const size_t surface_points = lmb_opaque_surface_area(&work.surface) > 0.0 ? settings->points : 0;
    result = lmb_pool_run(subject->pool, surface_points, surface_task, &work, "surfaces", progress);
    if (result != LMB_OK) {
        goto cleanup;
    }
    result = free_points_run(&work, progress);
    if (result != LMB_OK) {
        goto cleanup;
    }
    result = work_report(&work, surface_points, &made);
    if (result == LMB_OK) {
        *report = made;
    }
cleanup:
    work_free(&work);
    return result;
}
