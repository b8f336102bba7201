/* The version of these headers and, by a call, of the library that was linked. Before 1.0 a minor version may change
 * the interface. CMake reads the numbers from here. */
#ifndef LAMBENT_VERSION_H
#define LAMBENT_VERSION_H

#include <lambent/api.h>

#ifdef __cplusplus
extern "C" {
#endif

#define LMB_VERSION_MAJOR 0
#define LMB_VERSION_MINOR 1
#define LMB_VERSION_PATCH 0

/* One number to compare: 1.2.3 is 10203. */
#define LMB_VERSION (LMB_VERSION_MAJOR * 10000 + LMB_VERSION_MINOR * 100 + LMB_VERSION_PATCH)

/* LMB_VERSION of the library as it was built: a shared one may be another than the headers. */
LMB_API int lmb_version(void);

/* The same as text, "1.2.3". */
LMB_API const char *lmb_version_text(void);

#ifdef __cplusplus
}
#endif

#endif
