/* Packing probes into the run-time file, .lmb (docs/formats.md; opened by lambent/volume.h). */
#ifndef LAMBENT_PACK_H
#define LAMBENT_PACK_H

#include <lambent/probes.h>
#include <lambent/volume_format.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_pack_stats {
    float scale;             /* power of two that radiance was divided by, so that fp16 holds it */
    uint64_t overflow_count; /* coefficients beyond fp16 even so; their whole probe was scaled down, not the one
                                coefficient: clamping a coefficient turns the light */
    uint64_t bytes;
    uint64_t flattened_count; /* colours of compact probes whose harmonics are more than light that is nowhere negative
                                 has over their mean: all eight were made less alike */
} lmb_pack_stats;

/* The .lmb image of probes, of levels whose lattices are not turned, each with twice the spacing of the one before, and
 * of one set of lights, in malloc'ed memory, 16-byte aligned; the caller frees `*data`. A cell is stored where it is
 * cut, where its eight corners hold probes with light, and where one of them was baked: then the others get light here.
 * Each 4 x 4 x 4 cells of the finest level that begin at multiples of 4 are the finest level's that has a cell there.
 * `stats` may be NULL.
 * @return LMB_ERROR_MEMORY, _ARGUMENT (no probes, several sets, levels that are turned or of other spacings, a box of
 * too many blocks for the format's directory or farther than 2^31 - 2^17 spacings away, non-finite radiance, key lights
 * without direction or irradiance, or no cell has light); then no output is touched */
lmb_result lmb_pack(const lmb_probes *probes, unsigned char **data, size_t *size, lmb_pack_stats *stats);

/* The same in another form of probes: LMB_VOLUME_HALFS, as above, or LMB_VOLUME_COMPACT, of little more than half the
 * size. */
lmb_result lmb_pack_as(lmb_volume_form form, const lmb_probes *probes, unsigned char **data, size_t *size,
                       lmb_pack_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
