/* Whether probes that store the gradients of their harmonics may stand farther apart (Oat, "Irradiance Volumes for
 * Games", GDC 2005, as Chen and Liu, "Lighting and Material of Halo 3", 2008, tell of it):
 *
 *     lambent_gradients LEVEL DIR
 *
 * takes the bake in DIR, whose lattice should be fine, for the truth, and leaves probes out of it. At its own points,
 * each in cells 2, 3, 4, 5 and 8 times as large that lie about it by chance, it interpolates the radiance of the eight
 * corners:
 *
 *     plain       sum of w_i L_i, trilinear
 *     gradients   sum of w_i (L_i + G_i.(p - p_i)): each corner's own first order
 *     half        sum of w_i (L_i + G_i.(p - p_i)/2)
 *
 * with G_i from the lattice's neighbours of the corner. Of a quadratic field the first is as far above the truth as the
 * second is below it, so that the third is exact. Only points count whose corners, and their neighbours, have probes
 * that are valid and in sight, for all sizes of cells: what leaks is another matter.
 *
 * One line for each size, tabs between: spacing in metres; bytes of fp16 for a cubic metre, without and with gradients
 * (27 and 108 numbers a probe); relative root mean square errors of irradiance, over all normals and colours, of the
 * three. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <lambent/baked.h>
#include <lambent/file.h>
#include <lambent/sequence.h>
#include <lambent/vdb.h>
#include <lambent/vector.h>

#include "command.h"

static const char usage[] = "usage: lambent_gradients LEVEL DIR\n";

enum { SIZES = 5, CORNERS = 8, METHODS = 3, NUMBERS = 3 * LMB_SH3_COUNT };
static const int32_t sizes[SIZES] = {2, 3, 4, 5, 8};

/* A cell about a point: its corners' probes, and for each those before and behind along the axes. */
typedef struct cell {
    float weight[CORNERS];
    int32_t step[CORNERS][3]; /* from the corner to the point, in points of the lattice */
    int32_t probe[CORNERS];
    int32_t beside[CORNERS][3][2];
} cell;

typedef struct measured {
    const lmb_tracer *tracer;
    const lmb_probes *probes;
    double squared_error[SIZES][METHODS];
    double squared_light;
    size_t points;
} measured;

static lmb_vec3 position_in_scene(const measured *work, int32_t probe)
{
    const lmb_vec3 at = lmb_probes_position(work->probes, probe);
    const lmb_vec3d from = work->probes->origin;
    return lmb_scene_from_world(lmb_tracer_scene(work->tracer),
                                (lmb_vec3d){from.x + (double)at.x, from.y + (double)at.y, from.z + (double)at.z});
}

/* The probe at a point of the lattice if it is valid and seen from `from`; else -1. */
static int32_t probe_seen(const measured *work, const int32_t at[3], lmb_vec3 from)
{
    const int32_t probe = lmb_probes_find(work->probes, 0, at[0], at[1], at[2]);
    if (probe < 0 || !(work->probes->validity[probe] >= LMB_PROBES_MIN_VALIDITY)) {
        return -1;
    }
    uint64_t rays = 0;
    const lmb_rgb share = lmb_trace_transmittance(work->tracer, from, position_in_scene(work, probe), &rays);
    return lmb_rgb_max(share) > 0.0f ? probe : -1;
}

/* The cell of that size about a point that a random number chooses. False: not all of it is seen. */
static bool cell_find(const measured *work, int32_t probe, int32_t size, cell *found)
{
    const int32_t *point = work->probes->point[probe];
    const lmb_vec3 from = position_in_scene(work, probe);
    int32_t phase[3];
    for (int axis = 0; axis < 3; ++axis) {
        const uint64_t stream = lmb_mix((uint64_t)probe, (uint64_t)size);
        phase[axis] = (int32_t)(lmb_random(stream, (uint32_t)axis, 0, 0) * (float)size);
    }
    for (int k = 0; k < CORNERS; ++k) {
        int32_t at[3];
        found->weight[k] = 1.0f;
        for (int axis = 0; axis < 3; ++axis) {
            const bool upper = (k >> axis & 1) != 0;
            const float share = (float)phase[axis] / (float)size;
            at[axis] = point[axis] - phase[axis] + (upper ? size : 0);
            found->step[k][axis] = point[axis] - at[axis];
            found->weight[k] *= upper ? share : 1.0f - share;
        }
        found->probe[k] = probe_seen(work, at, from);
        for (int axis = 0; axis < 3 && found->probe[k] >= 0; ++axis) {
            for (int side = 0; side < 2; ++side) {
                int32_t beside[3] = {at[0], at[1], at[2]};
                beside[axis] += side ? 1 : -1;
                found->beside[k][axis][side] = probe_seen(work, beside, from);
                if (found->beside[k][axis][side] < 0) {
                    return false;
                }
            }
        }
        if (found->probe[k] < 0) {
            return false;
        }
    }
    return true;
}

static float number_of(const measured *work, int32_t probe, int i)
{
    return work->probes->radiance[0][probe].channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT];
}

static void cell_interpolate(const measured *work, const cell *from, int i, double value[METHODS])
{
    double plain = 0.0, first_order = 0.0;
    for (int k = 0; k < CORNERS; ++k) {
        plain += (double)from->weight[k] * (double)number_of(work, from->probe[k], i);
        for (int axis = 0; axis < 3; ++axis) {
            const double slope = 0.5 * ((double)number_of(work, from->beside[k][axis][1], i) -
                                        (double)number_of(work, from->beside[k][axis][0], i));
            first_order += (double)from->weight[k] * slope * from->step[k][axis];
        }
    }
    value[0] = plain;
    value[1] = plain + first_order;
    value[2] = plain + 0.5 * first_order;
}

/* Adds the squared error of irradiance, whose norm over the sphere the bands' scales give. */
static void point_measure(measured *work, int32_t probe, const cell cells[SIZES])
{
    for (int i = 0; i < NUMBERS; ++i) {
        const int coefficient = i % LMB_SH3_COUNT;
        const double scale = coefficient == 0 ? 1.0 : coefficient < LMB_SH2_COUNT ? 2.0 / 3.0 : 0.25;
        const double truth = (double)number_of(work, probe, i);
        work->squared_light += scale * scale * truth * truth;
        for (int s = 0; s < SIZES; ++s) {
            double value[METHODS];
            cell_interpolate(work, &cells[s], i, value);
            for (int m = 0; m < METHODS; ++m) {
                work->squared_error[s][m] += scale * scale * (value[m] - truth) * (value[m] - truth);
            }
        }
    }
    ++work->points;
}

static void volume_measure(measured *work)
{
    for (int32_t probe = 0; probe < work->probes->count; ++probe) {
        cell cells[SIZES];
        bool whole = work->probes->validity[probe] >= LMB_PROBES_MIN_VALIDITY;
        for (int s = 0; s < SIZES && whole; ++s) {
            whole = cell_find(work, probe, sizes[s], &cells[s]);
        }
        if (whole) {
            point_measure(work, probe, cells);
        }
    }
}

static void report_print(const measured *work)
{
    const double fine = (double)work->probes->level[0].lattice.spacing;
    printf("# %zu of %d probes have whole cells\n", work->points, work->probes->count);
    printf("# spacing\tbytes\tbytes_with\tplain\tgradients\thalf\n");
    for (int s = 0; s < SIZES; ++s) {
        const double spacing = fine * sizes[s], probes = 1.0 / (spacing * spacing * spacing);
        printf("%g\t%.4g\t%.4g", spacing, 2.0 * NUMBERS * probes, 8.0 * NUMBERS * probes);
        for (int m = 0; m < METHODS; ++m) {
            printf("\t%.5f", sqrt(work->squared_error[s][m] / work->squared_light));
        }
        putchar('\n');
    }
}

int main(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "gradients", usage);
    const char *path[2] = {NULL, NULL};
    int given = 0;
    for (const char *next; (next = arguments_next(&arguments));) {
        if (next[0] == '-' || given == 2) {
            arguments_error(&arguments, "unexpected argument", next);
        } else {
            path[given++] = next;
        }
    }
    if (!arguments.failed && !arguments.help && given < 2) {
        arguments_error(&arguments, "missing argument", given == 0 ? "LEVEL" : "DIR");
    }
    if (arguments.failed || arguments.help) {
        return arguments_status(&arguments);
    }
    lmb_error error = {""};
    lmb_baked baked;
    lmb_probes *probes = NULL;
    lmb_result result = lmb_baked_open(path[0], path[1], 0, NULL, &baked, &error);
    char *file = lmb_file_in(path[1], "probes.vdb");
    if (result == LMB_OK) {
        result = file ? lmb_vdb_read(file, &probes, NULL, NULL, &error) : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        measured work = {.tracer = baked.level.tracer, .probes = probes};
        volume_measure(&work);
        report_print(&work);
    }
    lmb_probes_destroy(probes);
    lmb_baked_close(&baked);
    free(file);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
