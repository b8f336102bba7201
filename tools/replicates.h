/* Who takes which replicates of samples (lmb_gather_samples): what one uses must be independent of what another judges
 * by it. Bakes have those below LMB_GATHER_REPLICATES; `probe` stands alone, and its reference counts from 0. */
#ifndef LMB_TOOLS_REPLICATES_H
#define LMB_TOOLS_REPLICATES_H

enum {
    REPLICATES_PROBE = 0,  /* and 15 more */
    REPLICATES_CHECK = 64, /* the first half of its reference; then the second */
    REPLICATES_RENDER = 128
};

#endif
