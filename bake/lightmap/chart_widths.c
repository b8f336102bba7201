#include "lightmap/chart_widths.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a packing twice as long as wide may cost more than a square. */
static const double ASPECT_COST = 0.02;
/* Of searching for places, for all widths together: some tenths of a second. */
static const uint64_t MOST_STEPS = UINT64_C(400000000);
/* Widths that are tried, as shares of a full square's, in this order. */
static const double SHARES[] = {1.0, 1.1, 0.95, 1.2, 0.9, 1.05, 1.3, 1.15, 0.85, 1.25, 1.35, 0.8, 1.4, 0.75};

enum { SHARE_COUNT = (int)(sizeof SHARES / sizeof SHARES[0]) };

/* Trials beside each other: the same whatever the number of threads, as what was tried decides what else is. */
enum { AT_ONCE = 4 };

static int32_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

static int32_t smaller(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static int item_compare(const void *a, const void *b)
{
    const chart_item *const p = a;
    const chart_item *const q = b;
    const int32_t p_longest = larger(p->shape->width, p->shape->height);
    const int32_t q_longest = larger(q->shape->width, q->shape->height);
    if (p_longest != q_longest) {
        return p_longest > q_longest ? -1 : 1;
    }
    const int32_t p_least = smaller(p->shape->width, p->shape->height);
    const int32_t q_least = smaller(q->shape->width, q->shape->height);
    if (p_least != q_least) {
        return p_least > q_least ? -1 : 1;
    }
    return (p->id > q->id) - (p->id < q->id);
}

void lmb_chart_items_sort(chart_item *items, size_t count)
{
    qsort(items, count, sizeof *items, item_compare);
}

void lmb_chart_items_free(chart_item *items, size_t count)
{
    for (size_t i = 0; items && i < count; ++i) {
        for (int turn = 0; turn < CHART_TURNS; ++turn) {
            lmb_chart_shape_free(&items[i].shape[turn]);
        }
    }
    free(items);
}

/* One width. */
typedef struct width_trial {
    int32_t width;
    chart_place *place; /* [item] */
    lmb_result result;  /* LMB_ERROR_ARGUMENT: higher than allowed */
    double cost;
    int32_t used_width, used_height;
    uint64_t steps;
} width_trial;

/* Trials that are made at once, and what is known between them. */
typedef struct trials {
    chart_widths *job;
    width_trial at_once[AT_ONCE];
    double best_cost;
    uint64_t steps; /* of all so far */
} trials;

/* Texels of an image that a packing takes; more where it is far from square, which is hard to place, and sooner larger
 * than an image. */
static double canvas_cost(const chart_canvas *canvas)
{
    const double width = canvas->used_width - canvas->gutter;
    const double height = canvas->used_height - canvas->gutter;
    const double aspect = width > height ? width / height : height / width;
    return width * height * (1.0 + ASPECT_COST * (aspect - 1.0));
}

/* @return LMB_ERROR_ARGUMENT: higher than allowed */
static lmb_result canvas_fill(const chart_widths *job, chart_canvas *canvas, bool all, chart_place *place)
{
    for (size_t i = 0; i < job->count; ++i) {
        const chart_item *const item = &job->items[i];
        if (!lmb_chart_canvas_add(canvas, item->shape, item->turns, job->most, &place[i])) {
            return LMB_ERROR_MEMORY;
        }
        if (all && place[i].turn < 0) {
            return LMB_ERROR_ARGUMENT;
        }
    }
    return LMB_OK;
}

static void width_try(void *context, size_t task, int worker)
{
    (void)worker;
    trials *const all = context;
    const chart_widths *job = all->job;
    width_trial *const at = &all->at_once[task];
    chart_canvas canvas;
    at->result = lmb_chart_canvas_make(at->width, job->gutter, &canvas) ? LMB_OK : LMB_ERROR_MEMORY;
    if (at->result == LMB_OK) {
        at->result = canvas_fill(job, &canvas, true, at->place);
    }
    at->steps = canvas.work;
    at->cost = at->result == LMB_OK ? canvas_cost(&canvas) : HUGE_VAL;
    at->used_width = canvas.used_width;
    at->used_height = canvas.used_height;
    lmb_chart_canvas_free(&canvas);
}

/* Tries the widths at hand, and keeps the best, the first of those that are as good. */
static lmb_result widths_try(trials *all, int count)
{
    chart_widths *const job = all->job;
    for (int i = 0; i < count && !job->pool; ++i) {
        width_try(all, (size_t)i, 0);
    }
    lmb_result result = job->pool ? lmb_pool_run(job->pool, (size_t)count, width_try, all, "layout", NULL) : LMB_OK;
    for (int i = 0; i < count && result == LMB_OK; ++i) {
        const width_trial *const at = &all->at_once[i];
        result = at->result == LMB_ERROR_MEMORY ? LMB_ERROR_MEMORY : LMB_OK;
        all->steps += at->steps;
        if (at->cost < all->best_cost) {
            all->best_cost = at->cost;
            memcpy(job->place, at->place, job->count * sizeof *job->place);
            job->width = at->used_width;
            job->height = at->used_height;
        }
    }
    return result;
}

/* The width of a trial: of a square that holds all if it is full, or (first) of the longest shape, as a few long ones
 * want it; and the largest. */
static double trial_width(const chart_widths *job, int trial)
{
    double area = 0.0;
    int32_t longest = 0, least = 0;
    for (size_t i = 0; i < job->count; ++i) {
        const chart_shape *const shape = job->items[i].shape;
        area += (double)(shape->width + job->gutter) * (double)(shape->height + job->gutter);
        longest = larger(longest, larger(shape->width, shape->height));
        least = larger(least, job->items[i].turns > 1 ? smaller(shape->width, shape->height) : shape->width);
    }
    return trial == 0                 ? larger(longest, least)
           : trial == SHARE_COUNT + 1 ? job->most - 2 * job->gutter
                                      : fmax(ceil(SHARES[trial - 1] * sqrt(area)) - job->gutter, least);
}

/* Whether full boxes alone, which nothing can lie in, are more than the largest image has. */
static bool boxes_exceed(const chart_widths *job)
{
    const double side = (double)job->most - job->gutter;
    double area = 0.0;
    for (size_t i = 0; i < job->count; ++i) {
        const chart_shape *const shape = job->items[i].shape;
        area += shape->solid ? (double)(shape->width + job->gutter) * (double)(shape->height + job->gutter) : 0.0;
    }
    return area > side * side;
}

/* How many trials may follow `done` of them: as if each took as long as those before. */
static int trials_left(const trials *all, int done)
{
    const int most = SHARE_COUNT + 1 - done < AT_ONCE ? SHARE_COUNT + 1 - done : AT_ONCE;
    if (all->best_cost == HUGE_VAL) {
        return most > 0 ? 1 : done == SHARE_COUNT + 1;
    }
    int count = 0;
    while (count < most && all->steps * (uint64_t)(done + count + 1) <= MOST_STEPS * (uint64_t)done) {
        ++count;
    }
    return count;
}

static lmb_result trials_run(trials *all)
{
    const chart_widths *job = all->job;
    lmb_result result = LMB_OK;
    int next;
    for (int done = 0; (next = trials_left(all, done)) > 0 && result == LMB_OK; done += next) {
        int count = 0;
        for (int i = 0; i < next; ++i) {
            const double width = trial_width(job, done + i) + 2.0 * job->gutter;
            if (width <= job->most) {
                all->at_once[count++].width = (int32_t)width;
            }
        }
        result = widths_try(all, count);
    }
    return result;
}

lmb_result lmb_chart_widths_pack(chart_widths *job)
{
    if (boxes_exceed(job)) {
        return LMB_ERROR_ARGUMENT;
    }
    trials all = {.job = job, .best_cost = HUGE_VAL};
    chart_place *const places = malloc((AT_ONCE * job->count + 1) * sizeof *places);
    for (int i = 0; i < AT_ONCE; ++i) {
        all.at_once[i].place = places ? places + (size_t)i * job->count : NULL;
    }
    const lmb_result result = places ? trials_run(&all) : LMB_ERROR_MEMORY;
    free(places);
    return result == LMB_OK && all.best_cost == HUGE_VAL ? LMB_ERROR_ARGUMENT : result;
}

lmb_result lmb_chart_widths_fill(chart_widths *job)
{
    chart_canvas canvas;
    lmb_result result = lmb_chart_canvas_make(job->most, job->gutter, &canvas) ? LMB_OK : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = canvas_fill(job, &canvas, false, job->place);
    }
    job->width = canvas.used_width;
    job->height = canvas.used_height;
    lmb_chart_canvas_free(&canvas);
    return result;
}
