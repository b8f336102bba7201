/* The inside of lambent/gltf.h: a glTF file with its JSON, its buffers and its accessors.
 *
 *     file -> gltf_file.c (container, URIs, buffers) -> gltf_check.c (types, indices, ranges)
 *          -> gltf_extras.c (what nodes want) -> gltf_loader.hh (tinygltf: nodes, materials, lights)
 *          -> gltf_transform.c, gltf_mesh.c (triangles in their place) -> scene
 *          -> gltf_uv.c (the same JSON with new accessors) -> .glb
 *
 * tinygltf sees nothing but JSON that passed the checks: it takes wrong types for absent ones, and indexes buffers
 * without looking. */
#ifndef LMB_GLTF_FILE_H
#define LMB_GLTF_FILE_H

#include <cjson/cJSON.h>

#include <lambent/gltf.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LMB_GLTF_PLACE_SIZE = 256 };

enum {
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

/* Reads the file of file->path, finds the GLB's chunks and parses the JSON. */
lmb_result lmb_gltf_file_read(lmb_gltf_file *file, lmb_error *error);
/* Reads all buffers; the JSON was checked. */
lmb_result lmb_gltf_buffers_read(lmb_gltf_file *file, lmb_error *error);
void lmb_gltf_file_close(lmb_gltf_file *file);

/* The bytes that a `uri` stands for; `place` names it in messages. */
lmb_result lmb_gltf_uri_read(lmb_gltf_file *file, const char *uri, const char *place, lmb_gltf_bytes *bytes,
                             lmb_error *error);

/* Says where in the file something is; what does not fit is cut. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void lmb_gltf_place(char place[LMB_GLTF_PLACE_SIZE], const char *format, ...);

/* A non-negative integer property that was checked, or `missing`. */
uint32_t lmb_gltf_uint(const cJSON *object, const char *name, uint32_t missing);

#ifdef __cplusplus
}
#endif

#endif
