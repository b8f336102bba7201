#include "leaks_measure.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "cpu_time.h"

static const lmb_vec3 axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

static void sample_at(const leaks_sampler *sampler, const leaks_point *point, lmb_sh3_rgb *radiance)
{
    const bool beside = point->kind != LEAKS_ANYWHERE;
    sampler->method->sample(sampler->state, point->position, beside ? &point->normal : NULL, radiance);
}

/* Sums over the points of one kind in the rooms of one home. */
typedef struct sums {
    double count, foreign, own, own_truth, squared_off, squared;
    double own_squared, own_product, truth_squared; /* of the own channel, found and true */
} sums;

static void sums_add(sums *to, const leaks_point *point, const lmb_sh3_rgb *found, bool open)
{
    const int home = point->home, foreign = 1 - home;
    to->count += 1.0;
    to->foreign += (double)found->channel[foreign].c[0] - (open ? (double)point->truth.channel[foreign].c[0] : 0.0);
    const double own = (double)found->channel[home].c[0], own_truth = (double)point->truth.channel[home].c[0];
    to->own += own;
    to->own_truth += own_truth;
    to->own_squared += own * own;
    to->own_product += own * own_truth;
    to->truth_squared += own_truth * own_truth;
    for (int i = 0; i < 6; ++i) {
        const double truth = (double)lmb_sh3_irradiance(&point->truth.channel[home], axes[i]);
        const double off = (double)lmb_sh3_irradiance(&found->channel[home], axes[i]) - truth;
        to->squared_off += off * off;
        to->squared += truth * truth;
    }
}

/* Of the ratio of two means, over points that are drawn alike (Cochran 1977, "Sampling Techniques", chapter 6). */
static double ratio_std_error(const sums *at)
{
    const double ratio = at->own / at->own_truth;
    const double squares = at->own_squared - 2.0 * ratio * at->own_product + ratio * ratio * at->truth_squared;
    return sqrt(fmax(squares, 0.0)) / at->own_truth;
}

static bool keep_worse(double *kept, double found)
{
    const bool worse = fabs(found) > fabs(*kept);
    *kept = worse ? found : *kept;
    return worse;
}

static leaks_errors errors_of(const sums home[2], const double home_mean[2])
{
    leaks_errors worst = {0};
    for (int i = 0; i < 2; ++i) {
        const sums *at = &home[i];
        if (!(at->count > 0.0 && at->own_truth > 0.0)) {
            continue;
        }
        keep_worse(&worst.leak, home_mean[1 - i] > 0.0 ? at->foreign / at->count / home_mean[1 - i] : 0.0);
        keep_worse(&worst.of_own, at->foreign / at->own_truth);
        if (keep_worse(&worst.own_mean, at->own / at->own_truth - 1.0)) {
            worst.own_std_error = ratio_std_error(at);
        }
        keep_worse(&worst.own_rmse, sqrt(at->squared_off / at->squared));
    }
    return worst;
}

leaks_figures leaks_measure(const leaks_sampler *sampler, const leaks_places *places)
{
    sums all[LEAKS_KINDS][2] = {{{.count = 0.0}}};
    for (size_t i = 0; i < places->point_count; ++i) {
        const leaks_point *point = &places->point[i];
        lmb_sh3_rgb found;
        sample_at(sampler, point, &found);
        sums_add(&all[point->kind][point->home], point, &found, places->open);
    }
    leaks_figures figures = {.step = 0.0};
    for (int kind = 0; kind < LEAKS_KINDS; ++kind) {
        figures.at[kind] = errors_of(all[kind], places->home_mean);
    }
    for (size_t i = 0; i < places->line_count; ++i) {
        const leaks_line *line = &places->line[i];
        const double step = leaks_step(sampler, line->from, line->to);
        figures.step =
            fmax(figures.step, places->home_mean[line->home] > 0.0 ? step / places->home_mean[line->home] : 0.0);
    }
    return figures;
}

/* --- steps ------------------------------------------------------------------------------------------------------- */

/* Part of a line, from the first to the second share of it. */
typedef struct stretch {
    double low, high, change;
} stretch;

static void light_along(const leaks_sampler *sampler, lmb_vec3 from, lmb_vec3 to, double share, double light[3])
{
    lmb_sh3_rgb found;
    sampler->method->sample(sampler->state, lmb_vec3_mad(from, lmb_vec3_sub(to, from), (float)share), NULL, &found);
    for (int c = 0; c < 3; ++c) {
        light[c] = (double)found.channel[c].c[0];
    }
}

static double change_between(const double a[3], const double b[3])
{
    return fmax(fabs(a[0] - b[0]), fmax(fabs(a[1] - b[1]), fabs(a[2] - b[2])));
}

/* Halves a stretch again and again, and goes on with the half that changes most. */
static double stretch_limit(const leaks_sampler *sampler, lmb_vec3 from, lmb_vec3 to, stretch part)
{
    enum { HALVINGS = 12 };
    double low[3], middle[3], high[3];
    light_along(sampler, from, to, part.low, low);
    light_along(sampler, from, to, part.high, high);
    for (int i = 0; i < HALVINGS; ++i) {
        const double half = 0.5 * (part.low + part.high);
        light_along(sampler, from, to, half, middle);
        const bool first = change_between(low, middle) > change_between(middle, high);
        *(first ? &part.high : &part.low) = half;
        for (int c = 0; c < 3; ++c) {
            *(first ? &high[c] : &low[c]) = middle[c];
        }
    }
    return change_between(low, high);
}

double leaks_step(const leaks_sampler *sampler, lmb_vec3 from, lmb_vec3 to)
{
    enum { STRETCHES = 256, LOOKED_AT = 4 };
    stretch most[LOOKED_AT] = {{0.0, 0.0, 0.0}};
    double last[3], next[3];
    light_along(sampler, from, to, 0.0, last);
    for (int i = 1; i <= STRETCHES; ++i) {
        stretch part = {(double)(i - 1) / STRETCHES, (double)i / STRETCHES, 0.0};
        light_along(sampler, from, to, part.high, next);
        part.change = change_between(last, next);
        for (int k = 0; k < LOOKED_AT; ++k) {
            if (part.change > most[k].change) {
                const stretch moved = most[k];
                most[k] = part;
                part = moved;
            }
        }
        for (int c = 0; c < 3; ++c) {
            last[c] = next[c];
        }
    }
    double largest = 0.0;
    for (int k = 0; k < LOOKED_AT; ++k) {
        if (most[k].change > largest) {
            largest = fmax(largest, stretch_limit(sampler, from, to, most[k]));
        }
    }
    return largest;
}

/* --- time --------------------------------------------------------------------------------------------------------- */

static int compare_doubles(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

double leaks_time(const leaks_sampler *sampler, const leaks_places *places)
{
    enum { REPEATS = 7, ROUNDS = 8 };
    double seconds[REPEATS];
    if (places->point_count == 0) {
        return 0.0;
    }
    for (int i = 0; i < REPEATS; ++i) {
        const double start = cpu_time_of_thread();
        for (size_t k = 0; k < ROUNDS * places->point_count; ++k) {
            lmb_sh3_rgb found;
            sample_at(sampler, &places->point[k % places->point_count], &found);
        }
        seconds[i] = cpu_time_of_thread() - start;
    }
    qsort(seconds, REPEATS, sizeof seconds[0], compare_doubles);
    return 1e9 * seconds[REPEATS / 2] / (double)(ROUNDS * places->point_count);
}
