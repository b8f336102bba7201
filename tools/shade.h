/* What a camera ray sees in a baked level, lit by what the bake stored, or by the truth. */
#ifndef LMB_TOOLS_SHADE_H
#define LMB_TOOLS_SHADE_H

#include <lambent/lightmap.h>
#include <lambent/model.h>
#include <lambent/specular.h>
#include <lambent/volume.h>

#include "environment_maps.h"
#include "local_light.h"
#include "probe_spheres.h"
#include "render_object.h"

typedef enum lmb_light_source {
    SOURCE_STORED,    /* surfaces by lightmaps, or their local sets; where there are neither (and on back sides) by
                         probes; objects by probes */
    SOURCE_PROBES,    /* everything by probes */
    SOURCE_REFERENCE, /* everything by the path tracer */
    SOURCE_TEXELS     /* no light: a checker of the lightmap's texels, and another colour where there are none */
} lmb_light_source;

/* What is looked at. The pointers must outlive every call; nothing is written. */
typedef struct lmb_shader {
    const lmb_transport *transport;
    const lmb_volume *volume;     /* NULL: none; what it would light is black */
    const lmb_model *probe_model; /* by which probes light; NULL: surfaces and objects by the default of each */
    const lmb_lightmap *lightmap; /* NULL: none */
    const local_light *local;     /* what lights nodes that want it in place of texels; NULL: nothing does */
    const lmb_render_object *objects;
    int object_count;
    const probe_spheres *spheres; /* NULL: none */
    float default_texel;          /* metres: a texel's size where there are no lightmaps */
    bool irradiance_only;         /* show irradiance as on white paper: no albedo, emission or self-bounce */
    const lmb_specular *specular; /* how objects reflect beside their diffuse light; NULL: not at all */
    bool by_materials;            /* everything reflects, as its material says */
    const environment_maps *maps; /* of reflections; NULL: none */
    uint32_t reference_samples;   /* of SOURCE_REFERENCE, for each surface seen */
} lmb_shader;

/* Radiance (or irradiance) along a ray from `origin` in unit `direction`, through see-through surfaces. Two sources see
 * exactly the same surfaces along one ray. */
lmb_rgb shade_ray(const lmb_shader *shader, lmb_light_source source, lmb_vec3 origin, lmb_vec3 direction);

#endif
