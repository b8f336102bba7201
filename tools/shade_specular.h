/* What surfaces of a picture reflect beside their diffuse light, of what a bake stored. */
#ifndef LMB_TOOLS_SHADE_SPECULAR_H
#define LMB_TOOLS_SHADE_SPECULAR_H

#include <lambent/lightmap.h>
#include <lambent/volume.h>

#include "environment_maps.h"
#include "glossy.h"
#include "key_lights_seen.h"
#include "lamps_seen.h"

/* The layers of lambent/specular.h together. */
typedef enum specular_layers {
    LAYERS_NONE,
    LAYERS_ANALYTIC,    /* key lights and lamps, or, where the level has neither, the dominant light */
    LAYERS_AREA,        /* and the area layer of what remains */
    LAYERS_LAMPLESS,    /* the same without lamps, which stay in the area layer */
    LAYERS_DOMINANT,    /* in place of lamps the dominant light of what is not key lights */
    LAYERS_ENVIRONMENT, /* key lights, lamps and environment maps in place of the area layer */
    LAYERS_ALL, /* either by the roughness: the map up to SPECULAR_MAP_UP_TO, the area layer from SPECULAR_AREA_FROM
                   on, and something of both between */
    LAYERS_COUNT
} specular_layers;

#define SPECULAR_MAP_UP_TO 0.1f
#define SPECULAR_AREA_FROM 0.2f

/* The light at a place that layers are made of. */
typedef struct specular_light_here {
    lmb_sh3_rgb radiance; /* without the key lights */
    key_lights_seen keys;
    lamps_seen lamps;
    lmb_sh3_rgb lampless; /* without these too */
    lmb_sh3_rgb around;   /* the same of probes, whatever `radiance` is of: environment maps are over that */
} specular_light_here;

/* By probes at a point of the transport's scene. */
specular_light_here specular_light_of_volume(const lmb_transport *transport, const lmb_volume *volume,
                                             const lmb_gather_point *point);

/* By the texels at a hit, of a lightmap whose model has the radiance. Without a volume (NULL) they count as what is
 * around, too. */
specular_light_here specular_light_of_lightmap(const lmb_transport *transport, const lmb_volume *volume,
                                               const lmb_lightmap *lightmap, const lmb_hit *hit,
                                               const lmb_gather_point *point);

/* What is reflected by those layers. `map` is the place's environment map; without (NULL) the area layer stands for it.
 */
lmb_rgb specular_reflected(specular_layers layers, const specular_light_here *light, const specular_place *place,
                           const map_here *map);

/* Radiance from a direction, without a sun that was taken out of the environment's picture. */
lmb_rgb radiance_without_keys(const lmb_transport *transport, lmb_vec3 origin, lmb_vec3 direction, uint64_t stream,
                              uint32_t sample);

#endif
