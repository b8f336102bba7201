/* A panel with textures, built in memory: what glTF can say of them, the level builder does not. */
#ifndef LMB_TESTS_EMISSION_FIXTURE_H
#define LMB_TESTS_EMISSION_FIXTURE_H

#include <stdlib.h>

#include "level_fixture.h"

/* Emission and, in the same pixels, alpha of a panel. */
typedef struct panel_texture {
    int32_t width, height;
    void (*pixel)(int32_t x, int32_t y, uint8_t rgba[4]);
} panel_texture;

/* A rectangle in the plane z = 0 that looks towards +z, in two triangles. */
typedef struct panel_case {
    const char *name;
    panel_texture texture;
    lmb_wrap wrap;
    bool nearest;
    float uv[2][2];                 /* at its lower left and upper right corner */
    float transform[2][3];          /* all 0: identity */
    bool emission_even, alpha_used; /* which of the two come from the texture */
    lmb_alpha_mode alpha_mode;
    float cutoff;
    float vertex_alpha; /* of the right corners; 0: no vertex colours */
    float transmission;
    lmb_rgb emissive;
    double lit[2]; /* shares of the width that all light is between; both 0: anywhere */
} panel_case;

#define PANEL_LEFT (-2.0f)
#define PANEL_WIDTH 4.0f
#define PANEL_HEIGHT 2.0f

typedef struct panel {
    lmb_scene scene;
    lmb_mesh mesh;
    lmb_instance instance;
    lmb_material material;
    lmb_texture_image image;
    lmb_vec3 position[4], normal[4];
    lmb_vec2 uv[4];
    float color[4][4];
    uint32_t triangle[2][3], triangle_material[2];
    lmb_tracer *tracer;
    lmb_emitters *emitters;
} panel;

static inline void panel_close(panel *made)
{
    lmb_emitters_destroy(made->emitters);
    lmb_tracer_destroy(made->tracer);
    free(made->image.rgba);
}

static inline void panel_shape(panel *made, const panel_case *wanted)
{
    for (int k = 0; k < 4; ++k) {
        const bool right = k == 1 || k == 2, upper = k >= 2;
        made->position[k] = (lmb_vec3){PANEL_LEFT + (right ? PANEL_WIDTH : 0.0f), upper ? PANEL_HEIGHT : 0.0f, 0.0f};
        made->normal[k] = (lmb_vec3){0.0f, 0.0f, 1.0f};
        made->uv[k] = (lmb_vec2){wanted->uv[right][0], wanted->uv[upper][1]};
        const float alpha = right ? wanted->vertex_alpha : 1.0f;
        const float color[4] = {1.0f, 1.0f, 1.0f, alpha};
        memcpy(made->color[k], color, sizeof color);
    }
    static const uint32_t triangle[2][3] = {{0, 1, 2}, {0, 2, 3}};
    memcpy(made->triangle, triangle, sizeof triangle);
    made->mesh = (lmb_mesh){.vertex_count = 4,
                            .position = made->position,
                            .normal = made->normal,
                            .uv = {made->uv, NULL},
                            .color = wanted->vertex_alpha > 0.0f ? made->color : NULL,
                            .triangle_count = 2,
                            .triangle = made->triangle,
                            .material = made->triangle_material};
}

static inline void panel_material(panel *made, const panel_case *wanted)
{
    lmb_texture texture = {.wrap_u = wanted->wrap,
                           .wrap_v = wanted->wrap,
                           .nearest = wanted->nearest,
                           .transform = {{1, 0, 0}, {0, 1, 0}}};
    if (wanted->transform[0][0] != 0.0f || wanted->transform[0][1] != 0.0f) {
        memcpy(texture.transform, wanted->transform, sizeof texture.transform);
    }
    lmb_texture none = texture;
    none.image = -1;
    made->material = (lmb_material){.base_color = {0.0f, 0.0f, 0.0f, 1.0f},
                                    .base_color_texture = wanted->alpha_used ? texture : none,
                                    .emissive = wanted->emissive,
                                    .emissive_texture = wanted->emission_even ? none : texture,
                                    .normal_texture = none,
                                    .metallic_roughness_texture = none,
                                    .transmission = wanted->transmission,
                                    .alpha_mode = wanted->alpha_mode,
                                    .alpha_cutoff = wanted->cutoff};
    made->image = (lmb_texture_image){.width = wanted->texture.width, .height = wanted->texture.height};
    made->image.rgba = malloc(4 * (size_t)made->image.width * (size_t)made->image.height);
    for (int32_t y = 0; made->image.rgba && y < made->image.height; ++y) {
        for (int32_t x = 0; x < made->image.width; ++x) {
            wanted->texture.pixel(x, y, made->image.rgba + 4 * ((size_t)y * (size_t)made->image.width + (size_t)x));
        }
    }
}

/* A failure is a failed check, and false. `made` must stay where it is. */
static inline bool panel_open(panel *made, const panel_case *wanted)
{
    static const lmb_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    lmb_error error = {{0}};
    memset(made, 0, sizeof *made);
    panel_shape(made, wanted);
    panel_material(made, wanted);
    made->instance = (lmb_instance){.to_world = identity, .normal_to_world = identity};
    made->scene = (lmb_scene){.meshes = &made->mesh,
                              .mesh_count = 1,
                              .instances = &made->instance,
                              .instance_count = 1,
                              .materials = &made->material,
                              .material_count = 1,
                              .images = &made->image,
                              .image_count = 1};
    lmb_result result = made->image.rgba ? LMB_OK : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = lmb_tracer_create(&made->scene, NULL, 1, &made->tracer, &error);
    }
    if (result == LMB_OK) {
        result = lmb_emitters_create(made->tracer, &made->emitters);
    }
    CHECK(result == LMB_OK, "%s: %s", wanted->name, error.message);
    if (result != LMB_OK) {
        panel_close(made);
    }
    return result == LMB_OK;
}

#endif
