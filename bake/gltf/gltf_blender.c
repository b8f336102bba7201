/* What Blender's exporter does to light, and does not say. */
#include "gltf/gltf_blender.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

/* Blender's "Standard" lighting mode turns watts into lumens by 683 for lamps, and leaves emission as it is. A lamp
 * that would make a white wall so many times brighter than the brightest lamp-shade was hardly meant so. */
#define LUMENS_PER_WATT 683.0
#define SUSPICIOUS_RATIO 10.0

/* Metres from a lamp to the wall that is thought of. */
#define WALL_DISTANCE 2.0

static bool is_from_blender(const lmb_gltf_file *file)
{
    const char *const generator = cJSON_GetStringValue(
        cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(file->root, "asset"), "generator"));
    return generator && strstr(generator, "Khronos glTF Blender I/O") != NULL;
}

/* Radiance of a white wall in the light of the brightest lamp. */
static double lamp_radiance(const lmb_scene *scene)
{
    double brightest = 0.0;
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        const lmb_light *const light = &scene->lights[i];
        const double distance = light->type == LMB_LIGHT_DIRECTIONAL ? 1.0 : WALL_DISTANCE;
        brightest = fmax(brightest, (double)lmb_rgb_max(light->intensity) / (LMB_PI * distance * distance));
    }
    return brightest;
}

static double emitted_radiance(const lmb_scene *scene)
{
    double brightest = 0.0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_mesh *const mesh = &scene->meshes[scene->instances[i].mesh];
        for (uint32_t t = 0; t < mesh->triangle_count && !scene->instances[i].dynamic; ++t) {
            const lmb_material *const material = &scene->materials[mesh->material[t]];
            brightest = material->unlit ? brightest : fmax(brightest, (double)lmb_rgb_max(material->emissive));
        }
    }
    return brightest;
}

void lmb_gltf_blender_warn_units(const lmb_gltf_file *file, const lmb_scene *scene, const lmb_warnings *warnings)
{
    if (!is_from_blender(file)) {
        return;
    }
    const double emitted = emitted_radiance(scene);
    const double ratio = emitted > 0.0 ? lamp_radiance(scene) / emitted : 0.0;
    if (ratio >= SUSPICIOUS_RATIO) {
        lmb_warn(
            warnings,
            "%s: lamps are some %.0f times as bright as what emits: Blender's \"Standard\" lighting mode multiplies "
            "lamps by %.0f but not emission; export with \"Unitless\", or give --light-scale %.6f",
            file->path, ratio, LUMENS_PER_WATT, 1.0 / LUMENS_PER_WATT);
    }
}

/* "Area", "Area.001", "Area Light": Blender's names of area lamps. */
static bool is_named_area(const char *name)
{
    return name && strncmp(name, "Area", 4) == 0 && !islower((unsigned char)name[4]);
}

static bool is_empty_node(const cJSON *node)
{
    static const char *const contents[] = {"mesh", "camera", "children", "skin", "extensions"};
    for (size_t i = 0; i < sizeof contents / sizeof *contents; ++i) {
        if (cJSON_GetObjectItemCaseSensitive(node, contents[i])) {
            return false;
        }
    }
    return true;
}

void lmb_gltf_blender_warn_area_lamps(const lmb_gltf_file *file, const lmb_warnings *warnings)
{
    unsigned count = 0;
    const char *first = NULL;
    const cJSON *const nodes = is_from_blender(file) ? cJSON_GetObjectItemCaseSensitive(file->root, "nodes") : NULL;
    const cJSON *node;
    cJSON_ArrayForEach(node, nodes)
    {
        const char *const name = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(node, "name"));
        if (is_named_area(name) && is_empty_node(node)) {
            first = first ? first : name;
            ++count;
        }
    }
    if (count > 0) {
        char others[32] = "";
        if (count > 1) {
            snprintf(others, sizeof others, " and %u more", count - 1);
        }
        lmb_warn(warnings,
                 "%s: node '%s'%s is empty and called like an area lamp, which Blender does not export: it gives no "
                 "light; make it an emissive panel",
                 file->path, first, others);
    }
}
