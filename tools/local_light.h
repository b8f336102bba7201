/* The local sets of a volume as tools light a level by them: all probes read once, found by instances. */
#ifndef LMB_TOOLS_LOCAL_LIGHT_H
#define LMB_TOOLS_LOCAL_LIGHT_H

#include <stdbool.h>

#include <lambent/error.h>
#include <lambent/local_set.h>
#include <lambent/scene.h>

#include "key_lights_seen.h"

typedef struct local_light_set {
    lmb_local_frame frame;
    lmb_sh3_rgb *radiance; /* [probe] */
    float (*visibility)[LMB_KEY_LIGHTS_MOST];
} local_light_set;

typedef struct local_light {
    uint32_t count;
    local_light_set *set;
    int32_t *of_instance; /* [instance of the scene] its set, or -1 */
    uint32_t key_count;
    lmb_key_light key[LMB_KEY_LIGHTS_MOST];
} local_light;

/* `volume` may be NULL: then no instance has a set. @return LMB_ERROR_MEMORY */
lmb_result local_light_open(const lmb_volume *volume, const lmb_scene *scene, local_light *opened);
void local_light_close(local_light *closed);

/* Whether the level wants an instance to be lit by its set in place of texels, and there is one. */
bool local_light_has(const local_light *local, const lmb_scene *scene, uint32_t instance);

/* The light of an instance's set at a place in the world. */
void local_light_sample(const local_light *local, uint32_t instance, lmb_vec3d position, lmb_sh3_rgb *radiance,
                        key_lights_seen *keys);

#endif
