/* Small levels whose light is known or easy to reason about, written as .glb. All are in metres, +Y up.
 * @return of each: LMB_ERROR_MEMORY, _WRITE */
#ifndef LAMBENT_LEVELS_H
#define LAMBENT_LEVELS_H

#include <stdbool.h>

#include <lambent/error.h>
#include <lambent/types.h>

/* A closed cube around the origin that looks inward; every face reflects `albedo` and emits `emission`. Radiance is
 * emission / (1 - albedo) everywhere inside. 12 triangles. */
lmb_result lmb_level_furnace(const char *path, float size_m, float albedo, lmb_rgb emission, bool double_sided,
                             lmb_error *error);

/* A grey square on y = 0 around the origin that looks up. No light. 2 triangles. */
lmb_result lmb_level_open_ground(const char *path, float size_m, float albedo, lmb_error *error);

/* The box of x, z in [-1, 1], y in [0, 2], open towards +Z: red at -X, green at +X, else white; a lamp of 0.5 m and
 * radiance 15 under the ceiling, a tall and a short block. 34 + 2 triangles. */
lmb_result lmb_level_cornell(const char *path, lmb_error *error);

typedef struct lmb_two_rooms {
    float wall_m; /* thickness of the wall between the rooms, which stands on x = 0 */
    float door_m; /* width of a doorway in it, 2 m high, in the middle of z; 0: none, the rooms are sealed */
    float albedo;
    float red_radiance;   /* of the lamp at -X; 0 leaves it dark */
    float green_radiance; /* of the lamp at +X */
} lmb_two_rooms;

/* A wall of 0.1 m, no doorway, albedo 0.5, radiance 10 and 10. */
lmb_two_rooms lmb_two_rooms_default(void);

/* Two rooms of 4 x 3 x 4 m (y from 0, z in [-2, 2]) on either side of a wall, in a hull of 0.3 m; under each ceiling
 * a box lamp of 0.6 x 0.1 x 0.6 m around (+-(wall_m / 2 + 2), 2.5, 0) that emits red or green. Sealed: 12 + 24
 * triangles of hull and 24 of lamps. */
lmb_result lmb_level_two_rooms(const char *path, const lmb_two_rooms *rooms, lmb_error *error);

/* A sphere around the origin that looks inward, as 12 * divisions^2 triangles, with a white point light of
 * `intensity_cd` in its middle. */
lmb_result lmb_level_sphere_room(const char *path, float radius_m, int divisions, float albedo, float intensity_cd,
                                 lmb_error *error);

/* A square on y = height_m that emits downward with `radiance`, 1 m wide, over a floor of 10 m on y = 0 with albedo
 * 0.5. The lamp itself reflects nothing. 4 triangles. */
lmb_result lmb_level_quad_light(const char *path, float height_m, float radiance, lmb_error *error);

/* The ground of lmb_level_open_ground (20 m) under a white directional light of `lux` that travels along `direction`
 * (any length but 0). */
lmb_result lmb_level_sun_plane(const char *path, float albedo, lmb_vec3 direction, float lux, lmb_error *error);

#endif
