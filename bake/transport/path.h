/* Whole paths. */
#ifndef LMB_PATH_H
#define LMB_PATH_H

#include "transport/segment.h"

/* Radiance along a segment from its vertex on: what it ends on emits, and what that reflects. `path` is at its first
 * vertex. */
lmb_rgb lmb_path_radiance(lmb_path *path, lmb_segment segment, lmb_path_vertex vertex);

#endif
