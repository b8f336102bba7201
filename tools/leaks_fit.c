#include "leaks_fit.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_PASSES = 100 };

/* Squared, of the gradient to where it began. */
#define CONVERGED 1e-10

typedef struct fit_work {
    const leaks_equation *equation;
    size_t rows, columns;
    double *x, *gradient, *direction; /* [column] */
    double *residual, *image;         /* [row] */
} fit_work;

static float coefficient_of(const lmb_sh3_rgb *light, int k)
{
    return light->channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT];
}

static void image_of(const fit_work *work, const double *columns, double *rows)
{
    for (size_t row = 0; row < work->rows; ++row) {
        const leaks_equation *e = &work->equation[row];
        rows[row] = 0.0;
        for (uint32_t i = 0; i < e->count; ++i) {
            rows[row] += (double)e->weight[i] * columns[e->unknown[i]];
        }
    }
}

static double gradient_of(const fit_work *work)
{
    double squared = 0.0;
    memset(work->gradient, 0, work->columns * sizeof *work->gradient);
    for (size_t row = 0; row < work->rows; ++row) {
        const leaks_equation *e = &work->equation[row];
        for (uint32_t i = 0; i < e->count; ++i) {
            work->gradient[e->unknown[i]] += (double)e->weight[i] * work->residual[row];
        }
    }
    for (size_t i = 0; i < work->columns; ++i) {
        squared += work->gradient[i] * work->gradient[i];
    }
    return squared;
}

static void solve(const fit_work *work, int k)
{
    memset(work->x, 0, work->columns * sizeof *work->x);
    for (size_t row = 0; row < work->rows; ++row) {
        work->residual[row] = (double)coefficient_of(&work->equation[row].right, k);
    }
    double squared = gradient_of(work);
    const double enough = CONVERGED * squared;
    memcpy(work->direction, work->gradient, work->columns * sizeof *work->direction);
    for (int pass = 0; pass < MOST_PASSES && squared > enough; ++pass) {
        double length = 0.0;
        image_of(work, work->direction, work->image);
        for (size_t row = 0; row < work->rows; ++row) {
            length += work->image[row] * work->image[row];
        }
        if (!(length > 0.0)) {
            return;
        }
        const double step = squared / length;
        for (size_t i = 0; i < work->columns; ++i) {
            work->x[i] += step * work->direction[i];
        }
        for (size_t row = 0; row < work->rows; ++row) {
            work->residual[row] -= step * work->image[row];
        }
        const double next = gradient_of(work);
        for (size_t i = 0; i < work->columns; ++i) {
            work->direction[i] = work->gradient[i] + next / squared * work->direction[i];
        }
        squared = next;
    }
}

lmb_result leaks_fit(const leaks_equation *equation, size_t equation_count, lmb_sh3_rgb *unknown, size_t unknown_count)
{
    double *const numbers = malloc((3 * unknown_count + 2 * equation_count + 1) * sizeof *numbers);
    if (!numbers) {
        return LMB_ERROR_MEMORY;
    }
    const fit_work work = {.equation = equation,
                           .rows = equation_count,
                           .columns = unknown_count,
                           .x = numbers,
                           .gradient = numbers + unknown_count,
                           .direction = numbers + 2 * unknown_count,
                           .residual = numbers + 3 * unknown_count,
                           .image = numbers + 3 * unknown_count + equation_count};
    for (int k = 0; k < 3 * LMB_SH3_COUNT; ++k) {
        solve(&work, k);
        for (size_t i = 0; i < unknown_count; ++i) {
            unknown[i].channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT] = (float)work.x[i];
        }
    }
    free(numbers);
    return LMB_OK;
}
