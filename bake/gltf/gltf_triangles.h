/* How the vertices of a primitive make triangles. */
#ifndef LMB_GLTF_TRIANGLES_H
#define LMB_GLTF_TRIANGLES_H

#include "gltf/gltf_accessor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Modes of primitives; those below make no triangles. */
enum { LMB_GLTF_TRIANGLES = 4, LMB_GLTF_TRIANGLE_STRIP = 5, LMB_GLTF_TRIANGLE_FAN = 6 };

/* Triangles, vertices, and so on of one mesh: so many that 3 of each are an int. */
enum { LMB_GLTF_MAX_ELEMENTS = 0x7fffffff / 3 };

typedef struct lmb_gltf_topology {
    int32_t mode;
    int32_t indices; /* accessor, or -1: vertices in their order */
    uint32_t vertex_count;
} lmb_gltf_topology;

typedef struct lmb_gltf_triangles {
    uint32_t (*corners)[3]; /* vertices, malloc'ed */
    uint32_t count;
} lmb_gltf_triangles;

/* All triangles of a primitive, in order; none for points and lines. Every index is checked against the vertex count.
 * `where` names the primitive in messages.
 * @return LMB_ERROR_FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_triangles_read(const lmb_gltf_file *file, const lmb_gltf_topology *topology, const char *where,
                                   lmb_gltf_triangles *triangles, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
