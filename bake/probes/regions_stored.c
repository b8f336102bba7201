#include "probes/regions_stored.h"

#include <math.h>
#include <stdlib.h>

#include "probes/regions_internal.h"

/* Names all there is, in its order: written, or read. */
static void regions_move(lmb_stored *stored, lmb_regions *regions, int32_t probes)
{
    uint64_t counts[3] = {regions->point_count, regions->hanging_count, regions->place_count};
    LMB_STORED(stored, counts);
    LMB_STORED(stored, regions->region_count);
    LMB_STORED(stored, regions->unknown_count);
    regions->point_count = (size_t)counts[0];
    regions->hanging_count = (size_t)counts[1];
    regions->place_count = (size_t)counts[2];
    regions->point = lmb_stored_array(stored, regions->point, regions->point_count, sizeof *regions->point);
    regions->place = lmb_stored_array(stored, regions->place, regions->place_count, sizeof *regions->place);
    regions->corner = lmb_stored_array(stored, regions->corner, regions->region_count, sizeof *regions->corner);
    regions->hanging = lmb_stored_array(stored, regions->hanging, regions->hanging_count, sizeof *regions->hanging);
    regions->hangs = lmb_stored_array(stored, regions->hangs, (size_t)probes, sizeof *regions->hangs);
    regions->unknown = lmb_stored_array(stored, regions->unknown, regions->unknown_count, sizeof *regions->unknown);
    regions->unknown_of = lmb_stored_array(stored, regions->unknown_of, (size_t)probes, sizeof *regions->unknown_of);
}

void lmb_regions_write(const lmb_regions *regions, int32_t probes, lmb_stored *stored)
{
    /* Structures of fours of bytes: without padding. */
    _Static_assert(sizeof(lmb_region_point) == 8 * sizeof(float), "padded");
    _Static_assert(sizeof(lmb_region_place) == 4 * sizeof(float), "padded");
    _Static_assert(sizeof(lmb_region_hanging) == 18 * sizeof(float), "padded");
    lmb_regions own = *regions;
    regions_move(stored, &own, probes);
}

static bool are_probes(const int32_t *value, size_t count, int32_t probes)
{
    bool sane = true;
    for (size_t i = 0; i < count && sane; ++i) {
        sane = value[i] >= 0 && value[i] < probes;
    }
    return sane;
}

/* Whether rays can begin there: not where numbers overflow. */
static bool is_place(lmb_vec3 at)
{
    const float farthest = 1e18f;
    return fabsf(at.x) < farthest && fabsf(at.y) < farthest && fabsf(at.z) < farthest;
}

static bool regions_are_sane(const lmb_regions *regions, int32_t probes)
{
    bool sane =
        are_probes(regions->unknown, regions->unknown_count, probes) &&
        (regions->region_count == 0 || are_probes(regions->corner[0], 8 * (size_t)regions->region_count, probes));
    for (size_t i = 0; i < regions->point_count && sane; ++i) {
        const lmb_region_point *const point = &regions->point[i];
        sane = point->region < regions->region_count && point->spacing > 0.0f && is_place(point->position);
    }
    for (size_t i = 0; i < regions->place_count && sane; ++i) {
        sane = regions->place[i].region < regions->region_count;
    }
    for (size_t i = 0; i < regions->hanging_count && sane; ++i) {
        sane = are_probes(&regions->hanging[i].value, 1, probes) && are_probes(regions->hanging[i].parent, 8, probes);
    }
    for (int32_t i = 0; i < probes && sane; ++i) {
        sane = regions->unknown_of[i] >= -1 && regions->unknown_of[i] < (int64_t)regions->unknown_count;
    }
    return sane;
}

lmb_regions *lmb_regions_read(lmb_stored *stored, int32_t probes)
{
    lmb_regions *const regions = calloc(1, sizeof *regions);
    if (!regions) {
        stored->result = LMB_ERROR_MEMORY;
        return NULL;
    }
    regions_move(stored, regions, probes);
    if (stored->result == LMB_OK && lmb_stored_expect(stored, regions_are_sane(regions, probes))) {
        return regions;
    }
    lmb_regions_destroy(regions);
    return NULL;
}
