#include <stdio.h>
#include <string.h>

#include "bake_arguments.h"
#include "bench_plot.h"
#include "bench_rays.h"
#include "bench_report.h"
#include "bench_time.h"
#include "machine.h"
#include "output_file.h"
#include "query.h"

enum { MOST_VOLUMES = 8, MOST_HOUSE_PROBES = 100000000 };

static const char usage[] =
    "usage: lambent bench DIR ... [options]\n"
    "       lambent bench --house N [--house N ...] [options]\n"
    "       lambent bench --rays LEVEL [options]\n"
    "\n"
    "With folders that were baked, measures how fast the probes.lmb of each is sampled, and how right, beside dense\n"
    "arrays, NanoVDB and OpenVDB that hold the probes of its probes.vdb, and beside the same volume as compact "
    "probes,\n"
    "with every cell cut, and in tiles of 32 cells: CPU time, in cells that have eight probes, along lines (coherent) "
    "and at random. Time "
    "it\n"
    "on a machine that does nothing else.\n"
    "\n"
    "  --house N             a made-up volume of about N probes, in the place of a folder\n"
    "  --threads N           measures N threads at once, too\n"
    "  --samples N           of each pattern (default 262144)\n"
    "  --repeat N            medians of N rounds, in which samplers take turns (default 7)\n"
    "  --plot FILE           writes ns against probes, an SVG\n"
    "  --json                one JSON object on standard output\n"
    "\n"
    "With --rays, measures how fast a bake with lightmaps traces its rays, phase by phase, beside bare Embree on the\n"
    "same rays: some of them are recorded, and replayed on the same BVH by as many threads.\n"
    "\n"
    "  --rays LEVEL          the level to bake (.gltf or .glb)\n"
    "  --repeat N            medians of N bakes and replays in turn (default 3)\n"
    "  --json                one JSON object on standard output\n" BAKE_USAGE LEVEL_USAGE;

/* Of the phases that trace, all together. */
static lmb_bench_phase phases_sum(const lmb_bench_phase phase[BENCH_PHASES])
{
    lmb_bench_phase sum = {0};
    for (int i = 0; i < BENCH_PHASES; ++i) {
        if (phase[i].rays > 0) {
            sum.rays += phase[i].rays;
            sum.recorded += phase[i].recorded;
            sum.seconds += phase[i].seconds;
            sum.cpu_seconds += phase[i].cpu_seconds;
            sum.bare_seconds += phase[i].bare_seconds;
            sum.bare_cpu_seconds += phase[i].bare_cpu_seconds;
            sum.best_seconds += phase[i].best_seconds;
        }
    }
    return sum;
}

static double quotient(double a, double b)
{
    return b > 0.0 ? a / b : 0.0;
}

static const char *const call_names[LMB_REPLAY_CALLS] = {"single", "packet of 8", "coherent stream",
                                                         "incoherent stream"};

static void json_add_rates(cJSON *json, const lmb_bench_phase *phase)
{
    const double millions = 1e-6 * (double)phase->rays;
    cJSON_AddNumberToObject(json, "rays", (double)phase->rays);
    cJSON_AddNumberToObject(json, "recorded", (double)phase->recorded);
    cJSON_AddNumberToObject(json, "seconds", phase->seconds);
    cJSON_AddNumberToObject(json, "mrays_per_s", quotient(millions, phase->seconds));
    cJSON_AddNumberToObject(json, "bare_mrays_per_s", quotient(millions, phase->bare_seconds));
    cJSON_AddNumberToObject(json, "best_mrays_per_s", quotient(millions, phase->best_seconds));
    cJSON_AddNumberToObject(json, "ratio", quotient(phase->bare_seconds, phase->seconds));
    cJSON_AddNumberToObject(json, "best_ratio", quotient(phase->best_seconds, phase->seconds));
    cJSON_AddNumberToObject(json, "cpu_ratio", quotient(phase->bare_cpu_seconds, phase->cpu_seconds));
}

static cJSON *phase_json(const lmb_bench_phase *measured, lmb_bake_phase phase)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "name", lmb_bake_phase_name(phase));
    json_add_rates(json, measured);
    cJSON *best = cJSON_AddObjectToObject(json, "best");
    cJSON_AddStringToObject(best, "nearest", call_names[measured->best[LMB_RAY_NEAREST]]);
    cJSON_AddStringToObject(best, "occluded", call_names[measured->best[LMB_RAY_OCCLUDED]]);
    return json;
}

/* How many times faster all threads are than one: the bake, and bare Embree. */
static void scaling_find(const lmb_bench_rays *bench, double *bake, double *bare)
{
    const lmb_bench_phase one = phases_sum(bench->phase[0]);
    const lmb_bench_phase all = phases_sum(bench->phase[1]);
    *bake = quotient(one.seconds, all.seconds);
    *bare = quotient(one.bare_seconds, all.bare_seconds);
}

static int rays_print_json(const lmb_bench_rays *bench, const char *machine)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "machine", machine);
    cJSON_AddNumberToObject(json, "threads", bench->threads);
    cJSON *phases = cJSON_AddArrayToObject(json, "phases");
    for (int i = 0; i < BENCH_PHASES; ++i) {
        cJSON_AddItemToArray(phases, phase_json(&bench->phase[1][i], bench_phases[i]));
    }
    const lmb_bench_phase all = phases_sum(bench->phase[1]);
    json_add_rates(json, &all);
    double bake, bare;
    scaling_find(bench, &bake, &bare);
    cJSON *scaling = cJSON_AddObjectToObject(json, "scaling");
    cJSON_AddNumberToObject(scaling, "bake", bake);
    cJSON_AddNumberToObject(scaling, "bare", bare);
    cJSON_AddNumberToObject(scaling, "ratio", quotient(bake, bare));
    return json_print_line(json);
}

static void phase_print(const char *name, const lmb_bench_phase *phase)
{
    const double millions = 1e-6 * (double)phase->rays;
    printf("%-10s %9.3f %9.3f %8.2f %8.2f %7.1f %% %8.2f %7.1f %%\n", name, millions, phase->seconds,
           quotient(millions, phase->seconds), quotient(millions, phase->bare_seconds),
           100.0 * quotient(phase->bare_seconds, phase->seconds), quotient(millions, phase->best_seconds),
           100.0 * quotient(phase->best_seconds, phase->seconds));
}

static void rays_print(const lmb_bench_rays *bench, const char *machine)
{
    printf(
        "%s\n%d threads. Rates in million rays a second; bare: Embree, single rays as the bake traced them; best: its\n"
        "best call for each kind of ray.\n\n",
        machine, bench->threads);
    printf("%-10s %9s %9s %8s %8s %9s %8s %9s\n", "phase", "Mrays", "seconds", "bake", "bare", "of bare", "best",
           "of best");
    for (int i = 0; i < BENCH_PHASES; ++i) {
        phase_print(lmb_bake_phase_name(bench_phases[i]), &bench->phase[1][i]);
    }
    const lmb_bench_phase all = phases_sum(bench->phase[1]);
    phase_print("all", &all);
    double bake, bare;
    scaling_find(bench, &bake, &bare);
    printf("\nby CPU seconds %.1f %% of bare\nfrom 1 to %d threads: bake %.3f times, bare %.3f times, ratio %.3f\n",
           100.0 * quotient(all.bare_cpu_seconds, all.cpu_seconds), bench->threads, bake, bare, quotient(bake, bare));
}

/* Reads the command line. False: a usage error was printed, or --help. */
static bool rays_arguments(lmb_arguments *arguments, lmb_bake_settings *settings, int *repeats, bool *json)
{
    for (const char *argument; (argument = arguments_next(arguments));) {
        if (strcmp(argument, "--rays") == 0) {
            settings->level.path = arguments_text(arguments, argument);
        } else if (strcmp(argument, "--repeat") == 0) {
            *repeats = (int)arguments_integer(arguments, argument, 1, BENCH_MAX_REPEATS);
        } else if (strcmp(argument, "--json") == 0) {
            *json = true;
        } else if (argument[0] != '-' || !bake_argument(settings, arguments, argument)) {
            arguments_error(arguments, "unexpected argument", argument);
        }
    }
    return !arguments->failed && !arguments->help;
}

static int bench_rays(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "bench", usage);
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.lightmaps = true;
    settings.denoise = false; /* it traces no rays */
    int repeats = 3;
    bool json = false;
    if (!rays_arguments(&arguments, &settings, &repeats, &json)) {
        return arguments_status(&arguments);
    }
    if (settings.max_samples == settings.samples) {
        samples_say_rounded(settings.samples, LMB_GATHER_REPLICATES, arguments.quiet || json);
    }
    lmb_error error = {{0}};
    lmb_level level;
    const lmb_warnings warnings = console_warnings(arguments.quiet);
    lmb_result result = lmb_level_open(&settings.level, &warnings, NULL, &level, &error);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    lmb_console console;
    const lmb_progress progress = console_progress(&console, arguments.quiet || json, false);
    lmb_bench_rays bench;
    result = bench_rays_measure(&settings, &level, repeats, &progress, &bench, &error);
    console_finish(&console);
    lmb_level_close(&level);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    char machine[512];
    machine_text(machine);
    if (json) {
        return rays_print_json(&bench, machine);
    }
    rays_print(&bench, machine);
    return EXIT_DONE;
}

typedef struct volume_options {
    lmb_bench_source source[MOST_VOLUMES];
    int source_count;
    lmb_bench_settings settings;
    const char *plot; /* NULL: none */
    bool json;
} volume_options;

static void source_add(volume_options *options, lmb_arguments *arguments, lmb_bench_source source)
{
    if (options->source_count == MOST_VOLUMES) {
        arguments_error(arguments, "more than eight volumes, with", source.folder ? source.folder : "--house");
    } else {
        options->source[options->source_count++] = source;
    }
}

/* Reads the command line. False: a usage error was printed, or --help. */
static bool volume_arguments(lmb_arguments *arguments, volume_options *options)
{
    lmb_bench_settings *const settings = &options->settings;
    for (const char *argument; (argument = arguments_next(arguments));) {
        if (strcmp(argument, "--samples") == 0) {
            settings->samples = (size_t)arguments_integer(arguments, argument, 1, BENCH_VOLUME_MOST_SAMPLES);
        } else if (strcmp(argument, "--repeat") == 0) {
            settings->repeats = (int)arguments_integer(arguments, argument, 1, BENCH_MAX_REPEATS);
        } else if (strcmp(argument, "--threads") == 0) {
            settings->threads = (int)arguments_integer(arguments, argument, 1, BENCH_MOST_THREADS);
        } else if (strcmp(argument, "--house") == 0) {
            const double probes = (double)arguments_integer(arguments, argument, 1, MOST_HOUSE_PROBES);
            source_add(options, arguments, (lmb_bench_source){.house = probes});
        } else if (strcmp(argument, "--plot") == 0) {
            options->plot = arguments_text(arguments, argument);
        } else if (strcmp(argument, "--json") == 0) {
            options->json = true;
        } else if (argument[0] == '-' && argument[1] != '\0') {
            arguments_error(arguments, "unknown option", argument);
        } else {
            source_add(options, arguments, (lmb_bench_source){.folder = argument});
        }
    }
    if (options->source_count == 0 && !arguments->failed && !arguments->help) {
        arguments_error(arguments, "missing argument", "DIR, or --house N, or --rays LEVEL");
    }
    return !arguments->failed && !arguments->help;
}

/* Measures all, and says each that is done. */
static lmb_result volumes_measure(const volume_options *options, const char *machine, lmb_bench_volume *bench,
                                  lmb_error *error)
{
    lmb_result result = options->plot ? output_file_check(options->plot, error) : LMB_OK;
    for (int i = 0; i < options->source_count && result == LMB_OK; ++i) {
        result = bench_volume_measure(&options->source[i], &options->settings, &bench[i], error);
        if (result == LMB_OK && !options->json) {
            if (i == 0) {
                printf("%s\nCPU time of a thread for a sample; `ratio`: to dense.fp32.\n", machine);
            }
            bench_report_print(&bench[i]);
            fflush(stdout);
        }
    }
    return result;
}

static int volumes_print_json(const lmb_bench_volume *bench, int count, const char *machine)
{
    cJSON *const json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "machine", machine);
    cJSON_AddStringToObject(json, "dense_kernel", bench->dense_kernel ? bench->dense_kernel : "");
    cJSON *const samplers = cJSON_AddArrayToObject(json, "samplers");
    for (int i = 0; i < count; ++i) {
        bench_report_add(&bench[i], samplers);
    }
    return json_print_line(json);
}

static int bench_volumes(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "bench", usage);
    volume_options options = {.settings = {.samples = 1 << 18, .repeats = 7, .threads = 1}};
    if (!volume_arguments(&arguments, &options)) {
        return arguments_status(&arguments);
    }
    lmb_error error = {{0}};
    lmb_bench_volume bench[MOST_VOLUMES];
    char machine[512];
    machine_text(machine);
    lmb_result result = volumes_measure(&options, machine, bench, &error);
    if (result == LMB_OK && options.plot) {
        result = bench_plot_write(options.plot, bench, options.source_count, machine, &error);
    }
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    return options.json ? volumes_print_json(bench, options.source_count, machine) : EXIT_DONE;
}

/* The options of the two have the same names: which is meant is known first. */
int command_bench(int count, char **values)
{
    for (int i = 0; i < count && strcmp(values[i], "--") != 0; ++i) {
        if (strcmp(values[i], "--rays") == 0 || strncmp(values[i], "--rays=", 7) == 0) {
            return bench_rays(count, values);
        }
    }
    return bench_volumes(count, values);
}
