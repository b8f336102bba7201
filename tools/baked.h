/* A finished bake's folder, opened again together with its level, as `check` and `render` need it. */
#ifndef LMB_TOOLS_BAKED_H
#define LMB_TOOLS_BAKED_H

#include <cjson/cJSON.h>

#include <lambent/lightmap.h>
#include <lambent/volume.h>

#include "level.h"

typedef struct lmb_baked {
    cJSON *json;            /* DIR/bake.json */
    lmb_level level;        /* loaded with the settings that it was baked with */
    lmb_volume *volume;     /* DIR/probes.lmb */
    lmb_lightmap *lightmap; /* NULL when the bake has none */
} lmb_baked;

/* Opens DIR's bake.json, probes.lmb and lightmaps, and LEVEL with the bake's own settings (environment, excluded nodes,
 * bounces). `level_path` may be NULL: then the path in bake.json. A level whose content hash differs from the one baked
 * is refused. `threads` 0: all. Nodes called `view_node` (NULL: none) become cameras of the scene. @return
 * LMB_ERROR_FORMAT (not a bake, or another level), and what opening the parts returns */
lmb_result baked_open(const char *level_path, const char *directory, int threads, const char *view_node,
                      lmb_baked *opened, lmb_error *error);
void baked_close(lmb_baked *closed);

#endif
