#include <lambent/scene_content.h>

#include <lambent/file.h>

const char *lmb_scene_part_name(lmb_scene_part part)
{
    static const char *const names[LMB_SCENE_PARTS] = {[LMB_SCENE_GEOMETRY] = "geometry",
                                                       [LMB_SCENE_MATERIALS] = "materials",
                                                       [LMB_SCENE_LIGHTS] = "lights",
                                                       [LMB_SCENE_ENVIRONMENT] = "environment"};
    return names[part];
}

/* A value without padding. */
#define TAKE(hash, value) ((hash) = lmb_hash(hash, &(value), sizeof(value)))

/* An array that may be missing. */
static uint64_t take_array(uint64_t hash, const void *values, size_t size)
{
    hash = lmb_hash(hash, values ? "+" : "-", 1);
    return values && size > 0 ? lmb_hash(hash, values, size) : hash;
}

static uint64_t take_flags(uint64_t hash, const bool *flag, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        hash = lmb_hash(hash, flag[i] ? "1" : "0", 1);
    }
    return hash;
}

static uint64_t mesh_take(uint64_t hash, const lmb_mesh *mesh)
{
    const size_t vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    TAKE(hash, mesh->vertex_count);
    TAKE(hash, mesh->triangle_count);
    hash = take_array(hash, mesh->position, vertices * sizeof *mesh->position);
    hash = take_array(hash, mesh->normal, vertices * sizeof *mesh->normal);
    hash = take_array(hash, mesh->tangent, vertices * sizeof *mesh->tangent);
    for (int set = 0; set < LMB_UV_SETS; ++set) {
        hash = take_array(hash, mesh->uv[set], vertices * sizeof *mesh->uv[set]);
    }
    hash = take_array(hash, mesh->color, vertices * sizeof *mesh->color);
    hash = take_array(hash, mesh->triangle, triangles * sizeof *mesh->triangle);
    hash = take_array(hash, mesh->material, triangles * sizeof *mesh->material);
    TAKE(hash, mesh->shift);
    return hash;
}

static uint64_t instance_take(uint64_t hash, const lmb_instance *instance)
{
    const bool flags[] = {instance->dynamic, instance->no_lightmap, instance->has_local_set, instance->lit_locally};
    TAKE(hash, instance->mesh);
    TAKE(hash, instance->to_world);
    TAKE(hash, instance->local_size);
    TAKE(hash, instance->texels_per_m);
    TAKE(hash, instance->texel_scale);
    return take_flags(hash, flags, sizeof flags / sizeof flags[0]);
}

static uint64_t probe_box_take(uint64_t hash, const lmb_probe_box *box)
{
    TAKE(hash, box->to_world);
    TAKE(hash, box->spacing);
    TAKE(hash, box->min_spacing);
    TAKE(hash, box->tolerance);
    TAKE(hash, box->priority);
    return take_flags(hash, &box->exclude, 1);
}

static uint64_t geometry_hash(const lmb_scene *scene)
{
    uint64_t hash = LMB_HASH_SEED;
    TAKE(hash, scene->origin);
    for (uint32_t i = 0; i < scene->mesh_count; ++i) {
        hash = mesh_take(hash, &scene->meshes[i]);
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        hash = instance_take(hash, &scene->instances[i]);
    }
    for (uint32_t i = 0; i < scene->probe_box_count; ++i) {
        hash = probe_box_take(hash, &scene->probe_boxes[i]);
    }
    return take_array(hash, scene->seed_points, scene->seed_point_count * sizeof *scene->seed_points);
}

static uint64_t texture_take(uint64_t hash, const lmb_texture *texture)
{
    TAKE(hash, texture->image);
    TAKE(hash, texture->uv_set);
    TAKE(hash, texture->wrap_u);
    TAKE(hash, texture->wrap_v);
    TAKE(hash, texture->transform);
    return take_flags(hash, &texture->nearest, 1);
}

static uint64_t material_take(uint64_t hash, const lmb_material *material)
{
    TAKE(hash, material->base_color);
    TAKE(hash, material->emissive);
    TAKE(hash, material->normal_scale);
    TAKE(hash, material->transmission);
    TAKE(hash, material->alpha_mode);
    TAKE(hash, material->alpha_cutoff);
    TAKE(hash, material->set);
    hash = texture_take(hash, &material->base_color_texture);
    hash = texture_take(hash, &material->emissive_texture);
    hash = texture_take(hash, &material->normal_texture);
    const bool flags[] = {material->double_sided, material->unlit};
    return take_flags(hash, flags, sizeof flags / sizeof flags[0]);
}

static uint64_t materials_hash(const lmb_scene *scene)
{
    uint64_t hash = LMB_HASH_SEED;
    for (uint32_t i = 0; i < scene->material_count; ++i) {
        hash = material_take(hash, &scene->materials[i]);
    }
    for (uint32_t i = 0; i < scene->image_count; ++i) {
        const lmb_texture_image *const image = &scene->images[i];
        TAKE(hash, image->width);
        TAKE(hash, image->height);
        hash = take_array(hash, image->rgba, 4 * (size_t)image->width * (size_t)image->height);
    }
    return hash;
}

static uint64_t light_take(uint64_t hash, const lmb_light *light)
{
    const bool flags[] = {light->indirect_only, light->dark};
    TAKE(hash, light->type);
    TAKE(hash, light->position);
    TAKE(hash, light->direction);
    TAKE(hash, light->intensity);
    TAKE(hash, light->range);
    TAKE(hash, light->cos_inner);
    TAKE(hash, light->cos_outer);
    TAKE(hash, light->angle_rad);
    TAKE(hash, light->radius);
    TAKE(hash, light->set);
    return take_flags(hash, flags, sizeof flags / sizeof flags[0]);
}

/* Without the sky's own sun. */
static uint64_t lights_hash(const lmb_scene *scene)
{
    const uint32_t count = scene->light_count - (scene->environment.has_sun ? 1 : 0);
    uint64_t hash = LMB_HASH_SEED;
    for (uint32_t i = 0; i < count; ++i) {
        hash = light_take(hash, &scene->lights[i]);
    }
    return hash;
}

static uint64_t environment_hash(const lmb_scene *scene)
{
    const lmb_environment *const environment = &scene->environment;
    const size_t pixels = (size_t)environment->image.width * (size_t)environment->image.height;
    uint64_t hash = take_flags(LMB_HASH_SEED, &environment->present, 1);
    TAKE(hash, environment->constant);
    TAKE(hash, environment->axes);
    TAKE(hash, environment->rotation_rad);
    TAKE(hash, environment->strength);
    TAKE(hash, environment->set);
    if (environment->has_sun) {
        hash = light_take(hash, &scene->lights[scene->light_count - 1]);
    }
    hash = take_array(hash, environment->taken, environment->taken_count * sizeof *environment->taken);
    return take_array(hash, environment->image.rgb, pixels * 3 * sizeof(float));
}

void lmb_scene_part_hashes(const lmb_scene *scene, uint64_t hash[LMB_SCENE_PARTS])
{
    hash[LMB_SCENE_GEOMETRY] = geometry_hash(scene);
    hash[LMB_SCENE_MATERIALS] = materials_hash(scene);
    hash[LMB_SCENE_LIGHTS] = lights_hash(scene);
    hash[LMB_SCENE_ENVIRONMENT] = environment_hash(scene);
}
