#define _POSIX_C_SOURCE 200809L
#include "bench_plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include "markup.h"

/* Pixels. A panel is a title, a plot with numbers on its left and names on its right, and numbers beneath. */
enum {
    HEAD = 50,
    TITLE = 30,
    LEFT = 56,
    WIDTH = 330,
    NAMES = 152,
    HEIGHT = 320,
    BENEATH = 46,
    ROW = 17,
    NAME_HEIGHT = 12,
    PANEL_WIDTH = LEFT + WIDTH + NAMES,
    PANEL_HEIGHT = TITLE + HEIGHT + BENEATH
};

#define TO_BASELINE 3.5 /* from the middle of a line of text */

/* The picture: volumes from small to large, the samplers of all of them, and the logarithms at the plots' edges. */
typedef struct picture {
    FILE *page;
    int volume_count;
    const lmb_bench_volume **volume;
    int series_count;
    const char *series[BENCH_MOST_SAMPLERS];
    double low[2], high[2];
} picture;

/* One plot of it. */
typedef struct panel {
    double left, top; /* of the plot itself */
    int load, pattern;
} panel;

static const char style[] =
    "<style>\n"
    "text{font:11px system-ui,sans-serif;fill:#444}.title{font-weight:600;font-size:13px}.page{fill:#fff}\n"
    ".grid{stroke:#e6e6e6}.lead{stroke-width:.6;opacity:.7}polyline{fill:none;stroke-width:1.8}circle{fill:#fff}\n"
    ".ahead polyline{stroke-dasharray:5 3}.number{text-anchor:end}.middle{text-anchor:middle}\n"
    ".f0 *{stroke:#00797a}.f1 *{stroke:#8a3ab9}.f2 *{stroke:#0b5fd0}.f3 *{stroke:#b34700}.f4 *{stroke:#876400}\n"
    ".f5 *{stroke:#1e7d32}.f6 *{stroke:#c21f3a}.f7 *{stroke:#666}\n"
    ".f0 text{fill:#00797a}.f1 text{fill:#8a3ab9}.f2 text{fill:#0b5fd0}.f3 text{fill:#b34700}.f4 text{fill:#876400}\n"
    ".f5 text{fill:#1e7d32}.f6 text{fill:#c21f3a}.f7 text{fill:#666}g text{stroke:none!important}\n"
    "@media(prefers-color-scheme:dark){\n"
    "text{fill:#bbb}.page,circle{fill:#0f1318}.grid{stroke:#2b3138}\n"
    ".f0 *{stroke:#35c5c6}.f1 *{stroke:#c792ea}.f2 *{stroke:#6aa9ff}.f3 *{stroke:#ff9d5c}.f4 *{stroke:#dcb83e}\n"
    ".f5 *{stroke:#67c97b}.f6 *{stroke:#ff7d92}.f7 *{stroke:#999}\n"
    ".f0 text{fill:#35c5c6}.f1 text{fill:#c792ea}.f2 text{fill:#6aa9ff}.f3 text{fill:#ff9d5c}.f4 text{fill:#dcb83e}\n"
    ".f5 text{fill:#67c97b}.f6 text{fill:#ff7d92}.f7 text{fill:#999}}\n"
    "</style>\n";

/* The colour of a sampler's class: those of one way to hold light are alike. */
static int family_of(const char *name)
{
    static const char *const begins[] = {"lambent.compact", "lambent.cut", "lambent", "dense.fp32",
                                         "dense.fp16",      "nanovdb",     "openvdb", "lambent.tiles"};
    int family = 0;
    size_t longest = 0;
    for (int i = 0; i < (int)(sizeof begins / sizeof begins[0]); ++i) {
        const size_t length = strlen(begins[i]);
        if (length > longest && strncmp(name, begins[i], length) == 0) {
            family = i;
            longest = length;
        }
    }
    return family;
}

/* Whether it asks for memory ahead of use. */
static bool is_ahead(const char *name)
{
    const char *const last = strrchr(name, '.');
    return last && (strcmp(last, ".batch") == 0 || strcmp(last, ".prefetch") == 0);
}

static const lmb_bench_volume_row *row_find(const lmb_bench_volume *volume, const char *name)
{
    for (int i = 0; i < volume->row_count; ++i) {
        if (strcmp(volume->row[i].name, name) == 0) {
            return &volume->row[i];
        }
    }
    return NULL; /* a box too large for it */
}

static double across(const picture *made, const panel *at, double probes)
{
    return at->left + WIDTH * (log10(probes) - made->low[0]) / (made->high[0] - made->low[0]);
}

static double down(const picture *made, const panel *at, double ns)
{
    return at->top + HEIGHT * (made->high[1] - log10(ns)) / (made->high[1] - made->low[1]);
}

/* 300 k, 1 M */
static void count_text(double value, char text[32])
{
    const bool millions = value >= 1e6, thousands = value >= 1e3;
    snprintf(text, 32, "%.4g%s",
             value / (millions    ? 1e6
                      : thousands ? 1e3
                                  : 1.0),
             millions    ? " M"
             : thousands ? " k"
                         : "");
}

/* Lines at 1 and 3 of each decade of probes, and at 1, 2 and 5 of ns. */
static void grid_write(const picture *made, const panel *at, int axis)
{
    static const double steps[2][3] = {{1.0, 3.0, INFINITY}, {1.0, 2.0, 5.0}};
    for (int i = 3 * (int)floor(made->low[axis]); i <= 3 * (int)ceil(made->high[axis]); ++i) {
        const int decade = (int)floor(i / 3.0);
        const double value = steps[axis][i - 3 * decade] * pow(10.0, decade);
        if (log10(value) < made->low[axis] || log10(value) > made->high[axis]) {
            continue;
        }
        if (axis == 0) {
            char text[32];
            const double x = across(made, at, value);
            count_text(value, text);
            fprintf(made->page,
                    "<path class='grid' d='M%.1f %.1fv%d'/><text class='middle' x='%.1f' y='%.1f'>%s</text>\n", x,
                    at->top, HEIGHT, x, at->top + HEIGHT + 16, text);
        } else {
            const double y = down(made, at, value);
            fprintf(made->page,
                    "<path class='grid' d='M%.1f %.1fh%d'/><text class='number' x='%.1f' y='%.1f'>%g</text>\n",
                    at->left, y, WIDTH, at->left - 6, y + TO_BASELINE, value);
        }
    }
}

/* Moves names that overlap apart, and none out of the plot: those that must move together by the least squares. */
static void names_spread(double *y, int count, double top, double bottom)
{
    int order[BENCH_MOST_SAMPLERS], first[BENCH_MOST_SAMPLERS], groups = 0;
    double begin[BENCH_MOST_SAMPLERS]; /* where a group's first name is */
    for (int i = 0; i < count; ++i) {
        int k = i;
        for (; k > 0 && y[order[k - 1]] > y[i]; --k) {
            order[k] = order[k - 1];
        }
        order[k] = i;
    }
    for (int i = 0; i < count; ++i) {
        first[groups] = i;
        begin[groups++] = y[order[i]];
        for (;;) {
            const int b = first[groups - 1];
            double *const last = &begin[groups - 1];
            *last = fmax(top, fmin(*last, bottom - NAME_HEIGHT * (i - b)));
            const int a = groups > 1 ? first[groups - 2] : b;
            const double room = NAME_HEIGHT * (b - a);
            if (a == b || *last >= last[-1] + room) {
                break;
            }
            last[-1] = (last[-1] * (b - a) + (*last - room) * (i + 1 - b)) / (i + 1 - a);
            --groups;
        }
    }
    for (int group = 0; group < groups; ++group) {
        const int end = group + 1 < groups ? first[group + 1] : count;
        for (int i = first[group]; i < end; ++i) {
            y[order[i]] = begin[group] + NAME_HEIGHT * (i - first[group]);
        }
    }
}

/* The last point of a series. @return false when it has none */
static bool series_end(const picture *made, const panel *at, const char *name, double end[2])
{
    for (int i = made->volume_count - 1; i >= 0; --i) {
        const lmb_bench_volume_row *const row = row_find(made->volume[i], name);
        if (row) {
            end[0] = across(made, at, made->volume[i]->probes);
            end[1] = down(made, at, row->ns_per_sample[at->load][at->pattern]);
            return true;
        }
    }
    return false;
}

static void group_begin(FILE *page, const char *name)
{
    fprintf(page, "<g class='f%d%s'>", family_of(name), is_ahead(name) ? " ahead" : "");
}

/* A line, its points, and the name at its end, at the height of `name_y`. */
static void series_write(const picture *made, const panel *at, const char *name, double name_y)
{
    double end[2];
    if (!series_end(made, at, name, end)) {
        return;
    }
    group_begin(made->page, name);
    fprintf(made->page, "<title>%s</title><polyline points='", name);
    for (int i = 0; i < made->volume_count; ++i) {
        const lmb_bench_volume_row *const row = row_find(made->volume[i], name);
        if (row) {
            fprintf(made->page, "%.1f,%.1f ", across(made, at, made->volume[i]->probes),
                    down(made, at, row->ns_per_sample[at->load][at->pattern]));
        }
    }
    fputs("'/>", made->page);
    for (int i = 0; i < made->volume_count; ++i) {
        const lmb_bench_volume_row *const row = row_find(made->volume[i], name);
        if (row) {
            const double ns = row->ns_per_sample[at->load][at->pattern];
            fprintf(made->page, "<circle cx='%.1f' cy='%.1f' r='2.6'><title>%s: %d probes, %.1f ns</title></circle>",
                    across(made, at, made->volume[i]->probes), down(made, at, ns), name, made->volume[i]->probes, ns);
        }
    }
    const double x = at->left + WIDTH;
    fprintf(made->page, "<path class='lead' d='M%.1f %.1fL%.1f %.1f'/><text x='%.1f' y='%.1f'>%s</text></g>\n",
            end[0] + 4, end[1], x + 14, name_y, x + 17, name_y + TO_BASELINE, name);
}

static void panel_write(const picture *made, const panel *at)
{
    double end[2], name_y[BENCH_MOST_SAMPLERS];
    const int threads = bench_volume_threads(made->volume[0], at->load);
    fprintf(made->page, "<text class='title' x='%.1f' y='%.1f'>%s, %d thread%s</text>\n", at->left, at->top - 10,
            at->pattern == BENCH_COHERENT ? "Coherent" : "Random", threads, threads > 1 ? "s" : "");
    grid_write(made, at, 0);
    grid_write(made, at, 1);
    fprintf(made->page,
            "<text class='middle' x='%.1f' y='%.1f'>probes</text>"
            "<text class='middle' transform='translate(%.1f %.1f) rotate(-90)'>ns a sample, CPU time</text>\n",
            at->left + WIDTH / 2.0, at->top + HEIGHT + 32, at->left - 42, at->top + HEIGHT / 2.0);
    for (int i = 0; i < made->series_count; ++i) {
        name_y[i] = series_end(made, at, made->series[i], end) ? end[1] : at->top;
    }
    names_spread(name_y, made->series_count, at->top, at->top + HEIGHT);
    for (int i = 0; i < made->series_count; ++i) {
        series_write(made, at, made->series[i], name_y[i]);
    }
}

/* Of the largest volume that has it: the last row of the picture. */
static void table_write(const picture *made, double top)
{
    const int half = (made->series_count + 1) / 2;
    for (int column = 0; column < 2; ++column) {
        const double left = column * PANEL_WIDTH + LEFT;
        fprintf(made->page,
                "<text class='number' x='%.1f' y='%.1f'>bytes a probe</text>"
                "<text class='number' x='%.1f' y='%.1f'>rel. error</text>\n",
                left + 270, top, left + 350, top);
    }
    for (int i = 0; i < made->series_count; ++i) {
        const lmb_bench_volume_row *row = NULL;
        for (int k = made->volume_count - 1; k >= 0 && !row; --k) {
            row = row_find(made->volume[k], made->series[i]);
        }
        const double left = i / half * PANEL_WIDTH + LEFT, y = top + ROW * (1 + i % half);
        group_begin(made->page, row->name);
        fprintf(
            made->page,
            "<polyline points='%.1f,%.1f %.1f,%.1f'/><text x='%.1f' y='%.1f'>%s</text></g>"
            "<text class='number' x='%.1f' y='%.1f'>%.1f</text><text class='number' x='%.1f' y='%.1f'>%.1e</text>\n",
            left, y - TO_BASELINE, left + 26, y - TO_BASELINE, left + 34, y, row->name, left + 270, y,
            row->bytes_per_probe, left + 350, y, row->rel_rmse[BENCH_RANDOM]);
    }
}

static void picture_write(const picture *made, const char *machine)
{
    const int loads = bench_volume_loads(made->volume[0]);
    const int width = BENCH_PATTERNS * PANEL_WIDTH, table = HEAD + loads * PANEL_HEIGHT + ROW;
    const int height = table + ROW * ((made->series_count + 1) / 2 + 1);
    fprintf(made->page, "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %d %d' width='%d' height='%d'>\n%s",
            width, height, width, height, style);
    fprintf(made->page, "<rect class='page' width='%d' height='%d'/>\n<text class='title' x='%d' y='20'>", width,
            height, LEFT);
    fputs("What a sample costs, by probes</text>\n", made->page);
    fprintf(made->page, "<text x='%d' y='38'>", LEFT);
    markup_text(made->page, machine);
    fputs(". Dashed: asks for memory ahead of use. Bytes and errors: of the largest volume.</text>\n", made->page);
    for (int load = 0; load < loads; ++load) {
        for (int pattern = 0; pattern < BENCH_PATTERNS; ++pattern) {
            const panel at = {pattern * PANEL_WIDTH + LEFT, HEAD + load * PANEL_HEIGHT + TITLE, load, pattern};
            panel_write(made, &at);
        }
    }
    table_write(made, table);
    fputs("</svg>\n", made->page);
}

static bool series_has(const picture *made, const char *name)
{
    for (int i = 0; i < made->series_count; ++i) {
        if (strcmp(made->series[i], name) == 0) {
            return true;
        }
    }
    return false;
}

static void value_fit(picture *made, int axis, double value)
{
    made->low[axis] = fmin(made->low[axis], log10(value) - 0.06);
    made->high[axis] = fmax(made->high[axis], log10(value) + 0.06);
}

/* Finds the samplers, and what the axes hold. */
static void picture_fit(picture *made)
{
    for (int axis = 0; axis < 2; ++axis) {
        made->low[axis] = INFINITY;
        made->high[axis] = -INFINITY;
    }
    for (int i = 0; i < made->volume_count; ++i) {
        const lmb_bench_volume *const volume = made->volume[i];
        value_fit(made, 0, volume->probes);
        for (int k = 0; k < volume->row_count; ++k) {
            if (!series_has(made, volume->row[k].name)) {
                made->series[made->series_count++] = volume->row[k].name;
            }
            for (int j = 0; j < bench_volume_loads(volume) * BENCH_PATTERNS; ++j) {
                value_fit(made, 1, volume->row[k].ns_per_sample[j / BENCH_PATTERNS][j % BENCH_PATTERNS]);
            }
        }
    }
}

static int compare_probes(const void *a, const void *b)
{
    const int32_t x = (*(const lmb_bench_volume *const *)a)->probes, y = (*(const lmb_bench_volume *const *)b)->probes;
    return (x > y) - (x < y);
}

lmb_result bench_plot_write(const char *path, const lmb_bench_volume *bench, int count, const char *machine,
                            lmb_error *error)
{
    char *text = NULL;
    size_t size = 0;
    picture made = {.volume_count = count, .volume = malloc((size_t)count * sizeof *made.volume)};
    made.page = made.volume ? open_memstream(&text, &size) : NULL;
    if (!made.page) {
        free(made.volume);
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    }
    for (int i = 0; i < count; ++i) {
        made.volume[i] = &bench[i];
    }
    qsort(made.volume, (size_t)count, sizeof *made.volume, compare_probes);
    picture_fit(&made);
    picture_write(&made, machine);
    lmb_result result = LMB_OK;
    if (fclose(made.page) != 0) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    }
    if (result == LMB_OK) {
        result = lmb_file_write(path, text, size, error);
    }
    free(text);
    free(made.volume);
    return result;
}
