/* Which extensions of glTF are read, and which cannot matter to a bake. */
#ifndef LMB_GLTF_EXTENSIONS_H
#define LMB_GLTF_EXTENSIONS_H

#include <lambent/warning.h>

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What may be in extensionsRequired. */
bool lmb_gltf_extension_may_be_required(const char *name);

/* `*` matches any run, `?` any one byte. */
bool lmb_gltf_name_matches(const char *pattern, const char *text);

/* One warning that names what else is in extensionsUsed. */
void lmb_gltf_extensions_warn(const lmb_gltf_file *file, const lmb_warnings *warnings);

#ifdef __cplusplus
}
#endif

#endif
