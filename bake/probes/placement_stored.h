/* Placed probes and their regions, still dark, in a file. */
#ifndef LMB_PLACEMENT_STORED_H
#define LMB_PLACEMENT_STORED_H

#include <lambent/regions.h>

#include "base/stored.h"

/* As lmb_placement_make or _levels and lmb_regions_make left them: no light, no local sets. */
void lmb_placement_write(const lmb_probes *probes, const lmb_regions *regions, lmb_stored *stored);

/* The same again, as of a scene of that origin. Whatever is stored, what is made of it keeps every invariant.
 * @return LMB_ERROR_MEMORY, _FORMAT, _TRUNCATED; then nothing is set */
lmb_result lmb_placement_read(lmb_stored *stored, lmb_vec3d origin, lmb_probes **probes, lmb_regions **regions);

#endif
