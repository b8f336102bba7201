/* What materials do at points of a mesh. */
#ifndef LAMBENT_MATERIAL_H
#define LAMBENT_MATERIAL_H

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Whether it lets no light through anywhere. Else it is see-through: MASK, BLEND or transmission. */
bool lmb_material_is_opaque(const lmb_material *material);

/* Whether it gives light, but where its texture is black. */
bool lmb_material_emits(const lmb_material *material);

/* A point of a triangle of a mesh, at barycentric weights u and v of its second and third corner. */
typedef struct lmb_mesh_point {
    const lmb_scene *scene;
    const lmb_mesh *mesh;
    uint32_t triangle;
    float u, v;
} lmb_mesh_point;

const lmb_material *lmb_material_at(const lmb_mesh_point *point);

/* A texture at the point; RGBA as lmb_texture_sample has it. */
void lmb_material_texel(const lmb_mesh_point *point, const lmb_texture *texture, bool srgb, float rgba[4]);

/* Base colour: factor x texture x vertex colour, RGBA in [0, 1]. */
void lmb_material_base_color(const lmb_mesh_point *point, float rgba[4]);

/* Radiance that the material emits there, of the part of the light that is not let through. */
lmb_rgb lmb_material_emission(const lmb_mesh_point *point);

/* How much of the light a surface takes part in. */
typedef struct lmb_coverage {
    float opacity; /* share of the light that it takes part in: 1 for opaque */
    lmb_rgb pass;  /* share of each channel that goes straight through */
} lmb_coverage;

lmb_coverage lmb_material_coverage(const lmb_mesh_point *point);

/* That of a material by its factors alone. */
lmb_coverage lmb_material_coverage_of_factors(const lmb_material *material);

/* What the material reflects and lets through. */
typedef struct lmb_surface {
    lmb_rgb albedo; /* diffuse, of the part of the light that is not let through; 0 for unlit ones */
    lmb_coverage coverage;
} lmb_surface;

lmb_surface lmb_material_surface(const lmb_mesh_point *point);

/* How a surface reflects beside its diffuse light, by glTF's metallic-roughness: `diffuse` of what its base colour
 * says is left of that; `f0` is its reflectance along the normal, and `slope` the root mean square of its facets'
 * slopes, the square of the roughness. All in [0, 1]. */
typedef struct lmb_reflection {
    float diffuse;
    lmb_rgb f0;
    float slope;
} lmb_reflection;

lmb_reflection lmb_material_reflection(const lmb_mesh_point *point);

#ifdef __cplusplus
}
#endif

#endif
