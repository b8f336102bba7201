/* Solving E = D + T E: direct light D and the transport T by samples, then the bounces by multiplying. */
#include "surface_light_internal.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/sequence.h>

#include "bake_internal.h"
#include "surface_light_bounce.h"
#include "surface_light_sample.h"

enum { SIDES_PER_TASK = 128 };

/* The first samples of a side, to learn whether any light can reach it. One that sees only dark sides by all of them,
 * as insides of solids do, gets no more and stays dark. */
enum { PILOT_SAMPLES = 4 };

/* At least, of a side whose cell is less than half as long as cells can be. Long thin ones get the pilot's: they lie in
 * gaps, where few samples may all see each other's cells, which then never let go of the light. */
enum { SMALL_SAMPLES = 2 };

/* For a side whose cell is about as large as cells can be. */
enum { ENOUGH_SAMPLES = 8 };

/* The light of a cell that is partly in a gap is that of its open part, if enough samples show that part. Fewer may all
 * see each other's cells: what reflects more than WHITE of the light then hardly ever lets go of it. */
enum { ENOUGH_OPEN_SAMPLES = 4 };
#define WHITE 0.9f

/* Streams of cells are apart from those of gather points. */
#define STREAM_OF_CELLS UINT64_C(0x73757266616365)

/* Of sides that stay dark. */
#define NO_PLACE UINT32_MAX

typedef struct solve_work {
    const lmb_transport *transport;
    lmb_surface_light *light;
    uint32_t side_count;
    uint32_t *cell_samples; /* [cell] that each of its sides is to get, if it is lit */
    uint32_t first_sample;  /* of the samples to be taken now */
    lmb_rgb *direct;        /* [side] sum over its samples */
    lmb_rgb *open_direct;   /* [side] over those that are open */
    size_t *row;            /* [side] its first link, and the count at its end; a row is as long as it has samples */
    lmb_link *links;        /* their targets are sides */
    uint64_t *rays;         /* [task] */
    size_t most_bytes;
} solve_work;

static size_t task_count(uint32_t side_count)
{
    return ((size_t)side_count + SIDES_PER_TASK - 1) / SIDES_PER_TASK;
}

/* All samples when a cell is about as large as cells can be, fewer for small ones, whose neighbours are seen beside
 * them. */
static void cell_samples_set(const solve_work *work, uint32_t samples)
{
    const lmb_surface_light *light = work->light;
    const float full_area = 0.25f * light->cell_size * light->cell_size;
    for (uint32_t i = 0; i < light->instance_count; ++i) {
        for (uint32_t t = light->triangle_first[i]; t < light->triangle_first[i + 1]; ++t) {
            const bool small = light->grid[t].cell_size < 0.5f * light->cell_size;
            const uint32_t least = small ? SMALL_SAMPLES : PILOT_SAMPLES;
            lmb_cell cell = {i, t - light->triangle_first[i], 0, &light->grid[t]};
            for (; cell.grid->first + cell.number < cell.grid[1].first; ++cell.number) {
                const float share = fminf(lmb_cell_area(&cell, work->transport->tracer) / full_area, 1.0f);
                const uint32_t wanted = share > 0.0f ? (uint32_t)ceilf((float)samples * share) : 0;
                work->cell_samples[cell.grid->first + cell.number] = wanted > least ? wanted : least;
            }
        }
    }
}

static uint32_t pilot_samples(const solve_work *work, uint32_t side)
{
    const uint32_t samples = work->cell_samples[side / 2];
    return samples < PILOT_SAMPLES ? samples : PILOT_SAMPLES;
}

static uint64_t side_stream(const solve_work *work, const lmb_cell *cell, uint32_t side)
{
    const uint64_t instance = lmb_mix(work->transport->seed ^ STREAM_OF_CELLS, cell->instance);
    return lmb_mix(lmb_mix(instance, cell->triangle), 2 * (uint64_t)cell->number + (side & 1));
}

/* Samples that wait until there are enough to be taken together. */
typedef struct side_queue {
    uint32_t count;
    uint32_t side[LMB_SIDE_SAMPLES];
    lmb_side_sample sample[LMB_SIDE_SAMPLES];
} side_queue;

static void queue_take(const solve_work *work, side_queue *queue)
{
    if (queue->count == 0) {
        return;
    }
    lmb_side_samples_take(work->light, queue->sample, queue->count);
    for (uint32_t i = 0; i < queue->count; ++i) {
        const lmb_side_sample *sample = &queue->sample[i];
        const uint32_t side = queue->side[i];
        work->links[work->row[side] + sample->path.sample] = sample->link;
        work->direct[side] = rgb_add(work->direct[side], sample->direct);
        if (sample->link.open) {
            work->open_direct[side] = rgb_add(work->open_direct[side], sample->direct);
        }
    }
    queue->count = 0;
}

static void queue_side(const solve_work *work, side_queue *queue, uint32_t side, uint32_t samples, uint64_t *rays)
{
    const lmb_cell cell = lmb_cell_find(work->light, side / 2);
    lmb_path path = {.transport = work->transport, .stream = side_stream(work, &cell, side), .rays = rays};
    for (path.sample = work->first_sample; path.sample < samples; ++path.sample) {
        queue->side[queue->count] = side;
        queue->sample[queue->count++] = (lmb_side_sample){.path = path, .cell = cell, .front = side % 2 == 0};
        if (queue->count == LMB_SIDE_SAMPLES) {
            queue_take(work, queue);
        }
    }
}

static void sides_task(void *context, size_t task, int worker)
{
    (void)worker;
    const solve_work *work = context;
    const uint32_t first = (uint32_t)task * SIDES_PER_TASK;
    const uint32_t end = first + SIDES_PER_TASK < work->side_count ? first + SIDES_PER_TASK : work->side_count;
    side_queue queue;
    queue.count = 0;
    for (uint32_t side = first; side < end; ++side) {
        const uint32_t samples = (uint32_t)(work->row[side + 1] - work->row[side]);
        if (samples > work->first_sample) {
            queue_side(work, &queue, side, samples, &work->rays[task]);
        }
    }
    queue_take(work, &queue);
}

static bool side_sees_light(const solve_work *work, const uint8_t *lit, uint32_t side)
{
    bool sees = rgb_max(work->direct[side]) > 0.0f;
    for (size_t k = work->row[side]; k < work->row[side + 1] && !sees; ++k) {
        const lmb_link *link = &work->links[k];
        sees = lit[link->target] && lmb_link_weight(link) > 0;
    }
    return sees;
}

/* Marks the sides that light reaches over any number of links, sweeping up and down until nothing changes. */
static uint32_t lit_mark(const solve_work *work, uint8_t *lit)
{
    uint32_t count = 0;
    bool changed = true;
    for (int sweep = 0; changed; ++sweep) {
        changed = false;
        for (uint32_t i = 0; i < work->side_count; ++i) {
            const uint32_t side = sweep % 2 == 0 ? i : work->side_count - 1 - i;
            if (!lit[side] && side_sees_light(work, lit, side)) {
                lit[side] = 1;
                ++count;
                changed = true;
            }
        }
    }
    return count;
}

static void bytes_count(solve_work *work, size_t links, size_t extra)
{
    const size_t bytes = lmb_surface_light_bytes(work->light) + links * sizeof *work->links +
                         work->side_count * (sizeof *work->direct + sizeof *work->row) +
                         work->side_count / 2 * sizeof *work->cell_samples + extra;
    work->most_bytes = bytes > work->most_bytes ? bytes : work->most_bytes;
}

/* Longer rows for lit sides, with the pilot's links at their beginnings, and none for dark ones. */
static lmb_result rows_extend(solve_work *work, const uint8_t *lit)
{
    size_t count = 0;
    for (uint32_t side = 0; side < work->side_count; ++side) {
        count += lit[side] ? work->cell_samples[side / 2] : 0;
    }
    lmb_link *links = malloc((count + 1) * sizeof *links);
    if (!links) {
        return LMB_ERROR_MEMORY;
    }
    bytes_count(work, count + work->row[work->side_count], work->side_count * sizeof *work->open_direct);
    size_t pilot = 0;
    count = 0;
    for (uint32_t side = 0; side < work->side_count; ++side) {
        work->row[side] = count;
        if (lit[side]) {
            memcpy(links + count, work->links + pilot, pilot_samples(work, side) * sizeof *links);
            count += work->cell_samples[side / 2];
        }
        pilot += pilot_samples(work, side);
    }
    work->row[work->side_count] = count;
    free(work->links);
    work->links = links;
    return LMB_OK;
}

/* Returns how many links they are. */
static size_t rows_start(solve_work *work)
{
    size_t count = 0;
    for (uint32_t side = 0; side < work->side_count; ++side) {
        work->row[side] = count;
        count += pilot_samples(work, side);
    }
    work->row[work->side_count] = count;
    return count;
}

static lmb_result work_sample(solve_work *work, lmb_pool *pool, const lmb_progress *progress,
                              lmb_surface_light_stats *stats)
{
    const size_t tasks = task_count(work->side_count);
    lmb_result result = lmb_pool_run(pool, tasks, sides_task, work, "surface pilot", progress);
    uint8_t *lit = calloc(work->side_count + 1u, sizeof *lit);
    if (result == LMB_OK) {
        result = lit ? LMB_OK : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        stats->lit_sides = lit_mark(work, lit);
        result = rows_extend(work, lit);
    }
    free(lit);
    if (result == LMB_OK) {
        work->first_sample = PILOT_SAMPLES;
        result = lmb_pool_run(pool, tasks, sides_task, work, "surface", progress);
    }
    for (size_t i = 0; i < tasks; ++i) {
        stats->rays += work->rays[i];
    }
    return result;
}

/* Numbers the lit sides from 0 without gaps, and gives how many there are. */
static uint32_t places_number(const solve_work *work, uint32_t *place)
{
    uint32_t count = 0;
    for (uint32_t side = 0; side < work->side_count; ++side) {
        place[side] = work->row[side] < work->row[side + 1] ? count++ : NO_PLACE;
    }
    return count;
}

/* Of a side by its samples, the links from `begin` to `end`, of which `open` are open. */
static lmb_openness side_openness(const lmb_link *begin, const lmb_link *end, uint32_t open)
{
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

static uint32_t open_count(const lmb_link *begin, const lmb_link *end)
{
    uint32_t count = 0;
    for (const lmb_link *link = begin; link < end; ++link) {
        count += link->open;
    }
    return count;
}

/* Moves what the sides have to their places: the links that see something lit, of mixed sides only those of open
 * samples. `samples` has room for every place. */
static lmb_bounce_rows rows_compact(solve_work *work, const uint32_t *place, float *samples)
{
    lmb_bounce_rows rows = {.first = work->row, .samples = samples, .light = work->direct};
    size_t kept = 0, begin = 0;
    for (uint32_t side = 0; side < work->side_count; ++side) {
        const size_t end = work->row[side + 1];
        if (place[side] != NO_PLACE) {
            const uint32_t open = open_count(work->links + begin, work->links + end);
            const lmb_openness openness = side_openness(work->links + begin, work->links + end, open);
            const bool mixed = openness == LMB_CELL_MIXED;
            const lmb_rgb direct = mixed ? work->open_direct[side] : work->direct[side];
            work->light->openness[side] = (uint8_t)openness;
            work->row[rows.count] = kept;
            for (size_t k = begin; k < end; ++k) {
                lmb_link link = work->links[k];
                link.target = place[link.target];
                if (link.target != NO_PLACE && lmb_link_weight(&link) > 0 && (link.open || !mixed)) {
                    work->links[kept++] = link;
                }
            }
            samples[rows.count] = mixed ? (float)open : (float)(end - begin);
            work->direct[rows.count] = rgb_scale(direct, 1.0f / samples[rows.count]);
            ++rows.count;
        }
        begin = end;
    }
    work->row[rows.count] = kept;
    lmb_link *shorter = realloc(work->links, (kept + 1) * sizeof *shorter);
    work->links = shorter ? shorter : work->links;
    rows.links = work->links;
    return rows;
}

static lmb_result work_bounce(solve_work *work, lmb_pool *pool, const lmb_progress *progress, int *passes)
{
    const int bounces = work->transport->bounces;
    uint32_t *place = malloc((work->side_count + 1u) * sizeof *place);
    const uint32_t count = place ? places_number(work, place) : 0;
    float *samples = malloc((count + 1u) * sizeof *samples);
    lmb_result result = LMB_ERROR_MEMORY;
    if (place && samples) {
        bytes_count(work, work->row[work->side_count],
                    work->side_count * sizeof *place + count * sizeof *samples + lmb_bounces_bytes(count));
        const lmb_bounce_rows rows = rows_compact(work, place, samples);
        free(work->open_direct);
        work->open_direct = NULL;
        /* The last bounce is that on the surface that is looked at. */
        result = lmb_bounces_sum(&rows, bounces < 0 ? -1 : bounces - 1, pool, progress, passes);
        for (uint32_t side = 0; side < work->side_count; ++side) {
            work->light->irradiance[side] = place[side] != NO_PLACE ? rows.light[place[side]] : rgb(0.0f, 0.0f, 0.0f);
        }
    }
    free(place);
    free(samples);
    return result;
}

static lmb_result work_run(solve_work *work, uint32_t samples, lmb_pool *pool, const lmb_progress *progress,
                           lmb_surface_light_stats *stats)
{
    const size_t sides = (size_t)work->side_count + 1;
    work->direct = calloc(sides, sizeof *work->direct);
    work->open_direct = calloc(sides, sizeof *work->open_direct);
    work->row = malloc(sides * sizeof *work->row);
    work->cell_samples = malloc(sides / 2 * sizeof *work->cell_samples);
    work->rays = calloc(task_count(work->side_count) + 1, sizeof *work->rays);
    if (!work->direct || !work->open_direct || !work->row || !work->cell_samples || !work->rays) {
        return LMB_ERROR_MEMORY;
    }
    cell_samples_set(work, samples);
    work->links = malloc((rows_start(work) + 1) * sizeof *work->links);
    if (!work->links) {
        return LMB_ERROR_MEMORY;
    }
    lmb_result result = lmb_surface_light_find_albedos(work->light, work->transport->tracer, pool);
    if (result == LMB_OK) {
        result = work_sample(work, pool, progress, stats);
    }
    return result == LMB_OK ? work_bounce(work, pool, progress, &stats->passes) : result;
}

lmb_result lmb_surface_light_solve(const lmb_transport *transport, const lmb_surface_light_settings *settings,
                                   lmb_pool *pool, const lmb_progress *progress, lmb_surface_light **light,
                                   lmb_surface_light_stats *stats, lmb_error *error)
{
    lmb_surface_light *created;
    lmb_result result = lmb_surface_light_create(transport->tracer, settings, &created, error);
    if (result != LMB_OK) {
        return result;
    }
    lmb_surface_light_stats made = {.cells = created->cell_count};
    lmb_transport solving = *transport;
    solving.surface = created; /* of which the albedos are known */
    solve_work work = {.transport = &solving, .light = created, .side_count = 2 * created->cell_count};
    bytes_count(&work, 0, 0);
    /* Without reflections nobody looks at what surfaces receive. */
    if (transport->bounces != 0 && work.side_count > 0) {
        result = work_run(&work, settings->samples > 0 ? settings->samples : ENOUGH_SAMPLES, pool, progress, &made);
    }
    made.bytes_solving = work.most_bytes;
    free(work.direct);
    free(work.open_direct);
    free(work.row);
    free(work.cell_samples);
    free(work.links);
    free(work.rays);
    if (result == LMB_OK) {
        result = lmb_surface_light_reflect(created, pool);
    }
    if (result == LMB_OK && !settings->bright_by_chance) {
        result = lmb_bright_cells_create(created, transport->tracer, &created->bright);
    }
    if (result != LMB_OK) {
        lmb_surface_light_destroy(created);
        return lmb_error_set(error, result, "surface light: %s", lmb_result_text(result));
    }
    *light = created;
    *stats = made;
    return LMB_OK;
}
