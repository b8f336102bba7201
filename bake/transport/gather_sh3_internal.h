/* Gathering SH3 moments in several goes. */
#ifndef LMB_GATHER_SH3_INTERNAL_H
#define LMB_GATHER_SH3_INTERNAL_H

#include <lambent/gather_sh3.h>

/* What an element's samples have found. */
typedef struct lmb_sh3_sums {
    double replicate[LMB_GATHER_REPLICATES][3][LMB_SH3_COUNT];  /* of polynomials, summed over samples */
    double first_half[LMB_GATHER_REPLICATES][3][LMB_SH3_COUNT]; /* of them, those that start at the first half of the
                                                                   points */
    double steady[LMB_GATHER_REPLICATES][3][LMB_SH3_COUNT];     /* of them, what is steady (lmb_contributions) */
    uint32_t points;
    bool without_punctual; /* they left out punctual lights, which are known */
    double punctual[3][LMB_SH3_COUNT];
    float key_visibility[LMB_KEY_LIGHTS_MOST];
    lmb_sh3_rgb keys; /* moments of what is seen of key lights */
    uint32_t taken;   /* by each replicate */
    uint64_t rays;
} lmb_sh3_sums;

/* The first samples, `count` of each replicate. */
void lmb_sh3_sums_begin(const lmb_transport *transport, const lmb_gather_point *points, uint32_t point_count,
                        uint32_t count, lmb_sh3_sums *sums);

/* The samples after those, up to `count` of each replicate, at the same points. */
void lmb_sh3_sums_continue(const lmb_transport *transport, const lmb_gather_point *points, uint32_t count,
                           lmb_sh3_sums *sums);

/* Mean of the replicates, and the standard error of that mean from their spread. */
void lmb_sh3_sums_combine(const lmb_sh3_sums *sums, lmb_gathered *gathered);

/* Samples of each replicate for at least so many in all, rounded up to a multiple. */
uint32_t lmb_replicate_share(uint32_t samples, uint32_t multiple);

#endif
