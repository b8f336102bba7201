/* A level, as the baker needs it: triangles, what they reflect and emit, lights, environment.
 *
 * Loaded from glTF 2.0 (lambent/gltf.h). Everything is plain data: arrays that the scene owns, indices into them,
 * never pointers between them. Meshes are in their own space and shared by instances.
 *
 * World positions of a scene count from its `origin`, in the world's axes: floats are finest near zero, so a level that
 * lies far out is moved to there. Whoever takes or gives a position in the world goes through lmb_scene_from_world and
 * lmb_scene_to_world. */
#ifndef LAMBENT_SCENE_H
#define LAMBENT_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/affine.h>
#include <lambent/error.h>
#include <lambent/image.h>
#include <lambent/key_light.h>
#include <lambent/types.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_vec2 {
    float x, y;
} lmb_vec2;

typedef enum lmb_wrap { LMB_WRAP_REPEAT, LMB_WRAP_CLAMP, LMB_WRAP_MIRROR } lmb_wrap;

/* 8-bit RGBA pixels as the file has them; row 0 is the top, v = 0. 16-bit sources are rounded to 8. */
typedef struct lmb_texture_image {
    char *name; /* URI or "image N", for messages */
    int32_t width;
    int32_t height;
    uint8_t *rgba;
} lmb_texture_image;

/* UV sets of a mesh: TEXCOORD_0, TEXCOORD_1, and those of higher numbers that a texture which is read needs, in the
 * order in which they were met: the same for all meshes of a scene. */
enum { LMB_UV_SETS = 8 };

/* A use of an image by a material. */
typedef struct lmb_texture {
    int32_t image;  /* index into scene.images, or -1: no texture, the factor alone */
    int32_t uv_set; /* into lmb_mesh.uv */
    lmb_wrap wrap_u, wrap_v;
    bool nearest;          /* nearest filtering; else bilinear */
    float transform[2][3]; /* KHR_texture_transform as an affine map of (u, v); identity by default */
} lmb_texture;

typedef enum lmb_alpha_mode { LMB_ALPHA_OPAQUE, LMB_ALPHA_MASK, LMB_ALPHA_BLEND } lmb_alpha_mode;

typedef struct lmb_material {
    char *name;
    float base_color[4];            /* linear factor, alpha last; each in [0, 1] */
    lmb_texture base_color_texture; /* sRGB, alpha linear */
    lmb_rgb emissive;               /* radiance factor: emissiveFactor x emissive strength */
    lmb_texture emissive_texture;   /* sRGB */
    lmb_texture normal_texture;     /* tangent space, +Y up; linear */
    float normal_scale;
    float metallic, roughness; /* factors, each in [0, 1]; of pictures alone: all surfaces are diffuse to the bake */
    lmb_texture metallic_roughness_texture; /* linear: G roughness, B metalness; read for lmb_gltf_options.reflection */
    float transmission;                     /* KHR_materials_transmission factor: lets light straight through, tinted */
    lmb_alpha_mode alpha_mode;
    float alpha_cutoff;
    bool double_sided; /* does not change transport: surfaces reflect on both sides */
    bool unlit;        /* neither emits nor bounces */
    uint32_t set;      /* of lights (light_sets.h), that its emission belongs to */
} lmb_material;

/* Triangles of one glTF mesh, all its primitives together, in mesh space. */
typedef struct lmb_mesh {
    char *name;
    uint32_t vertex_count;
    lmb_vec3 *position;        /* [vertex] finite */
    lmb_vec3 *normal;          /* [vertex] unit; flat normals are made where the file has none */
    float (*tangent)[4];       /* [vertex] xyz unit, w = +-1 handedness; all zero where the file has none, and NULL
                                  when no primitive has any: then derived from UVs where needed */
    lmb_vec2 *uv[LMB_UV_SETS]; /* [vertex] NULL when absent from every primitive, or, beyond TEXCOORD_1, not needed */
    float (*color)[4];         /* [vertex] linear COLOR_0, or NULL */
    uint32_t triangle_count;
    uint32_t (*triangle)[3];    /* [triangle] vertex indices, wound counter-clockwise seen from the front */
    uint32_t *material;         /* [triangle] index into scene.materials (a default material always exists) */
    int32_t source_mesh;        /* index in the glTF file */
    int32_t source_node;        /* the node whose skin or morph weights pose this copy of the glTF mesh, or -1 */
    uint32_t *source_primitive; /* [triangle] primitive of the glTF mesh that it came from */
    uint32_t *source_triangle;  /* [triangle] its index in that primitive, counting those that were dropped */
    lmb_vec3 shift;             /* what was taken off the file's positions: 0 but for meshes far from their origin */
    float file_reach;           /* the largest coordinate that the file itself has for a triangle's corner */
} lmb_mesh;

/* A mesh placed in the world: one for each glTF node that has one, or for each of its transforms
 * (EXT_mesh_gpu_instancing).
 */
typedef struct lmb_instance {
    char *name;    /* the node's name, or "node N" */
    int32_t node;  /* index in the glTF file */
    int32_t place; /* index of the transform in EXT_mesh_gpu_instancing, 0 without */
    uint32_t mesh;
    lmb_affine to_world;
    lmb_affine normal_to_world; /* inverse transpose of the linear part; translation 0 */
    bool mirrored;              /* negative determinant: winding is the other way round */
    bool dynamic;               /* extras {"lambent": {"static": false}}: neither baked nor an occluder */
    bool no_lightmap;           /* extras "lightmap": false: a surface like others, but without texels */
    bool has_local_set;         /* extras "local_set": probes of its own about its bounds (probe_locals.h) */
    bool lit_locally;           /* extras "lightmap": "local": no texels, and they light it */
    uint32_t local_size[3];     /* of these probes along each of its axes; 0: as its shape wants */
    float texels_per_m;         /* of its lightmap; 0: the level's */
    float texel_scale;          /* factor on that; 0 counts as 1 */
    float position_step;        /* metres between its positions that floats tell apart, the file's or the scene's: the
                                   coarser at the farthest corner. 0 for what is never traced */
} lmb_instance;

typedef enum lmb_light_type { LMB_LIGHT_POINT, LMB_LIGHT_SPOT, LMB_LIGHT_DIRECTIONAL } lmb_light_type;

/* KHR_lights_punctual, in world space and in radiometric use of its photometric units: 1 lux on a white Lambertian
 * surface gives radiance 1/pi; emissive radiance is in the same units. */
typedef struct lmb_light {
    char *name;
    lmb_light_type type;
    lmb_vec3 position;  /* point, spot */
    lmb_vec3 direction; /* unit, the way the light travels (the node's -Z); spot, directional */
    lmb_rgb intensity;  /* colour x intensity: candela (point, spot), lux (directional) */
    float range;        /* metres; 0: unlimited */
    float cos_inner;    /* spot: full intensity inside */
    float cos_outer;    /* spot: none outside */
    float angle_rad;    /* directional: the whole angle that its disc takes in the sky, up to pi; 0: none */
    float radius;       /* metres; point, spot: of the sphere that it is; 0: none */
    bool indirect_only; /* extras {"lambent": {"light": "indirect"}}: only its bounces are baked, the game adds the rest
                         */
    uint32_t set;       /* of lights that it belongs to (light_sets.h) */
    bool dark;          /* its set is not shown */
} lmb_light;

/* A pixel of a picture whose sun became a light, as it was. */
typedef struct lmb_environment_pixel {
    uint32_t pixel;
    lmb_rgb radiance;
} lmb_environment_pixel;

typedef struct lmb_environment {
    bool present;
    lmb_rgb constant; /* used when image.rgb is NULL */
    lmb_image image;  /* latitude-longitude radiance; each pixel counts as constant over its solid angle */
    lmb_latlong_axes axes;
    float rotation_rad; /* turns the environment about +Y, counter-clockwise seen from above */
    float strength;
    uint32_t set;                 /* of lights that it belongs to */
    lmb_environment_pixel *taken; /* ascending; who looks at the picture sees these */
    uint32_t taken_count;
    bool has_sun; /* the scene's last light is this sky's sun, which is not in the picture */
} lmb_environment;

/* A camera of the level, or a node that a picture is to be taken from (lmb_gltf_options.view_node). */
typedef struct lmb_scene_camera {
    char *name;             /* the node's, or "node N" */
    lmb_affine to_world;    /* looks along its -Z, +Y upwards */
    float vertical_fov_rad; /* 0: not told */
} lmb_scene_camera;

/* A box that says how probes are to stand in it (probe_boxes.h): extras {"lambent": {"volume": {...}}}. A node with a
 * mesh is the box around that, which then is no surface; one without is the cube from -1 to 1. */
typedef struct lmb_probe_box {
    char *name;            /* the node's name, or "node N" */
    lmb_affine to_world;   /* of the cube from -1 to 1: turned and skewed as the node is */
    lmb_affine from_world; /* its inverse */
    float spacing;         /* metres between probes; 0: the level's */
    float min_spacing;     /* of its finest level of probes; 0: the level's */
    float tolerance;       /* error of interpolation beyond which a finer level follows; 0: the level's */
    bool exclude;          /* no probes */
    double priority;       /* where boxes overlap */
} lmb_probe_box;

/* Sets of lights beside those that name none (light_sets.h), and a name's bytes with its NUL. */
enum { LMB_LIGHT_SETS_MOST = 16, LMB_LIGHT_SET_NAME = 64 };

typedef struct lmb_scene {
    char *path;
    lmb_vec3d origin; /* in the world; all positions below count from it */
    lmb_mesh *meshes;
    uint32_t mesh_count;
    lmb_instance *instances;
    uint32_t instance_count;
    lmb_material *materials;
    uint32_t material_count;
    lmb_texture_image *images;
    uint32_t image_count;
    lmb_light *lights;
    uint32_t light_count;
    uint32_t
        key_light[LMB_KEY_LIGHTS_MOST]; /* of them, those that are kept apart (key_lights.h), the strongest first */
    uint32_t key_light_count;
    lmb_environment environment;
    char light_set_name[LMB_LIGHT_SETS_MOST][LMB_LIGHT_SET_NAME]; /* [set - 1] */
    uint32_t light_set_count;                                     /* named ones */
    /* What lmb_scene_show_light_set took away, and what it shows. */
    bool light_set_hides_others;
    uint32_t light_set_shown;
    lmb_rgb *lit; /* [material] its emission; NULL: nothing was hidden yet */
    bool environment_lit;
    uint32_t key_light_lit[LMB_KEY_LIGHTS_MOST], key_light_lit_count;
    lmb_vec3 bounds_min; /* of all static triangles, world space; min > max when there are none */
    lmb_vec3 bounds_max;
    lmb_vec3 *seed_points; /* nodes marked by extras {"lambent": {"seed": true}}, world space */
    char **seed_names;     /* [seed point] name of its node; NULL: they have none */
    uint32_t seed_point_count;
    lmb_vec3 *cube_points; /* nodes marked by extras {"lambent": {"cube_map": true}}, world space */
    char **cube_names;     /* [cube point] name of its node */
    uint32_t cube_point_count;
    lmb_scene_camera *cameras;
    uint32_t camera_count;
    lmb_probe_box *probe_boxes;
    uint32_t probe_box_count;
    lmb_vec3 *path_points; /* nodes marked by extras {"lambent": {"path": n}}, in the order of n */
    uint32_t path_point_count;
    uint32_t dropped_triangle_count; /* degenerate, non-finite or out-of-range triangles that were left out */
    uint64_t
        content_hash; /* of the level's bytes with its buffers and images, the environment, and what was excluded */
} lmb_scene;

/* Frees everything; NULL is allowed. */
void lmb_scene_destroy(lmb_scene *scene);

/* The scene's position of one in the world, and the reverse. */
lmb_vec3 lmb_scene_from_world(const lmb_scene *scene, lmb_vec3d world);
lmb_vec3d lmb_scene_to_world(const lmb_scene *scene, lmb_vec3 position);

/* The coarsest position_step of all static instances, metres. */
float lmb_scene_position_step(const lmb_scene *scene);

/* Checks every index, every vertex and every unit vector. @return LMB_ERROR_FORMAT with the place in `error` */
lmb_result lmb_scene_validate(const lmb_scene *scene, lmb_error *error);

/* Whether anything in the scene gives light. */
bool lmb_scene_has_light(const lmb_scene *scene);

#ifdef __cplusplus
}
#endif

#endif
