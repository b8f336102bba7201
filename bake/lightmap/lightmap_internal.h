/* What the lightmap's files share: texel grids, and which texels a mesh covers. */
#ifndef LMB_LIGHTMAP_INTERNAL_H
#define LMB_LIGHTMAP_INTERNAL_H

#include <lambent/lightmap.h>

#include "lightmap/uv_islands.h"

/* A region's texels in UV space: UV (u, v) is at ((u, v) density - (shift_x, shift_y)) texels from the region's corner.
 * Whole numbers, so that texel centres of charts stay texel centres of the image. */
typedef struct lmb_texel_grid {
    int32_t density; /* texels for one unit of UV */
    int32_t shift_x, shift_y;
    int32_t width, height;
} lmb_texel_grid;

/* The surface point that stands for a texel. */
typedef struct lmb_texel_source {
    uint32_t triangle; /* LMB_TEXEL_UNCOVERED: no triangle touches the texel */
    float u, v;        /* barycentric weights of the second and third corner */
    float distance;    /* from the texel's centre, in texels */
} lmb_texel_source;

#define LMB_TEXEL_UNCOVERED UINT32_MAX

/* Finds for each of the grid's texels (source[x + width y]) the point of the triangles that touch it that is nearest to
 * its centre. Points are kept a little inside their triangle, where rounding cannot put them behind the surface that
 * meets it at its edge. `corner_uv` NULL: the mesh's TEXCOORD_1. */
void lmb_texels_cover(const lmb_mesh *mesh, const lmb_vec2 *corner_uv, const lmb_texel_grid *grid,
                      lmb_texel_source *source);

/* What a triangle covers of the texel at (x, y). */
typedef struct lmb_texel_spread {
    const lmb_mesh *mesh;
    const lmb_vec2 *corner_uv; /* as above */
    const lmb_texel_grid *grid;
    int32_t x, y;
    uint32_t triangle;
} lmb_texel_spread;

/* Points that are spread evenly over that, as barycentric weights of the second and third corner. Returns how many it
 * has written: `count`, or 0 where rounding leaves nothing covered. The same `stream` gives the same points. `count` <=
 * LMB_RAY_BATCH. */
uint32_t lmb_texel_spread_points(const lmb_texel_spread *spread, uint64_t stream, uint32_t count, float (*weights)[2]);

/* A point of a triangle in texels, with its barycentric weights. */
typedef struct lmb_texel_vertex {
    double x, y;
    double u, v;
} lmb_texel_vertex;

/* A triangle cut by four lines has 7 corners, or 13 if rounding has bent every cut polygon to a zigzag. */
enum { LMB_TEXEL_PIECE_MAX = 13 };

/* What a triangle covers of the square between the centres of four texels, (x, y) to (x + 1, y + 1): a convex polygon
 * over which bilinear filtering reads these four. Its vertices are relative to the first centre. */
typedef struct lmb_texel_piece {
    int32_t x, y; /* -1 to the grid's width and height, less 1 */
    int count;
    const lmb_texel_vertex *vertex;
} lmb_texel_piece;

typedef void (*lmb_texel_piece_function)(void *context, const lmb_texel_piece *piece);

/* Calls `visit` for each piece of a triangle that has one. */
void lmb_texels_pieces(const lmb_mesh *mesh, const lmb_vec2 *corner_uv, const lmb_texel_grid *grid, uint32_t triangle,
                       lmb_texel_piece_function visit, void *context);

/* The lightmap UV of a corner. `corner_uv` as above. */
lmb_vec2 lmb_texels_corner_uv(const lmb_mesh *mesh, const lmb_vec2 *corner_uv, uint32_t triangle, int corner);

/* An island of less than this many texels shows its border: all of them are on it. */
#define LMB_SMALL_ISLAND_TEXELS 16.0

/* What the layout says of those that do not get what they have asked for. */
typedef struct lmb_layout_losses {
    double *density_share;    /* [instance] of the texels per metre asked for that its image can hold, at most 1 */
    lmb_uv_islands *islands;  /* [mesh] at the density of its largest instance */
    uint32_t *first_instance; /* [mesh] that has a region; UINT32_MAX: none */
} lmb_layout_losses;

/* Says it, a few of each kind by name. */
void lmb_lightmap_warn(const lmb_lightmap *lightmap, const lmb_layout_losses *losses);

/* Places every region that has a size into images, and makes those. @return LMB_ERROR_MEMORY */
lmb_result lmb_lightmap_pack(lmb_lightmap *lightmap);

/* Texels of the largest region; at least 1. */
size_t lmb_lightmap_largest_region(const lmb_lightmap *lightmap);

/* The grid of an instance that has a region. */
lmb_texel_grid lmb_lightmap_grid(const lmb_lightmap *lightmap, uint32_t instance);

/* The texels that bilinear filtering reads for a point of the surface. */
enum { LMB_FOOTPRINT = 4 };
typedef struct lmb_lightmap_footprint {
    int32_t image;
    uint32_t pixel[LMB_FOOTPRINT];
    float weight[LMB_FOOTPRINT];
} lmb_lightmap_footprint;

/* Those of a hit on an instance that has a region. */
void lmb_lightmap_footprint_find(const lmb_lightmap *lightmap, const lmb_hit *hit, lmb_lightmap_footprint *footprint);

/* Their mean. */
void lmb_lightmap_footprint_read(const lmb_lightmap *lightmap, const lmb_lightmap_footprint *footprint,
                                 float channel[LMB_MODEL_MOST_CHANNELS]);

/* The mean of what they have seen of each key light. */
void lmb_lightmap_footprint_keys(const lmb_lightmap *lightmap, const lmb_lightmap_footprint *footprint,
                                 float visibility[LMB_KEY_LIGHTS_MOST]);

/* Whether it is lit by texels: static, not left out, and not empty. */
bool lmb_instance_has_region(const lmb_scene *scene, uint32_t instance);

/* Texels per metre that an instance asks for: its own or the level's, times its factor. */
double lmb_lightmap_density_asked(const lmb_lightmap *lightmap, uint32_t instance);

/* Area of a mesh's triangles after a transform, in square metres. */
double lmb_mesh_area(const lmb_mesh *mesh, const lmb_affine *transform);

/* Area of an instance's triangles, in square metres. */
double lmb_instance_area(const lmb_scene *scene, uint32_t instance);

/* Fills what no triangle touches, in every region and the padding around it, from the nearest texels that have light;
 * marks it LMB_TEXEL_DILATED. @return LMB_ERROR_MEMORY */
lmb_result lmb_lightmap_dilate(lmb_lightmap *lightmap);

/* Shortens d, or lowers the directional share, of texels where filtering would make light: wherever those around a
 * point of the surface, filtered and decoded at the point's own normal, would give more light than they hold. Texels
 * around which none does keep their bits. Light was gathered as held[image][pixel] says, in luminance: a texel that has
 * been made brighter since shines no brighter than that in any direction. @return LMB_ERROR_MEMORY */
lmb_result lmb_lightmap_limit(lmb_lightmap *lightmap, float *const *held, const lmb_tracer *tracer, lmb_pool *pool);

/* Sets the states that a bake leaves, without its light. @return LMB_ERROR_MEMORY */
lmb_result lmb_lightmap_mark(lmb_lightmap *lightmap);

/* lightmap_resolution.c: warns where floats do not tell positions apart that are a texel from each other. */
void lmb_lightmap_warn_of_steps(const lmb_lightmap *lightmap);

/* Whether the text of a lightmap.json describes just this lightmap; then takes from it which sides were baked, and
 * the scales of the light in textures, [image]. `path` names it in messages. @return LMB_ERROR_FORMAT */
lmb_result lmb_lightmap_json_check(lmb_lightmap *lightmap, const char *path, const char *text, size_t size,
                                   float *scale, lmb_error *error);

#endif
