/* How much light each way of interpolating probes lets through walls, and what that costs:
 *
 *     lambent_leaks [--spacing M,...] [--scene NAME,...] [--method NAME,...] [--tolerance E] [--json] [--pictures DIR]
 *
 * bakes the scenes of tests/scenes/leak_scenes.h with the library at every spacing, and measures every row of the table
 * in leaks_methods.h against light that is gathered at the very points. Leaks and errors are in percent, steps too:
 *
 *     leak        foreign light 1 cm and 10 cm from surfaces that divide, and anywhere, over its mean at home
 *     of own      the worst of these three over the own light there
 *     mean, rmse  of the own light: error of the mean, relative RMSE of irradiance, the worst of the three
 *     step        the largest along straight lines within a room, over its light
 *     bytes, ns   of the whole over the probes of the even lattice; a sample, CPU time
 *
 * Where light gets from room to room by ways of its own only what goes beyond the truth is a leak. Tables and what they
 * say are in docs/leaks.md. */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "command.h"
#include "leaks_measure.h"
#include "leaks_picture.h"

static const char usage[] =
    "usage: lambent_leaks [options]\n"
    "\n"
    "  --spacing M,...       metres between probes (default 0.5,1,2, and 0.25 in small scenes)\n"
    "  --scene NAME,...      (default: all; an unknown one lists them)\n"
    "  --method NAME,...     ways of interpolating (default: all; likewise)\n"
    "  --tolerance E         error of interpolation beyond which the method `levels` has a finer one (default 0.05)\n"
    "  --json                one JSON object in place of the tables\n"
    "  --pictures DIR        plans as PNG, for each scene, spacing and method\n";

enum { PROBE_SAMPLES = 256, TRUTH_SAMPLES = 1024, POINTS = 1024, MOST_SPACINGS = 8 };

/* By default scenes that are not small have no probes nearer to each other: it would take minutes more. */
#define LEAST_OF_LARGE_M 0.5

/* One method in one scene at one spacing. */
typedef struct leaks_row {
    const lmb_leak_scene *scene;
    const leaks_method *method;
    double spacing;
    int32_t probes;
    leaks_figures figures;
    double bytes, ns; /* a probe, a sample */
} leaks_row;

typedef struct leaks_run {
    double spacing[MOST_SPACINGS];
    int spacing_count;
    bool spacing_given;
    const char *scenes, *methods; /* names and commas; NULL: all */
    double tolerance;             /* of levels */
    bool json;
    const char *pictures; /* folder, or NULL */
    char level_path[64];
    leaks_row *row;
    size_t row_count;
} leaks_run;

/* Whether a list of names and commas has that one. */
static bool is_listed(const char *list, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = list; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        if (strncmp(at, name, length) == 0 && (at[length] == ',' || at[length] == '\0')) {
            return true;
        }
    }
    return list == NULL;
}

static double worst_of(const leaks_figures *figures, size_t offset)
{
    double worst = 0.0;
    for (int kind = 0; kind < LEAKS_KINDS; ++kind) {
        const double found = *(const double *)((const char *)&figures->at[kind] + offset);
        worst = fabs(found) > fabs(worst) ? found : worst;
    }
    return worst;
}
#define WORST(figures, field) worst_of(figures, offsetof(leaks_errors, field))

static void row_print(const leaks_row *row)
{
    const leaks_figures *f = &row->figures;
    printf("| %s | %g | %s | %.3f | %.3f | %.3f | %.3f | %+.1f | %.1f | %.3f | %.0f | %.0f |\n", row->scene->name,
           row->spacing, row->method->name, 100.0 * f->at[LEAKS_1_CM].leak, 100.0 * f->at[LEAKS_10_CM].leak,
           100.0 * f->at[LEAKS_ANYWHERE].leak, 100.0 * WORST(f, of_own), 100.0 * WORST(f, own_mean),
           100.0 * WORST(f, own_rmse), 100.0 * f->step, row->bytes, row->ns);
    fflush(stdout);
}

static void row_print_json(const leaks_row *row, bool first)
{
    static const char *const kinds[LEAKS_KINDS] = {"at_1_cm", "at_10_cm", "anywhere"};
    printf("%s\n  {\"scene\": \"%s\", \"open\": %s, \"spacing\": %g, \"method\": \"%s\", \"probes\": %d,\n   ",
           first ? "" : ",", row->scene->name, row->scene->open ? "true" : "false", row->spacing, row->method->name,
           row->probes);
    for (int kind = 0; kind < LEAKS_KINDS; ++kind) {
        const leaks_errors *at = &row->figures.at[kind];
        printf("\"%s\": {\"leak\": %.6g, \"of_own\": %.6g, \"own_mean\": %.6g, \"own_std_error\": %.6g, "
               "\"own_rmse\": %.6g},\n   ",
               kinds[kind], at->leak, at->of_own, at->own_mean, at->own_std_error, at->own_rmse);
    }
    printf("\"step\": %.6g, \"bytes_per_probe\": %.4g, \"ns_per_sample\": %.4g}", row->figures.step, row->bytes,
           row->ns);
    fflush(stdout);
}

static lmb_result picture_make(const leaks_run *run, const leaks_row *row, const leaks_level *level,
                               const leaks_sampler *sampler, const leaks_places *places, lmb_error *error)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s_%gm_%s.png", run->pictures, row->scene->name, row->spacing, row->method->name);
    return leaks_picture_write(path, level, sampler, places, error);
}

static lmb_result method_measure(leaks_run *run, const leaks_level *level, const leaks_field *field,
                                 const leaks_places *places, const leaks_method *method, lmb_error *error)
{
    void *state;
    size_t bytes;
    lmb_result result = method->prepare(field, &state, &bytes);
    if (result != LMB_OK) {
        return lmb_error_set(error, result, "%s: %s", method->name, lmb_result_text(result));
    }
    const leaks_sampler sampler = {method, state};
    leaks_row *row = &run->row[run->row_count++];
    *row = (leaks_row){.scene = level->scene,
                       .method = method,
                       .spacing = (double)field->probes->level[0].lattice.spacing,
                       .probes = field->probes->count,
                       .figures = leaks_measure(&sampler, places),
                       .bytes = (double)bytes / field->probes->count,
                       .ns = leaks_time(&sampler, places)};
    if (run->json) {
        row_print_json(row, run->row_count == 1);
    } else {
        row_print(row);
    }
    if (run->pictures) {
        result = picture_make(run, row, level, &sampler, places, error);
    }
    if (method->release) {
        method->release(state);
    }
    return result;
}

static lmb_result spacing_measure(leaks_run *run, leaks_level *level, const leaks_places *places, double spacing,
                                  lmb_error *error)
{
    leaks_field field;
    lmb_result result = leaks_field_bake(level, (float)spacing, PROBE_SAMPLES, &field, error);
    if (result != LMB_OK) {
        return result;
    }
    field.bake.record.settings.tolerance = run->tolerance;
    size_t count;
    const leaks_method *const *methods = leaks_methods(&count);
    for (size_t i = 0; i < count && result == LMB_OK; ++i) {
        if (is_listed(run->methods, methods[i]->name)) {
            result = method_measure(run, level, &field, places, methods[i], error);
        }
    }
    leaks_field_free(&field);
    return result;
}

static lmb_result scene_measure(leaks_run *run, const lmb_leak_scene *scene, lmb_error *error)
{
    leaks_level level;
    lmb_result result = leaks_level_open(scene, run->level_path, 0, &level, error);
    if (result != LMB_OK) {
        return result;
    }
    leaks_places places;
    result = leaks_places_make(&level, POINTS, TRUTH_SAMPLES, &places);
    if (result != LMB_OK) {
        lmb_error_set(error, result, "out of memory for points");
    } else {
        for (int i = 0; i < run->spacing_count && result == LMB_OK; ++i) {
            if (run->spacing_given || scene->small || run->spacing[i] >= LEAST_OF_LARGE_M) {
                result = spacing_measure(run, &level, &places, run->spacing[i], error);
            }
        }
        leaks_places_free(&places);
    }
    leaks_level_close(&level);
    return result;
}

/* --- over all scenes ------------------------------------------------------------------------------------------ */

/* Of the rows of one method at one spacing, in sealed scenes or in open ones. */
static void summary_row_print(const leaks_run *run, const leaks_method *method, double spacing, bool open)
{
    double count = 0.0, worst = 0.0, sum = 0.0, own = 0.0, mean = 0.0, rmse = 0.0, step = 0.0, bytes = 0.0, ns = 0.0;
    for (size_t i = 0; i < run->row_count; ++i) {
        const leaks_row *row = &run->row[i];
        if (row->method != method || fabs(row->spacing - spacing) > 1e-6 * spacing || row->scene->open != open) {
            continue;
        }
        const leaks_figures *f = &row->figures;
        count += 1.0;
        worst = fmax(worst, fabs(WORST(f, leak)));
        sum += fabs(WORST(f, leak));
        own = fmax(own, fabs(WORST(f, of_own)));
        mean = fmax(mean, fabs(WORST(f, own_mean)));
        rmse += WORST(f, own_rmse);
        step = fmax(step, f->step);
        bytes += row->bytes;
        ns += row->ns;
    }
    if (count > 0.0) {
        printf("| %s | %g | %s | %.3f | %.3f | %.2f | %.1f | %.1f | %.3f | %.0f | %.0f |\n", open ? "open" : "sealed",
               spacing, method->name, 100.0 * worst, 100.0 * sum / count, 100.0 * own, 100.0 * mean,
               100.0 * rmse / count, 100.0 * step, bytes / count, ns / count);
    }
}

static void summary_print(const leaks_run *run)
{
    size_t count;
    const leaks_method *const *methods = leaks_methods(&count);
    printf("\n| scenes | m | method | worst leak | mean leak | worst of own | worst mean | mean rmse | worst step | "
           "bytes | ns |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (int open = 0; open < 2; ++open) {
        for (int i = 0; i < run->spacing_count; ++i) {
            for (size_t k = 0; k < count; ++k) {
                summary_row_print(run, methods[k], run->spacing[i], open);
            }
        }
    }
}

static lmb_result run_all(leaks_run *run, lmb_error *error)
{
    size_t scene_count, method_count;
    const lmb_leak_scene *scenes = lmb_leak_scenes(&scene_count);
    leaks_methods(&method_count);
    run->row = calloc(scene_count * method_count * MOST_SPACINGS, sizeof *run->row);
    if (!run->row) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for rows");
    }
    printf("%s", run->json
                     ? "{\"rows\": ["
                     : "| scene | m | method | leak at 1 cm | at 10 cm | anywhere | of own | mean | rmse | step | "
                       "bytes | ns |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    lmb_result result = LMB_OK;
    for (size_t i = 0; i < scene_count && result == LMB_OK; ++i) {
        if (is_listed(run->scenes, scenes[i].name)) {
            result = scene_measure(run, &scenes[i], error);
        }
    }
    if (run->json) {
        printf("\n]}\n");
    } else {
        summary_print(run);
    }
    free(run->row);
    return result;
}

/* --- options ------------------------------------------------------------------------------------------------------ */

static void take_spacings(leaks_run *run, lmb_arguments *arguments, const char *option)
{
    const char *text = arguments_text(arguments, option);
    run->spacing_count = 0;
    run->spacing_given = true;
    while (!arguments->failed && text) {
        char *end;
        const double spacing = strtod(text, &end);
        if (end == text || (*end != ',' && *end != '\0') || !(spacing >= 0.1 && spacing <= 4.0) ||
            run->spacing_count == MOST_SPACINGS) {
            arguments_error(arguments, "up to eight spacings from 0.1 to 4 m, not", text);
            return;
        }
        run->spacing[run->spacing_count++] = spacing;
        text = *end == ',' ? end + 1 : NULL;
    }
}

static const char *scene_name(size_t i)
{
    size_t count;
    const lmb_leak_scene *scenes = lmb_leak_scenes(&count);
    return i < count ? scenes[i].name : NULL;
}

static const char *method_name(size_t i)
{
    size_t count;
    const leaks_method *const *methods = leaks_methods(&count);
    return i < count ? methods[i]->name : NULL;
}

/* A list of which every name is known; where one is not, all are told. */
static const char *take_names(lmb_arguments *arguments, const char *option, const char *(*known)(size_t i))
{
    const char *const list = arguments_text(arguments, option);
    for (const char *at = list; !arguments->failed && at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        size_t i = 0;
        const size_t length = strcspn(at, ",");
        while (known(i) && !(strlen(known(i)) == length && strncmp(known(i), at, length) == 0)) {
            ++i;
        }
        if (!known(i)) {
            arguments_error(arguments, "there is no", at);
            for (i = 0; known(i); ++i) {
                fprintf(stderr, "  %s\n", known(i));
            }
        }
    }
    return list;
}

static void take_argument(leaks_run *run, lmb_arguments *arguments, const char *argument)
{
    if (strcmp(argument, "--spacing") == 0) {
        take_spacings(run, arguments, argument);
    } else if (strcmp(argument, "--scene") == 0) {
        run->scenes = take_names(arguments, argument, scene_name);
    } else if (strcmp(argument, "--method") == 0) {
        run->methods = take_names(arguments, argument, method_name);
    } else if (strcmp(argument, "--tolerance") == 0) {
        run->tolerance = arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--json") == 0) {
        run->json = true;
    } else if (strcmp(argument, "--pictures") == 0) {
        run->pictures = arguments_text(arguments, argument);
    } else {
        arguments_error(arguments, "unexpected argument", argument);
    }
}

int main(int count, char **values)
{
    leaks_run run = {.spacing = {0.25, 0.5, 1.0, 2.0},
                     .spacing_count = 4,
                     .tolerance = lmb_bake_settings_default().tolerance,
                     .level_path = "/tmp/lambent_leaks_XXXXXX.glb"};
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "leaks", usage);
    for (const char *argument; (argument = arguments_next(&arguments));) {
        take_argument(&run, &arguments, argument);
    }
    if (arguments.failed || arguments.help) {
        return arguments_status(&arguments);
    }
    lmb_error error = {{0}};
    const int file = mkstemps(run.level_path, 4);
    if (file < 0) {
        return command_fail(lmb_error_set(&error, LMB_ERROR_WRITE, "no temporary file in /tmp"), &error);
    }
    close(file);
    const lmb_result result = run_all(&run, &error);
    unlink(run.level_path);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
