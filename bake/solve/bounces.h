/* The bounces E = D + T E: one row of T for each patch that is lit. */
#ifndef LMB_BOUNCES_H
#define LMB_BOUNCES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/pool.h>
#include <lambent/types.h>

/* What one sample of a row's patch sees: part of that row. */
typedef struct lmb_link {
    uint32_t target;    /* row */
    uint16_t weight[3]; /* albedo and tint in 1/65535; 0 when the sample sees nothing that reflects */
    bool open;          /* a ray of the cell's size gets away from the sample's point; nothing to the bounces */
} lmb_link;

/* The largest of its channels. */
static inline uint16_t lmb_link_weight(const lmb_link *link)
{
    const uint16_t larger = link->weight[0] > link->weight[1] ? link->weight[0] : link->weight[1];
    return larger > link->weight[2] ? larger : link->weight[2];
}

/* How many are open. */
static inline uint32_t lmb_links_open(const lmb_link *begin, const lmb_link *end)
{
    uint32_t count = 0;
    for (const lmb_link *link = begin; link < end; ++link) {
        count += link->open;
    }
    return count;
}

typedef struct lmb_bounce_rows {
    uint32_t count;
    const size_t *first;   /* [row] its first link, and the count of all at its end */
    const lmb_link *links; /* those that weigh nothing may be left out */
    const float *samples;  /* [row] how many it has, > 0 */
    lmb_rgb *light;        /* [row] D, which becomes E */
} lmb_bounce_rows;

/* Adds `bounces` bounces to direct light, or all when < 0.
 * @param passes how often T was applied
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_bounces_sum(const lmb_bounce_rows *rows, int bounces, lmb_pool *pool, const lmb_progress *progress,
                           int *passes);

/* Bytes that this takes for a time at most, beside its arguments. */
size_t lmb_bounces_bytes(uint32_t count, size_t links);

#endif
