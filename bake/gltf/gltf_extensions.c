/* Which extensions of glTF are read, which cannot matter to a bake, and the warning that names the others. */
#include "gltf/gltf_extensions.h"

#include <stdio.h>
#include <string.h>

typedef enum extension_use {
    IS_READ,      /* may be required */
    IS_NO_MATTER, /* changes neither geometry nor light as they are modelled here; may be required */
    IS_OTHER_FORM /* another form of what core glTF says too: nothing is lost unless the file requires it */
} extension_use;

/* A name that ends with * stands for all that begin so. What is not here is unknown, or known to matter: a file that
 * requires it is refused, one that only uses it gets a warning. */
static const struct {
    const char *name;
    extension_use use;
} extensions[] = {
    {"EXT_mesh_gpu_instancing", IS_READ},
    {"KHR_lights_punctual", IS_READ},
    {"KHR_materials_emissive_strength", IS_READ},
    {"KHR_materials_pbrSpecularGlossiness", IS_READ},
    {"KHR_materials_transmission", IS_READ},
    {"KHR_materials_unlit", IS_READ},
    {"KHR_mesh_quantization", IS_READ},
    {"KHR_node_visibility", IS_READ},
    {"KHR_texture_transform", IS_READ},
    /* what surfaces do beside diffuse reflection, which is not modelled */
    {"ADOBE_materials_clearcoat_*", IS_NO_MATTER},
    {"EXT_materials_bump", IS_NO_MATTER},
    {"KHR_materials_anisotropy", IS_NO_MATTER},
    {"KHR_materials_clearcoat", IS_NO_MATTER},
    {"KHR_materials_dispersion", IS_NO_MATTER},
    {"KHR_materials_ior", IS_NO_MATTER},
    {"KHR_materials_iridescence", IS_NO_MATTER},
    {"KHR_materials_sheen", IS_NO_MATTER},
    {"KHR_materials_specular", IS_NO_MATTER},
    /* what a viewer may choose; the file's own state is baked */
    {"EPIC_animation_playback", IS_NO_MATTER},
    {"EPIC_level_variant_sets", IS_NO_MATTER},
    {"KHR_animation_pointer", IS_NO_MATTER},
    {"KHR_interactivity*", IS_NO_MATTER},
    {"KHR_materials_variants", IS_NO_MATTER},
    {"KHR_node_hoverability", IS_NO_MATTER},
    {"KHR_node_selectability", IS_NO_MATTER},
    /* metadata, sound, physics, characters, light that somebody has baked before */
    {"AGI_*", IS_NO_MATTER},
    {"CESIUM_primitive_outline", IS_NO_MATTER},
    {"EPIC_lightmap_textures", IS_NO_MATTER},
    {"EXT_feature_metadata", IS_NO_MATTER},
    {"EXT_instance_features", IS_NO_MATTER},
    {"EXT_mesh_features", IS_NO_MATTER},
    {"EXT_mesh_manifold", IS_NO_MATTER},
    {"EXT_property_animation", IS_NO_MATTER},
    {"EXT_structural_metadata", IS_NO_MATTER},
    {"FB_geometry_metadata", IS_NO_MATTER},
    {"GODOT_*", IS_NO_MATTER},
    {"KHR_audio*", IS_NO_MATTER},
    {"KHR_collision_shapes", IS_NO_MATTER},
    {"KHR_implicit_shapes", IS_NO_MATTER},
    {"KHR_physics_*", IS_NO_MATTER},
    {"KHR_rigid_bodies", IS_NO_MATTER},
    {"KHR_xmp*", IS_NO_MATTER},
    {"MOZ_lightmap", IS_NO_MATTER},
    {"MSFT_audio_emitter", IS_NO_MATTER},
    {"MSFT_collision_primitives", IS_NO_MATTER},
    {"MSFT_packing_*", IS_NO_MATTER},
    {"MSFT_physics_*", IS_NO_MATTER},
    {"OMI_audio_*", IS_NO_MATTER},
    {"OMI_collider", IS_NO_MATTER},
    {"OMI_link", IS_NO_MATTER},
    {"OMI_personality", IS_NO_MATTER},
    {"OMI_physics_*", IS_NO_MATTER},
    {"OMI_seat", IS_NO_MATTER},
    {"OMI_spawn_point", IS_NO_MATTER},
    {"OMI_vehicle_*", IS_NO_MATTER},
    {"VRM", IS_NO_MATTER},
    {"VRMC_node_constraint", IS_NO_MATTER},
    {"VRMC_springBone*", IS_NO_MATTER},
    {"VRMC_vrm*", IS_NO_MATTER},
    /* pictures: a texture without another source is an error where it is read */
    {"EXT_texture_avif", IS_OTHER_FORM},
    {"EXT_texture_webp", IS_OTHER_FORM},
    {"KHR_texture_basisu", IS_OTHER_FORM},
    {"MSFT_texture_dds", IS_OTHER_FORM},
};

/* Not read, but nothing that must be: light goes straight through without being absorbed, which a file that requires
 * these looks right enough with. */
static const char *const tolerated[] = {"KHR_materials_volume"};

bool lmb_gltf_name_matches(const char *pattern, const char *text)
{
    const char *star = NULL, *resume = NULL;
    while (*text) {
        if (*pattern == '*') {
            star = pattern++;
            resume = text;
        } else if (*pattern == '?' || *pattern == *text) {
            ++pattern;
            ++text;
        } else if (star) {
            pattern = star + 1;
            text = ++resume;
        } else {
            return false;
        }
    }
    while (*pattern == '*') {
        ++pattern;
    }
    return *pattern == '\0';
}

/* An extension_use, or -1. */
static int find_use(const char *name)
{
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; ++i) {
        if (lmb_gltf_name_matches(extensions[i].name, name)) {
            return (int)extensions[i].use;
        }
    }
    return -1;
}

bool lmb_gltf_extension_may_be_required(const char *name)
{
    for (size_t i = 0; i < sizeof tolerated / sizeof *tolerated; ++i) {
        if (strcmp(tolerated[i], name) == 0) {
            return true;
        }
    }
    const int use = find_use(name);
    return use == IS_READ || use == IS_NO_MATTER;
}

void lmb_gltf_extensions_warn(const lmb_gltf_file *file, const lmb_warnings *warnings)
{
    char names[384] = "";
    size_t length = 0;
    unsigned count = 0, left_out = 0;
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(file->root, "extensionsUsed"))
    {
        if (find_use(item->valuestring) >= 0) {
            continue;
        }
        const size_t more = strlen(item->valuestring) + 2;
        ++count;
        if (length + more >= sizeof names) {
            ++left_out;
            continue;
        }
        length +=
            (size_t)snprintf(names + length, sizeof names - length, "%s%s", length > 0 ? ", " : "", item->valuestring);
    }
    if (count > 0) {
        char others[32] = "";
        if (left_out > 0) {
            snprintf(others, sizeof others, " and %u more", left_out);
        }
        lmb_warn(warnings, "%s: not read, though it may change light or geometry: %s%s", file->path, names, others);
    }
}
