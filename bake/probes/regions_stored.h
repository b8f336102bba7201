/* Regions in a file, as the part of a placement that they are. */
#ifndef LMB_REGIONS_STORED_H
#define LMB_REGIONS_STORED_H

#include <lambent/regions.h>

#include "base/stored.h"

/* `probes`: how many there are, with ghosts. */
void lmb_regions_write(const lmb_regions *regions, int32_t probes, lmb_stored *stored);

/* NULL, and `stored` says why, where they name what is not there. */
lmb_regions *lmb_regions_read(lmb_stored *stored, int32_t probes);

#endif
