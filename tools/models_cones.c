#include "models_cones.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "models_spread.h"

const float models_cone_cosine[MODELS_CONE_COSINES] = {0.0f, 0.25f, 0.5f, 0.75f, 0.9f};
const float models_cone_tilt_deg[MODELS_CONE_TILTS] = {0.0f, 30.0f, 60.0f};

enum { CONES = MODELS_CONE_TILTS * MODELS_CONE_COSINES, SKY_POINTS = 1 << 16 };

static const lmb_vec3 up = {0.0f, 0.0f, 1.0f};

const char *models_cone_method_name(models_cone_method method)
{
    static const char *const names[MODELS_CONE_METHOD_COUNT] = {"cone", "ao", "bent"};
    return names[method];
}

typedef struct cone {
    lmb_vec3 axis;
    float cosine;
    float visibility; /* V of it */
} cone;

typedef struct cone_job {
    const models_settings *settings;
    const models_map *map;
    const models_cone_report *report;
    lmb_vec3 normal[MODELS_NORMAL_COUNT];
    cone cone[CONES];    /* tilt by tilt */
    models_turn *turn;   /* [worker] */
    uint32_t *histogram; /* [worker][row][cone][bin] */
} cone_job;

/* The share of a white sky's irradiance that comes through: most cones reach below the horizon, and have no formula. */
static float visibility_of(lmb_vec3 axis, float cosine)
{
    double seen = 0.0, all = 0.0;
    for (int i = 0; i < SKY_POINTS; ++i) {
        const double z = ((double)i + 0.5) / SKY_POINTS, r = sqrt(1.0 - z * z);
        const double turn = 2.0 * LMB_PI * fmod((double)i * 0.61803398874989485, 1.0);
        all += z;
        seen += r * cos(turn) * (double)axis.x + z * (double)axis.z > (double)cosine ? z : 0.0;
    }
    return (float)(seen / all);
}

static void cones_make(cone cones[CONES])
{
    for (int tilt = 0; tilt < MODELS_CONE_TILTS; ++tilt) {
        const double angle = (double)models_cone_tilt_deg[tilt] * LMB_PI / 180.0;
        const lmb_vec3 axis = lmb_vec3_of((float)sin(angle), 0.0f, (float)cos(angle));
        for (int k = 0; k < MODELS_CONE_COSINES; ++k) {
            const float cosine = models_cone_cosine[k];
            cones[tilt * MODELS_CONE_COSINES + k] = (cone){axis, cosine, visibility_of(axis, cosine)};
        }
    }
}

/* `normal` as the turn that takes the surface's normal to `axis` leaves it, which is about y. */
static lmb_vec3 bent_normal(lmb_vec3 normal, lmb_vec3 axis)
{
    return lmb_vec3_of(axis.z * normal.x + axis.x * normal.z, normal.y, axis.z * normal.z - axis.x * normal.x);
}

static void row_apply(const models_cone_row *row, const cone *through, const models_turn *turn,
                      const lmb_vec3 normal[MODELS_NORMAL_COUNT], lmb_rgb irradiance[MODELS_NORMAL_COUNT])
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    if (row->method == MODELS_CONE_OWN) {
        row->model->encode(&turn->sh3[MODELS_PROBE], through->axis, through->cosine, channel);
        row->model->evaluate(channel, through->axis, normal, MODELS_NORMAL_COUNT, irradiance);
        return;
    }
    lmb_vec3 bent[MODELS_NORMAL_COUNT];
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        bent[i] = row->method == MODELS_CONE_BENT ? bent_normal(normal[i], through->axis) : normal[i];
    }
    row->model->encode(&turn->sh3[MODELS_PROBE], up, 0.0f, channel);
    row->model->evaluate(channel, up, bent, MODELS_NORMAL_COUNT, irradiance);
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        irradiance[i] = lmb_rgb_scale(irradiance[i], through->visibility);
    }
}

static void histogram_add(uint32_t *bins, const lmb_rgb *found, const lmb_rgb *reference)
{
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        const float own = reference[i].c[1], off = fabsf(found[i].c[1] - own);
        ++bins[models_bin_of(own > 0.0f ? off / own : off > 0.0f ? INFINITY : 0.0f)];
    }
}

static void cone_turn_measure(void *context, size_t task, int worker)
{
    cone_job *const all = context;
    const size_t rows = all->report->row_count;
    models_turn *const turn = &all->turn[worker];
    models_turn_fill(turn, &all->map[task / all->settings->turns], all->normal, (uint32_t)(task % all->settings->turns),
                     all->settings->seed);
    models_turn_make_grey(turn);
    for (size_t k = 0; k < CONES; ++k) {
        lmb_rgb reference[MODELS_NORMAL_COUNT], found[MODELS_NORMAL_COUNT];
        models_turn_reference(turn, all->cone[k].axis, all->cone[k].cosine, all->normal, reference);
        for (size_t r = 0; r < rows; ++r) {
            row_apply(&all->report->row[r], &all->cone[k], turn, all->normal, found);
            const size_t slot = ((size_t)worker * rows + r) * CONES + k;
            histogram_add(&all->histogram[slot * MODELS_BIN_COUNT], found, reference);
        }
    }
}

/* The other methods are shown of models that have a use. */
static bool method_exists(const lmb_model *model, models_cone_method method)
{
    const bool other = model->uses != 0 && (method == MODELS_CONE_AO || model->unoccluded);
    return model->encode && (method == MODELS_CONE_OWN ? model->cone : other);
}

static lmb_result cone_rows_make(const models_settings *settings, models_cone_report *report)
{
    const size_t models = settings->model ? settings->model_count : lmb_model_count();
    report->row = calloc(models * MODELS_CONE_METHOD_COUNT, sizeof *report->row);
    if (!report->row) {
        return LMB_ERROR_MEMORY;
    }
    for (int method = 0; method < MODELS_CONE_METHOD_COUNT; ++method) {
        for (size_t i = 0; i < models; ++i) {
            const lmb_model *model = settings->model ? settings->model[i] : lmb_model_at(i);
            if (method_exists(model, (models_cone_method)method)) {
                report->row[report->row_count++] =
                    (models_cone_row){.model = model, .method = (models_cone_method)method};
            }
        }
    }
    return LMB_OK;
}

static void cone_row_spread(const cone_job *all, size_t workers, size_t r, models_cone_row *row)
{
    for (size_t k = 0; k < CONES; ++k) {
        models_spread spread = {{0}, 0};
        for (size_t worker = 0; worker < workers; ++worker) {
            const size_t slot = (worker * all->report->row_count + r) * CONES + k;
            models_spread_add(&spread, &all->histogram[slot * MODELS_BIN_COUNT]);
        }
        row->median[k / MODELS_CONE_COSINES][k % MODELS_CONE_COSINES] = models_spread_quantile(&spread, 0.5);
    }
}

lmb_result models_cones_measure(const models_settings *settings, const models_map *map, size_t map_count,
                                lmb_pool *pool, const lmb_progress *progress, models_cone_report *report)
{
    *report = (models_cone_report){NULL, 0};
    const size_t workers = (size_t)lmb_pool_threads(pool);
    cone_job *const all = calloc(1, sizeof *all);
    lmb_result result = all ? cone_rows_make(settings, report) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        *all = (cone_job){.settings = settings, .map = map, .report = report};
        models_normals(all->normal);
        cones_make(all->cone);
        all->turn = malloc(workers * sizeof *all->turn);
        all->histogram = calloc(workers * report->row_count * CONES * MODELS_BIN_COUNT, sizeof *all->histogram);
        result = all->turn && all->histogram
                     ? lmb_pool_run(pool, map_count * settings->turns, cone_turn_measure, all, "cones", progress)
                     : LMB_ERROR_MEMORY;
    }
    for (size_t r = 0; result == LMB_OK && r < report->row_count; ++r) {
        cone_row_spread(all, workers, r, &report->row[r]);
    }
    if (all) {
        free(all->turn);
        free(all->histogram);
    }
    free(all);
    if (result != LMB_OK) {
        models_cones_free(report);
    }
    return result;
}

void models_cones_free(models_cone_report *report)
{
    free(report->row);
    *report = (models_cone_report){NULL, 0};
}
