#include <stdlib.h>

#include "cpu_time.h"
#include "models.h"

enum {
    INPUT_COUNT = 256, /* lights that every pass encodes */
    LIGHT_COUNT = 4,   /* of them, where a model takes the light itself, some thousands of samples */
    NORMAL_COUNT = 16, /* that each is evaluated on */
    REPEATS = 7,       /* of which the median is taken */
    MOST_PASSES = 1 << 20
};

/* CPU time that a repeat takes at least. */
#define REPEAT_NS 1e6

static const lmb_vec3 up = {0.0f, 0.0f, 1.0f};

typedef struct speed_inputs {
    lmb_vec3 normal[MODELS_NORMAL_COUNT];
    lmb_sh3_rgb sh3[MODELS_INPUT_COUNT][INPUT_COUNT];
    models_turn turn[LIGHT_COUNT];
    float channel[INPUT_COUNT][LMB_MODEL_MOST_CHANNELS];
    lmb_rgb irradiance[NORMAL_COUNT];
} speed_inputs;

/* Turn by turn, of all maps in turn. */
static void inputs_fill(speed_inputs *inputs, const models_map *map, size_t map_count, uint64_t seed)
{
    models_normals(inputs->normal);
    for (uint32_t i = 0; i < INPUT_COUNT; ++i) {
        models_turn *const turn = &inputs->turn[i % LIGHT_COUNT];
        models_turn_fill(turn, &map[i % map_count], NULL, i / (uint32_t)map_count, seed);
        for (int input = 0; input < MODELS_INPUT_COUNT; ++input) {
            inputs->sh3[input][i] = turn->sh3[input];
        }
    }
}

/* Encodes so many inputs. */
static int encode_pass(const models_row *row, speed_inputs *inputs)
{
    const lmb_model *model = row->model;
    if (model->encode) {
        for (int i = 0; i < INPUT_COUNT; ++i) {
            model->encode(&inputs->sh3[row->input][i], up, 0.0f, inputs->channel[i]);
        }
        return INPUT_COUNT;
    }
    for (int i = 0; i < LIGHT_COUNT; ++i) {
        const models_turn *turn = &inputs->turn[i];
        model->encode_light(turn->light, turn->light_count, up, inputs->channel[i]);
    }
    return LIGHT_COUNT;
}

/* Evaluates what encode_pass left, on so many normals together. */
static int evaluate_pass(const models_row *row, speed_inputs *inputs)
{
    const int count = row->model->encode ? INPUT_COUNT : LIGHT_COUNT;
    for (int i = 0; i < count; ++i) {
        const lmb_vec3 *normal = &inputs->normal[i * NORMAL_COUNT % MODELS_NORMAL_COUNT];
        row->model->evaluate(inputs->channel[i], up, normal, NORMAL_COUNT, inputs->irradiance);
    }
    return count * NORMAL_COUNT;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Nanoseconds of one of what a pass does, the median of repeats of enough passes each. */
static double pass_ns(int (*pass)(const models_row *, speed_inputs *), const models_row *row, speed_inputs *inputs)
{
    int passes = 1, done = 1;
    double spent = 0.0;
    while (passes < MOST_PASSES) {
        const double start = cpu_time_of_thread();
        for (int i = 0; i < passes; ++i) {
            done = pass(row, inputs);
        }
        spent = 1e9 * (cpu_time_of_thread() - start);
        if (spent >= REPEAT_NS) {
            break;
        }
        passes *= 2;
    }
    double sample[REPEATS];
    for (int repeat = 0; repeat < REPEATS; ++repeat) {
        const double start = cpu_time_of_thread();
        for (int i = 0; i < passes; ++i) {
            pass(row, inputs);
        }
        sample[repeat] = 1e9 * (cpu_time_of_thread() - start) / ((double)passes * done);
    }
    qsort(sample, REPEATS, sizeof *sample, compare_doubles);
    return sample[REPEATS / 2];
}

lmb_result models_measure_speed(const models_settings *settings, const models_map *map, size_t map_count,
                                const lmb_progress *progress, models_report *report)
{
    speed_inputs *const inputs = calloc(1, sizeof *inputs);
    if (!inputs) {
        return LMB_ERROR_MEMORY;
    }
    inputs_fill(inputs, map, map_count, settings->seed);
    lmb_result result = LMB_OK;
    for (size_t i = 0; i < report->row_count && result == LMB_OK; ++i) {
        report->row[i].ns_encode = pass_ns(encode_pass, &report->row[i], inputs);
        report->row[i].ns_eval = pass_ns(evaluate_pass, &report->row[i], inputs);
        if (progress && progress->report &&
            !progress->report(progress->context, "speed", (double)(i + 1) / (double)report->row_count)) {
            result = LMB_ERROR_INTERRUPTED;
        }
    }
    free(inputs);
    return result;
}
