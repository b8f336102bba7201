#include <lambent/material.h>

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

#include "scene/scene_internal.h"

/* How far from 1 the length of what is called unit may be. */
#define UNIT_TOLERANCE 1e-4

void lmb_mesh_free(lmb_mesh *mesh)
{
    free(mesh->name);
    free(mesh->position);
    free(mesh->normal);
    free(mesh->tangent);
    for (int set = 0; set < LMB_UV_SETS; ++set) {
        free(mesh->uv[set]);
    }
    free(mesh->color);
    free(mesh->triangle);
    free(mesh->material);
    free(mesh->source_primitive);
    free(mesh->source_triangle);
}

void lmb_scene_clear_nodes(lmb_scene *scene)
{
    for (uint32_t i = 0; i < scene->mesh_count; ++i) {
        lmb_mesh_free(&scene->meshes[i]);
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        free(scene->instances[i].name);
    }
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        free(scene->lights[i].name);
    }
    for (uint32_t i = 0; scene->seed_names && i < scene->seed_point_count; ++i) {
        free(scene->seed_names[i]);
    }
    for (uint32_t i = 0; i < scene->cube_point_count; ++i) {
        free(scene->cube_names[i]);
    }
    for (uint32_t i = 0; i < scene->camera_count; ++i) {
        free(scene->cameras[i].name);
    }
    for (uint32_t i = 0; i < scene->probe_box_count; ++i) {
        free(scene->probe_boxes[i].name);
    }
    free(scene->probe_boxes);
    free(scene->meshes);
    free(scene->instances);
    free(scene->lights);
    free(scene->seed_points);
    free(scene->seed_names);
    free(scene->path_points);
    free(scene->cube_points);
    free(scene->cube_names);
    free(scene->cameras);
    scene->meshes = NULL;
    scene->instances = NULL;
    scene->lights = NULL;
    scene->seed_points = NULL;
    scene->seed_names = NULL;
    scene->path_points = NULL;
    scene->cameras = NULL;
    scene->probe_boxes = NULL;
    scene->cube_points = NULL;
    scene->cube_names = NULL;
    scene->cube_point_count = 0;
    scene->mesh_count = scene->instance_count = scene->light_count = scene->key_light_count = 0;
    scene->seed_point_count = scene->path_point_count = scene->camera_count = scene->probe_box_count = 0;
    scene->dropped_triangle_count = 0;
}

void lmb_scene_destroy(lmb_scene *scene)
{
    if (!scene) {
        return;
    }
    lmb_scene_clear_nodes(scene);
    for (uint32_t i = 0; i < scene->material_count; ++i) {
        free(scene->materials[i].name);
    }
    for (uint32_t i = 0; i < scene->image_count; ++i) {
        free(scene->images[i].name);
        free(scene->images[i].rgba);
    }
    free(scene->materials);
    free(scene->lit);
    free(scene->images);
    free(scene->environment.image.rgb);
    free(scene->environment.taken);
    free(scene->path);
    free(scene);
}

lmb_result lmb_scene_add_sun(lmb_scene *scene, const lmb_environment_sun *sun)
{
    static const char SUN_NAME[] = "the environment's sun";
    lmb_light *const lights = realloc(scene->lights, (scene->light_count + 1u) * sizeof *lights);
    char *const name = malloc(sizeof SUN_NAME);
    scene->lights = lights ? lights : scene->lights;
    if (!lights || !name) {
        free(name);
        return LMB_ERROR_MEMORY;
    }
    memcpy(name, SUN_NAME, sizeof SUN_NAME);
    lights[scene->light_count++] = (lmb_light){.name = name,
                                               .type = LMB_LIGHT_DIRECTIONAL,
                                               .direction = lmb_vec3_scale(sun->direction, -1.0f),
                                               .intensity = sun->irradiance,
                                               .angle_rad = sun->angle_rad};
    return LMB_OK;
}

lmb_vec3 lmb_scene_from_world(const lmb_scene *scene, lmb_vec3d world)
{
    return lmb_vec3_of((float)(world.x - scene->origin.x), (float)(world.y - scene->origin.y),
                       (float)(world.z - scene->origin.z));
}

lmb_vec3d lmb_scene_to_world(const lmb_scene *scene, lmb_vec3 position)
{
    return (lmb_vec3d){(double)position.x + scene->origin.x, (double)position.y + scene->origin.y,
                       (double)position.z + scene->origin.z};
}

float lmb_scene_position_step(const lmb_scene *scene)
{
    float coarsest = 0.0f;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (!scene->instances[i].dynamic) {
            coarsest = lmb_larger(coarsest, scene->instances[i].position_step);
        }
    }
    return coarsest;
}

static bool is_finite3(lmb_vec3 v)
{
    return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

static bool is_unit(lmb_vec3 v)
{
    const double x = (double)v.x, y = (double)v.y, z = (double)v.z;
    return fabs(sqrt(x * x + y * y + z * z) - 1.0) <= UNIT_TOLERANCE;
}

static bool is_light_colour(lmb_rgb c)
{
    return isfinite(c.c[0]) && isfinite(c.c[1]) && isfinite(c.c[2]) && c.c[0] >= 0.0f && c.c[1] >= 0.0f &&
           c.c[2] >= 0.0f;
}

/* What is wrong with a vertex, or NULL. */
static const char *vertex_fault(const lmb_mesh *mesh, uint32_t v)
{
    if (!is_finite3(mesh->position[v])) {
        return "position is not finite";
    }
    if (!is_unit(mesh->normal[v])) {
        return "normal is not a unit vector";
    }
    for (int set = 0; set < LMB_UV_SETS; ++set) {
        if (mesh->uv[set] && !(isfinite(mesh->uv[set][v].x) && isfinite(mesh->uv[set][v].y))) {
            return "UV is not finite";
        }
    }
    for (int c = 0; mesh->color && c < 4; ++c) {
        if (!(mesh->color[v][c] >= 0.0f && mesh->color[v][c] <= 1.0f)) {
            return "colour is outside [0, 1]";
        }
    }
    if (mesh->tangent) {
        const float *const t = mesh->tangent[v];
        const bool none = t[0] == 0.0f && t[1] == 0.0f && t[2] == 0.0f && t[3] == 0.0f;
        if (!none && (!is_unit(lmb_vec3_of(t[0], t[1], t[2])) || fabsf(t[3]) != 1.0f)) {
            return "tangent is not a unit vector with a sign";
        }
    }
    return NULL;
}

static lmb_result validate_mesh(const lmb_scene *scene, uint32_t index, lmb_error *error)
{
    const lmb_mesh *const mesh = &scene->meshes[index];
    if (!mesh->position || !mesh->normal || !mesh->triangle || !mesh->material || !mesh->source_primitive ||
        !mesh->source_triangle) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: mesh %u: arrays are missing", scene->path, index);
    }
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        const char *const fault = vertex_fault(mesh, v);
        if (fault) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: mesh %u: vertex %u: %s", scene->path, index, v, fault);
        }
    }
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const uint32_t *const corner = mesh->triangle[t];
        if (corner[0] >= mesh->vertex_count || corner[1] >= mesh->vertex_count || corner[2] >= mesh->vertex_count) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: mesh %u: triangle %u: corner out of range", scene->path,
                                 index, t);
        }
        if (mesh->material[t] >= scene->material_count) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: mesh %u: triangle %u: material out of range",
                                 scene->path, index, t);
        }
    }
    return LMB_OK;
}

static bool affine_is_finite(const lmb_affine *t)
{
    for (int k = 0; k < 12; ++k) {
        if (!isfinite(t->m[k / 4][k % 4])) {
            return false;
        }
    }
    return true;
}

static double determinant(const lmb_affine *t)
{
    return t->m[0][0] * (t->m[1][1] * t->m[2][2] - t->m[1][2] * t->m[2][1]) -
           t->m[0][1] * (t->m[1][0] * t->m[2][2] - t->m[1][2] * t->m[2][0]) +
           t->m[0][2] * (t->m[1][0] * t->m[2][1] - t->m[1][1] * t->m[2][0]);
}

static lmb_result validate_instance(const lmb_scene *scene, uint32_t index, lmb_error *error)
{
    const lmb_instance *const instance = &scene->instances[index];
    const char *fault = NULL;
    if (instance->mesh >= scene->mesh_count) {
        fault = "mesh out of range";
    } else if (!affine_is_finite(&instance->to_world) || !affine_is_finite(&instance->normal_to_world)) {
        fault = "transform is not finite";
    } else if ((determinant(&instance->to_world) < 0.0) != instance->mirrored) {
        fault = "mirrored contradicts the transform";
    }
    /* M^T N = 1 for the inverse transpose. */
    for (int k = 0; k < 9 && !fault; ++k) {
        double dot = 0.0, scale = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            const double product = instance->to_world.m[axis][k / 3] * instance->normal_to_world.m[axis][k % 3];
            dot += product;
            scale += fabs(product);
        }
        if (fabs(dot - (k / 3 == k % 3 ? 1.0 : 0.0)) > 1e-6 * fmax(scale, 1.0)) {
            fault = "normal transform is not the inverse transpose";
        }
    }
    return fault ? lmb_error_set(error, LMB_ERROR_FORMAT, "%s: instance %u: %s", scene->path, index, fault) : LMB_OK;
}

static const char *texture_fault(const lmb_scene *scene, const lmb_texture *texture)
{
    if (texture->image < -1 || texture->image >= (int64_t)scene->image_count) {
        return "image out of range";
    }
    if (texture->uv_set < 0 || texture->uv_set >= LMB_UV_SETS) {
        return "UV set out of range";
    }
    for (int k = 0; k < 6; ++k) {
        if (!isfinite(texture->transform[k / 3][k % 3])) {
            return "texture transform is not finite";
        }
    }
    return NULL;
}

static lmb_result validate_material(const lmb_scene *scene, uint32_t index, lmb_error *error)
{
    const lmb_material *const material = &scene->materials[index];
    const lmb_texture *const textures[] = {&material->base_color_texture, &material->emissive_texture,
                                           &material->normal_texture, &material->metallic_roughness_texture};
    const char *fault = NULL;
    for (size_t i = 0; i < sizeof textures / sizeof textures[0] && !fault; ++i) {
        fault = texture_fault(scene, textures[i]);
    }
    for (int c = 0; c < 4 && !fault; ++c) {
        fault =
            material->base_color[c] >= 0.0f && material->base_color[c] <= 1.0f ? NULL : "base colour is outside [0, 1]";
    }
    if (!fault && !is_light_colour(material->emissive)) {
        fault = "emissive is negative or not finite";
    }
    if (!fault && !(material->transmission >= 0.0f && material->transmission <= 1.0f)) {
        fault = "transmission is outside [0, 1]";
    }
    if (!fault && !(material->metallic >= 0.0f && material->metallic <= 1.0f && material->roughness >= 0.0f &&
                    material->roughness <= 1.0f)) {
        fault = "metalness or roughness is outside [0, 1]";
    }
    if (!fault && !(isfinite(material->alpha_cutoff) && isfinite(material->normal_scale))) {
        fault = "alpha cutoff or normal scale is not finite";
    }
    return fault ? lmb_error_set(error, LMB_ERROR_FORMAT, "%s: material %u: %s", scene->path, index, fault) : LMB_OK;
}

static lmb_result validate_light(const lmb_scene *scene, uint32_t index, lmb_error *error)
{
    const lmb_light *const light = &scene->lights[index];
    const char *fault = NULL;
    if (!is_finite3(light->position)) {
        fault = "position is not finite";
    } else if (light->type != LMB_LIGHT_POINT && !is_unit(light->direction)) {
        fault = "direction is not a unit vector";
    } else if (!is_light_colour(light->intensity)) {
        fault = "intensity is negative or not finite";
    } else if (!(light->range >= 0.0f && isfinite(light->range))) {
        fault = "range is negative or not finite";
    } else if (!(light->radius >= 0.0f && isfinite(light->radius))) {
        fault = "radius is negative or not finite";
    } else if (!(light->angle_rad >= 0.0f && light->angle_rad <= LMB_PI_F)) {
        fault = "angle is not between 0 and pi";
    } else if (light->type == LMB_LIGHT_SPOT &&
               !(light->cos_inner >= light->cos_outer && light->cos_inner <= 1.0f && light->cos_outer >= -1.0f)) {
        fault = "cone is inside out";
    }
    return fault ? lmb_error_set(error, LMB_ERROR_FORMAT, "%s: light %u: %s", scene->path, index, fault) : LMB_OK;
}

static lmb_result validate_points(const lmb_scene *scene, lmb_error *error)
{
    if (!isfinite(scene->origin.x) || !isfinite(scene->origin.y) || !isfinite(scene->origin.z)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: origin: not finite", scene->path);
    }
    for (uint32_t i = 0; i < scene->seed_point_count; ++i) {
        if (!is_finite3(scene->seed_points[i])) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: seed point %u: not finite", scene->path, i);
        }
    }
    for (uint32_t i = 0; i < scene->path_point_count; ++i) {
        if (!is_finite3(scene->path_points[i])) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: path point %u: not finite", scene->path, i);
        }
    }
    for (uint32_t i = 0; i < scene->cube_point_count; ++i) {
        if (!is_finite3(scene->cube_points[i])) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: cube map %u: not finite", scene->path, i);
        }
    }
    if (!is_finite3(scene->bounds_min) || !is_finite3(scene->bounds_max)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: bounds: not finite", scene->path);
    }
    return LMB_OK;
}

lmb_result lmb_scene_validate(const lmb_scene *scene, lmb_error *error)
{
    assert(scene);
    lmb_result result = LMB_OK;
    if (scene->material_count == 0) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: no material", scene->path);
    }
    for (uint32_t i = 0; i < scene->image_count; ++i) {
        const lmb_texture_image *const image = &scene->images[i];
        if (image->width < 1 || image->height < 1 || !image->rgba) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: image %u: has no pixels", scene->path, i);
        }
    }
    for (uint32_t i = 0; i < scene->material_count && result == LMB_OK; ++i) {
        result = validate_material(scene, i, error);
    }
    for (uint32_t i = 0; i < scene->mesh_count && result == LMB_OK; ++i) {
        result = validate_mesh(scene, i, error);
    }
    for (uint32_t i = 0; i < scene->instance_count && result == LMB_OK; ++i) {
        result = validate_instance(scene, i, error);
    }
    for (uint32_t i = 0; i < scene->light_count && result == LMB_OK; ++i) {
        result = validate_light(scene, i, error);
    }
    return result == LMB_OK ? validate_points(scene, error) : result;
}

static bool environment_has_light(const lmb_environment *environment)
{
    if (!environment->present || !(environment->strength > 0.0f)) {
        return false;
    }
    if (!environment->image.rgb) {
        return lmb_rgb_max(environment->constant) > 0.0f;
    }
    const size_t count = (size_t)environment->image.width * (size_t)environment->image.height * 3;
    for (size_t i = 0; i < count; ++i) {
        if (environment->image.rgb[i] > 0.0f) {
            return true;
        }
    }
    return false;
}

/* Whether a material gives light anywhere: exporters write a factor of 1 beside textures that are all black. */
static bool material_has_light(const lmb_scene *scene, const lmb_material *material)
{
    if (!lmb_material_emits(material)) {
        return false;
    }
    const int32_t index = material->emissive_texture.image;
    if (index < 0 || (uint32_t)index >= scene->image_count) {
        return true;
    }
    const lmb_texture_image *image = &scene->images[index];
    const size_t count = 4 * (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < count; ++i) {
        if (i % 4 < 3 && image->rgba[i] > 0 && material->emissive.c[i % 4] > 0.0f) {
            return true;
        }
    }
    return false;
}

bool lmb_scene_has_light(const lmb_scene *scene)
{
    assert(scene);
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        if (lmb_rgb_max(scene->lights[i].intensity) > 0.0f) {
            return true;
        }
    }
    uint32_t dark = UINT32_MAX; /* the last material that was found to be */
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_mesh *const mesh = &scene->meshes[scene->instances[i].mesh];
        for (uint32_t t = 0; t < mesh->triangle_count && !scene->instances[i].dynamic; ++t) {
            if (mesh->material[t] != dark && material_has_light(scene, &scene->materials[mesh->material[t]])) {
                return true;
            }
            dark = mesh->material[t];
        }
    }
    return environment_has_light(&scene->environment);
}
