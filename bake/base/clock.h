#ifndef LMB_CLOCK_H
#define LMB_CLOCK_H

/* Wall-clock seconds of a monotonic clock. */
double lmb_clock_seconds(void);

#endif
