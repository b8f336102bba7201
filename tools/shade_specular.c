#include "shade_specular.h"

#include <float.h>
#include <string.h>

#include <lambent/vector.h>

#include "model/clipped.h"

specular_light_here specular_light_of_volume(const lmb_transport *transport, const lmb_volume *volume,
                                             const lmb_gather_point *point)
{
    specular_light_here light;
    const lmb_vec3d position = lmb_scene_to_world(lmb_tracer_scene(transport->tracer), point->position);
    light.keys.count = lmb_volume_key_lights(volume, light.keys.light);
    lmb_volume_sample_with_keys(volume, position, &light.radiance, light.keys.visibility);
    light.lampless = light.radiance;
    lamps_take(transport->emitters, point->position, &point->normal, &light.lampless, &light.lamps);
    light.around = light.lampless;
    return light;
}

specular_light_here specular_light_of_lightmap(const lmb_transport *transport, const lmb_volume *volume,
                                               const lmb_lightmap *lightmap, const lmb_hit *hit,
                                               const lmb_gather_point *point)
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    specular_light_here light = {.lamps.present = false};
    if (volume) {
        light = specular_light_of_volume(transport, volume, point);
    }
    light.keys.count = lmb_scene_key_lights(lightmap->scene, light.keys.light);
    lmb_lightmap_sample(lightmap, hit, channel);
    lmb_lightmap_sample_keys(lightmap, hit, light.keys.visibility);
    lightmap->model->radiance(channel, point->normal, &light.radiance);
    /* A lamp is as plain as among probes in harmonics of what the hemisphere lets through. */
    lmb_sh3_rgb clipped = lmb_clipped_sh3_rgb(&light.radiance, point->normal, 0.0f);
    lamps_take(transport->emitters, point->position, &point->normal, &clipped, &light.lamps);
    light.lampless = lmb_unclipped_sh3_rgb(&clipped, point->normal);
    light.around = volume ? light.around : light.lampless;
    return light;
}

/* The highlight of the dominant light, which is taken out of the harmonics. */
static lmb_rgb dominant_highlight(const specular_place *place, lmb_sh3_rgb *radiance)
{
    const lmb_key_light dominant = lmb_sh3_rgb_dominant_light(radiance);
    lmb_key_light_add_to_sh3(&dominant, -1.0f, radiance);
    return lmb_specular_light(&dominant, 1.0f, &place->specular, place->point.normal, place->normal, place->view);
}

/* Of `count` lights. */
static lmb_rgb highlights(const specular_place *place, const lmb_key_light *light, const float *visibility,
                          uint32_t count)
{
    lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
    for (uint32_t i = 0; i < count; ++i) {
        sum = lmb_rgb_add(sum, lmb_specular_light(&light[i], visibility[i], &place->specular, place->point.normal,
                                                  place->normal, place->view));
    }
    return sum;
}

static lmb_rgb mapped(const lmb_sh3_rgb *radiance, const specular_place *place, const map_here *map)
{
    const lmb_vec3 view = place->view, normal = place->normal;
    const lmb_vec3 mirrored = lmb_vec3_mad(lmb_vec3_scale(view, -1.0f), normal, 2.0f * lmb_vec3_dot(normal, view));
    const lmb_vec3 direction = lmb_specular_proxy_direction(&map->proxy, place->point.position, mirrored);
    const lmb_rgb texel = cube_map_look(map->map, direction, place->specular.roughness);
    return lmb_specular_environment(texel, radiance, &place->specular, normal, view);
}

/* How much of the environment map is taken in place of the area layer. */
static float map_share(specular_layers layers, float roughness)
{
    const float share = (SPECULAR_AREA_FROM - roughness) / (SPECULAR_AREA_FROM - SPECULAR_MAP_UP_TO);
    return layers == LAYERS_ENVIRONMENT ? 1.0f : layers == LAYERS_ALL ? lmb_saturate(share) : 0.0f;
}

lmb_rgb specular_reflected(specular_layers layers, const specular_light_here *light, const specular_place *place,
                           const map_here *map)
{
    if (layers == LAYERS_NONE) {
        return (lmb_rgb){{0.0f, 0.0f, 0.0f}};
    }
    const bool lamps = light->lamps.present && layers != LAYERS_LAMPLESS && layers != LAYERS_DOMINANT;
    lmb_sh3_rgb rest = lamps ? light->lampless : light->radiance;
    lmb_rgb sum = highlights(place, light->keys.light, light->keys.visibility, light->keys.count);
    if (lamps) {
        sum = lmb_rgb_add(sum, highlights(place, light->lamps.light, light->lamps.visibility, light->lamps.count));
    }
    if (layers == LAYERS_DOMINANT || (light->keys.count == 0 && !lamps)) {
        sum = lmb_rgb_add(sum, dominant_highlight(place, &rest));
    }
    const float share = map ? map_share(layers, place->specular.roughness) : 0.0f;
    if (layers != LAYERS_ANALYTIC && share < 1.0f) {
        const lmb_rgb area = lmb_specular_area(&rest, &place->specular, place->normal, place->view);
        sum = lmb_rgb_add(sum, lmb_rgb_scale(area, 1.0f - share));
    }
    if (share > 0.0f) {
        sum = lmb_rgb_add(sum, lmb_rgb_scale(mapped(&light->around, place, map), share));
    }
    return sum;
}

lmb_rgb radiance_without_keys(const lmb_transport *transport, lmb_vec3 origin, lmb_vec3 direction, uint64_t stream,
                              uint32_t sample)
{
    lmb_hit hit;
    uint64_t rays = 0;
    if (lmb_trace_nearest(transport->tracer, origin, direction, 0.0f, FLT_MAX, &hit)) {
        return lmb_radiance(transport, origin, direction, stream, sample, &rays);
    }
    lmb_environment_seen seen;
    const float *const axes[3] = {&direction.x, &direction.y, &direction.z};
    lmb_emitters_environment_look(transport->emitters, axes, 1, &seen);
    return seen.radiance;
}
