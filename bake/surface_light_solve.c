/* Solving E = D + T E: direct light D and the transport T by samples, then the bounces by multiplying. */
#include "surface_light_internal.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/sequence.h>

#include "bake_internal.h"
#include "leg.h"

enum { SIDES_PER_TASK = 128, ROWS_PER_TASK = 4096 };

/* Samples that every side gets, to learn whether any light can reach it. One that sees only dark sides by all of them,
 * as insides of solids do, gets no more and stays dark. */
enum { PILOT_SAMPLES = 4 };

/* The solution stands still when by the mean over the cells all further bounces together would add less than the first
 * share of a cell's light, or one bounce less than the second: then only light that is trapped between white surfaces,
 * as within a lamp, can go on for long. It counts relative to each cell, or a few such would keep all waiting. */
#define STILL_TAIL 2.5e-4
#define STILL_BOUNCE 5e-5
/* The most passes: those that multiply with LINKS_IN_ALL links together, within these bounds. */
enum { MIN_PASSES = 128, MAX_PASSES = 2000, LINKS_IN_ALL = 400000000 };

/* Streams of cells are apart from those of gather points. */
#define STREAM_OF_CELLS UINT64_C(0x73757266616365)

/* What one sample of a side sees: part of one row of T. */
typedef struct lmb_link {
    uint32_t target;    /* side */
    uint16_t weight[3]; /* albedo and tint in 1/65535; 0 when the sample sees nothing that reflects */
    uint16_t open;      /* what the sample counts, in 1/OPEN */
} lmb_link;

/* A sample counts OPEN when a ray of the cell's size gets away from it, else HIDDEN: next to nothing, unless all of the
 * cell's samples are. */
enum { OPEN = 1024, HIDDEN = 1 };

typedef struct solve_work {
    const lmb_transport *transport;
    lmb_surface_light *light;
    uint32_t samples;
    uint32_t side_count;
    uint32_t first_sample; /* of the samples to be taken now */
    lmb_rgb *direct;       /* [side] sum over its samples, by what they count; then the mean */
    float *open;           /* [side] sum of what its samples count */
    size_t *row;           /* [side] its first link, and the count at its end; a row is as long as it has samples */
    lmb_link *links;
    uint64_t *rays;      /* [task] */
    lmb_rgb *next;       /* [side] what the bounces at hand add up to */
    double (*change)[2]; /* [task] sum of relative changes over the rows, by their samples, and of these */
    size_t most_bytes;
} solve_work;

static size_t task_count(uint32_t count, uint32_t per_task)
{
    return ((size_t)count + per_task - 1) / per_task;
}

static uint64_t side_stream(const solve_work *work, const lmb_cell *cell, uint32_t side)
{
    const uint64_t instance = lmb_mix(work->transport->seed ^ STREAM_OF_CELLS, cell->instance);
    return lmb_mix(lmb_mix(instance, cell->triangle), 2 * (uint64_t)cell->number + (side & 1));
}

static void link_weigh(lmb_link *link, lmb_rgb weight)
{
    for (int c = 0; c < 3; ++c) {
        link->weight[c] = (uint16_t)(fminf(fmaxf(weight.c[c], 0.0f), 1.0f) * 65535.0f + 0.5f);
    }
}

/* Whether a ray from the start of a sample gets as far as the cell is large. It has a direction of its own: the one by
 * which the sample finds light would count more often the brighter what it sees. */
static bool sample_is_open(const lmb_path *path, const lmb_receiver *receiver, float cell_size)
{
    float numbers[2];
    lmb_path_numbers(path, PAIRS_PER_VERTEX + PAIR_ENVIRONMENT, numbers);
    const lmb_vec3 direction = lmb_receiver_direction(receiver, numbers);
    if (!lmb_receiver_sees(receiver, direction)) {
        return false;
    }
    const lmb_vec3 origin = lmb_receiver_ray_origin(receiver, direction);
    const lmb_vec3 end = vec3_mad(origin, direction, cell_size);
    return rgb_max(lmb_trace_transmittance(path->transport->tracer, origin, end, path->rays)) > 0.0f;
}

/* One sample of a side: a point of its cell, the direct light there, and what a ray from there sees. */
static lmb_rgb side_sample(const solve_work *work, const lmb_cell *cell, const lmb_path *path, bool front,
                           lmb_link *link)
{
    const lmb_transport *transport = work->transport;
    float numbers[2], u, v;
    lmb_path_numbers(path, PAIRS_PER_VERTEX + PAIR_DIRECTION, numbers);
    lmb_cell_point(cell, numbers, &u, &v);
    const lmb_place place = lmb_trace_place(transport->tracer, cell->instance, cell->triangle, u, v);
    const lmb_receiver receiver = lmb_receiver_on_surface(&place, front);
    lmb_direct_light found;
    lmb_direct_collect(path, &receiver, &found);
    lmb_rgb direct = rgb(0.0f, 0.0f, 0.0f);
    for (int i = 0; i < found.count; ++i) {
        direct = rgb_add(direct, found.weight[i]);
    }
    *link = (lmb_link){.open = sample_is_open(path, &receiver, cell->grid->cell_size) ? OPEN : HIDDEN};
    lmb_path_numbers(path, PAIR_DIRECTION, numbers);
    const lmb_vec3 direction = lmb_receiver_direction(&receiver, numbers);
    if (lmb_receiver_sees(&receiver, direction)) {
        lmb_leg leg = {&receiver, lmb_receiver_ray_origin(&receiver, direction), direction, {{1.0f, 1.0f, 1.0f}}};
        const lmb_landing landing = lmb_leg_follow(path, &leg);
        direct = rgb_add(direct, rgb_mul(leg.throughput, landing.emitted));
        if (landing.on_surface && rgb_max(landing.albedo) > 0.0f) {
            link->target = lmb_surface_light_side(work->light, &landing.hit, landing.hit.front);
            link_weigh(link, rgb_mul(leg.throughput, landing.albedo));
        }
    }
    return rgb_is_finite(direct) ? direct : rgb(0.0f, 0.0f, 0.0f);
}

static void sides_task(void *context, size_t task, int worker)
{
    (void)worker;
    const solve_work *work = context;
    const uint32_t first = (uint32_t)task * SIDES_PER_TASK;
    const uint32_t end = first + SIDES_PER_TASK < work->side_count ? first + SIDES_PER_TASK : work->side_count;
    for (uint32_t side = first; side < end; ++side) {
        const uint32_t count = (uint32_t)(work->row[side + 1] - work->row[side]);
        if (count <= work->first_sample) {
            continue;
        }
        const lmb_cell cell = lmb_cell_find(work->light, side / 2);
        lmb_path path = {
            .transport = work->transport, .stream = side_stream(work, &cell, side), .rays = &work->rays[task]};
        for (path.sample = work->first_sample; path.sample < count; ++path.sample) {
            lmb_link *link = &work->links[work->row[side] + path.sample];
            const lmb_rgb direct = side_sample(work, &cell, &path, side % 2 == 0, link);
            work->direct[side] = rgb_add(work->direct[side], rgb_scale(direct, (float)link->open));
            work->open[side] += (float)link->open;
        }
    }
}

static bool side_sees_light(const solve_work *work, const uint8_t *lit, uint32_t side)
{
    bool sees = rgb_max(work->direct[side]) > 0.0f;
    for (size_t k = work->row[side]; k < work->row[side + 1] && !sees; ++k) {
        const lmb_link *link = &work->links[k];
        sees = lit[link->target] && (link->weight[0] | link->weight[1] | link->weight[2]) != 0;
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

/* How many samples a cell gets: all when it is about as large as cells can be, fewer for small ones, whose neighbours
 * are seen beside them. */
static uint32_t cell_samples(const solve_work *work, uint32_t number)
{
    const lmb_cell cell = lmb_cell_find(work->light, number);
    lmb_vec3 corner[3];
    lmb_trace_corners(work->transport->tracer, cell.instance, cell.triangle, corner);
    const float area = 0.5f * vec3_length(vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0])));
    const float full_area = 0.25f * work->light->cell_size * work->light->cell_size;
    const float share = fminf(area * lmb_cell_area_share(&cell) / full_area, 1.0f);
    const uint32_t samples = share > 0.0f ? (uint32_t)ceilf((float)work->samples * share) : 0;
    return samples > PILOT_SAMPLES ? samples : PILOT_SAMPLES;
}

static void bytes_count(solve_work *work, size_t links)
{
    const size_t bytes = lmb_surface_light_bytes(work->light) + links * sizeof *work->links +
                         work->side_count * (2 * sizeof *work->direct + sizeof *work->open + sizeof *work->row);
    work->most_bytes = bytes > work->most_bytes ? bytes : work->most_bytes;
}

/* Longer rows for lit sides, with the pilot's links at their beginnings, and none for dark ones. */
static lmb_result rows_extend(solve_work *work, const uint8_t *lit)
{
    size_t count = 0;
    for (uint32_t side = 0; side < work->side_count; ++side) {
        work->row[side] = count;
        count += lit[side] ? cell_samples(work, side / 2) : 0;
    }
    work->row[work->side_count] = count;
    lmb_link *links = malloc((count + 1) * sizeof *links);
    if (!links) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t side = 0; side < work->side_count; ++side) {
        if (lit[side]) {
            memcpy(links + work->row[side], work->links + (size_t)PILOT_SAMPLES * side, PILOT_SAMPLES * sizeof *links);
        }
    }
    bytes_count(work, count + (size_t)PILOT_SAMPLES * work->side_count);
    free(work->links);
    work->links = links;
    return LMB_OK;
}

static lmb_result work_sample(solve_work *work, lmb_pool *pool, const lmb_progress *progress,
                              lmb_surface_light_stats *stats)
{
    const size_t tasks = task_count(work->side_count, SIDES_PER_TASK);
    for (uint32_t side = 0; side <= work->side_count; ++side) {
        work->row[side] = (size_t)PILOT_SAMPLES * side;
    }
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

static void rows_task(void *context, size_t task, int worker)
{
    (void)worker;
    const solve_work *work = context;
    const lmb_rgb *now = work->light->irradiance;
    const uint32_t first = (uint32_t)task * ROWS_PER_TASK;
    const uint32_t end = first + ROWS_PER_TASK < work->side_count ? first + ROWS_PER_TASK : work->side_count;
    double change = 0.0;
    double total = 0.0;
    for (uint32_t side = first; side < end; ++side) {
        const size_t samples = work->row[side + 1] - work->row[side];
        if (samples == 0) {
            continue;
        }
        lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
        for (size_t k = work->row[side]; k < work->row[side + 1]; ++k) {
            const lmb_link *link = &work->links[k];
            for (int c = 0; c < 3; ++c) {
                sum.c[c] += (float)((uint32_t)link->weight[c] * link->open) * now[link->target].c[c];
            }
        }
        const lmb_rgb found = rgb_add(work->direct[side], rgb_scale(sum, 1.0f / (65535.0f * work->open[side])));
        const double light = (double)found.c[0] + (double)found.c[1] + (double)found.c[2];
        double added = 0.0;
        for (int c = 0; c < 3; ++c) {
            added += fabs((double)found.c[c] - (double)now[side].c[c]);
        }
        change += light > 0.0 ? (double)samples * added / light : 0.0;
        total += (double)samples;
        work->next[side] = found;
    }
    work->change[task][0] = change;
    work->change[task][1] = total;
}

/* Bounces that follow the one at hand are taken to shrink as it did beside the one before: a geometric series. */
static bool stands_still(double change, double before)
{
    const double ratio = before > 0.0 ? change / before : 1.0;
    return change <= STILL_BOUNCE || (ratio < 1.0 && change * ratio / (1.0 - ratio) <= STILL_TAIL);
}

static int passes_most(size_t links)
{
    const size_t passes = LINKS_IN_ALL / (links + 1);
    return passes < MIN_PASSES ? MIN_PASSES : passes < MAX_PASSES ? (int)passes : MAX_PASSES;
}

static lmb_result work_bounce(solve_work *work, lmb_pool *pool, const lmb_progress *progress, int *passes)
{
    const size_t tasks = task_count(work->side_count, ROWS_PER_TASK);
    const int bounces = work->transport->bounces;
    const int most = passes_most(work->row[work->side_count]);
    const int limit = bounces >= 0 && bounces - 1 < most ? bounces - 1 : most;
    lmb_surface_light *light = work->light;
    memcpy(light->irradiance, work->direct, work->side_count * sizeof *light->irradiance);
    double before = 0.0;
    bool still = false;
    for (*passes = 0; *passes < limit && !still; ++*passes) {
        const lmb_result result = lmb_pool_run(pool, tasks, rows_task, work, "bounces", progress);
        if (result != LMB_OK) {
            return result;
        }
        double change = 0.0;
        double total = 0.0;
        for (size_t i = 0; i < tasks; ++i) {
            change += work->change[i][0];
            total += work->change[i][1];
        }
        lmb_rgb *const swapped = light->irradiance;
        light->irradiance = work->next;
        work->next = swapped;
        change = total > 0.0 ? change / total : 0.0;
        still = stands_still(change, before);
        before = change;
    }
    return LMB_OK;
}

/* Sums over samples become means. */
static void direct_average(solve_work *work)
{
    for (uint32_t side = 0; side < work->side_count; ++side) {
        if (work->open[side] > 0.0f) {
            work->direct[side] = rgb_scale(work->direct[side], 1.0f / work->open[side]);
        }
    }
}

static lmb_result work_run(solve_work *work, lmb_pool *pool, const lmb_progress *progress,
                           lmb_surface_light_stats *stats)
{
    const size_t sides = (size_t)work->side_count + 1;
    work->direct = calloc(sides, sizeof *work->direct);
    work->open = calloc(sides, sizeof *work->open);
    work->next = calloc(sides, sizeof *work->next);
    work->row = malloc(sides * sizeof *work->row);
    work->links = malloc(PILOT_SAMPLES * sides * sizeof *work->links);
    work->rays = calloc(task_count(work->side_count, SIDES_PER_TASK) + 1, sizeof *work->rays);
    work->change = calloc(task_count(work->side_count, ROWS_PER_TASK) + 1, sizeof *work->change);
    if (!work->direct || !work->open || !work->next || !work->row || !work->links || !work->rays || !work->change) {
        return LMB_ERROR_MEMORY;
    }
    lmb_result result = work_sample(work, pool, progress, stats);
    if (result == LMB_OK) {
        direct_average(work);
        result = work_bounce(work, pool, progress, &stats->passes);
    }
    return result;
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
    solve_work work = {
        .transport = transport, .light = created, .samples = settings->samples, .side_count = 2 * created->cell_count};
    bytes_count(&work, 0);
    /* Without reflections nobody looks at what surfaces receive. */
    if (transport->bounces != 0 && work.side_count > 0) {
        result = work_run(&work, pool, progress, &made);
    }
    made.bytes_solving = work.most_bytes;
    free(work.direct);
    free(work.open);
    free(work.next);
    free(work.row);
    free(work.links);
    free(work.rays);
    free(work.change);
    if (result != LMB_OK) {
        lmb_surface_light_destroy(created);
        return lmb_error_set(error, result, "surface light: %s", lmb_result_text(result));
    }
    lmb_surface_light_reflect(created, transport->tracer);
    *light = created;
    *stats = made;
    return LMB_OK;
}
