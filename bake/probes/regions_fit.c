/* Fitting the corners of regions to light that was gathered inside of them: least squares by their normal equations,
 * which are the same for all coefficients, and conjugate gradients (Hestenes and Stiefel 1952) under a diagonal
 * preconditioner. */
#include <lambent/key_lights.h>

#include <stdlib.h>
#include <string.h>

#include "probes/regions_internal.h"

/* Squared, where gathered light counts 1: how much values of a face are held to those of a plane, and ends of an edge
 * to each other. */
#define HOLD_FACE 0.01
#define HOLD_EDGE 0.0004

/* Coefficients that are solved at once: a channel's, or all key lights'. */
enum { LANES = LMB_SH3_COUNT, MOST_PASSES = 200 };

/* Each holds some more of what came out negative in the last one. */
enum { MOST_FITS = 4 };

/* Squared, of what is left to where it began. */
#define CONVERGED 1e-10

typedef struct fit_entry {
    int32_t column;
    double value;
} fit_entry;

/* Rows of a matrix over what is unknown. */
typedef struct fit_matrix {
    size_t *first; /* [unknown + 1] */
    fit_entry *entry;
} fit_matrix;

typedef struct fit_job {
    const lmb_regions *regions;
    const lmb_gathered *gathered;
    lmb_probes *probes;
    uint32_t set;
    fit_matrix matrix;
    double *diagonal; /* [unknown] */
    bool *held;       /* [unknown] its radiance stays where solving starts */
    bool failed[4];   /* [task] out of memory */
} fit_job;

/* What values of a region are held by: sums that are about 0, of four corners of a face or of the two of an edge. */
typedef struct hold {
    int count, corner[4];
    float sign[4];
    double weight; /* of its square */
} hold;
enum { FACES = 6, EDGES = 12, HOLDS = FACES + EDGES };

static hold hold_of(int i)
{
    const int axis = i < FACES ? i / 2 : (i - FACES) / 4, below = (1 << axis) - 1;
    hold found = {.count = 2, .sign = {1.0f, -1.0f, -1.0f, 1.0f}, .weight = HOLD_EDGE};
    if (i < FACES) {
        const int first = i % 2 << axis, one = 1 << (axis + 1) % 3, other = 1 << (axis + 2) % 3;
        found = (hold){4, {first, first | one, first | other, first | one | other}, {1, -1, -1, 1}, HOLD_FACE};
    } else {
        const int k = (i - FACES) % 4;
        found.corner[0] = (k & below) | (k & ~below) << 1;
        found.corner[1] = found.corner[0] | 1 << axis;
    }
    return found;
}

/* --- the matrix --------------------------------------------------------------------------------------------------- */

/* Receives products of the equations' terms: of each pair of unknown ones. */
typedef struct matrix_sink {
    size_t *count;    /* [unknown] of entries, when `entry` is NULL; else the next one's place */
    fit_entry *entry; /* NULL: they are only counted */
} matrix_sink;

static void sink_add(const matrix_sink *sink, int32_t row, int32_t column, double value)
{
    if (row >= 0 && column >= 0) {
        if (sink->entry) {
            sink->entry[sink->count[row]] = (fit_entry){column, value};
        }
        ++sink->count[row];
    }
}

static void products_add(const lmb_regions *regions, const matrix_sink *sink)
{
    const int32_t *const unknown = regions->unknown_of;
    for (size_t i = 0; i < regions->point_count; ++i) {
        const int32_t *const corner = regions->corner[regions->point[i].region];
        float weight[8];
        lmb_region_weights(regions->point[i].t, weight);
        for (int k = 0; k < 64; ++k) {
            sink_add(sink, unknown[corner[k / 8]], unknown[corner[k % 8]],
                     (double)weight[k / 8] * (double)weight[k % 8]);
        }
    }
    for (uint32_t region = 0; region < regions->region_count; ++region) {
        const int32_t *const corner = regions->corner[region];
        for (int i = 0; i < HOLDS; ++i) {
            const hold held = hold_of(i);
            for (int k = 0; k < held.count * held.count; ++k) {
                const int a = k / held.count, b = k % held.count;
                sink_add(sink, unknown[corner[held.corner[a]]], unknown[corner[held.corner[b]]],
                         held.weight * (double)held.sign[a] * (double)held.sign[b]);
            }
        }
    }
}

/* Adds up entries of one place, and keeps those of each row together. `seen` has room for a number for each column. */
static void rows_merge(fit_matrix *matrix, double *diagonal, size_t rows, size_t *seen)
{
    size_t to = 0;
    memset(seen, 0xff, rows * sizeof *seen);
    for (size_t row = 0; row < rows; ++row) {
        const size_t start = to;
        for (size_t i = matrix->first[row]; i < matrix->first[row + 1]; ++i) {
            const fit_entry entry = matrix->entry[i];
            size_t *const at = &seen[entry.column];
            if (*at != SIZE_MAX && *at >= start) {
                matrix->entry[*at].value += entry.value;
            } else {
                *at = to;
                matrix->entry[to++] = entry;
            }
        }
        matrix->first[row] = start;
        diagonal[row] = seen[row] != SIZE_MAX && seen[row] >= start ? matrix->entry[seen[row]].value : 0.0;
    }
    matrix->first[rows] = to;
}

static lmb_result matrix_make(const lmb_regions *regions, fit_matrix *matrix, double *diagonal)
{
    const size_t rows = regions->unknown_count;
    size_t *const count = calloc(rows + 1, sizeof *count);
    lmb_result result = LMB_ERROR_MEMORY;
    if (count && matrix->first) {
        products_add(regions, &(matrix_sink){count, NULL});
        size_t sum = 0;
        for (size_t row = 0; row < rows; ++row) {
            matrix->first[row] = sum;
            sum += count[row];
            count[row] = matrix->first[row];
        }
        matrix->first[rows] = sum;
        matrix->entry = malloc((sum + 1) * sizeof *matrix->entry);
        result = matrix->entry ? LMB_OK : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        products_add(regions, &(matrix_sink){count, matrix->entry});
        rows_merge(matrix, diagonal, rows, count);
    }
    free(count);
    return result;
}

/* --- coefficients ------------------------------------------------------------------------------------------------- */

/* A task's coefficients: of a channel, or what is seen of key lights. */
static void value_get(const fit_job *job, size_t task, int32_t probe, double value[LANES])
{
    for (int k = 0; k < LANES; ++k) {
        value[k] = task < 3                  ? (double)job->probes->radiance[job->set][probe].channel[task].c[k]
                   : k < LMB_KEY_LIGHTS_MOST ? (double)job->probes->key_visibility[probe][k]
                                             : 0.0;
    }
}

static void value_set(const fit_job *job, size_t task, int32_t probe, const double value[LANES])
{
    for (int k = 0; k < LANES; ++k) {
        if (task < 3) {
            job->probes->radiance[job->set][probe].channel[task].c[k] = (float)value[k];
        } else if (k < LMB_KEY_LIGHTS_MOST) {
            job->probes->key_visibility[probe][k] = lmb_saturate((float)value[k]);
        }
    }
}

static void gathered_get(const fit_job *job, size_t task, size_t point, double value[LANES])
{
    const lmb_gathered *const gathered = &job->gathered[point];
    for (int k = 0; k < LANES; ++k) {
        value[k] = task < 3                  ? (double)gathered->moments.channel[task].c[k]
                   : k < LMB_KEY_LIGHTS_MOST ? (double)gathered->key_visibility[k]
                                             : 0.0;
    }
}

/* Known ends of what is held. */
static void right_hold(const fit_job *job, size_t task, const int32_t corner[8], int i, double (*right)[LANES])
{
    const int32_t *const unknown = job->regions->unknown_of;
    const hold held = hold_of(i);
    double sum[LANES] = {0.0}, known[LANES];
    for (int a = 0; a < held.count; ++a) {
        if (unknown[corner[held.corner[a]]] < 0) {
            value_get(job, task, corner[held.corner[a]], known);
            for (int k = 0; k < LANES; ++k) {
                sum[k] += (double)held.sign[a] * known[k];
            }
        }
    }
    for (int a = 0; a < held.count; ++a) {
        const int32_t to = unknown[corner[held.corner[a]]];
        for (int k = 0; k < LANES && to >= 0; ++k) {
            right[to][k] -= held.weight * (double)held.sign[a] * sum[k];
        }
    }
}

/* The right side: what is gathered less what known corners give, and the known ends of edges. */
static void right_make(const fit_job *job, size_t task, double (*right)[LANES])
{
    const lmb_regions *const regions = job->regions;
    const int32_t *const unknown = regions->unknown_of;
    double value[LANES], known[LANES];
    for (size_t i = 0; i < regions->point_count; ++i) {
        const int32_t *const corner = regions->corner[regions->point[i].region];
        float weight[8];
        lmb_region_weights(regions->point[i].t, weight);
        gathered_get(job, task, i, value);
        for (int c = 0; c < 8; ++c) {
            if (unknown[corner[c]] < 0) {
                value_get(job, task, corner[c], known);
                for (int k = 0; k < LANES; ++k) {
                    value[k] -= (double)weight[c] * known[k];
                }
            }
        }
        for (int c = 0; c < 8; ++c) {
            for (int k = 0; k < LANES && unknown[corner[c]] >= 0; ++k) {
                right[unknown[corner[c]]][k] += (double)weight[c] * value[k];
            }
        }
    }
    for (uint32_t region = 0; region < regions->region_count; ++region) {
        for (int i = 0; i < HOLDS; ++i) {
            right_hold(job, task, regions->corner[region], i, right);
        }
    }
}

/* --- solving ------------------------------------------------------------------------------------------------------ */

/* Vectors over what is unknown, LANES of them side by side. */
typedef struct fit_work {
    const fit_matrix *matrix;
    const double *diagonal;
    const bool *held; /* NULL: none is */
    size_t rows;
    double (*x)[LANES], (*left)[LANES], (*direction)[LANES], (*image)[LANES];
} fit_work;

static bool is_held(const fit_work *work, size_t row)
{
    return work->held && work->held[row];
}

/* The matrix times the direction, 0 where it is held; `along` is the direction's product with it. */
static void image_make(const fit_work *work, double along[LANES])
{
    memset(along, 0, LANES * sizeof *along);
    for (size_t row = 0; row < work->rows; ++row) {
        double sum[LANES] = {0.0};
        const size_t end = is_held(work, row) ? work->matrix->first[row] : work->matrix->first[row + 1];
        for (size_t i = work->matrix->first[row]; i < end; ++i) {
            const double value = work->matrix->entry[i].value;
            const double *const column = work->direction[work->matrix->entry[i].column];
            for (int k = 0; k < LANES; ++k) {
                sum[k] += value * column[k];
            }
        }
        memcpy(work->image[row], sum, sizeof sum);
        for (int k = 0; k < LANES; ++k) {
            along[k] += sum[k] * work->direction[row][k];
        }
    }
}

/* What is left, squared, under the preconditioner. */
static void left_measure(const fit_work *work, double squared[LANES])
{
    memset(squared, 0, LANES * sizeof *squared);
    for (size_t row = 0; row < work->rows; ++row) {
        const double inverse = work->diagonal[row] > 0.0 ? 1.0 / work->diagonal[row] : 0.0;
        for (int k = 0; k < LANES; ++k) {
            squared[k] += inverse * work->left[row][k] * work->left[row][k];
        }
    }
}

/* The next direction: what is left, and a share of the last one. */
static void direction_turn(const fit_work *work, const double share[LANES])
{
    for (size_t row = 0; row < work->rows; ++row) {
        const double inverse = work->diagonal[row] > 0.0 ? 1.0 / work->diagonal[row] : 0.0;
        for (int k = 0; k < LANES; ++k) {
            work->direction[row][k] = inverse * work->left[row][k] + share[k] * work->direction[row][k];
        }
    }
}

/* `left` is what x leaves of the right side. */
static void solve(const fit_work *work)
{
    double squared[LANES], enough[LANES], along[LANES], step[LANES], share[LANES] = {0.0};
    left_measure(work, squared);
    for (int k = 0; k < LANES; ++k) {
        enough[k] = CONVERGED * squared[k];
    }
    bool goes_on = true;
    for (int pass = 0; pass < MOST_PASSES && goes_on; ++pass) {
        direction_turn(work, share);
        image_make(work, along);
        for (int k = 0; k < LANES; ++k) {
            step[k] = squared[k] > enough[k] && along[k] > 0.0 ? squared[k] / along[k] : 0.0;
        }
        for (size_t row = 0; row < work->rows; ++row) {
            for (int k = 0; k < LANES; ++k) {
                work->x[row][k] += step[k] * work->direction[row][k];
                work->left[row][k] -= step[k] * work->image[row][k];
            }
        }
        double next[LANES];
        left_measure(work, next);
        goes_on = false;
        for (int k = 0; k < LANES; ++k) {
            share[k] = squared[k] > 0.0 ? next[k] / squared[k] : 0.0;
            squared[k] = next[k];
            goes_on = goes_on || (step[k] > 0.0 && squared[k] > enough[k]);
        }
    }
}

/* Where solving starts: each value has the mean of what is gathered in its regions, by weight. `sum` is 0. */
static void start_make(const fit_job *job, size_t task, double (*start)[LANES], double *sum)
{
    const double least = 1e-3; /* a point says something of all corners */
    const lmb_regions *const regions = job->regions;
    for (size_t i = 0; i < regions->point_count; ++i) {
        float weight[8];
        double value[LANES];
        lmb_region_weights(regions->point[i].t, weight);
        gathered_get(job, task, i, value);
        for (int c = 0; c < 8; ++c) {
            const int32_t to = regions->unknown_of[regions->corner[regions->point[i].region][c]];
            for (int k = 0; k < LANES && to >= 0; ++k) {
                start[to][k] += ((double)weight[c] + least) * value[k];
            }
            if (to >= 0) {
                sum[to] += (double)weight[c] + least;
            }
        }
    }
    for (size_t row = 0; row < regions->unknown_count; ++row) {
        for (int k = 0; k < LANES && sum[row] > 0.0; ++k) {
            start[row][k] /= sum[row];
        }
    }
}

static void coefficients_fit(void *context, size_t task, int worker)
{
    (void)worker;
    fit_job *const job = context;
    const size_t rows = job->regions->unknown_count;
    double(*const vectors)[LANES] = calloc(4 * rows + 1, sizeof *vectors);
    double *const sum = calloc(rows + 1, sizeof *sum);
    if (!vectors || !sum) {
        job->failed[task] = true;
        free(vectors);
        free(sum);
        return;
    }
    const fit_work work = {.matrix = &job->matrix,
                           .diagonal = job->diagonal,
                           .held = task < 3 ? job->held : NULL,
                           .rows = rows,
                           .x = vectors,
                           .left = vectors + rows,
                           .direction = vectors + 2 * rows,
                           .image = vectors + 3 * rows};
    right_make(job, task, work.left);
    start_make(job, task, work.x, sum);
    double along[LANES];
    memcpy(work.direction, work.x, rows * sizeof *work.x);
    image_make(&work, along);
    for (size_t i = 0; i < rows; ++i) {
        for (int k = 0; k < LANES; ++k) {
            work.left[i][k] = is_held(&work, i) ? 0.0 : work.left[i][k] - work.image[i][k];
        }
    }
    solve(&work);
    for (size_t i = 0; i < rows; ++i) {
        value_set(job, task, job->regions->unknown[i], work.x[i]);
    }
    free(vectors);
    free(sum);
}

static float mean_light(const fit_job *job, int32_t probe)
{
    const lmb_sh3_rgb *const light = &job->probes->radiance[job->set][probe];
    return lmb_luminance(lmb_rgb_of(light->channel[0].c[0], light->channel[1].c[0], light->channel[2].c[0]));
}

/* Holds what makes light negative before a surface: beside a lamp light falls off fast, and lines through what is
 * gathered can come out below 0 behind a wall. Returns how many more are held. */
static size_t negative_hold(const fit_job *job)
{
    const lmb_regions *const regions = job->regions;
    size_t more = 0;
    for (size_t i = 0; i < regions->place_count; ++i) {
        const int32_t *const corner = regions->corner[regions->place[i].region];
        float weight[8], sum = 0.0f;
        lmb_region_weights(regions->place[i].t, weight);
        for (int c = 0; c < 8; ++c) {
            sum += weight[c] * mean_light(job, corner[c]);
        }
        for (int c = 0; c < 8 && sum < 0.0f; ++c) {
            const int32_t unknown = regions->unknown_of[corner[c]];
            if (unknown >= 0 && !job->held[unknown] && mean_light(job, corner[c]) < 0.0f) {
                job->held[unknown] = true;
                ++more;
            }
        }
    }
    return more;
}

/* Sets what hangs on coarser levels. */
static void values_hang(const fit_job *job, size_t tasks)
{
    for (size_t i = 0; i < job->regions->hanging_count; ++i) {
        const lmb_region_hanging *const hanging = &job->regions->hanging[i];
        for (size_t task = 0; task < tasks; ++task) {
            double sum[LANES] = {0.0}, parent[LANES];
            for (int c = 0; c < 8; ++c) {
                value_get(job, task, hanging->parent[c], parent);
                for (int k = 0; k < LANES; ++k) {
                    sum[k] += (double)hanging->weight[c] * parent[k];
                }
            }
            value_set(job, task, hanging->value, sum);
        }
    }
}

lmb_result lmb_regions_fit(const lmb_regions *regions, const lmb_gathered *gathered, uint32_t set, lmb_pool *pool,
                           lmb_probes *probes)
{
    const size_t rows = regions->unknown_count;
    if (rows == 0 && regions->hanging_count == 0) {
        return LMB_OK;
    }
    fit_job job = {.regions = regions,
                   .gathered = gathered,
                   .probes = probes,
                   .set = set,
                   .matrix.first = malloc((rows + 1) * sizeof *job.matrix.first),
                   .diagonal = malloc((rows + 1) * sizeof *job.diagonal),
                   .held = calloc(rows + 1, sizeof *job.held)};
    const size_t tasks = probes->key_light_count > 0 ? 4 : 3;
    lmb_result result = LMB_ERROR_MEMORY;
    if (job.matrix.first && job.diagonal && job.held) {
        result = matrix_make(regions, &job.matrix, job.diagonal);
    }
    /* Each pass, one more level hangs on those that are done. */
    for (uint32_t pass = 0; pass < probes->level_count && result == LMB_OK; ++pass) {
        values_hang(&job, tasks);
        size_t held = 1;
        for (int fit = 0; fit < MOST_FITS && held > 0 && result == LMB_OK; ++fit) {
            result = lmb_pool_run(pool, tasks, coefficients_fit, &job, "probes", NULL);
            held = negative_hold(&job);
        }
    }
    values_hang(&job, tasks);
    for (int i = 0; i < 4; ++i) {
        result = job.failed[i] ? LMB_ERROR_MEMORY : result;
    }
    free(job.matrix.first);
    free(job.matrix.entry);
    free(job.diagonal);
    free(job.held);
    return result;
}
