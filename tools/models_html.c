#define _POSIX_C_SOURCE 200809L
#include "models_html.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include "markup.h"
#include "models_picture.h"
#include "models_plot.h"

enum { MOST_PICTURES = 3 };

static const char head[] =
    "<!doctype html>\n<html lang=en><meta charset=utf-8><title>Lighting models</title>\n<style>\n"
    "body{font:14px system-ui,sans-serif;margin:2em;color:#222;background:#fff}\n"
    "svg text{font-size:10px;fill:#444}.grid{stroke:#e4e4e4}.lead{stroke:#bbb;stroke-width:.6}\n"
    "circle.ships{fill:#c33}circle.other{fill:#36c}circle.open{fill:#999}\n"
    "svg text.ships{fill:#a11;font-weight:bold}svg text.other{fill:#235}svg text.open{fill:#777}\n"
    "table{border-collapse:collapse;font-size:12px}td,th{padding:1px 8px;text-align:right;border-bottom:1px solid "
    "#eee}\n"
    "td:first-child,th:first-child{text-align:left}tr.default{font-weight:bold}\n"
    ".cells{display:flex;flex-wrap:wrap;gap:10px}figure{margin:0}figcaption{font-size:11px;text-align:center}\n"
    "h2{margin-top:2em}\n</style>\n";

static void plots_write(FILE *page, const models_page *about)
{
    for (int input = 0; input < MODELS_INPUT_COUNT; ++input) {
        fprintf(page, "<h2>%s</h2>\n", models_input_name((models_input)input));
        models_plot_write(page, about->report, (models_input)input, MODELS_COST_EVAL);
        models_plot_write(page, about->report, (models_input)input, MODELS_COST_ENCODE);
        models_plot_write(page, about->report, (models_input)input, MODELS_COST_BYTES);
    }
}

static lmb_result pictures_write(FILE *page, const models_page *about)
{
    fputs("<h2>Hemispheres</h2>\n<p>Irradiance on all shading normals of a surface seen from above, and its difference "
          "from the truth: red too bright, blue too dark, in full colour at 30 % of the mean.</p>\n",
          page);
    const size_t count = about->map_count < MOST_PICTURES ? about->map_count : MOST_PICTURES;
    lmb_result result = LMB_OK;
    for (size_t i = 0; i < count && result == LMB_OK; ++i) {
        const models_map *map = &about->map[i * about->map_count / count];
        fputs("<h3>", page);
        markup_text(page, map->name);
        fputs("</h3>\n", page);
        for (int input = MODELS_LIGHTMAP; input <= MODELS_PROBE_WALL && result == LMB_OK; ++input) {
            result = models_picture_write(page, (int)i * MODELS_INPUT_COUNT + input, about->settings, map,
                                          (models_input)input);
        }
    }
    return result;
}

static void rows_write(FILE *page, const models_report *report)
{
    fputs("<h2>Errors and costs</h2>\n<table><tr><th>model<th>input<th>numbers<th>bytes<th>rel. RMSE<th>max<th>in "
          "colour<th>median<th>p95<th>share over 10 %<th>ns to encode<th>ns to evaluate<th>what it is\n",
          page);
    for (size_t i = 0; i < report->row_count; ++i) {
        const models_row *row = &report->row[i];
        fprintf(page,
                "<tr%s><td>%s<td>%s<td>%d<td>%d<td>%.4f<td>%.4f<td>%.4f<td>%.4f<td>%.4f<td>%.4f<td>%.0f<td>%.1f<td>%s"
                "\n",
                row->is_default ? " class=default" : "", lmb_model_full_name(row->model), models_input_name(row->input),
                row->model->channel_count, row->model->bytes, row->luminance.mean, row->luminance.max, row->colour.mean,
                row->median, row->p95, row->share_over_10pct, row->ns_encode, row->ns_eval, row->model->title);
    }
    fputs("</table>\n", page);
}

static void cones_write(FILE *page, const models_cone_report *cones)
{
    fprintf(page,
            "<h2>Behind cones of visibility</h2>\n<p>Median error in percent of each shading normal's irradiance; the "
            "input is the whole sphere's SH3. cone: the model's own way with a cone; ao: the hemisphere's model times "
            "the cosine-weighted visibility; bent: the same with the normal bent towards the axis.</p>\n"
            "<table><tr><th>tilt of the axis<th>");
    for (int tilt = 0; tilt < MODELS_CONE_TILTS; ++tilt) {
        fprintf(page, "<th colspan=%d>%.0f&deg;", MODELS_CONE_COSINES, (double)models_cone_tilt_deg[tilt]);
    }
    fputs("\n<tr><th>cosine of the half angle<th>", page);
    for (int i = 0; i < MODELS_CONE_TILTS * MODELS_CONE_COSINES; ++i) {
        fprintf(page, "<th>%g", (double)models_cone_cosine[i % MODELS_CONE_COSINES]);
    }
    for (size_t i = 0; i < cones->row_count; ++i) {
        const models_cone_row *row = &cones->row[i];
        fprintf(page, "\n<tr><td>%s<td>%s", lmb_model_full_name(row->model), models_cone_method_name(row->method));
        for (int k = 0; k < MODELS_CONE_TILTS * MODELS_CONE_COSINES; ++k) {
            fprintf(page, "<td>%.1f", 100.0 * row->median[k / MODELS_CONE_COSINES][k % MODELS_CONE_COSINES]);
        }
    }
    fputs("\n</table>\n", page);
}

static lmb_result page_write(FILE *page, const models_page *about)
{
    fputs(head, page);
    fputs("<h1>Lighting models</h1>\n<p>", page);
    markup_text(page, about->machine);
    fprintf(page, ". %u turns each of ", about->settings->turns);
    for (size_t i = 0; i < about->map_count; ++i) {
        fputs(i > 0 ? ", " : "", page);
        markup_text(page, about->map[i].name);
    }
    fputs(".</p>\n<p>Red: ships with the sampler (* is what a bake and a game take). Blue: to be compared with. Grey: "
          "clips no light.</p>\n",
          page);
    plots_write(page, about);
    const lmb_result result = pictures_write(page, about);
    rows_write(page, about->report);
    cones_write(page, about->cones);
    fputs("</html>\n", page);
    return result;
}

lmb_result models_html_write(const char *path, const models_page *page, lmb_error *error)
{
    char *text = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    if (!memory) {
        return LMB_ERROR_MEMORY;
    }
    lmb_result result = page_write(memory, page);
    if (fclose(memory) != 0) {
        result = LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        result = lmb_file_write(path, text, size, error);
    }
    free(text);
    return result;
}
