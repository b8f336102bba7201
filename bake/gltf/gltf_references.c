#include "gltf/gltf_references.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gltf/gltf_json.h"

/* What a vertex attribute may be; quantised forms are KHR_mesh_quantization's. */
typedef struct attribute_form {
    const char *name;
    uint32_t components; /* 0: 3 or 4 */
    bool integers;       /* integers that are not normalised will do */
    bool only_integers;
    bool normalized_allowed; /* normalised integers will do */
} attribute_form;

static const attribute_form attribute_forms[] = {
    {"POSITION", 3, true, false, true},   {"NORMAL", 3, false, false, true},    {"TANGENT", 4, false, false, true},
    {"TEXCOORD_0", 2, true, false, true}, {"TEXCOORD_1", 2, true, false, true}, {"COLOR_0", 0, false, false, true},
    {"JOINTS_0", 4, true, true, false},   {"JOINTS_1", 4, true, true, false},   {"WEIGHTS_0", 4, false, false, true},
    {"WEIGHTS_1", 4, false, false, true},
};

static bool form_fits(const attribute_form *form, const lmb_gltf_accessor *accessor)
{
    const bool components_fit = form->components ? accessor->components == form->components
                                                 : accessor->components == 3 || accessor->components == 4;
    if (!components_fit || accessor->component_type == LMB_GLTF_UNSIGNED_INT) {
        return false;
    }
    if (accessor->component_type == LMB_GLTF_FLOAT) {
        return !form->only_integers;
    }
    return accessor->normalized ? form->normalized_allowed : form->integers;
}

bool lmb_gltf_is_uv(const lmb_gltf_accessor *accessor)
{
    static const attribute_form form = {"TEXCOORD", 2, true, false, true};
    return form_fits(&form, accessor);
}

static lmb_result require_bytes(const lmb_gltf_file *file, uint32_t accessor, const char *where, lmb_error *error)
{
    if (file->accessors[accessor].missing) {
        return lmb_error_set(error, LMB_ERROR_FORMAT,
                             "%s: %s: accessors[%u] is of a buffer with neither a uri nor a binary chunk", file->path,
                             where, accessor);
    }
    return LMB_OK;
}

static lmb_result check_attribute_set(const lmb_gltf_file *file, const cJSON *attributes, bool target,
                                      uint32_t vertex_count, const char *where, lmb_error *error)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, attributes)
    {
        const lmb_gltf_accessor *const accessor = &file->accessors[(uint32_t)item->valuedouble];
        if (accessor->count != vertex_count) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.%s: %u elements for %u vertices", file->path, where,
                                 item->string, accessor->count, vertex_count);
        }
        const lmb_result result = require_bytes(file, (uint32_t)item->valuedouble, where, error);
        if (result != LMB_OK) {
            return result;
        }
        for (size_t i = 0; i < sizeof attribute_forms / sizeof *attribute_forms; ++i) {
            attribute_form form = attribute_forms[i];
            if (strcmp(item->string, form.name) != 0) {
                continue;
            }
            if (target && strcmp(form.name, "TANGENT") == 0) {
                form.components = 3; /* handedness does not morph */
            }
            if (!form_fits(&form, accessor)) {
                return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.%s: accessors[%u] is of a wrong type", file->path,
                                     where, item->string, (uint32_t)item->valuedouble);
            }
        }
    }
    return LMB_OK;
}

static lmb_result check_primitive(const lmb_gltf_file *file, const cJSON *primitive, const char *where,
                                  lmb_error *error)
{
    const cJSON *const attributes = cJSON_GetObjectItemCaseSensitive(primitive, "attributes");
    const cJSON *const position = cJSON_GetObjectItemCaseSensitive(attributes, "POSITION");
    if (!position) {
        return LMB_OK; /* nothing to see, which glTF allows */
    }
    const uint32_t vertex_count = file->accessors[(uint32_t)position->valuedouble].count;
    char inner[LMB_GLTF_WHERE_SIZE];
    lmb_gltf_where(inner, "%s.attributes", where);
    lmb_result result = check_attribute_set(file, attributes, false, vertex_count, inner, error);
    const cJSON *target;
    unsigned index = 0;
    cJSON_ArrayForEach(target, cJSON_GetObjectItemCaseSensitive(primitive, "targets"))
    {
        lmb_gltf_where(inner, "%s.targets[%u]", where, index++);
        if (result == LMB_OK) {
            result = check_attribute_set(file, target, true, vertex_count, inner, error);
        }
    }
    if (result != LMB_OK || !cJSON_GetObjectItemCaseSensitive(primitive, "indices")) {
        return result;
    }
    const uint32_t indices_accessor = lmb_gltf_uint(primitive, "indices", 0);
    const lmb_gltf_accessor *const indices = &file->accessors[indices_accessor];
    const bool integers = indices->component_type == LMB_GLTF_UNSIGNED_BYTE ||
                          indices->component_type == LMB_GLTF_UNSIGNED_SHORT ||
                          indices->component_type == LMB_GLTF_UNSIGNED_INT;
    if (!integers || indices->components != 1 || indices->normalized) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.indices: accessors[%u] is not of unsigned integers",
                             file->path, where, indices_accessor);
    }
    return require_bytes(file, indices_accessor, where, error);
}

static lmb_result check_meshes(const lmb_gltf_file *file, lmb_error *error)
{
    const cJSON *mesh, *primitive;
    unsigned mesh_index = 0;
    cJSON_ArrayForEach(mesh, cJSON_GetObjectItemCaseSensitive(file->root, "meshes"))
    {
        unsigned index = 0;
        cJSON_ArrayForEach(primitive, cJSON_GetObjectItemCaseSensitive(mesh, "primitives"))
        {
            char where[LMB_GLTF_WHERE_SIZE];
            lmb_gltf_where(where, "meshes[%u].primitives[%u]", mesh_index, index++);
            const lmb_result result = check_primitive(file, primitive, where, error);
            if (result != LMB_OK) {
                return result;
            }
        }
        ++mesh_index;
    }
    return LMB_OK;
}

static lmb_result check_skins(const lmb_gltf_file *file, lmb_error *error)
{
    const cJSON *skin;
    unsigned index = 0;
    cJSON_ArrayForEach(skin, cJSON_GetObjectItemCaseSensitive(file->root, "skins"))
    {
        const int joint_count = cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(skin, "joints"));
        const uint32_t matrices = lmb_gltf_uint(skin, "inverseBindMatrices", UINT32_MAX);
        if (matrices != UINT32_MAX) {
            const lmb_gltf_accessor *const accessor = &file->accessors[matrices];
            if (accessor->components != 16 || accessor->component_type != LMB_GLTF_FLOAT ||
                accessor->count < (uint32_t)joint_count) {
                return lmb_error_set(error, LMB_ERROR_FORMAT,
                                     "%s: skins[%u].inverseBindMatrices: accessors[%u] is not %d float matrices",
                                     file->path, index, matrices, joint_count);
            }
            char where[LMB_GLTF_WHERE_SIZE];
            lmb_gltf_where(where, "skins[%u].inverseBindMatrices", index);
            const lmb_result result = require_bytes(file, matrices, where, error);
            if (result != LMB_OK) {
                return result;
            }
        }
        ++index;
    }
    return LMB_OK;
}

/* EXT_mesh_gpu_instancing: equal counts, known types. */
static lmb_result check_instancing(const lmb_gltf_file *file, const cJSON *node, unsigned index, lmb_error *error)
{
    const cJSON *const extension = lmb_gltf_extension(node, "EXT_mesh_gpu_instancing");
    const cJSON *item;
    uint32_t count = UINT32_MAX;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(extension, "attributes"))
    {
        const lmb_gltf_accessor *const accessor = &file->accessors[(uint32_t)item->valuedouble];
        const bool rotation = strcmp(item->string, "ROTATION") == 0;
        const bool vector = strcmp(item->string, "TRANSLATION") == 0 || strcmp(item->string, "SCALE") == 0;
        count = count == UINT32_MAX ? accessor->count : count;
        const bool is_float = accessor->component_type == LMB_GLTF_FLOAT;
        if (accessor->count != count || (vector && (accessor->components != 3 || !is_float)) ||
            (rotation && (accessor->components != 4 || !(is_float || accessor->normalized)))) {
            return lmb_error_set(error, LMB_ERROR_FORMAT,
                                 "%s: nodes[%u].extensions.EXT_mesh_gpu_instancing.%s: accessors[%u] does not fit",
                                 file->path, index, item->string, (uint32_t)item->valuedouble);
        }
        char where[LMB_GLTF_WHERE_SIZE];
        lmb_gltf_where(where, "nodes[%u].extensions.EXT_mesh_gpu_instancing", index);
        const lmb_result result = require_bytes(file, (uint32_t)item->valuedouble, where, error);
        if (result != LMB_OK) {
            return result;
        }
    }
    return LMB_OK;
}

static lmb_result check_node(const lmb_gltf_file *file, const cJSON *node, unsigned index, lmb_error *error)
{
    if (cJSON_GetObjectItemCaseSensitive(node, "skin") && !cJSON_GetObjectItemCaseSensitive(node, "mesh")) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: nodes[%u]: a skin without a mesh", file->path, index);
    }
    return check_instancing(file, node, index, error);
}

/* Every node has at most one parent, which `parent` gets. */
static lmb_result find_parents(const lmb_gltf_file *file, uint32_t *parent, uint32_t node_count, lmb_error *error)
{
    const cJSON *node, *child;
    uint32_t node_index = 0;
    for (uint32_t i = 0; i < node_count; ++i) {
        parent[i] = UINT32_MAX;
    }
    cJSON_ArrayForEach(node, cJSON_GetObjectItemCaseSensitive(file->root, "nodes"))
    {
        cJSON_ArrayForEach(child, cJSON_GetObjectItemCaseSensitive(node, "children"))
        {
            const uint32_t index = (uint32_t)child->valuedouble;
            if (parent[index] != UINT32_MAX) {
                return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: nodes[%u].children: node %u has two parents",
                                     file->path, node_index, index);
            }
            parent[index] = node_index;
        }
        const lmb_result result = check_node(file, node, node_index, error);
        if (result != LMB_OK) {
            return result;
        }
        ++node_index;
    }
    return LMB_OK;
}

/* No node is its own ancestor. Up from each node, until a node that an earlier walk has seen: linear in all. `seen` is
 * zero. */
static lmb_result check_ancestors(const lmb_gltf_file *file, const uint32_t *parent, uint32_t *seen,
                                  uint32_t node_count, lmb_error *error)
{
    for (uint32_t i = 0; i < node_count; ++i) {
        uint32_t at = i;
        while (at != UINT32_MAX && seen[at] == 0) {
            seen[at] = i + 1; /* which walk has been here */
            at = parent[at];
        }
        if (at != UINT32_MAX && seen[at] == i + 1) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: nodes[%u]: is its own ancestor", file->path, at);
        }
    }
    return LMB_OK;
}

/* Every scene lists roots, each once. `listed` has room for all nodes. */
static lmb_result check_scenes(const lmb_gltf_file *file, const uint32_t *parent, uint32_t *listed, uint32_t node_count,
                               lmb_error *error)
{
    const cJSON *scene, *node;
    uint32_t scene_index = 0;
    cJSON_ArrayForEach(scene, cJSON_GetObjectItemCaseSensitive(file->root, "scenes"))
    {
        memset(listed, 0, node_count * sizeof *listed);
        cJSON_ArrayForEach(node, cJSON_GetObjectItemCaseSensitive(scene, "nodes"))
        {
            const uint32_t index = (uint32_t)node->valuedouble;
            if (parent[index] != UINT32_MAX || listed[index]++) {
                return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: scenes[%u].nodes: node %u is %s", file->path,
                                     scene_index, index, listed[index] ? "listed twice" : "not a root");
            }
        }
        ++scene_index;
    }
    return LMB_OK;
}

static lmb_result check_hierarchy(const lmb_gltf_file *file, lmb_error *error)
{
    const uint32_t node_count = (uint32_t)cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(file->root, "nodes"));
    uint32_t *const parent = calloc((size_t)node_count * 2 + 1, sizeof *parent);
    if (!parent) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", file->path);
    }
    uint32_t *const state = parent + node_count;
    lmb_result result = find_parents(file, parent, node_count, error);
    if (result == LMB_OK) {
        result = check_ancestors(file, parent, state, node_count, error);
    }
    if (result == LMB_OK) {
        result = check_scenes(file, parent, state, node_count, error);
    }
    free(parent);
    return result;
}

lmb_result lmb_gltf_check_references(const lmb_gltf_file *file, lmb_error *error)
{
    lmb_result result = check_meshes(file, error);
    if (result == LMB_OK) {
        result = check_skins(file, error);
    }
    return result == LMB_OK ? check_hierarchy(file, error) : result;
}
