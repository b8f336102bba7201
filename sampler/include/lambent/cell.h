/* Cells that geometry cuts into regions of free space: which region a point of one is in.
 *
 * A cut cell has planes in a binary tree, and eight probes for each of its regions (after the virtual nodes of cutting
 * simulations: Molino, Bao and Fedkiw 2004). A point inside of a wall is in one of them too. */
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
                          LMB_CELL_REGION + that of a region */
} lmb_cell_plane;

enum {
    LMB_CELL_UNIT = 16383,
    LMB_CELL_PLANES_MOST = 31, /* in a cell */
    LMB_CELL_REGIONS_MOST = 32,
    LMB_CELL_REGION = 128
};

/* Whether every child of a cell's planes is a plane further on, or a region of the cell. */
static inline bool lmb_cell_planes_are_sane(const lmb_cell_plane *plane, uint32_t planes, uint32_t regions)
{
    bool sane = planes <= LMB_CELL_PLANES_MOST && regions >= 1 && regions <= LMB_CELL_REGIONS_MOST;
    for (uint32_t i = 0; sane && i < planes; ++i) {
        for (int side = 0; side < 2; ++side) {
            const uint32_t child = plane[i].child[side];
            sane = sane && (child < LMB_CELL_REGION ? child > i && child < planes : child - LMB_CELL_REGION < regions);
        }
    }
    return sane;
}

/* The region of a cell of so many planes that t is in. No NaN. */
static inline uint32_t lmb_cell_region(const lmb_cell_plane *plane, uint32_t count, const float t[3])
{
    uint32_t at = count > 0 ? 0 : LMB_CELL_REGION;
    while (at < LMB_CELL_REGION) {
        const lmb_cell_plane *const p = &plane[at];
        const float along = (float)p->normal[0] * t[0] + (float)p->normal[1] * t[1] + (float)p->normal[2] * t[2];
        at = p->child[along > (float)p->offset];
    }
    return at - LMB_CELL_REGION;
}

#ifdef __cplusplus
}
#endif

#endif
