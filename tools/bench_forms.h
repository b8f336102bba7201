/* The library's own volumes as samplers of `lambent bench`. */
#ifndef LMB_TOOLS_BENCH_FORMS_H
#define LMB_TOOLS_BENCH_FORMS_H

#include <lambent/probes.h>
#include <lambent/volume_format.h>

#include "bench_sampler.h"

/* Of an lmb_volume, by single calls and by one for all. */
void bench_sample_single(const void *volume, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance);
void bench_sample_batch(const void *volume, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance);

/* Fills two samplers of a level's probes as a volume: by single calls, and by one for all.
 * @return LMB_ERROR_MEMORY, or what packing and opening can: then there is none */
lmb_result bench_form_create(const lmb_probes *probes, lmb_volume_form form, const char *const name[2],
                             lmb_bench_sampler sampler[2]);

#endif
