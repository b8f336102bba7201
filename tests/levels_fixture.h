/* Probes of several levels, with cells that are cut, as placement leaves them: cubes of 2 x 2 x 2 cells are wholly of
 * one level or wholly finer, and a fine probe on a coarser cell has that cell's light. */
#ifndef LMB_TESTS_LEVELS_FIXTURE_H
#define LMB_TESTS_LEVELS_FIXTURE_H

#include <stdbool.h>
#include <string.h>

#include "harness.h"
#include "probes_fixture.h"

enum { LEVELS_MOST = 4, LEVEL_POINTS_MOST = 60000, LEVEL_GHOSTS_MOST = 20000 };

typedef struct levels_recipe {
    float spacing;
    uint32_t levels;
    int32_t low, cubes; /* of the coarsest level, from `low` on along each axis */
    double split;       /* share of cubes that are finer */
    double holes;       /* share of whole cubes that are not there */
    double cut;         /* share of cells that are cut */
    double wedges;      /* share of these, where they have two regions or more, that have a wedge */
    uint32_t keys;
    uint64_t seed;
} levels_recipe;

/* What is made on the way. */
typedef struct levels_work {
    const levels_recipe *recipe;
    uint64_t state;
    int32_t count[LEVELS_MOST], ghost_count[LEVELS_MOST];
    int32_t (*point[LEVELS_MOST])[3];
    int32_t (*ghost[LEVELS_MOST])[3];
    lmb_probe_index known[LEVELS_MOST]; /* points */
    lmb_probe_index leaf[LEVELS_MOST];  /* cubes that are there and not finer */
    int32_t leaf_count;
} levels_work;

static inline void levels_point(levels_work *work, uint32_t level, const int32_t point[3])
{
    if (lmb_probe_index_find(&work->known[level], point) < 0 && work->count[level] < LEVEL_POINTS_MOST) {
        lmb_probe_index_add(&work->known[level], point, work->count[level]);
        memcpy(work->point[level][work->count[level]++], point, sizeof work->point[level][0]);
    }
}

static inline void levels_cube(levels_work *work, uint32_t level, const int32_t cube[3])
{
    if (level > 0 && fixture_random(&work->state) < work->recipe->split) {
        for (int32_t i = 0; i < 8; ++i) {
            const int32_t finer[3] = {2 * cube[0] + (i & 1), 2 * cube[1] + (i >> 1 & 1), 2 * cube[2] + (i >> 2)};
            levels_cube(work, level - 1, finer);
        }
        return;
    }
    if (fixture_random(&work->state) < work->recipe->holes) {
        return;
    }
    lmb_probe_index_add(&work->leaf[level], cube, work->leaf_count++);
    for (int32_t i = 0; i < 27; ++i) {
        const int32_t point[3] = {2 * cube[0] + i % 3, 2 * cube[1] + i / 3 % 3, 2 * cube[2] + i / 9};
        levels_point(work, level, point);
    }
}

static inline int32_t levels_floor(int32_t a, int32_t b)
{
    return a / b - (a % b < 0);
}

/* Light of a coarser cell that the point is in or on. @return false: there is none */
static inline bool levels_hang(const levels_work *work, lmb_probes *probes, uint32_t level, int32_t probe)
{
    for (uint32_t coarser = level + 1; coarser < work->recipe->levels; ++coarser) {
        const int32_t along = 1 << (coarser - level);
        for (int32_t side = 0; side < 8; ++side) {
            int32_t cell[3], cube[3];
            double t[3];
            bool good = true;
            for (int axis = 0; axis < 3; ++axis) {
                cell[axis] = levels_floor(probes->point[probe][axis], along) - (side >> axis & 1);
                t[axis] = (double)(probes->point[probe][axis] - cell[axis] * along) / along;
                cube[axis] = levels_floor(cell[axis], 2);
                good = good && t[axis] <= 1.0;
            }
            if (!good || lmb_probe_index_find(&work->leaf[coarser], cube) < 0) {
                continue;
            }
            double sum[27] = {0.0}, seen[LMB_KEY_LIGHTS_MOST] = {0.0};
            for (int32_t i = 0; i < 8; ++i) {
                const int32_t other =
                    lmb_probes_find(probes, coarser, cell[0] + (i & 1), cell[1] + (i >> 1 & 1), cell[2] + (i >> 2));
                const double w =
                    (i & 1 ? t[0] : 1.0 - t[0]) * (i & 2 ? t[1] : 1.0 - t[1]) * (i & 4 ? t[2] : 1.0 - t[2]);
                for (int k = 0; k < 27; ++k) {
                    sum[k] += w * (double)probes->radiance[0][other].channel[k / 9].c[k % 9];
                }
                for (int k = 0; k < LMB_KEY_LIGHTS_MOST; ++k) {
                    seen[k] += w * (double)probes->key_visibility[other][k];
                }
            }
            for (int k = 0; k < 27; ++k) {
                probes->radiance[0][probe].channel[k / 9].c[k % 9] = (float)sum[k];
            }
            for (int k = 0; k < LMB_KEY_LIGHTS_MOST; ++k) {
                probes->key_visibility[probe][k] = (float)seen[k];
            }
            return true;
        }
    }
    return false;
}

static inline void levels_light(levels_work *work, lmb_probes *probes, int32_t probe)
{
    for (int k = 0; k < 27; ++k) {
        probes->radiance[0][probe].channel[k / 9].c[k % 9] = (float)(2.0 * fixture_random(&work->state) - 1.0);
    }
    for (uint32_t k = 0; k < work->recipe->keys; ++k) {
        probes->key_visibility[probe][k] = (float)fixture_random(&work->state);
    }
    probes->validity[probe] = 1.0f;
}

/* A cell's regions in a chain of planes, or two with a wedge between, each with some ghosts. */
typedef struct levels_cut {
    int32_t cell[3];
    uint32_t level, regions, planes;
    int32_t corner[4][8]; /* a probe, or -1 - a ghost of the level */
    lmb_cell_plane plane[3];
} levels_cut;

/* Above the second plane, and the third, the first region and the last pass over into each other. */
static inline void levels_wedge_make(levels_cut *cut)
{
    const uint8_t child[3][2] = {{1, 2},
                                 {LMB_CELL_REGION, LMB_CELL_BLEND + 2},
                                 {(uint8_t)(LMB_CELL_REGION + cut->regions - 1), LMB_CELL_BLEND + 1}};
    for (int k = 0; k < 3; ++k) {
        memcpy(cut->plane[k].child, child[k], sizeof child[k]);
    }
}

static inline void levels_cut_make(levels_work *work, const lmb_probes *probes, levels_cut *cut)
{
    for (uint32_t region = 0; region < cut->regions; ++region) {
        for (int32_t i = 0; i < 8; ++i) {
            const int32_t at[3] = {cut->cell[0] + (i & 1), cut->cell[1] + (i >> 1 & 1), cut->cell[2] + (i >> 2)};
            int32_t *const ghosts = &work->ghost_count[cut->level];
            if (fixture_random(&work->state) < 0.5 && *ghosts < LEVEL_GHOSTS_MOST) {
                memcpy(work->ghost[cut->level][*ghosts], at, sizeof at);
                cut->corner[region][i] = -1 - (*ghosts)++;
            } else {
                cut->corner[region][i] = lmb_probes_find(probes, cut->level, at[0], at[1], at[2]);
            }
        }
    }
    const double wedges = work->recipe->wedges;
    const bool has_wedge = wedges > 0.0 && cut->regions > 1 && fixture_random(&work->state) < wedges;
    cut->planes = has_wedge ? 3 : cut->regions - 1;
    for (uint32_t k = 0; k < cut->planes; ++k) {
        double n[3], length = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            n[axis] = 2.0 * fixture_random(&work->state) - 1.0;
            length += n[axis] * n[axis];
        }
        double offset = 0.4 * (fixture_random(&work->state) - 0.5);
        for (int axis = 0; axis < 3; ++axis) {
            n[axis] /= sqrt(length);
            offset += 0.5 * n[axis];
            cut->plane[k].normal[axis] = (int16_t)lrint(n[axis] * LMB_CELL_UNIT);
        }
        cut->plane[k].offset = (int16_t)lrint(offset * LMB_CELL_UNIT);
        cut->plane[k].child[0] = (uint8_t)(LMB_CELL_REGION + k);
        cut->plane[k].child[1] = (uint8_t)(k + 2 < cut->regions ? k + 1 : LMB_CELL_REGION + k + 1);
    }
    if (has_wedge) {
        levels_wedge_make(cut);
    }
}

/* Cuts cells of cubes that are there. */
static inline bool levels_cut_cells(levels_work *work, lmb_probes *probes)
{
    levels_cut *const cut = malloc((size_t)(8 * work->leaf_count + 1) * sizeof *cut);
    int32_t count = 0;
    for (uint32_t level = 0; cut && level < work->recipe->levels; ++level) {
        const lmb_probe_index *const leaf = &work->leaf[level];
        for (uint32_t i = 0; i < 64 * leaf->block_count; ++i) {
            const lmb_probe_block *const block = &leaf->block[i / 64];
            const int32_t in = (int32_t)(i % 64);
            for (int32_t k = 0; k < 8 && block->probe[in] >= 0; ++k) {
                if (fixture_random(&work->state) < work->recipe->cut) {
                    levels_cut *const made = &cut[count++];
                    *made = (levels_cut){.level = level,
                                         .regions = 1 + (uint32_t)(fixture_random(&work->state) * 4.0),
                                         .cell = {2 * (4 * block->at[0] + in % 4) + (k & 1),
                                                  2 * (4 * block->at[1] + in / 4 % 4) + (k >> 1 & 1),
                                                  2 * (4 * block->at[2] + in / 16) + (k >> 2)}};
                    levels_cut_make(work, probes, made);
                }
            }
        }
    }
    int32_t first[LEVELS_MOST];
    bool good = cut != NULL;
    for (uint32_t level = 0; good && level < work->recipe->levels; ++level) {
        good = lmb_probes_add_ghosts(probes, level, (const int32_t(*)[3])work->ghost[level], work->ghost_count[level],
                                     &first[level]) == LMB_OK;
    }
    for (int32_t i = 0; good && i < count; ++i) {
        for (uint32_t k = 0; k < 8 * cut[i].regions; ++k) {
            int32_t *const corner = &cut[i].corner[k / 8][k % 8];
            *corner = *corner < 0 ? first[cut[i].level] - 1 - *corner : *corner;
        }
        good = lmb_probes_cut(probes, cut[i].level, cut[i].cell, cut[i].plane, cut[i].planes,
                              (const int32_t(*)[8])cut[i].corner, cut[i].regions) == LMB_OK;
    }
    free(cut);
    return good;
}

static inline void levels_work_free(levels_work *work)
{
    for (int level = 0; level < LEVELS_MOST; ++level) {
        free(work->point[level]);
        free(work->ghost[level]);
        lmb_probe_index_free(&work->known[level]);
        lmb_probe_index_free(&work->leaf[level]);
    }
}

/* The box around a level's points, with room for cells beside it. */
static inline lmb_lattice levels_lattice(const levels_work *work, uint32_t level)
{
    const int32_t along = 1 << (work->recipe->levels - 1 - level);
    const int32_t low = 2 * work->recipe->low * along, size = 2 * work->recipe->cubes * along + 1;
    return (lmb_lattice){
        .spacing = ldexpf(work->recipe->spacing, (int)level), .min = {low, low, low}, .size = {size, size, size}};
}

/* Aborts when out of memory. */
static inline lmb_probes *levels_make(const levels_recipe *recipe)
{
    levels_work work = {.recipe = recipe, .state = recipe->seed * UINT64_C(0x9e3779b97f4a7c15) + 1};
    lmb_probes *probes = NULL;
    bool good = lmb_probes_create(&probes) == LMB_OK;
    for (int level = 0; level < LEVELS_MOST; ++level) {
        work.point[level] = malloc(LEVEL_POINTS_MOST * sizeof *work.point[level]);
        work.ghost[level] = malloc(LEVEL_GHOSTS_MOST * sizeof *work.ghost[level]);
        good = good && work.point[level] && work.ghost[level];
    }
    for (int32_t i = 0; good && i < recipe->cubes * recipe->cubes * recipe->cubes; ++i) {
        const int32_t cube[3] = {recipe->low + i % recipe->cubes, recipe->low + i / recipe->cubes % recipe->cubes,
                                 recipe->low + i / recipe->cubes / recipe->cubes};
        levels_cube(&work, recipe->levels - 1, cube);
    }
    for (uint32_t level = 0; good && level < recipe->levels; ++level) {
        const lmb_lattice lattice = levels_lattice(&work, level);
        good =
            lmb_probes_add_level(probes, &lattice, (const int32_t(*)[3])work.point[level], work.count[level]) == LMB_OK;
    }
    good = good && levels_cut_cells(&work, probes);
    for (uint32_t key = 0; good && key < recipe->keys; ++key) {
        probes->key_light[key] = (lmb_key_light){{0.0f, 1.0f, 0.0f}, {{1.0f, 2.0f, 3.0f}}};
        probes->key_light_count = recipe->keys;
    }
    for (int32_t probe = 0; good && probe < probes->count; ++probe) {
        levels_light(&work, probes, probe);
    }
    for (uint32_t level = recipe->levels; good && level-- > 0;) {
        const lmb_probe_level *const own = &probes->level[level];
        for (int32_t probe = own->first; probe < own->first + own->count; ++probe) {
            levels_hang(&work, probes, level, probe);
        }
    }
    levels_work_free(&work);
    lmb_error error = {{0}};
    if (!good || lmb_probes_validate(probes, &error) != LMB_OK) {
        fprintf(stderr, "levels: %s\n", error.message);
        abort();
    }
    return probes;
}

static const levels_recipe levels_recipes[] = {
    {.spacing = 0.5f, .levels = 1, .low = -2, .cubes = 5, .cut = 0.3, .keys = 2, .seed = 1},
    {.spacing = 0.5f, .levels = 2, .low = -3, .cubes = 5, .split = 0.5, .seed = 2},
    {.spacing = 0.3f, .levels = 3, .low = -1, .cubes = 3, .split = 0.6, .keys = 1, .seed = 3},
    {.spacing = 1.7f, .levels = 3, .low = 5, .cubes = 3, .split = 0.6, .holes = 0.2, .cut = 0.2, .keys = 4, .seed = 4},
    {.spacing = 0.25f, .levels = 4, .low = -1, .cubes = 2, .split = 0.6, .holes = 0.1, .cut = 0.1, .seed = 5},
    {.spacing = 0.1f, .levels = 4, .low = 40, .cubes = 2, .split = 0.4, .cut = 0.5, .keys = 3, .seed = 6},
    {.spacing = 0.5f,
     .levels = 2,
     .low = -2,
     .cubes = 4,
     .split = 0.3,
     .cut = 0.15,
     .wedges = 0.8,
     .keys = 3,
     .seed = 7},
};
enum { LEVELS_RECIPES = sizeof levels_recipes / sizeof levels_recipes[0] };

#endif
