#include <stdio.h>
#include <string.h>

#include <lambent/gather_sh3.h>
#include <lambent/key_lights.h>

#include "command.h"
#include "level_arguments.h"
#include "query.h"
#include "replicates.h"

static const char usage[] =
    "usage: lambent probe LEVEL --at X,Y,Z [options]\n"
    "\n"
    "Traces one probe on the spot, without a volume: SH3 radiance, and with a normal the irradiance there by the\n"
    "default lighting model beside the traced truth.\n"
    "\n" QUERY_USAGE "  --samples N           paths from the point (default 4096)\n"
    "  --estimator NAME      reference: trace every path to its end (default); cached: as the bake does\n"
    "  --json                one JSON object a line\n" LEVEL_USAGE;

typedef struct lmb_probe_answer {
    lmb_gathered gathered;
    lmb_query_light light;
    lmb_rgb irradiance;
    lmb_rgb traced;
    double seconds;
} lmb_probe_answer;

/* The truth's samples come in so many parts, for threads to share. All samples are a multiple of it. */
enum { TRUTH_REPLICATES = 16 };

typedef struct lmb_truth_work {
    const lmb_transport *transport;
    const lmb_query *query;
    lmb_vec3 position;
    uint32_t samples;
    lmb_rgb irradiance[TRUTH_REPLICATES];
    uint64_t rays[TRUTH_REPLICATES];
} lmb_truth_work;

static void truth_task(void *context, size_t task, int worker)
{
    (void)worker;
    lmb_truth_work *work = context;
    const lmb_gather_point point = {
        .position = work->position, .hemisphere = true, .normal = work->query->vertex_normal};
    const lmb_gather_samples samples = {
        .points = &point, .point_count = 1, .replicate = REPLICATES_PROBE + (uint32_t)task, .count = work->samples};
    lmb_gather_irradiance(work->transport, &samples, &work->query->normal, 1, &work->irradiance[task],
                          &work->rays[task]);
}

static lmb_result probe_trace(const lmb_level *level, const lmb_query *query, uint32_t samples,
                              const lmb_progress *progress, lmb_probe_answer *answer)
{
    const double start = seconds_now();
    const lmb_gather_point point = {.position = lmb_scene_from_world(level->scene, query->position)};
    lmb_result result =
        lmb_gather_sh3_parallel(&level->transport, &point, samples, level->pool, progress, &answer->gathered);
    if (result == LMB_OK) {
        answer->light.rest = answer->gathered.moments;
        answer->light.keys.count = lmb_scene_key_lights(level->scene, answer->light.keys.light);
        memcpy(answer->light.keys.visibility, answer->gathered.key_visibility, sizeof answer->gathered.key_visibility);
    }
    if (result == LMB_OK && query->has_normal) {
        answer->irradiance = query_irradiance(query, lmb_model_default(LMB_MODEL_FOR_SURFACE), &answer->light);
        lmb_truth_work work = {.transport = &level->transport,
                               .query = query,
                               .position = point.position,
                               .samples = samples / TRUTH_REPLICATES};
        result = lmb_pool_run(level->pool, TRUTH_REPLICATES, truth_task, &work, "truth", progress);
        answer->traced = (lmb_rgb){{0.0f, 0.0f, 0.0f}};
        for (int r = 0; r < TRUTH_REPLICATES; ++r) {
            answer->gathered.rays += work.rays[r];
            for (int c = 0; c < 3; ++c) {
                answer->traced.c[c] += work.irradiance[r].c[c] / (float)TRUTH_REPLICATES;
            }
        }
    }
    answer->seconds = seconds_now() - start;
    return result;
}

static double answer_relative_error(const lmb_probe_answer *answer)
{
    return lmb_relative_error(answer->gathered.squared_error, answer->gathered.squared_light);
}

static int answer_print_json(const lmb_query *query, const lmb_probe_answer *answer)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddItemToObject(object, "position", json_position(query->position));
    json_add_light(object, &answer->light);
    cJSON_AddNumberToObject(object, "std_error", answer_relative_error(answer));
    if (query->has_normal) {
        cJSON_AddItemToObject(object, "normal", json_vector(query->normal));
        cJSON_AddItemToObject(object, "irradiance", json_rgb(answer->irradiance));
        cJSON_AddItemToObject(object, "traced_irradiance", json_rgb(answer->traced));
    }
    cJSON_AddNumberToObject(object, "rays", (double)answer->gathered.rays);
    cJSON_AddNumberToObject(object, "seconds", answer->seconds);
    return json_print_line(object);
}

static int answer_print(const lmb_query *query, const lmb_probe_answer *answer)
{
    static const char *const names[LMB_SH3_COUNT] = {"0,0", "1,-1", "1,0", "1,1", "2,-2", "2,-1", "2,0", "2,1", "2,2"};
    const lmb_sh3_rgb whole = key_lights_add_sh3(&answer->light.keys, &answer->light.rest);
    printf("probe at %.9g, %.9g, %.9g\n", query->position.x, query->position.y, query->position.z);
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        printf("  l%-5s %12.6g %12.6g %12.6g\n", names[i], (double)whole.channel[0].c[i], (double)whole.channel[1].c[i],
               (double)whole.channel[2].c[i]);
    }
    for (uint32_t i = 0; i < answer->light.keys.count; ++i) {
        const lmb_key_light *key = &answer->light.keys.light[i];
        printf("  key light %u: %.4g of %.6g %.6g %.6g from %.6g %.6g %.6g\n", i,
               (double)answer->light.keys.visibility[i], (double)key->irradiance.c[0], (double)key->irradiance.c[1],
               (double)key->irradiance.c[2], (double)key->direction.x, (double)key->direction.y,
               (double)key->direction.z);
    }
    if (query->has_normal) {
        printf("  irradiance        %12.6g %12.6g %12.6g\n", (double)answer->irradiance.c[0],
               (double)answer->irradiance.c[1], (double)answer->irradiance.c[2]);
        printf("  traced irradiance %12.6g %12.6g %12.6g\n", (double)answer->traced.c[0], (double)answer->traced.c[1],
               (double)answer->traced.c[2]);
    }
    printf("  relative standard error %.3g %%, %llu rays in %.2f s\n", 100.0 * answer_relative_error(answer),
           (unsigned long long)answer->gathered.rays, answer->seconds);
    return EXIT_DONE;
}

typedef struct probe_options {
    lmb_level_settings level;
    lmb_query_arguments query;
    lmb_estimator estimator;
    uint32_t samples;
    bool json;
    bool quiet;
} probe_options;

static void option_take(probe_options *options, lmb_arguments *arguments, const char *argument)
{
    if (level_argument(&options->level, arguments, argument) || query_argument(&options->query, arguments, argument) ||
        estimator_argument(&options->estimator, arguments, argument)) {
        return;
    }
    if (strcmp(argument, "--samples") == 0) {
        options->samples = (uint32_t)arguments_integer(arguments, argument, 1, 1 << 28);
    } else if (strcmp(argument, "--json") == 0) {
        options->json = true;
    } else if (argument[0] != '-' && !options->level.path) {
        options->level.path = argument;
    } else {
        arguments_error(arguments, "unexpected argument", argument);
    }
}

/* Reads the command line. False: a usage error was printed, or --help. */
static bool options_read(probe_options *options, lmb_arguments *arguments)
{
    for (const char *argument; (argument = arguments_next(arguments));) {
        option_take(options, arguments, argument);
    }
    options->quiet = arguments->quiet;
    if (arguments->failed || arguments->help) {
        return false;
    }
    if (!options->level.path) {
        arguments_error(arguments, "missing argument", "LEVEL");
    }
    return !arguments->failed && query_finish(&options->query, arguments);
}

/* Traces the one point, or all of standard input. @return exit status */
static int points_answer(const probe_options *options, const lmb_level *level, lmb_console *console,
                         const lmb_progress *progress)
{
    const bool one = options->query.has_position;
    lmb_query query = options->query.one;
    lmb_error error = {{0}};
    int line = 0;
    int status = EXIT_DONE;
    int more = one ? 1 : query_read_line(&query, &line);
    while (more == 1) {
        lmb_probe_answer answer;
        const lmb_result result = probe_trace(level, &query, options->samples, progress, &answer);
        console_finish(console);
        if (result != LMB_OK) {
            return command_fail(result, &error);
        }
        status = options->json ? answer_print_json(&query, &answer) : answer_print(&query, &answer);
        if (status != EXIT_DONE || ferror(stdout)) {
            break;
        }
        more = one ? 0 : query_read_line(&query, &line);
    }
    return more < 0 ? EXIT_BAD_INPUT : status;
}

int command_probe(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "probe", usage);
    probe_options options = {
        .level = lmb_level_settings_default(), .estimator = LMB_ESTIMATOR_REFERENCE, .samples = 4096};
    if (!options_read(&options, &arguments)) {
        return arguments_status(&arguments);
    }
    samples_say_rounded(options.samples, TRUTH_REPLICATES, options.quiet);
    options.samples = (options.samples + TRUTH_REPLICATES - 1) / TRUTH_REPLICATES * TRUTH_REPLICATES;
    lmb_error error = {{0}};
    lmb_level level;
    const lmb_warnings warnings = console_warnings(options.quiet);
    lmb_result result = lmb_level_open(&options.level, &warnings, NULL, &level, &error);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    lmb_console console;
    const lmb_progress progress = console_progress(&console, options.quiet || options.json, false);
    result = lmb_level_solve(&level, options.estimator, &progress, &error);
    if (result != LMB_OK) {
        console_finish(&console);
        lmb_level_close(&level);
        return command_fail(result, &error);
    }
    const int status = points_answer(&options, &level, &console, &progress);
    lmb_level_close(&level);
    return status;
}
