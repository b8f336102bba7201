/* The points that placement looks at, all of a box, and the steps that fill it. */
#ifndef LMB_PLACEMENT_INTERNAL_H
#define LMB_PLACEMENT_INTERNAL_H

#include <lambent/placement.h>

typedef struct lmb_survey {
    float spacing;
    lmb_vec3d origin; /* the scene's; its points' numbers count from the world's */
    int32_t min[3];
    int32_t size[3];
    size_t count;
    float *validity; /* [point] share of rays that see no back face, or 0 for a solid point */
    uint8_t *free;   /* [point] 1: an object can be here */
} lmb_survey;

static inline size_t survey_index(const lmb_survey *survey, int32_t x, int32_t y, int32_t z)
{
    return (size_t)x + (size_t)survey->size[0] * ((size_t)y + (size_t)survey->size[1] * (size_t)z);
}

/* In the scene. */
static inline lmb_vec3 survey_position(const lmb_survey *survey, int32_t x, int32_t y, int32_t z)
{
    const double spacing = (double)survey->spacing;
    const lmb_vec3 position = {(float)((double)(survey->min[0] + x) * spacing - survey->origin.x),
                               (float)((double)(survey->min[1] + y) * spacing - survey->origin.y),
                               (float)((double)(survey->min[2] + z) * spacing - survey->origin.z)};
    return position;
}

/* Fills validity and `free` from rays. */
lmb_result lmb_survey_classify(lmb_survey *survey, const lmb_tracer *tracer, lmb_pool *pool,
                               const lmb_progress *progress, uint64_t *rays);

/* Where a seed point lies. */
typedef enum lmb_seed_state { LMB_SEED_FREE, LMB_SEED_SOLID, LMB_SEED_OUTSIDE } lmb_seed_state;

/* Clears `free` where no seed point is connected through free space. `states` has room for each seed. */
lmb_result lmb_survey_flood(lmb_survey *survey, const lmb_tracer *tracer, const lmb_vec3 *seeds, uint32_t seed_count,
                            lmb_seed_state *states, uint64_t *rays);

/* Number of a level's cells with all eight probes, and how many of them a static triangle passes through. */
lmb_result lmb_placement_count_cells(const lmb_probes *probes, uint32_t level, const lmb_tracer *tracer, int64_t *cells,
                                     int64_t *crossed);

#endif
