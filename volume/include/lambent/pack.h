/* Packing probes into the run-time file, .lmb (docs/formats.md; opened by lambent/volume.h). */
#ifndef LAMBENT_PACK_H
#define LAMBENT_PACK_H

#include <lambent/probes.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_pack_stats {
    float scale;             /* power of two that radiance was divided by, so that fp16 holds it */
    uint64_t overflow_count; /* coefficients beyond fp16 even so; their whole probe was scaled down, not the one
                                coefficient: clamping a coefficient turns the light */
    uint64_t bytes;
} lmb_pack_stats;

/* The .lmb image of probes, of one level whose lattice is not turned and one set of lights, in malloc'ed memory,
 * 16-byte aligned; the caller frees `*data`. `stats` may be NULL.
 * @return LMB_ERROR_MEMORY, _ARGUMENT (no probes, several levels or sets, a lattice that is turned, a box of too many
 * bricks for the format's directory, non-finite radiance, or key lights without direction or irradiance); then no
 * output is touched */
lmb_result lmb_pack(const lmb_probes *probes, unsigned char **data, size_t *size, lmb_pack_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
