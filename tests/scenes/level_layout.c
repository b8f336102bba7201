#include "level_builder_internal.h"

#include <math.h>
#include <stdlib.h>

typedef struct layout_item {
    float height;
    size_t chart;
} layout_item;

static int compare_items(const void *left, const void *right)
{
    const layout_item *a = left;
    const layout_item *b = right;
    if (a->height != b->height) {
        return a->height > b->height ? -1 : 1;
    }
    return a->chart < b->chart ? -1 : a->chart > b->chart;
}

/* Fills shelves from the bottom up, highest charts first. */
static bool pack_shelves(level_chart *charts, const layout_item *items, size_t count, float gutter, float side)
{
    float x = gutter;
    float y = gutter;
    float shelf_height = 0;
    for (size_t i = 0; i < count; ++i) {
        level_chart *chart = &charts[items[i].chart];
        if (i == 0 || x + chart->width + gutter > side) {
            y += i == 0 ? 0 : shelf_height + gutter;
            x = gutter;
            shelf_height = chart->height;
        }
        if (x + chart->width + gutter > side || y + chart->height + gutter > side) {
            return false;
        }
        chart->x = x;
        chart->y = y;
        x += chart->width + gutter;
    }
    return true;
}

float level_layout_pack(level_chart *charts, size_t count, float gutter_m)
{
    if (count == 0) {
        return 1;
    }
    layout_item *items = malloc(count * sizeof *items);
    if (!items) {
        return -1;
    }
    float area = 0;
    for (size_t i = 0; i < count; ++i) {
        items[i] = (layout_item){charts[i].height, i};
        area += (charts[i].width + gutter_m) * (charts[i].height + gutter_m);
    }
    qsort(items, count, sizeof *items, compare_items);
    float side = sqrtf(area) + gutter_m;
    while (!pack_shelves(charts, items, count, gutter_m, side)) {
        side *= 1.03f;
    }
    free(items);
    return side;
}
