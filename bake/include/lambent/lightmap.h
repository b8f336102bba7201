/* Lightmaps: where each instance's texels are, what light they hold, and the files.
 *
 * Every static instance with triangles owns a rectangle of texels in one of a few images. Its UVs are the mesh's
 * TEXCOORD_1 where that is good (lambent/chart.h), else charts made here. The layout depends on the scene and the
 * settings alone, so it can always be made again; docs/formats.md describes the files. */
#ifndef LAMBENT_LIGHTMAP_H
#define LAMBENT_LIGHTMAP_H

#include <lambent/chart.h>
#include <lambent/gather_elements.h>
#include <lambent/key_lights.h>
#include <lambent/model.h>
#include <lambent/surface.h>
#include <lambent/uv_check.h>
#include <lambent/warning.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LMB_LIGHTMAP_MAX_PADDING = 64, LMB_LIGHTMAP_MOST_MODELS = 16 };

/* What a lightmap's images are written as. */
typedef enum lmb_lightmap_format {
    LMB_LIGHTMAP_EXR,
    LMB_LIGHTMAP_KTX2,      /* block-compressed textures, with mip levels as the padding allows */
    LMB_LIGHTMAP_DDS,       /* the same in other files */
    LMB_LIGHTMAP_KTX2_ASTC, /* ASTC in KTX2, for mobile hardware; where the build has it */
    LMB_LIGHTMAP_FORMATS
} lmb_lightmap_format;

/* "exr", "ktx2", "dds", "ktx2-astc". */
const char *lmb_lightmap_format_name(lmb_lightmap_format format);

typedef struct lmb_lightmap_settings {
    float texels_per_m;     /* > 0; lowered for instances that would not fit an image */
    int32_t max_image_size; /* texels along a side, a power of two */
    int32_t padding;        /* texels around each region and each chart made here that are filled from within, up to
                               LMB_LIGHTMAP_MAX_PADDING: one is what bilinear filtering reads, each mip level doubles
                               that. 0 counts as 1 */
    lmb_warnings warnings;  /* UVs that are not used, densities that do not fit, islands of a few texels */
    lmb_lightmap_format format;
    const lmb_model *model;                           /* that texels are stored in; NULL: the format's default one */
    const lmb_model *other[LMB_LIGHTMAP_MOST_MODELS]; /* that they are stored in too, up to the first NULL; in
                                                         EXR where textures do not hold them */
    bool error;                                       /* the standard error of each texel, too */
    lmb_pool *pool; /* that lays out, and compresses textures; NULL: the caller's thread */
} lmb_lightmap_settings;

/* Texels per metre from the level's size, for about a million texels at most; max_image_size 2048, padding 1. */
lmb_lightmap_settings lmb_lightmap_settings_default(const lmb_scene *scene);

/* One instance's place. A corner at (u, v) of the mesh's lightmap UVs lies at (u, v) * scale + offset of the image,
 * both in [0, 1]; pixel (x, y) covers [x, x + 1) / width, rows downwards as v grows. */
typedef struct lmb_lightmap_region {
    int32_t image;               /* -1: this instance has no lightmap (dynamic, or no triangles) */
    int32_t x, y, width, height; /* texels */
    lmb_vec2 offset;
    lmb_vec2 scale;
    float texel_size; /* metres, the mean over the instance; 0 without a lightmap */
    bool back; /* baked on the side that the winding calls back: lmb_tracer_is_turned. Known once baked or read */
} lmb_lightmap_region;

/* One image of texels. */
typedef struct lmb_lightmap_image {
    int32_t width, height;
    float *plane;   /* [channel][x + width y] of the lightmap's model, then [key light] what is seen of it, 0 to 1; 0
                       until   baked or read */
    uint8_t *state; /* [x + width y] lmb_texel_state */
    float *other[LMB_LIGHTMAP_MOST_MODELS]; /* as `plane`, of the other models */
    float *error; /* [x + width y] standard error of what was gathered, relative to it or 1 % of the root mean square if
                     that is more; NULL: not asked for */
} lmb_lightmap_image;

typedef enum lmb_texel_state { LMB_TEXEL_EMPTY, LMB_TEXEL_GATHERED, LMB_TEXEL_DILATED } lmb_texel_state;

/* Steps of light, key lights' too, across seams, where charts meet on a smooth surface: relative to the light there, or
 * to 1 % of the mean where that is more; over points a texel apart. 0 where there are none. */
typedef struct lmb_seam_steps {
    size_t edges;
    double median;
    double p95;
} lmb_seam_steps;

typedef struct lmb_lightmap {
    const lmb_scene *scene;
    lmb_lightmap_settings settings;
    const lmb_model *model;
    uint32_t key_light_count; /* those of the scene; the model's channels hold the rest of the light */
    lmb_key_light key_light[LMB_KEY_LIGHTS_MOST];
    lmb_lightmap_region *region; /* [instance] */
    lmb_vec2 **corner_uv;        /* [mesh] charts made here: [3 * triangle + corner], or NULL: the mesh's TEXCOORD_1 */
    lmb_uv_fault *fault;         /* [mesh] why charts were made, LMB_UV_GOOD when they were not */
    lmb_lightmap_image *image;
    int32_t image_count;
    uint64_t covered_texel_count; /* texels that a triangle touches */
    lmb_seam_steps open, closed;  /* before and after its seams were closed; once finished */
    uint64_t chart_count;         /* charts made here, of all meshes; nodes with one mesh share them */
} lmb_lightmap;

/* Covered texels as a share of the texels of all images, 0 to 1: 0 without images. */
static inline double lmb_lightmap_texels_used(const lmb_lightmap *lightmap)
{
    double texels = 0.0;
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        texels += (double)lightmap->image[i].width * (double)lightmap->image[i].height;
    }
    return texels > 0.0 ? (double)lightmap->covered_texel_count / texels : 0.0;
}

/* Lays out the lightmap of a scene, without light. The scene must outlive it. @return LMB_ERROR_MEMORY, _ARGUMENT,
 * _UNSUPPORTED (too many texels for any layout) */
lmb_result lmb_lightmap_create(const lmb_scene *scene, const lmb_lightmap_settings *settings, lmb_lightmap **lightmap,
                               lmb_error *error);
void lmb_lightmap_destroy(lmb_lightmap *lightmap);

/* The texels that a triangle touches, to be gathered at over their hemispheres: each over its area, or, where a
 * triangle covers part of it, over that. Lightmap and tracer must outlive the list. @return LMB_ERROR_MEMORY */
typedef struct lmb_texel_list lmb_texel_list;
lmb_result lmb_texel_list_create(const lmb_lightmap *lightmap, const lmb_transport *transport,
                                 const lmb_gather_effort *effort, lmb_texel_list **list);
void lmb_texel_list_destroy(lmb_texel_list *list);

/* To be gathered at. */
lmb_gather_list lmb_texel_list_elements(const lmb_texel_list *list);

/* Takes noise off what was gathered (lambent/denoise.h), [covered_texel_count] in the list's order.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_texel_list_denoise(const lmb_texel_list *list, lmb_pool *pool, const lmb_progress *progress,
                                  lmb_gathered *gathered);

/* Fits SH3 to what was gathered, [covered_texel_count] in the list's order, encodes it by the model into the list's
 * lightmap, dilates into the padding, and closes seams. @return LMB_ERROR_MEMORY */
lmb_result lmb_texel_list_finish(const lmb_texel_list *list, const lmb_gathered *gathered, lmb_pool *pool,
                                 lmb_lightmap *lightmap);

/* Gathers with that effort at every covered texel, and finishes: a lightmap without denoising.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_lightmap_bake(lmb_lightmap *lightmap, const lmb_transport *transport, const lmb_gather_effort *effort,
                             lmb_pool *pool, const lmb_progress *progress, lmb_gather_stats *stats);

/* The surface point whose light stands for a point of a triangle, pushed out of geometry that it starts inside of: the
 * gather point of texels, and of checks against them. `radius` is the texel's size in metres. */
lmb_gather_point lmb_surface_gather_point(const lmb_tracer *tracer, const lmb_place *place, float radius,
                                          bool *pushed_out);

/* Planes of each image. */
static inline int lmb_lightmap_plane_count(const lmb_lightmap *lightmap)
{
    return lightmap->model->channel_count + (int)lightmap->key_light_count;
}

/* One of them. */
static inline float *lmb_lightmap_plane(const lmb_lightmap_image *image, int channel)
{
    return image->plane + (size_t)channel * (size_t)image->width * (size_t)image->height;
}

/* The stored texels at a hit, filtered bilinearly: the model's channels, to be evaluated. All 0, and false, where the
 * instance has none. */
bool lmb_lightmap_sample(const lmb_lightmap *lightmap, const lmb_hit *hit, float channel[LMB_MODEL_MOST_CHANNELS]);

/* What the texels have seen of each key light, filtered likewise. All 0, and false, where the instance has none. */
bool lmb_lightmap_sample_keys(const lmb_lightmap *lightmap, const lmb_hit *hit, float visibility[LMB_KEY_LIGHTS_MOST]);

/* What is left of steps across seams. @return LMB_ERROR_MEMORY */
lmb_result lmb_lightmap_seam_steps(const lmb_lightmap *lightmap, const lmb_tracer *tracer, lmb_seam_steps *steps);

/* The column and row of the texel at a hit, in the instance's image. False, and nothing written, where the instance has
 * none. */
bool lmb_lightmap_texel(const lmb_lightmap *lightmap, const lmb_hit *hit, int32_t *column, int32_t *row);

/* Writes lightmap_N.exr, the irradiance at the vertex normal as a picture, and lightmap_N_MODEL.exr, what else each
 * model has, for each image, or textures in their place (docs/formats.md), lightmap.json, and, when charts were made,
 * `level_uv2.glb` (the level with the new UVs, through lmb_gltf_write_with_uvs), into folder `directory`. `*bytes` gets
 * their sum.
 * @return LMB_ERROR_WRITE, _MEMORY */
struct lmb_gltf_options;
lmb_result lmb_lightmap_write(const lmb_lightmap *lightmap, const char *directory,
                              const struct lmb_gltf_options *options, uint64_t *bytes, lmb_error *error);

/* Fills the images of a freshly created lightmap from the files in `directory`, of its own model alone; lightmap.json
 * must describe the same layout. @return LMB_ERROR_IO, _FORMAT (another layout), _MEMORY */
lmb_result lmb_lightmap_read(lmb_lightmap *lightmap, const char *directory, lmb_error *error);

/* The same of another model that was written beside its own, which becomes the lightmap's. @return LMB_ERROR_FORMAT,
 * too, where it was not; the lightmap is then as it was */
lmb_result lmb_lightmap_read_model(lmb_lightmap *lightmap, const lmb_model *model, const char *directory,
                                   lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
