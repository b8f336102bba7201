/* The library's own volumes in other forms, for `lambent bench`: compact, and with every cell cut. */
#ifndef LMB_TOOLS_BENCH_FORMS_H
#define LMB_TOOLS_BENCH_FORMS_H

#include <lambent/probes.h>

#include "bench_sampler.h"

enum { BENCH_FORMS = 4 };

/* Of an lmb_volume, by single calls and by one for all. */
void bench_sample_single(const void *volume, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance);
void bench_sample_batch(const void *volume, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance);

/* Fills the samplers `lambent.compact`, `lambent.compact.batch`, `lambent.cut` and `lambent.cut.batch` from one level's
 * probes, whose whole cells are cut from then on: by two planes, into three regions, all of which have the cell's own
 * corners, so that light stays what it was.
 * @return LMB_ERROR_MEMORY, or what packing and opening can: then there is none */
lmb_result bench_forms_create(lmb_probes *probes, lmb_bench_sampler sampler[BENCH_FORMS]);

#endif
