#include "transport/path.h"

#include <lambent/vector.h>

#include "surface/surface_light_internal.h"

/* Roulette starts after this many reflections, for short paths carry most of the light, and then where less than
 * ROULETTE_BELOW is left of it: what survives carries that much. Survival is kept just below 1 so that a white room
 * ends. */
#define ROULETTE_AFTER 2
#define ROULETTE_BELOW 0.1f
#define ROULETTE_MAX_SURVIVAL 0.999f

/* A gap is narrow below this share of a cell's size: by lambent_convergence, `cached without near hits`. */
#define NARROW_SHARE 0.125f

/* The patch whose light stands for that of the very hit. False where it does not: the hit sees none, or is so near to
 * the cell that its mean is no measure of what one point of it sends. After the first reflection only that within a gap
 * counts as near, where light goes to and fro: one that is narrow beside its cells, or that the cell is partly in.
 * Counting the reflections forbids to put one more before what is stored. */
static bool patch_look_up(const lmb_path *path, const lmb_hit *hit, uint32_t *patch)
{
    const lmb_transport *transport = path->transport;
    const lmb_surface_light *light = transport->surface;
    const lmb_cell_grid *grid = lmb_cell_grid_at(light, hit);
    const bool near = transport->bounces < 0 && hit->distance < lmb_cell_near(grid);
    if (near && (path->vertex == 0 || hit->distance < NARROW_SHARE * grid->cell_size)) {
        return false;
    }
    return lmb_surface_light_patch(light, transport->tracer, hit, hit->front, path->rays, patch) &&
           !(near && light->openness[*patch] == LMB_CELL_MIXED);
}

/* Whether what a vertex reflects is to be looked up, and that. A camera sees each cell's edges, so its own vertex is
 * traced. */
static bool vertex_look_up(lmb_path *path, const lmb_segment *segment, const lmb_path_vertex *vertex,
                           lmb_rgb *irradiance)
{
    const lmb_surface_light *light = path->transport->surface;
    uint32_t patch;
    if (!light || !segment->from || !patch_look_up(path, &vertex->hit, &patch)) {
        return false;
    }
    *irradiance = light->irradiance[patch];
    if (lmb_patch_is_uneven(light, patch)) {
        ++path->vertex;
        const lmb_receiver here = lmb_vertex_receiver(path, vertex);
        const lmb_rgb direct = lmb_direct_collect_suns(path, &here);
        for (int c = 0; c < 3; ++c) {
            irradiance->c[c] = lmb_larger(irradiance->c[c] - light->sun[patch].c[c], 0.0f) + direct.c[c];
        }
    }
    return true;
}

/* The same of what only reflects, before it has been looked at: its radiance. */
static bool hit_look_up(const lmb_path *path, const lmb_hit *hit, lmb_rgb *radiance)
{
    const lmb_transport *transport = path->transport;
    const lmb_surface_light *light = transport->surface;
    uint32_t patch;
    if (!light || (transport->bounces >= 0 && path->vertex >= (uint32_t)transport->bounces) ||
        !lmb_cell_grid_at(light, hit)->even || !patch_look_up(path, hit, &patch) || lmb_patch_is_uneven(light, patch)) {
        return false;
    }
    *radiance = light->radiance[patch];
    return true;
}

lmb_rgb lmb_path_radiance(lmb_path *path, lmb_segment segment, lmb_path_vertex vertex)
{
    const lmb_transport *transport = path->transport;
    lmb_rgb radiance = {{0.0f, 0.0f, 0.0f}};
    lmb_receiver receivers[2]; /* the one at hand, and the one before, which `segment.from` points to */
    for (int turn = 0;; turn ^= 1) {
        radiance = lmb_rgb_add(radiance, lmb_rgb_mul(segment.throughput, vertex.emitted));
        if (!vertex.on_surface || !(lmb_rgb_max(vertex.albedo) > 0.0f) ||
            (transport->bounces >= 0 && path->vertex >= (uint32_t)transport->bounces)) {
            return radiance;
        }
        segment.throughput = lmb_rgb_mul(segment.throughput, vertex.albedo);
        lmb_rgb irradiance;
        if (vertex_look_up(path, &segment, &vertex, &irradiance)) {
            return lmb_rgb_add(radiance, lmb_rgb_mul(segment.throughput, irradiance));
        }
        ++path->vertex;
        float u[2];
        if (path->vertex > ROULETTE_AFTER) {
            const float survival = lmb_smaller(lmb_rgb_max(segment.throughput) / ROULETTE_BELOW, ROULETTE_MAX_SURVIVAL);
            lmb_path_variates(path, PAIR_ROULETTE, u);
            if (u[0] >= survival) {
                return radiance;
            }
            segment.throughput = lmb_rgb_scale(segment.throughput, 1.0f / survival);
        }
        lmb_receiver *here = &receivers[turn];
        *here = lmb_vertex_receiver(path, &vertex);
        radiance = lmb_rgb_add(radiance, lmb_rgb_mul(segment.throughput, lmb_direct_collect(path, here)));
        lmb_path_variates(path, PAIR_DIRECTION, u);
        segment.direction = lmb_receiver_direction(here, u);
        if (!lmb_receiver_sees(here, segment.direction)) {
            return radiance;
        }
        /* Cosine sampling cancels the cosine: the throughput stays. */
        segment.from = here;
        segment.origin = lmb_receiver_ray_origin(here, segment.direction);
        lmb_hit hit;
        const bool found = lmb_segment_trace(path, &segment, &hit);
        lmb_rgb reflected;
        if (found && hit_look_up(path, &hit, &reflected)) {
            return lmb_rgb_add(radiance, lmb_rgb_mul(segment.throughput, reflected));
        }
        vertex = lmb_segment_vertex(path, &segment, found ? &hit : NULL);
    }
}
