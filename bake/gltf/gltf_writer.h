/* A level that is written again: its own JSON, with all bytes in one chunk. */
#ifndef LMB_GLTF_WRITER_H
#define LMB_GLTF_WRITER_H

#include <lambent/warning.h>

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The items of one of the level's lists by index, which cJSON would have to walk to. */
typedef struct lmb_gltf_items {
    cJSON **items;
    uint32_t count;
} lmb_gltf_items;

typedef struct lmb_gltf_writer {
    lmb_gltf_file *file;
    const lmb_warnings *warnings;
    lmb_error *error;
    unsigned char *bytes; /* the binary chunk */
    size_t size, capacity;
    cJSON *views, *accessors;
    uint32_t view_count, accessor_count; /* of those lists; cJSON would count anew each time */
    uint32_t mesh_count;                 /* with the copies that were added */
    lmb_gltf_items source_accessors, source_meshes, source_nodes;
} lmb_gltf_writer;

/* Lists the items that are there, and sees to the lists that grow. @return LMB_ERROR_MEMORY */
lmb_result lmb_gltf_writer_begin(lmb_gltf_writer *writer);

/* Frees what the writer holds, but for its file. */
void lmb_gltf_writer_free(lmb_gltf_writer *writer);

lmb_result lmb_gltf_writer_out_of_memory(const lmb_gltf_writer *w);

/* Appends room for `size` bytes at a multiple of 4, zeroed. NULL when out of memory or too large. */
unsigned char *lmb_gltf_append_bytes(lmb_gltf_writer *w, size_t size, size_t *offset);

/* Sets a property. @return false when out of memory */
bool lmb_gltf_set_number(cJSON *object, const char *name, double value);

/* What the bytes of a view are for; LMB_GLTF_ANY does not say. */
enum { LMB_GLTF_ANY = 0, LMB_GLTF_VERTICES = 34962, LMB_GLTF_INDICES = 34963 };

/* A run of bytes that was appended. `stride` 0: tight. */
typedef struct lmb_gltf_range {
    size_t offset, size, stride;
    int target;
} lmb_gltf_range;

/* New buffer view. @return its index, or -1 when out of memory */
int64_t lmb_gltf_add_view(lmb_gltf_writer *w, lmb_gltf_range range);

/* Takes `accessor`, which may be NULL. @return its index, or -1 */
int64_t lmb_gltf_add_accessor(lmb_gltf_writer *w, cJSON *accessor, int64_t view, uint32_t count);

/* NULL when out of memory. */
cJSON *lmb_gltf_new_accessor(int component_type, const char *type);

/* Writes JSON and chunk as they are now, beside `path`, then renames. @return LMB_ERROR_WRITE, _MEMORY */
lmb_result lmb_gltf_write_glb(lmb_gltf_writer *w, const char *path);

#ifdef __cplusplus
}
#endif

#endif
