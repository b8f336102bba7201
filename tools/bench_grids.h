/* Volumes in OpenVDB's and NanoVDB's grids, nine of three channels each, with the libraries' own trilinear samplers. */
#ifndef LMB_TOOLS_BENCH_GRIDS_H
#define LMB_TOOLS_BENCH_GRIDS_H

#include <lambent/probes.h>

#include "bench_sampler.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { BENCH_GRID_SAMPLERS = 2 };

/* Fills the samplers `openvdb` and, where the build found its headers, `nanovdb` from one level's probes.
 * @return how many there are; 0 when out of memory, or where a library fails */
int bench_grids_create(const lmb_probes *probes, lmb_bench_sampler sampler[BENCH_GRID_SAMPLERS]);

#ifdef __cplusplus
}
#endif

#endif
