/* The rows that light goes round in. */
#ifndef LMB_BOUNCE_CORE_H
#define LMB_BOUNCE_CORE_H

#include "solve/bounces.h"

/* As a pass wants it: weights as numbers of 1/65535. */
typedef struct lmb_core_link {
    uint32_t target; /* core row */
    float weight[3];
} lmb_core_link;

/* Rows that nobody sees but those of which the same is true take light and give none: there are as many of these as of
 * others, since small patches are seldom hit. Passes do without them, and their light follows from the others'. */
typedef struct lmb_bounce_core {
    uint32_t count;
    size_t *first; /* [core row] its first link, and the count of all at its end */
    lmb_core_link *links;
    float *samples;  /* [core row] */
    lmb_rgb *direct; /* [core row] */
    uint32_t *order; /* rows: those of the core, then the rest, each after all that it sees */
} lmb_bounce_core;

/* `all`: the core has all rows. @return LMB_ERROR_MEMORY; then, too, lmb_bounce_core_free is to be called */
lmb_result lmb_bounce_core_make(const lmb_bounce_rows *rows, bool all, lmb_bounce_core *core);
void lmb_bounce_core_free(lmb_bounce_core *core);

/* Sets the rows' light by that of the core, [core row]. */
void lmb_bounce_core_spread(const lmb_bounce_core *core, const lmb_bounce_rows *rows, const lmb_rgb *light);

/* Bytes that a core takes at most. */
size_t lmb_bounce_core_bytes(uint32_t rows, size_t links);

#endif
