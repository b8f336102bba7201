/* What the files of volume/ share among themselves. */
#ifndef LAMBENT_VOLUME_INTERNAL_H
#define LAMBENT_VOLUME_INTERNAL_H

#include <stdbool.h>

#include <lambent/half_scale.h>
#include <lambent/probes.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The power of two that radiance is divided by before it is stored as halfs, the same in .vdb and .lmb:
 * lmb_half_scale of the largest coefficient, at most 2^96. */
float lmb_probes_scale(const lmb_probes *probes);

/* Whether they are few enough, each with a unit direction and an irradiance that is finite and not negative. */
bool lmb_probes_key_lights_are_sane(const lmb_probes *probes);

/* Whether ghosts are of points of their levels, and cut cells as lmb_probes_cut takes them. */
bool lmb_probes_cuts_are_sane(const lmb_probes *probes);

/* Of lmb_probes_destroy, lmb_probes_scale: frees local sets; their largest coefficient, without its sign. */
void lmb_probes_free_locals(lmb_probes *probes);
float lmb_probes_locals_largest(const lmb_probes *probes);

/* The block of points 4 at .. 4 at + 3, or NULL. */
const lmb_probe_block *lmb_probe_index_block(const lmb_probe_index *index, const int32_t at[3]);

/* A level's cell for a place in it, `fraction` 0 to 1. @return false: the cell is not there */
bool lmb_probes_cell_at(const lmb_probes *probes, uint32_t level, const int32_t cell[3], const double fraction[3],
                        lmb_probe_cell *found);

/* The same, false also where finer cells stand in for it. */
bool lmb_probes_leaf_at(const lmb_probes *probes, uint32_t level, const int32_t cell[3], const double fraction[3],
                        lmb_probe_cell *found);

/* Whether a probe hangs, if it does, on a level that there is. */
bool lmb_probes_hanging_is_sane(const lmb_probes *probes, int32_t probe);

/* lmb_probes_hang for one level, when the coarser ones have their light. */
void lmb_probes_hang_level(lmb_probes *probes, uint32_t level);

/* Which pass of the dilation fills a probe: `pass[probe]` is 0 for a valid probe, -1 for one that is never reached.
 * `order` lists the reached ones by rising pass, `*reached` says how many. Both arrays hold `count` elements.
 * Ghosts are left out: theirs is -1. */
void lmb_probes_dilation_passes(const lmb_probes *probes, int32_t *pass, int32_t *order, int32_t *reached);

#ifdef __cplusplus
}
#endif

#endif
