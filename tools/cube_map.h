/* Environment maps: what is seen around a place, as cubes whose levels are blurred by lobes of rising roughness,
 * divided by the area layer of the place's harmonics. Times the area layer of a surface they are its reflection
 * (docs/sampling.md). */
#ifndef LMB_TOOLS_CUBE_MAP_H
#define LMB_TOOLS_CUBE_MAP_H

#include <lambent/pool.h>
#include <lambent/sh.h>
#include <lambent/transport.h>

enum { CUBE_FACES = 6, CUBE_SIDE = 128, CUBE_LEVELS = 5 };

/* Of the first level; each further one is twice as rough and half as wide. */
#define CUBE_LEAST_ROUGHNESS 0.05f

/* Faces are +X, -X, +Y, -Y, +Z, -Z, and lie as graphics interfaces take them: row 0 is t = 0. */
typedef struct cube_map {
    float *rgb[CUBE_LEVELS]; /* [face][row][column][channel] */
    float side[CUBE_FACES];  /* of a box around the place: the median of how far along a face's axis the surfaces are
                                that face against it, by solid angle; the sky counts for the face it is in */
} cube_map;

static inline int cube_side(int level)
{
    return CUBE_SIDE >> level;
}

float cube_roughness(int level);

/* Unit direction of a place on a face, both coordinates in [0, 1]. */
lmb_vec3 cube_direction(int face, float s, float t);

/* What a map shows in a direction at a roughness: filtered within a face, and between the two levels that are about as
 * rough, of equal steps where roughness doubles. */
lmb_rgb cube_map_look(const cube_map *map, lmb_vec3 direction, float roughness);

/* Index of the texel of a level that a direction goes through, times 3. */
size_t cube_texel(int side, lmb_vec3 direction);

typedef struct cube_place {
    lmb_vec3 position;    /* in the level's scene */
    lmb_sh3_rgb radiance; /* of the probes there, without key lights */
} cube_place;

/* `side` where it is mostly the sky: so many times the farthest other one, and metres at least. */
#define CUBE_SKY_SIDES 1024.0f

/* Traces the first level's texels, `samples` rays each, without the direct light of key lights; then blurs and divides
 * all levels. On failure nothing is to be freed. @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result cube_map_make(const lmb_transport *transport, const cube_place *place, uint32_t samples, lmb_pool *pool,
                         const lmb_progress *progress, cube_map *made);
void cube_map_free(cube_map *freed);

/* Room for all levels. @return false without memory; then, too, it is to be freed */
bool cube_map_allocate(cube_map *map);

#endif
