/* Where probes go: a world-aligned lattice over the level, without the points that no dynamic object needs, and then
 * levels of lattices beside it, finer ones where light changes fast and coarser ones where it does not. */
#ifndef LAMBENT_PLACEMENT_H
#define LAMBENT_PLACEMENT_H

#include <lambent/gather_elements.h>
#include <lambent/pool.h>
#include <lambent/probes.h>
#include <lambent/trace.h>
#include <lambent/transport.h>
#include <lambent/warning.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_placement_settings {
    float spacing;      /* metres; 0: lmb_placement_default_spacing */
    int32_t max_probes; /* at least 27; the spacing grows until there are no more than this */
    /* In the world: free space connected to these is baked; beside the scene's own seed points. */
    const lmb_vec3d *seeds;
    uint32_t seed_count;          /* no seeds at all: every free point within the bounds */
    bool for_levels;              /* lmb_placement_levels follows: free points in boxes without probes are kept */
    lmb_warnings warnings;        /* seeds that are ignored, each by name */
    const lmb_progress *progress; /* NULL: none */
} lmb_placement_settings;

/* spacing 0, max_probes 262 144, no seeds. */
lmb_placement_settings lmb_placement_settings_default(void);

/* A round figure in metres for about 32 768 points in the level's bounds: units vary from level to level. */
float lmb_placement_default_spacing(const lmb_scene *scene);

typedef struct lmb_placement_stats {
    int32_t probes_valid;   /* to be baked */
    int32_t probes_dilated; /* inside solids, or out of reach, beside valid ones */
    int32_t probes_hanging; /* on coarser cells, whose light they have (lambent/probes.h) */
    int64_t cells;          /* that light is interpolated in */
    int64_t cells_crossed;  /* of these, cells that a triangle passes through */
    uint64_t rays;
    bool seeds_in_solid;   /* at least one seed point lies inside something, or outside the level, and was ignored */
    bool everything_solid; /* the level's winding calls all its space solid: the test of being inside was ignored */
    /* Of levels. */
    double tolerance_scale; /* by how much all tolerances were raised for max_probes; 1 when there was room */
    uint32_t levels_lost;   /* finest ones that boxes asked for and max_probes did not allow */
} lmb_placement_stats;

/* Places probes. A point is solid when most of the rays that hit anything hit a back face AND signed crossings of
 * surfaces over whole rays do not say that it lies within a room that faces inwards. Probes are made for every corner
 * of every cell that has at least one free, reachable corner outside of the scene's boxes without probes; those not
 * free have validity 0 and are to be filled by lmb_probes_dilate. `*probes` have validity set and no light.
 * @return LMB_ERROR_UNSUPPORTED (no triangles, so no bounds; spacing too fine for the level's size; seeds, of which
 * none lies in free space; or all of it in boxes without probes), _MEMORY, _INTERRUPTED */
lmb_result lmb_placement_make(const lmb_tracer *tracer, const lmb_placement_settings *settings, lmb_pool *pool,
                              lmb_probes **probes, lmb_placement_stats *stats, lmb_error *error);

/* Which levels there may be at a place, by number: 0 is the finest of all. */
typedef struct lmb_level_rule {
    uint32_t coarsest, finest; /* finest <= coarsest */
    double tolerance;          /* as lmb_levels_settings has it */
} lmb_level_rule;

typedef struct lmb_levels_settings {
    uint32_t coarser, finer; /* levels beside the even one, each of twice, or of half the spacing of the one before */
    double tolerance; /* of interpolation on the coarsest level, relative to the light at a place, or to `dark` where
                         that is more; 2.8 times that on each finer one */
    const lmb_level_rule *rule; /* [box] of the scene's boxes that have probes, and one more for all other places;
                                   NULL: every level everywhere, by `tolerance` */
    double dark;                /* radiance */
    lmb_gather_effort effort;   /* of trials */
    int32_t max_probes;         /* tolerances are raised until there are no more than this; the coarsest level stays */
    bool has_seeds;             /* as the even level was placed with: the scene's own count too */
    const lmb_progress *progress; /* NULL: none. Its phase is "levels" */
} lmb_levels_settings;

/* Puts levels in place of the one that lmb_placement_make made, whose spacing is one of theirs. Everything begins with
 * the coarsest. Where a rule wants finer levels, or the mean squared error of interpolation over the centres of a
 * cube's 2 x 2 x 2 cells and of their faces is more than the tolerance's square, the cube gives way to the next finer
 * level. A finer level takes eight times as many probes, so the square may be eight times as large there: all probes
 * are spent where they take away most error. No place counts for more than its light. The error is of what an object
 * sees: of normalised irradiance, by SH3 and key lights, over all normals. It is found by gathering a little light
 * there and at the corners, and its noise is taken off.
 * `*probes` are replaced on success; `*stats`, of the even level, become those of all. The same for any number of
 * threads.
 * @return LMB_ERROR_UNSUPPORTED (the finest spacing is too fine for the level's size), _MEMORY, _INTERRUPTED */
lmb_result lmb_placement_levels(const lmb_transport *transport, const lmb_levels_settings *settings, lmb_pool *pool,
                                lmb_probes **probes, lmb_placement_stats *stats, lmb_error *error);

/* Finds which probes hang (lambent/probes.h) once their levels, and their cuts if there are any, are there: valid ones,
 * which see into the leaf that they lie on. Counts `*stats`' probes anew and adds to its rays.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_placement_hang(const lmb_tracer *tracer, lmb_pool *pool, lmb_probes *probes, lmb_placement_stats *stats);

/* Where the light of a probe at lattice position `position` is gathered: there, or, when that is on a surface or
 * almost, a twentieth of the spacing in front of it. Adds to `*rays`. */
lmb_vec3 lmb_placement_relocate(const lmb_tracer *tracer, lmb_vec3 position, float spacing, uint64_t *rays);

/* Whether a point is in free space rather than in a solid, by the test that placement uses. Adds to `*rays`. */
bool lmb_placement_is_free(const lmb_tracer *tracer, lmb_vec3 position, uint64_t *rays);

#ifdef __cplusplus
}
#endif

#endif
