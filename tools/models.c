#include "models.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "models_spread.h"

static const lmb_vec3 up = {0.0f, 0.0f, 1.0f};

models_settings models_settings_default(void)
{
    return (models_settings){.turns = 256};
}

void models_apply(const lmb_model *model, models_input input, const models_turn *turn,
                  const lmb_vec3 normal[MODELS_NORMAL_COUNT], lmb_rgb irradiance[MODELS_NORMAL_COUNT])
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    if (model->encode) {
        model->encode(&turn->sh3[input], up, 0.0f, channel);
    } else {
        model->encode_light(turn->light, turn->light_count, up, channel);
    }
    model->evaluate(channel, up, normal, MODELS_NORMAL_COUNT, irradiance);
}

bool models_row_exists(const lmb_model *model, models_input input)
{
    if (input != MODELS_LIGHTMAP) {
        return model->encode != NULL;
    }
    return model->uses != 0 ? (model->uses & LMB_MODEL_FOR_LIGHTMAP) != 0 : !model->unoccluded;
}

static const lmb_model *model_at(const models_settings *settings, size_t index)
{
    return settings->model ? settings->model[index] : lmb_model_at(index);
}

static bool row_is_default(const lmb_model *model, models_input input)
{
    return model == lmb_model_default(input == MODELS_LIGHTMAP ? LMB_MODEL_FOR_LIGHTMAP : LMB_MODEL_FOR_SURFACE);
}

static lmb_result rows_make(const models_settings *settings, models_report *report)
{
    const size_t models = settings->model ? settings->model_count : lmb_model_count();
    report->row_count = 0;
    report->row = calloc(models * MODELS_INPUT_COUNT, sizeof *report->row);
    if (!report->row) {
        return LMB_ERROR_MEMORY;
    }
    for (int input = 0; input < MODELS_INPUT_COUNT; ++input) {
        for (size_t i = 0; i < models; ++i) {
            const lmb_model *model = model_at(settings, i);
            if (models_row_exists(model, (models_input)input)) {
                report->row[report->row_count++] =
                    (models_row){.model = model,
                                 .input = (models_input)input,
                                 .is_default = row_is_default(model, (models_input)input)};
            }
        }
    }
    return LMB_OK;
}

/* Sums of squares. */
typedef struct squares {
    double luminance;
    double colour;
} squares;

typedef struct job {
    const models_settings *settings;
    const models_map *map;
    const models_report *report;
    lmb_vec3 normal[MODELS_NORMAL_COUNT];
    models_turn *turn; /* [worker], and then as many again without colour */
    int workers;
    squares *reference;  /* [map][turn] */
    squares *error;      /* [map][turn][row] */
    uint32_t *histogram; /* [worker][row][bin] */
} job;

static double squares_of_colour(const lmb_rgb *a, const lmb_rgb *b)
{
    double sum = 0.0;
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        for (int c = 0; c < 3; ++c) {
            const double off = (double)a[i].c[c] - (b ? (double)b[i].c[c] : 0.0);
            sum += off * off;
        }
    }
    return sum;
}

/* All channels of these are the luminance. */
static double squares_of_grey(const lmb_rgb *a, const lmb_rgb *b)
{
    double sum = 0.0;
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        const double off = (double)a[i].c[1] - (b ? (double)b[i].c[1] : 0.0);
        sum += off * off;
    }
    return sum;
}

static void histogram_add(uint32_t *bins, const lmb_rgb *found, const lmb_rgb *reference)
{
    float mean = 0.0f;
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        mean += reference[i].c[1] * (1.0f / MODELS_NORMAL_COUNT);
    }
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        const float own = lmb_larger(reference[i].c[1], 0.01f * mean);
        ++bins[models_bin_of(own > 0.0f ? fabsf(found[i].c[1] - reference[i].c[1]) / own : 0.0f)];
    }
}

static void turn_measure(void *context, size_t task, int worker)
{
    job *const all = context;
    const size_t rows = all->report->row_count;
    models_turn *const coloured = &all->turn[worker], *const grey = &all->turn[all->workers + worker];
    models_turn_fill(coloured, &all->map[task / all->settings->turns], all->normal,
                     (uint32_t)(task % all->settings->turns), all->settings->seed);
    *grey = *coloured;
    models_turn_make_grey(grey);
    all->reference[task] =
        (squares){squares_of_grey(grey->reference, NULL), squares_of_colour(coloured->reference, NULL)};
    for (size_t r = 0; r < rows; ++r) {
        const models_row *row = &all->report->row[r];
        squares *const error = &all->error[task * rows + r];
        lmb_rgb found[MODELS_NORMAL_COUNT];
        models_apply(row->model, row->input, coloured, all->normal, found);
        error->colour = squares_of_colour(found, coloured->reference);
        models_apply(row->model, row->input, grey, all->normal, found);
        error->luminance = squares_of_grey(found, grey->reference);
        histogram_add(&all->histogram[((size_t)worker * rows + r) * MODELS_BIN_COUNT], found, grey->reference);
    }
}

/* Errors pooled over the turns of each map. */
static void row_pool(const job *all, size_t map_count, size_t r, models_row *row)
{
    const size_t turns = all->settings->turns, rows = all->report->row_count;
    for (size_t m = 0; m < map_count; ++m) {
        squares error = {0.0, 0.0}, reference = {0.0, 0.0};
        for (size_t task = m * turns; task < (m + 1) * turns; ++task) {
            error.luminance += all->error[task * rows + r].luminance;
            error.colour += all->error[task * rows + r].colour;
            reference.luminance += all->reference[task].luminance;
            reference.colour += all->reference[task].colour;
        }
        const double luminance = sqrt(error.luminance / reference.luminance);
        const double colour = sqrt(error.colour / reference.colour);
        row->luminance.mean += luminance / (double)map_count;
        row->luminance.max = fmax(row->luminance.max, luminance);
        row->colour.mean += colour / (double)map_count;
        row->colour.max = fmax(row->colour.max, colour);
    }
}

static void row_spread(const job *all, size_t r, models_row *row)
{
    const size_t rows = all->report->row_count;
    models_spread spread = {{0}, 0};
    for (int worker = 0; worker < all->workers; ++worker) {
        models_spread_add(&spread, &all->histogram[((size_t)worker * rows + r) * MODELS_BIN_COUNT]);
    }
    row->median = models_spread_quantile(&spread, 0.5);
    row->p95 = models_spread_quantile(&spread, 0.95);
    row->share_over_10pct = models_spread_share_over(&spread, 0.1f);
}

static lmb_result job_run(job *all, size_t map_count, lmb_pool *pool, const lmb_progress *progress,
                          models_report *report)
{
    const size_t tasks = map_count * all->settings->turns, rows = report->row_count;
    const size_t workers = (size_t)all->workers;
    all->turn = malloc(2 * workers * sizeof *all->turn);
    all->reference = malloc(tasks * sizeof *all->reference);
    all->error = malloc(tasks * rows * sizeof *all->error);
    all->histogram = calloc(workers * rows * MODELS_BIN_COUNT, sizeof *all->histogram);
    lmb_result result = LMB_ERROR_MEMORY;
    if (all->turn && all->reference && all->error && all->histogram) {
        result = lmb_pool_run(pool, tasks, turn_measure, all, "models", progress);
    }
    for (size_t r = 0; r < rows && result == LMB_OK; ++r) {
        row_pool(all, map_count, r, &report->row[r]);
        row_spread(all, r, &report->row[r]);
    }
    free(all->turn);
    free(all->reference);
    free(all->error);
    free(all->histogram);
    return result;
}

lmb_result models_measure(const models_settings *settings, const models_map *map, size_t map_count, lmb_pool *pool,
                          const lmb_progress *progress, models_report *report)
{
    *report = (models_report){NULL, 0};
    lmb_result result = rows_make(settings, report);
    if (result != LMB_OK) {
        return result;
    }
    job *const all = malloc(sizeof *all);
    if (!all) {
        models_report_free(report);
        return LMB_ERROR_MEMORY;
    }
    *all = (job){.settings = settings, .map = map, .report = report, .workers = lmb_pool_threads(pool)};
    models_normals(all->normal);
    result = job_run(all, map_count, pool, progress, report);
    free(all);
    if (result != LMB_OK) {
        models_report_free(report);
    }
    return result;
}

void models_report_free(models_report *report)
{
    free(report->row);
    *report = (models_report){NULL, 0};
}
