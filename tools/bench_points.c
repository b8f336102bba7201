#include "bench_points.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

const char *bench_pattern_name(lmb_bench_pattern pattern)
{
    return pattern == BENCH_COHERENT ? "coherent" : "random";
}

/* xorshift64. @return 0 up to 1 */
static double draw(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) * 0x1p-53;
}

/* Whether all corners were baked, and it is not cut: others that are timed know nothing of that. */
static bool cell_is_whole(const lmb_probes *probes, const int32_t cell[3])
{
    if (lmb_probe_index_find(&probes->level[0].cut, cell) >= 0) {
        return false;
    }
    for (int corner = 0; corner < 8; ++corner) {
        const int32_t probe =
            lmb_probes_find(probes, 0, cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2));
        if (probe < 0 || probes->validity[probe] < LMB_PROBES_MIN_VALIDITY) {
            return false;
        }
    }
    return true;
}

/* The probes that are the first corner of a whole cell. */
static int32_t *cells_find(const lmb_probes *probes, int32_t *count)
{
    int32_t *const cell = malloc(((size_t)probes->count + 1) * sizeof *cell);
    *count = 0;
    for (int32_t probe = 0; cell && probe < probes->count - probes->ghost_count; ++probe) {
        if (cell_is_whole(probes, probes->point[probe])) {
            cell[(*count)++] = probe;
        }
    }
    return cell;
}

/* A point on a line, lattice coordinates. */
typedef struct walk {
    double at[3], step[3];
} walk;

/* Begins anywhere in a whole cell, in any direction. */
static walk walk_begin(const int32_t cell[3], uint64_t *state)
{
    walk begun;
    double length = 0.0;
    do {
        length = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            begun.at[axis] = cell[axis] + draw(state);
            begun.step[axis] = 2.0 * draw(state) - 1.0;
            length += begun.step[axis] * begun.step[axis];
        }
    } while (length < 1e-3 || length > 1.0);
    for (int axis = 0; axis < 3; ++axis) {
        begun.step[axis] *= 0.1 / sqrt(length);
    }
    return begun;
}

static bool walk_is_inside(const lmb_probes *probes, const walk *walked)
{
    const int32_t cell[3] = {(int32_t)floor(walked->at[0]), (int32_t)floor(walked->at[1]),
                             (int32_t)floor(walked->at[2])};
    return cell_is_whole(probes, cell);
}

lmb_result bench_points_fill(const lmb_probes *probes, lmb_bench_pattern pattern, size_t count, lmb_vec3 *position)
{
    int32_t cells;
    int32_t *const cell = cells_find(probes, &cells);
    if (!cell || cells == 0) {
        free(cell);
        return cell ? LMB_ERROR_FORMAT : LMB_ERROR_MEMORY;
    }
    uint64_t state = UINT64_C(0x9e3779b97f4a7c15);
    const double spacing = (double)probes->level[0].lattice.spacing;
    walk walked = {{0.0}, {0.0}};
    for (size_t i = 0; i < count; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            walked.at[axis] += walked.step[axis];
        }
        if (i == 0 || pattern == BENCH_RANDOM || !walk_is_inside(probes, &walked)) {
            const int32_t begun = cell[(int32_t)(draw(&state) * cells)];
            walked = walk_begin(probes->point[begun], &state);
        }
        position[i] = (lmb_vec3){(float)(walked.at[0] * spacing), (float)(walked.at[1] * spacing),
                                 (float)(walked.at[2] * spacing)};
    }
    free(cell);
    return LMB_OK;
}

void bench_points_truth(const lmb_probes *probes, lmb_vec3 position, double light[27])
{
    const double spacing = (double)probes->level[0].lattice.spacing;
    const double at[3] = {(double)position.x / spacing, (double)position.y / spacing, (double)position.z / spacing};
    for (int i = 0; i < 27; ++i) {
        light[i] = 0.0;
    }
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        int32_t point[3];
        for (int axis = 0; axis < 3; ++axis) {
            const double below = floor(at[axis]), t = at[axis] - below;
            weight *= corner >> axis & 1 ? t : 1.0 - t;
            point[axis] = (int32_t)below + (corner >> axis & 1);
        }
        const int32_t probe = lmb_probes_find(probes, 0, point[0], point[1], point[2]);
        for (int i = 0; probe >= 0 && i < 27; ++i) {
            light[i] += weight * (double)probes->radiance[0][probe].channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT];
        }
    }
}
