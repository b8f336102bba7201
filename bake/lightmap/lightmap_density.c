/* How many texels a metre: what is asked for an instance, and what a level gets where nobody asks. */
#include "lightmap/lightmap_internal.h"

#include <math.h>

#include "base/affine.h"

/* Defaults: this many texels across the level's diagonal, unless its surfaces then have more than this many. */
#define DEFAULT_TEXELS_ACROSS 256.0
#define DEFAULT_MAX_TEXELS 1e6

static double triangle_area(lmb_vec3 a, lmb_vec3 b, lmb_vec3 c)
{
    const double ux = (double)b.x - (double)a.x, uy = (double)b.y - (double)a.y, uz = (double)b.z - (double)a.z;
    const double vx = (double)c.x - (double)a.x, vy = (double)c.y - (double)a.y, vz = (double)c.z - (double)a.z;
    const double x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    return 0.5 * sqrt(x * x + y * y + z * z);
}

double lmb_mesh_area(const lmb_mesh *mesh, const lmb_affine *transform)
{
    double area = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        lmb_vec3 corner[3];
        for (int k = 0; k < 3; ++k) {
            corner[k] = affine_vector(transform, mesh->position[mesh->triangle[t][k]]);
        }
        area += triangle_area(corner[0], corner[1], corner[2]);
    }
    return area;
}

double lmb_instance_area(const lmb_scene *scene, uint32_t instance)
{
    const lmb_instance *placed = &scene->instances[instance];
    return lmb_mesh_area(&scene->meshes[placed->mesh], &placed->to_world);
}

bool lmb_instance_has_region(const lmb_scene *scene, uint32_t instance)
{
    const lmb_instance *placed = &scene->instances[instance];
    return !placed->dynamic && !placed->no_lightmap && scene->meshes[placed->mesh].triangle_count > 0;
}

/* The factor on the level's density, of instances that have none of their own. */
static double instance_scale(const lmb_instance *placed)
{
    return placed->texel_scale > 0.0f ? (double)placed->texel_scale : 1.0;
}

double lmb_lightmap_density_asked(const lmb_lightmap *lightmap, uint32_t instance)
{
    const lmb_instance *placed = &lightmap->scene->instances[instance];
    const float density = placed->texels_per_m > 0.0f ? placed->texels_per_m : lightmap->settings.texels_per_m;
    return instance_scale(placed) * (double)density;
}

lmb_lightmap_settings lmb_lightmap_settings_default(const lmb_scene *scene)
{
    lmb_lightmap_settings settings = {.texels_per_m = 1.0f, .max_image_size = 2048, .padding = 1};
    double area = 0.0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_instance *placed = &scene->instances[i];
        if (lmb_instance_has_region(scene, i) && !(placed->texels_per_m > 0.0f)) {
            area += lmb_instance_area(scene, i) * instance_scale(placed) * instance_scale(placed);
        }
    }
    const double x = (double)scene->bounds_max.x - (double)scene->bounds_min.x;
    const double y = (double)scene->bounds_max.y - (double)scene->bounds_min.y;
    const double z = (double)scene->bounds_max.z - (double)scene->bounds_min.z;
    const double density = fmin(DEFAULT_TEXELS_ACROSS / sqrt(x * x + y * y + z * z), sqrt(DEFAULT_MAX_TEXELS / area));
    if (area > 0.0 && isfinite(density) && (float)density > 0.0f) {
        settings.texels_per_m = (float)density;
    }
    return settings;
}
