/* What levels of probes save: probes and error of interpolation beside even lattices of the same level.
 *
 *     lambent_levels LEVEL [bake options] [--points N] [--truth N] [--even M,...] [--tolerances E,...]
 *
 * solves the level's light once, gathers the truth at random places of free space, and bakes in memory, with the bake
 * options, an even lattice of each spacing and levels of each tolerance. One line for each, tabs between:
 *
 *     "even" and its spacing, or "levels" and their tolerance; probes; of these baked; places outside;
 *     relative RMSE; RMS (none counted as more than 1), median and 95th percentile of the places' own relative errors;
 *     the share beyond a tenth;
 *     seconds of placing, of choosing levels and of gathering
 *
 * and for levels, by RMS, median and 95th percentile, how many times as many probes an even lattice of the same error
 * has, by interpolation between the even ones on logarithmic axes; beyond them by the slope of the last two, "~" before
 * it. The error is of irradiance, over all normals, by SH3 and key lights, relative to the light at the place or to 1 %
 * of the mean. Noise of truth and probes is taken out by their independent halves; denoising is off. Its table is in
 * docs/baking.md. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake_arguments.h"
#include "levels_places.h"

static const char usage[] =
    "usage: lambent_levels LEVEL [options]\n"
    "\n"
    "  --points N            places in free space (default 2000)\n"
    "  --truth N             samples at each (default 4096)\n"
    "  --even M,...          spacings of even lattices\n"
    "  --tolerances E,...    of levels between --spacing and --min-spacing\n" BAKE_USAGE LEVEL_USAGE;

enum { MOST_RUNS = 16, ERRORS = 3 };

typedef struct run_record {
    const char *kind;
    double setting;
    double probes, baked, outside;
    double rel_rmse, error[ERRORS], over; /* RMS, median, 95th percentile */
    double seconds[3];
} run_record;

typedef struct levels_work {
    level_places places;
    double spacing[MOST_RUNS], tolerance[MOST_RUNS];
    int spacing_count, tolerance_count, even_count;
    run_record even[MOST_RUNS];
} levels_work;

static int doubles_compare(const void *a, const void *b)
{
    const double *const p = a, *const q = b;
    return (*p > *q) - (*p < *q);
}

static void errors_measure(const level_places *places, const lmb_probes *probes, run_record *run)
{
    double *const own = malloc((places->count + (size_t)1) * sizeof *own);
    double squared_sum = 0.0, light_sum = 0.0, relative = 0.0;
    uint32_t count = 0, over = 0;
    for (uint32_t i = 0; i < places->count && own; ++i) {
        double squared, share;
        if (!place_error(places, probes, &places->place[i], &squared, &share)) {
            continue;
        }
        squared_sum += squared;
        light_sum += places->place[i].squared_light;
        relative += fmin(share, 1.0);
        over += share > 0.01;
        own[count++] = sqrt(fmax(share, 0.0));
    }
    run->outside = places->count - count;
    if (count > 0) {
        qsort(own, count, sizeof *own, doubles_compare);
        run->rel_rmse = sqrt(fmax(squared_sum, 0.0) / light_sum);
        run->error[0] = sqrt(fmax(relative, 0.0) / count);
        run->error[1] = own[count / 2];
        run->error[2] = own[count * 95 / 100];
        run->over = (double)over / count;
    }
    free(own);
}

static lmb_result run_bake(const levels_work *work, const lmb_bake_settings *settings, run_record *run,
                           lmb_error *error)
{
    lmb_bake bake;
    const double start = seconds_now();
    const lmb_result result = places_bake(&work->places, settings, &bake, error);
    if (result == LMB_OK) {
        run->probes = bake.probes->count;
        run->baked = bake.record.placement.probes_valid;
        run->seconds[0] = bake.record.seconds[LMB_PHASE_PLACE];
        run->seconds[1] = bake.record.seconds[LMB_PHASE_LEVELS];
        run->seconds[2] = seconds_now() - start - run->seconds[0] - run->seconds[1];
        errors_measure(&work->places, bake.probes, run);
    }
    lmb_bake_end(&bake);
    return result;
}

/* How many probes an even lattice of that error has, and whether that lies beyond those that were measured. */
static double even_probes(const levels_work *work, int which, double error, bool *beyond)
{
    int at = 0;
    while (at + 2 < work->even_count && work->even[at + 1].error[which] > error) {
        ++at;
    }
    if (work->even_count < 2) {
        return NAN;
    }
    const run_record *const a = &work->even[at], *const b = &work->even[at + 1];
    const double slope = log(b->probes / a->probes) / log(b->error[which] / a->error[which]);
    *beyond = error > a->error[which] || error < b->error[which];
    return a->probes * exp(slope * log(error / a->error[which]));
}

static void run_print(const levels_work *work, const run_record *run)
{
    printf("%s\t%g\t%.0f\t%.0f\t%.0f\t%.4f\t%.4f\t%.4f\t%.4f\t%.4f\t%.1f\t%.1f\t%.1f", run->kind, run->setting,
           run->probes, run->baked, run->outside, run->rel_rmse, run->error[0], run->error[1], run->error[2], run->over,
           run->seconds[0], run->seconds[1], run->seconds[2]);
    for (int which = 0; which < ERRORS && strcmp(run->kind, "levels") == 0; ++which) {
        bool beyond = false;
        const double probes = even_probes(work, which, run->error[which], &beyond);
        printf("\t%s%.2f", beyond ? "~" : "", probes / run->probes);
    }
    printf("\n");
    fflush(stdout);
}

static lmb_result runs_make(levels_work *work, lmb_error *error)
{
    lmb_result result = LMB_OK;
    for (int i = 0; i < work->spacing_count && result == LMB_OK; ++i) {
        lmb_bake_settings settings = work->places.settings;
        settings.min_spacing = 0.0f;
        settings.spacing = (float)work->spacing[i];
        run_record *const run = &work->even[work->even_count];
        *run = (run_record){.kind = "even", .setting = work->spacing[i]};
        result = run_bake(work, &settings, run, error);
        if (result == LMB_OK) {
            ++work->even_count;
            run_print(work, run);
        }
    }
    for (int i = 0; i < work->tolerance_count && result == LMB_OK; ++i) {
        lmb_bake_settings settings = work->places.settings;
        settings.tolerance = work->tolerance[i];
        run_record run = {.kind = "levels", .setting = work->tolerance[i]};
        result = run_bake(work, &settings, &run, error);
        if (result == LMB_OK) {
            run_print(work, &run);
        }
    }
    return result;
}

static lmb_result levels_measure(levels_work *work, lmb_error *error)
{
    double finest = work->spacing[0];
    for (int i = 1; i < work->spacing_count; ++i) {
        finest = fmin(finest, work->spacing[i]);
    }
    const lmb_result result = places_make(&work->places, finest, error);
    return result == LMB_OK ? runs_make(work, error) : result;
}

/* A,B,... */
static int numbers_take(lmb_arguments *arguments, const char *option, double number[MOST_RUNS])
{
    const char *text = arguments_text(arguments, option);
    int count = 0;
    while (*text && count < MOST_RUNS) {
        char *end;
        number[count] = strtod(text, &end);
        if (end == text || !(number[count] > 0.0) || (*end != ',' && *end != '\0')) {
            arguments_error(arguments, "no list of numbers", text);
            return 0;
        }
        ++count;
        text = *end == ',' ? end + 1 : end;
    }
    return count;
}

int main(int count, char **values)
{
    levels_work work = {.places = {.wanted = 2000, .truth_samples = 4096, .settings = lmb_bake_settings_default()}};
    lmb_bake_settings *const settings = &work.places.settings;
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "lambent_levels", usage);
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (bake_argument(settings, &arguments, argument)) {
            continue;
        }
        if (strcmp(argument, "--points") == 0) {
            work.places.wanted = (uint32_t)arguments_integer(&arguments, argument, 1, 1 << 24);
        } else if (strcmp(argument, "--truth") == 0) {
            work.places.truth_samples = (uint32_t)arguments_integer(&arguments, argument, 4, 1 << 28);
        } else if (strcmp(argument, "--even") == 0) {
            work.spacing_count = numbers_take(&arguments, argument, work.spacing);
        } else if (strcmp(argument, "--tolerances") == 0) {
            work.tolerance_count = numbers_take(&arguments, argument, work.tolerance);
        } else {
            arguments_error(&arguments, "unexpected argument", argument);
        }
    }
    if (arguments.failed || arguments.help || !settings->level.path || work.spacing_count == 0) {
        fputs(usage, stderr);
        return 2;
    }
    lmb_error error = {{0}};
    lmb_level level;
    const lmb_warnings warnings = console_warnings(arguments.quiet);
    lmb_result result = lmb_level_open(&settings->level, &warnings, NULL, &level, &error);
    if (result == LMB_OK) {
        work.places.level = &level;
        result = levels_measure(&work, &error);
        free(work.places.place);
        lmb_level_close(&level);
    }
    return result == LMB_OK ? 0 : command_fail(result, &error);
}
