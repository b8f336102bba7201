#include "lightmap/chart_internal.h"

#include <math.h>
#include <stdlib.h>

#include <stb_rect_pack.h>

enum { MAX_RESOLUTION = 32768, RESOLUTION_STEP = 4, MAX_HULL_EDGES = 256 };
/* A box may stick out of its texels by this much, so that rounding does not cost a row. */
static const double ROUNDING_TEXELS = 1e-3;

static int point_compare(const void *a, const void *b)
{
    const chart_vec2 *const p = a;
    const chart_vec2 *const q = b;
    if (p->x != q->x) {
        return p->x < q->x ? -1 : 1;
    }
    return (p->y > q->y) - (p->y < q->y);
}

static double turn(chart_vec2 a, chart_vec2 b, chart_vec2 c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* Convex hull, counter-clockwise, by Andrew's monotone chain (1979). Sorts `points`; `hull` has room for count + 1. */
static size_t hull_make(chart_vec2 *points, size_t count, chart_vec2 *hull)
{
    size_t size = 0;
    qsort(points, count, sizeof *points, point_compare);
    for (size_t i = 0; i < count; ++i) {
        while (size >= 2 && turn(hull[size - 2], hull[size - 1], points[i]) <= 0.0) {
            --size;
        }
        hull[size++] = points[i];
    }
    const size_t lower = size + 1;
    for (size_t i = count - 1; i-- > 0;) {
        while (size >= lower && turn(hull[size - 2], hull[size - 1], points[i]) <= 0.0) {
            --size;
        }
        hull[size++] = points[i];
    }
    return size > 1 ? size - 1 : size;
}

/* The x axis of the smallest box around the hull; one of its sides lies along an edge of the hull. */
static chart_vec2 smallest_box_axis(const chart_vec2 *hull, size_t count)
{
    chart_vec2 best = {1.0, 0.0};
    double best_area = HUGE_VAL;
    const size_t step = count / MAX_HULL_EDGES + 1;
    for (size_t i = 0; i < count; i += step) {
        const chart_vec2 a = hull[i];
        const chart_vec2 b = hull[(i + 1) % count];
        const double length = sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
        if (!(length > 0.0)) {
            continue;
        }
        const chart_vec2 axis = {(b.x - a.x) / length, (b.y - a.y) / length};
        chart_vec2 low = {HUGE_VAL, HUGE_VAL};
        chart_vec2 high = {-HUGE_VAL, -HUGE_VAL};
        for (size_t k = 0; k < count; ++k) {
            const double x = hull[k].x * axis.x + hull[k].y * axis.y;
            const double y = hull[k].y * axis.x - hull[k].x * axis.y;
            low.x = fmin(low.x, x);
            low.y = fmin(low.y, y);
            high.x = fmax(high.x, x);
            high.y = fmax(high.y, y);
        }
        const double area = (high.x - low.x) * (high.y - low.y);
        if (area < best_area) {
            best_area = area;
            best = high.x - low.x >= high.y - low.y ? axis : (chart_vec2){-axis.y, axis.x};
        }
    }
    return best;
}

/* Turns and scales one chart so that it fills its box, which stands at the origin. False: larger than any square. */
static bool chart_fit(const chart_flat *chart, chart_vec2 *corners, chart_vec2 *scratch, stbrp_rect *box)
{
    chart_vec2 *const own = corners + chart->first;
    for (size_t i = 0; i < chart->count; ++i) {
        scratch[i] = own[i];
    }
    chart_vec2 *const hull = scratch + chart->count;
    const chart_vec2 axis = smallest_box_axis(hull, hull_make(scratch, chart->count, hull));
    chart_vec2 low = {HUGE_VAL, HUGE_VAL};
    chart_vec2 high = {-HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < chart->count; ++i) {
        const chart_vec2 p = own[i];
        own[i] =
            (chart_vec2){chart->scale * (p.x * axis.x + p.y * axis.y), chart->scale * (p.y * axis.x - p.x * axis.y)};
        low.x = fmin(low.x, own[i].x);
        low.y = fmin(low.y, own[i].y);
        high.x = fmax(high.x, own[i].x);
        high.y = fmax(high.y, own[i].y);
    }
    const double width = fmax(1.0, ceil(high.x - low.x - ROUNDING_TEXELS));
    const double height = fmax(1.0, ceil(high.y - low.y - ROUNDING_TEXELS));
    if (!(width <= MAX_RESOLUTION && height <= MAX_RESOLUTION)) {
        return false;
    }
    /* In the middle of its box, a rectangle covers the centre of every texel of the box. */
    const chart_vec2 shift = {0.5 * (width - (high.x - low.x)) - low.x, 0.5 * (height - (high.y - low.y)) - low.y};
    for (size_t i = 0; i < chart->count; ++i) {
        own[i].x += shift.x;
        own[i].y += shift.y;
    }
    box->w = (stbrp_coord)width;
    box->h = (stbrp_coord)height;
    return true;
}

static int box_compare_size(const void *a, const void *b)
{
    const stbrp_rect *const p = a;
    const stbrp_rect *const q = b;
    if (p->h != q->h) {
        return p->h > q->h ? -1 : 1;
    }
    if (p->w != q->w) {
        return p->w > q->w ? -1 : 1;
    }
    return (p->id > q->id) - (p->id < q->id);
}

static int box_compare_place(const void *a, const void *b)
{
    const stbrp_rect *const p = a;
    const stbrp_rect *const q = b;
    if (p->y != q->y) {
        return p->y < q->y ? -1 : 1;
    }
    return (p->x > q->x) - (p->x < q->x);
}

/* Boxes of equal size trade places until they lie in the order of their charts: which of them the packer takes first
 * depends on the C library's qsort(). `boxes` are sorted by size, then chart. */
static bool equal_boxes_order(stbrp_rect *boxes, size_t count)
{
    stbrp_rect *const places = malloc(count * sizeof *places);
    if (!places) {
        return false;
    }
    for (size_t first = 0; first < count;) {
        size_t end = first;
        while (end < count && boxes[end].w == boxes[first].w && boxes[end].h == boxes[first].h) {
            places[end - first] = boxes[end];
            ++end;
        }
        qsort(places, end - first, sizeof *places, box_compare_place);
        for (size_t i = first; i < end; ++i) {
            boxes[i].x = places[i - first].x;
            boxes[i].y = places[i - first].y;
        }
        first = end;
    }
    free(places);
    return true;
}

static bool boxes_try(stbrp_rect *boxes, size_t count, int32_t side, stbrp_node *nodes)
{
    stbrp_context context;
    stbrp_init_target(&context, side, side, nodes, side);
    return stbrp_pack_rects(&context, boxes, (int)count) != 0;
}

static int32_t round_up(double value)
{
    return (int32_t)ceil(value / RESOLUTION_STEP) * RESOLUTION_STEP;
}

/* Finds the smallest square by growing 5 % at a time, then halving the last step. Boxes include one gutter. */
static lmb_result boxes_pack(stbrp_rect *boxes, size_t count, int32_t gutter, int32_t *resolution)
{
    double area = 0.0;
    int32_t longest = 0;
    for (size_t i = 0; i < count; ++i) {
        area += (double)boxes[i].w * (double)boxes[i].h;
        longest = boxes[i].w > longest ? boxes[i].w : longest;
        longest = boxes[i].h > longest ? boxes[i].h : longest;
    }
    const double least = fmax(sqrt(area), longest) + gutter;
    if (!(least <= MAX_RESOLUTION)) {
        return LMB_ERROR_ARGUMENT;
    }
    stbrp_node *const nodes = malloc(MAX_RESOLUTION * sizeof *nodes);
    if (!nodes) {
        return LMB_ERROR_MEMORY;
    }
    int32_t good = round_up(least);
    int32_t bad = good - RESOLUTION_STEP;
    while (good <= MAX_RESOLUTION && !boxes_try(boxes, count, good - gutter, nodes)) {
        bad = good;
        good = round_up(1.05 * good);
    }
    const bool fits = good <= MAX_RESOLUTION;
    while (fits && good - bad > RESOLUTION_STEP) {
        const int32_t middle = bad + (good - bad) / (2 * RESOLUTION_STEP) * RESOLUTION_STEP;
        if (boxes_try(boxes, count, middle - gutter, nodes)) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    if (fits) {
        (void)boxes_try(boxes, count, good - gutter, nodes);
    }
    free(nodes);
    *resolution = good;
    return fits ? LMB_OK : LMB_ERROR_ARGUMENT;
}

lmb_result chart_pack(const chart_flat *charts, size_t chart_count, chart_vec2 *corners, int32_t gutter_texels,
                      int32_t *resolution)
{
    size_t most = 0;
    for (size_t i = 0; i < chart_count; ++i) {
        most = charts[i].count > most ? charts[i].count : most;
    }
    lmb_result result = LMB_OK;
    stbrp_rect *const boxes = calloc(chart_count, sizeof *boxes);
    chart_vec2 *const scratch = malloc((2 * most + 1) * sizeof *scratch);
    if (!boxes || !scratch) {
        result = LMB_ERROR_MEMORY;
    }
    for (size_t i = 0; i < chart_count && result == LMB_OK; ++i) {
        boxes[i].id = (int)i;
        result = chart_fit(&charts[i], corners, scratch, &boxes[i]) ? LMB_OK : LMB_ERROR_ARGUMENT;
        boxes[i].w += gutter_texels;
        boxes[i].h += gutter_texels;
    }
    if (result == LMB_OK) {
        qsort(boxes, chart_count, sizeof *boxes, box_compare_size);
        result = boxes_pack(boxes, chart_count, gutter_texels, resolution);
    }
    if (result == LMB_OK && !equal_boxes_order(boxes, chart_count)) {
        result = LMB_ERROR_MEMORY;
    }
    for (size_t i = 0; i < chart_count && result == LMB_OK; ++i) {
        const chart_flat *const chart = &charts[boxes[i].id];
        for (size_t k = chart->first; k < chart->first + chart->count; ++k) {
            corners[k].x += boxes[i].x + gutter_texels;
            corners[k].y += boxes[i].y + gutter_texels;
        }
    }
    free(boxes);
    free(scratch);
    return result;
}
