#include "texture/colour_line.h"

#include <math.h>

colour_sums lmb_colour_line_rest(const colour_sums *a, const colour_sums *b)
{
    colour_sums rest = *a;
    rest.weight -= b->weight;
    for (int i = 0; i < 3; ++i) {
        rest.first[i] -= b->first[i];
    }
    for (int i = 0; i < 6; ++i) {
        rest.second[i] -= b->second[i];
    }
    return rest;
}

/* Symmetric: xx, xy, xz, yy, yz, zz. */
static void matrix_apply(const float m[6], const float v[3], float to[3])
{
    to[0] = m[0] * v[0] + m[1] * v[1] + m[2] * v[2];
    to[1] = m[1] * v[0] + m[3] * v[1] + m[4] * v[2];
    to[2] = m[2] * v[0] + m[4] * v[1] + m[5] * v[2];
}

/* The eigenvector of the largest eigenvalue of a covariance, by powers of it; returns that value. Begins with the
 * matrix's longest column, which has some of it. */
static float axis_find(const float covariance[6], float axis[3])
{
    enum { STEPS = 8 };
    const float *m = covariance;
    const int longest = m[0] >= m[3] && m[0] >= m[5] ? 0 : m[3] >= m[5] ? 1 : 2;
    float v[3] = {longest == 0, longest == 1, longest == 2};
    float value = 0.0f;
    for (int step = 0; step < STEPS; ++step) {
        float next[3];
        matrix_apply(covariance, v, next);
        value = sqrtf(next[0] * next[0] + next[1] * next[1] + next[2] * next[2]);
        if (!(value > 0.0f)) {
            break;
        }
        for (int i = 0; i < 3; ++i) {
            v[i] = next[i] / value;
        }
    }
    for (int i = 0; i < 3; ++i) {
        axis[i] = v[i];
    }
    return value;
}

colour_line lmb_colour_line_fit(const colour_sums *sums)
{
    colour_line line = {{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, 0.0f};
    if (!(sums->weight > 0.0f)) {
        return line;
    }
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    float covariance[6];
    for (int i = 0; i < 3; ++i) {
        line.mean[i] = sums->first[i] / sums->weight;
    }
    for (int i = 0; i < 6; ++i) {
        covariance[i] = sums->second[i] - sums->first[row[i]] * line.mean[column[i]];
    }
    const float along = axis_find(covariance, line.axis);
    const float all = covariance[0] + covariance[3] + covariance[5];
    line.off = all > along ? all - along : 0.0f;
    return line;
}
