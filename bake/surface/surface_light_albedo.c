/* What triangles reflect. */
#include "surface/surface_light_internal.h"

#include <math.h>

#include <lambent/surface.h>
#include <lambent/vector.h>

#include "surface/bright_cells.h"

/* Triangles that one task of the pool looks at. */
enum { TRIANGLES_PER_TASK = 4096 };

/* Cells of less than this share of the largest cell's length are too small for anybody to see texture within. */
#define EVEN_CELL_SHARE 0.25f

/* Albedos within this of their mean are one. */
#define EVEN_ALBEDO 0.05f

/* Mean albedo over points of a triangle; false where it changes. */
static bool albedo_even(const lmb_tracer *tracer, const lmb_hit *hit, bool small, lmb_rgb *mean)
{
    enum { POINTS = 16 };
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    const lmb_mesh *mesh = &scene->meshes[scene->instances[hit->instance].mesh];
    if (!mesh->color && scene->materials[mesh->material[hit->triangle]].base_color_texture.image < 0) {
        *mean = lmb_trace_surface(tracer, hit).albedo;
        return true;
    }
    lmb_rgb albedo[POINTS];
    *mean = lmb_rgb_of(0.0f, 0.0f, 0.0f);
    for (int i = 0; i < POINTS; ++i) {
        /* The R2 sequence (Roberts 2018), in step with no texture; the square's upper half folded back. */
        float u = 0.5f + (float)i * 0.7548777f;
        float v = 0.5f + (float)i * 0.5698403f;
        u -= floorf(u);
        v -= floorf(v);
        if (u + v > 1.0f) {
            u = 1.0f - u;
            v = 1.0f - v;
        }
        albedo[i] =
            lmb_trace_surface(tracer, &(lmb_hit){.instance = hit->instance, .triangle = hit->triangle, .u = u, .v = v})
                .albedo;
        *mean = lmb_rgb_add(*mean, lmb_rgb_scale(albedo[i], 1.0f / POINTS));
    }
    for (int i = 0; i < POINTS && !small; ++i) {
        for (int c = 0; c < 3; ++c) {
            if (fabsf(albedo[i].c[c] - mean->c[c]) > EVEN_ALBEDO) {
                return false;
            }
        }
    }
    return true;
}

static bool material_only_reflects(const lmb_material *material)
{
    return !lmb_material_emits(material) && lmb_material_is_opaque(material);
}

static float cell_size_largest(const lmb_surface_light *light)
{
    float largest = 0.0f;
    for (uint32_t t = 0; t < light->triangle_count; ++t) {
        largest = fmaxf(largest, light->grid[t].cell_size);
    }
    return largest;
}

typedef struct albedo_work {
    lmb_surface_light *light;
    const lmb_tracer *tracer;
    float small_size; /* metres: below it a cell's texture does not matter */
} albedo_work;

static void triangle_look(const albedo_work *work, const lmb_hit *hit)
{
    lmb_surface_light *light = work->light;
    const lmb_scene *scene = lmb_tracer_scene(work->tracer);
    const lmb_mesh *mesh = &scene->meshes[scene->instances[hit->instance].mesh];
    const uint32_t triangle = light->triangle_first[hit->instance] + hit->triangle;
    lmb_cell_grid *grid = &light->grid[triangle];
    grid->even = material_only_reflects(&scene->materials[mesh->material[hit->triangle]]) &&
                 albedo_even(work->tracer, hit, grid->cell_size < work->small_size, &light->albedo[triangle]);
}

static uint32_t task_end(const lmb_surface_light *light, size_t task)
{
    const uint32_t first = (uint32_t)task * TRIANGLES_PER_TASK;
    const uint32_t left = light->triangle_count - first;
    return first + (left < TRIANGLES_PER_TASK ? left : TRIANGLES_PER_TASK);
}

static void albedos_task(void *context, size_t task, int worker)
{
    (void)worker;
    const albedo_work *work = context;
    const lmb_surface_light *light = work->light;
    lmb_hit hit = {.instance = 0};
    for (uint32_t t = (uint32_t)task * TRIANGLES_PER_TASK; t < task_end(light, task); ++t) {
        while (t >= light->triangle_first[hit.instance + 1]) {
            ++hit.instance;
        }
        hit.triangle = t - light->triangle_first[hit.instance];
        triangle_look(work, &hit);
    }
}

static size_t task_count(const lmb_surface_light *light)
{
    return ((size_t)light->triangle_count + TRIANGLES_PER_TASK - 1) / TRIANGLES_PER_TASK;
}

lmb_result lmb_surface_light_find_albedos(lmb_surface_light *light, const lmb_tracer *tracer, lmb_pool *pool)
{
    albedo_work work = {light, tracer, EVEN_CELL_SHARE * cell_size_largest(light)};
    return lmb_pool_run(pool, task_count(light), albedos_task, &work, "surface", NULL);
}

static void reflect_task(void *context, size_t task, int worker)
{
    (void)worker;
    const lmb_surface_light *light = context;
    for (uint32_t t = (uint32_t)task * TRIANGLES_PER_TASK; t < task_end(light, task); ++t) {
        const lmb_cell_grid *grid = &light->grid[t];
        for (uint32_t side = 2 * grid->first; grid->even && side < 2 * (grid + 1)->first; ++side) {
            light->radiance[side] = lmb_rgb_mul(light->albedo[t], light->irradiance[side]);
        }
    }
}

lmb_result lmb_surface_light_finish(lmb_surface_light *light, const lmb_tracer *tracer, bool aims, lmb_pool *pool)
{
    for (uint32_t i = 0; i < light->piece_count; ++i) {
        const lmb_cell cell = lmb_cell_find(light, light->piece[i].side / 2);
        const uint32_t patch = 2 * light->cell_count + i;
        if (cell.grid->even) {
            light->radiance[patch] = lmb_rgb_mul(light->albedo[cell.grid - light->grid], light->irradiance[patch]);
        }
    }
    const lmb_result result = lmb_pool_run(pool, task_count(light), reflect_task, light, "surface", NULL);
    return result == LMB_OK && aims ? lmb_bright_cells_create(light, tracer, &light->bright) : result;
}
