#include "render_object.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

enum { SPHERE_COLUMNS = 64, SPHERE_ROWS = 32 };

static void sphere_fill(lmb_mesh *mesh, float radius)
{
    for (uint32_t row = 0; row <= SPHERE_ROWS; ++row) {
        const float polar = LMB_PI_F * (float)row / (float)SPHERE_ROWS;
        for (uint32_t column = 0; column <= SPHERE_COLUMNS; ++column) {
            const float turn = 2.0f * LMB_PI_F * (float)column / (float)SPHERE_COLUMNS;
            const lmb_vec3 raw = {sinf(polar) * sinf(turn), cosf(polar), sinf(polar) * cosf(turn)};
            const lmb_vec3 normal = lmb_vec3_unit_or(raw, (lmb_vec3){0.0f, 1.0f, 0.0f});
            mesh->position[mesh->vertex_count] = lmb_vec3_scale(normal, radius);
            mesh->normal[mesh->vertex_count++] = normal;
        }
    }
    for (uint32_t row = 0; row < SPHERE_ROWS; ++row) {
        for (uint32_t column = 0; column < SPHERE_COLUMNS; ++column) {
            const uint32_t above = row * (SPHERE_COLUMNS + 1) + column;
            const uint32_t below = above + SPHERE_COLUMNS + 1;
            const uint32_t corner[2][3] = {{above, below, below + 1}, {above, below + 1, above + 1}};
            /* At the poles one of the two has no area. */
            for (uint32_t k = row == SPHERE_ROWS - 1 ? 1 : 0; k < (row == 0 ? 1u : 2u); ++k) {
                memcpy(mesh->triangle[mesh->triangle_count++], corner[k], sizeof corner[k]);
            }
        }
    }
}

static lmb_affine identity(void)
{
    return (lmb_affine){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
}

static lmb_texture no_texture(void)
{
    return (lmb_texture){.image = -1, .transform = {{1, 0, 0}, {0, 1, 0}}};
}

/* Allocates what the sphere's scene needs. On failure the scene can be destroyed. */
static bool sphere_allocate(lmb_scene *scene)
{
    const size_t vertices = (SPHERE_COLUMNS + 1) * (SPHERE_ROWS + 1);
    const size_t triangles = 2 * SPHERE_COLUMNS * SPHERE_ROWS;
    scene->meshes = calloc(1, sizeof *scene->meshes);
    scene->instances = calloc(1, sizeof *scene->instances);
    scene->materials = calloc(1, sizeof *scene->materials);
    if (!scene->meshes || !scene->instances || !scene->materials) {
        return false;
    }
    scene->mesh_count = scene->instance_count = scene->material_count = 1;
    lmb_mesh *mesh = scene->meshes;
    mesh->position = malloc(vertices * sizeof *mesh->position);
    mesh->normal = malloc(vertices * sizeof *mesh->normal);
    mesh->triangle = malloc(triangles * sizeof *mesh->triangle);
    mesh->material = calloc(triangles, sizeof *mesh->material);
    return mesh->position && mesh->normal && mesh->triangle && mesh->material;
}

static lmb_scene *sphere_make(float radius)
{
    lmb_scene *scene = calloc(1, sizeof *scene);
    if (!scene) {
        return NULL;
    }
    if (!sphere_allocate(scene)) {
        lmb_scene_destroy(scene);
        return NULL;
    }
    sphere_fill(scene->meshes, radius);
    scene->materials[0] = (lmb_material){.base_color = {0.8f, 0.8f, 0.8f, 1.0f},
                                         .base_color_texture = no_texture(),
                                         .emissive_texture = no_texture(),
                                         .normal_texture = no_texture(),
                                         .normal_scale = 1.0f,
                                         .roughness = 1.0f,
                                         .metallic_roughness_texture = no_texture()};
    scene->instances[0] = (lmb_instance){.to_world = identity(), .normal_to_world = identity()};
    scene->bounds_min = (lmb_vec3){-radius, -radius, -radius};
    scene->bounds_max = (lmb_vec3){radius, radius, radius};
    return scene;
}

/* In the object's own picture everything is there, whatever its level says about it. */
static void everything_is_static(lmb_scene *scene)
{
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        scene->instances[i].dynamic = false;
    }
}

lmb_result render_object_open(const char *path, float radius, lmb_vec3d position, lmb_render_object *object,
                              lmb_error *error)
{
    lmb_render_object opened = {.tracer = NULL};
    lmb_result result = LMB_OK;
    if (path) {
        const lmb_gltf_options options = {.reflection = true};
        result = lmb_gltf_load(path, &options, &opened.scene, error);
    } else {
        opened.scene = sphere_make(radius);
        result = opened.scene ? LMB_OK : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    if (result == LMB_OK) {
        const lmb_vec3d own = opened.scene->origin;
        opened.position =
            (lmb_vec3){(float)(position.x + own.x), (float)(position.y + own.y), (float)(position.z + own.z)};
        everything_is_static(opened.scene);
        result = lmb_tracer_create(opened.scene, NULL, 1, &opened.tracer, error);
    }
    if (result != LMB_OK) {
        render_object_close(&opened);
        return result;
    }
    *object = opened;
    return LMB_OK;
}

void render_object_close(lmb_render_object *object)
{
    lmb_tracer_destroy(object->tracer);
    lmb_scene_destroy(object->scene);
    *object = (lmb_render_object){0};
}
