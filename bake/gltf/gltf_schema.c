/* What is read of glTF 2.0, as a table: for each property of each kind of object its type and range. Properties that
 * the table does not name are not read by anyone. Where a texture leads is checked when it is read: most are not. */
#include "gltf/gltf_schema.h"

#include <float.h>
#include <math.h>

#include "gltf/gltf_accessor.h"
#include "gltf/gltf_json.h"

typedef enum object_kind {
    ROOT,
    ASSET,
    BUFFER,
    VIEW,
    ACCESSOR,
    SPARSE,
    SPARSE_INDICES,
    SPARSE_VALUES,
    SCENE,
    NODE,
    MESH,
    PRIMITIVE,
    SKIN,
    MATERIAL,
    METALLIC_ROUGHNESS,
    TEXTURE_INFO,
    TEXTURE,
    SAMPLER,
    IMAGE,
    LIGHT,
    SPOT,
    ROOT_EXTENSIONS,
    ROOT_LIGHTS,
    NODE_EXTENSIONS,
    NODE_LIGHT,
    NODE_INSTANCES,
    NODE_VISIBILITY,
    MATERIAL_EXTENSIONS,
    EMISSIVE_STRENGTH,
    TRANSMISSION,
    SPECULAR_GLOSSINESS,
    INFO_EXTENSIONS,
    TEXTURE_TRANSFORM,
    EMPTY
} object_kind;

typedef enum value_type {
    STRING,
    STRINGS,
    BOOL,
    UINT,    /* low .. high */
    NUMBER,  /* low .. high */
    NUMBERS, /* low .. high of them */
    INDEX,   /* into the list `list` */
    INDICES,
    ATTRIBUTES, /* object of indices into the accessors */
    TARGETS,    /* list of those */
    OBJECT,     /* of kind `kind` */
    OBJECTS
} value_type;

typedef enum list_kind {
    BUFFERS,
    VIEWS,
    ACCESSORS,
    SCENES,
    NODES,
    MESHES,
    SKINS,
    MATERIALS,
    LIGHTS,
    LIST_COUNT
} list_kind;

static const char *const list_names[LIST_COUNT] = {"buffers", "bufferViews", "accessors", "scenes", "nodes",
                                                   "meshes",  "skins",       "materials", "lights"};

typedef struct rule {
    object_kind of;
    const char *name;
    value_type type;
    bool required;
    int detail; /* object_kind or list_kind */
    double low, high;
} rule;

#define MAX_UINT 2147483647.0
#define MAX_LIST 16777216.0
/* Texts of FLT_MAX are rounded, to as few as four digits: what lies a little above it means it. Whoever makes a float
 * of a number clamps it. */
#define MAX_NUMBER 3.41e38

static const rule rules[] = {
    {ROOT, "asset", OBJECT, true, ASSET, 0, 0},
    {ROOT, "extensionsUsed", STRINGS, false, 0, 0, 0},
    {ROOT, "extensionsRequired", STRINGS, false, 0, 0, 0},
    {ROOT, "buffers", OBJECTS, false, BUFFER, 0, 0},
    {ROOT, "bufferViews", OBJECTS, false, VIEW, 0, 0},
    {ROOT, "accessors", OBJECTS, false, ACCESSOR, 0, 0},
    {ROOT, "scene", INDEX, false, SCENES, 0, 0},
    {ROOT, "scenes", OBJECTS, false, SCENE, 0, 0},
    {ROOT, "nodes", OBJECTS, false, NODE, 0, 0},
    {ROOT, "meshes", OBJECTS, false, MESH, 0, 0},
    {ROOT, "skins", OBJECTS, false, SKIN, 0, 0},
    {ROOT, "materials", OBJECTS, false, MATERIAL, 0, 0},
    {ROOT, "textures", OBJECTS, false, TEXTURE, 0, 0},
    {ROOT, "samplers", OBJECTS, false, SAMPLER, 0, 0},
    {ROOT, "images", OBJECTS, false, IMAGE, 0, 0},
    {ROOT, "extensions", OBJECT, false, ROOT_EXTENSIONS, 0, 0},
    {ASSET, "version", STRING, true, 0, 0, 0},
    {ASSET, "minVersion", STRING, false, 0, 0, 0},
    {BUFFER, "uri", STRING, false, 0, 0, 0},
    {BUFFER, "byteLength", UINT, true, 0, 0, MAX_UINT},
    {VIEW, "buffer", INDEX, true, BUFFERS, 0, 0},
    {VIEW, "byteOffset", UINT, false, 0, 0, MAX_UINT},
    {VIEW, "byteLength", UINT, true, 0, 0, MAX_UINT},
    {VIEW, "byteStride", UINT, false, 0, 0, 252}, /* 0: some exporters' none */
    {ACCESSOR, "bufferView", INDEX, false, VIEWS, 0, 0},
    {ACCESSOR, "byteOffset", UINT, false, 0, 0, MAX_UINT},
    {ACCESSOR, "componentType", UINT, true, 0, LMB_GLTF_BYTE, LMB_GLTF_FLOAT},
    {ACCESSOR, "count", UINT, true, 0, 0, MAX_UINT},
    {ACCESSOR, "type", STRING, true, 0, 0, 0},
    {ACCESSOR, "normalized", BOOL, false, 0, 0, 0},
    {ACCESSOR, "sparse", OBJECT, false, SPARSE, 0, 0},
    {SPARSE, "count", UINT, true, 0, 0, MAX_UINT},
    {SPARSE, "indices", OBJECT, true, SPARSE_INDICES, 0, 0},
    {SPARSE, "values", OBJECT, true, SPARSE_VALUES, 0, 0},
    {SPARSE_INDICES, "bufferView", INDEX, true, VIEWS, 0, 0},
    {SPARSE_INDICES, "byteOffset", UINT, false, 0, 0, MAX_UINT},
    {SPARSE_INDICES, "componentType", UINT, true, 0, LMB_GLTF_UNSIGNED_BYTE, LMB_GLTF_UNSIGNED_INT},
    {SPARSE_VALUES, "bufferView", INDEX, true, VIEWS, 0, 0},
    {SPARSE_VALUES, "byteOffset", UINT, false, 0, 0, MAX_UINT},
    {SCENE, "nodes", INDICES, false, NODES, 0, 0},
    {NODE, "name", STRING, false, 0, 0, 0},
    {NODE, "children", INDICES, false, NODES, 0, 0},
    {NODE, "mesh", INDEX, false, MESHES, 0, 0},
    {NODE, "skin", INDEX, false, SKINS, 0, 0},
    {NODE, "matrix", NUMBERS, false, 0, 16, 16},
    {NODE, "translation", NUMBERS, false, 0, 3, 3},
    {NODE, "rotation", NUMBERS, false, 0, 4, 4},
    {NODE, "scale", NUMBERS, false, 0, 3, 3},
    {NODE, "weights", NUMBERS, false, 0, 0, MAX_LIST},
    {NODE, "extensions", OBJECT, false, NODE_EXTENSIONS, 0, 0},
    {MESH, "name", STRING, false, 0, 0, 0},
    {MESH, "primitives", OBJECTS, true, PRIMITIVE, 0, 0},
    {MESH, "weights", NUMBERS, false, 0, 0, MAX_LIST},
    {PRIMITIVE, "attributes", ATTRIBUTES, true, 0, 0, 0},
    {PRIMITIVE, "indices", INDEX, false, ACCESSORS, 0, 0},
    {PRIMITIVE, "material", INDEX, false, MATERIALS, 0, 0},
    {PRIMITIVE, "mode", UINT, false, 0, 0, 6},
    {PRIMITIVE, "targets", TARGETS, false, 0, 0, 0},
    {SKIN, "joints", INDICES, true, NODES, 0, 0},
    {SKIN, "inverseBindMatrices", INDEX, false, ACCESSORS, 0, 0},
    {MATERIAL, "name", STRING, false, 0, 0, 0},
    {MATERIAL, "pbrMetallicRoughness", OBJECT, false, METALLIC_ROUGHNESS, 0, 0},
    {MATERIAL, "normalTexture", OBJECT, false, TEXTURE_INFO, 0, 0},
    {MATERIAL, "emissiveTexture", OBJECT, false, TEXTURE_INFO, 0, 0},
    {MATERIAL, "emissiveFactor", NUMBERS, false, 0, 3, 3},
    {MATERIAL, "alphaMode", STRING, false, 0, 0, 0},
    {MATERIAL, "alphaCutoff", NUMBER, false, 0, 0, MAX_NUMBER},
    {MATERIAL, "doubleSided", BOOL, false, 0, 0, 0},
    {MATERIAL, "extensions", OBJECT, false, MATERIAL_EXTENSIONS, 0, 0},
    {METALLIC_ROUGHNESS, "baseColorFactor", NUMBERS, false, 0, 4, 4},
    {METALLIC_ROUGHNESS, "baseColorTexture", OBJECT, false, TEXTURE_INFO, 0, 0},
    {TEXTURE_INFO, "index", UINT, true, 0, 0, MAX_UINT},
    {TEXTURE_INFO, "texCoord", UINT, false, 0, 0, MAX_UINT},
    {TEXTURE_INFO, "scale", NUMBER, false, 0, -MAX_NUMBER, MAX_NUMBER},
    {TEXTURE_INFO, "extensions", OBJECT, false, INFO_EXTENSIONS, 0, 0},
    {TEXTURE, "source", UINT, false, 0, 0, MAX_UINT},
    {TEXTURE, "sampler", UINT, false, 0, 0, MAX_UINT},
    {SAMPLER, "magFilter", UINT, false, 0, 9728, 9729},
    {SAMPLER, "wrapS", UINT, false, 0, 10497, 33648},
    {SAMPLER, "wrapT", UINT, false, 0, 10497, 33648},
    {IMAGE, "uri", STRING, false, 0, 0, 0},
    {IMAGE, "bufferView", UINT, false, 0, 0, MAX_UINT},
    {ROOT_EXTENSIONS, "KHR_lights_punctual", OBJECT, false, ROOT_LIGHTS, 0, 0},
    {ROOT_LIGHTS, "lights", OBJECTS, true, LIGHT, 0, 0},
    {LIGHT, "type", STRING, true, 0, 0, 0},
    {LIGHT, "name", STRING, false, 0, 0, 0},
    {LIGHT, "color", NUMBERS, false, 0, 3, 3},
    {LIGHT, "intensity", NUMBER, false, 0, -MAX_NUMBER, MAX_NUMBER},
    {LIGHT, "range", NUMBER, false, 0, 0, DBL_MAX},
    {LIGHT, "spot", OBJECT, false, SPOT, 0, 0},
    {SPOT, "innerConeAngle", NUMBER, false, 0, 0, 3.2},
    {SPOT, "outerConeAngle", NUMBER, false, 0, 0, 3.2},
    {NODE_EXTENSIONS, "KHR_lights_punctual", OBJECT, false, NODE_LIGHT, 0, 0},
    {NODE_EXTENSIONS, "KHR_node_visibility", OBJECT, false, NODE_VISIBILITY, 0, 0},
    {NODE_VISIBILITY, "visible", BOOL, false, 0, 0, 0},
    {NODE_EXTENSIONS, "EXT_mesh_gpu_instancing", OBJECT, false, NODE_INSTANCES, 0, 0},
    {NODE_LIGHT, "light", INDEX, true, LIGHTS, 0, 0},
    {NODE_INSTANCES, "attributes", ATTRIBUTES, true, 0, 0, 0},
    {MATERIAL_EXTENSIONS, "KHR_materials_emissive_strength", OBJECT, false, EMISSIVE_STRENGTH, 0, 0},
    {MATERIAL_EXTENSIONS, "KHR_materials_transmission", OBJECT, false, TRANSMISSION, 0, 0},
    {MATERIAL_EXTENSIONS, "KHR_materials_unlit", OBJECT, false, EMPTY, 0, 0},
    {MATERIAL_EXTENSIONS, "KHR_materials_pbrSpecularGlossiness", OBJECT, false, SPECULAR_GLOSSINESS, 0, 0},
    {EMISSIVE_STRENGTH, "emissiveStrength", NUMBER, false, 0, 0, MAX_NUMBER},
    {TRANSMISSION, "transmissionFactor", NUMBER, false, 0, 0, MAX_NUMBER},
    {SPECULAR_GLOSSINESS, "diffuseFactor", NUMBERS, false, 0, 4, 4},
    {SPECULAR_GLOSSINESS, "diffuseTexture", OBJECT, false, TEXTURE_INFO, 0, 0},
    {INFO_EXTENSIONS, "KHR_texture_transform", OBJECT, false, TEXTURE_TRANSFORM, 0, 0},
    {TEXTURE_TRANSFORM, "offset", NUMBERS, false, 0, 2, 2},
    {TEXTURE_TRANSFORM, "rotation", NUMBER, false, 0, -1e6, 1e6},
    {TEXTURE_TRANSFORM, "scale", NUMBERS, false, 0, 2, 2},
    {TEXTURE_TRANSFORM, "texCoord", UINT, false, 0, 0, MAX_UINT},
};

typedef struct checker {
    const lmb_gltf_file *file;
    lmb_error *error;
    uint32_t counts[LIST_COUNT];
} checker;

#define FAIL(check, ...) lmb_error_set((check)->error, LMB_ERROR_FORMAT, __VA_ARGS__)

static lmb_result check_object(const checker *check, object_kind kind, const cJSON *object, const char *where);

static bool is_integer_between(const cJSON *item, double low, double high)
{
    return cJSON_IsNumber(item) && item->valuedouble >= low && item->valuedouble <= high &&
           item->valuedouble == floor(item->valuedouble);
}

static lmb_result check_index(const checker *check, int list, const cJSON *item, const char *where)
{
    if (!is_integer_between(item, 0, MAX_UINT)) {
        return FAIL(check, "%s: %s: not an index", check->file->path, where);
    }
    if (item->valuedouble >= check->counts[list]) {
        return FAIL(check, "%s: %s: %.0f, but there are %u %s", check->file->path, where, item->valuedouble,
                    check->counts[list], list_names[list]);
    }
    return LMB_OK;
}

static lmb_result check_attributes(const checker *check, const cJSON *object, const char *where)
{
    if (!cJSON_IsObject(object)) {
        return FAIL(check, "%s: %s: not an object", check->file->path, where);
    }
    const cJSON *item;
    cJSON_ArrayForEach(item, object)
    {
        char inner[LMB_GLTF_WHERE_SIZE];
        lmb_gltf_where(inner, "%s.%s", where, item->string);
        const lmb_result result = check_index(check, ACCESSORS, item, inner);
        if (result != LMB_OK) {
            return result;
        }
    }
    return LMB_OK;
}

/* The elements of a list, by the list's type. */
static lmb_result check_element(const checker *check, const rule *r, const cJSON *item, const char *where)
{
    switch (r->type) {
    case STRINGS:
        return cJSON_IsString(item) ? LMB_OK : FAIL(check, "%s: %s: not a string", check->file->path, where);
    case NUMBERS:
        return cJSON_IsNumber(item) && fabs(item->valuedouble) <= MAX_NUMBER
                   ? LMB_OK
                   : FAIL(check, "%s: %s: not a finite number", check->file->path, where);
    case INDICES:
        return check_index(check, r->detail, item, where);
    case TARGETS:
        return check_attributes(check, item, where);
    default:
        return check_object(check, (object_kind)r->detail, item, where);
    }
}

static lmb_result check_list(const checker *check, const rule *r, const cJSON *list, const char *where)
{
    if (!cJSON_IsArray(list)) {
        return FAIL(check, "%s: %s: not an array", check->file->path, where);
    }
    unsigned count = 0;
    const cJSON *item;
    cJSON_ArrayForEach(item, list)
    {
        char inner[LMB_GLTF_WHERE_SIZE];
        lmb_gltf_where(inner, "%s[%u]", where, count++);
        const lmb_result result = check_element(check, r, item, inner);
        if (result != LMB_OK) {
            return result;
        }
    }
    if (r->type == NUMBERS && (count < r->low || count > r->high)) {
        return FAIL(check, "%s: %s: %u numbers, not %.0f", check->file->path, where, count, r->low);
    }
    return LMB_OK;
}

static lmb_result check_value(const checker *check, const rule *r, const cJSON *item, const char *where)
{
    const char *const path = check->file->path;
    switch (r->type) {
    case STRING:
        return cJSON_IsString(item) ? LMB_OK : FAIL(check, "%s: %s: not a string", path, where);
    case BOOL:
        return cJSON_IsBool(item) ? LMB_OK : FAIL(check, "%s: %s: neither true nor false", path, where);
    case UINT:
        return is_integer_between(item, r->low, r->high)
                   ? LMB_OK
                   : FAIL(check, "%s: %s: not an integer from %.0f to %.0f", path, where, r->low, r->high);
    case NUMBER:
        return cJSON_IsNumber(item) && item->valuedouble >= r->low && item->valuedouble <= r->high
                   ? LMB_OK
                   : FAIL(check, "%s: %s: not a number from %.4g to %.4g", path, where, r->low, r->high);
    case INDEX:
        return check_index(check, r->detail, item, where);
    case ATTRIBUTES:
        return check_attributes(check, item, where);
    case OBJECT:
        return check_object(check, (object_kind)r->detail, item, where);
    default:
        return check_list(check, r, item, where);
    }
}

static lmb_result check_object(const checker *check, object_kind kind, const cJSON *object, const char *where)
{
    if (!cJSON_IsObject(object)) {
        return FAIL(check, "%s: %s: not an object", check->file->path, where);
    }
    for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i) {
        if (rules[i].of != kind) {
            continue;
        }
        const cJSON *const item = cJSON_GetObjectItemCaseSensitive(object, rules[i].name);
        char inner[LMB_GLTF_WHERE_SIZE];
        lmb_gltf_where(inner, "%s%s%s", where, *where ? "." : "", rules[i].name);
        if (!item && rules[i].required) {
            return FAIL(check, "%s: %s: missing", check->file->path, inner);
        }
        const lmb_result result = item ? check_value(check, &rules[i], item, inner) : LMB_OK;
        if (result != LMB_OK) {
            return result;
        }
    }
    return LMB_OK;
}

lmb_result lmb_gltf_check_schema(const lmb_gltf_file *file, lmb_error *error)
{
    checker check = {.file = file, .error = error};
    const cJSON *const lights =
        cJSON_GetObjectItemCaseSensitive(lmb_gltf_extension(file->root, "KHR_lights_punctual"), "lights");
    for (int i = 0; i < LIST_COUNT; ++i) {
        const cJSON *const list = i == LIGHTS ? lights : cJSON_GetObjectItemCaseSensitive(file->root, list_names[i]);
        check.counts[i] = cJSON_IsArray(list) ? (uint32_t)cJSON_GetArraySize(list) : 0;
    }
    return check_object(&check, ROOT, file->root, "");
}
