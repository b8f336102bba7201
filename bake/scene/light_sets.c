#include <lambent/light_sets.h>

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

static bool name_is_good(const char *name)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
    const size_t length = strlen(name);
    return length > 0 && length < LMB_LIGHT_SET_NAME && strspn(name, letters) == length;
}

lmb_result lmb_scene_light_set(lmb_scene *scene, const char *name, uint32_t *set)
{
    assert(scene && name && set);
    if (!name_is_good(name)) {
        return LMB_ERROR_ARGUMENT;
    }
    uint32_t at = 0;
    while (at < scene->light_set_count && strcmp(scene->light_set_name[at], name) != 0) {
        ++at;
    }
    if (at == LMB_LIGHT_SETS_MOST) {
        return LMB_ERROR_UNSUPPORTED;
    }
    if (at == scene->light_set_count) {
        strcpy(scene->light_set_name[at], name);
        ++scene->light_set_count;
    }
    *set = at + 1;
    return LMB_OK;
}

const char *lmb_scene_light_set_name(const lmb_scene *scene, uint32_t set)
{
    assert(set <= scene->light_set_count);
    return set > 0 ? scene->light_set_name[set - 1] : "";
}

/* Of a material or light of that set. */
static bool is_shown(const lmb_scene *scene, uint32_t set)
{
    return scene->light_set_hides_others ? set == scene->light_set_shown : true;
}

bool lmb_scene_light_set_is_used(const lmb_scene *scene, uint32_t set)
{
    bool used = scene->environment.present && scene->environment.set == set;
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        used = used || (scene->lights[i].set == set && lmb_rgb_max(scene->lights[i].intensity) > 0.0f);
    }
    for (uint32_t i = 0; i < scene->material_count; ++i) {
        used = used || (scene->materials[i].set == set && lmb_rgb_max(scene->materials[i].emissive) > 0.0f);
    }
    return used;
}

lmb_result lmb_scene_show_light_set(lmb_scene *scene, uint32_t set)
{
    assert(scene && (set == LMB_LIGHT_SETS_ALL || set <= scene->light_set_count));
    if (!scene->lit) {
        scene->lit = malloc((scene->material_count + 1u) * sizeof *scene->lit);
        for (uint32_t i = 0; scene->lit && i < scene->material_count; ++i) {
            scene->lit[i] = scene->materials[i].emissive;
        }
    }
    if (!scene->lit) {
        return LMB_ERROR_MEMORY;
    }
    if (!scene->light_set_hides_others) {
        scene->environment_lit = scene->environment.present;
        memcpy(scene->key_light_lit, scene->key_light, sizeof scene->key_light);
        scene->key_light_lit_count = scene->key_light_count;
    }
    scene->light_set_hides_others = set != LMB_LIGHT_SETS_ALL;
    scene->light_set_shown = set;
    for (uint32_t i = 0; i < scene->material_count; ++i) {
        const bool shown = is_shown(scene, scene->materials[i].set);
        scene->materials[i].emissive = shown ? scene->lit[i] : lmb_rgb_of(0.0f, 0.0f, 0.0f);
    }
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        scene->lights[i].dark = !is_shown(scene, scene->lights[i].set);
    }
    scene->environment.present = scene->environment_lit && is_shown(scene, scene->environment.set);
    scene->key_light_count = 0;
    for (uint32_t i = 0; i < scene->key_light_lit_count; ++i) {
        if (!scene->lights[scene->key_light_lit[i]].dark) {
            scene->key_light[scene->key_light_count++] = scene->key_light_lit[i];
        }
    }
    return LMB_OK;
}
