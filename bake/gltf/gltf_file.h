/* A glTF file as it is on the disk: its container, its JSON, and what the steps that follow find in it.
 *
 *     gltf_open.c  the order of the steps: nothing below it knows of a step that comes later
 *       gltf_container.c, gltf_file.c   bytes -> JSON
 *       gltf_schema.c, gltf_check.c     types, ranges, indices, versions, extensions
 *       gltf_uri.c, gltf_buffers.c      buffers, views of them
 *       gltf_accessor.c                 every element in its view
 *       gltf_references.c               what the JSON alone cannot tell: hierarchy, primitives, skins */
#ifndef LMB_GLTF_FILE_H
#define LMB_GLTF_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cjson/cJSON.h>

#include <lambent/error.h>

#include "gltf/gltf_container.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_gltf_file {
    char *path;
    bool allow_outside_uris;
    lmb_gltf_bytes bytes;
    lmb_gltf_bytes bin; /* the GLB's binary chunk; its data may be NULL */
    cJSON *root;
    lmb_gltf_bytes *buffers; /* gltf_buffers.h */
    uint32_t buffer_count;
    const cJSON **views; /* [bufferView] */
    uint32_t view_count;
    struct lmb_gltf_accessor *accessors; /* gltf_accessor.h */
    uint32_t accessor_count;
    uint64_t hash; /* of all bytes read so far */
} lmb_gltf_file;

/* Refuses what is not a plain file (a pipe would hang) or larger than 2 GiB before reading it. `shown` stands for the
 * path in messages. `*bytes` owns what was read.
 * @return LMB_ERROR_IO, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_plain_file_read(const char *path, const char *shown, lmb_gltf_bytes *bytes, lmb_error *error);

/* Where a file is. */
typedef struct lmb_gltf_source {
    const char *path;
    const void *data; /* its bytes, which outlive what is read from them; NULL: they are on the disk */
    size_t size;
} lmb_gltf_source;

/* Reads the container and parses the JSON, which is an object then, and unchecked. For lmb_gltf_file_close.
 * @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_file_read(const lmb_gltf_source *source, bool allow_outside_uris, lmb_gltf_file **file,
                              lmb_error *error);

/* `file` may be NULL. */
void lmb_gltf_file_close(lmb_gltf_file *file);

#ifdef __cplusplus
}
#endif

#endif
