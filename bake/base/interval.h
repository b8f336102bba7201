/* Where a value lies among rising ones. */
#ifndef LMB_INTERVAL_H
#define LMB_INTERVAL_H

#include <stdint.h>

/* The last i < count with bound[i] <= value, or 0: that with bound[i] <= value < bound[i + 1], when value is within the
 * bounds. `bound` rises; 0 < count. */
static inline uint64_t lmb_interval_find(const double *bound, uint64_t count, double value)
{
    uint64_t low = 0, high = count;
    while (high - low > 1) {
        const uint64_t middle = low + (high - low) / 2;
        if (bound[middle] <= value) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

#endif
