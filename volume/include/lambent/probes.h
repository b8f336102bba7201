/* Probes while they are being placed, baked, edited or converted.
 *
 * They are flat arrays. Levels, each a lattice of one spacing, turned or not, are indices over them: a level's probes
 * follow each other in the arrays, and it finds the one at any of its points. Nothing is held for points without a
 * probe. Light is one array for each set of lights, in the world's axes, also on a lattice that is turned. Key lights
 * (lambent/key_light.h) are kept apart from it: once, with what is seen of them at each probe. Files hold one level
 * that is not turned, and one set: writers refuse others. */
#ifndef LAMBENT_PROBES_H
#define LAMBENT_PROBES_H

#include <stddef.h>
#include <stdint.h>

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
} lmb_probe_level;

typedef struct lmb_probes {
    int32_t count;
    int32_t (*point)[3];    /* [probe] on its level's lattice */
    float *validity;        /* [probe] share of rays that see no back face: 1 in the open, 0 in a solid. A probe below
                               LMB_PROBES_MIN_VALIDITY was not baked: its radiance is dilated from its neighbours */
    uint32_t set_count;     /* of lights, >= 1 */
    lmb_sh3_rgb **radiance; /* [set][probe] callers fill it. A set's may be NULL while there are no probes */
    uint32_t key_light_count;
    lmb_key_light key_light[LMB_KEY_LIGHTS_MOST];
    float (*key_visibility)[LMB_KEY_LIGHTS_MOST]; /* [probe][light] 0 to 1; 0 beyond the count */
    uint32_t level_count;
    lmb_probe_level *level; /* the finest first */
    lmb_vec3d origin;       /* world position that lmb_probes_position counts from; no file holds it */
} lmb_probes;

#define LMB_PROBES_MIN_VALIDITY 0.5f

/* None yet, of one set of lights. @return LMB_ERROR_MEMORY */
lmb_result lmb_probes_create(lmb_probes **probes);

/* Adds a level with probes at these points of its lattice, each once, with validity 0, zero radiance in every set and
 * no key light seen, in that order. Earlier probes keep what they have; the arrays move.
 * @return LMB_ERROR_ARGUMENT (spacing, box or axes out of range, a point outside of the box or given twice, more than
 * 2^31 - 1 probes), _MEMORY; then nothing has changed */
lmb_result lmb_probes_add_level(lmb_probes *probes, const lmb_lattice *lattice, const int32_t (*point)[3],
                                int32_t count);

/* Adds a set of lights, in which every probe has zero radiance. `*set` is its number: the first is 0, others follow.
 * `radiance` moves, the sets' arrays do not.
 * @return LMB_ERROR_ARGUMENT (2^32 - 1 sets), _MEMORY; then nothing has changed */
lmb_result lmb_probes_add_set(lmb_probes *probes, uint32_t *set);

/* NULL is allowed. */
void lmb_probes_destroy(lmb_probes *probes);

/* The probe at a point of a level's lattice, or -1. */
int32_t lmb_probes_find(const lmb_probes *probes, uint32_t level, int32_t x, int32_t y, int32_t z);

/* The level that a probe belongs to. */
const lmb_probe_level *lmb_probes_level_of(const lmb_probes *probes, int32_t probe);

/* World position of a probe less `origin`, metres: found in double, rounded last. */
lmb_vec3 lmb_probes_position(const lmb_probes *probes, int32_t probe);

/* Metres: a probe speaks for the space within half of that. Its level's spacing. */
float lmb_probes_footprint(const lmb_probes *probes, int32_t probe);

/* Checks every invariant above; finite radiance and sane key lights too. @return LMB_ERROR_FORMAT with the place in
 * `error` */
lmb_result lmb_probes_validate(const lmb_probes *probes, lmb_error *error);

/* Gives every probe with validity below LMB_PROBES_MIN_VALIDITY the mean radiance, and the mean visibility of key
 * lights, of its 26 neighbours on its level that have light (valid, or filled by an earlier pass), nearer ones weighing
 * more, pass after pass until nothing changes, in each set by itself. Probes that no valid one reaches stay dark. The
 * result does not depend on the order of probes.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_probes_dilate(lmb_probes *probes);

#ifdef __cplusplus
}
#endif

#endif
