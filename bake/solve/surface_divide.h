/* Cells that something stands on are divided into pieces. */
#ifndef LMB_SURFACE_DIVIDE_H
#define LMB_SURFACE_DIVIDE_H

#include <lambent/transport.h>

#include "surface/surface_light_internal.h"

/* Finds the sides that something stands on, and their pieces. Adds to `*rays`. */
lmb_result lmb_surface_light_divide(lmb_surface_light *light, const lmb_transport *transport, lmb_pool *pool,
                                    uint64_t *rays);

#endif
