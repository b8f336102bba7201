/* Where spaces have their origins: a scene's at the world's, and a mesh's where the file has it, but for what lies so
 * far out that floats are too coarse for it there; and how far everything reaches from them. */
#include "scene/scene_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "base/affine.h"

/* A median needs no more triangles than this. */
enum { MOST_SAMPLES = 1024 };

/* A level's middle is far when it is farther from zero than this many times the level's size. Points are lifted off
 * their surfaces by 2^-20 of their coordinates (lmb_trace_epsilon): up to here, by a 16 000th of the level. Most levels
 * lie within four of their sizes. */
#define FAR_SIZES 64.0

/* A triangle does not suffer up to this many times its own size from zero, and cannot suffer more than from that many.
 */
#define GOOD_SIZES 16.0
#define RUINED_SIZES 4096.0

typedef struct placed_triangle {
    double middle[3];
    double size; /* its longest edge */
    double area;
} placed_triangle;

static placed_triangle placed_triangle_of(const lmb_scene *scene, const lmb_instance *instance, uint32_t triangle)
{
    const lmb_mesh *const mesh = &scene->meshes[instance->mesh];
    const lmb_affine *const t = &instance->to_world;
    double corner[3][3];
    for (int k = 0; k < 3; ++k) {
        const lmb_vec3 p = mesh->position[mesh->triangle[triangle][k]];
        for (int axis = 0; axis < 3; ++axis) {
            corner[k][axis] =
                t->m[axis][0] * (double)p.x + t->m[axis][1] * (double)p.y + t->m[axis][2] * (double)p.z + t->m[axis][3];
        }
    }
    placed_triangle placed = {{0.0, 0.0, 0.0}, 0.0, 0.0};
    double edge[3][3];
    for (int k = 0; k < 3; ++k) {
        double square = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            edge[k][axis] = corner[(k + 1) % 3][axis] - corner[k][axis];
            square += edge[k][axis] * edge[k][axis];
            placed.middle[axis] += corner[k][axis] / 3.0;
        }
        placed.size = fmax(placed.size, sqrt(square));
    }
    const double x = edge[0][1] * edge[1][2] - edge[0][2] * edge[1][1];
    const double y = edge[0][2] * edge[1][0] - edge[0][0] * edge[1][2];
    const double z = edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0];
    placed.area = 0.5 * sqrt(x * x + y * y + z * z);
    return placed;
}

/* Static instances count; where none is static, all of them. */
static bool instance_counts(const lmb_scene *scene, const lmb_instance *instance, bool any_static)
{
    return scene->meshes[instance->mesh].triangle_count > 0 && !(any_static && instance->dynamic);
}

static bool scene_has_static(const lmb_scene *scene)
{
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (instance_counts(scene, &scene->instances[i], true)) {
            return true;
        }
    }
    return false;
}

/* Takes triangles evenly from all of them. @return how many */
static uint32_t samples_take(const lmb_scene *scene, bool any_static, placed_triangle samples[MOST_SAMPLES])
{
    uint64_t total = 0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_instance *const instance = &scene->instances[i];
        total += instance_counts(scene, instance, any_static) ? scene->meshes[instance->mesh].triangle_count : 0;
    }
    const uint32_t wanted = total < MOST_SAMPLES ? (uint32_t)total : MOST_SAMPLES;
    uint32_t taken = 0;
    uint64_t before = 0;
    for (uint32_t i = 0; i < scene->instance_count && taken < wanted; ++i) {
        const lmb_instance *const instance = &scene->instances[i];
        if (!instance_counts(scene, instance, any_static)) {
            continue;
        }
        const uint64_t end = before + scene->meshes[instance->mesh].triangle_count;
        for (; taken < wanted; ++taken) {
            /* The first of part `taken` of `wanted` equal parts. */
            const uint64_t triangle = total / wanted * taken + total % wanted * taken / wanted;
            if (triangle >= end) {
                break;
            }
            samples[taken] = placed_triangle_of(scene, instance, (uint32_t)(triangle - before));
        }
        before = end;
    }
    return taken;
}

static int double_compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, uint32_t count)
{
    qsort(values, count, sizeof *values, double_compare);
    return values[count / 2];
}

static double distance_along_axes(const double a[3], const double b[3])
{
    return fmax(fabs(a[0] - b[0]), fmax(fabs(a[1] - b[1]), fabs(a[2] - b[2])));
}

/* How much area floats are too coarse for when they count from `origin`. */
static double area_suffering(const lmb_scene *scene, bool any_static, const double origin[3])
{
    double sum = 0.0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_instance *const instance = &scene->instances[i];
        const uint32_t count =
            instance_counts(scene, instance, any_static) ? scene->meshes[instance->mesh].triangle_count : 0;
        for (uint32_t t = 0; t < count; ++t) {
            const placed_triangle placed = placed_triangle_of(scene, instance, t);
            const double sizes = distance_along_axes(placed.middle, origin) / placed.size;
            if (sizes > GOOD_SIZES) {
                sum += placed.area * fmin((sizes - GOOD_SIZES) / RUINED_SIZES, 1.0);
            }
        }
    }
    return sum;
}

/* By medians, so that a sky around everything, or something lost far away, does not count. */
static void middle_and_size(const placed_triangle *samples, uint32_t count, double middle[3], double *size)
{
    double column[MOST_SAMPLES];
    for (int axis = 0; axis < 3; ++axis) {
        for (uint32_t i = 0; i < count; ++i) {
            column[i] = samples[i].middle[axis];
        }
        middle[axis] = median(column, count);
    }
    for (uint32_t i = 0; i < count; ++i) {
        column[i] = fmax(distance_along_axes(samples[i].middle, middle), samples[i].size);
    }
    *size = median(column, count);
}

lmb_vec3d lmb_scene_choose_origin(const lmb_scene *scene)
{
    const lmb_vec3d nowhere = {0.0, 0.0, 0.0};
    const double zero[3] = {0.0, 0.0, 0.0};
    const bool any_static = scene_has_static(scene);
    placed_triangle samples[MOST_SAMPLES];
    const uint32_t count = samples_take(scene, any_static, samples);
    if (count == 0) {
        return nowhere;
    }
    double middle[3], size;
    middle_and_size(samples, count, middle, &size);
    if (!(size > 0.0) || !(distance_along_axes(middle, zero) > FAR_SIZES * size)) {
        return nowhere;
    }
    int exponent;
    frexp(size, &exponent);
    const double unit = ldexp(1.0, exponent - 1); /* unit <= size < 2 unit */
    double origin[3];
    for (int axis = 0; axis < 3; ++axis) {
        origin[axis] = floor(middle[axis] / unit + 0.5) * unit;
    }
    return area_suffering(scene, any_static, origin) < area_suffering(scene, any_static, zero)
               ? (lmb_vec3d){origin[0], origin[1], origin[2]}
               : nowhere;
}

/* The distance between floats at `reach` from zero. */
static float float_step(float reach)
{
    const float at = lmb_smaller(reach, FLT_MAX / 2.0f);
    return nextafterf(at, FLT_MAX) - at;
}

float lmb_position_step(float reach, const lmb_affine *to_world)
{
    double longest = 0.0; /* what the transform makes of the unit axes */
    for (int k = 0; k < 3; ++k) {
        const double x = to_world->m[0][k], y = to_world->m[1][k], z = to_world->m[2][k];
        longest = fmax(longest, x * x + y * y + z * z);
    }
    return (float)((double)float_step(reach) * sqrt(longest));
}

/* Squares of what is placed here must stay floats. */
#define TOO_FAR 1e18f

uint32_t lmb_scene_find_bounds(lmb_scene *scene)
{
    lmb_vec3 low = lmb_vec3_of(FLT_MAX, FLT_MAX, FLT_MAX), high = lmb_vec3_of(-FLT_MAX, -FLT_MAX, -FLT_MAX);
    const lmb_vec3d from = scene->origin;
    const float double_step = (float)(fmax(fabs(from.x), fmax(fabs(from.y), fabs(from.z))) * DBL_EPSILON);
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        lmb_instance *const instance = &scene->instances[i];
        const lmb_mesh *const mesh = &scene->meshes[instance->mesh];
        float reach = 0.0f;
        for (uint32_t c = 0; !instance->dynamic && c < 3 * mesh->triangle_count; ++c) {
            const lmb_vec3 p = affine_point(&instance->to_world, mesh->position[mesh->triangle[c / 3][c % 3]]);
            if (!(fabsf(p.x) < TOO_FAR && fabsf(p.y) < TOO_FAR && fabsf(p.z) < TOO_FAR)) {
                return i;
            }
            low = lmb_vec3_smaller(p, low);
            high = lmb_vec3_larger(p, high);
            reach = lmb_larger(lmb_larger(reach, fabsf(p.x)), lmb_larger(fabsf(p.y), fabsf(p.z)));
        }
        instance->position_step = lmb_larger(instance->position_step, lmb_larger(float_step(reach), double_step));
    }
    scene->bounds_min = low;
    scene->bounds_max = high;
    return UINT32_MAX;
}

/* A mesh is far from its own origin from this many times its size on. */
#define FAR_MESH_SIZES 1024.0f

void lmb_mesh_recentre(lmb_mesh *mesh)
{
    float low[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, high[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (uint32_t c = 0; c < 3 * mesh->triangle_count; ++c) {
        const lmb_vec3 p = mesh->position[mesh->triangle[c / 3][c % 3]];
        const float at[3] = {p.x, p.y, p.z};
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = lmb_smaller(low[axis], at[axis]);
            high[axis] = lmb_larger(high[axis], at[axis]);
        }
    }
    float size = 0.0f, reach = 0.0f, shift[3];
    for (int axis = 0; axis < 3; ++axis) {
        size = lmb_larger(size, high[axis] - low[axis]);
        reach = lmb_larger(reach, lmb_larger(fabsf(low[axis]), fabsf(high[axis])));
    }
    if (!(reach > FAR_MESH_SIZES * size) || !(size > 0.0f)) {
        return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        /* Less than a factor of two apart, floats are subtracted exactly (Sterbenz). */
        const float nearest = lmb_smaller(fabsf(low[axis]), fabsf(high[axis]));
        shift[axis] = low[axis] * high[axis] > 0.0f && nearest > high[axis] - low[axis] ? low[axis] : 0.0f;
    }
    mesh->shift = lmb_vec3_of(shift[0], shift[1], shift[2]);
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        mesh->position[v] = lmb_vec3_sub(mesh->position[v], mesh->shift);
    }
}
