#include "models_plot.h"

#include <math.h>

/* Pixels. */
enum { WIDTH = 760, HEIGHT = 460, LEFT = 60, RIGHT = 40, TOP = 16, BOTTOM = 44, LABEL_HEIGHT = 11, MOST_LABELS = 128 };

#define LETTER_WIDTH 5.6
#define TO_BASELINE 3.5 /* from a label's middle */
#define POINT 4.0       /* radius */

static double cost_of(const models_row *row, models_cost cost)
{
    return cost == MODELS_COST_EVAL     ? row->ns_eval
           : cost == MODELS_COST_ENCODE ? row->ns_encode
                                        : (double)row->model->bytes;
}

/* Logarithms of what is plotted, and their place on the page. */
typedef struct plot_axes {
    double low[2], high[2];
} plot_axes;

static bool row_is_shown(const models_row *row, models_input input, models_cost cost)
{
    /* Encoding thousands of samples is no cost beside encoding SH3. */
    return row->input == input && row->luminance.mean > 0.0 && cost_of(row, cost) > 0.0 &&
           (cost != MODELS_COST_ENCODE || row->model->encode);
}

static plot_axes axes_fit(const models_report *report, models_input input, models_cost cost)
{
    plot_axes axes = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (size_t i = 0; i < report->row_count; ++i) {
        const models_row *row = &report->row[i];
        if (!row_is_shown(row, input, cost)) {
            continue;
        }
        const double at[2] = {log10(cost_of(row, cost)), log10(row->luminance.mean)};
        for (int axis = 0; axis < 2; ++axis) {
            axes.low[axis] = fmin(axes.low[axis], at[axis] - 0.08);
            axes.high[axis] = fmax(axes.high[axis], at[axis] + 0.08);
        }
    }
    axes.high[0] += 0.12 * (axes.high[0] - axes.low[0]); /* for names */
    return axes;
}

static double across(const plot_axes *axes, double value)
{
    return LEFT + (WIDTH - LEFT - RIGHT) * (log10(value) - axes->low[0]) / (axes->high[0] - axes->low[0]);
}

static double down(const plot_axes *axes, double value)
{
    return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (log10(value) - axes->low[1]) / (axes->high[1] - axes->low[1]);
}

/* Lines at 1, 2 and 5 of each decade. */
static void grid_write(FILE *page, const plot_axes *axes, int axis)
{
    static const double steps[3] = {1.0, 2.0, 5.0};
    for (int decade = (int)floor(axes->low[axis]); decade <= (int)axes->high[axis]; ++decade) {
        for (int i = 0; i < 3; ++i) {
            const double value = steps[i] * pow(10.0, decade);
            if (log10(value) < axes->low[axis] || log10(value) > axes->high[axis]) {
                continue;
            }
            if (axis == 0) {
                const double x = across(axes, value);
                fprintf(page,
                        "<line class=grid x1='%.1f' x2='%.1f' y1='%d' y2='%d'/><text x='%.1f' y='%d' "
                        "text-anchor=middle>%g</text>",
                        x, x, TOP, HEIGHT - BOTTOM, x, HEIGHT - BOTTOM + 14, value);
            } else {
                const double y = down(axes, value);
                fprintf(page,
                        "<line class=grid x1='%d' x2='%d' y1='%.1f' y2='%.1f'/><text x='%d' y='%.1f' "
                        "text-anchor=end>%g</text>",
                        LEFT, WIDTH - RIGHT, y, y, LEFT - 5, y + TO_BASELINE, value);
            }
        }
    }
}

typedef struct label_box {
    double x0, x1, y;
} label_box;

static bool label_is_free(const label_box *placed, int count, const label_box *box)
{
    for (int i = 0; i < count; ++i) {
        if (box->x0 < placed[i].x1 && placed[i].x0 < box->x1 && fabs(box->y - placed[i].y) < LABEL_HEIGHT) {
            return false;
        }
    }
    return box->y > TOP && box->y < HEIGHT - BOTTOM;
}

/* Beside the point or, where other names are, above or below that; on its left where there is no room on the right. */
static label_box label_place(const label_box *placed, int count, double x, double y, double width)
{
    const bool left = x + 6.0 + width > WIDTH;
    const double x0 = left ? x - 6.0 - width : x + 6.0;
    label_box box = {x0, x0 + width, y + TO_BASELINE};
    for (int step = 1; step < 60 && !label_is_free(placed, count, &box); ++step) {
        box.y = y + TO_BASELINE + (step % 2 == 0 ? -1.0 : 1.0) * 0.5 * LABEL_HEIGHT * ((step + 1) / 2);
    }
    return box;
}

static const char *point_class(const lmb_model *model)
{
    return model->at_run_time ? "ships" : model->unoccluded ? "open" : "other";
}

static void points_write(FILE *page, const plot_axes *axes, const models_report *report, models_input input,
                         models_cost cost)
{
    label_box placed[2 * MOST_LABELS];
    int count = 0;
    for (size_t i = 0; i < report->row_count && count < MOST_LABELS; ++i) {
        const models_row *row = &report->row[i];
        if (row_is_shown(row, input, cost)) { /* no name over a point */
            const double x = across(axes, cost_of(row, cost));
            placed[count++] = (label_box){x - POINT, x + POINT, down(axes, row->luminance.mean) + TO_BASELINE};
        }
    }
    for (size_t i = 0; i < report->row_count; ++i) {
        const models_row *row = &report->row[i];
        if (!row_is_shown(row, input, cost) || count == 2 * MOST_LABELS) {
            continue;
        }
        const char *name = lmb_model_full_name(row->model);
        const double x = across(axes, cost_of(row, cost)), y = down(axes, row->luminance.mean);
        const label_box box = label_place(placed, count, x, y, LETTER_WIDTH * (double)snprintf(NULL, 0, "%s", name));
        placed[count++] = box;
        fprintf(page, "<line class=lead x1='%.1f' y1='%.1f' x2='%.1f' y2='%.1f'/>", x, y, box.x0 < x ? box.x1 : box.x0,
                box.y - TO_BASELINE);
        fprintf(page,
                "<circle class=%s cx='%.1f' cy='%.1f' r=4><title>%s: %s; error %.4f (max %.4f), %d bytes, %.0f ns to "
                "encode, %.1f ns to evaluate</title></circle>",
                point_class(row->model), x, y, name, row->model->title, row->luminance.mean, row->luminance.max,
                row->model->bytes, row->ns_encode, row->ns_eval);
        fprintf(page, "<text class=%s x='%.1f' y='%.1f'>%s%s</text>\n", point_class(row->model), box.x0, box.y, name,
                row->is_default ? " *" : "");
    }
}

void models_plot_write(FILE *page, const models_report *report, models_input input, models_cost cost)
{
    static const char *const about[] = {"ns to evaluate a colour on a normal", "ns to encode a colour",
                                        "bytes of a texel or probe"};
    const plot_axes axes = axes_fit(report, input, cost);
    fprintf(page, "<svg viewBox='0 0 %d %d' width=%d height=%d>\n", WIDTH, HEIGHT, WIDTH, HEIGHT);
    grid_write(page, &axes, 0);
    grid_write(page, &axes, 1);
    fprintf(page,
            "\n<text x='%d' y='%d' text-anchor=middle>%s</text><text x='14' y='%d' text-anchor=middle "
            "transform='rotate(-90 14 %d)'>relative RMSE, mean over environments</text>\n",
            (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, about[cost], HEIGHT / 2, HEIGHT / 2);
    points_write(page, &axes, report, input, cost);
    fputs("</svg>\n", page);
}
