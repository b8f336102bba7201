/* The rows of E = D + T E by samples: what each patch receives directly, and what it sees. */
#ifndef LMB_LIGHT_ROWS_H
#define LMB_LIGHT_ROWS_H

#include <lambent/transport.h>

#include "solve/bounces.h"
#include "surface/surface_light_internal.h"

enum {
    /* Of a side of a cell about as large as cells can be: by lambent_convergence, `cells`. */
    LMB_ROWS_SAMPLES = 8,
    /* The first samples of a patch, to learn whether any light can reach it. One that sees only dark ones by all of
     * them, as insides of solids do, gets no more and stays dark. */
    LMB_ROWS_PILOT_SAMPLES = 4,
    /* At least, of a side whose cell is less than half as long as cells can be. Long thin ones get the pilot's: they
     * lie in gaps, where few samples may all see each other's cells, which then never let go of the light. */
    LMB_ROWS_SMALL_SAMPLES = 2
};

typedef struct lmb_light_rows {
    const lmb_transport *transport;
    lmb_surface_light *light;
    uint32_t patch_count;
    uint32_t *cell_samples; /* [cell] that each of its sides is to get, if it is lit */
    lmb_rgb *direct;        /* [patch] sum over its samples */
    lmb_rgb *open_direct;   /* [patch] over those that are open */
    lmb_rgb *sun;           /* [patch] sum of what directional lights give */
    float *sun_least;       /* [patch] the least luminance of it in a sample */
    size_t *row;            /* [patch] its first link, and the count at its end; a row is as long as it has samples */
    lmb_link *links;        /* their targets are patches */
    uint64_t rays;
    uint32_t lit_patches;
    size_t most_bytes;
} lmb_light_rows;

/* Takes all samples of a light whose sides have been divided. `samples` are for a side of a cell about as large as
 * cells can be. */
lmb_result lmb_light_rows_sample(lmb_light_rows *rows, uint32_t samples, lmb_pool *pool, const lmb_progress *progress);

/* Frees what the rows own. */
void lmb_light_rows_free(lmb_light_rows *rows);

/* Notes the bytes that are in use with so many links, and so many others. */
void lmb_light_rows_count_bytes(lmb_light_rows *rows, size_t links, size_t others);

#endif
