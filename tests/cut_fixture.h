/* Probes in two levels, with ghosts and cut cells, whose light is known: for the tests of what holds, stores and shows
 * them. */
#ifndef LMB_TESTS_CUT_FIXTURE_H
#define LMB_TESTS_CUT_FIXTURE_H

#include <lambent/probes.h>

#include <stdlib.h>

/* The finest level, spacing 0.5: 5 x 5 x 5 points from (-4, 0, 0), less (-4, 4, 4) and (0, 0, 4), so 4 x 4 x 4 cells of
 * which (-1, 0, 3) is not there, and (-4, 3, 3) by its cut alone. The coarse one, spacing 1: 5 x 3 x 3 points from (-2,
 * 0, 0), less the one in the middle of the finest level's cells: the 2 x 2 x 2 of its cells there are the finest
 * level's. */
static const lmb_lattice cut_fixture_lattice[2] = {
    {.spacing = 0.5f, .min = {-4, 0, 0}, .size = {5, 5, 5}},
    {.spacing = 1.0f, .min = {-2, 0, 0}, .size = {5, 3, 3}},
};
static const struct {
    int32_t level, point[3];
} cut_fixture_missing[3] = {{0, {-4, 4, 4}}, {0, {0, 0, 4}}, {1, {-1, 1, 1}}};
enum { CUT_FIXTURE_FINE = 123, CUT_FIXTURE_COARSE = 44 };

enum { CUT_FIXTURE_CELLS = 6, CUT_FIXTURE_REGIONS = 3, CUT_FIXTURE_PLANES = 3 };

typedef struct cut_fixture_cell {
    uint32_t level;
    int32_t point[3];
    uint32_t plane_count, region_count;
    lmb_cell_plane plane[CUT_FIXTURE_PLANES];
    uint8_t ghosts[CUT_FIXTURE_REGIONS]; /* [region] a bit for each corner that gets a ghost, of this region alone */
} cut_fixture_cell;

#define CUT_NO_PLANES                                                                                                  \
    {                                                                                                                  \
        {                                                                                                              \
            {0, 0, 0}, 0,                                                                                              \
            {                                                                                                          \
                0, 0                                                                                                   \
            }                                                                                                          \
        }                                                                                                              \
    }
#define CUT_REGION(r) (uint8_t)(LMB_CELL_REGION + (r))
#define CUT_BLEND(plane) (uint8_t)(LMB_CELL_BLEND + (plane))

/* Offsets are a quarter and a half but for their last digits; 11585 is 16383 / sqrt(2). */
static const cut_fixture_cell cut_fixture_cells[CUT_FIXTURE_CELLS] = {
    /* x = 1/4 */
    {0, {-4, 0, 0}, 1, 2, {{{16383, 0, 0}, 4096, {CUT_REGION(0), CUT_REGION(1)}}}, {0xaa, 0x55}},
    /* whole, with a ghost at its corner 0 */
    {0, {-3, 0, 0}, 0, 1, CUT_NO_PLANES, {0x01}},
    /* x = 1/2, and above it y = 1/2 */
    {0,
     {-2, 0, 0},
     2,
     3,
     {{{16383, 0, 0}, 8192, {CUT_REGION(0), 1}}, {{0, 16383, 0}, 8192, {CUT_REGION(1), CUT_REGION(2)}}},
     {0xaa, 0xdd, 0x77}},
    /* whole, with a ghost at corner 6, where there is no probe */
    {0, {-4, 3, 3}, 0, 1, CUT_NO_PLANES, {0x40}},
    /* x + y = 1 */
    {1, {0, 0, 0}, 1, 2, {{{11585, 11585, 0}, 11585, {CUT_REGION(0), CUT_REGION(1)}}}, {0x88, 0x11}},
    /* a wall at z = 1/2, up to x = 1/2, and from there on a wedge: x + z = 1 below, x = z above */
    {1,
     {1, 0, 0},
     3,
     2,
     {{{0, 0, 16383}, 8192, {1, 2}},
      {{11585, 0, 11585}, 11585, {CUT_REGION(0), CUT_BLEND(2)}},
      {{11585, 0, -11585}, 0, {CUT_REGION(1), CUT_BLEND(1)}}},
     {0xf0, 0x0f}},
};

/* Of coefficient i: probes of the finest level have cut_fixture_light of their place, coarse ones so much more. */
#define CUT_FIXTURE_COARSE_MORE 1000.0
static inline double cut_fixture_light(int i, lmb_vec3d at)
{
    return 1.0 + i + 3.0 * at.x - 5.0 * at.y + 7.0 * at.z;
}

/* Ghosts have what a probe of their level would have there, and so much more. */
static inline double cut_fixture_jump(int cell, uint32_t region)
{
    return 20.0 * (cell + 1) + 100.0 * region;
}

static inline void cut_fixture_fill(lmb_probes *probes, int32_t probe, double more)
{
    const lmb_lattice *const lattice = &lmb_probes_level_of(probes, probe)->lattice;
    const lmb_vec3d at = lmb_lattice_position(lattice, probes->point[probe]);
    more += lattice->spacing == 1.0f ? CUT_FIXTURE_COARSE_MORE : 0.0;
    for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
        probes->radiance[0][probe].channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT] =
            (float)(cut_fixture_light(i, at) + more);
    }
    probes->validity[probe] = 1.0f;
}

static inline lmb_result cut_fixture_add_level(lmb_probes *probes, const lmb_lattice *lattice)
{
    int32_t point[128][3], count = 0;
    for (int32_t i = 0; i < lattice->size[0] * lattice->size[1] * lattice->size[2]; ++i) {
        const int32_t at[3] = {lattice->min[0] + i % lattice->size[0],
                               lattice->min[1] + i / lattice->size[0] % lattice->size[1],
                               lattice->min[2] + i / lattice->size[0] / lattice->size[1]};
        bool wanted = true;
        for (int k = 0; k < 3; ++k) {
            const int32_t *const missing = cut_fixture_missing[k].point;
            const bool is_own = lattice == &cut_fixture_lattice[cut_fixture_missing[k].level];
            wanted = wanted && !(is_own && at[0] == missing[0] && at[1] == missing[1] && at[2] == missing[2]);
        }
        for (int axis = 0; wanted && axis < 3; ++axis) {
            point[count][axis] = at[axis];
        }
        count += wanted;
    }
    return lmb_probes_add_level(probes, lattice, (const int32_t(*)[3])point, count);
}

/* A level's ghosts, in the order in which cells need them. */
static inline lmb_result cut_fixture_add_ghosts(lmb_probes *probes, uint32_t level)
{
    int32_t point[64][3], count = 0, first = 0;
    for (int i = 0; i < CUT_FIXTURE_CELLS; ++i) {
        const cut_fixture_cell *const cell = &cut_fixture_cells[i];
        for (uint32_t k = 0; cell->level == level && k < 8 * cell->region_count; ++k) {
            if (cell->ghosts[k / 8] >> k % 8 & 1) {
                for (int axis = 0; axis < 3; ++axis) {
                    point[count][axis] = cell->point[axis] + (int32_t)(k >> axis & 1);
                }
                ++count;
            }
        }
    }
    return lmb_probes_add_ghosts(probes, level, (const int32_t(*)[3])point, count, &first);
}

/* Cuts a cell; `*ghost` is the level's next one. */
static inline lmb_result cut_fixture_cut(lmb_probes *probes, int number, int32_t *ghost)
{
    const cut_fixture_cell *const cell = &cut_fixture_cells[number];
    int32_t corner[CUT_FIXTURE_REGIONS][8];
    for (uint32_t k = 0; k < 8 * cell->region_count; ++k) {
        int32_t at[3];
        for (int axis = 0; axis < 3; ++axis) {
            at[axis] = cell->point[axis] + (int32_t)(k >> axis & 1);
        }
        if (cell->ghosts[k / 8] >> k % 8 & 1) {
            corner[k / 8][k % 8] = *ghost;
            cut_fixture_fill(probes, (*ghost)++, cut_fixture_jump(number, k / 8));
        } else {
            corner[k / 8][k % 8] = lmb_probes_find(probes, cell->level, at[0], at[1], at[2]);
        }
    }
    return lmb_probes_cut(probes, cell->level, cell->point, cell->plane, cell->plane_count, (const int32_t(*)[8])corner,
                          cell->region_count);
}

/* All of it. Aborts when that cannot be. */
static inline lmb_probes *cut_fixture_probes(void)
{
    lmb_probes *probes = NULL;
    bool good = lmb_probes_create(&probes) == LMB_OK &&
                cut_fixture_add_level(probes, &cut_fixture_lattice[0]) == LMB_OK &&
                cut_fixture_add_level(probes, &cut_fixture_lattice[1]) == LMB_OK;
    for (int32_t probe = 0; good && probe < probes->count; ++probe) {
        cut_fixture_fill(probes, probe, 0.0);
    }
    good = good && cut_fixture_add_ghosts(probes, 0) == LMB_OK && cut_fixture_add_ghosts(probes, 1) == LMB_OK;
    if (!good) {
        abort();
    }
    int32_t ghost[2] = {probes->level[0].ghost_first, probes->level[1].ghost_first};
    for (int i = 0; i < CUT_FIXTURE_CELLS; ++i) {
        if (cut_fixture_cut(probes, i, &ghost[cut_fixture_cells[i].level]) != LMB_OK) {
            abort();
        }
    }
    return probes;
}

#endif
