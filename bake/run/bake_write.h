/* The files of a bake that is done. */
#ifndef LMB_BAKE_WRITE_H
#define LMB_BAKE_WRITE_H

#include <lambent/bake_phases.h>

#include "run/bake_folder_internal.h"

/* Writes all beside what is in the folder, then lets it take its place. Completes the record, which bake.json gets.
 * @return LMB_ERROR_WRITE, _MEMORY, _INTERRUPTED: then the folder is as it was */
lmb_result lmb_bake_write(lmb_bake *bake, lmb_bake_folder *folder, lmb_error *error);

#endif
