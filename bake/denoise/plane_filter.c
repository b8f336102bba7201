#include "denoise/plane_filter.h"

#include <string.h>

#include "base/vectorised.h"

enum { TERMS = 4, LANES = 8 };

/* Vectors of the compiler's: sums in them stay in registers. */
typedef float eight_floats __attribute__((vector_size(32)));
typedef double four_doubles __attribute__((vector_size(32)));

/* The first column of the inverse of a positive symmetric matrix, of which the lower half is given and lost. */
static void inverse_column(double a[TERMS][TERMS], double column[TERMS])
{
    for (int k = 0; k < TERMS; ++k) { /* a = L D L^T */
        for (int i = k + 1; i < TERMS; ++i) {
            const double factor = a[i][k] / a[k][k];
            for (int j = k + 1; j <= i; ++j) {
                a[i][j] -= factor * a[j][k];
            }
            column[i] = 0.0;
        }
    }
    column[0] = 1.0;
    for (int i = 1; i < TERMS; ++i) {
        column[i] = 0.0;
        for (int k = 0; k < i; ++k) {
            column[i] -= a[i][k] / a[k][k] * column[k];
        }
    }
    for (int i = TERMS - 1; i >= 0; --i) {
        column[i] /= a[i][i];
        for (int k = i + 1; k < TERMS; ++k) {
            column[i] -= a[k][i] / a[i][i] * column[k];
        }
    }
}

/* Also the upper half: whole rows are whole vectors. Of a surface the last row is 0. */
static inline void rows_add(const lmb_neighbours *found, float radius, lmb_plane *plane, int rows, four_doubles *sum)
{
    for (uint32_t i = 0; i < plane->part.count; ++i) {
        const uint32_t at = plane->part.place[i];
        plane->weight[i] = lmb_biweight(found->square[at], radius);
        const double w = (double)plane->weight[i];
        const four_doubles term = {1.0, (double)found->x[at], (double)found->y[at], (double)found->z[at]};
        for (int row = 0; row < rows; ++row) {
            sum[row] += w * term[row] * term;
        }
    }
}

LMB_VECTORISED
static void moments_sum(const lmb_neighbours *found, float radius, lmb_plane *plane, double moment[TERMS][TERMS])
{
    four_doubles sum[TERMS] = {{0.0}};
    if (found->flat) {
        rows_add(found, radius, plane, TERMS - 1, sum);
    } else {
        rows_add(found, radius, plane, TERMS, sum);
    }
    memcpy(moment, sum, sizeof sum);
}

void lmb_plane_fit(const lmb_neighbours *found, float radius, lmb_plane *plane)
{
    double moment[TERMS][TERMS], value[TERMS];
    lmb_neighbours_within(found, radius, &plane->part);
    moments_sum(found, radius, plane, moment);
    const double hold = 0.02 * (double)radius * (double)radius * moment[0][0];
    for (int row = 1; row < TERMS; ++row) {
        moment[row][row] += hold;
    }
    inverse_column(moment, value);
    for (uint32_t i = 0; i < plane->part.count; ++i) {
        const uint32_t at = plane->part.place[i];
        plane->weight[i] *= (float)(value[0] + value[1] * (double)found->x[at] + value[2] * (double)found->y[at] +
                                    value[3] * (double)found->z[at]);
    }
}

void lmb_plane_even(const lmb_neighbours *found, float radius, lmb_plane *plane)
{
    lmb_neighbours_within(found, radius, &plane->part);
    for (uint32_t i = 0; i < plane->part.count; ++i) {
        plane->weight[i] = 1.0f / (float)plane->part.count;
    }
}

static inline void light_sum(const lmb_plane *plane, const lmb_neighbours *found, const float (*light)[LMB_LIGHT_ROW],
                             int vectors, float *sum)
{
    eight_floats all[LMB_LIGHT_ROW / LANES] = {{0.0f}};
    for (uint32_t i = 0; i < plane->part.count; ++i) {
        const float *const row = light[found->rank[plane->part.place[i]]];
        for (int k = 0; k < vectors; ++k) {
            eight_floats part;
            memcpy(&part, row + LANES * k, sizeof part);
            all[k] += plane->weight[i] * part;
        }
    }
    memcpy(sum, all, (size_t)vectors * sizeof all[0]);
}

LMB_VECTORISED
void lmb_plane_rows(const lmb_plane *plane, const lmb_neighbours *found, const float (*light)[LMB_LIGHT_ROW],
                    float sum[LMB_LIGHT_ROW])
{
    light_sum(plane, found, light, LMB_LIGHT_ROW / LANES, sum);
}

LMB_VECTORISED
void lmb_plane_halves(const lmb_plane *plane, const lmb_neighbours *found, const float (*light)[LMB_LIGHT_ROW],
                      float sum[LMB_LIGHT_HALF])
{
    light_sum(plane, found, light, LMB_LIGHT_HALF / LANES, sum);
}
