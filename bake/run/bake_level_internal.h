#ifndef LMB_BAKE_LEVEL_INTERNAL_H
#define LMB_BAKE_LEVEL_INTERNAL_H

#include <lambent/bake_level.h>

#include "base/stored.h"

/* How the level's file is read. Points into `settings`; `warnings` may be NULL. */
lmb_gltf_options lmb_level_gltf_options(const lmb_level_settings *settings, const lmb_warnings *warnings);

/* Lets the level gather from solved light, which becomes its own. */
void lmb_level_take_surface(lmb_level *level, lmb_surface_light *surface);

/* Solved light, or that there is none. Reading takes the place of lmb_level_solve.
 * @return LMB_ERROR_FORMAT, _TRUNCATED (it is not of this level), _MEMORY */
void lmb_level_write_surface(const lmb_level *level, lmb_stored *stored);
lmb_result lmb_level_read_surface(lmb_level *level, lmb_stored *stored, lmb_error *error);

#endif
