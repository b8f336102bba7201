#include "lightmap/chart_canvas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vectorised.h"

enum { WORD = 64 };

/* A triangle that reaches less than this far into a texel does not touch it. Half of what covering texels forgives, so
 * that rounding corners to floats cannot make a shape touch more than its bits say. */
static const double TOUCH_TEXELS = 5e-4;

/* Larger boxes are only let down from above: looking for holes costs their area for every row, and those are filled by
 * what is smaller. */
enum { MOST_SEARCHED_TEXELS = 1 << 14 };

static int32_t words_of(int32_t width)
{
    return (width + WORD - 1) / WORD;
}

static bool shape_alloc(int32_t width, int32_t height, chart_shape *shape)
{
    *shape = (chart_shape){.width = width, .height = height, .words = words_of(width)};
    shape->bits = calloc((size_t)shape->words * (size_t)height, sizeof *shape->bits);
    shape->bottom = malloc((size_t)width * sizeof *shape->bottom);
    shape->run = malloc((size_t)height * sizeof *shape->run);
    shape->alike = malloc((size_t)height * sizeof *shape->alike);
    return shape->bits && shape->bottom && shape->run && shape->alike;
}

void lmb_chart_shape_free(chart_shape *shape)
{
    free(shape->bits);
    free(shape->bottom);
    free(shape->run);
    free(shape->alike);
    *shape = (chart_shape){0};
}

static bool bit_get(const uint64_t *row, int32_t x)
{
    return (row[x / WORD] >> (x % WORD) & 1) != 0;
}

static void bits_set(uint64_t *row, int32_t from, int32_t to)
{
    for (int32_t x = from; x < to;) {
        const int32_t end = (x / WORD + 1) * WORD < to ? (x / WORD + 1) * WORD : to;
        const uint64_t ones = end - x == WORD ? UINT64_MAX : (UINT64_C(1) << (end - x)) - 1;
        row[x / WORD] |= ones << (x % WORD);
        x = end;
    }
}

/* The first bit from `x` on that is `value`; `end` if there is none before it. */
static int32_t bit_find(const uint64_t *row, int32_t x, int32_t end, bool value)
{
    while (x < end) {
        const uint64_t rest = (value ? row[x / WORD] : ~row[x / WORD]) >> (x % WORD);
        if (rest == 0) {
            x = (x / WORD + 1) * WORD;
            continue;
        }
        x += __builtin_ctzll(rest);
        return x < end ? x : end;
    }
    return end;
}

static int32_t longest_run(const uint64_t *row, int32_t width, bool value)
{
    int32_t longest = 0;
    for (int32_t x = bit_find(row, 0, width, value); x < width;) {
        const int32_t end = bit_find(row, x, width, !value);
        longest = end - x > longest ? end - x : longest;
        x = bit_find(row, end, width, value);
    }
    return longest;
}

/* Shapes that share a key and are not alike only lose places that the later one might have had. */
static uint64_t shape_key(const chart_shape *shape)
{
    uint64_t key = (uint64_t)shape->width << 32 | (uint64_t)shape->height << 1 | 1;
    if (!shape->solid && (int64_t)shape->width * shape->height > WORD) {
        return 0;
    }
    for (int32_t y = 0; !shape->solid && y < shape->height; ++y) {
        key = (key ^ shape->bits[y]) * UINT64_C(0x9e3779b97f4a7c15);
        key ^= key >> 29;
    }
    return key;
}

/* What the search asks of a shape's bits. */
static void shape_finish(chart_shape *shape)
{
    const size_t row_bytes = (size_t)shape->words * sizeof *shape->bits;
    shape->solid = true;
    shape->least_run = shape->width;
    for (int32_t x = 0; x < shape->width; ++x) {
        shape->bottom[x] = shape->height;
    }
    for (int32_t y = 0; y < shape->height; ++y) {
        const uint64_t *const row = shape->bits + (size_t)y * (size_t)shape->words;
        shape->run[y] = longest_run(row, shape->width, true);
        shape->solid = shape->solid && shape->run[y] == shape->width;
        shape->least_run = shape->run[y] < shape->least_run ? shape->run[y] : shape->least_run;
        for (int32_t x = bit_find(row, 0, shape->width, true); x < shape->width;
             x = bit_find(row, x + 1, shape->width, true)) {
            shape->bottom[x] = y < shape->bottom[x] ? y : shape->bottom[x];
        }
    }
    for (int32_t y = shape->height - 1; y >= 0; --y) {
        const uint64_t *const row = shape->bits + (size_t)y * (size_t)shape->words;
        const bool same = y + 1 < shape->height && memcmp(row, row + shape->words, row_bytes) == 0;
        shape->alike[y] = same ? shape->alike[y + 1] + 1 : 1;
    }
    shape->key = shape_key(shape);
}

/* The range of x that a triangle takes between two heights; empty where it is above or below. */
static void strip_range(const chart_vec2 corner[3], double low_y, double high_y, double *low, double *high)
{
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (int e = 0; e < 3; ++e) {
        const chart_vec2 a = corner[e];
        const chart_vec2 b = corner[(e + 1) % 3];
        if (a.y >= low_y && a.y <= high_y) {
            *low = fmin(*low, a.x);
            *high = fmax(*high, a.x);
        }
        const double levels[2] = {low_y, high_y};
        for (int k = 0; k < 2; ++k) {
            if ((a.y < levels[k] && b.y > levels[k]) || (a.y > levels[k] && b.y < levels[k])) {
                const double x = a.x + (b.x - a.x) * ((levels[k] - a.y) / (b.y - a.y));
                *low = fmin(*low, x);
                *high = fmax(*high, x);
            }
        }
    }
}

static int32_t texel_between(double value, int32_t size)
{
    return value <= 0.0 ? 0 : value >= size - 1 ? size - 1 : (int32_t)value;
}

static void triangle_draw(chart_shape *shape, const chart_vec2 corner[3])
{
    const double low_y = fmin(corner[0].y, fmin(corner[1].y, corner[2].y));
    const double high_y = fmax(corner[0].y, fmax(corner[1].y, corner[2].y));
    const int32_t last = texel_between(high_y - TOUCH_TEXELS, shape->height);
    for (int32_t y = texel_between(low_y + TOUCH_TEXELS, shape->height); y <= last; ++y) {
        double low, high;
        strip_range(corner, fmax(y, low_y), fmin(y + 1, high_y), &low, &high);
        if (low <= high) {
            bits_set(shape->bits + (size_t)y * (size_t)shape->words, texel_between(low + TOUCH_TEXELS, shape->width),
                     texel_between(high - TOUCH_TEXELS, shape->width) + 1);
        }
    }
}

bool lmb_chart_shape_make(const chart_vec2 *corners, size_t count, int32_t width, int32_t height, chart_shape *shape)
{
    if (!shape_alloc(width, height, shape)) {
        return false;
    }
    for (size_t i = 0; i + 2 < count; i += 3) {
        triangle_draw(shape, corners + i);
    }
    shape_finish(shape);
    return true;
}

bool lmb_chart_shape_make_box(int32_t width, int32_t height, chart_shape *shape)
{
    if (!shape_alloc(width, height, shape)) {
        return false;
    }
    for (int32_t y = 0; y < height; ++y) {
        bits_set(shape->bits + (size_t)y * (size_t)shape->words, 0, width);
    }
    shape_finish(shape);
    return true;
}

bool lmb_chart_shape_turn(const chart_shape *shape, chart_shape *turned)
{
    if (!shape_alloc(shape->height, shape->width, turned)) {
        return false;
    }
    for (int32_t y = 0; y < shape->height; ++y) {
        const uint64_t *const row = shape->bits + (size_t)y * (size_t)shape->words;
        const int32_t column = shape->height - 1 - y;
        for (int32_t x = bit_find(row, 0, shape->width, true); x < shape->width;
             x = bit_find(row, x + 1, shape->width, true)) {
            turned->bits[(size_t)x * (size_t)turned->words + (size_t)(column / WORD)] |= UINT64_C(1) << (column % WORD);
        }
    }
    shape_finish(turned);
    return true;
}

bool lmb_chart_canvas_make(int32_t width, int32_t gutter, chart_canvas *canvas)
{
    *canvas = (chart_canvas){.width = width, .gutter = gutter, .words = words_of(width)};
    canvas->top = malloc((size_t)width * sizeof *canvas->top);
    canvas->lowest = malloc((size_t)width * sizeof *canvas->lowest);
    canvas->hit = malloc((size_t)canvas->words * sizeof *canvas->hit);
    canvas->row = malloc((size_t)canvas->words * sizeof *canvas->row);
    for (int32_t x = 0; canvas->top && x < width; ++x) {
        canvas->top[x] = gutter;
    }
    return canvas->top && canvas->lowest && canvas->hit && canvas->row;
}

void lmb_chart_canvas_free(chart_canvas *canvas)
{
    free(canvas->blocked);
    free(canvas->room);
    free(canvas->top);
    free(canvas->lowest);
    free(canvas->hit);
    free(canvas->row);
    *canvas = (chart_canvas){0};
}

static uint64_t *canvas_row(const chart_canvas *canvas, int32_t y)
{
    return canvas->blocked + (size_t)y * (size_t)canvas->words;
}

static bool canvas_grow(chart_canvas *canvas, int32_t height)
{
    if (height <= canvas->height) {
        return true;
    }
    const int32_t rows = height + height / 2;
    const size_t words = (size_t)canvas->words;
    uint64_t *const blocked = realloc(canvas->blocked, (size_t)rows * words * sizeof *blocked);
    canvas->blocked = blocked ? blocked : canvas->blocked;
    int32_t *const room = realloc(canvas->room, (size_t)rows * sizeof *room);
    canvas->room = room ? room : canvas->room;
    if (!blocked || !room) {
        return false;
    }
    memset(canvas_row(canvas, canvas->height), 0, (size_t)(rows - canvas->height) * words * sizeof *blocked);
    for (int32_t y = canvas->height; y < rows; ++y) {
        room[y] = canvas->width;
    }
    canvas->height = rows;
    return true;
}

/* Moves all bits down by `shift`, zeros after them: out[x] |= row[x + shift]. The two may be one. */
static void row_or_shifted(uint64_t *out, const uint64_t *row, int32_t words, int32_t shift)
{
    const int32_t whole = shift / WORD, part = shift % WORD;
    for (int32_t i = 0; i + whole < words; ++i) {
        uint64_t bits = row[i + whole] >> part;
        if (part > 0 && i + whole + 1 < words) {
            bits |= row[i + whole + 1] << (WORD - part);
        }
        out[i] |= bits;
    }
}

/* Makes of each bit the sum of it and the length - 1 that follow: where a run of that length would hit something. */
static void row_smear(uint64_t *row, int32_t words, int32_t length)
{
    int32_t done = 1;
    for (; 2 * done <= length; done *= 2) {
        row_or_shifted(row, row, words, done);
    }
    if (done < length) {
        row_or_shifted(row, row, words, length - done);
    }
}

/* What one look of rows that are alike, `count` of them from `first` on, leaves of row `y`, onto `hit`. */
static void rows_search(chart_canvas *canvas, const chart_shape *shape, int32_t y, int32_t first, int32_t count)
{
    const int32_t words = canvas->words;
    const uint64_t *const row = shape->bits + (size_t)first * (size_t)shape->words;
    for (int32_t x = bit_find(row, 0, shape->width, true); x < shape->width;) {
        const int32_t stop = bit_find(row, x, shape->width, false);
        memset(canvas->row, 0, (size_t)words * sizeof *canvas->row);
        for (int32_t k = first; k < first + count && y + k < canvas->height; ++k) {
            const uint64_t *const blocked = canvas_row(canvas, y + k);
            for (int32_t i = 0; i < words; ++i) {
                canvas->row[i] |= blocked[i];
            }
        }
        row_smear(canvas->row, words, stop - x);
        row_or_shifted(canvas->hit, canvas->row, words, x);
        x = bit_find(row, stop, shape->width, true);
    }
}

/* The first place of row `y`, before `end`, where the shape may begin; `end` if there is none. */
static int32_t row_search(chart_canvas *canvas, const chart_shape *shape, int32_t y, int32_t end)
{
    const int32_t words = canvas->words;
    int32_t free = canvas->gutter;
    memset(canvas->hit, 0, (size_t)words * sizeof *canvas->hit);
    for (int32_t first = 0; first < shape->height && y + first < canvas->height; first += shape->alike[first]) {
        if (free < end) {
            rows_search(canvas, shape, y, first, shape->alike[first]);
            free = bit_find(canvas->hit, free, end, false);
        }
        canvas->work += (uint64_t)(shape->alike[first] + 8) * (uint64_t)words;
    }
    return free;
}

/* The first row from `y` on whose rows, and those above it, have room for the shape's; `end` if there is none before
 * it. */
static int32_t row_with_room(const chart_canvas *canvas, const chart_shape *shape, int32_t y, int32_t end)
{
    for (int32_t k = 0; y < end && k < shape->height && y + k < canvas->height;) {
        const int32_t room = canvas->room[y + k];
        if (room < shape->least_run) { /* for none of its rows */
            y += k + 1;
            k = 0;
        } else if (room < shape->run[k]) {
            ++y;
            k = 0;
        } else {
            ++k;
        }
    }
    return y < end ? y : end;
}

/* How low what hangs `bottom[k]` below each of its columns may stand at each of `count` places from the left, no lower
 * than `floor`. @return the least */
LMB_VECTORISED
static int32_t lowest_find(int32_t *lowest, int32_t count, const int32_t *top, const int32_t *bottom, int32_t columns,
                           int32_t floor)
{
    for (int32_t i = 0; i < count; ++i) {
        lowest[i] = floor;
    }
    for (int32_t k = 0; k < columns; ++k) {
        for (int32_t i = 0; i < count; ++i) {
            const int32_t stands = top[i + k] - bottom[k];
            lowest[i] = stands > lowest[i] ? stands : lowest[i];
        }
    }
    int32_t least = INT32_MAX;
    for (int32_t i = 0; i < count; ++i) {
        least = lowest[i] < least ? lowest[i] : least;
    }
    return least;
}

/* The lowest place of a shape that is let down from above, then the leftmost. */
static bool fall_find(chart_canvas *canvas, const chart_shape *shape, int32_t *x, int32_t *y)
{
    const int32_t first = canvas->gutter, count = canvas->width - canvas->gutter - shape->width - first + 1;
    if (count <= 0) {
        return false;
    }
    *y = lowest_find(canvas->lowest, count, canvas->top + first, shape->bottom, shape->width, canvas->gutter);
    *x = first;
    while (canvas->lowest[*x - first] != *y) {
        ++*x;
    }
    canvas->work += (uint64_t)shape->width * (uint64_t)count / 4;
    return true;
}

/* The lowest place in a hole below `fallen`, then the leftmost. */
static bool hole_find(chart_canvas *canvas, const chart_shape *shape, int32_t fallen, int32_t *x, int32_t *y)
{
    const int32_t last = canvas->width - canvas->gutter - shape->width;
    const size_t slot = shape->key % CHART_SEEN;
    const bool seen = shape->key != 0 && canvas->seen[slot].key == shape->key;
    int32_t row = seen ? canvas->seen[slot].row : canvas->gutter;
    int32_t free = last + 1;
    for (; row < fallen; ++row) {
        const int32_t first = row;
        row = row_with_room(canvas, shape, row, fallen);
        canvas->work += 4 * (uint64_t)(row - first + (row < fallen));
        if (row == fallen) {
            break;
        }
        free = row_search(canvas, shape, row, last + 1);
        if (free <= last) {
            break;
        }
    }
    if (shape->key != 0) {
        canvas->seen[slot].key = shape->key;
        canvas->seen[slot].row = row;
    }
    *x = free <= last ? free : *x;
    *y = free <= last ? row : *y;
    return free <= last;
}

/* Finds the lowest place of a shape, then the leftmost, whose top is below `limit`. */
static bool place_find(chart_canvas *canvas, const chart_shape *shape, int32_t limit, int32_t *x, int32_t *y)
{
    if (!fall_find(canvas, shape, x, y)) {
        return false;
    }
    if ((int64_t)shape->width * shape->height <= MOST_SEARCHED_TEXELS) {
        const int32_t end = *y + shape->height < limit ? *y : limit - shape->height;
        if (hole_find(canvas, shape, end, x, y)) {
            return true;
        }
    }
    return *y + shape->height < limit;
}

/* One row of the shape, with the gutter left and right of it, onto one of the canvas. */
static void row_block(chart_canvas *canvas, const uint64_t *bits, int32_t width, int32_t x, int32_t y)
{
    uint64_t *const row = canvas_row(canvas, y);
    for (int32_t from = bit_find(bits, 0, width, true); from < width;) {
        const int32_t to = bit_find(bits, from, width, false);
        const int32_t left = x + from - canvas->gutter, right = x + to + canvas->gutter;
        bits_set(row, left > 0 ? left : 0, right < canvas->width ? right : canvas->width);
        from = bit_find(bits, to, width, true);
    }
}

static bool canvas_place(chart_canvas *canvas, const chart_shape *shape, int32_t x, int32_t y)
{
    const int32_t gutter = canvas->gutter;
    if (!canvas_grow(canvas, y + shape->height + gutter)) {
        return false;
    }
    for (int32_t k = 0; k < shape->height; ++k) {
        for (int32_t row = y + k - gutter; row <= y + k + gutter; ++row) {
            row_block(canvas, shape->bits + (size_t)k * (size_t)shape->words, shape->width, x, row);
        }
    }
    for (int32_t row = y - gutter; row < y + shape->height + gutter; ++row) {
        const uint64_t *const blocked = canvas_row(canvas, row);
        canvas->room[row] = longest_run(blocked, canvas->width, false);
        for (int32_t i = x - gutter; i < x + shape->width + gutter; ++i) {
            if (bit_get(blocked, i)) {
                canvas->top[i] = row + 1 > canvas->top[i] ? row + 1 : canvas->top[i];
            }
        }
    }
    canvas->used_width =
        x + shape->width + gutter > canvas->used_width ? x + shape->width + gutter : canvas->used_width;
    canvas->used_height =
        y + shape->height + gutter > canvas->used_height ? y + shape->height + gutter : canvas->used_height;
    return true;
}

bool lmb_chart_canvas_add(chart_canvas *canvas, const chart_shape *shape, int turns, int32_t most_height,
                          chart_place *place)
{
    int32_t limit = most_height - canvas->gutter + 1;
    place->turn = -1;
    for (int turn = 0; turn < turns; ++turn) {
        int32_t x = 0, y = 0;
        if (place_find(canvas, &shape[turn], limit, &x, &y)) {
            *place = (chart_place){x, y, turn};
            limit = y + shape[turn].height;
        }
    }
    return place->turn < 0 || canvas_place(canvas, &shape[place->turn], place->x, place->y);
}
