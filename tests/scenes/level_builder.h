/* Building a small level in memory and writing it as a binary glTF file.
 *
 *     lmb_level_builder *builder = lmb_level_builder_create(0.2f);
 *     const int white = lmb_level_builder_add_material(builder, &material);
 *     const int room = lmb_level_builder_add_mesh(builder, "room");
 *     lmb_level_builder_add_box(builder, room, &box);
 *     lmb_level_builder_place(builder, "room", room, (lmb_vec3){0, 0, 0});
 *     lmb_level_builder_write(builder, "room.glb", &error);
 *     lmb_level_builder_destroy(builder);
 *
 * The adding functions return an index that other calls take, or -1 when memory has run out; -1 may be passed on, and
 * lmb_level_builder_write then reports the failure. Indices from another builder are the caller's bug. Equal calls
 * give equal bytes. Strings are copied. Nothing here is thread-safe on one builder.
 *
 * Shapes carry TEXCOORD_0 in metres over the material's `texture_size_m`, and TEXCOORD_1 as a lightmap layout: every
 * flat or curved patch gets its own rectangle of the mesh's unit square, proportional to its size, gutters between. */
#ifndef LAMBENT_LEVEL_BUILDER_H
#define LAMBENT_LEVEL_BUILDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/error.h>
#include <lambent/types.h>

enum { LMB_LEVEL_NONE = -1 };

typedef struct lmb_level_builder lmb_level_builder;

/* `lightmap_gutter_m` > 0: space between the rectangles of TEXCOORD_1 and around them, in metres of surface.
 * @return NULL when memory has run out; every other function accepts that NULL */
lmb_level_builder *lmb_level_builder_create(float lightmap_gutter_m);

void lmb_level_builder_destroy(lmb_level_builder *builder);

/* Writes everything as .glb: to a file beside, which is then renamed.
 * @return LMB_ERROR_MEMORY, _WRITE, _UNSUPPORTED (more than 4 GB) */
lmb_result lmb_level_builder_write(lmb_level_builder *builder, const char *path, lmb_error *error);

/* --- materials ----------------------------------------------------------------------------------------------- */

typedef enum lmb_level_alpha { LMB_LEVEL_OPAQUE, LMB_LEVEL_MASK, LMB_LEVEL_BLEND } lmb_level_alpha;

typedef struct lmb_level_material {
    const char *name;
    lmb_rgb base_color;     /* linear, [0, 1] */
    float alpha;            /* [0, 1] */
    int base_color_texture; /* from lmb_level_builder_add_image, or LMB_LEVEL_NONE */
    lmb_rgb emission;       /* radiance; above 1 it needs and gets KHR_materials_emissive_strength */
    int emissive_texture;
    int normal_texture; /* tangent space, +Y up; shapes with such a material get TANGENT */
    float normal_scale;
    float metallic, roughness;      /* [0, 1] */
    int metallic_roughness_texture; /* factors on them: roughness in its green, metalness in its blue */
    float texture_size_m;           /* metres that one repetition of the textures covers */
    lmb_level_alpha alpha_mode;
    float alpha_cutoff; /* for LMB_LEVEL_MASK */
    bool double_sided;
    bool unlit;
    float transmission;    /* KHR_materials_transmission */
    const char *light_set; /* extras {"lambent": {"light_set": "..."}}, of the caller's; NULL: none */
} lmb_level_material;

/* Mid-grey (0.5), opaque, single-sided, no metal, fully rough, no textures, a texture size of 1 m. */
lmb_level_material lmb_level_material_default(void);

int lmb_level_builder_add_material(lmb_level_builder *builder, const lmb_level_material *material);

/* A texture of width x height RGBA bytes (row 0 on top), embedded as PNG; it repeats and is filtered linearly. */
int lmb_level_builder_add_image(lmb_level_builder *builder, const char *name, int width, int height,
                                const uint8_t *rgba);

/* --- meshes and shapes, in the mesh's own space --------------------------------------------------------------- */

int lmb_level_builder_add_mesh(lmb_level_builder *builder, const char *name);

/* The parallelogram origin, +edge_u, +edge_u+edge_v, +edge_v; its front is along edge_u x edge_v. The texture stands
 * upright with edge_v pointing up. */
void lmb_level_builder_add_quad(lmb_level_builder *builder, int mesh, int material, lmb_vec3 origin, lmb_vec3 edge_u,
                                lmb_vec3 edge_v);

/* Counter-clockwise seen from the front. */
void lmb_level_builder_add_triangle(lmb_level_builder *builder, int mesh, int material, lmb_vec3 a, lmb_vec3 b,
                                    lmb_vec3 c);

typedef struct lmb_level_box {
    lmb_vec3 min, max;
    int material[6]; /* -X, +X, -Y, +Y, -Z, +Z; LMB_LEVEL_NONE leaves the face out */
    bool inward;     /* faces look into the box: a room */
} lmb_level_box;

void lmb_level_builder_add_box(lmb_level_builder *builder, int mesh, const lmb_level_box *box);

/* A box with one material on all its faces. */
lmb_level_box lmb_level_box_of(lmb_vec3 min, lmb_vec3 max, int material);

typedef struct lmb_level_point {
    lmb_vec3 position;
    lmb_vec3 normal;  /* unit */
    lmb_vec3 tangent; /* unit, the way u grows; the way v grows is then normal x tangent */
} lmb_level_point;

/* A curved patch over (u, v) in [0, 1]^2 with columns x rows cells; its front is where v grows to the left of u. */
typedef struct lmb_level_patch {
    int columns, rows;
    float width_m, height_m; /* about how large it is along u and v: for textures and the lightmap layout */
    lmb_level_point (*surface)(const void *context, double u, double v);
    const void *context;
} lmb_level_patch;

void lmb_level_builder_add_patch(lmb_level_builder *builder, int mesh, int material, const lmb_level_patch *patch);

/* A cube laid on a sphere: 12 * divisions^2 triangles with smooth normals. */
typedef struct lmb_level_sphere {
    lmb_vec3 centre;
    float radius;
    int divisions; /* of each edge of the cube */
    bool inward;   /* the front is inside */
} lmb_level_sphere;

void lmb_level_builder_add_sphere(lmb_level_builder *builder, int mesh, int material, const lmb_level_sphere *sphere);

/* A closed upright cylinder: 4 * segments - 4 triangles, smooth around, flat ends. */
typedef struct lmb_level_cylinder {
    lmb_vec3 base; /* the centre of its lower end */
    float radius, height;
    int segments; /* 3 or more */
} lmb_level_cylinder;

void lmb_level_builder_add_cylinder(lmb_level_builder *builder, int mesh, int material,
                                    const lmb_level_cylinder *cylinder);

/* Triangles so far; 0 for LMB_LEVEL_NONE. */
size_t lmb_level_builder_triangle_count(const lmb_level_builder *builder, int mesh);

/* --- lights, cameras, nodes ----------------------------------------------------------------------------------- */

typedef enum lmb_level_light_type {
    LMB_LEVEL_LIGHT_POINT,
    LMB_LEVEL_LIGHT_SPOT,
    LMB_LEVEL_LIGHT_DIRECTIONAL
} lmb_level_light_type;

/* KHR_lights_punctual; a node places it, shining along the node's -Z. */
typedef struct lmb_level_light {
    const char *name;
    lmb_level_light_type type;
    lmb_rgb color;         /* linear, [0, 1] */
    float intensity;       /* candela (point, spot), lux (directional) */
    float range_m;         /* 0: unlimited */
    float inner_angle_rad; /* spot: half angles of the cone */
    float outer_angle_rad;
} lmb_level_light;

int lmb_level_builder_add_light(lmb_level_builder *builder, const lmb_level_light *light);

/* A perspective camera with the given vertical angle of view; a node places it, looking along the node's -Z. */
int lmb_level_builder_add_camera(lmb_level_builder *builder, const char *name, float view_angle_rad);

/* A box of probes, the cube from -1 to 1 of its node: extras {"lambent": {"volume": {...}}}. 0 leaves a number out. */
typedef struct lmb_level_volume {
    float spacing, min_spacing, tolerance;
    bool exclude;
    int priority;
} lmb_level_volume;

typedef struct lmb_level_node {
    const char *name;
    int parent; /* a node added before, or LMB_LEVEL_NONE */
    int mesh;   /* each of these may be LMB_LEVEL_NONE */
    int light;
    int camera;
    lmb_vec3 translation;
    float rotation[4]; /* unit quaternion x, y, z, w */
    lmb_vec3 scale;
    bool dynamic;                    /* extras {"lambent": {"static": false}} */
    bool seed;                       /* extras {"lambent": {"seed": true}} */
    bool cube_map;                   /* extras {"lambent": {"cube_map": true}} */
    int path;                        /* extras {"lambent": {"path": n}}; LMB_LEVEL_NONE: not a point of the path */
    bool no_lightmap;                /* extras {"lambent": {"lightmap": false}} */
    bool local_set;                  /* extras {"lambent": {"local_set": true}}, or, with a size, that */
    uint32_t local_size[3];          /* probes along each axis; 0: none told */
    bool lit_locally;                /* extras {"lambent": {"lightmap": "local"}} */
    float texels_per_m, texel_scale; /* extras likewise; 0: none */
    float angle_deg;       /* of its directional light's disc: extras {"lambent": {"angle_deg": x}}; 0: none */
    float radius_m;        /* of its point or spot light, likewise */
    const char *light_set; /* of its light, likewise, of the caller's; NULL: none */
    bool has_volume;
    lmb_level_volume volume;
} lmb_level_node;

/* At the origin, unturned, unscaled, static, with nothing in it. */
lmb_level_node lmb_level_node_default(const char *name);

int lmb_level_builder_add_node(lmb_level_builder *builder, const lmb_level_node *node);

/* A node that puts a mesh somewhere. */
int lmb_level_builder_place(lmb_level_builder *builder, const char *name, int mesh, lmb_vec3 translation);

/* A node that is a box of probes along the axes. */
int lmb_level_builder_add_volume(lmb_level_builder *builder, const char *name, lmb_vec3 min, lmb_vec3 max,
                                 const lmb_level_volume *volume);

/* Sets `rotation` so that -Z points along `direction` (any length but 0) and +Y stays as upright as it can. */
void lmb_level_look_along(lmb_vec3 direction, float rotation[4]);

/* Sets `rotation` to a turn about +Y, counter-clockwise seen from above. */
void lmb_level_turn(float angle_rad, float rotation[4]);

#endif
