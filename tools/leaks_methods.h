/* Ways of interpolating baked probes, as rows of one table. They are there to be measured: what runs in a game is
 * sampler/'s. */
#ifndef LMB_TOOLS_LEAKS_METHODS_H
#define LMB_TOOLS_LEAKS_METHODS_H

#include "leaks_field.h"

typedef struct leaks_method {
    const char *name;
    const char *about;
    /* Makes `*state` from a field, which outlives it; `*bytes` is what a game would hold of it, probes among it.
     * @return LMB_ERROR_MEMORY, and what phases of a bake return; then there is no state */
    lmb_result (*prepare)(const leaks_field *field, void **state, size_t *bytes);
    /* The light at a position. `normal` is that of the surface that is lit there, or NULL: of nothing. */
    void (*sample)(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance);
    void (*release)(void *state); /* NULL: nothing to release */
} leaks_method;

/* Trilinear in the packed volume, without regions: what was not baked is dilated. */
extern const leaks_method leaks_trilinear;

/* Corners count where they are seen from, by rays at every sample. */
extern const leaks_method leaks_masked_exact;

/* Corners count where they are seen from, as rays to each eighth of a cell have found before: 64 bits a cell. */
extern const leaks_method leaks_masked;

/* DDGI's: how far each probe sees in each direction says how likely it sees a point (Majercik et al. 2019, "Dynamic
 * Diffuse Global Illumination with Ray-Traced Irradiance Fields"). */
extern const leaks_method leaks_chebyshev;

/* What the product bakes: cells that geometry cuts have eight corners for each of their regions of free space. */
extern const leaks_method leaks_regions;

/* Likewise, and levels where light changes fast, down to an eighth of the field's spacing, or an eighth of a metre. */
extern const leaks_method leaks_levels;

/* All of them; `*count`. */
const leaks_method *const *leaks_methods(size_t *count);

/* NULL: there is none of that name. */
const leaks_method *leaks_method_find(const char *name);

#endif
