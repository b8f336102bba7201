#include "models_blend.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

static const lmb_vec3 up = {0.0f, 0.0f, 1.0f};

/* Of one row and task. */
typedef struct blend_sums {
    double harmonics, channels, reference;
} blend_sums;

/* What a thread works on. */
typedef struct blend_worker {
    models_turn turn[2];
    lmb_rgb reference[MODELS_NORMAL_COUNT];
    lmb_rgb found[MODELS_NORMAL_COUNT];
} blend_worker;

typedef struct blend_job {
    const models_settings *settings;
    const models_map *map;
    size_t map_count;
    const models_blend_report *report;
    lmb_vec3 normal[MODELS_NORMAL_COUNT];
    blend_worker *worker;
    blend_sums *sums; /* [map][turn][row] */
} blend_job;

static double error_of(const lmb_rgb *found, const lmb_rgb *reference)
{
    double sum = 0.0;
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        const double off = (double)found[i].c[1] - (double)reference[i].c[1];
        sum += off * off;
    }
    return sum;
}

/* Both turns without colour, each half, and equally bright; their sum's irradiance. */
static void lights_make(const blend_job *job, size_t map, uint32_t turn, blend_worker *worker)
{
    const models_map *maps[2] = {&job->map[map], &job->map[(map + 1) % job->map_count]};
    for (uint32_t k = 0; k < 2; ++k) {
        models_turn *one = &worker->turn[k];
        models_turn_fill(one, maps[k], job->normal, turn + k, job->settings->seed);
        models_turn_make_grey(one);
        const float share = 0.5f / one->sh3[MODELS_PROBE].channel[1].c[0];
        for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
            one->sh3[MODELS_PROBE].channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT] *= share;
        }
        for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
            const lmb_rgb light = lmb_rgb_scale(one->reference[i], share);
            worker->reference[i] = k == 0 ? light : lmb_rgb_add(worker->reference[i], light);
        }
    }
}

static void row_blend(const blend_job *job, const lmb_model *model, blend_worker *worker, blend_sums *sums)
{
    float channel[2][LMB_MODEL_MOST_CHANNELS];
    lmb_sh3_rgb both = worker->turn[0].sh3[MODELS_PROBE];
    for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
        both.channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT] +=
            worker->turn[1].sh3[MODELS_PROBE].channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT];
    }
    model->encode(&both, up, 0.0f, channel[0]);
    model->evaluate(channel[0], up, job->normal, MODELS_NORMAL_COUNT, worker->found);
    sums->harmonics = error_of(worker->found, worker->reference);
    for (int k = 0; k < 2; ++k) {
        model->encode(&worker->turn[k].sh3[MODELS_PROBE], up, 0.0f, channel[k]);
    }
    /* Halves of the light add up; weights and directions are means. */
    for (int i = 0; i < model->channel_count; ++i) {
        channel[0][i] += channel[1][i];
    }
    lmb_model_average(model, channel[0], 2.0f);
    for (int i = 0; i < model->light_count; ++i) {
        channel[0][i] *= 2.0f;
    }
    model->evaluate(channel[0], up, job->normal, MODELS_NORMAL_COUNT, worker->found);
    sums->channels = error_of(worker->found, worker->reference);
    sums->reference = 0.0;
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        sums->reference += (double)worker->reference[i].c[1] * (double)worker->reference[i].c[1];
    }
}

static void blend_task(void *context, size_t task, int worker)
{
    blend_job *const job = context;
    const uint32_t turns = job->settings->turns;
    lights_make(job, task / turns, (uint32_t)(task % turns), &job->worker[worker]);
    for (size_t r = 0; r < job->report->row_count; ++r) {
        row_blend(job, job->report->row[r].model, &job->worker[worker], &job->sums[task * job->report->row_count + r]);
    }
}

static lmb_result blend_rows_make(const models_settings *settings, models_blend_report *report)
{
    const size_t models = settings->model ? settings->model_count : lmb_model_count();
    report->row = calloc(models + 1, sizeof *report->row);
    for (size_t i = 0; report->row && i < models; ++i) {
        const lmb_model *model = settings->model ? settings->model[i] : lmb_model_at(i);
        if (model->uses != 0 && model->encode) {
            report->row[report->row_count++].model = model;
        }
    }
    return report->row ? LMB_OK : LMB_ERROR_MEMORY;
}

static void row_sum(const blend_job *job, size_t r, models_blend_row *row)
{
    for (size_t map = 0; map < job->map_count; ++map) {
        blend_sums sum = {0.0, 0.0, 0.0};
        for (size_t turn = 0; turn < job->settings->turns; ++turn) {
            const blend_sums *one = &job->sums[(map * job->settings->turns + turn) * job->report->row_count + r];
            sum.harmonics += one->harmonics;
            sum.channels += one->channels;
            sum.reference += one->reference;
        }
        row->harmonics += sqrt(sum.harmonics / sum.reference) / (double)job->map_count;
        row->channels += sqrt(sum.channels / sum.reference) / (double)job->map_count;
    }
}

lmb_result models_blend_measure(const models_settings *settings, const models_map *map, size_t map_count,
                                lmb_pool *pool, const lmb_progress *progress, models_blend_report *report)
{
    *report = (models_blend_report){NULL, 0};
    const size_t tasks = map_count * settings->turns;
    blend_job job = {.settings = settings, .map = map, .map_count = map_count, .report = report};
    lmb_result result = blend_rows_make(settings, report);
    if (result == LMB_OK) {
        models_normals(job.normal);
        job.worker = malloc((size_t)lmb_pool_threads(pool) * sizeof *job.worker);
        job.sums = calloc(tasks * report->row_count + 1, sizeof *job.sums);
        result =
            job.worker && job.sums ? lmb_pool_run(pool, tasks, blend_task, &job, "blends", progress) : LMB_ERROR_MEMORY;
    }
    for (size_t r = 0; result == LMB_OK && r < report->row_count; ++r) {
        row_sum(&job, r, &report->row[r]);
    }
    free(job.worker);
    free(job.sums);
    if (result != LMB_OK) {
        models_blend_free(report);
    }
    return result;
}

void models_blend_free(models_blend_report *report)
{
    free(report->row);
    *report = (models_blend_report){NULL, 0};
}
