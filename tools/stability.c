/* Numerical stability of the lighting models: lambent_stability [--inputs N] [--model NAME] [--limit E] [--threads N]
 *
 * Runs every row of the table that is made of SH3 over light of levels, random coefficients and the hard cases, in
 * float, beside the same source compiled with long doubles, and prints for each the worst error and the input that gave
 * it. An error is relative to the light of the long doubles there, or to 1 % of the input's largest coefficient where
 * that is more: below, only its rounding is left. Exit status 1: NaN, infinite or negative light anywhere, or of a
 * model that the sampler has an error above the limit. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/model.h>
#include <lambent/pool.h>

#include "base/clock.h"
#include "command.h"
#include "stability_inputs.h"

static const char usage[] = "usage: lambent_stability [--inputs N] [--model NAME] [--limit E] [--threads N]\n";

enum { CHUNK = 1000 };
#define LEAST_SHARE 0.01
#define LEAST_LIGHT 1e-30 /* below, floats have fewer digits */

/* The worst of some inputs. */
typedef struct worst {
    double error;
    uint64_t index; /* of the input */
    int value;
    uint64_t broken; /* how many values were NaN, infinite or negative */
    uint64_t first_broken;
} worst;

typedef struct stability_job {
    size_t model;
    uint64_t inputs;
    worst *found; /* [chunk] */
} stability_job;

static void input_try(size_t model, uint64_t index, worst *found)
{
    stability_input input;
    double narrow[STABILITY_VALUES], wide[STABILITY_VALUES];
    stability_input_make(index, &input);
    stability_run_float(model, &input, narrow);
    stability_run_wide(model, &input, wide);
    const double least = LEAST_SHARE * stability_input_size(&input) + LEAST_LIGHT;
    for (int i = 0; i < STABILITY_VALUES; ++i) {
        if (!(narrow[i] >= 0.0 && isfinite(narrow[i]))) {
            found->first_broken = found->broken++ == 0 ? index : found->first_broken;
            continue;
        }
        const double error = fabs(narrow[i] - wide[i]) / fmax(wide[i], least);
        if (error > found->error) {
            found->error = error;
            found->index = index;
            found->value = i;
        }
    }
}

static void chunk_task(void *context, size_t task, int worker)
{
    (void)worker;
    const stability_job *job = context;
    worst found = {0};
    const uint64_t first = (uint64_t)task * CHUNK;
    for (uint64_t i = first; i < first + CHUNK && i < job->inputs; ++i) {
        input_try(job->model, i, &found);
    }
    job->found[task] = found;
}

static void worst_add(worst *sum, const worst *one)
{
    if (one->error > sum->error) {
        sum->error = one->error;
        sum->index = one->index;
        sum->value = one->value;
    }
    if (one->broken > 0) {
        sum->first_broken = sum->broken == 0 ? one->first_broken : sum->first_broken;
        sum->broken += one->broken;
    }
}

static bool model_try(size_t model, uint64_t inputs, lmb_pool *pool, worst *sum)
{
    const size_t chunks = (size_t)((inputs + CHUNK - 1) / CHUNK);
    stability_job job = {model, inputs, calloc(chunks + 1, sizeof *job.found)};
    memset(sum, 0, sizeof *sum);
    const bool ran = job.found && lmb_pool_run(pool, chunks, chunk_task, &job, "models", NULL) == LMB_OK;
    for (size_t i = 0; ran && i < chunks; ++i) {
        worst_add(sum, &job.found[i]);
    }
    free(job.found);
    return ran;
}

static void input_print(uint64_t index, int value)
{
    static const char channels[] = "RGB";
    stability_input input;
    const char *kind = stability_input_make(index, &input);
    const double *n_v = input.vertex_normal, *n = input.normal[value / 3];
    printf("    input %llu, %s: n_v %.9g %.9g %.9g, n %.9g %.9g %.9g, cone cos %.9g, %c of", (unsigned long long)index,
           kind, n_v[0], n_v[1], n_v[2], n[0], n[1], n[2], input.cone_cos, channels[value % 3]);
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < 9; ++i) {
            printf("%s%.9g", i == 0 ? "\n      " : " ", input.sh[c][i]);
        }
    }
    putchar('\n');
}

typedef struct stability_options {
    uint64_t inputs;
    const char *model;
    double limit;
    int threads;
} stability_options;

/* Slow models take fewer, so that no row takes minutes. */
static uint64_t inputs_of(const stability_options *options, size_t model, lmb_pool *pool)
{
    enum { TRIED = 2000, MOST_SECONDS = 60 };
    worst unused;
    const double start = lmb_clock_seconds();
    model_try(model, TRIED, pool, &unused);
    const double most = MOST_SECONDS * TRIED / (lmb_clock_seconds() - start);
    return (double)options->inputs > most ? (uint64_t)most : options->inputs;
}

/* Prints a row. False: it broke. */
static bool model_report(const stability_options *options, size_t model, lmb_pool *pool)
{
    const lmb_model *row = lmb_model_at(model);
    const uint64_t inputs = inputs_of(options, model, pool);
    worst sum;
    if (!model_try(model, inputs, pool, &sum)) {
        fprintf(stderr, "lambent_stability: out of memory\n");
        return false;
    }
    const bool good = sum.broken == 0 && !(row->at_run_time && sum.error > options->limit);
    printf("%-28s %10llu inputs, worst relative error %.3g%s\n", lmb_model_full_name(row), (unsigned long long)inputs,
           sum.error, good ? "" : "  FAILS");
    if (sum.error > 0.0) {
        input_print(sum.index, sum.value);
    }
    if (sum.broken > 0) {
        printf("    %llu values NaN, infinite or negative, first of\n", (unsigned long long)sum.broken);
        input_print(sum.first_broken, 0);
    }
    fflush(stdout);
    return good;
}

static bool options_read(lmb_arguments *arguments, stability_options *options)
{
    for (const char *next; (next = arguments_next(arguments));) {
        if (strcmp(next, "--inputs") == 0) {
            options->inputs = (uint64_t)arguments_integer(arguments, next, 1, INT64_C(1) << 40);
        } else if (strcmp(next, "--model") == 0) {
            options->model = arguments_text(arguments, next);
        } else if (strcmp(next, "--limit") == 0) {
            options->limit = arguments_number(arguments, next, 0.0, 1.0);
        } else if (strcmp(next, "--threads") == 0) {
            options->threads = (int)arguments_integer(arguments, next, 1, 1024);
        } else {
            arguments_error(arguments, "unexpected argument", next);
        }
    }
    if (options->model && !lmb_model_find(options->model, 0)) {
        arguments_error(arguments, "no such model:", options->model);
    }
    return !arguments->failed && !arguments->help;
}

int main(int count, char **values)
{
    stability_options options = {.inputs = 10000000, .limit = 1.0};
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "stability", usage);
    if (!options_read(&arguments, &options)) {
        return arguments_status(&arguments);
    }
    lmb_pool *pool = NULL;
    if (lmb_pool_create(options.threads, &pool) != LMB_OK) {
        fprintf(stderr, "lambent_stability: out of memory\n");
        return EXIT_FAILED;
    }
    bool good = true;
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        const lmb_model *row = lmb_model_at(i);
        if (row->encode && (!options.model || lmb_model_find(options.model, 0) == row)) {
            good = model_report(&options, i, pool) && good;
        }
    }
    lmb_pool_destroy(pool);
    return good ? EXIT_DONE : EXIT_FAILED;
}
