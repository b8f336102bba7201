/* The solved light on surfaces in a file. Cells and albedos are found anew: they are the level's. */
#ifndef LMB_SURFACE_STORED_H
#define LMB_SURFACE_STORED_H

#include <lambent/surface_solve.h>

#include "base/stored.h"

void lmb_surface_light_write(const lmb_surface_light *light, lmb_stored *stored);

/* What was written of the same transport and settings, bit for bit. Whatever is stored, what is made of it is safe to
 * gather from. @return as lmb_surface_light_solve; LMB_ERROR_FORMAT, _TRUNCATED (it is not of these) */
lmb_result lmb_surface_light_read(const lmb_transport *transport, const lmb_surface_light_settings *settings,
                                  lmb_pool *pool, lmb_stored *stored, lmb_surface_light **light, lmb_error *error);

#endif
