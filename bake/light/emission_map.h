/* How much light leaves each texel of a texture: sums over any rectangle of texels, wrapped as the texture is.
 *
 * A cell is the square that one texel covers. Its weight is the mean over it of emission's luminance times opacity,
 * filtered as lmb_texture_sample does, in proportion to what a white texel gives: 0 only where nothing of the cell
 * gives any. */
#ifndef LMB_EMISSION_MAP_H
#define LMB_EMISSION_MAP_H

#include <lambent/scene.h>

typedef struct lmb_emission_map lmb_emission_map;

/* Which cells give what. */
typedef struct lmb_emission_key {
    int32_t emission; /* image of the emission, or -1: the same all over */
    int32_t alpha;    /* image whose alpha lets light through, or -1: none, or it lies otherwise */
    lmb_wrap wrap_u, wrap_v;
    bool nearest;
    float tint[3];  /* of the emission's channels, the largest 1; coarse, so that few maps do for many materials */
    bool is_masked; /* opaque from an alpha of `cutoff` on; else as opaque as alpha says */
    float cutoff;
} lmb_emission_key;

/* What a material's emission is judged by; false when no texture has a part in it. `*texture` lies as the map does. */
bool lmb_emission_key_of(const lmb_scene *scene, const lmb_material *material, lmb_emission_key *key,
                         const lmb_texture **texture);

bool lmb_emission_key_equal(const lmb_emission_key *a, const lmb_emission_key *b);

/* Takes 8 bytes a texel. @return LMB_ERROR_MEMORY */
lmb_result lmb_emission_map_create(const lmb_scene *scene, const lmb_emission_key *key, lmb_emission_map **map);
void lmb_emission_map_destroy(lmb_emission_map *map);

/* Texels in a row and in a column. */
int32_t lmb_emission_map_size(const lmb_emission_map *map, int axis);

/* Cells first <= x < end of a texture that goes on for ever. */
typedef struct lmb_texel_range {
    int32_t first[2];
    int32_t end[2];
} lmb_texel_range;

/* Sum over the cells, in a unit of its own. */
double lmb_emission_map_sum(const lmb_emission_map *map, const lmb_texel_range *range);

/* Mean weight of the cells, in [0, 1]; exactly 0 where all are dark. Takes the same time for any range. */
double lmb_emission_map_mean(const lmb_emission_map *map, const lmb_texel_range *range);

#endif
