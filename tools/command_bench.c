#include <stdio.h>
#include <string.h>

#include "bake_arguments.h"
#include "bench_rays.h"
#include "bench_volume.h"
#include "machine.h"
#include "query.h"

static const char usage[] =
    "usage: lambent bench DIR [options]\n"
    "       lambent bench --rays LEVEL [options]\n"
    "\n"
    "With a folder that was baked, measures how fast its probes.lmb is sampled, and how right, beside dense arrays,\n"
    "NanoVDB and OpenVDB that hold the probes of its probes.vdb, and beside the same volume as compact probes and "
    "with\n"
    "every cell cut: CPU time of one thread, in cells that have eight\n"
    "probes, along lines (coherent) and at random. Writes no files. Time it on a machine that does nothing else.\n"
    "\n"
    "  --samples N           of each pattern (default 262144)\n"
    "  --repeat N            medians of N rounds, in which samplers take turns (default 7)\n"
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

static int volume_print_json(const lmb_bench_volume *bench, const char *machine)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "machine", machine);
    cJSON_AddStringToObject(json, "dense_kernel", bench->dense_kernel ? bench->dense_kernel : "");
    cJSON *samplers = cJSON_AddArrayToObject(json, "samplers");
    for (int i = 0; i < bench->row_count * BENCH_PATTERNS; ++i) {
        const lmb_bench_volume_row *row = &bench->row[i % bench->row_count];
        const int pattern = i / bench->row_count;
        cJSON *sampler = cJSON_CreateObject();
        cJSON_AddStringToObject(sampler, "name", row->name);
        cJSON_AddStringToObject(sampler, "pattern", bench_pattern_name((lmb_bench_pattern)pattern));
        cJSON_AddNumberToObject(sampler, "probes", bench->probes);
        cJSON_AddNumberToObject(sampler, "bytes_per_probe", row->bytes_per_probe);
        cJSON_AddNumberToObject(sampler, "ns_per_sample", row->ns_per_sample[pattern]);
        cJSON_AddNumberToObject(sampler, "rel_rmse", row->rel_rmse[pattern]);
        cJSON_AddItemToArray(samplers, sampler);
    }
    return json_print_line(json);
}

static void volume_print(const lmb_bench_volume *bench, const char *machine)
{
    printf("%s\n%d probes. CPU time of one thread for a sample; `ratio`: to dense.fp32.\n", machine, bench->probes);
    if (bench->dense_kernel) {
        printf("Dense arrays by %s.\n", bench->dense_kernel);
    } else {
        printf("The box is too large for dense arrays.\n");
    }
    if (!bench->has_nanovdb) {
        printf("Built without NanoVDB.\n");
    }
    printf("\n%-20s %11s %12s %8s %10s %8s %10s\n", "sampler", "bytes/probe", "coherent ns", "ratio", "random ns",
           "ratio", "rel. RMSE");
    const lmb_bench_volume_row *base = NULL;
    for (int i = 0; i < bench->row_count; ++i) {
        base = strcmp(bench->row[i].name, "dense.fp32") == 0 ? &bench->row[i] : base;
    }
    for (int i = 0; i < bench->row_count; ++i) {
        const lmb_bench_volume_row *row = &bench->row[i];
        const double *ns = row->ns_per_sample;
        printf("%-20s %11.1f %12.1f %8.2f %10.1f %8.2f %10.1e\n", row->name, row->bytes_per_probe, ns[BENCH_COHERENT],
               base ? quotient(ns[BENCH_COHERENT], base->ns_per_sample[BENCH_COHERENT]) : 0.0, ns[BENCH_RANDOM],
               base ? quotient(ns[BENCH_RANDOM], base->ns_per_sample[BENCH_RANDOM]) : 0.0, row->rel_rmse[BENCH_RANDOM]);
    }
}

static int bench_folder(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "bench", usage);
    lmb_shared_arguments shared = {.path_name = {"DIR, or --rays LEVEL"}};
    size_t samples = 1 << 18;
    int repeats = 7;
    bool json = false;
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (strcmp(argument, "--samples") == 0) {
            samples = (size_t)arguments_integer(&arguments, argument, 1, BENCH_VOLUME_MOST_SAMPLES);
        } else if (strcmp(argument, "--repeat") == 0) {
            repeats = (int)arguments_integer(&arguments, argument, 1, BENCH_MAX_REPEATS);
        } else if (strcmp(argument, "--json") == 0) {
            json = true;
        } else {
            arguments_shared(&arguments, argument, &shared);
        }
    }
    if (!arguments_complete(&arguments, &shared)) {
        return arguments_status(&arguments);
    }
    lmb_error error = {{0}};
    lmb_bench_volume bench;
    const lmb_result result = bench_volume_measure(shared.path[0], samples, repeats, &bench, &error);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    char machine[512];
    machine_text(machine);
    if (json) {
        return volume_print_json(&bench, machine);
    }
    volume_print(&bench, machine);
    return EXIT_DONE;
}

/* The options of the two have the same names: which is meant is known first. */
int command_bench(int count, char **values)
{
    for (int i = 0; i < count && strcmp(values[i], "--") != 0; ++i) {
        if (strcmp(values[i], "--rays") == 0 || strncmp(values[i], "--rays=", 7) == 0) {
            return bench_rays(count, values);
        }
    }
    return bench_folder(count, values);
}
