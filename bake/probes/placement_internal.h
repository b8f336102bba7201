/* The lattice that placement works on, and the steps that fill it. */
#ifndef LMB_PLACEMENT_INTERNAL_H
#define LMB_PLACEMENT_INTERNAL_H

#include <lambent/placement.h>

typedef struct lmb_lattice {
    float spacing;
    lmb_vec3d origin; /* the scene's; the lattice itself counts from the world's */
    int32_t min[3];
    int32_t size[3];
    size_t count;
    float *validity; /* [point] share of rays that see no back face, or 0 for a solid point */
    uint8_t *free;   /* [point] 1: an object can be here */
} lmb_lattice;

static inline size_t lattice_index(const lmb_lattice *lattice, int32_t x, int32_t y, int32_t z)
{
    return (size_t)x + (size_t)lattice->size[0] * ((size_t)y + (size_t)lattice->size[1] * (size_t)z);
}

/* In the scene. */
static inline lmb_vec3 lattice_position(const lmb_lattice *lattice, int32_t x, int32_t y, int32_t z)
{
    const double spacing = (double)lattice->spacing;
    const lmb_vec3 position = {(float)((double)(lattice->min[0] + x) * spacing - lattice->origin.x),
                               (float)((double)(lattice->min[1] + y) * spacing - lattice->origin.y),
                               (float)((double)(lattice->min[2] + z) * spacing - lattice->origin.z)};
    return position;
}

/* Fills validity and `free` from rays. */
lmb_result lmb_lattice_classify(lmb_lattice *lattice, const lmb_tracer *tracer, lmb_pool *pool,
                                const lmb_progress *progress, uint64_t *rays);

/* Where a seed point lies. */
typedef enum lmb_seed_state { LMB_SEED_FREE, LMB_SEED_SOLID, LMB_SEED_OUTSIDE } lmb_seed_state;

/* Clears `free` where no seed point is connected through free space. `states` has room for each seed. */
lmb_result lmb_lattice_flood(lmb_lattice *lattice, const lmb_tracer *tracer, const lmb_vec3 *seeds, uint32_t seed_count,
                             lmb_seed_state *states, uint64_t *rays);

/* Number of the grid's cells with all eight probes, and how many of them a static triangle passes through. */
lmb_result lmb_grid_count_cells(const lmb_grid *grid, const lmb_tracer *tracer, int64_t *cells, int64_t *crossed);

#endif
