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
            const double off = value - 0.5 * (a + b);
            error.product += (value - a) * (value - b);
            error.reference += a * b;
            error.deviation += off * off;
        }
    }
    const double count = 3.0 * normal_count;
    return (point_error){error.product / count, error.reference / count, error.deviation / count};
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Standard error of sqrt(P / R), P and R the means of product and reference: by the delta method for the ratio, whose
 * residuals are product - ratio * reference, then for the root. */
static double root_std_error(const point_error *errors, size_t count, double ratio, double reference_mean)
{
    if (count < 2) {
        return missing;
    }
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const double residual = errors[i].product - ratio * errors[i].reference;
        sum += residual * residual;
    }
    const double ratio_error = sqrt(sum / ((double)count * (double)(count - 1))) / reference_mean;
    /* Where the ratio drowns in its error, the root's tangent would promise nonsense. */
    return ratio > ratio_error ? 0.5 * ratio_error / sqrt(ratio) : 0.5 * sqrt(ratio_error);
}

lmb_result error_summarize(const point_error *errors, size_t count, error_summary *summary)
{
    double product = 0.0, reference = 0.0;
    for (size_t i = 0; i < count; ++i) {
        product += errors[i].product;
        reference += errors[i].reference;
    }
    if (count == 0 || !(reference > 0.0)) {
        *summary = (error_summary){missing, missing, missing, missing};
        return LMB_OK;
    }
    double *deviation = malloc(count * sizeof *deviation);
    if (!deviation) {
        return LMB_ERROR_MEMORY;
    }
    const double reference_mean = reference / (double)count;
    for (size_t i = 0; i < count; ++i) {
        deviation[i] = sqrt(errors[i].deviation / reference_mean);
    }
    qsort(deviation, count, sizeof *deviation, compare_doubles);
    const double ratio = fmax(product, 0.0) / reference;
    /* The smallest value that at least 95 % of the points do not exceed. */
    const size_t rank = (count * 95 + 99) / 100;
    summary->rel_rmse = sqrt(ratio);
    summary->std_error = root_std_error(errors, count, ratio, reference_mean);
    summary->p95 = deviation[rank - 1];
    summary->max = deviation[count - 1];
    free(deviation);
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

leak_summary leak_summarize(const point_light *lights, size_t count)
{
    double reference = 0.0, noise = 0.0, product = 0.0;
    for (size_t i = 0; i < count; ++i) {
        reference += lights[i].reference;
        noise += lights[i].reference_noise;
        product += lights[i].reference_product;
    }
    leak_summary summary = {.reference_mean = count > 0 ? reference / (double)count : missing,
                            .reference_std_error = product > 0.0 ? sqrt(noise / product) : missing};
    double excess = 0.0;
    for (size_t i = 0; i < count; ++i) {
        if (lights[i].reference < LEAK_DARK_SHARE * summary.reference_mean) {
            excess += lights[i].excess;
            ++summary.dark_points;
        }
    }
    if (summary.dark_points > 0) {
        summary.leak = excess / (double)summary.dark_points / summary.reference_mean;
    }
    return summary;
}
