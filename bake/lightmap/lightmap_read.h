/* Reading a lightmap's files, from memory where that is all there is. */
#ifndef LMB_LIGHTMAP_READ_H
#define LMB_LIGHTMAP_READ_H

#include <stddef.h>

#include <lambent/lightmap.h>

/* Whether the text of a lightmap.json describes just this lightmap; then takes from it which sides were baked. `path`
 * names it in messages. @return LMB_ERROR_FORMAT */
lmb_result lmb_lightmap_json_check(lmb_lightmap *lightmap, const char *path, const char *text, size_t size,
                                   lmb_error *error);

#endif
