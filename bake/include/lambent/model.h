/* Lighting models: what is made of a hemisphere of light, and how it lights a bumpy surface.
 *
 * One row for each model; everything that bakes, stores, filters or compares them goes through the table and knows none
 * by name. A model is stored as floats, its channels. Those of a model with a use can be filtered; what filtering
 * leaves can be evaluated. Models without a use are there to be compared with, and no file holds them. Rows of what
 * ships with the sampler wrap its functions, so that a file and a game agree bit for bit. */
#ifndef LAMBENT_MODEL_H
#define LAMBENT_MODEL_H

#include <stdbool.h>
#include <stddef.h>

#include <lambent/sh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a model can be made for; a bit each. */
typedef enum lmb_model_use {
    LMB_MODEL_FOR_LIGHTMAP = 1, /* a texel, of SH3 fitted over its hemisphere */
    LMB_MODEL_FOR_SURFACE = 2,  /* a surface that is lit by probes as if by a lightmap */
    LMB_MODEL_FOR_OBJECT = 4,   /* an object that moves among probes */
    LMB_MODEL_FOR_TEXTURE = 8   /* a texel, in compressed textures: every part is light or has a range */
} lmb_model_use;

/* Of models that are I_z at the vertex normal n_v, an ambient weight w and a direction d: the light that a texel stands
 * for, C_a (1 + n_v.n)/2 + C_d max(0, n.d), depends on the normal that it is decoded for, and filtering may make light.
 */
typedef struct lmb_model_direction {
    int weight; /* channel of w; 1 - w is the directional share */
    int first;  /* of the three channels of d, which may be shorter than 1; LMB_MODEL_NO_LENGTH: it is always unit */
    float min_height; /* the lowest n_v.d of which decoding believes all */
    /* C_a, C_d and n_v.d of the light with I(n_v) = 1 that w and d give at a normal. */
    void (*decode)(const float *channel, lmb_vec3 normal, float *ambient, float *directional, float *height);
} lmb_model_direction;

enum { LMB_MODEL_NO_LENGTH = -1 };

/* Channels that belong together, one after the other. */
typedef struct lmb_model_part {
    const char *name;
    int count;
    float low, high; /* the range of channels that are not light; 0, 0: not known */
} lmb_model_part;

enum { LMB_MODEL_MOST_CHANNELS = 33 };

/* Light from one direction: radiance times solid angle. */
typedef struct lmb_directed_light {
    lmb_vec3 direction;
    lmb_rgb weight;
} lmb_directed_light;

typedef struct lmb_model {
    const char *name;       /* in files: what it is made of */
    const char *full_name;  /* among the compared ones, where `name` does not say all; NULL: `name` */
    const char *short_name; /* on the command line; NULL: none */
    const char *title;      /* for people */
    unsigned uses;          /* lmb_model_use; 0: to be compared with */
    unsigned default_uses;  /* of them, those that it is taken for unless told otherwise */
    bool at_run_time;       /* the sampler has it */
    int channel_count;
    int bytes;       /* of a stored texel or probe, as fp16 */
    bool cone;       /* encodes behind a cone, not only behind the hemisphere */
    bool unoccluded; /* light from below the horizon counts as well */

    /* Makes channels of SH3 radiance about unit `vertex_normal`, clipped by a cone about it (cone_cos = 0: the
     * hemisphere). Models without occlusion ignore both. NULL: the model is made of the light itself. */
    void (*encode)(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel);

    /* Makes channels of the light itself, of which what is below the horizon counts for nothing. NULL: of SH3. */
    void (*encode_light)(const lmb_directed_light *light, size_t count, lmb_vec3 vertex_normal, float *channel);

    /* Normalised irradiance at `count` unit normals, >= 0, whatever was filtered. */
    void (*evaluate)(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance);

    /* The rest is of models with a use. */

    const char *const *channel_name;
    const lmb_model_part *part; /* all channels; ended by a count of 0 */
    int light_count;            /* the first channels, which scale with the light: one RGB colour or more */
    bool irradiance_first;      /* the first three are the normalised irradiance at the vertex normal */
    const char *convention;     /* what the channels mean, for a file's header */

    /* lmb_model_average, where it is not the mean of each channel by itself; else NULL. */
    void (*average)(float *channel, float total);

    /* SH3 radiance that is right over the hemisphere of unit `vertex_normal`: what reflections are made of
     * (lambent/specular.h). NULL: the channels say no such thing. */
    void (*radiance)(const float *channel, lmb_vec3 vertex_normal, lmb_sh3_rgb *radiance);

    const lmb_model_direction *direction; /* NULL: filtering makes no light */
} lmb_model;

/* The table. */
size_t lmb_model_count(void);
const lmb_model *lmb_model_at(size_t index);

/* The row of that name, full name or short name: one that can be made for one of `uses` (lmb_model_use), or else any;
 * NULL: none. A lightmap's row and a probe's may share a short name. */
const lmb_model *lmb_model_find(const char *name, unsigned uses);

/* The row of that name if lightmaps can have it; else the one that clips the same by the hemisphere, NAME.gram: what a
 * texel's SH3 says below its horizon means nothing. NULL: none. */
const lmb_model *lmb_model_for_lightmap(const char *name);

/* What a row is called among all. */
const char *lmb_model_full_name(const lmb_model *model);

/* Makes of a sum over several, whose weights come to `total`, what one of them would be. Of models with a use. */
void lmb_model_average(const lmb_model *model, float *channel, float total);

/* What is taken unless told otherwise. */
const lmb_model *lmb_model_default(lmb_model_use use);

#ifdef __cplusplus
}
#endif

#endif
