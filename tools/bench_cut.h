/* A volume in which every cell is cut, for `lambent bench`. */
#ifndef LMB_TOOLS_BENCH_CUT_H
#define LMB_TOOLS_BENCH_CUT_H

#include <lambent/probes.h>

/* Makes probes of the finest level of others, with whole cells cut by two planes into three regions. A region has the
 * probes at the corners that lie in it, and ghosts, one for each point, at the others. Ghosts have the light of the
 * probes at their points, so that light is everywhere what it was.
 * @return NULL when out of memory */
lmb_probes *bench_cut_probes(const lmb_probes *probes);

#endif
