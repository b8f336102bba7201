#include "check_statistics.h"

#include <math.h>
#include <stdlib.h>

static const double missing = (double)NAN;

point_error point_error_of(const lmb_rgb *x, const lmb_rgb *r1, const lmb_rgb *r2, int normal_count)
{
    point_error error = {0.0, 0.0, 0.0};
    for (int k = 0; k < normal_count; ++k) {
        for (int c = 0; c < 3; ++c) {
            const double a = (double)r1[k].c[c];
            const double b = (double)r2[k].c[c];
            const double value = (double)x[k].c[c];
            const double mean = 0.5 * (a + b);
            error.product += (value - a) * (value - b);
            error.reference += a * b;
            error.own += mean * mean;
        }
    }
    const double count = 3.0 * normal_count;
    return (point_error){error.product / count, error.reference / count, error.own / count};
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sums over the points that count. */
typedef struct error_sums {
    size_t count;
    double product, reference;
    double own; /* of their roots */
} error_sums;

static bool counts(const bool *has, size_t i)
{
    return !has || has[i];
}

static error_sums sums_of(const point_error *errors, const bool *has, size_t count)
{
    error_sums sums = {0, 0.0, 0.0, 0.0};
    for (size_t i = 0; i < count; ++i) {
        if (counts(has, i)) {
            sums.count += 1;
            sums.product += errors[i].product;
            sums.reference += errors[i].reference;
            sums.own += sqrt(errors[i].own);
        }
    }
    return sums;
}

/* Standard error of sqrt(P / R), P and R the means of product and reference: by the delta method for the ratio, whose
 * residuals are product - ratio * reference, then for the root. */
static double root_std_error(const point_error *errors, const bool *has, size_t count, const error_sums *sums)
{
    if (sums->count < 2) {
        return missing;
    }
    const double ratio = fmax(sums->product, 0.0) / sums->reference;
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        if (counts(has, i)) {
            const double residual = errors[i].product - ratio * errors[i].reference;
            sum += residual * residual;
        }
    }
    const double points = (double)sums->count;
    const double ratio_error = sqrt(sum / (points * (points - 1.0))) / (sums->reference / points);
    /* Where the ratio drowns in its error, the root's tangent would promise nonsense. */
    return ratio > ratio_error ? 0.5 * ratio_error / sqrt(ratio) : 0.5 * sqrt(ratio_error);
}

/* The smallest of sorted values that at least that many percent of them do not exceed. */
static double percentile(const double *sorted, size_t count, size_t percent)
{
    return sorted[(count * percent + 99) / 100 - 1];
}

lmb_result error_summarize(const point_error *errors, const bool *has, size_t count, error_summary *summary)
{
    const error_sums sums = sums_of(errors, has, count);
    if (sums.count == 0 || !(sums.reference > 0.0)) {
        *summary = (error_summary){missing, missing, missing, missing, missing, missing};
        return LMB_OK;
    }
    double *own = malloc(sums.count * sizeof *own);
    if (!own) {
        return LMB_ERROR_MEMORY;
    }
    const double least = CHECK_DARK_SHARE * sums.own / (double)sums.count;
    size_t found = 0, visible = 0;
    for (size_t i = 0; i < count; ++i) {
        if (counts(has, i)) {
            own[found] = sqrt(fmax(errors[i].product, 0.0)) / fmax(sqrt(errors[i].own), least);
            visible += own[found] > CHECK_VISIBLE_SHARE;
            ++found;
        }
    }
    qsort(own, found, sizeof *own, compare_doubles);
    summary->rel_rmse = sqrt(fmax(sums.product, 0.0) / sums.reference);
    summary->std_error = root_std_error(errors, has, count, &sums);
    summary->median = percentile(own, found, 50);
    summary->p95 = percentile(own, found, 95);
    summary->share_over_10pct = (double)visible / (double)found;
    summary->max = own[found - 1];
    free(own);
    return LMB_OK;
}

point_light point_light_of(const lmb_rgb *x, const lmb_rgb *r1, const lmb_rgb *r2, int normal_count)
{
    point_light light = {0.0, 0.0, 0.0, 0.0};
    const double count = 3.0 * normal_count;
    for (int k = 0; k < normal_count; ++k) {
        for (int c = 0; c < 3; ++c) {
            const double a = (double)r1[k].c[c];
            const double b = (double)r2[k].c[c];
            const double mean = 0.5 * (a + b);
            light.reference += mean / count;
            light.reference_noise += 0.25 * (a - b) * (a - b) / count;
            light.reference_product += a * b / count;
            light.excess += fmax(0.0, (double)x[k].c[c] - mean) / count;
        }
    }
    return light;
}

leak_summary leak_summarize(const point_light *lights, const bool *has, size_t count)
{
    double reference = 0.0, noise = 0.0, product = 0.0;
    size_t found = 0;
    for (size_t i = 0; i < count; ++i) {
        if (counts(has, i)) {
            reference += lights[i].reference;
            noise += lights[i].reference_noise;
            product += lights[i].reference_product;
            ++found;
        }
    }
    leak_summary summary = {.reference_mean = found > 0 ? reference / (double)found : missing,
                            .reference_std_error = product > 0.0 ? sqrt(noise / product) : missing};
    double excess = 0.0;
    for (size_t i = 0; i < count; ++i) {
        if (counts(has, i) && lights[i].reference < LEAK_DARK_SHARE * summary.reference_mean) {
            excess += lights[i].excess;
            ++summary.dark_points;
        }
    }
    if (summary.dark_points > 0) {
        summary.leak = excess / (double)summary.dark_points / summary.reference_mean;
    }
    return summary;
}
