/* Levels beside each other: which cells light is interpolated in, and the probes of a finer level on a coarser one's
 * cells. These have no light of their own but the coarser cell's interpolation, so that there is no step between. */
#include <lambent/probes.h>

#include "volume_internal.h"

#include <assert.h>
#include <string.h>

/* Whether the probes of any of a block's points, or a cut, make one of its cells be there. */
static bool block_has_cell(const lmb_probes *probes, uint32_t level, const int32_t at[3])
{
    const lmb_probe_level *const own = &probes->level[level];
    const lmb_probe_block *const points = lmb_probe_index_block(&own->index, at);
    const lmb_probe_block *const cuts = lmb_probe_index_block(&own->cut, at);
    for (int within = 0; within < LMB_PROBE_BLOCK_POINTS; ++within) {
        const int32_t cell[3] = {at[0] * LMB_PROBE_BLOCK + within % LMB_PROBE_BLOCK,
                                 at[1] * LMB_PROBE_BLOCK + within / LMB_PROBE_BLOCK % LMB_PROBE_BLOCK,
                                 at[2] * LMB_PROBE_BLOCK + within / LMB_PROBE_BLOCK / LMB_PROBE_BLOCK};
        const double first[3] = {0.0};
        lmb_probe_cell found;
        if ((cuts && cuts->probe[within] >= 0) ||
            (points && points->probe[within] >= 0 && lmb_probes_cell_at(probes, level, cell, first, &found))) {
            return true;
        }
    }
    return false;
}

/* Whether there is a cell of a level, or of a finer one, within 4 x 4 x 4 of its cells, the first at 4 `at`. */
static bool brick_has_cell(const lmb_probes *probes, uint32_t level, const int32_t at[3])
{
    bool has = block_has_cell(probes, level, at);
    for (int part = 0; part < 8 && level > 0 && !has; ++part) {
        const int32_t finer[3] = {2 * at[0] + (part & 1), 2 * at[1] + (part >> 1 & 1), 2 * at[2] + (part >> 2)};
        has = brick_has_cell(probes, level - 1, finer);
    }
    return has;
}

/* Rounded down. */
static int32_t divided(int32_t point, uint32_t power_of_two)
{
    const uint32_t rest = (uint32_t)point & (power_of_two - 1);
    return (int32_t)(((int64_t)point - rest) / power_of_two);
}

bool lmb_probes_leaf_at(const lmb_probes *probes, uint32_t level, const int32_t cell[3], const double fraction[3],
                        lmb_probe_cell *found)
{
    if (!lmb_probes_cell_at(probes, level, cell, fraction, found)) {
        return false;
    }
    const int32_t cube[3] = {divided(cell[0], 2), divided(cell[1], 2), divided(cell[2], 2)};
    return level == 0 || !brick_has_cell(probes, level - 1, cube);
}

bool lmb_probes_level_has(const lmb_probes *probes, uint32_t level, const int32_t cell[3])
{
    assert(probes && level < probes->level_count && cell);
    bool has = true;
    int32_t cube[3] = {divided(cell[0], 2), divided(cell[1], 2), divided(cell[2], 2)};
    for (uint32_t at = level; at < probes->level_count && has; ++at) {
        has = at == 0 || brick_has_cell(probes, at - 1, cube) == (at > level);
        for (int axis = 0; axis < 3; ++axis) {
            cube[axis] = divided(cube[axis], 2);
        }
    }
    return has;
}

bool lmb_probes_cell_is_leaf(const lmb_probes *probes, uint32_t level, const int32_t cell[3])
{
    assert(probes && level < probes->level_count && cell);
    const double first[3] = {0.0};
    lmb_probe_cell found;
    return lmb_probes_leaf_at(probes, level, cell, first, &found);
}

/* How far within a leaf a probe on its side is looked at, in spacings of the probe's level. */
#define WITHIN_SPACINGS 0.02

/* One of the cells of a coarser level that touch a point, of which `step` spacings are one of theirs: `side` has a bit
 * for each axis along which the cell is the one below. @return false where that side has none */
static bool cell_touching(const int32_t point[3], uint32_t step, int side, int32_t cell[3], double fraction[3])
{
    bool touches = true;
    for (int axis = 0; axis < 3; ++axis) {
        const bool below = (side >> axis & 1) != 0;
        const uint32_t rest = (uint32_t)point[axis] & (step - 1);
        cell[axis] = divided(point[axis], step) - below;
        fraction[axis] = below ? 1.0 : (double)rest / step;
        touches = touches && !(below && rest != 0);
    }
    return touches;
}

/* Moves off the sides of a cell, where a cut cell's planes may part it from the other side; `step` as above. */
static void move_within(uint32_t step, const double fraction[3], double within[3])
{
    const double inset = WITHIN_SPACINGS / step;
    for (int axis = 0; axis < 3; ++axis) {
        within[axis] = fraction[axis] < inset ? inset : fraction[axis] > 1.0 - inset ? 1.0 - inset : fraction[axis];
    }
}

/* The cell for a probe that lies at its side. */
static bool side_cell(const lmb_probes *probes, uint32_t level, const int32_t cell[3], uint32_t step,
                      const double fraction[3], lmb_probe_cell *found)
{
    double within[3];
    move_within(step, fraction, within);
    return lmb_probes_leaf_at(probes, level, cell, within, found);
}

static bool side_is_seen(const lmb_probes *probes, int32_t probe, uint32_t level, int side, lmb_probe_sees sees,
                         void *context)
{
    const uint32_t own = (uint32_t)(lmb_probes_level_of(probes, probe) - probes->level);
    const uint32_t step = UINT32_C(1) << (level - own);
    int32_t cell[3];
    lmb_probe_cell found;
    double fraction[3], within[3];
    if (!cell_touching(probes->point[probe], step, side, cell, fraction) ||
        !side_cell(probes, level, cell, step, fraction, &found)) {
        return false;
    }
    const lmb_lattice *const lattice = &probes->level[level].lattice;
    const double spacing = (double)lattice->spacing;
    move_within(step, fraction, within);
    const lmb_vec3d local = {spacing * (cell[0] + within[0]), spacing * (cell[1] + within[1]),
                             spacing * (cell[2] + within[2])};
    return !sees || sees(context, probe, lmb_lattice_vector_to_world(lattice, local));
}

/* 1 + the side, of 8, + 8 times how many levels coarser than the next one the leaf is. */
enum { HANGING_SIDES = 8, HANGING_LEVELS = 31 };

void lmb_probes_find_hanging(lmb_probes *probes, int32_t first, int32_t count, lmb_probe_sees sees, void *context)
{
    assert(probes && first >= 0 && count >= 0 && first + count <= probes->count);
    for (int32_t probe = first; probe < first + count; ++probe) {
        const uint32_t own = (uint32_t)(lmb_probes_level_of(probes, probe) - probes->level);
        const bool is_ghost = probe >= probes->count - probes->ghost_count;
        probes->hanging[probe] = 0;
        for (uint32_t level = probes->level_count - 1; level > own && !is_ghost; --level) {
            for (int side = 0; side < HANGING_SIDES && !probes->hanging[probe] && level - own < HANGING_LEVELS;
                 ++side) {
                if (side_is_seen(probes, probe, level, side, sees, context)) {
                    probes->hanging[probe] = (uint8_t)(1 + side + HANGING_SIDES * (int)(level - own - 1));
                }
            }
        }
    }
}

/* The level of the leaf that a probe hangs on; it does. */
static uint32_t hanging_level(const lmb_probes *probes, int32_t probe)
{
    const uint32_t above = 1 + (uint32_t)(probes->hanging[probe] - 1) / HANGING_SIDES;
    return (uint32_t)(lmb_probes_level_of(probes, probe) - probes->level) + above;
}

bool lmb_probes_hanging_is_sane(const lmb_probes *probes, int32_t probe)
{
    return probes->hanging[probe] == 0 || hanging_level(probes, probe) < probes->level_count;
}

bool lmb_probes_hangs(const lmb_probes *probes, int32_t probe, lmb_probe_parents *parents)
{
    assert(probes && probe >= 0 && probe < probes->count && parents);
    if (probes->hanging[probe] == 0) {
        return false;
    }
    const int side = (probes->hanging[probe] - 1) % HANGING_SIDES;
    const uint32_t level = hanging_level(probes, probe);
    const uint32_t step = UINT32_C(1) << (level - (uint32_t)(lmb_probes_level_of(probes, probe) - probes->level));
    int32_t cell[3];
    lmb_probe_cell found;
    double fraction[3];
    if (!cell_touching(probes->point[probe], step, side, cell, fraction) ||
        !side_cell(probes, level, cell, step, fraction, &found)) {
        return false;
    }
    parents->count = found.share > 0.0 ? 16 : 8;
    for (uint32_t i = 0; i < parents->count; ++i) {
        const double weight = (i & 1 ? fraction[0] : 1.0 - fraction[0]) * (i & 2 ? fraction[1] : 1.0 - fraction[1]) *
                              (i & 4 ? fraction[2] : 1.0 - fraction[2]);
        parents->probe[i] = i < 8 ? found.probe[i] : found.other[i - 8];
        parents->weight[i] = weight * (i < 8 ? 1.0 - found.share : found.share);
    }
    return true;
}

static void probe_hang(lmb_probes *probes, int32_t probe, const lmb_probe_parents *parents)
{
    for (uint32_t set = 0; set < probes->set_count; ++set) {
        lmb_sh3_rgb *const light = probes->radiance[set];
        for (int number = 0; number < 3 * LMB_SH3_COUNT; ++number) {
            const int channel = number / LMB_SH3_COUNT, k = number % LMB_SH3_COUNT;
            double sum = 0.0;
            for (uint32_t i = 0; i < parents->count; ++i) {
                sum += parents->weight[i] * (double)light[parents->probe[i]].channel[channel].c[k];
            }
            light[probe].channel[channel].c[k] = (float)sum;
        }
    }
    for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
        double sum = 0.0;
        for (uint32_t i = 0; i < parents->count; ++i) {
            sum += parents->weight[i] * (double)probes->key_visibility[parents->probe[i]][key];
        }
        probes->key_visibility[probe][key] = sum < 1.0 ? (float)sum : 1.0f;
    }
}

void lmb_probes_hang_level(lmb_probes *probes, uint32_t level)
{
    const lmb_probe_level *const own = &probes->level[level];
    for (int32_t probe = own->first; probe < own->first + own->count; ++probe) {
        lmb_probe_parents parents;
        if (lmb_probes_hangs(probes, probe, &parents)) {
            probe_hang(probes, probe, &parents);
        }
    }
}

void lmb_probes_hang(lmb_probes *probes)
{
    assert(probes);
    for (uint32_t level = probes->level_count; level-- > 0;) {
        lmb_probes_hang_level(probes, level);
    }
}
