#include "lightmap/chart_widths.h"

#include <math.h>
#include <stdlib.h>

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
static bool chart_fit(const chart_flat *chart, chart_vec2 *corners, chart_vec2 *scratch, int32_t size[2])
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
    size[0] = (int32_t)width;
    size[1] = (int32_t)height;
    return true;
}

/* The bitmaps of a chart in all its turns: two of a full rectangle, which looks the same from the other side. */
static bool item_make(const chart_flat *chart, const chart_vec2 *corners, const int32_t size[2], chart_item *item)
{
    bool enough = lmb_chart_shape_make(corners + chart->first, chart->count, size[0], size[1], &item->shape[0]);
    item->turns = item->shape[0].solid ? CHART_TURNS / 2 : CHART_TURNS;
    for (int k = 1; enough && k < item->turns; ++k) {
        enough = lmb_chart_shape_turn(&item->shape[k - 1], &item->shape[k]);
    }
    return enough;
}

/* Lays all charts into boxes of their own. */
static lmb_result charts_fit(const chart_flat *charts, size_t count, chart_vec2 *corners, int32_t (*sizes)[2])
{
    size_t most = 0;
    for (size_t i = 0; i < count; ++i) {
        most = charts[i].count > most ? charts[i].count : most;
    }
    chart_vec2 *const scratch = malloc((2 * most + 1) * sizeof *scratch);
    if (!scratch) {
        return LMB_ERROR_MEMORY;
    }
    double area = 0.0; /* twice that of the largest square is surely too much, and may be much memory */
    bool fits = true;
    for (size_t i = 0; i < count && fits; ++i) {
        fits = chart_fit(&charts[i], corners, scratch, sizes[i]);
        area += fits ? (double)sizes[i][0] * (double)sizes[i][1] : 0.0;
        fits = fits && area <= 2.0 * MAX_RESOLUTION * MAX_RESOLUTION;
    }
    free(scratch);
    return fits ? LMB_OK : LMB_ERROR_ARGUMENT;
}

/* Moves a chart's corners to where it was placed. */
static void corners_move(const chart_flat *chart, const chart_item *item, const chart_place *place, chart_vec2 *corners)
{
    for (size_t k = chart->first; k < chart->first + chart->count; ++k) {
        chart_vec2 p = corners[k];
        for (int turn = 0; turn < place->turn; ++turn) {
            p = (chart_vec2){item->shape[turn].height - p.y, p.x};
        }
        corners[k] = (chart_vec2){p.x + place->x, p.y + place->y};
    }
}

lmb_result lmb_chart_pack(const chart_flat *charts, size_t chart_count, chart_vec2 *corners, int32_t gutter_texels,
                          lmb_pool *pool, int32_t *resolution)
{
    int32_t(*const sizes)[2] = malloc(chart_count * sizeof *sizes);
    chart_item *const items = calloc(chart_count, sizeof *items);
    chart_place *const places = malloc(chart_count * sizeof *places);
    lmb_result result = sizes && items && places ? charts_fit(charts, chart_count, corners, sizes) : LMB_ERROR_MEMORY;
    for (size_t i = 0; i < chart_count && result == LMB_OK; ++i) {
        items[i].id = i;
        result = item_make(&charts[i], corners, sizes[i], &items[i]) ? LMB_OK : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        lmb_chart_items_sort(items, chart_count);
        chart_widths job = {.items = items,
                            .count = chart_count,
                            .gutter = gutter_texels,
                            .most = MAX_RESOLUTION,
                            .pool = pool,
                            .place = places};
        result = lmb_chart_widths_pack(&job);
        const int32_t side = job.width > job.height ? job.width : job.height;
        *resolution = result == LMB_OK ? (side + RESOLUTION_STEP - 1) / RESOLUTION_STEP * RESOLUTION_STEP : *resolution;
    }
    for (size_t i = 0; i < chart_count && result == LMB_OK; ++i) {
        corners_move(&charts[items[i].id], &items[i], &places[i], corners);
    }
    free(sizes);
    lmb_chart_items_free(items, chart_count);
    free(places);
    return result;
}
