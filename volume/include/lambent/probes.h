/* Probes while they are being placed, baked, edited or converted.
 *
 * They are flat arrays. Levels, each a lattice of one spacing, turned or not, are indices over them: a level's probes
 * follow each other in the arrays, and it finds the one at any of its points. Nothing is held for points without a
 * probe. Light is one array for each set of lights, in the world's axes, also on a lattice that is turned. Key lights
 * (lambent/key_light.h) are kept apart from it: once, with what is seen of them at each probe.
 *
 * Light is interpolated in the finest level's cell that is there: one whose eight corners hold probes, or one that is
 * cut. Levels give way to finer ones by cubes of 2 x 2 x 2 cells, the first at even points: where a finer level has a
 * cell, the whole cube around it is the finer level's, 4 x 4 x 4 of its cells or what of them is there. The cells that
 * light is interpolated in are leaves. A probe of a finer level on a coarser level's leaf, on its faces, edges and
 * corners too, *hangs* on it, unless a wall is between: it has that leaf's interpolation, and no light of its own. Cut
 * cells (lambent/cell.h) have eight probes for each region of theirs: those at their corners, or ghosts, which stand
 * for a corner as a region that does not hold it needs it. Ghosts follow the levels' probes in the arrays.
 *
 * Beside all that, objects may have local sets (lambent/probe_local.h): few probes each, in arrays of their own. */
#ifndef LAMBENT_PROBES_H
#define LAMBENT_PROBES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/cell.h>
#include <lambent/error.h>
#include <lambent/key_light.h>
#include <lambent/lattice.h>
#include <lambent/sh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Finds things by their points on a lattice, probes above all: a hash table of blocks of 4 x 4 x 4 points. Zeroed, it
 * is empty. */
enum { LMB_PROBE_BLOCK = 4, LMB_PROBE_BLOCK_POINTS = 64 };
typedef struct lmb_probe_block {
    int32_t at[3];                         /* its points are 4 at .. 4 at + 3 */
    int32_t probe[LMB_PROBE_BLOCK_POINTS]; /* [x + 4 (y + 4 z)] its index, or -1 */
} lmb_probe_block;

typedef struct lmb_probe_index {
    uint32_t block_count;
    lmb_probe_block *block;
    uint32_t slot_count; /* a power of two */
    uint32_t *slot;      /* [hash of a block] its index + 1, or 0 */
} lmb_probe_index;

/* Gives a point an index >= 0. @return LMB_ERROR_ARGUMENT (it has one), _MEMORY; then nothing has changed */
lmb_result lmb_probe_index_add(lmb_probe_index *index, const int32_t point[3], int32_t probe);

/* The index of a point, or -1. */
int32_t lmb_probe_index_find(const lmb_probe_index *index, const int32_t point[3]);

/* Frees what it holds and empties it. */
void lmb_probe_index_free(lmb_probe_index *index);

typedef struct lmb_probe_level {
    lmb_lattice lattice;
    int32_t first, count; /* of its probes */
    lmb_probe_index index;
    int32_t ghost_first, ghost_count;
    lmb_probe_index cut; /* its cut cells, by their first points */
} lmb_probe_level;

typedef struct lmb_cut_cell {
    int32_t point[3]; /* its first, on its level's lattice */
    uint32_t level;
    uint32_t plane_first, plane_count;
    uint32_t region_first, region_count; /* >= 1 */
} lmb_cut_cell;

typedef struct lmb_cut_cells {
    uint32_t count, plane_count, region_count;
    lmb_cut_cell *cell;
    lmb_cell_plane *plane;
    int32_t (*corner)[8]; /* [region][corner, bit 0 is x, 1 is y, 2 is z] the probe: its level's at that point, or a
                             ghost of that point */
} lmb_cut_cells;

typedef struct lmb_probes {
    int32_t count;
    int32_t (*point)[3];    /* [probe] on its level's lattice */
    float *validity;        /* [probe] share of rays that see no back face: 1 in the open, 0 in a solid. A probe below
                               LMB_PROBES_MIN_VALIDITY was not baked: its radiance is dilated from its neighbours */
    uint8_t *hanging;       /* [probe] 0, or on which leaf it hangs, as lmb_probes_find_hanging has it */
    uint32_t set_count;     /* of lights, >= 1 */
    lmb_sh3_rgb **radiance; /* [set][probe] callers fill it. A set's may be NULL while there are no probes */
    uint32_t key_light_count;
    lmb_key_light key_light[LMB_KEY_LIGHTS_MOST];
    float (*key_visibility)[LMB_KEY_LIGHTS_MOST]; /* [probe][light] 0 to 1; 0 beyond the count */
    uint32_t level_count;
    lmb_probe_level *level; /* the finest first, each next one of twice the spacing */
    int32_t ghost_count;    /* the last ones of all */
    lmb_cut_cells cut;
    uint32_t local_count;
    struct lmb_probe_local *local; /* local sets */
    lmb_vec3d origin;              /* world position that lmb_probes_position counts from; no file holds it */
} lmb_probes;

#define LMB_PROBES_MIN_VALIDITY 0.5f

/* None yet, of one set of lights. @return LMB_ERROR_MEMORY */
lmb_result lmb_probes_create(lmb_probes **probes);

/* Adds a level with probes at these points of its lattice, each once, with validity 0, zero radiance in every set and
 * no key light seen, in that order. Earlier probes keep what they have; the arrays move.
 * @return LMB_ERROR_ARGUMENT (spacing, box or axes out of range, a point outside of the box or given twice, more than
 * 2^31 - 1 probes, or there are ghosts), _MEMORY; then nothing has changed */
lmb_result lmb_probes_add_level(lmb_probes *probes, const lmb_lattice *lattice, const int32_t (*point)[3],
                                int32_t count);

/* Adds ghosts of these points of a level, in that order, dark as a level's probes are: once for each level, after all
 * levels were added. `*first` is the first one's index.
 * @return LMB_ERROR_ARGUMENT (a point outside of the level's box, or it has ghosts), _MEMORY; then nothing has changed
 */
lmb_result lmb_probes_add_ghosts(lmb_probes *probes, uint32_t level, const int32_t (*point)[3], int32_t count,
                                 int32_t *first);

/* Cuts a cell of a level. `plane` may be NULL where there are none: then there is one region.
 * @return LMB_ERROR_ARGUMENT (it is cut already, or not of the level's box; a plane leads backwards or nowhere; a
 * corner is neither the probe of that point nor a ghost of it), _MEMORY; then nothing has changed */
lmb_result lmb_probes_cut(lmb_probes *probes, uint32_t level, const int32_t point[3], const lmb_cell_plane *plane,
                          uint32_t plane_count, const int32_t (*corner)[8], uint32_t region_count);

/* Adds a set of lights, in which every probe has zero radiance. `*set` is its number: the first is 0, others follow.
 * `radiance` moves, the sets' arrays do not.
 * @return LMB_ERROR_ARGUMENT (2^32 - 1 sets), _MEMORY; then nothing has changed */
lmb_result lmb_probes_add_set(lmb_probes *probes, uint32_t *set);

/* NULL is allowed. */
void lmb_probes_destroy(lmb_probes *probes);

/* The probe at a point of a level's lattice, or -1. */
int32_t lmb_probes_find(const lmb_probes *probes, uint32_t level, int32_t x, int32_t y, int32_t z);

/* The cell that light at a place is interpolated in. In a wedge (lambent/cell.h) the place is in two regions. */
typedef struct lmb_probe_cell {
    uint32_t level;
    int32_t point[3];   /* its first, on the level's lattice */
    int32_t cut;        /* its number among cut cells, or -1: a plain one */
    uint32_t region;    /* of a cut cell, that the place is in, the one that weighs most; else 0 */
    int32_t probe[8];   /* [corner, bit 0 is x, 1 is y, 2 is z] of that region */
    int32_t other[8];   /* of the other region of a wedge; else the same */
    double share;       /* of the other one's light, 0 to 0.5; 0 but in wedges */
    double fraction[3]; /* where in the cell, 0 to 1 along each axis */
} lmb_probe_cell;

/* @return false, and nothing is set, where no level has a cell */
bool lmb_probes_cell(const lmb_probes *probes, lmb_vec3d position, lmb_probe_cell *cell);

/* The eight probes around a place in its cell, of the region that weighs most, and where in it that is, 0 to 1 along
 * each axis.
 * @return false, and nothing is set, where no level has a cell */
bool lmb_probes_around(const lmb_probes *probes, lmb_vec3d position, int32_t probe[8], double fraction[3]);

/* The light at a place, by trilinear weights, in a wedge of both regions by their shares: what a file packed of these
 * probes gives, up to rounding. All zero where there is no cell. */
lmb_sh3_rgb lmb_probes_light(const lmb_probes *probes, uint32_t set, lmb_vec3d position);

/* The level that a probe, or a ghost, belongs to. */
const lmb_probe_level *lmb_probes_level_of(const lmb_probes *probes, int32_t probe);

/* World position of a probe less `origin`, metres: found in double, rounded last. */
lmb_vec3 lmb_probes_position(const lmb_probes *probes, int32_t probe);

/* Metres: a probe speaks for the space within half of that. Its level's spacing. */
float lmb_probes_footprint(const lmb_probes *probes, int32_t probe);

/* Checks every invariant above; finite radiance and sane key lights too. @return LMB_ERROR_FORMAT with the place in
 * `error` */
lmb_result lmb_probes_validate(const lmb_probes *probes, lmb_error *error);

/* Whether the place of a level's cell is the level's, wherever it has cells: coarser levels give way there, and no
 * finer one's cell is in its cube of 2 x 2 x 2. What no level has cells near is the coarsest's. */
bool lmb_probes_level_has(const lmb_probes *probes, uint32_t level, const int32_t cell[3]);

/* Whether light is interpolated in a level's cell: it is there, and no finer cell is in its cube of 2 x 2 x 2. */
bool lmb_probes_cell_is_leaf(const lmb_probes *probes, uint32_t level, const int32_t cell[3]);

/* What a hanging probe's light is made of. */
typedef struct lmb_probe_parents {
    uint32_t count; /* 8; 16 in a wedge */
    int32_t probe[16];
    double weight[16]; /* sum 1 */
} lmb_probe_parents;

/* Whether a probe sees a world place a little within a leaf that it lies on. */
typedef bool (*lmb_probe_sees)(void *context, int32_t probe, lmb_vec3d place);

/* Finds, of probes `first` on, which of them hang, for as long as neither levels nor cuts change: on the coarsest leaf
 * that one touches and sees. `sees` NULL: walls are none. Ghosts do not hang. Until then no probe does. Other threads
 * may do the same for other probes. */
void lmb_probes_find_hanging(lmb_probes *probes, int32_t first, int32_t count, lmb_probe_sees sees, void *context);

/* Whether a probe hangs; sets `*parents` then. */
bool lmb_probes_hangs(const lmb_probes *probes, int32_t probe, lmb_probe_parents *parents);

/* Gives all hanging probes their light in every set, and what is seen of key lights, coarse levels first. */
void lmb_probes_hang(lmb_probes *probes);

/* Takes all light out of them, as they were placed; local sets too, which are no more. */
void lmb_probes_clear_light(lmb_probes *probes);

/* Gives every probe with validity below LMB_PROBES_MIN_VALIDITY the mean radiance, and the mean visibility of key
 * lights, of its 26 neighbours on its level that have light (valid, or filled by an earlier pass), nearer ones weighing
 * more, pass after pass until nothing changes, in each set by itself. Probes that no valid one reaches stay dark.
 * Hanging probes get their light as lmb_probes_hang gives it, and hand it on as valid ones do. The result does not
 * depend on the order of probes.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_probes_dilate(lmb_probes *probes);

#ifdef __cplusplus
}
#endif

#endif
