/* A made-up volume to measure the sampler on, without a bake. */
#ifndef LMB_TOOLS_HOUSE_H
#define LMB_TOOLS_HOUSE_H

#include <lambent/probes.h>

/* Probes at the points that a house with a missing wing leaves free, 0.25 m apart: storeys of rooms between slabs and
 * walls one point thick, with doors in the walls. The light is smooth within a room, of another colour in each. It is
 * the smallest such house, twice as wide and as deep as high, that has as many as `wanted`, 1 to 1e8.
 * @return NULL when out of memory */
lmb_probes *house_probes(double wanted);

#endif
