/* Which extensions are known. */
#ifndef LMB_GLTF_EXTENSIONS_H
#define LMB_GLTF_EXTENSIONS_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What may be in extensionsRequired, and one warning that names what else is in extensionsUsed. */
bool lmb_gltf_extension_may_be_required(const char *name);
bool lmb_gltf_name_matches(const char *pattern, const char *text); /* `*` matches any run, `?` any one byte */
void lmb_gltf_extensions_warn(const lmb_gltf_file *file, const lmb_warnings *warnings);

#ifdef __cplusplus
}
#endif

#endif
