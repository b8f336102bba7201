#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include <lambent/baked.h>

#include "bake_arguments.h"
#include "check.h"
#include "check_limits.h"

static const char usage[] =
    "usage: lambent check LEVEL DIR [options]\n"
    "\n"
    "Measures the bake in DIR against a path-traced reference of LEVEL: how far probes and lightmaps are from the\n"
    "truth and from each other, and how much light leaks.\n"
    "\n"
    "  --points N    random points on surfaces, and as many in free space (default: 1000, or up to 8000 if the\n"
    "                standard error of a rel_rmse is above a tenth of it)\n"
    "  --samples N   samples of each of the reference's two halves, at each point (default 256), and up to 16 times\n"
    "                as many where they leave it uncertain by more than 2 % of the light there\n"
    "  --seed N      of points, normals and reference (default 0)\n"
    "  --model NAME  measure the lightmaps of that model, which the bake wrote beside its own (bake --models)\n"
    "  --threads N   default: all processors\n"
    "  --fail-above NAME=VALUE...\n"
    "                exit with 1 when that figure of --json is above VALUE: probe_vs_reference (its rel_rmse),\n"
    "                probe_vs_reference.p95, leak, ... (repeatable)\n"
    "  --json        print one JSON object\n"
    "  --quiet       no progress\n"
    "\n"
    "All errors are of normalised irradiance on 8 normals a point:\n"
    "  rel_rmse      root mean square over points, normals and channels, free of the reference's own noise, relative\n"
    "                to the reference's (in ..._vs_lightmap the lightmap's): a few very bright points decide it\n"
    "  std_error     of rel_rmse, from the spread between points\n"
    "  median, p95, max\n"
    "                of the points' own errors, each relative to the reference there, or to 1 % of its mean if that\n"
    "                is more; the reference's noise spreads p95 and max\n"
    "  share_over_10pct\n"
    "                share of the points that are off by more than a tenth of their own light: what an eye would see\n"
    "local_set_vs_reference is of nodes that the level wants lit by their local sets in place of texels, and\n"
    "local_set_by_volume_vs_reference of the same local_points by the volume. Both are missing where there are none.\n"
    "reference_std_error is the reference's own noise, coincident_std_error that of the probes traced at the very\n"
    "points, which counts as their error; both are relative root mean squares. leak is the mean of max(0, probe -\n"
    "reference) at points whose reference is below 1 % of the mean, over the mean; leak_points counts them (leak is 0\n"
    "when there are none). denoised says whether the bake is. seam_step_median and seam_step_p95 are steps of the\n"
    "lightmap's light between charts that meet on a smooth surface, relative to the light there, over points a texel\n"
    "apart.\n";

typedef struct check_options {
    lmb_shared_arguments shared; /* LEVEL and DIR */
    check_settings settings;
    check_limits limits;
    const lmb_model *model; /* NULL: the bake's own */
    bool json;
} check_options;

static bool options_read(lmb_arguments *arguments, check_options *options)
{
    for (const char *next; (next = arguments_next(arguments));) {
        if (strcmp(next, "--points") == 0) {
            options->settings.points = (uint32_t)arguments_integer(arguments, next, 1, 10000000);
            options->settings.max_points = options->settings.points;
        } else if (strcmp(next, "--samples") == 0) {
            options->settings.samples = (uint32_t)arguments_integer(arguments, next, 1, 100000000);
        } else if (strcmp(next, "--seed") == 0) {
            options->settings.seed = (uint64_t)arguments_integer(arguments, next, 0, INT64_MAX);
        } else if (strcmp(next, "--model") == 0) {
            options->model = lightmap_model_argument(arguments, next);
        } else if (strcmp(next, "--fail-above") == 0) {
            check_limits_read(&options->limits, arguments, next);
        } else if (strcmp(next, "--json") == 0) {
            options->json = true;
        } else {
            arguments_shared(arguments, next, &options->shared);
        }
    }
    return arguments_complete(arguments, &options->shared);
}

/* Adds a number, or null for NaN. */
static void json_add_number(cJSON *object, const char *key, double value)
{
    if (isnan(value)) {
        cJSON_AddNullToObject(object, key);
    } else {
        cJSON_AddNumberToObject(object, key, value);
    }
}

static void json_add_error(cJSON *object, const char *key, const error_summary *error)
{
    if (isnan(error->rel_rmse)) {
        cJSON_AddNullToObject(object, key);
        return;
    }
    cJSON *figures = cJSON_AddObjectToObject(object, key);
    json_add_number(figures, "rel_rmse", error->rel_rmse);
    json_add_number(figures, "std_error", error->std_error);
    json_add_number(figures, "median", error->median);
    json_add_number(figures, "p95", error->p95);
    json_add_number(figures, "share_over_10pct", error->share_over_10pct);
    json_add_number(figures, "max", error->max);
}

/* Of interpolation; NAN where probes are even. */
static double tolerance_of(const lmb_bake_settings *baked)
{
    return baked->min_spacing > 0.0f ? baked->tolerance : (double)NAN;
}

static lmb_result report_print_json(const check_options *options, const check_report *report,
                                    const lmb_bake_settings *baked, lmb_error *error)
{
    cJSON *object = cJSON_CreateObject();
    json_add_number(object, "points", (double)report->points);
    json_add_number(object, "free_points", (double)report->free_points);
    json_add_number(object, "samples", 2.0 * options->settings.samples);
    json_add_number(object, "seed", (double)options->settings.seed);
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        json_add_error(object, check_pair_name((check_pair)pair), &report->error[pair]);
    }
    json_add_number(object, "local_points", (double)report->local_points);
    json_add_error(object, "local_set_vs_reference", &report->local);
    json_add_error(object, "local_set_by_volume_vs_reference", &report->local_field);
    json_add_number(object, "reference_mean", report->leak.reference_mean);
    json_add_number(object, "reference_std_error", report->leak.reference_std_error);
    json_add_number(object, "coincident_std_error", report->coincident_std_error);
    json_add_number(object, "leak", report->leak.leak);
    json_add_number(object, "leak_points", (double)report->leak.dark_points);
    json_add_number(object, "lightmap_leak", report->lightmap_leak);
    json_add_number(object, "seam_step_median", report->seam_step_median);
    json_add_number(object, "seam_step_p95", report->seam_step_p95);
    json_add_number(object, "tolerance", tolerance_of(baked));
    cJSON_AddBoolToObject(object, "denoised", baked->denoise);
    char *text = object ? cJSON_Print(object) : NULL;
    cJSON_Delete(object);
    if (!text) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    const int printed = puts(text);
    cJSON_free(text);
    return printed < 0 ? lmb_error_set(error, LMB_ERROR_WRITE, "standard output: cannot write") : LMB_OK;
}

static void print_percent(double value)
{
    if (isnan(value)) {
        printf("%11s", "-");
    } else {
        printf("%9.3f %%", 100.0 * value);
    }
}

static void error_print(const char *name, const error_summary *error)
{
    printf("%-30s", name);
    print_percent(error->rel_rmse);
    print_percent(error->std_error);
    print_percent(error->median);
    print_percent(error->p95);
    print_percent(error->share_over_10pct);
    print_percent(error->max);
    putchar('\n');
}

static void errors_print(const check_report *report)
{
    printf("%-30s%11s%11s%11s%11s%11s%11s\n", "relative error of irradiance", "rel. RMSE", "+-", "median", "p95",
           "over 10 %", "max");
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        error_print(check_pair_name((check_pair)pair), &report->error[pair]);
    }
    if (report->local_points > 0) {
        error_print("local_set_vs_reference", &report->local);
        error_print("  the same by the volume", &report->local_field);
    }
}

/* A sentence for each line. */
static void seen_print(const check_report *report)
{
    printf("\nwhat an eye would see:\n");
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        const error_summary *error = &report->error[pair];
        if (!isnan(error->rel_rmse)) {
            printf("  %s: half of all places are within %.1f %%, %.1f in 100 are off by more than a tenth\n",
                   check_pair_seen((check_pair)pair), 100.0 * error->median, 100.0 * error->share_over_10pct);
        }
    }
    if (report->local_points > 0) {
        printf("  nodes lit by local sets, beside the truth: half of %zu places are within %.1f %%, %.1f in 100 are "
               "off by "
               "more than a tenth\n",
               report->local_points, 100.0 * report->local.median, 100.0 * report->local.share_over_10pct);
    }
    putchar('\n');
}

static void report_print_table(const check_options *options, const check_report *report, const lmb_bake_settings *baked)
{
    errors_print(report);
    printf("%-30s", "reference_std_error");
    print_percent(report->leak.reference_std_error);
    printf("\n%-30s", "coincident_std_error");
    print_percent(report->coincident_std_error);
    printf("\n%-30s", "leak");
    print_percent(report->leak.leak);
    printf("   at %zu of %zu points\n", report->leak.dark_points, report->points);
    if (!isnan(report->lightmap_leak)) {
        printf("%-30s", "lightmap_leak");
        print_percent(report->lightmap_leak);
        printf("\n%-30s", "seam_step (median, p95)");
        print_percent(report->seam_step_median);
        print_percent(report->seam_step_p95);
        putchar('\n');
    }
    if (!isnan(tolerance_of(baked))) {
        printf("%-30s", "tolerance");
        print_percent(tolerance_of(baked));
        printf("   of interpolation, that levels of probes were chosen by\n");
    }
    seen_print(report);
    printf("%s bake; %zu surface points, %zu free points, 8 normals each; reference: path tracer, 2 x %u samples a "
           "point or more, "
           "seed %llu\n",
           baked->denoise ? "denoised" : "plain", report->points, report->free_points, options->settings.samples,
           (unsigned long long)options->settings.seed);
}

int command_check(int count, char **values)
{
    check_options options = {
        .settings = check_settings_default(),
        .shared = {.path_name = {"LEVEL", "DIR"}, .takes = ARGUMENTS_THREADS | ARGUMENTS_QUIET},
    };
    lmb_arguments arguments = arguments_begin(count, values, "check", usage);
    if (!options_read(&arguments, &options)) {
        return arguments_status(&arguments);
    }
    lmb_error error = {""};
    lmb_baked baked;
    lmb_result result =
        lmb_baked_open(options.shared.path[0], options.shared.path[1], options.shared.threads, NULL, &baked, &error);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    result = lmb_baked_need_probes(&baked, options.shared.path[1], &error);
    if (result == LMB_OK && options.model) {
        result = lmb_baked_read_model(&baked, options.shared.path[1], options.model, &error);
    }
    if (result == LMB_OK) {
        result = check_limits_apply(&options.limits, baked.lightmap != NULL, &error);
    }
    if (result != LMB_OK) {
        lmb_baked_close(&baked);
        return command_fail(result, &error);
    }
    lmb_console console;
    const lmb_progress progress = console_progress(&console, options.shared.quiet, false);
    result = lmb_level_solve(&baked.level, baked.settings.estimator, &progress, &error);
    if (result != LMB_OK) {
        console_finish(&console);
        lmb_baked_close(&baked);
        return command_fail(result, &error);
    }
    local_light local = {0};
    check_report report;
    result = local_light_open(baked.volume, baked.level.scene, &local);
    if (result == LMB_OK) {
        const check_subject subject = {&baked.level.transport, baked.volume, baked.lightmap, baked.level.pool, &local};
        result = check_run(&subject, &options.settings, &progress, &report);
    }
    local_light_close(&local);
    console_finish(&console);
    if (result != LMB_OK) {
        lmb_error_set(&error, result, "check: %s", lmb_result_text(result));
    } else if (options.json) {
        result = report_print_json(&options, &report, &baked.settings, &error);
    } else {
        report_print_table(&options, &report, &baked.settings);
    }
    lmb_baked_close(&baked);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    return check_limits_hold(&options.limits, &report) ? EXIT_DONE : EXIT_FAILED;
}
