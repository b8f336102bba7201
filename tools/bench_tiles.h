/* A volume in tiles as a sampler of `lambent bench`. */
#ifndef LMB_TOOLS_BENCH_TILES_H
#define LMB_TOOLS_BENCH_TILES_H

#include <lambent/probes.h>

#include "bench_sampler.h"

/* Fills two samplers of a level's probes in tiles of some 32 cells along each axis, all of them set: by single calls,
 * and by one for all. Their bytes are those of the tiles and the index.
 * @return LMB_ERROR_MEMORY, or what packing, splitting and opening can: then there is none */
lmb_result bench_tiles_create(const lmb_probes *probes, const char *const name[2], lmb_bench_sampler sampler[2]);

#endif
