/* Running a bake from a level in memory to files in a folder. */
#ifndef LMB_TOOLS_BAKE_RUN_H
#define LMB_TOOLS_BAKE_RUN_H

#include "bake_phases.h"
#include "forecast.h"
#include "output_folder.h"

/* Places, bakes and writes into `folder` (NULL for a dry run); says what it found, unless quiet or as a record.
 * `*forecast` is kept up to date for what reports progress. */
lmb_result bake_run(const lmb_bake_settings *settings, lmb_level *level, lmb_output_folder *folder,
                    const lmb_progress *progress, lmb_forecast *forecast, lmb_error *error);

#endif
