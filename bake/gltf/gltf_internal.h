/* The inside of lambent/gltf.h: a glTF file whose JSON was checked, with its buffers and its accessors resolved.
 *
 *     file -> gltf_file.c (container, URIs, buffers) -> gltf_check.c (types, indices, ranges)
 *          -> gltf_extras.c (what nodes want) -> gltf.cc (tinygltf: nodes, materials, lights)
 *          -> gltf_transform.c, gltf_mesh.c (triangles in their place) -> scene
 *          -> gltf_uv.c (the same JSON with new accessors) -> .glb
 *
 * tinygltf sees nothing but JSON that passed the checks: it takes wrong types for absent ones, and indexes buffers
 * without looking. */
#ifndef LAMBENT_GLTF_INTERNAL_H
#define LAMBENT_GLTF_INTERNAL_H

#include <cjson/cJSON.h>

#include <lambent/gltf.h>

#include "scene/scene_internal.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    LMB_GLTF_PLACE_SIZE = 256,
    LMB_GLTF_BYTE = 5120,
    LMB_GLTF_UNSIGNED_BYTE = 5121,
    LMB_GLTF_SHORT = 5122,
    LMB_GLTF_UNSIGNED_SHORT = 5123,
    LMB_GLTF_UNSIGNED_INT = 5125,
    LMB_GLTF_FLOAT = 5126
};

typedef struct lmb_gltf_bytes {
    const unsigned char *data;
    size_t size;
    unsigned char *owned; /* what to free, or NULL */
} lmb_gltf_bytes;

/* An accessor whose every element was checked to lie in its buffer. */
typedef struct lmb_gltf_accessor {
    const unsigned char *data; /* NULL: zeros */
    size_t stride;
    uint32_t count;
    uint32_t components;
    uint32_t element_size; /* bytes, with the padding of small matrices */
    uint32_t used_size;    /* the same without the padding after the last column, which the last element may lack */
    int component_type;
    bool normalized;
    bool missing; /* its buffer has no bytes in the file, which is an error for whoever reads it */
    uint32_t sparse_count;
    int sparse_index_type;
    const unsigned char *sparse_indices;
    const unsigned char *sparse_values; /* tightly packed */
} lmb_gltf_accessor;

typedef struct lmb_gltf_file {
    char *path;
    bool allow_outside_uris;
    unsigned char *data;
    size_t size;
    const unsigned char *bin; /* the GLB's binary chunk, or NULL */
    size_t bin_size;
    cJSON *root;
    lmb_gltf_bytes *buffers;
    uint32_t buffer_count;
    const cJSON **views; /* [bufferView] */
    uint32_t view_count;
    lmb_gltf_accessor *accessors;
    uint32_t accessor_count;
    uint64_t hash; /* of all bytes read so far */
} lmb_gltf_file;

/* Reads and checks everything but what the accessors' elements say. */
lmb_result lmb_gltf_file_open(const char *path, const lmb_gltf_options *options, lmb_gltf_file **file,
                              lmb_error *error);
void lmb_gltf_file_close(lmb_gltf_file *file);

/* The still encoded bytes of an image, or why there are none. Adds external ones to file->hash; `name` (malloc'ed, may
 * be NULL) gets its URI or "image N". */
lmb_result lmb_gltf_image_read(lmb_gltf_file *file, const cJSON *image, uint32_t number, lmb_gltf_bytes *bytes,
                               char **name, lmb_error *error);

/* gltf_shown.c: the checked JSON as text for tinygltf, for cJSON_free; NULL when out of memory. */
char *lmb_gltf_text_for_tinygltf(const lmb_gltf_file *file);

/* The bytes that a `uri` stands for; `place` names it in messages. */
lmb_result lmb_gltf_uri_read(lmb_gltf_file *file, const char *uri, const char *place, lmb_gltf_bytes *bytes,
                             lmb_error *error);

/* gltf_accessor.c: every view in its buffer, then every accessor in its view; sparse indices in their accessor. */
lmb_result lmb_gltf_views_resolve(lmb_gltf_file *file, lmb_error *error);
lmb_result lmb_gltf_accessors_resolve(lmb_gltf_file *file, lmb_error *error);
/* A buffer view's bytes; `data` is NULL when the file does not have them. */
lmb_gltf_bytes lmb_gltf_view_bytes(const lmb_gltf_file *file, uint32_t view);

/* gltf_check.c: versions, required extensions, then the type and range of every property that is read. */
lmb_result lmb_gltf_check_json(const lmb_gltf_file *file, lmb_error *error);
/* The rest that the JSON alone can tell: the node hierarchy, primitives, skins. Needs the accessors. */
lmb_result lmb_gltf_check_references(const lmb_gltf_file *file, lmb_error *error);

/* gltf_extensions.c: what may be in extensionsRequired, and one warning that names what else is in extensionsUsed. */
bool lmb_gltf_extension_may_be_required(const char *name);
bool lmb_gltf_name_matches(const char *pattern, const char *text); /* `*` matches any run, `?` any one byte */
void lmb_gltf_extensions_warn(const lmb_gltf_file *file, const lmb_warnings *warnings);

/* gltf_blender.c: lamps far brighter than what emits, as its exporter makes them (after loading), and lamps that it
 * leaves out (from the JSON). */
void lmb_gltf_blender_warn_units(const lmb_gltf_file *file, const lmb_scene *scene, const lmb_warnings *warnings);
void lmb_gltf_blender_warn_area_lamps(const lmb_gltf_file *file, const lmb_warnings *warnings);

typedef enum lmb_gltf_movement { LMB_GLTF_AS_ABOVE, LMB_GLTF_STANDS, LMB_GLTF_MOVES } lmb_gltf_movement;
typedef enum lmb_gltf_light_part { LMB_GLTF_BAKED, LMB_GLTF_INDIRECT, LMB_GLTF_OFF } lmb_gltf_light_part;

/* What a node wants, by its `extras` and KHR_node_visibility. */
typedef struct lmb_gltf_marks {
    lmb_gltf_movement moves;
    lmb_gltf_light_part light;
    bool seed, has_path;
    bool hidden; /* with all below it; the other marks count all the same */
    double path;
    double angle_deg, radius_m; /* of the node's light; 0: not told */
} lmb_gltf_marks;

/* gltf_extras.c: the marks of all nodes, malloc'ed. What is not understood is warned about, but for a wrong `light`. */
lmb_result lmb_gltf_marks_read(const lmb_gltf_file *file, const lmb_warnings *warnings, lmb_gltf_marks **marks,
                               lmb_error *error);

/* gltf_transform.c: a after b; and translation x rotation x scale, with a quaternion x, y, z, w that need not be unit,
 * and turns nothing when it is zero. */
lmb_affine lmb_gltf_product(const lmb_affine *a, const lmb_affine *b);
lmb_affine lmb_gltf_compose(const double t[3], const double q[4], const double s[3]);
/* One place of EXT_mesh_gpu_instancing from its floats, each NULL where the node has none, and the largest of its
 * translation. @return false when one is not finite */
bool lmb_gltf_instancing_place(const float *translation, const float *rotation, const float *scale, lmb_affine *place,
                               float *reach);
/* Unit, where a node's -Z points; -Z of the world where it has no direction. */
lmb_vec3 lmb_gltf_forward(const lmb_affine *to_world);
typedef enum lmb_gltf_rank { LMB_GLTF_NOTHING, LMB_GLTF_FLAT, LMB_GLTF_SOLID } lmb_gltf_rank;
lmb_gltf_rank lmb_gltf_transform_rank(const lmb_affine *t);
/* Sets the transforms, from positions that `shift` was taken off, and `mirrored`. What is flattened along one axis gets
 * a thickness of a millionth, so that its normals have a transform. @return false when nothing is left to see */
bool lmb_gltf_instance_place(const lmb_affine *to_world, const lmb_vec3 *shift, lmb_instance *instance);

/* Says where in the file something is; what does not fit is cut. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void lmb_gltf_place(char place[LMB_GLTF_PLACE_SIZE], const char *format, ...);

/* A non-negative integer property that was checked, or `missing`. */
uint32_t lmb_gltf_uint(const cJSON *object, const char *name, uint32_t missing);

/* Element `index` of the plain part (without sparse substitution) as floats, normalised when the accessor says so. */
void lmb_gltf_decode(const lmb_gltf_accessor *accessor, const unsigned char *element, float *values);
/* All elements, sparse ones substituted; `values` holds count x components. */
void lmb_gltf_decode_all(const lmb_gltf_accessor *accessor, float *values);
/* All elements' raw bytes, tightly packed, sparse ones substituted; `bytes` holds count x element_size. */
void lmb_gltf_copy_all(const lmb_gltf_accessor *accessor, unsigned char *bytes);
/* Number `index` of a run of unsigned integers. */
uint32_t lmb_gltf_read_index(const unsigned char *data, int component_type, size_t index);

/* One primitive's accessors; -1 where absent. */
typedef struct lmb_gltf_target {
    int32_t position;
    int32_t normal;
} lmb_gltf_target;

typedef struct lmb_gltf_primitive {
    int32_t mode;
    int32_t indices;
    int32_t position;
    int32_t normal;
    int32_t tangent;
    int32_t color;
    int32_t uv[LMB_UV_SETS]; /* as lmb_mesh.uv */
    int32_t joints[2];
    int32_t weights[2];
    uint32_t material;
    uint32_t number; /* in its glTF mesh */
    const lmb_gltf_target *targets;
    size_t target_count;
} lmb_gltf_primitive;

/* gltf_nodes.c: the vertical angle of view of a camera in radians; 0 of an orthographic one, or none (negative). And a
 * warning for each pattern of the options that matches no node: it is mistyped, or the level has changed. */
float lmb_gltf_view_angle(const lmb_gltf_file *file, int32_t camera);
void lmb_gltf_excludes_warn(const lmb_gltf_file *file, const lmb_gltf_options *options, const lmb_warnings *warnings);

/* How a mesh stands at rest. */
typedef struct lmb_gltf_pose {
    const double *weights; /* [target], NULL: none */
    size_t weight_count;
    const lmb_affine *joints; /* [joint] from mesh space to the scene, then that of vertices without a joint;
                                 NULL: not skinned */
    size_t joint_count;
    bool is_moved; /* the scene counts from another origin than the world */
} lmb_gltf_pose;

/* The corners (vertex numbers) of all triangles of a primitive, in order; none for points and lines. Every number is
 * checked against the vertex count. `*corners` is malloc'ed. */
lmb_result lmb_gltf_triangles(const lmb_gltf_file *file, int32_t mode, int32_t indices, uint32_t vertex_count,
                              const char *place, uint32_t (**corners)[3], uint32_t *count, lmb_error *error);

/* Whether an accessor may be a TEXCOORD. */
bool lmb_gltf_is_uv(const lmb_gltf_accessor *accessor);

/* Joins primitives into one mesh. `mesh` must be zero; on failure it holds what lmb_mesh_free frees. */
lmb_result lmb_gltf_mesh_build(const lmb_gltf_file *file, uint32_t number, const lmb_gltf_primitive *primitives,
                               size_t primitive_count, const lmb_gltf_pose *pose, lmb_mesh *mesh, uint32_t *dropped,
                               lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
