/* Cells that geometry cuts into regions of free space: which region a point of one is in.
 *
 * A cut cell has planes in a binary tree, and eight probes for each of its regions (after the virtual nodes of cutting
 * simulations: Molino, Bao and Fedkiw 2004). A point inside of a wall is in one of them too. Where a wall ends within a
 * cell, the light of its sides passes over into each other beyond the end: in the wedge between two planes that meet
 * at the end, by how far a point is from either. There a point is in two regions. */
#ifndef LAMBENT_CELL_H
#define LAMBENT_CELL_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A plane in coordinates of its cell, which run from 0 to 1, and what is on its sides. */
typedef struct lmb_cell_plane {
    int16_t normal[3]; /* in 16383ths, of unit length as near as may be */
    int16_t offset;    /* normal . t on it, in 16383ths: to 1/16383 of a spacing */
    uint8_t child[2];  /* [0] normal . t <= offset, [1] above: the number of a plane further on in the cell, or
                          LMB_CELL_REGION + that of a region, or LMB_CELL_BLEND + that of any other plane: between these
                          two. On the other side of either plane there is a region, and no two of one plane */
} lmb_cell_plane;

enum {
    LMB_CELL_UNIT = 16383,
    LMB_CELL_PLANES_MOST = 31, /* in a cell */
    LMB_CELL_REGIONS_MOST = 32,
    LMB_CELL_REGION = 128,
    LMB_CELL_BLEND = LMB_CELL_REGION + LMB_CELL_REGIONS_MOST
};

/* The regions that a point is in. */
typedef struct lmb_cell_regions {
    uint32_t region[2]; /* twice the same, but in a wedge */
    float share;        /* of the second one, 0 to 1 */
} lmb_cell_regions;

static inline bool lmb_cell_is_region(uint32_t child)
{
    return child >= LMB_CELL_REGION && child < LMB_CELL_BLEND;
}

/* How far t is above a plane, in 16383ths of a spacing. */
static inline float lmb_cell_above(const lmb_cell_plane *plane, const float t[3])
{
    return (float)plane->normal[0] * t[0] + (float)plane->normal[1] * t[1] + (float)plane->normal[2] * t[2] -
           (float)plane->offset;
}

/* Whether every child of a cell's planes is a plane further on, a region of the cell, or a wedge between two. */
static inline bool lmb_cell_planes_are_sane(const lmb_cell_plane *plane, uint32_t planes, uint32_t regions)
{
    bool sane = planes <= LMB_CELL_PLANES_MOST && regions >= 1 && regions <= LMB_CELL_REGIONS_MOST;
    for (uint32_t i = 0; sane && i < planes; ++i) {
        for (int side = 0; sane && side < 2; ++side) {
            const uint32_t child = plane[i].child[side];
            if (child < LMB_CELL_REGION) {
                sane = child > i && child < planes;
            } else if (child < LMB_CELL_BLEND) {
                sane = child - LMB_CELL_REGION < regions;
            } else {
                const uint32_t other = child - LMB_CELL_BLEND;
                sane = other < planes && other != i && lmb_cell_is_region(plane[i].child[1 - side]) &&
                       lmb_cell_is_region(plane[other].child[0]) != lmb_cell_is_region(plane[other].child[1]);
            }
        }
    }
    return sane;
}

/* The regions of a cell of so many planes that t is in. No NaN. */
static inline lmb_cell_regions lmb_cell_regions_at(const lmb_cell_plane *plane, uint32_t count, const float t[3])
{
    uint32_t at = count > 0 ? 0 : LMB_CELL_REGION, last = 0, side = 0;
    while (at < LMB_CELL_REGION) {
        const lmb_cell_plane *const p = &plane[at];
        const float along = (float)p->normal[0] * t[0] + (float)p->normal[1] * t[1] + (float)p->normal[2] * t[2];
        last = at;
        side = along > (float)p->offset;
        at = p->child[side];
    }
    lmb_cell_regions in = {{at - LMB_CELL_REGION, at - LMB_CELL_REGION}, 0.0f};
    if (at >= LMB_CELL_BLEND) {
        const lmb_cell_plane *const own = &plane[last], *const other = &plane[at - LMB_CELL_BLEND];
        const float above = lmb_cell_above(own, t), beyond = lmb_cell_above(other, t);
        const float distance = above < 0.0f ? -above : above, sum = distance + (beyond < 0.0f ? -beyond : beyond);
        in.region[0] = (uint32_t)own->child[1 - side] - LMB_CELL_REGION;
        in.region[1] = (uint32_t)other->child[lmb_cell_is_region(other->child[0]) ? 0 : 1] - LMB_CELL_REGION;
        in.share = sum > 0.0f ? distance / sum : 0.0f;
    }
    return in;
}

/* The one that weighs most. */
static inline uint32_t lmb_cell_region(const lmb_cell_plane *plane, uint32_t count, const float t[3])
{
    const lmb_cell_regions at = lmb_cell_regions_at(plane, count, t);
    return at.region[at.share > 0.5f];
}

#ifdef __cplusplus
}
#endif

#endif
