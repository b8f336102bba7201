/* Where light is gathered inside of regions: where values that are to be fitted weigh most, and spread over surfaces.
 */
#include "probes/regions_internal.h"

#include <stdlib.h>
#include <string.h>

/* A value that weighs less than that in all of its regions is only held to its neighbours. */
#define LEAST_WEIGHT 0.1f

/* Spacings that points keep from surfaces, along their axis. */
#define BEFORE_SURFACE 0.01f

enum { AT_NODE, AT_SURFACE, POINTS_EACH };

typedef struct point_choice {
    float weight; /* of the value; 0: none */
    uint32_t cell, region;
    float t[3];
} point_choice;

typedef struct points_work {
    lmb_region_work *all;
    point_choice *choice; /* of all points, twice or more some of them */
    size_t count;
    point_choice (*best)[POINTS_EACH]; /* [unknown] the first of these */
} points_work;

static float corner_weight(const float t[3], int corner)
{
    float weight = 1.0f;
    for (int axis = 0; axis < 3; ++axis) {
        weight *= (corner >> axis & 1) != 0 ? t[axis] : 1.0f - t[axis];
    }
    return weight;
}

static void choice_offer(point_choice *best, uint32_t cell, uint32_t region, const float t[3], int corner)
{
    const float weight = corner_weight(t, corner);
    if (weight > best->weight) {
        *best = (point_choice){weight, cell, region, {t[0], t[1], t[2]}};
    }
}

/* A place just before the surface where a node's ray ends. */
static void end_place(const lmb_region_end *end, float t[3])
{
    lmb_region_node_at(end->node, t);
    const float at = (float)end->at / 65535.0f, way = at - t[end->axis];
    const float kept = lmb_smaller(BEFORE_SURFACE, way < 0.0f ? -0.5f * way : 0.5f * way);
    t[end->axis] = way < 0.0f ? at + kept : at - kept;
}

/* Whether an end lies on one of five lines of each axis: four near the points of Gauss's rule of 2 x 2, and one near
 * the middle. What is fitted to light before a surface there has the surface's mean, wherever in the cell light
 * changes. */
static bool end_is_spread(const lmb_region_end *end)
{
    bool outer = true, middle = true;
    for (int axis = 0; axis < 3; ++axis) {
        const int at = end->node / lmb_region_stride(axis) % LMB_REGION_SIDE;
        outer = outer && (axis == end->axis || at == 1 || at == LMB_REGION_SIDE - 2);
        middle = middle && (axis == end->axis || at == 2);
    }
    return outer || middle;
}

/* Offers the places of a region for one of its corners. */
static void region_offer(const points_work *work, uint32_t cell, uint32_t label, int corner, point_choice *best)
{
    const lmb_region_cell *const own = &work->all->cell[cell];
    const lmb_region_look *const look = own->look == UINT32_MAX ? NULL : &work->all->look[own->look];
    float t[3];
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        if (!look || look->label[node] == label) {
            lmb_region_node_at(node, t);
            choice_offer(&best[AT_NODE], cell, own->first + label, t, corner);
        }
    }
    for (uint32_t i = 0; look && i < look->end_count; ++i) {
        if (look->label[look->end[i].node] == label) {
            end_place(&look->end[i], t);
            choice_offer(&best[AT_SURFACE], cell, own->first + label, t, corner);
        }
    }
}

static void choices_make(const points_work *work)
{
    const lmb_region_work *const all = work->all;
    const lmb_regions *const made = all->regions;
    for (uint32_t c = 0; c < all->cell_count; ++c) {
        for (uint32_t label = 0; label < all->cell[c].count; ++label) {
            const uint32_t region = all->cell[c].first + label;
            for (int corner = 0; corner < 8 && all->reached[region]; ++corner) {
                const int32_t unknown = made->unknown_of[all->corner[region][corner]];
                if (unknown >= 0) {
                    region_offer(work, c, label, corner, work->best[unknown]);
                }
            }
        }
    }
}

/* The place of a region before a surface that is best for one of its corners. `weight` 0: there is none. */
static point_choice surface_best(const lmb_region_work *all, uint32_t cell, uint32_t label, int corner)
{
    const lmb_region_cell *const own = &all->cell[cell];
    const lmb_region_look *const look = own->look == UINT32_MAX ? NULL : &all->look[own->look];
    point_choice best = {.weight = 0.0f};
    for (uint32_t i = 0; look && i < look->end_count; ++i) {
        if (look->label[look->end[i].node] == label) {
            float t[3];
            end_place(&look->end[i], t);
            choice_offer(&best, cell, own->first + label, t, corner);
        }
    }
    return best;
}

static void places_choose(const lmb_region_work *all, const uint32_t *kept)
{
    lmb_regions *const made = all->regions;
    for (uint32_t c = 0; c < all->cell_count; ++c) {
        for (uint32_t label = 0; label < all->cell[c].count; ++label) {
            const uint32_t region = all->cell[c].first + label;
            for (int corner = 0; corner < 8 && kept[region] != UINT32_MAX; ++corner) {
                if (made->unknown_of[all->corner[region][corner]] >= 0) {
                    const point_choice best = surface_best(all, c, label, corner);
                    if (best.weight > 0.0f) {
                        made->place[made->place_count++] =
                            (lmb_region_place){kept[region], {best.t[0], best.t[1], best.t[2]}};
                    }
                }
            }
        }
    }
}

/* Chooses all spread places before surfaces of regions that are kept. @return how many; `choice` NULL: they are only
 * counted */
static size_t spread_choose(const lmb_region_work *all, const uint32_t *kept, point_choice *choice)
{
    size_t count = 0;
    for (uint32_t l = 0; l < all->look_count; ++l) {
        const lmb_region_look *const look = &all->look[l];
        const uint32_t cell = all->looked[l];
        for (uint32_t i = 0; i < look->end_count; ++i) {
            const uint8_t label = look->label[look->end[i].node];
            const uint32_t region = all->cell[cell].first + label;
            if (label == LMB_REGION_NONE || kept[region] == UINT32_MAX || !end_is_spread(&look->end[i])) {
                continue;
            }
            if (choice) {
                choice[count] = (point_choice){.weight = 1.0f, .cell = cell, .region = region};
                end_place(&look->end[i], choice[count].t);
            }
            ++count;
        }
    }
    return count;
}

static int choice_compare(const void *left, const void *right)
{
    const point_choice *const a = left, *const b = right;
    for (int axis = 0; axis < 3 && a->region == b->region; ++axis) {
        if (a->t[axis] != b->t[axis]) {
            return a->t[axis] < b->t[axis] ? -1 : 1;
        }
    }
    return (a->region > b->region) - (a->region < b->region);
}

/* --- what is to be fitted ----------------------------------------------------------------------------------------- */

static bool is_unknown(const lmb_probes *probes, int32_t value)
{
    return value >= probes->count - probes->ghost_count || probes->validity[value] < LMB_PROBES_MIN_VALIDITY;
}

/* Numbers what is to be fitted, in the order of cells, and keeps the regions that have any. `kept` is the number of
 * each that is kept, UINT32_MAX of the others. */
static void unknown_find(const lmb_region_work *all, uint32_t *kept)
{
    lmb_regions *const made = all->regions;
    memset(kept, 0xff, all->region_count * sizeof *kept);
    memset(made->unknown_of, 0xff, (size_t)all->probes->count * sizeof *made->unknown_of);
    for (uint32_t region = 0; region < all->region_count; ++region) {
        bool any = false;
        for (int corner = 0; corner < 8 && all->reached[region]; ++corner) {
            const int32_t value = all->corner[region][corner];
            if (is_unknown(all->probes, value) && !made->hangs[value]) {
                any = true;
                if (made->unknown_of[value] < 0) {
                    all->stats->fitted += value < all->probes->count - all->probes->ghost_count;
                    made->unknown[made->unknown_count] = value;
                    made->unknown_of[value] = (int32_t)made->unknown_count++;
                }
            }
        }
        if (any) {
            memcpy(made->corner[made->region_count], all->corner[region], sizeof made->corner[0]);
            kept[region] = made->region_count++;
        }
    }
}

static void points_add(const points_work *work, const uint32_t *kept)
{
    lmb_regions *const made = work->all->regions;
    point_choice *const choice = work->choice;
    size_t count = 0;
    for (size_t i = 0; i < work->count; ++i) {
        if (choice[i].weight > LEAST_WEIGHT) {
            choice[count++] = choice[i];
        }
    }
    qsort(choice, count, sizeof *choice, choice_compare);
    for (size_t i = 0; i < count; ++i) {
        if (i > 0 && memcmp(choice[i - 1].t, choice[i].t, sizeof choice[i].t) == 0 &&
            choice[i - 1].region == choice[i].region) {
            continue;
        }
        const lmb_region_cell *const cell = &work->all->cell[choice[i].cell];
        const lmb_region_frame frame = lmb_region_frame_of(work->all->probes, cell);
        lmb_region_point *const point = &made->point[made->point_count++];
        memcpy(point->t, choice[i].t, sizeof point->t);
        point->position = lmb_region_position(&frame, point->t);
        point->region = kept[choice[i].region];
        point->spacing = frame.spacing;
    }
}

lmb_result lmb_region_points_choose(lmb_region_work *all)
{
    lmb_regions *const made = all->regions;
    const size_t probes = (size_t)all->probes->count + 1, regions = (size_t)all->region_count + 1;
    uint32_t *const kept = malloc(regions * sizeof *kept);
    made->unknown = malloc(probes * sizeof *made->unknown);
    made->unknown_of = malloc(probes * sizeof *made->unknown_of);
    made->corner = malloc(regions * sizeof *made->corner);
    points_work work = {.all = all};
    lmb_result result = LMB_ERROR_MEMORY;
    if (kept && made->unknown && made->unknown_of && made->corner) {
        unknown_find(all, kept);
        const size_t most = (size_t)made->unknown_count * POINTS_EACH + spread_choose(all, kept, NULL) + 1;
        work.choice = calloc(most, sizeof *work.choice);
        made->point = malloc(most * sizeof *made->point);
        made->place = malloc((8 * (size_t)made->region_count + 1) * sizeof *made->place);
        result = work.choice && made->point && made->place ? LMB_OK : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        const size_t best = (size_t)made->unknown_count * POINTS_EACH;
        work.best = (point_choice(*)[POINTS_EACH])work.choice;
        choices_make(&work);
        work.count = best + spread_choose(all, kept, work.choice + best);
        points_add(&work, kept);
        places_choose(all, kept);
        all->stats->points = (int64_t)made->point_count;
    }
    free(kept);
    free(work.choice);
    return result;
}
