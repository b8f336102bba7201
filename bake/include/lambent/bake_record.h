/* What a bake did: its phases, and the record of them, which bake.json keeps (docs/baking.md). */
#ifndef LAMBENT_BAKE_RECORD_H
#define LAMBENT_BAKE_RECORD_H

#include <lambent/bake_settings.h>
#include <lambent/probes_bake.h>
#include <lambent/lightmap.h>
#include <lambent/placement.h>
#include <lambent/scene_content.h>

#ifdef __cplusplus
extern "C" {
#endif

struct cJSON;

/* In the order in which they run. */
typedef enum lmb_bake_phase {
    LMB_PHASE_LOAD,
    LMB_PHASE_BVH,
    LMB_PHASE_PLACE,
    LMB_PHASE_LAYOUT,  /* of lightmaps */
    LMB_PHASE_PILOT,   /* of the light on surfaces */
    LMB_PHASE_SURFACE, /* direct light on them; records count pilot and bounces here too */
    LMB_PHASE_BOUNCES, /* passes over them: each begins anew */
    LMB_PHASE_LEVELS,  /* of probes */
    LMB_PHASE_PROBES,
    LMB_PHASE_LIGHTMAPS,
    LMB_PHASE_DENOISE, /* of lightmaps */
    LMB_PHASE_WRITE,
    LMB_PHASE_COUNT
} lmb_bake_phase;

/* As progress and bake.json have it: "load", "bvh", "place", "layout", "surface pilot", "surface", "bounces", "levels",
 * "probes", "lightmaps", "denoise", "write". */
const char *lmb_bake_phase_name(lmb_bake_phase phase);

/* The phase of that name, LMB_PHASE_COUNT when there is none. */
lmb_bake_phase lmb_bake_phase_find(const char *name);

/* Of a level of probes. */
typedef struct lmb_level_record {
    float spacing; /* metres */
    int32_t probes;
} lmb_level_record;

enum { LMB_BAKE_LEVELS_MOST = 24 };

typedef struct lmb_bake_record {
    /* As they were used: spacing and lightmap density are set, seeds are where floats are. They make the same again. */
    lmb_bake_settings settings;
    uint64_t content_hash;             /* of level and environment */
    uint64_t content[LMB_SCENE_PARTS]; /* of the level's parts, each by itself; of whole bakes */
    uint64_t key;                      /* of all that decides the bytes, this program's version too */
    bool is_part;                      /* what does not lie in `only` was taken from the bake that the folder held */
    lmb_vec3d only[2];                 /* least and greatest coordinates; else 0 */
    uint64_t taken;                    /* probes, points of regions and texels */
    bool is_current;                   /* nothing was done: the folder held this very bake */
    int threads;
    uint32_t triangles_dropped;
    uint32_t key_light_count;
    lmb_key_light key_light[LMB_KEY_LIGHTS_MOST];
    int32_t probes; /* with those that are dilated, or hang on coarser cells */
    uint32_t level_count;
    lmb_level_record level[LMB_BAKE_LEVELS_MOST]; /* the finest first */
    lmb_placement_stats placement;
    lmb_regions_stats regions;
    uint32_t local_sets;       /* of objects, */
    uint64_t local_probes;     /* and all of their probes */
    lmb_gather_stats gathered; /* of probes */
    lmb_gather_stats lightmap; /* of texels */
    int32_t images;
    uint64_t texels_covered;
    lmb_seam_steps seams_open, seams_closed; /* before and after seams were closed */
    double texels_used;                      /* of the texels of all images, 0 to 1 */
    uint64_t charts;                         /* made here, of all meshes */
    bool surface_solved;                     /* false: the estimator was the reference, and what follows is 0 */
    lmb_surface_light_stats surface;         /* of the light on surfaces */
    size_t surface_bytes;
    float surface_cell_size; /* metres */
    uint64_t rays[LMB_PHASE_COUNT];
    double seconds[LMB_PHASE_COUNT]; /* wall-clock */
    double expected_seconds;         /* of what a plan leaves to do; 0 after a bake */
    /* What follows is of a bake that has been written. */
    double peak_rss_mb; /* of the process */
    uint64_t bytes_vdb, bytes_lmb, bytes_lightmaps;
    uint32_t tiles; /* files beside probes.lmt; 0: not written */
    uint64_t bytes_tiles;
    uint64_t fp16_overflows; /* coefficients of probes.lmb */
} lmb_bake_record;

/* Over all phases. */
uint64_t lmb_bake_record_rays(const lmb_bake_record *record);
/* Millions of rays a second, over the phases that trace. */
double lmb_bake_record_mrays_per_s(const lmb_bake_record *record);
/* Estimated standard error of probes and texels together, relative to their light. */
double lmb_bake_record_error(const lmb_bake_record *record);

/* The list `levels` of bake.json: the caller's. NULL: out of memory. */
struct cJSON *lmb_bake_record_json_levels(const lmb_bake_record *record);

/* The record as bake.json has it, but without `files` and `hashes`: a JSON object. The caller frees it; NULL: out of
 * memory. */
char *lmb_bake_record_text(const lmb_bake_record *record);

#ifdef __cplusplus
}
#endif

#endif
