/* Cells that something stands on, a wall most of all: one mean over both of its sides would let light through it. */
#include "solve/surface_divide.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/surface.h>
#include <lambent/vector.h>

#include "solve/side_sample.h"
#include "trace/trace_internal.h"

enum { SIDES_PER_TASK = 512 };

/* Shares of a cell's length: how far off the surface and off the cell's edges the rays run that look for what divides
 * it. Walls begin at the very edge of most floors. */
#define LIFT_SHARE (1.0f / 64.0f)
#define INSET_SHARE 0.02f

/* Below this share of the longest cell's length a side is no longer divided, but a hole: time against the huts of
 * test_dark_places. What a torch hangs on may well be small, and is aimed at only if it has light. */
#define HOLE_SHARE 0.12f

/* A plane figure: the cell, off the surface on one side. */
typedef struct side_frame {
    lmb_cell cell;
    lmb_cell_part part;
    lmb_vec3 corner[3];
    lmb_vec3 off;  /* from the surface to a point just off it */
    lmb_vec3 lift; /* and to one a little higher */
} side_frame;

static side_frame side_frame_of(const lmb_surface_light *light, const lmb_tracer *tracer, uint32_t side)
{
    side_frame frame = {.cell = lmb_cell_find(light, side / 2)};
    frame.part = lmb_cell_part_of(&frame.cell);
    lmb_trace_corners(tracer, frame.cell.instance, frame.cell.triangle, frame.corner);
    const lmb_place place = lmb_trace_place(
        tracer, &(lmb_hit){.instance = frame.cell.instance, .triangle = frame.cell.triangle, .u = 0.0f, .v = 0.0f});
    const float sign = side % 2 == 0 ? 1.0f : -1.0f;
    frame.off = lmb_vec3_scale(place.geometric_normal, sign * place.rounding);
    frame.lift = lmb_vec3_scale(place.geometric_normal,
                                sign * lmb_larger(LIFT_SHARE * frame.cell.grid->cell_size, 2.0f * place.rounding));
    return frame;
}

/* A point of the cell's triangle: how far along from the apex, and how far across. */
static lmb_vec3 frame_point(const side_frame *frame, float along, float across)
{
    const uint32_t apex = frame->cell.grid->apex;
    const lmb_vec3 start = lmb_vec3_scale(frame->corner[apex], 1.0f - along);
    return lmb_vec3_mad(lmb_vec3_mad(start, frame->corner[(apex + 1) % 3], along * (1.0f - across)),
                        frame->corner[(apex + 2) % 3], along * across);
}

/* Whatever divides a cell crosses two of its edges, so that all but one of them do. */
static void rays_across_add(lmb_ray_batch *rays, const side_frame *frame)
{
    static const int ends[3][2] = {{0, 2}, {1, 3}, {2, 3}};
    lmb_vec3 point[4];
    for (int i = 0; i < 4; ++i) {
        const float along = i / 2 ? 1.0f - INSET_SHARE : INSET_SHARE;
        const float across = i % 2 ? 1.0f - INSET_SHARE : INSET_SHARE;
        const lmb_vec3 on = frame_point(frame, (frame->part.strip + along) / frame->part.strips,
                                        (frame->part.column + across) / frame->part.columns);
        point[i] = lmb_vec3_add(on, frame->lift);
    }
    const int count = frame->part.strip > 0.0f ? 3 : 2; /* beside the apex the fourth has no length */
    for (int i = 0; i < count; ++i) {
        const lmb_vec3 from = point[ends[i][0]];
        lmb_ray_batch_add(rays, from, lmb_vec3_sub(point[ends[i][1]], from), LMB_TRACE_UP_TO_END);
    }
}

/* Pieces of the sides of one task. */
typedef struct piece_list {
    lmb_cell_piece *piece; /* one without starts: a hole */
    uint32_t count, capacity;
    uint64_t rays;
    bool failed; /* no memory */
} piece_list;

typedef struct pieces_work {
    const lmb_transport *transport;
    lmb_surface_light *light;
    piece_list *lists; /* [task] */
} pieces_work;

static void list_add(piece_list *list, const lmb_cell_piece *piece)
{
    if (list->count == list->capacity) {
        const uint32_t capacity = list->capacity ? 2 * list->capacity : 64;
        lmb_cell_piece *grown = realloc(list->piece, capacity * sizeof *grown);
        if (!grown) {
            list->failed = true;
            return;
        }
        list->piece = grown;
        list->capacity = capacity;
    }
    list->piece[list->count++] = *piece;
}

/* The point that stands for a start: higher than the surface, unless something lies on that. */
static lmb_vec3 point_of_start(const lmb_tracer *tracer, const side_frame *frame, lmb_vec3 start, uint64_t *rays)
{
    const lmb_vec3 low = lmb_vec3_add(start, frame->off);
    const lmb_vec3 high = lmb_vec3_add(start, frame->lift);
    return lmb_rgb_max(lmb_trace_transmittance(tracer, low, high, rays)) > LMB_PIECE_OPEN_SHARE ? high : low;
}

/* Which starts see each other: a bit for each of the others. */
static void starts_see(const lmb_tracer *tracer, const lmb_vec3 *point, uint32_t sees[LMB_CELL_STARTS],
                       uint64_t *rays_traced)
{
    lmb_ray_batch rays;
    lmb_rgb share[LMB_RAY_BATCH];
    rays.count = 0;
    for (int i = 0; i < LMB_CELL_STARTS; ++i) {
        for (int k = i + 1; k < LMB_CELL_STARTS; ++k) {
            lmb_ray_batch_add(&rays, point[i], lmb_vec3_sub(point[k], point[i]), LMB_TRACE_UP_TO_END);
        }
    }
    lmb_trace_transmittance_batch(tracer, &rays, share, rays_traced);
    memset(sees, 0, LMB_CELL_STARTS * sizeof *sees);
    const lmb_rgb *ray = share;
    for (int i = 0; i < LMB_CELL_STARTS; ++i) {
        for (int k = i + 1; k < LMB_CELL_STARTS; ++k, ++ray) {
            if (lmb_rgb_max(*ray) > LMB_PIECE_OPEN_SHARE) {
                sees[i] |= 1u << k;
                sees[k] |= 1u << i;
            }
        }
    }
}

/* Of the starts in `left`, the one that sees most of them; the first of several. */
static int start_most_open(const uint32_t sees[LMB_CELL_STARTS], uint32_t left)
{
    int most = -1;
    for (int i = 0; i < LMB_CELL_STARTS; ++i) {
        if (left >> i & 1u &&
            (most < 0 || __builtin_popcount(sees[i] & left) > __builtin_popcount(sees[most] & left))) {
            most = i;
        }
    }
    return most;
}

/* A piece takes starts that all see each other, the most open first: what is seen through a slit alone, as by one of
 * many, stays out. */
static uint32_t piece_take(const uint32_t sees[LMB_CELL_STARTS], uint32_t left, int first)
{
    uint32_t taken = 1u << first;
    uint32_t open = left & sees[first];
    while (open != 0) {
        const int next = start_most_open(sees, open);
        taken |= 1u << next;
        open &= sees[next] & ~(1u << next);
    }
    return taken;
}

static void side_divide(const pieces_work *work, const side_frame *frame, uint32_t side, piece_list *list)
{
    const lmb_tracer *tracer = work->transport->tracer;
    const uint64_t stream = lmb_side_stream(work->transport, &frame->cell, side);
    float x[LMB_CELL_STARTS], y[LMB_CELL_STARTS];
    lmb_vec3 start[LMB_CELL_STARTS], high[LMB_CELL_STARTS];
    uint32_t sees[LMB_CELL_STARTS];
    lmb_sample_variates(work->transport, (lmb_sample_range){stream, 0, LMB_CELL_STARTS}, LMB_PAIR_START, x, y);
    for (int i = 0; i < LMB_CELL_STARTS; ++i) {
        const float u[2] = {x[i], y[i]};
        float along, across;
        lmb_cell_part_point(&frame->part, u, &along, &across);
        start[i] = frame_point(frame, along, across);
        high[i] = lmb_vec3_add(start[i], frame->lift);
    }
    starts_see(tracer, high, sees, &list->rays);
    uint32_t left = (1u << LMB_CELL_STARTS) - 1u;
    for (int count = 0; left != 0 && count < LMB_CELL_MOST_PIECES; ++count) {
        const int first = start_most_open(sees, left);
        const uint32_t taken = piece_take(sees, left, first);
        left &= ~taken;
        const lmb_vec3 point = point_of_start(tracer, frame, start[first], &list->rays);
        const lmb_cell_piece piece = {point, side, (uint16_t)taken, left == 0 || count + 1 == LMB_CELL_MOST_PIECES};
        list_add(list, &piece);
    }
}

/* Sides whose rays wait to be traced together. */
typedef struct side_queue {
    lmb_ray_batch rays;
    uint32_t owner[LMB_RAY_BATCH];
    bool divided[SIDES_PER_TASK];
} side_queue;

static void queue_trace(side_queue *queue, const lmb_tracer *tracer, uint64_t *rays)
{
    lmb_rgb share[LMB_RAY_BATCH];
    lmb_trace_transmittance_batch(tracer, &queue->rays, share, rays);
    for (uint32_t k = 0; k < queue->rays.count; ++k) {
        queue->divided[queue->owner[k]] |= !(lmb_rgb_max(share[k]) > LMB_PIECE_OPEN_SHARE);
    }
    queue->rays.count = 0;
}

static void pieces_task(void *context, size_t task, int worker)
{
    (void)worker;
    const pieces_work *work = context;
    const lmb_tracer *tracer = work->transport->tracer;
    piece_list *list = &work->lists[task];
    const uint32_t first = (uint32_t)task * SIDES_PER_TASK;
    const uint32_t left = 2 * work->light->cell_count - first;
    const uint32_t count = left < SIDES_PER_TASK ? left : SIDES_PER_TASK;
    side_queue queue; /* large: only what is used is set */
    memset(queue.divided, 0, sizeof queue.divided);
    queue.rays.count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const side_frame frame = side_frame_of(work->light, tracer, first + i);
        uint32_t ray = queue.rays.count;
        rays_across_add(&queue.rays, &frame);
        for (; ray < queue.rays.count; ++ray) {
            queue.owner[ray] = i;
        }
        if (queue.rays.count + 3 > LMB_RAY_BATCH) {
            queue_trace(&queue, tracer, &list->rays);
        }
    }
    queue_trace(&queue, tracer, &list->rays);
    for (uint32_t i = 0; i < count && !list->failed; ++i) {
        if (queue.divided[i]) {
            const side_frame frame = side_frame_of(work->light, tracer, first + i);
            if (frame.cell.grid->cell_size < HOLE_SHARE * work->light->cell_size) {
                list_add(list, &(lmb_cell_piece){.side = first + i});
            } else {
                side_divide(work, &frame, first + i, list);
            }
        }
    }
}

static lmb_result pieces_take(lmb_surface_light *light, const piece_list *lists, size_t tasks)
{
    const size_t sides = 2 * (size_t)light->cell_count;
    size_t count = 0;
    for (size_t task = 0; task < tasks; ++task) {
        count += lists[task].count;
        if (lists[task].failed) {
            return LMB_ERROR_MEMORY;
        }
    }
    if (count == 0) {
        return LMB_OK;
    }
    light->first_piece = malloc(sides * sizeof *light->first_piece);
    light->piece = malloc(count * sizeof *light->piece);
    if (!light->first_piece || !light->piece) {
        return LMB_ERROR_MEMORY;
    }
    for (size_t side = 0; side < sides; ++side) {
        light->first_piece[side] = LMB_SIDE_WHOLE;
    }
    for (size_t task = 0; task < tasks; ++task) {
        for (uint32_t i = 0; i < lists[task].count; ++i) {
            const lmb_cell_piece *piece = &lists[task].piece[i];
            const bool hole = piece->starts == 0;
            if (light->first_piece[piece->side] == LMB_SIDE_WHOLE) {
                const lmb_cell cell = lmb_cell_find(light, piece->side / 2);
                light->first_piece[piece->side] = hole ? LMB_SIDE_HOLE : light->piece_count;
                light->grid[cell.grid - light->grid].divided = 1;
            }
            if (!hole) {
                light->piece[light->piece_count++] = *piece;
            }
        }
    }
    return LMB_OK;
}

lmb_result lmb_surface_light_divide(lmb_surface_light *light, const lmb_transport *transport, lmb_pool *pool,
                                    uint64_t *rays)
{
    const size_t tasks = (2 * (size_t)light->cell_count + SIDES_PER_TASK - 1) / SIDES_PER_TASK;
    pieces_work work = {transport, light, calloc(tasks + 1, sizeof *work.lists)};
    if (!work.lists) {
        return LMB_ERROR_MEMORY;
    }
    lmb_result result = lmb_pool_run(pool, tasks, pieces_task, &work, "surface pilot", NULL);
    if (result == LMB_OK) {
        result = pieces_take(light, work.lists, tasks);
    }
    for (size_t task = 0; task < tasks; ++task) {
        *rays += work.lists[task].rays;
        free(work.lists[task].piece);
    }
    free(work.lists);
    return result;
}
