/* The steps of packing: which cells are stored (pack_cells.c), the light of corners that no probe holds
 * (pack_corners.c), where probes lie in the file (pack_rows.c), records of cut cells (pack_cuts.c), local sets
 * (pack_locals.c), and writing it all (pack.c). */
#ifndef LMB_PACK_INTERNAL_H
#define LMB_PACK_INTERNAL_H

#include <lambent/probes.h>
#include <lambent/volume_format.h>

/* 4 x 4 x 4 cells of a level. Bit x + 4 (y + 4 z) of a mask is a cell. */
typedef struct lmb_pack_brick {
    int32_t at[3]; /* its first point is 4 at */
    uint32_t level;
    uint64_t whole;   /* all eight corners hold probes with light */
    uint64_t touched; /* one of them was baked */
    uint64_t cut;
    uint64_t plain;                             /* to be stored */
    uint64_t cut_stored;                        /* likewise */
    uint32_t row[LMB_BRICK_ROWS];               /* as in the file */
    uint32_t cut_first, ghost_first, cut_shift; /* likewise */
    uint32_t ghost_begin;                       /* of `ghost`: its cut cells', in the order of their records */
} lmb_pack_brick;

/* A point that gets light for the sake of a cell that lacks this corner. */
typedef struct lmb_pack_corner {
    int32_t point[3];
    uint32_t level;
    bool of_coarser; /* the cell is only there because a coarser one was */
    lmb_sh3_rgb light;
    float seen[LMB_KEY_LIGHTS_MOST];
} lmb_pack_corner;

/* Points along x of one brick: those of x = 0 to 4. */
typedef struct lmb_pack_row {
    uint32_t points; /* bit x: it is stored */
    uint32_t start;  /* as in the file */
    bool is_placed;
} lmb_pack_row;

/* Arrays grow as needed; all is zero at first. */
typedef struct lmb_packing {
    const lmb_probes *probes;
    int32_t *pass; /* [probe] < 0: it has no light, or is a ghost */
    lmb_volume_header header;
    lmb_volume_layout layout;
    uint8_t *level_of;   /* [block] the level that is there, or LMB_PACK_NO_LEVEL */
    uint32_t *directory; /* while it is written */
    uint32_t brick_count;
    lmb_pack_brick *brick;                            /* by level, z, y and x */
    lmb_probe_index brick_at[LMB_VOLUME_LEVELS_MOST]; /* by their places */
    int32_t corner_count;
    lmb_pack_corner *corner;
    lmb_probe_index corner_at[LMB_VOLUME_LEVELS_MOST];
    int32_t row_count;
    lmb_pack_row *row;
    lmb_probe_index row_at[LMB_VOLUME_LEVELS_MOST]; /* by brick's x, and y and z of the points */
    uint32_t *stored;                               /* [in the file] the probe, or probes->count + a corner; or
                                                       LMB_PACK_NOTHING */
    uint32_t ghost_count;
    uint32_t *ghost; /* [of a region of a cut cell] its place in the file */
    uint64_t flattened_count;
    uint32_t *slot; /* [probe] a place that it got, or LMB_PACK_NOTHING */
} lmb_packing;

enum { LMB_PACK_NO_LEVEL = 255 };
#define LMB_PACK_NOTHING UINT32_C(0xffffffff)

/* Units from a probe in the file to the next. */
static inline uint32_t lmb_pack_units(const lmb_packing *packing)
{
    return packing->header.probe_bytes / LMB_PROBE_UNIT;
}

/* Whether what a region has at a corner is no probe of the level. */
static inline bool lmb_pack_is_ghost(const lmb_packing *packing, int32_t probe)
{
    return probe >= packing->probes->count - packing->probes->ghost_count;
}

/* Makes room for one more element; it doubles with every power of two. */
bool lmb_pack_reserve(void **array, size_t size, uint32_t count);

/* A probe's light as it is stored. What is beyond halfs is darker as a whole, so that it keeps direction and colour. */
void lmb_pack_halfs(const lmb_sh3_rgb *radiance, float scale, uint16_t half[LMB_PROBE_COEFFICIENTS]);

/* A probe as the header's form has it, with what it sees of key lights. @return colours that were flattened */
uint32_t lmb_pack_probe_write(const lmb_volume_header *header, const lmb_sh3_rgb *light,
                              const float seen[LMB_KEY_LIGHTS_MOST], unsigned char *to);

/* Local sets as lambent/local_set_format.h has them: how many bytes, and those, of memory that is 0. */
uint64_t lmb_pack_locals_bytes(const lmb_probes *probes, const lmb_volume_header *header);
void lmb_pack_locals_write(const lmb_probes *probes, const lmb_volume_header *header, unsigned char *to);

/* Cut cells as lambent/volume_format.h has them, when ghosts have their places: gives bricks the places of their slots,
 * and counts all in the header. @return LMB_ERROR_ARGUMENT (too many) */
lmb_result lmb_pack_cuts_place(lmb_packing *packing);
void lmb_pack_cuts_write(const lmb_packing *packing, unsigned char *to);

/* The probe with light at a point of a level, or -1. */
int32_t lmb_pack_probe(const lmb_packing *packing, uint32_t level, const int32_t point[3]);

/* What is stored for a point: a probe, or probes->count + a corner. */
uint32_t lmb_pack_source(const lmb_packing *packing, uint32_t level, const int32_t point[3]);

/* Finds bricks and their cells, levels of blocks, and corners that want light. @return LMB_ERROR_MEMORY */
lmb_result lmb_pack_cells(lmb_packing *packing);

/* Leaves out the bricks that have no cells to store: after corners got their light, which such bricks may give.
 * @return LMB_ERROR_MEMORY, _ARGUMENT (none is left) */
lmb_result lmb_pack_drop(lmb_packing *packing);

/* Writes the directory, when all that is left has its number. */
void lmb_pack_directory(lmb_packing *packing, uint32_t *directory);

/* The brick of a cell's first point, and the cell's number in it; NULL: there is none. */
const lmb_pack_brick *lmb_pack_brick_of(const lmb_packing *packing, uint32_t level, const int32_t cell[3],
                                        uint32_t *number);

/* A brick's cell that is cut, by its number. */
const lmb_cut_cell *lmb_pack_cut(const lmb_packing *packing, const lmb_pack_brick *brick, int32_t number);

/* Gives corners their light. */
void lmb_pack_corners(lmb_packing *packing);

/* Gives everything its place among the probes of the file, and counts that in the header.
 * @return LMB_ERROR_MEMORY, _ARGUMENT (too many) */
lmb_result lmb_pack_rows(lmb_packing *packing);

#endif
