#include "shade.h"

#include <float.h>

#include <lambent/hhd.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

#include "key_lights_seen.h"
#include "replicates.h"
#include "shade_specular.h"

enum { MAX_LAYERS = 64 }; /* see-through surfaces along one ray */
/* What is left of a ray below this share cannot be seen in 8 bits. */
#define MIN_SHARE (1.0f / 1024.0f)

static const lmb_rgb black = {{0.0f, 0.0f, 0.0f}};

/* A surface that the camera sees, turned towards it. */
typedef struct seen_surface {
    const lmb_render_object *object; /* NULL: the level's own */
    const lmb_tracer *tracer;
    lmb_hit hit;
    lmb_place place; /* in the level's space */
    bool back;       /* seen from behind */
    lmb_vec3 normal; /* shading normal, by the normal map */
    lmb_surface surface;
    lmb_rgb emission;
} seen_surface;

static bool seen_nearest(const lmb_shader *shader, lmb_vec3 origin, lmb_vec3 direction, float start, seen_surface *seen)
{
    *seen = (seen_surface){.tracer = shader->transport->tracer};
    bool found = lmb_trace_nearest(seen->tracer, origin, direction, start, FLT_MAX, &seen->hit);
    for (int i = 0; i < shader->object_count; ++i) {
        const lmb_render_object *object = &shader->objects[i];
        const float far_distance = found ? seen->hit.distance : FLT_MAX;
        lmb_hit hit;
        if (lmb_trace_nearest(object->tracer, lmb_vec3_sub(origin, object->position), direction, start, far_distance,
                              &hit)) {
            found = true;
            seen->object = object;
            seen->tracer = object->tracer;
            seen->hit = hit;
        }
    }
    return found;
}

/* Fills in what is at the hit. */
static void seen_complete(seen_surface *seen, lmb_vec3 direction)
{
    const lmb_hit *hit = &seen->hit;
    const lmb_mesh_point point = lmb_trace_mesh_point(seen->tracer, hit);
    seen->surface = lmb_material_surface(&point);
    seen->emission = lmb_material_emission(&point);
    seen->place = lmb_trace_place(seen->tracer, hit);
    seen->back = lmb_vec3_dot(seen->place.geometric_normal, direction) > 0.0f;
    if (seen->back) {
        seen->place.geometric_normal = lmb_vec3_scale(seen->place.geometric_normal, -1.0f);
        seen->place.shading_normal = lmb_vec3_scale(seen->place.shading_normal, -1.0f);
    }
    seen->normal = lmb_trace_mapped_normal(seen->tracer, hit, &seen->place);
    if (seen->object) {
        seen->place.position = lmb_vec3_add(seen->place.position, seen->object->position);
    }
}

/* Where light is looked up or gathered: as checks do it. */
static lmb_gather_point seen_point(const lmb_shader *shader, const seen_surface *seen)
{
    if (seen->object) {
        const lmb_vec3 normal = seen->place.geometric_normal;
        const float rounding = fmaxf(seen->place.rounding, lmb_trace_epsilon(seen->place.position));
        const lmb_vec3 position = lmb_trace_offset(seen->place.position, normal, rounding, normal);
        return (lmb_gather_point){.position = position, .hemisphere = true, .normal = seen->place.shading_normal};
    }
    const lmb_lightmap *const lightmap = shader->lightmap;
    const float texel = lightmap && lightmap->region[seen->hit.instance].image >= 0
                            ? lightmap->region[seen->hit.instance].texel_size
                            : shader->default_texel;
    bool pushed_out;
    return lmb_surface_gather_point(shader->transport->tracer, &seen->place, texel, &pushed_out);
}

/* Irradiance at the shading normal, and at n_v for the self-bounce. */
typedef struct arriving_light {
    lmb_rgb irradiance;
    lmb_rgb irradiance_z;
} arriving_light;

static arriving_light light_of_channels(const lmb_model *model, const float *channel, const key_lights_seen *keys,
                                        lmb_vec3 vertex_normal, const seen_surface *seen)
{
    const lmb_vec3 normals[2] = {seen->normal, vertex_normal};
    lmb_rgb irradiance[2];
    model->evaluate(channel, vertex_normal, normals, 2, irradiance);
    return (arriving_light){key_lights_add(keys, vertex_normal, normals[0], irradiance[0]),
                            key_lights_add(keys, vertex_normal, normals[1], irradiance[1])};
}

static arriving_light light_of_lightmap(const lmb_shader *shader, const seen_surface *seen)
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    key_lights_seen keys;
    keys.count = lmb_scene_key_lights(shader->lightmap->scene, keys.light);
    lmb_lightmap_sample(shader->lightmap, &seen->hit, channel);
    lmb_lightmap_sample_keys(shader->lightmap, &seen->hit, keys.visibility);
    return light_of_channels(shader->lightmap->model, channel, &keys, seen->place.shading_normal, seen);
}

static bool is_lit_locally(const lmb_shader *shader, const seen_surface *seen)
{
    return !seen->object && shader->local &&
           local_light_has(shader->local, lmb_tracer_scene(shader->transport->tracer), seen->hit.instance);
}

static arriving_light light_of_local_set(const lmb_shader *shader, const seen_surface *seen)
{
    const lmb_gather_point point = seen_point(shader, seen);
    const lmb_model *model = lmb_model_default(LMB_MODEL_FOR_SURFACE);
    const lmb_scene *scene = lmb_tracer_scene(shader->transport->tracer);
    lmb_sh3_rgb radiance;
    float channel[LMB_MODEL_MOST_CHANNELS];
    key_lights_seen keys;
    local_light_sample(shader->local, seen->hit.instance, lmb_scene_to_world(scene, point.position), &radiance, &keys);
    model->encode(&radiance, point.normal, 0.0f, channel);
    return light_of_channels(model, channel, &keys, point.normal, seen);
}

/* Objects take the model of dynamic things and surfaces that of lightmaps, unless one is named. */
static arriving_light light_of_probes(const lmb_shader *shader, const seen_surface *seen)
{
    if (!shader->volume) {
        return (arriving_light){black, black};
    }
    const lmb_gather_point point = seen_point(shader, seen);
    const lmb_model *own = lmb_model_default(seen->object ? LMB_MODEL_FOR_OBJECT : LMB_MODEL_FOR_SURFACE);
    const lmb_model *model = shader->probe_model ? shader->probe_model : own;
    const lmb_scene *scene = lmb_tracer_scene(shader->transport->tracer);
    lmb_sh3_rgb radiance;
    float channel[LMB_MODEL_MOST_CHANNELS];
    key_lights_seen keys;
    keys.count = lmb_volume_key_lights(shader->volume, keys.light);
    lmb_volume_sample_with_keys(shader->volume, lmb_scene_to_world(scene, point.position), &radiance, keys.visibility);
    model->encode(&radiance, point.normal, 0.0f, channel);
    return light_of_channels(model, channel, &keys, point.normal, seen);
}

static arriving_light light_of_reference(const lmb_shader *shader, const seen_surface *seen)
{
    const lmb_gather_point point = seen_point(shader, seen);
    const lmb_vec3 normals[2] = {seen->normal, point.normal};
    lmb_rgb irradiance[2];
    uint64_t rays = 0;
    const lmb_gather_samples samples = {
        .points = &point, .point_count = 1, .replicate = REPLICATES_RENDER, .count = shader->reference_samples};
    lmb_gather_irradiance(shader->transport, &samples, normals, 2, irradiance, &rays);
    return (arriving_light){irradiance[0], irradiance[1]};
}

static bool has_texels(const lmb_shader *shader, const seen_surface *seen)
{
    return !seen->object && !seen->back && shader->lightmap && shader->lightmap->region[seen->hit.instance].image >= 0;
}

/* One square for each texel, light and dark by turns. */
static lmb_rgb texel_colour(const lmb_shader *shader, const seen_surface *seen)
{
    static const lmb_rgb light = {{0.8f, 0.8f, 0.8f}}, dark = {{0.2f, 0.2f, 0.2f}}, none = {{0.5f, 0.1f, 0.05f}};
    int32_t column = 0, row = 0;
    if (!has_texels(shader, seen) || !lmb_lightmap_texel(shader->lightmap, &seen->hit, &column, &row)) {
        return none;
    }
    return ((column + row) & 1) != 0 ? light : dark;
}

/* Unlit surfaces take no light: they show their base colour. */
static bool seen_unlit_colour(const seen_surface *seen, lmb_rgb *colour)
{
    const lmb_mesh_point point = lmb_trace_mesh_point(seen->tracer, &seen->hit);
    if (!lmb_material_at(&point)->unlit) {
        return false;
    }
    float base[4];
    lmb_material_base_color(&point, base);
    *colour = (lmb_rgb){{base[0], base[1], base[2]}};
    return true;
}

/* How it reflects, if it does: `*diffuse` gets the share of its base colour that is left of it. */
static bool seen_reflects(const lmb_shader *shader, const seen_surface *seen, lmb_specular *specular, float *diffuse)
{
    *diffuse = 1.0f;
    if (shader->by_materials) {
        const lmb_mesh_point point = lmb_trace_mesh_point(seen->tracer, &seen->hit);
        const lmb_reflection reflection = lmb_material_reflection(&point);
        *specular = (lmb_specular){reflection.slope, reflection.f0};
        *diffuse = reflection.diffuse;
        return true;
    }
    if (shader->specular && seen->object) {
        *specular = *shader->specular;
        return true;
    }
    return false;
}

/* By the light that is stored: a lightmap's harmonics, or those of probes. */
static lmb_rgb stored_specular(const lmb_shader *shader, lmb_light_source source, const seen_surface *seen,
                               const specular_place *place)
{
    specular_light_here light;
    if (source == SOURCE_STORED && has_texels(shader, seen) && shader->lightmap->model->radiance) {
        light = specular_light_of_lightmap(shader->transport, shader->maps ? shader->volume : NULL, shader->lightmap,
                                           &seen->hit, &place->point);
    } else if (shader->volume) {
        light = specular_light_of_volume(shader->transport, shader->volume, &place->point);
    } else {
        return black;
    }
    if (!shader->maps) {
        return specular_reflected(LAYERS_ALL, &light, place, NULL);
    }
    const map_here map = environment_maps_find(shader->maps, shader->transport->tracer, place->point.position);
    return specular_reflected(LAYERS_ALL, &light, place, &map);
}

static arriving_light seen_light(const lmb_shader *shader, lmb_light_source source, const seen_surface *seen)
{
    if (source == SOURCE_REFERENCE) {
        return light_of_reference(shader, seen);
    }
    if (source == SOURCE_STORED && has_texels(shader, seen)) {
        return light_of_lightmap(shader, seen);
    }
    return source == SOURCE_STORED && is_lit_locally(shader, seen) ? light_of_local_set(shader, seen)
                                                                   : light_of_probes(shader, seen);
}

static lmb_rgb seen_radiance(const lmb_shader *shader, lmb_light_source source, const seen_surface *seen,
                             lmb_vec3 direction)
{
    if (source == SOURCE_TEXELS) {
        return texel_colour(shader, seen);
    }
    lmb_rgb unlit;
    if (!shader->irradiance_only && seen_unlit_colour(seen, &unlit)) {
        return unlit;
    }
    const arriving_light light = seen_light(shader, source, seen);
    if (shader->irradiance_only) {
        return light.irradiance;
    }
    specular_place place;
    float diffuse;
    lmb_rgb own = seen->emission;
    if (seen_reflects(shader, seen, &place.specular, &diffuse)) {
        place.point = seen_point(shader, seen);
        place.normal = seen->normal;
        place.view = lmb_vec3_scale(direction, -1.0f);
        own = lmb_rgb_add(own, source == SOURCE_REFERENCE
                                   ? glossy_radiance(shader->transport, &place, shader->reference_samples, 0)
                                   : stored_specular(shader, source, seen, &place));
    }
    const lmb_rgb albedo = lmb_rgb_scale(seen->surface.albedo, diffuse);
    const lmb_rgb bounce = lmb_self_bounce(albedo, light.irradiance_z, seen->place.shading_normal, seen->normal);
    return lmb_rgb_add(lmb_rgb_mul(albedo, lmb_rgb_add(light.irradiance, bounce)), own);
}

/* Whether a probe's sphere is nearer than a surface. */
static bool sphere_before(const lmb_shader *shader, lmb_vec3 origin, lmb_vec3 direction, float start, float distance,
                          lmb_rgb *colour)
{
    if (!shader->spheres) {
        return false;
    }
    const lmb_vec3d world = lmb_scene_to_world(lmb_tracer_scene(shader->transport->tracer), origin);
    return probe_spheres_nearest(shader->spheres, world, direction, start, &distance, colour);
}

lmb_rgb shade_ray(const lmb_shader *shader, lmb_light_source source, lmb_vec3 origin, lmb_vec3 direction)
{
    lmb_rgb radiance = black;
    lmb_rgb share = {{1.0f, 1.0f, 1.0f}};
    float start = 0.0f;
    for (int layer = 0; layer < MAX_LAYERS; ++layer) {
        seen_surface seen;
        const bool found = seen_nearest(shader, origin, direction, start, &seen);
        lmb_rgb sphere;
        if (sphere_before(shader, origin, direction, start, found ? seen.hit.distance : FLT_MAX, &sphere)) {
            return lmb_rgb_add(radiance, lmb_rgb_mul(share, sphere));
        }
        if (!found) {
            const lmb_rgb sky = lmb_emitters_environment_shown(shader->transport->emitters, direction);
            return lmb_rgb_add(radiance, lmb_rgb_mul(share, sky));
        }
        seen_complete(&seen, direction);
        if (seen.surface.coverage.opacity > 0.0f) {
            const lmb_rgb own =
                lmb_rgb_scale(seen_radiance(shader, source, &seen, direction), seen.surface.coverage.opacity);
            radiance = lmb_rgb_add(radiance, lmb_rgb_mul(share, own));
        }
        share = lmb_rgb_mul(share, seen.surface.coverage.pass);
        if (!(lmb_rgb_max(share) > MIN_SHARE)) {
            break;
        }
        start = lmb_trace_beyond(seen.hit.distance);
    }
    return radiance;
}
