#include <lambent/material.h>
#include <lambent/texture.h>
#include <lambent/vector.h>

bool lmb_material_is_opaque(const lmb_material *material)
{
    return material->alpha_mode == LMB_ALPHA_OPAQUE && !(material->transmission > 0.0f);
}

bool lmb_material_emits(const lmb_material *material)
{
    return !material->unlit && lmb_rgb_max(material->emissive) > 0.0f;
}

const lmb_material *lmb_material_at(const lmb_mesh_point *point)
{
    return &point->scene->materials[point->mesh->material[point->triangle]];
}

/* UVs of set `set`; (0, 0) where the mesh has none. */
static lmb_vec2 point_uv(const lmb_mesh_point *point, int set)
{
    const lmb_vec2 *uv = point->mesh->uv[set];
    if (!uv) {
        return (lmb_vec2){0.0f, 0.0f};
    }
    const uint32_t *vertex = point->mesh->triangle[point->triangle];
    const float u = point->u, v = point->v, w = 1.0f - u - v;
    return (lmb_vec2){w * uv[vertex[0]].x + u * uv[vertex[1]].x + v * uv[vertex[2]].x,
                      w * uv[vertex[0]].y + u * uv[vertex[1]].y + v * uv[vertex[2]].y};
}

void lmb_material_texel(const lmb_mesh_point *point, const lmb_texture *texture, bool srgb, float rgba[4])
{
    const lmb_vec2 uv = texture->image >= 0 ? point_uv(point, texture->uv_set) : (lmb_vec2){0.0f, 0.0f};
    lmb_texture_sample(point->scene, texture, uv, srgb, rgba);
}

void lmb_material_base_color(const lmb_mesh_point *point, float rgba[4])
{
    const lmb_material *material = lmb_material_at(point);
    const lmb_mesh *mesh = point->mesh;
    const uint32_t *vertex = mesh->triangle[point->triangle];
    const float u = point->u, v = point->v;
    lmb_material_texel(point, &material->base_color_texture, true, rgba);
    for (int i = 0; i < 4; ++i) {
        float vertex_color = 1.0f;
        if (mesh->color) {
            vertex_color = (1.0f - u - v) * mesh->color[vertex[0]][i] + u * mesh->color[vertex[1]][i] +
                           v * mesh->color[vertex[2]][i];
        }
        rgba[i] = lmb_saturate(rgba[i] * material->base_color[i] * vertex_color);
    }
}

lmb_rgb lmb_material_emission(const lmb_mesh_point *point)
{
    const lmb_material *material = lmb_material_at(point);
    lmb_rgb emission = {{0.0f, 0.0f, 0.0f}};
    if (lmb_material_emits(material)) {
        float texel[4];
        lmb_material_texel(point, &material->emissive_texture, true, texel);
        for (int c = 0; c < 3; ++c) {
            emission.c[c] = material->emissive.c[c] * texel[c];
        }
    }
    return emission;
}

/* `base`: RGBA. */
static inline lmb_coverage coverage_of(const lmb_material *material, const float base[4])
{
    float alpha = 1.0f;
    if (material->alpha_mode == LMB_ALPHA_MASK) {
        alpha = base[3] >= material->alpha_cutoff ? 1.0f : 0.0f;
    } else if (material->alpha_mode == LMB_ALPHA_BLEND) {
        alpha = base[3];
    }
    /* Of the light that the coat of coverage alpha meets, `transmission` goes on, tinted; the rest is diffuse. */
    const float through = alpha * material->transmission;
    lmb_coverage coverage = {.opacity = alpha - through};
    for (int c = 0; c < 3; ++c) {
        coverage.pass.c[c] = (1.0f - alpha) + through * base[c];
    }
    return coverage;
}

lmb_coverage lmb_material_coverage(const lmb_mesh_point *point)
{
    float base[4];
    lmb_material_base_color(point, base);
    return coverage_of(lmb_material_at(point), base);
}

lmb_coverage lmb_material_coverage_of_factors(const lmb_material *material)
{
    return coverage_of(material, material->base_color);
}

lmb_surface lmb_material_surface(const lmb_mesh_point *point)
{
    const lmb_material *material = lmb_material_at(point);
    float base[4];
    lmb_material_base_color(point, base);
    lmb_surface surface = {.coverage = coverage_of(material, base)};
    for (int c = 0; c < 3; ++c) {
        surface.albedo.c[c] = material->unlit ? 0.0f : base[c];
    }
    return surface;
}

/* Of what is no metal, along the normal: glTF 2.0's 0.04. */
#define DIELECTRIC_F0 0.04f

lmb_reflection lmb_material_reflection(const lmb_mesh_point *point)
{
    const lmb_material *material = lmb_material_at(point);
    float base[4], texel[4];
    lmb_material_base_color(point, base);
    lmb_material_texel(point, &material->metallic_roughness_texture, false, texel);
    const float roughness = material->roughness * texel[1], metallic = material->metallic * texel[2];
    lmb_reflection reflection = {.diffuse = 1.0f - metallic, .slope = roughness * roughness};
    for (int c = 0; c < 3; ++c) {
        reflection.f0.c[c] = DIELECTRIC_F0 + metallic * (base[c] - DIELECTRIC_F0);
    }
    return reflection;
}
