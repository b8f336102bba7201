#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "command.h"
#include "machine.h"
#include "models.h"
#include "models_blend.h"
#include "models_cones.h"
#include "models_html.h"
#include "output_file.h"
#include "query.h"

enum { MOST_TURNS = 4096 };

static const char usage[] =
    "usage: lambent models ENV... [options]\n"
    "\n"
    "Measures every lighting model on a surface under environments, pictures (.hdr or .exr, latitude-longitude) "
    "turned\n"
    "in many ways: how far its irradiance is from the truth, and how long it takes.\n"
    "\n"
    "  --turns N     turns of each environment (default 256)\n"
    "  --seed N      of the turns; 0, the default, are the published ones (docs/testing.md)\n"
    "  --threads N   default: all processors\n"
    "  --html FILE   write plots, pictures and tables as well, one page that needs no other file\n"
    "  --json        print one JSON object\n"
    "  --quiet       no progress\n"
    "\n"
    "Each environment is averaged to 128 x 64 pixels. Shading normals are spread over the hemisphere of the surface's\n"
    "normal; the truth is the irradiance of the light above its horizon. Models are given\n"
    "  lightmap      SH3 that fits the light above the horizon by least squares there, as texels have it; or, where a\n"
    "                model is not made of SH3, that light itself\n"
    "  probe         SH3 of the whole sphere\n"
    "  probe-wall    the same, where a wall of half the surface's irradiance stands below the horizon\n"
    "  probe-wall31  where one half of that wall is three times as bright as the other\n"
    "\n"
    "  rel_rmse      root mean square error of luminance over that of the truth, over all turns and normals of an\n"
    "                environment: mean and maximum over environments; colour: the same over R, G and B\n"
    "  median        of each normal's own error over the larger of its own luminance and 1 % of the turn's mean\n"
    "  p95, over_10pct  of the same: its 95th percentile, and the share above a tenth\n"
    "  ns_encode, ns_eval  nanoseconds of CPU time of one thread, of a colour: made of its input; evaluated on one "
    "normal\n"
    "  numbers, bytes  that a texel or a probe stores, for a colour\n"
    "\n"
    "Behind cones of visibility the truth is the light in the cone and above the horizon, the input the whole "
    "sphere's\n"
    "SH3, and the error the median of each normal's own relative one:\n"
    "  cone          the model's own way with a cone, about its axis\n"
    "  ao            the model of the hemisphere times the visibility, cosine-weighted\n"
    "  bent          the same with the normal bent towards the cone's axis, of models that clip nothing\n"
    "\n"
    "Two lights half and half, an environment and the next: their harmonics blended and a model made of that, beside "
    "the\n"
    "channels of two models blended.\n";

typedef struct models_options {
    models_settings settings;
    const char *html;            /* NULL: none */
    lmb_shared_arguments shared; /* of environments */
    bool json;
} models_options;

static void options_read(lmb_arguments *arguments, models_options *options)
{
    for (const char *next; (next = arguments_next(arguments));) {
        if (strcmp(next, "--turns") == 0) {
            options->settings.turns = (uint32_t)arguments_integer(arguments, next, 1, MOST_TURNS);
        } else if (strcmp(next, "--seed") == 0) {
            options->settings.seed = (uint64_t)arguments_integer(arguments, next, 0, INT64_MAX);
        } else if (strcmp(next, "--html") == 0) {
            options->html = arguments_text(arguments, next);
        } else if (strcmp(next, "--json") == 0) {
            options->json = true;
        } else {
            arguments_shared(arguments, next, &options->shared);
        }
    }
}

/* What was measured. */
typedef struct measured {
    models_map *map;
    models_report report;
    models_cone_report cones;
    models_blend_report blends;
} measured;

static cJSON *row_json(const models_row *row)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "name", lmb_model_full_name(row->model));
    cJSON_AddStringToObject(json, "input", models_input_name(row->input));
    cJSON_AddNumberToObject(json, "numbers", row->model->channel_count);
    cJSON_AddNumberToObject(json, "bytes", row->model->bytes);
    cJSON_AddBoolToObject(json, "default", row->is_default);
    cJSON_AddNumberToObject(json, "rel_rmse_mean", row->luminance.mean);
    cJSON_AddNumberToObject(json, "rel_rmse_max", row->luminance.max);
    cJSON_AddNumberToObject(json, "colour_rel_rmse_mean", row->colour.mean);
    cJSON_AddNumberToObject(json, "colour_rel_rmse_max", row->colour.max);
    cJSON_AddNumberToObject(json, "median", row->median);
    cJSON_AddNumberToObject(json, "p95", row->p95);
    cJSON_AddNumberToObject(json, "share_over_10pct", row->share_over_10pct);
    cJSON_AddNumberToObject(json, "ns_encode", row->ns_encode);
    cJSON_AddNumberToObject(json, "ns_eval", row->ns_eval);
    return json;
}

/* One object for each model, method and tilt. */
static cJSON *cones_json(const models_cone_report *cones)
{
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < cones->row_count; ++i) {
        const models_cone_row *row = &cones->row[i];
        for (int tilt = 0; tilt < MODELS_CONE_TILTS; ++tilt) {
            cJSON *json = cJSON_CreateObject();
            cJSON_AddStringToObject(json, "name", lmb_model_full_name(row->model));
            cJSON_AddStringToObject(json, "method", models_cone_method_name(row->method));
            cJSON_AddNumberToObject(json, "tilt_deg", (double)models_cone_tilt_deg[tilt]);
            cJSON_AddItemToObject(json, "median", cJSON_CreateDoubleArray(row->median[tilt], MODELS_CONE_COSINES));
            cJSON_AddItemToArray(list, json);
        }
    }
    return list;
}

static cJSON *blends_json(const models_blend_report *blends)
{
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < blends->row_count; ++i) {
        const models_blend_row *row = &blends->row[i];
        cJSON *json = cJSON_CreateObject();
        cJSON_AddStringToObject(json, "name", lmb_model_full_name(row->model));
        cJSON_AddNumberToObject(json, "rel_rmse_harmonics", row->harmonics);
        cJSON_AddNumberToObject(json, "rel_rmse_channels", row->channels);
        cJSON_AddItemToArray(list, json);
    }
    return list;
}

static int report_print_json(const models_options *options, const measured *all, const char *machine)
{
    const models_report *report = &all->report;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "machine", machine);
    cJSON *environments = cJSON_AddArrayToObject(json, "environments");
    for (size_t i = 0; i < options->shared.many_count; ++i) {
        cJSON_AddItemToArray(environments, cJSON_CreateString(options->shared.many[i]));
    }
    cJSON_AddNumberToObject(json, "turns", options->settings.turns);
    cJSON_AddNumberToObject(json, "seed", (double)options->settings.seed);
    cJSON *models = cJSON_AddArrayToObject(json, "models");
    for (size_t i = 0; i < report->row_count; ++i) {
        cJSON_AddItemToArray(models, row_json(&report->row[i]));
    }
    cJSON_AddItemToObject(json, "cone_cos", cJSON_CreateFloatArray(models_cone_cosine, MODELS_CONE_COSINES));
    cJSON_AddItemToObject(json, "cones", cones_json(&all->cones));
    cJSON_AddItemToObject(json, "blends", blends_json(&all->blends));
    return json_print_line(json);
}

static void row_print(const models_row *row)
{
    printf("%-27s %-13s%7d%6d%8.4f%8.4f%8.4f%8.4f%8.4f%8.4f%10.0f%9.1f%s\n", lmb_model_full_name(row->model),
           models_input_name(row->input), row->model->channel_count, row->model->bytes, row->luminance.mean,
           row->luminance.max, row->colour.mean, row->median, row->p95, row->share_over_10pct, row->ns_encode,
           row->ns_eval, row->is_default ? "  default" : "");
}

static void report_print(const models_options *options, const models_report *report, const char *machine)
{
    printf("%s\n%u environments, %u turns each\n\n%-27s %-13s%7s%6s%8s%8s%8s%8s%8s%8s%10s%9s\n", machine,
           options->shared.many_count, options->settings.turns, "model", "input", "numbers", "bytes", "rmse", "max",
           "colour", "median", "p95", "over10%", "ns_encode", "ns_eval");
    for (size_t i = 0; i < report->row_count; ++i) {
        if (i > 0 && report->row[i].input != report->row[i - 1].input) {
            putchar('\n');
        }
        row_print(&report->row[i]);
    }
}

static void cones_print(const models_cone_report *cones)
{
    printf("\nmedian relative error in percent behind cones\n%-27s %-5s", "tilt of the axis in degrees", "");
    for (int tilt = 0; tilt < MODELS_CONE_TILTS; ++tilt) {
        printf("  %-*.0f", 7 * MODELS_CONE_COSINES, (double)models_cone_tilt_deg[tilt]);
    }
    printf("\n%-27s %-5s", "cosine of the half angle", "");
    for (int tilt = 0; tilt < MODELS_CONE_TILTS; ++tilt) {
        printf("  ");
        for (int k = 0; k < MODELS_CONE_COSINES; ++k) {
            printf("%-7.2f", (double)models_cone_cosine[k]);
        }
    }
    for (size_t i = 0; i < cones->row_count; ++i) {
        const models_cone_row *row = &cones->row[i];
        printf("\n%-27s %-5s", lmb_model_full_name(row->model), models_cone_method_name(row->method));
        for (int tilt = 0; tilt < MODELS_CONE_TILTS; ++tilt) {
            printf("  ");
            for (int k = 0; k < MODELS_CONE_COSINES; ++k) {
                printf("%-7.1f", 100.0 * row->median[tilt][k]);
            }
        }
    }
    putchar('\n');
}

static void blends_print(const models_blend_report *blends)
{
    printf("\nrmse of two lights, half and half\n%-27s %12s %12s\n", "blended", "harmonics", "channels");
    for (size_t i = 0; i < blends->row_count; ++i) {
        const models_blend_row *row = &blends->row[i];
        printf("%-27s %12.4f %12.4f\n", lmb_model_full_name(row->model), row->harmonics, row->channels);
    }
}

static lmb_result maps_read(const models_options *options, models_map **maps, lmb_error *error)
{
    *maps = malloc(options->shared.many_count * sizeof **maps);
    if (!*maps) {
        return LMB_ERROR_MEMORY;
    }
    lmb_result result = LMB_OK;
    for (size_t i = 0; i < options->shared.many_count && result == LMB_OK; ++i) {
        result = models_map_read(options->shared.many[i], &(*maps)[i], error);
    }
    return result;
}

static lmb_result all_measure(const models_options *options, const lmb_progress *progress, measured *all,
                              lmb_error *error)
{
    lmb_pool *pool = NULL;
    lmb_result result = maps_read(options, &all->map, error);
    if (result == LMB_OK) {
        result = lmb_pool_create(options->shared.threads, &pool);
    }
    if (result == LMB_OK) {
        result = models_measure(&options->settings, all->map, options->shared.many_count, pool, progress, &all->report);
    }
    if (result == LMB_OK) {
        result =
            models_cones_measure(&options->settings, all->map, options->shared.many_count, pool, progress, &all->cones);
    }
    if (result == LMB_OK) {
        result = models_blend_measure(&options->settings, all->map, options->shared.many_count, pool, progress,
                                      &all->blends);
    }
    if (result == LMB_OK) {
        result = models_measure_speed(&options->settings, all->map, options->shared.many_count, progress, &all->report);
    }
    lmb_pool_destroy(pool);
    return result;
}

/* Reads, measures and prints. */
static int models_run(const models_options *options)
{
    lmb_error error = {""};
    measured all = {.map = NULL};
    char machine[512];
    machine_text(machine);
    lmb_result result = options->html ? output_file_check(options->html, &error) : LMB_OK;
    lmb_console console;
    const lmb_progress progress = console_progress(&console, options->shared.quiet, false);
    if (result == LMB_OK) {
        result = all_measure(options, &progress, &all, &error);
    }
    console_finish(&console);
    if (result == LMB_OK && options->html) {
        const models_page page = {&options->settings, all.map,    options->shared.many_count,
                                  &all.report,        &all.cones, machine};
        result = models_html_write(options->html, &page, &error);
    }
    int status = EXIT_DONE;
    if (result != LMB_OK) {
        status = command_fail(result, &error);
    } else if (options->json) {
        status = report_print_json(options, &all, machine);
    } else {
        report_print(options, &all.report, machine);
        cones_print(&all.cones);
        blends_print(&all.blends);
    }
    models_blend_free(&all.blends);
    models_cones_free(&all.cones);
    models_report_free(&all.report);
    free(all.map);
    return status;
}

int command_models(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "models", usage);
    const char **const paths = malloc(((size_t)count + 1) * sizeof *paths);
    if (!paths) {
        return command_fail(LMB_ERROR_MEMORY, &(lmb_error){"out of memory"});
    }
    models_options options = {
        .settings = models_settings_default(),
        .shared = {.many_name = "ENV", .many = paths, .takes = ARGUMENTS_THREADS | ARGUMENTS_QUIET}};
    options_read(&arguments, &options);
    const int status =
        arguments_complete(&arguments, &options.shared) ? models_run(&options) : arguments_status(&arguments);
    free(paths);
    return status;
}
