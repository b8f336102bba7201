/* Cells of probes that geometry cuts: which regions of free space they fall into, and light for the corners of each.
 *
 * After virtual nodes (Molino, Bao and Fedkiw 2004, "A Virtual Node Algorithm for Changing Mesh Topology During
 * Simulation"). A cell that a triangle touches is looked at from a grid of nodes: those that see each other along it
 * are one region. Each region has eight values, one a corner of the cell; where regions of neighbouring cells touch,
 * the values of the corners that they share are one. One that any of its regions sees the baked probe of is that probe.
 * The others are fitted, by least squares, to light that is gathered inside of their regions: one of each corner is
 * what the lattice's own probe holds, if that was not baked; what is more than one becomes ghosts, and the cells that
 * need them are cut. So light is continuous wherever one can walk within cells, and breaks at walls. */
#ifndef LAMBENT_REGIONS_H
#define LAMBENT_REGIONS_H

#include <lambent/gather_sh3.h>
#include <lambent/pool.h>
#include <lambent/probes.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_regions lmb_regions;

typedef struct lmb_regions_stats {
    int64_t cells_looked_into; /* that opaque triangles touch */
    int64_t cells_cut;
    int64_t cells_parted; /* of these, in two or more regions */
    int64_t ghosts;
    int64_t fitted; /* probes of the lattice that were not baked and get light from their cells */
    int64_t points; /* that light is gathered at for that */
    int64_t planes;
    int64_t strays; /* nodes, and places beside surfaces, that planes take for another region's, of cells cut */
    uint64_t rays;
} lmb_regions_stats;

/* Cuts cells of probes that were just placed, and adds ghosts to them, still dark. `tracer` must outlive the regions.
 * The same for any number of threads.
 * @return LMB_ERROR_ARGUMENT (the probes have ghosts or cut cells), _MEMORY, _INTERRUPTED; then cells may be cut */
lmb_result lmb_regions_make(const lmb_tracer *tracer, lmb_pool *pool, const lmb_progress *progress, lmb_probes *probes,
                            lmb_regions **regions, lmb_regions_stats *stats);

/* NULL is allowed. */
void lmb_regions_destroy(lmb_regions *regions);

/* A place inside of a region whose light tells what its corners are to hold. */
typedef struct lmb_region_point {
    lmb_vec3 position; /* in the scene, as lmb_probes_position has it */
    float t[3];        /* in its cell, 0 to 1 */
    uint32_t region;
    float spacing; /* metres, of its level */
} lmb_region_point;

/* Neighbours follow each other. */
const lmb_region_point *lmb_regions_points(const lmb_regions *regions, size_t *count);

/* Whether a probe has no light of its own: a region at one of its cells touches a coarser level's. */
bool lmb_regions_hangs(const lmb_regions *regions, int32_t probe);

/* Sets light, in a set of lights, and what is seen of key lights, of ghosts and of the probes that were not baked but
 * lie at corners of regions, by what was gathered at the points and what baked probes have; and of all that hangs on
 * coarser levels.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_regions_fit(const lmb_regions *regions, const lmb_gathered *gathered, uint32_t set, lmb_pool *pool,
                           lmb_probes *probes);

#ifdef __cplusplus
}
#endif

#endif
