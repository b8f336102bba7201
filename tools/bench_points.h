/* Where `lambent bench` samples a volume: in cells whose eight corners are probes that were baked. */
#ifndef LMB_TOOLS_BENCH_POINTS_H
#define LMB_TOOLS_BENCH_POINTS_H

#include <lambent/probes.h>

/* Coherent: along straight lines, in steps of a tenth of a cell. Random: each by itself, all over the volume. */
typedef enum lmb_bench_pattern { BENCH_COHERENT, BENCH_RANDOM, BENCH_PATTERNS } lmb_bench_pattern;
const char *bench_pattern_name(lmb_bench_pattern pattern);

/* Fills positions in the world, metres; the same ones each time.
 * @return LMB_ERROR_MEMORY, _FORMAT (there is no such cell) */
lmb_result bench_points_fill(const lmb_probes *probes, lmb_bench_pattern pattern, size_t count, lmb_vec3 *position);

/* The light there by the definition: eight probes weighted in double. */
void bench_points_truth(const lmb_probes *probes, lmb_vec3 position, double light[27]);

#endif
