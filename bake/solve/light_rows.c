#include "solve/light_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "solve/side_sample.h"

enum { PATCHES_PER_TASK = 128 };

/* The light of a cell that is partly in a gap is that of its open part, if enough samples show that part. Fewer may all
 * see each other's cells: what reflects more than WHITE of the light then hardly ever lets go of it. */
enum { ENOUGH_OPEN_SAMPLES = 4 };
#define WHITE 0.9f

/* A patch of which a sample finds less than this share of its mean of the sun is uneven. Of other lights the samples
 * differ by chance too, and to choose by that would be a bias. */
#define SHADED 0.25f

static size_t task_count(uint32_t patch_count)
{
    return ((size_t)patch_count + PATCHES_PER_TASK - 1) / PATCHES_PER_TASK;
}

/* All samples when a cell is about as large as cells can be, fewer for small ones, whose neighbours are seen beside
 * them. */
static void cell_samples_set(const lmb_light_rows *rows, uint32_t samples)
{
    const lmb_surface_light *light = rows->light;
    const float full_area = 0.25f * light->cell_size * light->cell_size;
    for (uint32_t i = 0; i < light->instance_count; ++i) {
        for (uint32_t t = light->triangle_first[i]; t < light->triangle_first[i + 1]; ++t) {
            const uint32_t least =
                lmb_cell_is_small(light, &light->grid[t]) ? LMB_ROWS_SMALL_SAMPLES : LMB_ROWS_PILOT_SAMPLES;
            lmb_cell cell = {i, t - light->triangle_first[i], 0, &light->grid[t]};
            for (; cell.grid->first + cell.index < cell.grid[1].first; ++cell.index) {
                const float share = fminf(lmb_cell_area(&cell, rows->transport->tracer) / full_area, 1.0f);
                const uint32_t wanted = share > 0.0f ? (uint32_t)ceilf((float)samples * share) : 0;
                rows->cell_samples[cell.grid->first + cell.index] = wanted > least ? wanted : least;
            }
        }
    }
}

/* All of a patch that is lit. A piece gets its share of the side's. */
static uint32_t patch_samples(const lmb_light_rows *rows, uint32_t patch)
{
    const lmb_surface_light *light = rows->light;
    const uint32_t side = lmb_patch_side(light, patch);
    const uint32_t samples = rows->cell_samples[side / 2];
    if (patch == side) {
        return lmb_side_is_whole(light, side) ? samples : 0;
    }
    const uint32_t starts = (uint32_t)__builtin_popcount(light->piece[patch - 2 * light->cell_count].starts);
    const uint32_t share = (samples * starts + LMB_CELL_STARTS - 1) / LMB_CELL_STARTS;
    return share > LMB_ROWS_SMALL_SAMPLES ? share : LMB_ROWS_SMALL_SAMPLES;
}

static uint32_t pilot_samples(const lmb_light_rows *rows, uint32_t patch)
{
    const uint32_t samples = patch_samples(rows, patch);
    return samples < LMB_ROWS_PILOT_SAMPLES ? samples : LMB_ROWS_PILOT_SAMPLES;
}

typedef struct rows_work {
    lmb_light_rows *rows;
    bool corrects;  /* samples that see uneven patches */
    uint32_t first; /* of each patch's samples that are to be taken */
    uint64_t *rays; /* [task] */
} rows_work;

/* Samples that wait until there are enough to be taken together. */
typedef struct sample_queue {
    uint32_t count;
    uint32_t patch[LMB_SIDE_SAMPLES];
    lmb_side_sample sample[LMB_SIDE_SAMPLES];
} sample_queue;

static void direct_add(const lmb_light_rows *rows, uint32_t patch, const lmb_side_sample *sample)
{
    rows->direct[patch] = lmb_rgb_add(rows->direct[patch], sample->direct);
    if (sample->link.open) {
        rows->open_direct[patch] = lmb_rgb_add(rows->open_direct[patch], sample->direct);
    }
}

static void queue_take(const lmb_light_rows *rows, sample_queue *queue)
{
    if (queue->count == 0) {
        return;
    }
    lmb_side_samples_take(rows->light, queue->sample, queue->count);
    for (uint32_t i = 0; i < queue->count; ++i) {
        const lmb_side_sample *sample = &queue->sample[i];
        const uint32_t patch = queue->patch[i];
        direct_add(rows, patch, sample);
        rows->links[rows->row[patch] + sample->path.sample] = sample->link;
        rows->sun[patch] = lmb_rgb_add(rows->sun[patch], sample->sun);
        rows->sun_least[patch] = lmb_smaller(rows->sun_least[patch], lmb_luminance(sample->sun));
    }
    queue->count = 0;
}

/* Which of the side's starts is sample `sample` of a piece: its own take turns. */
static uint32_t piece_start(const lmb_cell_piece *piece, uint32_t sample)
{
    uint32_t starts = piece->starts;
    for (uint32_t skip = sample % (uint32_t)__builtin_popcount(starts); skip > 0; --skip) {
        starts &= starts - 1;
    }
    return (uint32_t)__builtin_ctz(starts);
}

static lmb_side_sample sample_make(const lmb_light_rows *rows, uint32_t patch, uint64_t *rays)
{
    const lmb_surface_light *light = rows->light;
    const uint32_t side = lmb_patch_side(light, patch);
    lmb_side_sample sample = {.cell = lmb_cell_find(light, side / 2), .front = side % 2 == 0};
    sample.start_stream = lmb_side_stream(rows->transport, &sample.cell, side);
    const uint64_t piece = patch == side ? 0 : 1 + patch - light->first_piece[side];
    sample.path = (lmb_path){.transport = rows->transport,
                             .stream = patch == side ? sample.start_stream : lmb_mix(sample.start_stream, piece),
                             .rays = rays};
    return sample;
}

static void queue_correct(const lmb_light_rows *rows, sample_queue *queue)
{
    if (queue->count == 0) {
        return;
    }
    lmb_side_samples_correct(rows->light, queue->sample, queue->count);
    for (uint32_t i = 0; i < queue->count; ++i) {
        direct_add(rows, queue->patch[i], &queue->sample[i]);
    }
    queue->count = 0;
}

static void sample_set(const lmb_light_rows *rows, uint32_t patch, uint32_t index, lmb_side_sample *sample)
{
    const uint32_t sides = 2 * rows->light->cell_count;
    sample->path.sample = index;
    sample->start_sample = patch < sides ? index : piece_start(&rows->light->piece[patch - sides], index);
}

static void queue_patch(const lmb_light_rows *rows, sample_queue *queue, uint32_t patch, uint32_t first, uint64_t *rays)
{
    const uint32_t samples = (uint32_t)(rows->row[patch + 1] - rows->row[patch]);
    if (first >= samples) {
        return;
    }
    lmb_side_sample sample = sample_make(rows, patch, rays);
    for (uint32_t i = first; i < samples; ++i) {
        sample_set(rows, patch, i, &sample);
        queue->patch[queue->count] = patch;
        queue->sample[queue->count++] = sample;
        if (queue->count == LMB_SIDE_SAMPLES) {
            queue_take(rows, queue);
        }
    }
}

/* Those of a patch's samples that see uneven patches. */
static void queue_patch_again(const lmb_light_rows *rows, sample_queue *queue, uint32_t patch, uint64_t *rays)
{
    for (size_t k = rows->row[patch]; k < rows->row[patch + 1]; ++k) {
        const lmb_link *link = &rows->links[k];
        if (lmb_link_weight(link) == 0 || !lmb_patch_is_uneven(rows->light, link->target)) {
            continue;
        }
        lmb_side_sample sample = sample_make(rows, patch, rays);
        sample_set(rows, patch, (uint32_t)(k - rows->row[patch]), &sample);
        sample.link = *link;
        queue->patch[queue->count] = patch;
        queue->sample[queue->count++] = sample;
        if (queue->count == LMB_SIDE_SAMPLES) {
            queue_correct(rows, queue);
        }
    }
}

static void rows_task(void *context, size_t task, int worker)
{
    (void)worker;
    const rows_work *work = context;
    const lmb_light_rows *rows = work->rows;
    const uint32_t first = (uint32_t)task * PATCHES_PER_TASK;
    const uint32_t end = first + PATCHES_PER_TASK < rows->patch_count ? first + PATCHES_PER_TASK : rows->patch_count;
    sample_queue queue;
    queue.count = 0;
    for (uint32_t patch = first; patch < end; ++patch) {
        if (work->corrects) {
            queue_patch_again(rows, &queue, patch, &work->rays[task]);
        } else {
            queue_patch(rows, &queue, patch, work->first, &work->rays[task]);
        }
    }
    if (work->corrects) {
        queue_correct(rows, &queue);
    } else {
        queue_take(rows, &queue);
    }
}

static lmb_result tasks_run(rows_work *work, const char *phase, lmb_pool *pool, const lmb_progress *progress)
{
    const size_t tasks = task_count(work->rows->patch_count);
    work->rays = calloc(tasks + 1, sizeof *work->rays);
    if (!work->rays) {
        return LMB_ERROR_MEMORY;
    }
    const lmb_result result = lmb_pool_run(pool, tasks, rows_task, work, phase, progress);
    for (size_t i = 0; i < tasks; ++i) {
        work->rows->rays += work->rays[i];
    }
    free(work->rays);
    return result;
}

static bool patch_sees_light(const lmb_light_rows *rows, const uint8_t *lit, uint32_t patch)
{
    bool sees = lmb_rgb_max(rows->direct[patch]) > 0.0f;
    for (size_t k = rows->row[patch]; k < rows->row[patch + 1] && !sees; ++k) {
        const lmb_link *link = &rows->links[k];
        sees = lit[link->target] && lmb_link_weight(link) > 0;
    }
    return sees;
}

/* Marks the patches that light reaches over any number of links, sweeping up and down until nothing changes. */
static uint32_t lit_mark(const lmb_light_rows *rows, uint8_t *lit)
{
    uint32_t count = 0;
    bool changed = true;
    for (int sweep = 0; changed; ++sweep) {
        changed = false;
        for (uint32_t i = 0; i < rows->patch_count; ++i) {
            const uint32_t patch = sweep % 2 == 0 ? i : rows->patch_count - 1 - i;
            if (!lit[patch] && patch_sees_light(rows, lit, patch)) {
                lit[patch] = 1;
                ++count;
                changed = true;
            }
        }
    }
    return count;
}

void lmb_light_rows_count_bytes(lmb_light_rows *rows, size_t links, size_t others)
{
    const size_t bytes = lmb_surface_light_bytes(rows->light) + links * sizeof *rows->links +
                         rows->patch_count * (sizeof *rows->direct + sizeof *rows->row) +
                         rows->light->cell_count * sizeof *rows->cell_samples + others;
    rows->most_bytes = bytes > rows->most_bytes ? bytes : rows->most_bytes;
}

/* Longer rows for lit patches, with the pilot's links at their beginnings, and none for dark ones. */
static lmb_result rows_extend(lmb_light_rows *rows, const uint8_t *lit)
{
    size_t count = 0;
    for (uint32_t patch = 0; patch < rows->patch_count; ++patch) {
        count += lit[patch] ? patch_samples(rows, patch) : 0;
    }
    lmb_link *links = malloc((count + 1) * sizeof *links);
    if (!links) {
        return LMB_ERROR_MEMORY;
    }
    lmb_light_rows_count_bytes(rows, count + rows->row[rows->patch_count],
                               rows->patch_count * sizeof *rows->open_direct);
    size_t pilot = 0;
    count = 0;
    for (uint32_t patch = 0; patch < rows->patch_count; ++patch) {
        rows->row[patch] = count;
        if (lit[patch]) {
            memcpy(links + count, rows->links + pilot, pilot_samples(rows, patch) * sizeof *links);
            count += patch_samples(rows, patch);
        }
        pilot += pilot_samples(rows, patch);
    }
    rows->row[rows->patch_count] = count;
    free(rows->links);
    rows->links = links;
    return LMB_OK;
}

static lmb_result rows_start(lmb_light_rows *rows)
{
    rows->patch_count = lmb_patch_count(rows->light);
    const size_t patches = (size_t)rows->patch_count + 1;
    rows->direct = calloc(patches, sizeof *rows->direct);
    rows->open_direct = calloc(patches, sizeof *rows->open_direct);
    rows->sun = calloc(patches, sizeof *rows->sun);
    rows->sun_least = malloc(patches * sizeof *rows->sun_least);
    rows->row = malloc(patches * sizeof *rows->row);
    size_t count = 0;
    for (uint32_t patch = 0; rows->row && rows->sun_least && patch < rows->patch_count; ++patch) {
        rows->sun_least[patch] = INFINITY;
        rows->row[patch] = count;
        count += pilot_samples(rows, patch);
    }
    rows->links = malloc((count + 1) * sizeof *rows->links);
    if (!rows->direct || !rows->open_direct || !rows->sun || !rows->sun_least || !rows->row || !rows->links) {
        return LMB_ERROR_MEMORY;
    }
    rows->row[rows->patch_count] = count;
    return LMB_OK;
}

static lmb_result lit_extend(lmb_light_rows *rows)
{
    uint8_t *lit = calloc((size_t)rows->patch_count + 1, sizeof *lit);
    if (!lit) {
        return LMB_ERROR_MEMORY;
    }
    rows->lit_patches = lit_mark(rows, lit);
    const lmb_result result = rows_extend(rows, lit);
    free(lit);
    return result;
}

/* Of a patch by its samples, the links from `begin` to `end`. */
static lmb_openness patch_openness(const lmb_link *begin, const lmb_link *end)
{
    const uint32_t open = lmb_links_open(begin, end);
    if (open == 0) {
        return LMB_CELL_HIDDEN;
    }
    if (begin + open == end) {
        return LMB_CELL_OPEN;
    }
    for (const lmb_link *link = begin; link < end && open < ENOUGH_OPEN_SAMPLES; ++link) {
        if ((float)lmb_link_weight(link) > WHITE * 65535.0f) {
            return LMB_CELL_HIDDEN;
        }
    }
    return LMB_CELL_MIXED;
}

static bool patch_is_shaded(const lmb_light_rows *rows, uint32_t patch, uint32_t samples)
{
    const float mean = lmb_luminance(rows->sun[patch]) / (float)samples;
    return rows->light->openness[patch] != LMB_CELL_MIXED && samples >= LMB_ROWS_PILOT_SAMPLES &&
           rows->sun_least[patch] < SHADED * mean;
}

/* Tells how open patches are, and which are uneven. */
static void patches_describe(lmb_light_rows *rows)
{
    lmb_surface_light *light = rows->light;
    bool any = false;
    for (uint32_t patch = 0; patch < rows->patch_count; ++patch) {
        const size_t begin = rows->row[patch], end = rows->row[patch + 1];
        light->openness[patch] = (uint8_t)patch_openness(rows->links + begin, rows->links + end);
        const uint32_t samples = (uint32_t)(end - begin);
        /* Where reflections are counted, what is stored has as many as it may have. */
        const bool uneven = rows->transport->bounces < 0 && samples > 0 && patch_is_shaded(rows, patch, samples);
        rows->sun[patch] = lmb_rgb_scale(rows->sun[patch], uneven ? 1.0f / (float)samples : 0.0f);
        any = any || uneven;
    }
    if (any) {
        light->sun = rows->sun;
        rows->sun = NULL;
    }
}

lmb_result lmb_light_rows_sample(lmb_light_rows *rows, uint32_t samples, lmb_pool *pool, const lmb_progress *progress)
{
    rows->cell_samples = malloc(((size_t)rows->light->cell_count + 1) * sizeof *rows->cell_samples);
    if (!rows->cell_samples) {
        return LMB_ERROR_MEMORY;
    }
    cell_samples_set(rows, samples);
    rows_work work = {.rows = rows};
    lmb_result result = rows_start(rows);
    if (result == LMB_OK) {
        result = tasks_run(&work, "surface pilot", pool, progress);
    }
    if (result == LMB_OK) {
        result = lit_extend(rows);
    }
    if (result == LMB_OK) {
        work.first = LMB_ROWS_PILOT_SAMPLES;
        result = tasks_run(&work, "surface", pool, progress);
    }
    if (result == LMB_OK) {
        patches_describe(rows);
        work.corrects = true;
        result = rows->light->sun ? tasks_run(&work, "surface", pool, NULL) : LMB_OK;
    }
    return result;
}

void lmb_light_rows_free(lmb_light_rows *rows)
{
    free(rows->direct);
    free(rows->open_direct);
    free(rows->sun);
    free(rows->sun_least);
    free(rows->row);
    free(rows->cell_samples);
    free(rows->links);
}
