/* What the file says of its nodes, apart from where they are. */
#include "gltf/gltf_nodes.h"

#include "gltf/gltf_extensions.h"
#include "gltf/gltf_json.h"

float lmb_gltf_view_angle(const lmb_gltf_file *file, int32_t camera)
{
    const cJSON *item = cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(file->root, "cameras"), camera);
    const cJSON *angle =
        cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(item, "perspective"), "yfov");
    const bool is_told = cJSON_IsNumber(angle) && angle->valuedouble > 0.0 && angle->valuedouble < 3.14;
    return is_told ? (float)angle->valuedouble : 0.0f;
}

static bool any_node_matches(const lmb_gltf_file *file, const char *pattern)
{
    const cJSON *node;
    uint32_t index = 0;
    cJSON_ArrayForEach(node, cJSON_GetObjectItemCaseSensitive(file->root, "nodes"))
    {
        char own[LMB_GLTF_WHERE_SIZE];
        const char *name = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(node, "name"));
        lmb_gltf_where(own, "node %u", index++);
        if (lmb_gltf_name_matches(pattern, name && name[0] ? name : own)) {
            return true;
        }
    }
    return false;
}

void lmb_gltf_excludes_warn(const lmb_gltf_file *file, const lmb_gltf_options *options)
{
    for (size_t i = 0; i < options->exclude_count; ++i) {
        if (!any_node_matches(file, options->exclude[i])) {
            lmb_warn(&options->warnings, "%s: no node has a name like '%s': it excludes nothing", file->path,
                     options->exclude[i]);
        }
    }
}
