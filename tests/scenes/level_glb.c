/* The binary glTF file: a JSON chunk that describes one binary chunk. Layout: glTF 2.0 specification, section 4. */
#include "level_builder_internal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

enum {
    GLTF_ARRAY_BUFFER = 34962,
    GLTF_ELEMENT_ARRAY_BUFFER = 34963,
    GLTF_FLOAT = 5126,
    GLTF_UNSIGNED_INT = 5125,
};

/* What is being written. A failed allocation anywhere leaves `failed` set. */
typedef struct glb {
    lmb_level_builder *builder;
    uint8_t *bytes;
    size_t byte_count, byte_capacity;
    cJSON *root, *views, *accessors;
    bool strength_used, unlit_used, transmission_used;
    bool failed;
} glb;

/* --- JSON, with every allocation checked ---------------------------------------------------------------------- */

static cJSON *checked(glb *out, cJSON *item)
{
    out->failed |= item == NULL;
    return item;
}

/* Puts `value` into an object and hands it back; a value that cannot be put there is freed. */
static cJSON *put(glb *out, cJSON *object, const char *key, cJSON *value)
{
    if (!checked(out, value)) {
        return NULL;
    }
    if (!object || !cJSON_AddItemToObject(object, key, value)) {
        cJSON_Delete(value);
        out->failed = true;
        return NULL;
    }
    return value;
}

static cJSON *push(glb *out, cJSON *array, cJSON *value)
{
    if (!checked(out, value)) {
        return NULL;
    }
    if (!array || !cJSON_AddItemToArray(array, value)) {
        cJSON_Delete(value);
        out->failed = true;
        return NULL;
    }
    return value;
}

static void put_number(glb *out, cJSON *object, const char *key, double value)
{
    put(out, object, key, cJSON_CreateNumber(value));
}

static void put_text(glb *out, cJSON *object, const char *key, const char *value)
{
    put(out, object, key, cJSON_CreateString(value));
}

static void put_floats(glb *out, cJSON *object, const char *key, const float *values, int count)
{
    put(out, object, key, cJSON_CreateFloatArray(values, count));
}

static cJSON *put_object(glb *out, cJSON *object, const char *key)
{
    return put(out, object, key, cJSON_CreateObject());
}

/* An array of the root, made when there is something to put into it: glTF forbids empty ones. */
static cJSON *put_list(glb *out, cJSON *object, const char *key, size_t count)
{
    return count > 0 ? put(out, object, key, cJSON_CreateArray()) : NULL;
}

/* --- the binary chunk ------------------------------------------------------------------------------------------ */

/* Appends `size` zero bytes, and before them padding to a multiple of 4. NULL when memory has run out. */
static uint8_t *extend(glb *out, size_t size)
{
    const size_t start = (out->byte_count + 3) & ~(size_t)3;
    const size_t extra = start - out->byte_count + size;
    uint8_t *bytes = level_grow(out->builder, out->bytes, out->byte_count, &out->byte_capacity, extra, 1);
    if (!bytes) {
        out->failed = true;
        return NULL;
    }
    memset(bytes + out->byte_count, 0, extra);
    out->bytes = bytes;
    out->byte_count = start + size;
    return bytes + start;
}

/* A buffer view of the last `size` bytes. @return its index */
static int add_view(glb *out, size_t size, int target)
{
    cJSON *view = push(out, out->views, cJSON_CreateObject());
    put_number(out, view, "buffer", 0);
    put_number(out, view, "byteOffset", (double)(out->byte_count - size));
    put_number(out, view, "byteLength", (double)size);
    if (target != 0) {
        put_number(out, view, "target", target);
    }
    return cJSON_GetArraySize(out->views) - 1;
}

static cJSON *add_accessor(glb *out, int view, int component_type, size_t count, const char *type)
{
    cJSON *accessor = push(out, out->accessors, cJSON_CreateObject());
    put_number(out, accessor, "bufferView", view);
    put_number(out, accessor, "componentType", component_type);
    put_number(out, accessor, "count", (double)count);
    put_text(out, accessor, "type", type);
    return accessor;
}

static void store_u32(uint8_t *bytes, uint32_t value)
{
    for (int i = 0; i < 4; ++i) {
        bytes[i] = (uint8_t)(value >> (8 * i));
    }
}

static void store_float(uint8_t *bytes, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    store_u32(bytes, bits);
}

/* --- meshes ----------------------------------------------------------------------------------------------------- */

static const struct attribute {
    const char *name;
    const char *type;
    size_t offset; /* of its floats in level_vertex */
    size_t components;
} attributes[] = {
    {"POSITION", "VEC3", offsetof(level_vertex, position), 3},
    {"NORMAL", "VEC3", offsetof(level_vertex, normal), 3},
    {"TEXCOORD_0", "VEC2", offsetof(level_vertex, uv), 2},
    {"TEXCOORD_1", "VEC2", offsetof(level_vertex, lightmap_uv), 2},
    {"TANGENT", "VEC4", offsetof(level_vertex, tangent), 4}, /* last: only with a normal texture */
};

static bool lay_out_lightmap(level_mesh *mesh, float gutter_m)
{
    const float side = level_layout_pack(mesh->charts, mesh->chart_count, gutter_m);
    if (side <= 0) {
        return false;
    }
    for (size_t i = 0; i < mesh->vertex_count; ++i) {
        level_vertex *vertex = &mesh->vertices[i];
        const level_chart *chart = &mesh->charts[vertex->chart];
        vertex->lightmap_uv[0] = (chart->x + vertex->chart_m[0]) / side;
        vertex->lightmap_uv[1] = (chart->y + vertex->chart_m[1]) / side;
    }
    return true;
}

/* POSITION must say its bounds. */
static void put_bounds(glb *out, cJSON *accessor, const level_mesh *mesh, int material)
{
    float min[3] = {INFINITY, INFINITY, INFINITY};
    float max[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < mesh->vertex_count; ++i) {
        const lmb_vec3 p = mesh->vertices[i].position;
        const float position[3] = {p.x, p.y, p.z};
        for (int axis = 0; axis < 3 && mesh->vertices[i].material == material; ++axis) {
            min[axis] = fminf(min[axis], position[axis]);
            max[axis] = fmaxf(max[axis], position[axis]);
        }
    }
    put_floats(out, accessor, "min", min, 3);
    put_floats(out, accessor, "max", max, 3);
}

/* One attribute of all vertices with the material. @return the accessor's index */
static int write_attribute(glb *out, const level_mesh *mesh, int material, const struct attribute *attribute)
{
    size_t count = 0;
    for (size_t i = 0; i < mesh->vertex_count; ++i) {
        count += mesh->vertices[i].material == material;
    }
    const size_t size = count * attribute->components * sizeof(float);
    uint8_t *bytes = extend(out, size);
    if (!bytes) {
        return LMB_LEVEL_NONE;
    }
    for (size_t i = 0; i < mesh->vertex_count; ++i) {
        if (mesh->vertices[i].material == material) {
            float values[4];
            memcpy(values, (const char *)&mesh->vertices[i] + attribute->offset, attribute->components * sizeof(float));
            for (size_t c = 0; c < attribute->components; ++c) {
                store_float(bytes, values[c]);
                bytes += sizeof(float);
            }
        }
    }
    cJSON *accessor = add_accessor(out, add_view(out, size, GLTF_ARRAY_BUFFER), GLTF_FLOAT, count, attribute->type);
    if (attribute == &attributes[0]) {
        put_bounds(out, accessor, mesh, material);
    }
    return cJSON_GetArraySize(out->accessors) - 1;
}

/* The triangles with the material, their vertices renumbered among those with the material. */
static int write_indices(glb *out, const level_mesh *mesh, int material, size_t triangle_count)
{
    const size_t size = triangle_count * 3 * sizeof(uint32_t);
    uint32_t *renumbered = malloc((mesh->vertex_count + 1) * sizeof *renumbered);
    uint8_t *bytes = renumbered ? extend(out, size) : NULL;
    if (!bytes) {
        free(renumbered);
        out->failed = true;
        return LMB_LEVEL_NONE;
    }
    uint32_t next = 0;
    for (size_t i = 0; i < mesh->vertex_count; ++i) {
        renumbered[i] = next;
        next += mesh->vertices[i].material == material;
    }
    for (size_t i = 0; i < mesh->triangle_count; ++i) {
        for (int corner = 0; corner < 3 && mesh->triangles[i].material == material; ++corner) {
            store_u32(bytes, renumbered[mesh->triangles[i].vertex[corner]]);
            bytes += sizeof(uint32_t);
        }
    }
    free(renumbered);
    add_accessor(out, add_view(out, size, GLTF_ELEMENT_ARRAY_BUFFER), GLTF_UNSIGNED_INT, 3 * triangle_count, "SCALAR");
    return cJSON_GetArraySize(out->accessors) - 1;
}

static void write_primitive(glb *out, cJSON *primitives, const level_mesh *mesh, int material)
{
    size_t triangle_count = 0;
    for (size_t i = 0; i < mesh->triangle_count; ++i) {
        triangle_count += mesh->triangles[i].material == material;
    }
    if (triangle_count == 0) {
        return;
    }
    cJSON *primitive = push(out, primitives, cJSON_CreateObject());
    cJSON *names = put_object(out, primitive, "attributes");
    const bool tangents = out->builder->materials[material].normal_texture != LMB_LEVEL_NONE;
    const size_t count = sizeof attributes / sizeof attributes[0] - (tangents ? 0 : 1);
    for (size_t i = 0; i < count && !out->failed; ++i) {
        put_number(out, names, attributes[i].name, write_attribute(out, mesh, material, &attributes[i]));
    }
    put_number(out, primitive, "indices", write_indices(out, mesh, material, triangle_count));
    put_number(out, primitive, "material", material);
}

static void write_meshes(glb *out)
{
    const lmb_level_builder *builder = out->builder;
    cJSON *meshes = put_list(out, out->root, "meshes", builder->mesh_count);
    for (size_t i = 0; i < builder->mesh_count && !out->failed; ++i) {
        level_mesh *mesh = &builder->meshes[i];
        cJSON *item = push(out, meshes, cJSON_CreateObject());
        put_text(out, item, "name", mesh->name);
        cJSON *primitives = put(out, item, "primitives", cJSON_CreateArray());
        if (!lay_out_lightmap(mesh, builder->gutter_m)) {
            out->failed = true;
        }
        for (size_t material = 0; material < builder->material_count && !out->failed; ++material) {
            write_primitive(out, primitives, mesh, (int)material);
        }
    }
}

/* --- materials and images --------------------------------------------------------------------------------------- */

static void write_images(glb *out)
{
    const lmb_level_builder *builder = out->builder;
    cJSON *images = put_list(out, out->root, "images", builder->image_count);
    cJSON *textures = put_list(out, out->root, "textures", builder->image_count);
    for (size_t i = 0; i < builder->image_count && !out->failed; ++i) {
        const level_image *source = &builder->images[i];
        uint8_t *bytes = extend(out, source->png_size);
        if (!bytes) {
            return;
        }
        memcpy(bytes, source->png, source->png_size);
        cJSON *image = push(out, images, cJSON_CreateObject());
        put_text(out, image, "name", source->name);
        put_text(out, image, "mimeType", "image/png");
        put_number(out, image, "bufferView", add_view(out, source->png_size, 0));
        cJSON *texture = push(out, textures, cJSON_CreateObject());
        put_number(out, texture, "source", (double)i);
    }
}

static cJSON *put_texture(glb *out, cJSON *object, const char *key, int image)
{
    if (image == LMB_LEVEL_NONE) {
        return NULL;
    }
    cJSON *info = put_object(out, object, key);
    put_number(out, info, "index", image);
    return info;
}

/* emissiveFactor is limited to 1: the rest goes into KHR_materials_emissive_strength. */
static void write_emission(glb *out, cJSON *item, cJSON **extensions, const lmb_level_material *material)
{
    const float *radiance = material->emission.c;
    const float largest = fmaxf(radiance[0], fmaxf(radiance[1], radiance[2]));
    if (largest <= 0) {
        return;
    }
    const float strength = largest > 1 ? largest : 1;
    const float factor[3] = {radiance[0] / strength, radiance[1] / strength, radiance[2] / strength};
    put_floats(out, item, "emissiveFactor", factor, 3);
    put_texture(out, item, "emissiveTexture", material->emissive_texture);
    if (strength > 1) {
        *extensions = *extensions ? *extensions : put_object(out, item, "extensions");
        put_number(out, put_object(out, *extensions, "KHR_materials_emissive_strength"), "emissiveStrength",
                   (double)strength);
        out->strength_used = true;
    }
}

static void write_material(glb *out, cJSON *item, const lmb_level_material *material)
{
    const float *rgb = material->base_color.c;
    const float base_color[4] = {rgb[0], rgb[1], rgb[2], material->alpha};
    cJSON *extensions = NULL;
    put_text(out, item, "name", material->name);
    cJSON *pbr = put_object(out, item, "pbrMetallicRoughness");
    put_floats(out, pbr, "baseColorFactor", base_color, 4);
    put_texture(out, pbr, "baseColorTexture", material->base_color_texture);
    put_number(out, pbr, "metallicFactor", (double)material->metallic);
    if (material->roughness != 1) {
        put_number(out, pbr, "roughnessFactor", (double)material->roughness);
    }
    put_texture(out, pbr, "metallicRoughnessTexture", material->metallic_roughness_texture);
    cJSON *normal = put_texture(out, item, "normalTexture", material->normal_texture);
    if (normal) {
        put_number(out, normal, "scale", (double)material->normal_scale);
    }
    write_emission(out, item, &extensions, material);
    if (material->alpha_mode != LMB_LEVEL_OPAQUE) {
        put_text(out, item, "alphaMode", material->alpha_mode == LMB_LEVEL_MASK ? "MASK" : "BLEND");
    }
    if (material->alpha_mode == LMB_LEVEL_MASK) {
        put_number(out, item, "alphaCutoff", (double)material->alpha_cutoff);
    }
    if (material->double_sided) {
        put(out, item, "doubleSided", cJSON_CreateTrue());
    }
    if (material->transmission > 0.0f) {
        extensions = extensions ? extensions : put_object(out, item, "extensions");
        put_number(out, put_object(out, extensions, "KHR_materials_transmission"), "transmissionFactor",
                   (double)material->transmission);
        out->transmission_used = true;
    }
    if (material->light_set) {
        put_text(out, put_object(out, put_object(out, item, "extras"), "lambent"), "light_set", material->light_set);
    }
    if (material->unlit) {
        extensions = extensions ? extensions : put_object(out, item, "extensions");
        put_object(out, extensions, "KHR_materials_unlit");
        out->unlit_used = true;
    }
}

static void write_materials(glb *out)
{
    const lmb_level_builder *builder = out->builder;
    cJSON *materials = put_list(out, out->root, "materials", builder->material_count);
    for (size_t i = 0; i < builder->material_count && !out->failed; ++i) {
        write_material(out, push(out, materials, cJSON_CreateObject()), &builder->materials[i]);
    }
}

/* --- lights, cameras, nodes ------------------------------------------------------------------------------------- */

static void write_lights(glb *out)
{
    static const char *const types[] = {"point", "spot", "directional"};
    const lmb_level_builder *builder = out->builder;
    if (builder->light_count == 0) {
        return;
    }
    cJSON *extension = put_object(out, put_object(out, out->root, "extensions"), "KHR_lights_punctual");
    cJSON *lights = put_list(out, extension, "lights", builder->light_count);
    for (size_t i = 0; i < builder->light_count && !out->failed; ++i) {
        const lmb_level_light *light = &builder->lights[i];
        cJSON *item = push(out, lights, cJSON_CreateObject());
        put_text(out, item, "name", light->name);
        put_text(out, item, "type", types[light->type]);
        put_floats(out, item, "color", light->color.c, 3);
        put_number(out, item, "intensity", (double)light->intensity);
        if (light->range_m > 0) {
            put_number(out, item, "range", (double)light->range_m);
        }
        if (light->type == LMB_LEVEL_LIGHT_SPOT) {
            cJSON *spot = put_object(out, item, "spot");
            put_number(out, spot, "innerConeAngle", (double)light->inner_angle_rad);
            put_number(out, spot, "outerConeAngle", (double)light->outer_angle_rad);
        }
    }
}

static void write_cameras(glb *out)
{
    const lmb_level_builder *builder = out->builder;
    cJSON *cameras = put_list(out, out->root, "cameras", builder->camera_count);
    for (size_t i = 0; i < builder->camera_count && !out->failed; ++i) {
        cJSON *item = push(out, cameras, cJSON_CreateObject());
        put_text(out, item, "name", builder->cameras[i].name);
        put_text(out, item, "type", "perspective");
        cJSON *perspective = put_object(out, item, "perspective");
        put_number(out, perspective, "yfov", (double)builder->cameras[i].view_angle_rad);
        put_number(out, perspective, "znear", 0.01);
    }
}

static void write_volume(glb *out, cJSON *lambent, const lmb_level_volume *volume)
{
    cJSON *item = put_object(out, lambent, "volume");
    const struct {
        const char *key;
        double value;
    } numbers[] = {{"spacing", (double)volume->spacing},
                   {"min_spacing", (double)volume->min_spacing},
                   {"tolerance", (double)volume->tolerance},
                   {"priority", volume->priority}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        if (numbers[i].value != 0.0) {
            put_number(out, item, numbers[i].key, numbers[i].value);
        }
    }
    if (volume->exclude) {
        put(out, item, "exclude", cJSON_CreateTrue());
    }
}

static void write_node_extras(glb *out, cJSON *item, const lmb_level_node *node)
{
    const bool soft = node->angle_deg > 0.0f || node->radius_m > 0.0f;
    const bool maps = node->no_lightmap || node->texels_per_m > 0.0f || node->texel_scale > 0.0f || node->light_set;
    const bool marks = node->dynamic || node->seed || node->cube_map || node->path != LMB_LEVEL_NONE;
    const bool local = node->local_set || node->lit_locally;
    if (!marks && !soft && !maps && !local && !node->has_volume) {
        return;
    }
    cJSON *lambent = put_object(out, put_object(out, item, "extras"), "lambent");
    if (node->has_volume) {
        write_volume(out, lambent, &node->volume);
    }
    if (node->dynamic) {
        put(out, lambent, "static", cJSON_CreateFalse());
    }
    if (node->cube_map) {
        put(out, lambent, "cube_map", cJSON_CreateTrue());
    }
    if (node->seed) {
        put(out, lambent, "seed", cJSON_CreateTrue());
    }
    if (node->path != LMB_LEVEL_NONE) {
        put_number(out, lambent, "path", node->path);
    }
    if (node->no_lightmap) {
        put(out, lambent, "lightmap", cJSON_CreateFalse());
    }
    if (node->lit_locally) {
        put_text(out, lambent, "lightmap", "local");
    }
    if (node->local_set) {
        const int size[3] = {(int)node->local_size[0], (int)node->local_size[1], (int)node->local_size[2]};
        put(out, lambent, "local_set", size[0] > 0 ? cJSON_CreateIntArray(size, 3) : cJSON_CreateTrue());
    }
    if (node->texels_per_m > 0.0f) {
        put_number(out, lambent, "texels_per_m", (double)node->texels_per_m);
    }
    if (node->texel_scale > 0.0f) {
        put_number(out, lambent, "texel_scale", (double)node->texel_scale);
    }
    if (node->angle_deg > 0.0f) {
        put_number(out, lambent, "angle_deg", (double)node->angle_deg);
    }
    if (node->light_set) {
        put_text(out, lambent, "light_set", node->light_set);
    }
    if (node->radius_m > 0.0f) {
        put_number(out, lambent, "radius_m", (double)node->radius_m);
    }
}

static void write_node(glb *out, cJSON *item, const lmb_level_node *node, size_t index)
{
    const float translation[3] = {node->translation.x, node->translation.y, node->translation.z};
    const float scale[3] = {node->scale.x, node->scale.y, node->scale.z};
    put_text(out, item, "name", node->name);
    put_floats(out, item, "translation", translation, 3);
    put_floats(out, item, "rotation", node->rotation, 4);
    put_floats(out, item, "scale", scale, 3);
    if (node->mesh != LMB_LEVEL_NONE) {
        put_number(out, item, "mesh", node->mesh);
    }
    if (node->camera != LMB_LEVEL_NONE) {
        put_number(out, item, "camera", node->camera);
    }
    if (node->light != LMB_LEVEL_NONE) {
        cJSON *extension = put_object(out, put_object(out, item, "extensions"), "KHR_lights_punctual");
        put_number(out, extension, "light", node->light);
    }
    cJSON *children = NULL;
    for (size_t i = index + 1; index < out->builder->parents_end && i < out->builder->node_count; ++i) {
        if (out->builder->nodes[i].parent == (int)index) {
            children = children ? children : put(out, item, "children", cJSON_CreateArray());
            push(out, children, cJSON_CreateNumber((double)i));
        }
    }
    write_node_extras(out, item, node);
}

static void write_nodes(glb *out)
{
    const lmb_level_builder *builder = out->builder;
    size_t root_count = 0;
    for (size_t i = 0; i < builder->node_count; ++i) {
        root_count += builder->nodes[i].parent == LMB_LEVEL_NONE;
    }
    put_number(out, out->root, "scene", 0);
    cJSON *scenes = put(out, out->root, "scenes", cJSON_CreateArray());
    cJSON *roots = put_list(out, push(out, scenes, cJSON_CreateObject()), "nodes", root_count);
    cJSON *nodes = put_list(out, out->root, "nodes", builder->node_count);
    for (size_t i = 0; i < builder->node_count && !out->failed; ++i) {
        write_node(out, push(out, nodes, cJSON_CreateObject()), &builder->nodes[i], i);
        if (builder->nodes[i].parent == LMB_LEVEL_NONE) {
            push(out, roots, cJSON_CreateNumber((double)i));
        }
    }
}

static void write_extensions_used(glb *out)
{
    const struct {
        const char *name;
        bool used;
    } extensions[] = {
        {"KHR_lights_punctual", out->builder->light_count > 0},
        {"KHR_materials_emissive_strength", out->strength_used},
        {"KHR_materials_transmission", out->transmission_used},
        {"KHR_materials_unlit", out->unlit_used},
    };
    cJSON *list = NULL;
    for (size_t i = 0; i < sizeof extensions / sizeof extensions[0]; ++i) {
        if (extensions[i].used) {
            list = list ? list : put(out, out->root, "extensionsUsed", cJSON_CreateArray());
            push(out, list, cJSON_CreateString(extensions[i].name));
        }
    }
}

/* --- the file --------------------------------------------------------------------------------------------------- */

static void compose(glb *out)
{
    cJSON *asset = put_object(out, out->root, "asset");
    put_text(out, asset, "version", "2.0");
    put_text(out, asset, "generator", "Lambent level builder");
    out->views = put(out, out->root, "bufferViews", cJSON_CreateArray());
    out->accessors = put(out, out->root, "accessors", cJSON_CreateArray());
    write_images(out);
    write_materials(out);
    write_meshes(out);
    write_lights(out);
    write_cameras(out);
    write_nodes(out);
    write_extensions_used(out);
    if (cJSON_GetArraySize(out->views) == 0) {
        cJSON_DeleteItemFromObject(out->root, "bufferViews");
    } else {
        cJSON *buffers = put(out, out->root, "buffers", cJSON_CreateArray());
        extend(out, 0); /* chunks are padded to 4 bytes */
        put_number(out, push(out, buffers, cJSON_CreateObject()), "byteLength", (double)out->byte_count);
    }
    if (cJSON_GetArraySize(out->accessors) == 0) {
        cJSON_DeleteItemFromObject(out->root, "accessors");
    }
}

static bool write_chunk(FILE *file, const char *type, const void *bytes, size_t size, char padding)
{
    const size_t pad = (4 - size % 4) % 4;
    const char padding_bytes[3] = {padding, padding, padding};
    uint8_t header[8];
    store_u32(header, (uint32_t)(size + pad));
    memcpy(header + 4, type, 4);
    return fwrite(header, 1, 8, file) == 8 && fwrite(bytes, 1, size, file) == size &&
           fwrite(padding_bytes, 1, pad, file) == pad;
}

static bool write_file(FILE *file, const glb *out, const char *json)
{
    const size_t json_size = strlen(json);
    const bool has_binary = out->byte_count > 0;
    const size_t total =
        12 + 8 + ((json_size + 3) & ~(size_t)3) + (has_binary ? 8 + ((out->byte_count + 3) & ~(size_t)3) : 0);
    uint8_t header[12] = {'g', 'l', 'T', 'F'};
    store_u32(header + 4, 2);
    store_u32(header + 8, (uint32_t)total);
    return fwrite(header, 1, 12, file) == 12 && write_chunk(file, "JSON", json, json_size, ' ') &&
           (!has_binary || write_chunk(file, "BIN\0", out->bytes, out->byte_count, 0));
}

static lmb_result save(const glb *out, const char *json, const char *path, lmb_error *error)
{
    lmb_result result = LMB_OK;
    const size_t size = strlen(path) + sizeof ".part";
    char *part = malloc(size);
    if (!part) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    }
    snprintf(part, size, "%s.part", path);
    FILE *file = fopen(part, "wb");
    if (!file) {
        result = lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot be written: %s", path, strerror(errno));
        goto cleanup;
    }
    const bool written = write_file(file, out, json);
    const int write_errno = errno;
    const bool closed = fclose(file) == 0;
    if (!written || !closed || rename(part, path) != 0) {
        result = lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot be written: %s", path,
                               strerror(written ? errno : write_errno));
        remove(part);
    }
cleanup:
    free(part);
    return result;
}

lmb_result lmb_level_builder_write(lmb_level_builder *builder, const char *path, lmb_error *error)
{
    if (!builder || builder->failed) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory while building the level", path);
    }
    lmb_result result = LMB_OK;
    char *json = NULL;
    glb out = {.builder = builder, .root = cJSON_CreateObject()};
    checked(&out, out.root);
    compose(&out);
    json = out.failed ? NULL : cJSON_PrintUnformatted(out.root);
    if (!json) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory while writing the level", path);
        goto cleanup;
    }
    if (out.byte_count > UINT32_MAX / 2 || strlen(json) > UINT32_MAX / 2 - 64) {
        result = lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: the level needs more than 4 GB", path);
        goto cleanup;
    }
    result = save(&out, json, path, error);
cleanup:
    cJSON_free(json);
    cJSON_Delete(out.root);
    free(out.bytes);
    return result;
}
