/* JSON that was checked: its properties, and how messages say where in it something is. */
#ifndef LMB_GLTF_JSON_H
#define LMB_GLTF_JSON_H

#include <stdbool.h>
#include <stdint.h>

#include <cjson/cJSON.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LMB_GLTF_WHERE_SIZE = 256 };

/* Says where in the file something is, as "meshes[3].primitives[0]"; what does not fit is cut. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void lmb_gltf_where(char where[LMB_GLTF_WHERE_SIZE], const char *format, ...);

/* A non-negative integer property that was checked, or `missing`. */
uint32_t lmb_gltf_uint(const cJSON *object, const char *name, uint32_t missing);

/* `extensions.name` of an object, or NULL. Before the checks too. */
cJSON *lmb_gltf_extension(const cJSON *object, const char *name);

#ifdef __cplusplus
}
#endif

#endif
