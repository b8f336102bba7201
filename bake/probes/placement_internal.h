/* The survey: the points of a box of the lattice that placement looks at, as far as it has to, and the steps that fill
 * it. */
#ifndef LMB_PLACEMENT_INTERNAL_H
#define LMB_PLACEMENT_INTERNAL_H

#include <lambent/placement.h>

/* Points of a lattice, each once, numbered as they came. Zeroed, it is empty. */
typedef struct lmb_point_set {
    int32_t count, room;
    int32_t (*point)[3];
    lmb_probe_index index;
} lmb_point_set;

#define LMB_POINT_SET_MOST (1 << 28)

/* Adds a point unless it is there. @return LMB_ERROR_UNSUPPORTED (there would be more than LMB_POINT_SET_MOST),
 * _MEMORY */
lmb_result lmb_point_set_add(lmb_point_set *set, const int32_t point[3]);
void lmb_point_set_free(lmb_point_set *set);

/* Puts the points in the order that files have them, x fastest; their numbers are lost. */
void lmb_point_set_sort(lmb_point_set *set);

/* The box of the points; of none, that of the lattice's first. */
lmb_lattice lmb_point_set_box(const lmb_point_set *set, float spacing);

/* The box of cells over the level's bounds. @return false when it is too far from the world's origin */
bool lmb_placement_box(const lmb_scene *scene, float spacing, lmb_lattice *box);

/* The share of rays from a point that see no back face, less than LMB_PROBES_MIN_VALIDITY in a solid, and not less in
 * free space. Adds to `*rays`. */
float lmb_placement_validity(const lmb_tracer *tracer, lmb_vec3 position, bool *is_free, uint64_t *rays);

typedef struct lmb_survey {
    const lmb_tracer *tracer;
    lmb_pool *pool;
    const lmb_progress *progress;
    lmb_vec3d origin; /* the scene's; points count from the world's */
    lmb_lattice box;
    lmb_point_set points; /* those looked at; the first `classified` have the rest too */
    int32_t classified;
    float *validity; /* [point] share of rays that see no back face, or 0 for a solid point */
    uint8_t *free;   /* [point] 1: an object can be here */
    uint64_t rays;
    double reported; /* when progress was, seconds */
} lmb_survey;

/* In the scene. */
static inline lmb_vec3 survey_position(const lmb_survey *survey, const int32_t point[3])
{
    const lmb_vec3d world = lmb_lattice_position(&survey->box, point);
    const lmb_vec3 position = {(float)(world.x - survey->origin.x), (float)(world.y - survey->origin.y),
                               (float)(world.z - survey->origin.z)};
    return position;
}

/* Points of the box; a double, as there may be more than any integer holds. */
static inline double survey_box_points(const lmb_survey *survey)
{
    return (double)survey->box.size[0] * survey->box.size[1] * survey->box.size[2];
}

/* Looks at every point of the box. @return LMB_ERROR_UNSUPPORTED (too many), _MEMORY, _INTERRUPTED */
lmb_result lmb_survey_fill(lmb_survey *survey);

/* Fills validity and `free` of the points that were added since the last time, from rays.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_survey_classify(lmb_survey *survey);

/* Where a seed point lies. */
typedef enum lmb_seed_state { LMB_SEED_FREE, LMB_SEED_SOLID, LMB_SEED_OUTSIDE } lmb_seed_state;

/* All seeds: the caller's, then the scene's own. */
typedef struct lmb_seed_list {
    uint32_t count;
    uint32_t callers;
    lmb_vec3 *at;
    lmb_seed_state *state;
} lmb_seed_list;

/* Looks at what is connected to a seed through free space, and no farther than next to it, and clears `free` of all
 * else. Sets the seeds' states. `*any` is false when no seed lies in free space: then nothing is cleared.
 * @return LMB_ERROR_UNSUPPORTED (too many points), _MEMORY, _INTERRUPTED */
lmb_result lmb_survey_flood(lmb_survey *survey, const lmb_seed_list *seeds, bool *any);

/* Whether a triangle, given relative to the centre of a cube of half side 1, touches the cube. */
bool lmb_triangle_touches_cube(const lmb_vec3 corner[3]);

/* Number of a level's leaf cells, and how many of them a static triangle passes through. */
lmb_result lmb_placement_count_cells(const lmb_probes *probes, uint32_t level, const lmb_tracer *tracer, int64_t *cells,
                                     int64_t *crossed);

#endif
