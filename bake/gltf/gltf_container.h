/* The binary container of glTF 2.0 (section 4 of its text), GLB: where its chunks are. */
#ifndef LMB_GLTF_CONTAINER_H
#define LMB_GLTF_CONTAINER_H

#include <stddef.h>

#include <lambent/error.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bytes of a file that is read or written. tinygltf counts in unsigned int and GLB in 32 bits; half of that leaves room
 * for sums. */
#define LMB_GLTF_MAX_SIZE ((size_t)0x7fffffff)

/* Bytes, most of them somebody else's. */
typedef struct lmb_gltf_bytes {
    const unsigned char *data;
    size_t size;
    unsigned char *owned; /* what to free, or NULL */
} lmb_gltf_bytes;

/* Finds the JSON and the binary chunk (NULL when there is none) in the bytes of a file, which stay the caller's. What
 * does not begin as a GLB is JSON as a whole. `path` names the file in messages.
 * @return LMB_ERROR_FORMAT, _UNSUPPORTED */
lmb_result lmb_gltf_container_split(const char *path, lmb_gltf_bytes file, lmb_gltf_bytes *json, lmb_gltf_bytes *bin,
                                    lmb_error *error);

/* A GLB of JSON and, unless it is empty, a binary chunk; malloc'ed, both padded. NULL when out of memory, or larger
 * than LMB_GLTF_MAX_SIZE. */
unsigned char *lmb_gltf_container_join(const char *json, lmb_gltf_bytes bin, size_t *size);

#ifdef __cplusplus
}
#endif

#endif
