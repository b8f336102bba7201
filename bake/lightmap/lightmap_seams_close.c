/* Least squares along seams: texels move by the least amount with which both sides read the same.
 *
 * What a point of a seam reads is a weighted sum of texels, so the step across it is one too: a row of eight weights.
 * Sought are the changes d of texels that minimise the sum of (row (x + d))^2 over all points, and of HOLD d^2 over all
 * texels: a sparse, positive system, solved by conjugate gradients for each channel by itself (after Iwanicki 2013,
 * "Lighting Technology of The Last of Us", who closes the seams of lightmaps this way). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

#include "lightmap/lightmap_seams.h"

/* What a texel's change counts beside a point's step: texels that were gathered know their light, others do not. At
 * 0.02 a ball whose islands are all border lost its shading, at 0.4 its borders showed. */
#define HOLD_GATHERED 0.1
#define HOLD_DILATED 0.002

/* Conjugate gradients end here at the latest, or when what is left has this share of its first length. */
enum { MOST_STEPS = 60 };
#define ENOUGH 1e-6

enum { ROW_TEXELS = 2 * LMB_FOOTPRINT };

/* A texel beside a seam. */
typedef struct seam_texel {
    int32_t image;
    uint32_t pixel;
} seam_texel;

typedef struct close_work {
    const lmb_seams *seams;
    lmb_lightmap *lightmap;
    size_t count;
    seam_texel *texel;
    uint32_t (*row)[ROW_TEXELS]; /* [point] its texels, as indices into `texel` */
    int light_channels;          /* that are closed; after them come key lights */
    uint8_t *out_of_memory;      /* [task] */
} close_work;

static int texel_compare(const void *a, const void *b)
{
    const seam_texel *const p = a, *const q = b;
    return p->image != q->image ? (p->image > q->image) - (p->image < q->image)
                                : (p->pixel > q->pixel) - (p->pixel < q->pixel);
}

static seam_texel row_texel(const lmb_seam_point *point, int k)
{
    const lmb_lightmap_footprint *side = &point->side[k / LMB_FOOTPRINT];
    return (seam_texel){side->image, side->pixel[k % LMB_FOOTPRINT]};
}

static double row_weight(const lmb_seam_point *point, int k)
{
    const double weight = (double)point->side[k / LMB_FOOTPRINT].weight[k % LMB_FOOTPRINT];
    return k < LMB_FOOTPRINT ? weight : -weight;
}

static uint32_t texel_index(const close_work *work, seam_texel texel)
{
    const seam_texel *found = bsearch(&texel, work->texel, work->count, sizeof texel, texel_compare);
    return (uint32_t)(found - work->texel);
}

/* Lists each texel of the seams once, and has the rows name them. */
static lmb_result texels_find(close_work *work)
{
    const lmb_seams *seams = work->seams;
    work->texel = malloc((seams->count * ROW_TEXELS + 1) * sizeof *work->texel);
    work->row = malloc((seams->count + 1) * sizeof *work->row);
    if (!work->texel || !work->row) {
        return LMB_ERROR_MEMORY;
    }
    for (size_t i = 0; i < seams->count; ++i) {
        for (int k = 0; k < ROW_TEXELS; ++k) {
            work->texel[i * ROW_TEXELS + (size_t)k] = row_texel(&seams->point[i], k);
        }
    }
    qsort(work->texel, seams->count * ROW_TEXELS, sizeof *work->texel, texel_compare);
    for (size_t i = 0; i < seams->count * ROW_TEXELS; ++i) {
        if (work->count == 0 || texel_compare(&work->texel[i], &work->texel[work->count - 1]) != 0) {
            work->texel[work->count++] = work->texel[i];
        }
    }
    for (size_t i = 0; i < seams->count; ++i) {
        for (int k = 0; k < ROW_TEXELS; ++k) {
            work->row[i][k] = texel_index(work, row_texel(&seams->point[i], k));
        }
    }
    return LMB_OK;
}

/* [texel] of one channel. */
typedef struct channel_system {
    double *value, *low, *high, *hold;
    double *change, *rest, *way, *image;
} channel_system;

static double row_sum(const close_work *work, size_t i, const double *of)
{
    double sum = 0.0;
    for (int k = 0; k < ROW_TEXELS; ++k) {
        sum += row_weight(&work->seams->point[i], k) * of[work->row[i][k]];
    }
    return sum;
}

/* to = to + R^T (scale R of). */
static void rows_apply(const close_work *work, const double *of, double scale, double *to)
{
    for (size_t i = 0; i < work->seams->count; ++i) {
        const double step = scale * row_sum(work, i, of);
        for (int k = 0; k < ROW_TEXELS; ++k) {
            to[work->row[i][k]] += step * row_weight(&work->seams->point[i], k);
        }
    }
}

static double dot(const double *a, const double *b, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* Each texel's value, and the range of those of its rows. */
static void values_find(const close_work *work, int channel, channel_system *system)
{
    for (size_t i = 0; i < work->count; ++i) {
        const lmb_lightmap_image *image = &work->lightmap->image[work->texel[i].image];
        const uint32_t pixel = work->texel[i].pixel;
        const double value = (double)lmb_lightmap_plane(image, channel)[pixel];
        system->value[i] = system->low[i] = system->high[i] = value;
        system->hold[i] = image->state[pixel] == LMB_TEXEL_GATHERED ? HOLD_GATHERED : HOLD_DILATED;
    }
    for (size_t i = 0; i < work->seams->count; ++i) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int k = 0; k < ROW_TEXELS; ++k) {
            low = fmin(low, system->value[work->row[i][k]]);
            high = fmax(high, system->value[work->row[i][k]]);
        }
        for (int k = 0; k < ROW_TEXELS; ++k) {
            const uint32_t texel = work->row[i][k];
            system->low[texel] = fmin(system->low[texel], low);
            system->high[texel] = fmax(system->high[texel], high);
        }
    }
}

static void system_solve(const close_work *work, channel_system *system)
{
    const size_t count = work->count;
    rows_apply(work, system->value, -1.0, system->rest);
    memcpy(system->way, system->rest, count * sizeof *system->way);
    double left = dot(system->rest, system->rest, count);
    const double enough = ENOUGH * ENOUGH * left;
    for (int step = 0; step < MOST_STEPS && left > enough; ++step) {
        for (size_t i = 0; i < count; ++i) {
            system->image[i] = system->hold[i] * system->way[i];
        }
        rows_apply(work, system->way, 1.0, system->image);
        const double along = left / dot(system->way, system->image, count);
        for (size_t i = 0; i < count; ++i) {
            system->change[i] += along * system->way[i];
            system->rest[i] -= along * system->image[i];
        }
        const double now = dot(system->rest, system->rest, count);
        for (size_t i = 0; i < count; ++i) {
            system->way[i] = system->rest[i] + now / left * system->way[i];
        }
        left = now;
    }
}

static void channel_task(void *context, size_t task, int worker)
{
    (void)worker;
    const close_work *work = context;
    const int number = (int)task, keys = work->lightmap->model->channel_count - work->light_channels;
    const int channel = number < work->light_channels ? number : number + keys;
    enum { ARRAYS = 8 };
    double *const memory = calloc(ARRAYS * (work->count + 1), sizeof *memory);
    if (!memory) {
        work->out_of_memory[task] = 1;
        return;
    }
    double *array[ARRAYS];
    for (size_t k = 0; k < ARRAYS; ++k) {
        array[k] = memory + k * (work->count + 1);
    }
    channel_system system = {array[0], array[1], array[2], array[3], array[4], array[5], array[6], array[7]};
    values_find(work, channel, &system);
    system_solve(work, &system);
    for (size_t i = 0; i < work->count; ++i) {
        const lmb_lightmap_image *image = &work->lightmap->image[work->texel[i].image];
        const double moved = fmin(fmax(system.value[i] + system.change[i], system.low[i]), system.high[i]);
        lmb_lightmap_plane(image, channel)[work->texel[i].pixel] = (float)moved;
    }
    free(memory);
}

lmb_result lmb_seams_close(const lmb_seams *seams, lmb_pool *pool, lmb_lightmap *lightmap)
{
    /* Where light has a direction, that of a texel is right for its own normal alone: moved, it would shine. */
    const lmb_model *model = lightmap->model;
    const int light = model->direction ? model->light_count : model->channel_count;
    const size_t channels = (size_t)light + lightmap->key_light_count;
    uint8_t out_of_memory[LMB_MODEL_MOST_CHANNELS + LMB_KEY_LIGHTS_MOST] = {0};
    close_work work = {.seams = seams, .lightmap = lightmap, .light_channels = light, .out_of_memory = out_of_memory};
    lmb_result result = texels_find(&work);
    if (result == LMB_OK && work.count > 0) {
        result = lmb_pool_run(pool, channels, channel_task, &work, "lightmaps", NULL);
    }
    for (size_t i = 0; i < channels; ++i) {
        result = out_of_memory[i] ? LMB_ERROR_MEMORY : result;
    }
    free(work.texel);
    free(work.row);
    return result;
}
