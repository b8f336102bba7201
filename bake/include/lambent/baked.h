/* A finished bake's folder, opened again together with its level: to measure it, to draw it. */
#ifndef LAMBENT_BAKED_H
#define LAMBENT_BAKED_H

#include <lambent/bake_settings.h>
#include <lambent/lightmap.h>
#include <lambent/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

struct cJSON;

typedef struct lmb_baked {
    lmb_bake_settings settings; /* that it was baked with, from DIR/bake.json */
    lmb_level level;            /* opened with them */
    lmb_volume *volume;         /* DIR/probes.lmb; NULL when the bake has no probes */
    lmb_lightmap *lightmap;     /* NULL when the bake has none */
    struct cJSON *json;         /* DIR/bake.json, where the strings of the settings lie */
} lmb_baked;

/* What pictures need of the level beside what was baked (lmb_gltf_options). */
typedef struct lmb_baked_view {
    const char *node; /* nodes of this name become cameras of the scene; NULL: none */
    bool reflection;
} lmb_baked_view;

/* Opens DIR's bake.json, probes.lmb and lightmaps, and LEVEL with the bake's own settings (environment, excluded nodes,
 * bounces), without warnings. `level_path` may be NULL: then the path in bake.json. A level whose content hash differs
 * from the one baked is refused. `threads` 0: all. `view` may be NULL: nothing more.
 * All strings are the caller's, for as long as the bake is open. On failure `*opened` needs no closing, and may be
 * closed. @return LMB_ERROR_FORMAT (not a bake, or another level), and what opening the parts returns */
lmb_result lmb_baked_open(const char *level_path, const char *directory, int threads, const lmb_baked_view *view,
                          lmb_baked *opened, lmb_error *error);
void lmb_baked_close(lmb_baked *closed);

/* @return LMB_ERROR_UNSUPPORTED when the bake has no probes */
lmb_result lmb_baked_need_probes(const lmb_baked *baked, const char *directory, lmb_error *error);

/* Has the lightmap in another model, which DIR must hold: one that it was baked with (bake --models).
 * @return LMB_ERROR_FORMAT (it does not), and what reading returns */
lmb_result lmb_baked_read_model(lmb_baked *baked, const char *directory, const lmb_model *model, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
