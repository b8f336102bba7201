/* A ray walks through the voxels of each level, whose middles are the level's points: a voxel holds the sphere of its
 * point and those of the point's ghosts, whole (after Amanatides and Woo 1987). */
#include "probe_spheres.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/lattice.h>
#include <lambent/probe_local.h>
#include <lambent/sh.h>
#include <lambent/vector.h>

#include "key_lights_seen.h"

/* Places of a cell along each axis that are asked for their region. */
enum { REGION_GRID = 6 };

/* Half height of a belt, as a share of the radius. */
#define BELT 0.25f

static const lmb_rgb unbaked = {{1.0f, 0.1f, 0.05f}}; /* of a belt */

static int32_t ghosts_begin(const lmb_probes *probes)
{
    return probes->count - probes->ghost_count;
}

/* ------------------------------------------------------------------------------------- where ghosts are shown */

/* Moves the ghosts of a cell's regions towards the middle of their region. */
static void shift_to_regions(const lmb_probes *probes, const lmb_cut_cell *cell, lmb_vec3d *shift)
{
    double sum[LMB_CELL_REGIONS_MOST][4] = {{0.0}};
    for (int i = 0; i < REGION_GRID * REGION_GRID * REGION_GRID; ++i) {
        const float t[3] = {((float)(i % REGION_GRID) + 0.5f) / REGION_GRID,
                            ((float)(i / REGION_GRID % REGION_GRID) + 0.5f) / REGION_GRID,
                            ((float)(i / REGION_GRID / REGION_GRID) + 0.5f) / REGION_GRID};
        const uint32_t region = lmb_cell_region(&probes->cut.plane[cell->plane_first], cell->plane_count, t);
        for (int axis = 0; axis < 3; ++axis) {
            sum[region][axis] += (double)t[axis];
        }
        sum[region][3] += 1.0;
    }
    for (uint32_t k = 0; k < 8 * cell->region_count; ++k) {
        const int32_t ghost = probes->cut.corner[cell->region_first + k / 8][k % 8] - ghosts_begin(probes);
        const double *const of = sum[k / 8];
        if (ghost >= 0 && of[3] > 0.0) {
            shift[ghost].x += of[0] / of[3] - (double)(k & 1);
            shift[ghost].y += of[1] / of[3] - (double)(k >> 1 & 1);
            shift[ghost].z += of[2] / of[3] - (double)(k >> 2 & 1);
        }
    }
}

static void shifts_find(const lmb_probes *probes, lmb_vec3d *shift)
{
    for (uint32_t i = 0; i < probes->cut.count; ++i) {
        shift_to_regions(probes, &probes->cut.cell[i], shift);
    }
    for (int32_t ghost = 0; ghost < probes->ghost_count; ++ghost) {
        lmb_vec3d *const s = &shift[ghost];
        const double length = sqrt(s->x * s->x + s->y * s->y + s->z * s->z);
        const double scale = length > 1e-6 ? GHOST_SPHERE_DISTANCE / length : 0.0;
        *s = (lmb_vec3d){scale * s->x, scale * s->y, scale * s->z};
    }
}

/* Lists each point's ghosts. */
static lmb_result ghosts_list(const lmb_probes *probes, probe_spheres *spheres)
{
    lmb_result result = LMB_OK;
    for (uint32_t level = 0; level < probes->level_count; ++level) {
        lmb_probe_index *const index = &spheres->first_ghost[level];
        const lmb_probe_level *const own = &probes->level[level];
        for (int32_t i = 0; i < own->ghost_count && result == LMB_OK; ++i) {
            const int32_t ghost = own->ghost_first + i - ghosts_begin(probes);
            const int32_t *const point = probes->point[own->ghost_first + i];
            const int32_t first = lmb_probe_index_find(index, point);
            if (first < 0) {
                spheres->next_ghost[ghost] = -1;
                result = lmb_probe_index_add(index, point, ghost);
            } else {
                spheres->next_ghost[ghost] = spheres->next_ghost[first];
                spheres->next_ghost[first] = ghost;
            }
        }
    }
    return result;
}

lmb_result probe_spheres_make(const lmb_probes *probes, probe_spheres *spheres)
{
    const size_t ghosts = (size_t)probes->ghost_count + 1;
    probe_spheres made = {.probes = probes,
                          .first_ghost = calloc((size_t)probes->level_count + 1, sizeof *made.first_ghost),
                          .next_ghost = calloc(ghosts, sizeof *made.next_ghost),
                          .shift = calloc(ghosts, sizeof *made.shift)};
    lmb_result result =
        made.first_ghost && made.next_ghost && made.shift ? ghosts_list(probes, &made) : LMB_ERROR_MEMORY;
    if (result != LMB_OK) {
        probe_spheres_free(&made);
        return result;
    }
    shifts_find(probes, made.shift);
    *spheres = made;
    return LMB_OK;
}

void probe_spheres_free(probe_spheres *spheres)
{
    for (uint32_t level = 0; spheres->first_ghost && level < spheres->probes->level_count; ++level) {
        lmb_probe_index_free(&spheres->first_ghost[level]);
    }
    free(spheres->first_ghost);
    free(spheres->next_ghost);
    free(spheres->shift);
    *spheres = (probe_spheres){0};
}

/* --------------------------------------------------------------------------------------------- along a ray */

/* A ray in voxels: of origin and direction in spacings, from a level's point (0, 0, 0) on. Lengths are spacings. */
typedef struct lattice_ray {
    double origin[3], direction[3];
    double start, nearest; /* of what is looked for */
    int32_t probe;         /* the nearest one's, or -1 */
    double normal[3];
} lattice_ray;

static void sphere_meet(lattice_ray *ray, const double centre[3], double radius, int32_t probe)
{
    double along = 0.0, square = 0.0, to[3];
    for (int axis = 0; axis < 3; ++axis) {
        to[axis] = centre[axis] - ray->origin[axis];
        along += to[axis] * ray->direction[axis];
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double across = to[axis] - along * ray->direction[axis];
        square += across * across;
    }
    if (square >= radius * radius) {
        return;
    }
    const double distance = along - sqrt(radius * radius - square);
    if (distance > ray->start && distance < ray->nearest) {
        ray->nearest = distance;
        ray->probe = probe;
        for (int axis = 0; axis < 3; ++axis) {
            ray->normal[axis] = (distance * ray->direction[axis] - to[axis]) / radius;
        }
    }
}

static void voxel_meet(const probe_spheres *spheres, uint32_t level, const int32_t point[3], lattice_ray *ray)
{
    const lmb_probes *const probes = spheres->probes;
    const int32_t probe = lmb_probe_index_find(&probes->level[level].index, point);
    if (probe >= 0) {
        sphere_meet(ray, (const double[3]){point[0], point[1], point[2]}, PROBE_SPHERE_RADIUS, probe);
    }
    for (int32_t ghost = lmb_probe_index_find(&spheres->first_ghost[level], point); ghost >= 0;
         ghost = spheres->next_ghost[ghost]) {
        const lmb_vec3d *const s = &spheres->shift[ghost];
        sphere_meet(ray, (const double[3]){point[0] + s->x, point[1] + s->y, point[2] + s->z}, GHOST_SPHERE_RADIUS,
                    ghosts_begin(probes) + ghost);
    }
}

/* The part of a ray in a lattice's voxels. @return false: none */
static bool clip(const lmb_lattice *lattice, const lattice_ray *ray, double *from, double *to)
{
    *from = fmax(ray->start, 0.0);
    *to = ray->nearest;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = lattice->min[axis] - 0.5 - ray->origin[axis], high = low + lattice->size[axis];
        if (ray->direction[axis] == 0.0) {
            if (low > 0.0 || high < 0.0) {
                return false;
            }
            continue;
        }
        const double a = low / ray->direction[axis], b = high / ray->direction[axis];
        *from = fmax(*from, fmin(a, b));
        *to = fmin(*to, fmax(a, b));
    }
    return *from < *to;
}

static void level_walk(const probe_spheres *spheres, uint32_t level, lattice_ray *ray)
{
    const lmb_lattice *const lattice = &spheres->probes->level[level].lattice;
    double from, to;
    if (!clip(lattice, ray, &from, &to)) {
        return;
    }
    int32_t point[3];
    double next[3]; /* along the ray, where the voxel ends */
    for (int axis = 0; axis < 3; ++axis) {
        const double at = floor(ray->origin[axis] + from * ray->direction[axis] + 0.5);
        const double low = lattice->min[axis], high = low + lattice->size[axis] - 1.0;
        point[axis] = (int32_t)fmin(fmax(at, low), high);
        const double side = ray->direction[axis] > 0.0 ? 0.5 : -0.5;
        next[axis] = ray->direction[axis] != 0.0 ? (point[axis] + side - ray->origin[axis]) / ray->direction[axis]
                                                 : (double)INFINITY;
    }
    for (double at = from; at < to && at < ray->nearest;) {
        voxel_meet(spheres, level, point, ray);
        const int axis = next[0] <= next[1] && next[0] <= next[2] ? 0 : next[1] <= next[2] ? 1 : 2;
        at = next[axis];
        point[axis] += ray->direction[axis] > 0.0 ? 1 : -1;
        next[axis] += 1.0 / fabs(ray->direction[axis]);
    }
}

static lmb_rgb white_paper(const lmb_probes *probes, const lmb_sh3_rgb *radiance, const float seen[LMB_KEY_LIGHTS_MOST],
                           lmb_vec3 normal)
{
    key_lights_seen keys = {.count = probes->key_light_count};
    memcpy(keys.light, probes->key_light, sizeof keys.light);
    memcpy(keys.visibility, seen, sizeof keys.visibility);
    return key_lights_add(&keys, normal, normal, lmb_sh3_rgb_irradiance(radiance, normal));
}

static lmb_rgb sphere_colour(const lmb_probes *probes, int32_t probe, lmb_vec3 normal)
{
    static const lmb_rgb ghost = {{0.1f, 0.2f, 1.0f}};
    const lmb_rgb light = white_paper(probes, &probes->radiance[0][probe], probes->key_visibility[probe], normal);
    const bool is_ghost = probe >= ghosts_begin(probes);
    if (fabsf(normal.y) < BELT && (is_ghost || probes->validity[probe] < LMB_PROBES_MIN_VALIDITY)) {
        return lmb_rgb_scale(is_ghost ? ghost : unbaked, lmb_luminance(light) + 0.01f);
    }
    return light;
}

/* ------------------------------------------------------------------------------------------------ local sets */

static double step_length(lmb_vec3 step)
{
    return sqrt((double)lmb_vec3_dot(step, step));
}

/* Spheres of a set are as large as its shortest step lets them be. */
static double local_radius(const lmb_local_frame *frame)
{
    double shortest = (double)INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
        shortest = fmin(shortest, step_length(frame->step[axis]));
    }
    return PROBE_SPHERE_RADIUS * shortest;
}

/* Whether a ray may meet a set: the sphere about all of its spheres. */
static bool local_is_near(const lmb_local_frame *frame, double radius, const lattice_ray *ray)
{
    double centre[3] = {frame->origin.x, frame->origin.y, frame->origin.z}, around = radius;
    for (int axis = 0; axis < 3; ++axis) {
        const double half = 0.5 * (frame->size[axis] - 1.0);
        centre[0] += half * (double)frame->step[axis].x;
        centre[1] += half * (double)frame->step[axis].y;
        centre[2] += half * (double)frame->step[axis].z;
        around += half * step_length(frame->step[axis]);
    }
    double along = 0.0, squared = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double to = centre[axis] - ray->origin[axis];
        along += to * ray->direction[axis];
        squared += to * to;
    }
    return squared - along * along <= around * around;
}

static bool local_meet(const lmb_probes *probes, const lmb_probe_local *local, lattice_ray *ray, lmb_rgb *colour)
{
    static const lmb_rgb belt = {{0.1f, 1.0f, 0.2f}};
    const double radius = local_radius(&local->frame);
    ray->probe = -1;
    for (uint32_t i = 0; local_is_near(&local->frame, radius, ray) && i < lmb_local_frame_count(&local->frame); ++i) {
        const lmb_vec3d at = lmb_local_frame_position(&local->frame, i);
        sphere_meet(ray, (const double[3]){at.x, at.y, at.z}, radius, (int32_t)i);
    }
    if (ray->probe < 0) {
        return false;
    }
    const lmb_vec3 normal = {(float)ray->normal[0], (float)ray->normal[1], (float)ray->normal[2]};
    *colour = white_paper(probes, &local->radiance[ray->probe], local->key_visibility[ray->probe], normal);
    if (fabsf(normal.y) < BELT) {
        const bool baked = local->validity[ray->probe] >= LMB_PROBES_MIN_VALIDITY;
        *colour = lmb_rgb_scale(baked ? belt : unbaked, lmb_luminance(*colour) + 0.01f);
    }
    return true;
}

bool probe_spheres_nearest(const probe_spheres *spheres, lmb_vec3d origin, lmb_vec3 direction, float start,
                           float *distance, lmb_rgb *colour)
{
    bool found = false;
    /* Exactly unit: spheres that are grazed magnify what is missing. */
    const double x = (double)direction.x, y = (double)direction.y, z = (double)direction.z;
    const double length = sqrt(x * x + y * y + z * z);
    for (uint32_t level = 0; level < spheres->probes->level_count; ++level) {
        const double spacing = (double)spheres->probes->level[level].lattice.spacing;
        lattice_ray ray = {.origin = {origin.x / spacing, origin.y / spacing, origin.z / spacing},
                           .direction = {x / length, y / length, z / length},
                           .start = (double)start / spacing,
                           .nearest = (double)*distance / spacing,
                           .probe = -1};
        level_walk(spheres, level, &ray);
        if (ray.probe >= 0) {
            const lmb_vec3 normal = {(float)ray.normal[0], (float)ray.normal[1], (float)ray.normal[2]};
            *distance = (float)(ray.nearest * spacing);
            *colour = sphere_colour(spheres->probes, ray.probe, normal);
            found = true;
        }
    }
    lattice_ray ray = {.origin = {origin.x, origin.y, origin.z},
                       .direction = {x / length, y / length, z / length},
                       .start = (double)start,
                       .nearest = (double)*distance};
    for (uint32_t i = 0; i < spheres->probes->local_count; ++i) {
        found |= local_meet(spheres->probes, &spheres->probes->local[i], &ray, colour);
    }
    *distance = (float)ray.nearest;
    return found;
}
