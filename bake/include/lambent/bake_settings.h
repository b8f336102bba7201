/* What a bake is to make: every setting that decides its bytes. */
#ifndef LAMBENT_BAKE_SETTINGS_H
#define LAMBENT_BAKE_SETTINGS_H

#include <lambent/bake_level.h>
#include <lambent/lightmap.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LMB_BAKE_MAX_SEEDS = 64 };

/* Values, as lmb_level_settings are: copy them by assignment. */
typedef struct lmb_bake_settings {
    lmb_level_settings level;
    lmb_estimator estimator;
    /* Probes: see lmb_placement_settings. */
    float spacing; /* metres, of the coarsest level; 0: from the level's size */
    float
        min_spacing;  /* metres: levels of half the spacing each, as far as none is less than this; 0: one even level */
    double tolerance; /* of interpolation, relative: decides where levels are */
    bool placed_by_all; /* levels are where the light of all sets wants them, rather than that of level.light_set: so
                           that the volumes of all sets have the same probes */
    int32_t max_probes;
    lmb_vec3d seeds[LMB_BAKE_MAX_SEEDS]; /* in the world */
    uint32_t seed_count;
    bool no_probes;   /* lightmaps alone */
    bool compact;     /* probes.lmb is of compact probes: lmb_pack_as */
    double tile_size; /* metres: the volume in tiles too, probes.lmt and its tiles (lmb_tile_files_write); 0: none */
    /* Effort: see lmb_gather_effort. */
    uint32_t samples; /* at each probe and texel; at least, if max_samples is more */
    uint32_t max_samples;
    double noise; /* relative standard error that ends an element's sampling */
    /* Lightmaps: see lmb_lightmap_settings; 0: as lmb_lightmap_settings_default has it. */
    bool lightmaps;
    lmb_lightmap_format lightmap_format;
    float texels_per_m;
    int32_t max_image_size;
    int32_t padding;
    const lmb_model *models[LMB_LIGHTMAP_MOST_MODELS]; /* beside the default one, up to the first NULL */
    bool texel_error;                                  /* the standard error of each texel, too */
    float detail; /* share of the level's own densities along a line, where spacing or texels_per_m is 0: half in a
                     draft; 0 counts as 1 */
    bool denoise; /* lambent/denoise.h; never of LMB_ESTIMATOR_REFERENCE */
} lmb_bake_settings;

/* Medium quality, no lightmaps, the level's own spacing and density, denoised; no level. */
lmb_bake_settings lmb_bake_settings_default(void);

/* Samples, noise and detail of "draft", "medium" or "high"; false, and nothing is written, for any other name. */
bool lmb_bake_settings_quality(lmb_bake_settings *settings, const char *name);

/* "exr", "ktx2", "dds" or "ktx2-astc"; false, and nothing is written, for any other name. */
bool lmb_bake_settings_lightmap_format(lmb_bake_settings *settings, const char *name);

/* The model that lightmaps are in, whatever others they are in too: the format's default one. */
const lmb_model *lmb_bake_settings_model(const lmb_bake_settings *settings);

/* Lightmaps in that model too, by its name or short name; the default one is always among them. False: no lightmap has
 * it, or there are too many. */
bool lmb_bake_settings_add_model(lmb_bake_settings *settings, const char *name);

#ifdef __cplusplus
}
#endif

#endif
