/* Running a bake from a level in memory to files in a folder. */
#ifndef LMB_TOOLS_BAKE_RUN_H
#define LMB_TOOLS_BAKE_RUN_H

#include "bake_phases.h"

/* Places, bakes and writes; prints what it found unless quiet. */
lmb_result bake_run(const lmb_bake_settings *settings, lmb_level *level, const lmb_progress *progress,
                    lmb_error *error);

#endif
