/* Cells that something stands on, a wall most of all: one mean over both of its sides would let light through it. */
#include "surface_light_internal.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "bake_internal.h"
#include "surface_light_sample.h"
#include "trace_internal.h"

enum { SIDES_PER_TASK = 512 };

/* At most, of one side: what lies in none is looked at point by point. */
enum { MAX_PIECES = 4 };

/* Shares of a cell's length: how far off the surface and off the cell's edges the rays run that look for what divides
 * it. Walls begin at the very edge of most floors. */
#define LIFT_SHARE (1.0f / 64.0f)
#define INSET_SHARE 0.02f

/* What lets more light through than this divides nothing. */
#define OPEN_SHARE 0.5f

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
    const lmb_place place = lmb_trace_place(tracer, frame.cell.instance, frame.cell.triangle, 0.0f, 0.0f);
    const float sign = side % 2 == 0 ? 1.0f : -1.0f;
    frame.off = vec3_scale(place.geometric_normal, sign * place.rounding);
    frame.lift = vec3_scale(place.geometric_normal,
                            sign * float_larger(LIFT_SHARE * frame.cell.grid->cell_size, 2.0f * place.rounding));
    return frame;
}

/* A point of the cell's triangle: how far along from the apex, and how far across. */
static lmb_vec3 frame_point(const side_frame *frame, float along, float across)
{
    const uint32_t apex = frame->cell.grid->apex;
    const lmb_vec3 start = vec3_scale(frame->corner[apex], 1.0f - along);
    return vec3_mad(vec3_mad(start, frame->corner[(apex + 1) % 3], along * (1.0f - across)),
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
        point[i] = vec3_add(on, frame->lift);
    }
    const int count = frame->part.strip > 0.0f ? 3 : 2; /* beside the apex the fourth has no length */
    for (int i = 0; i < count; ++i) {
        const lmb_vec3 from = point[ends[i][0]];
        lmb_ray_batch_add(rays, from, vec3_sub(point[ends[i][1]], from), LMB_TRACE_UP_TO_END);
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

/* The place that stands for a start: higher than the surface, unless something lies on that. */
static lmb_vec3 place_of_start(const lmb_tracer *tracer, const side_frame *frame, lmb_vec3 start, uint64_t *rays)
{
    const lmb_vec3 low = vec3_add(start, frame->off);
    const lmb_vec3 high = vec3_add(start, frame->lift);
    return rgb_max(lmb_trace_transmittance(tracer, low, high, rays)) > OPEN_SHARE ? high : low;
}

/* Those of the starts in `left` that `place` sees. */
static uint32_t starts_seen(const lmb_tracer *tracer, const side_frame *frame, const lmb_vec3 *start, uint32_t left,
                            lmb_vec3 place, uint64_t *rays_traced)
{
    lmb_ray_batch rays;
    lmb_rgb share[LMB_RAY_BATCH];
    uint32_t owner[LMB_CELL_STARTS];
    rays.count = 0;
    for (uint32_t i = 0; i < LMB_CELL_STARTS; ++i) {
        if (left >> i & 1u) {
            const lmb_vec3 from = vec3_add(start[i], frame->off);
            owner[rays.count] = i;
            lmb_ray_batch_add(&rays, from, vec3_sub(place, from), LMB_TRACE_UP_TO_END);
        }
    }
    lmb_trace_transmittance_batch(tracer, &rays, share, rays_traced);
    uint32_t seen = 0;
    for (uint32_t k = 0; k < rays.count; ++k) {
        seen |= rgb_max(share[k]) > OPEN_SHARE ? 1u << owner[k] : 0;
    }
    return seen;
}

/* Each start belongs to the first piece whose place it sees. */
static void side_divide(const pieces_work *work, const side_frame *frame, uint32_t side, piece_list *list)
{
    const lmb_tracer *tracer = work->transport->tracer;
    const uint64_t stream = lmb_side_stream(work->transport, &frame->cell, side);
    float x[LMB_CELL_STARTS], y[LMB_CELL_STARTS];
    lmb_vec3 start[LMB_CELL_STARTS];
    lmb_sample_numbers(work->transport, stream, 0, LMB_CELL_STARTS, LMB_PAIR_START, x, y);
    for (int i = 0; i < LMB_CELL_STARTS; ++i) {
        const float numbers[2] = {x[i], y[i]};
        float along, across;
        lmb_cell_part_point(&frame->part, numbers, &along, &across);
        start[i] = frame_point(frame, along, across);
    }
    uint32_t left = (1u << LMB_CELL_STARTS) - 1u;
    for (int count = 0; left != 0 && count < MAX_PIECES; ++count) {
        const uint32_t first = (uint32_t)__builtin_ctz(left);
        const lmb_vec3 place = place_of_start(tracer, frame, start[first], &list->rays);
        const uint32_t seen =
            starts_seen(tracer, frame, start, left & ~(1u << first), place, &list->rays) | 1u << first;
        left &= ~seen;
        const lmb_cell_piece piece = {place, side, (uint16_t)seen, left == 0 || count + 1 == MAX_PIECES};
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
        queue->divided[queue->owner[k]] |= !(rgb_max(share[k]) > OPEN_SHARE);
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
            if (lmb_cell_is_small(work->light, frame.cell.grid)) {
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

bool lmb_surface_light_piece_find(const lmb_surface_light *light, const lmb_tracer *tracer, const lmb_hit *hit,
                                  bool front, uint64_t *rays, uint32_t *patch)
{
    uint32_t number = light->first_piece[*patch];
    if (number >= LMB_SIDE_HOLE) {
        return number == LMB_SIDE_WHOLE;
    }
    const lmb_place place = lmb_trace_place(tracer, hit->instance, hit->triangle, hit->u, hit->v);
    const lmb_vec3 from = vec3_mad(place.position, place.geometric_normal, front ? place.rounding : -place.rounding);
    for (;; ++number) {
        const lmb_cell_piece *piece = &light->piece[number];
        if (rgb_max(lmb_trace_transmittance(tracer, from, piece->place, rays)) > OPEN_SHARE) {
            *patch = 2 * light->cell_count + number;
            return true;
        }
        if (piece->last) {
            return false;
        }
    }
}
