#include "level_builder_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <stb_image_write.h>

void *level_grow(lmb_level_builder *builder, void *items, size_t count, size_t *capacity, size_t extra,
                 size_t item_size)
{
    const size_t needed = count + extra;
    if (builder->failed) {
        return NULL;
    }
    if (needed <= *capacity) {
        return items;
    }
    const size_t grown = needed > 2 * *capacity ? needed : 2 * *capacity;
    void *moved = grown <= SIZE_MAX / item_size ? realloc(items, grown * item_size) : NULL;
    if (!moved) {
        builder->failed = true;
        return NULL;
    }
    *capacity = grown;
    return moved;
}

/* Room for one more item in one of the builder's arrays. */
#define RESERVE_ONE(builder, items, count, capacity)                                                                   \
    level_grow((builder), (builder)->items, (builder)->count, &(builder)->capacity, 1, sizeof *(builder)->items)

static char *copy_text(lmb_level_builder *builder, const char *text)
{
    const size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    if (!copy) {
        builder->failed = true;
        return NULL;
    }
    memcpy(copy, text, size);
    return copy;
}

lmb_level_builder *lmb_level_builder_create(float lightmap_gutter_m)
{
    assert(lightmap_gutter_m > 0);
    lmb_level_builder *builder = calloc(1, sizeof *builder);
    if (builder) {
        builder->gutter_m = lightmap_gutter_m;
    }
    return builder;
}

void lmb_level_builder_destroy(lmb_level_builder *builder)
{
    if (!builder) {
        return;
    }
    for (size_t i = 0; i < builder->image_count; ++i) {
        free(builder->images[i].name);
        free(builder->images[i].png);
    }
    for (size_t i = 0; i < builder->material_count; ++i) {
        free((char *)builder->materials[i].name);
    }
    for (size_t i = 0; i < builder->mesh_count; ++i) {
        free(builder->meshes[i].name);
        free(builder->meshes[i].vertices);
        free(builder->meshes[i].triangles);
        free(builder->meshes[i].charts);
    }
    for (size_t i = 0; i < builder->light_count; ++i) {
        free((char *)builder->lights[i].name);
    }
    for (size_t i = 0; i < builder->camera_count; ++i) {
        free(builder->cameras[i].name);
    }
    for (size_t i = 0; i < builder->node_count; ++i) {
        free((char *)builder->nodes[i].name);
    }
    free(builder->images);
    free(builder->materials);
    free(builder->meshes);
    free(builder->lights);
    free(builder->cameras);
    free(builder->nodes);
    free(builder);
}

lmb_level_material lmb_level_material_default(void)
{
    return (lmb_level_material){
        .name = "material",
        .base_color = {{0.5f, 0.5f, 0.5f}},
        .alpha = 1,
        .base_color_texture = LMB_LEVEL_NONE,
        .emissive_texture = LMB_LEVEL_NONE,
        .normal_texture = LMB_LEVEL_NONE,
        .roughness = 1,
        .metallic_roughness_texture = LMB_LEVEL_NONE,
        .normal_scale = 1,
        .texture_size_m = 1,
        .alpha_cutoff = 0.5f,
    };
}

int lmb_level_builder_add_material(lmb_level_builder *builder, const lmb_level_material *material)
{
    if (!builder) {
        return LMB_LEVEL_NONE;
    }
    assert(material->texture_size_m > 0);
    assert(material->base_color_texture < (int)builder->image_count);
    assert(material->emissive_texture < (int)builder->image_count);
    assert(material->normal_texture < (int)builder->image_count);
    assert(material->metallic_roughness_texture < (int)builder->image_count);
    lmb_level_material *materials = RESERVE_ONE(builder, materials, material_count, material_capacity);
    char *name = materials ? copy_text(builder, material->name) : NULL;
    builder->materials = materials ? materials : builder->materials;
    if (!name) {
        return LMB_LEVEL_NONE;
    }
    materials[builder->material_count] = *material;
    materials[builder->material_count].name = name;
    return (int)builder->material_count++;
}

/* stb_image_write hands the whole file over in one call. */
static void keep_png(void *context, void *data, int size)
{
    level_image *image = context;
    image->png = malloc((size_t)size);
    if (image->png) {
        memcpy(image->png, data, (size_t)size);
        image->png_size = (size_t)size;
    }
}

int lmb_level_builder_add_image(lmb_level_builder *builder, const char *name, int width, int height,
                                const uint8_t *rgba)
{
    if (!builder) {
        return LMB_LEVEL_NONE;
    }
    assert(width > 0 && height > 0 && width <= 8192 && height <= 8192);
    level_image *images = RESERVE_ONE(builder, images, image_count, image_capacity);
    builder->images = images ? images : builder->images;
    level_image image = {.name = images ? copy_text(builder, name) : NULL};
    if (!image.name) {
        return LMB_LEVEL_NONE;
    }
    if (!stbi_write_png_to_func(keep_png, &image, width, height, 4, rgba, 4 * width) || !image.png) {
        builder->failed = true;
        free(image.name);
        return LMB_LEVEL_NONE;
    }
    images[builder->image_count] = image;
    return (int)builder->image_count++;
}

int lmb_level_builder_add_mesh(lmb_level_builder *builder, const char *name)
{
    if (!builder) {
        return LMB_LEVEL_NONE;
    }
    level_mesh *meshes = RESERVE_ONE(builder, meshes, mesh_count, mesh_capacity);
    char *copy = meshes ? copy_text(builder, name) : NULL;
    builder->meshes = meshes ? meshes : builder->meshes;
    if (!copy) {
        return LMB_LEVEL_NONE;
    }
    meshes[builder->mesh_count] = (level_mesh){.name = copy};
    return (int)builder->mesh_count++;
}

level_mesh *level_mesh_at(lmb_level_builder *builder, int mesh)
{
    if (!builder || builder->failed) {
        return NULL;
    }
    assert(mesh >= 0 && (size_t)mesh < builder->mesh_count);
    return &builder->meshes[mesh];
}

size_t lmb_level_builder_triangle_count(const lmb_level_builder *builder, int mesh)
{
    if (!builder || mesh == LMB_LEVEL_NONE) {
        return 0;
    }
    assert(mesh >= 0 && (size_t)mesh < builder->mesh_count);
    return builder->meshes[mesh].triangle_count;
}

int lmb_level_builder_add_light(lmb_level_builder *builder, const lmb_level_light *light)
{
    if (!builder) {
        return LMB_LEVEL_NONE;
    }
    lmb_level_light *lights = RESERVE_ONE(builder, lights, light_count, light_capacity);
    char *name = lights ? copy_text(builder, light->name) : NULL;
    builder->lights = lights ? lights : builder->lights;
    if (!name) {
        return LMB_LEVEL_NONE;
    }
    lights[builder->light_count] = *light;
    lights[builder->light_count].name = name;
    return (int)builder->light_count++;
}

int lmb_level_builder_add_camera(lmb_level_builder *builder, const char *name, float view_angle_rad)
{
    if (!builder) {
        return LMB_LEVEL_NONE;
    }
    struct level_camera *cameras = RESERVE_ONE(builder, cameras, camera_count, camera_capacity);
    char *copy = cameras ? copy_text(builder, name) : NULL;
    builder->cameras = cameras ? cameras : builder->cameras;
    if (!copy) {
        return LMB_LEVEL_NONE;
    }
    cameras[builder->camera_count] = (struct level_camera){copy, view_angle_rad};
    return (int)builder->camera_count++;
}

lmb_level_node lmb_level_node_default(const char *name)
{
    return (lmb_level_node){
        .name = name,
        .parent = LMB_LEVEL_NONE,
        .mesh = LMB_LEVEL_NONE,
        .light = LMB_LEVEL_NONE,
        .camera = LMB_LEVEL_NONE,
        .rotation = {0, 0, 0, 1},
        .scale = {1, 1, 1},
        .path = LMB_LEVEL_NONE,
    };
}

int lmb_level_builder_add_node(lmb_level_builder *builder, const lmb_level_node *node)
{
    if (!builder) {
        return LMB_LEVEL_NONE;
    }
    assert(node->parent < (int)builder->node_count);
    assert(node->mesh < (int)builder->mesh_count);
    assert(node->light < (int)builder->light_count);
    assert(node->camera < (int)builder->camera_count);
    lmb_level_node *nodes = RESERVE_ONE(builder, nodes, node_count, node_capacity);
    char *name = nodes ? copy_text(builder, node->name) : NULL;
    builder->nodes = nodes ? nodes : builder->nodes;
    if (!name) {
        return LMB_LEVEL_NONE;
    }
    nodes[builder->node_count] = *node;
    nodes[builder->node_count].name = name;
    if (node->parent != LMB_LEVEL_NONE && (size_t)node->parent >= builder->parents_end) {
        builder->parents_end = (size_t)node->parent + 1;
    }
    return (int)builder->node_count++;
}

int lmb_level_builder_place(lmb_level_builder *builder, const char *name, int mesh, lmb_vec3 translation)
{
    lmb_level_node node = lmb_level_node_default(name);
    node.mesh = mesh;
    node.translation = translation;
    return lmb_level_builder_add_node(builder, &node);
}

/* The rotation is a turn about +Y by the heading, after a turn about +X by the pitch. */
int lmb_level_builder_add_volume(lmb_level_builder *builder, const char *name, lmb_vec3 min, lmb_vec3 max,
                                 const lmb_level_volume *volume)
{
    lmb_level_node node = lmb_level_node_default(name);
    node.translation = (lmb_vec3){0.5f * (min.x + max.x), 0.5f * (min.y + max.y), 0.5f * (min.z + max.z)};
    node.scale = (lmb_vec3){0.5f * (max.x - min.x), 0.5f * (max.y - min.y), 0.5f * (max.z - min.z)};
    node.has_volume = true;
    node.volume = *volume;
    return lmb_level_builder_add_node(builder, &node);
}

void lmb_level_look_along(lmb_vec3 direction, float rotation[4])
{
    const double flat = sqrt((double)direction.x * (double)direction.x + (double)direction.z * (double)direction.z);
    assert(flat > 0 || direction.y != 0);
    const double heading = flat > 0 ? atan2(-(double)direction.x, -(double)direction.z) : 0;
    const double pitch = atan2((double)direction.y, flat);
    const double ch = cos(heading / 2);
    const double sh = sin(heading / 2);
    const double cp = cos(pitch / 2);
    const double sp = sin(pitch / 2);
    rotation[0] = (float)(ch * sp);
    rotation[1] = (float)(sh * cp);
    rotation[2] = (float)(-sh * sp);
    rotation[3] = (float)(ch * cp);
}

void lmb_level_turn(float angle_rad, float rotation[4])
{
    rotation[0] = 0;
    rotation[1] = (float)sin((double)angle_rad / 2);
    rotation[2] = 0;
    rotation[3] = (float)cos((double)angle_rad / 2);
}
