/* The demo: a house of two floors, and an object to carry through it. */
#ifndef LAMBENT_DEMO_LEVEL_H
#define LAMBENT_DEMO_LEVEL_H

#include <lambent/error.h>
#include <lambent/types.h>

/* The inside of the sealed dark room. */
static const lmb_vec3 lmb_demo_dark_room_min = {7.0f, 0.0f, 0.0f};
static const lmb_vec3 lmb_demo_dark_room_max = {10.0f, 2.8f, 3.0f};

/* Writes the house, 10 x 5.8 x 8 m inside:
 *
 *     ground floor (y 0 to 2.8)                        upper floor (y 3 to 5.8)
 *     x 0        4.4 4.5     7          10
 *       +----------+-+-------+-----------+ z 0        +-----------------------------+
 *       |          | |       | dark room |            |                             |
 *       |          | |     o | (sealed)  |            |                             |
 *       |    lamp  | |       +---red-----+ 3          |==|                          |
 *       |teal      |b|    ^              |            |s |   []         []          | blue
 *       |stairs    |r|    | sun  o       |            |t |                          |
 *       |==|     door                    |            |  |                          |
 *       |  |       |k|                   |            +--+                          |
 *       +----------+-+---------[window]--+ 8          +------------------[window]---+
 *
 * The dark room's inner walls are 5 cm thick and no light gets in. Only the inside of the hull has faces: outside
 * there is nothing to light. Sun 60 lux through the windows, one of them half behind a lattice (alpha MASK); a lamp
 * with radiance 15; a brick wall with a normal map. Path points 0 to 6 run from the window to the lamp, 7 is in the
 * dark room; seeds are in the sunny and in the dark room. Cameras: overview, colour_wall, dark_room, stairs, upper.
 * @return LMB_ERROR_MEMORY, _WRITE */
lmb_result lmb_demo_level_write(const char *path, lmb_error *error);

/* Likewise, with three boxes of probes: of 0.25 m where the lattice throws its shadows, of 1 m on the upper floor, and
 * none in the dark room. */
lmb_result lmb_demo_level_write_with_volumes(const char *path, lmb_error *error);

/* Writes a ball on a foot with a ring around it, 0.4 m high, albedo 0.8, around the origin.
 * @return LMB_ERROR_MEMORY, _WRITE */
lmb_result lmb_demo_object_write(const char *path, lmb_error *error);

#endif
