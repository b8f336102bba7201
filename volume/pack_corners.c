/* Light for corners that no probe holds, so that every cell that is stored has eight. On a coarser cell it is that
 * cell's interpolation, as of any finer probe there; elsewhere the mean of the neighbours, as dilation has it. */
#include "pack_internal.h"

#include <Imath/half.h>
#include <string.h>

/* A sum of probes as they are stored: what was rounded already, in a .vdb, gives the same. */
typedef struct light_sum {
    double light[LMB_PROBE_COEFFICIENTS];
    double seen[LMB_KEY_LIGHTS_MOST];
    double weight;
} light_sum;

static void sum_add(const lmb_packing *packing, int32_t probe, double weight, light_sum *sum)
{
    uint16_t half[LMB_PROBE_COEFFICIENTS];
    lmb_pack_halfs(&packing->probes->radiance[0][probe], packing->header.scale, half);
    for (int i = 0; i < LMB_PROBE_COEFFICIENTS; ++i) {
        sum->light[i] += weight * (double)(imath_half_to_float(half[i]) * packing->header.scale);
    }
    for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
        sum->seen[key] += weight * (double)packing->probes->key_visibility[probe][key];
    }
    sum->weight += weight;
}

static void corner_set(lmb_pack_corner *corner, const light_sum *sum)
{
    for (int i = 0; i < LMB_PROBE_COEFFICIENTS; ++i) {
        corner->light.channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT] = (float)(sum->light[i] / sum->weight);
    }
    for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
        corner->seen[key] = (float)(sum->seen[key] / sum->weight);
    }
}

/* The eight probes of a level's cell at a place in it, or those of a wedge's two regions, and the share of the second
 * ones. @return false: it is not there, or `stored` and not so */
static bool cell_probes(const lmb_packing *packing, uint32_t level, const int32_t cell[3], const double t[3],
                        bool stored, int32_t probe[2][8], double *share)
{
    uint32_t number;
    const lmb_pack_brick *const brick = lmb_pack_brick_of(packing, level, cell, &number);
    if (!brick) {
        return false;
    }
    if ((stored ? brick->cut_stored : brick->cut) >> number & 1u) {
        const lmb_cut_cells *const cuts = &packing->probes->cut;
        const lmb_cut_cell *const cut = &cuts->cell[lmb_probe_index_find(&packing->probes->level[level].cut, cell)];
        const float at[3] = {(float)t[0], (float)t[1], (float)t[2]};
        const lmb_cell_regions in = lmb_cell_regions_at(&cuts->plane[cut->plane_first], cut->plane_count, at);
        memcpy(probe[0], cuts->corner[cut->region_first + in.region[0]], sizeof probe[0]);
        memcpy(probe[1], cuts->corner[cut->region_first + in.region[1]], sizeof probe[1]);
        *share = (double)in.share;
        return true;
    }
    const uint64_t cells = stored ? brick->plain & brick->whole : brick->whole;
    for (int32_t i = 0; i < 8 && (cells >> number & 1u); ++i) {
        const int32_t point[3] = {cell[0] + (i & 1), cell[1] + (i >> 1 & 1), cell[2] + (i >> 2)};
        probe[0][i] = lmb_pack_probe(packing, level, point);
    }
    *share = 0.0;
    return cells >> number & 1u;
}

/* By the cells of a coarser level that have the point in or on them: they all agree. */
static bool corner_from_level(const lmb_packing *packing, uint32_t level, lmb_pack_corner *corner)
{
    const int32_t along = INT32_C(1) << (level - corner->level);
    for (int32_t side = 0; side < 8; ++side) {
        int32_t cell[3], probe[2][8];
        double t[3], share;
        bool is_on_side = true;
        for (int axis = 0; axis < 3; ++axis) {
            cell[axis] = lmb_volume_floor_divide(corner->point[axis], along);
            t[axis] = (double)(corner->point[axis] - cell[axis] * along) / along;
            if (side >> axis & 1) {
                is_on_side = is_on_side && t[axis] == 0.0;
                cell[axis] -= 1;
                t[axis] = 1.0;
            }
        }
        if (is_on_side && cell_probes(packing, level, cell, t, !corner->of_coarser, probe, &share)) {
            light_sum sum = {.weight = 0.0};
            for (int i = 0; i < (share > 0.0 ? 16 : 8); ++i) {
                const double weight =
                    (i & 1 ? t[0] : 1.0 - t[0]) * (i & 2 ? t[1] : 1.0 - t[1]) * (i & 4 ? t[2] : 1.0 - t[2]);
                sum_add(packing, probe[i / 8][i % 8], weight * (i < 8 ? 1.0 - share : share), &sum);
            }
            corner_set(corner, &sum);
            return true;
        }
    }
    return false;
}

/* The mean over the 26 neighbours with light, nearer ones weighing more. */
static void corner_from_neighbours(const lmb_packing *packing, lmb_pack_corner *corner)
{
    light_sum sum = {.weight = 0.0};
    for (int32_t n = 0; n < 27; ++n) {
        const int32_t offset[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        const int32_t point[3] = {corner->point[0] + offset[0], corner->point[1] + offset[1],
                                  corner->point[2] + offset[2]};
        const int32_t probe = lmb_pack_probe(packing, corner->level, point);
        if (probe >= 0) {
            const int32_t square = offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2];
            sum_add(packing, probe, 1.0 / square, &sum);
        }
    }
    if (sum.weight > 0.0) {
        corner_set(corner, &sum);
    }
}

void lmb_pack_corners(lmb_packing *packing)
{
    for (int32_t i = 0; i < packing->corner_count; ++i) {
        lmb_pack_corner *const corner = &packing->corner[i];
        bool found = false;
        for (uint32_t level = corner->level + 1; !found && level < packing->probes->level_count; ++level) {
            found = corner_from_level(packing, level, corner);
        }
        if (!found) {
            corner_from_neighbours(packing, corner);
        }
    }
}
