#include "probes/placement_sites.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/probe_boxes.h>
#include <lambent/vector.h>

enum { SITES_PER_TASK = 64, SITES_AT_ONCE = 256 * LMB_GATHER_GROUP };

/* As a probe's: it speaks for the space within half its spacing. */
#define LIGHT_DISTANCE_SPACINGS 0.5f

lmb_result lmb_sites_open(lmb_sites *sites)
{
    const lmb_scene *scene = lmb_tracer_scene(sites->transport->tracer);
    const float even_spacing = sites->even->level[0].lattice.spacing;
    sites->spacing = even_spacing / (float)(UINT32_C(1) << sites->even_level);
    const bool fits =
        lmb_placement_box(scene, even_spacing, &sites->box) && lmb_placement_box(scene, sites->spacing, &sites->bounds);
    return fits ? LMB_OK : LMB_ERROR_UNSUPPORTED;
}

void lmb_sites_close(lmb_sites *sites)
{
    lmb_point_set_free(&sites->points);
    free(sites->site);
    sites->site = NULL;
}

/* On the finest lattice. */
static void finest_point(uint32_t level, const int32_t point[3], int32_t finest[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        finest[axis] = (int32_t)((uint32_t)point[axis] << level);
    }
}

lmb_result lmb_sites_add(lmb_sites *sites, uint32_t level, const int32_t point[3])
{
    int32_t at[3];
    finest_point(level, point, at);
    const int32_t count = sites->points.count, room = sites->points.room;
    const lmb_result result = lmb_point_set_add(&sites->points, at);
    if (result == LMB_OK && (sites->points.room != room || !sites->site)) {
        lmb_site *const site = realloc(sites->site, (size_t)sites->points.room * sizeof *site);
        if (!site) {
            sites->points.count = count;
            return LMB_ERROR_MEMORY;
        }
        sites->site = site;
    }
    if (sites->points.count > count) {
        sites->site[count] = (lmb_site){.level = (uint8_t)level};
    }
    return result;
}

bool lmb_sites_cell_counts(const lmb_sites *sites, uint32_t level, const int32_t cell[3])
{
    const int64_t step = INT64_C(1) << level;
    bool counts = true;
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t low = sites->bounds.min[axis], high = low + sites->bounds.size[axis] - 1;
        counts = counts && cell[axis] * step < high && (cell[axis] + 1) * step > low;
    }
    return counts;
}

bool lmb_sites_point_counts(const lmb_sites *sites, uint32_t level, const int32_t point[3])
{
    int32_t at[3];
    finest_point(level, point, at);
    return lmb_lattice_has(&sites->bounds, at);
}

lmb_site *lmb_sites_find(const lmb_sites *sites, uint32_t level, const int32_t point[3])
{
    int32_t at[3];
    finest_point(level, point, at);
    const int32_t found = lmb_probe_index_find(&sites->points.index, at);
    return found >= 0 ? &sites->site[found] : NULL;
}

static lmb_vec3 site_position(const lmb_sites *sites, int32_t number)
{
    const lmb_vec3d origin = lmb_tracer_scene(sites->transport->tracer)->origin;
    const lmb_lattice lattice = {.spacing = sites->spacing};
    const lmb_vec3d world = lmb_lattice_position(&lattice, sites->points.point[number]);
    return lmb_vec3_of((float)(world.x - origin.x), (float)(world.y - origin.y), (float)(world.z - origin.z));
}

/* Whether a point lies on the even lattice, and where. */
static bool even_point(const lmb_sites *sites, const int32_t finest[3], int32_t even[3])
{
    const uint32_t step = UINT32_C(1) << sites->even_level;
    bool is_even = true;
    for (int axis = 0; axis < 3; ++axis) {
        is_even = is_even && ((uint32_t)finest[axis] & (step - 1)) == 0;
        even[axis] = finest[axis] / (int32_t)step;
    }
    return is_even;
}

static bool is_in_box(const lmb_sites *sites, const int32_t finest[3])
{
    const int64_t step = INT64_C(1) << sites->even_level;
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t low = sites->box.min[axis] * step, high = low + (sites->box.size[axis] - 1) * step;
        inside = inside && finest[axis] >= low && finest[axis] <= high;
    }
    return inside;
}

/* Whether a free one of the points around a site on the next coarser level sees it. */
static bool site_is_reached(const lmb_sites *sites, int32_t number, uint64_t *rays)
{
    const int32_t *const at = sites->points.point[number];
    const uint32_t level = sites->site[number].level;
    const int32_t step = (int32_t)(UINT32_C(1) << level);
    for (int corner = 0; corner < 8; ++corner) {
        int32_t from[3];
        bool is_new = true; /* along an axis where the point is on the coarser lattice both corners are one */
        for (int axis = 0; axis < 3; ++axis) {
            const bool between = ((uint32_t)at[axis] & (uint32_t)step) != 0;
            const bool above = (corner >> axis & 1) != 0;
            is_new = is_new && (between || !above);
            from[axis] = between ? at[axis] + (above ? step : -step) : at[axis];
        }
        const int32_t parent = is_new ? lmb_probe_index_find(&sites->points.index, from) : -1;
        if (parent >= 0 && parent < sites->known && sites->site[parent].free &&
            lmb_rgb_max(lmb_trace_transmittance(sites->transport->tracer, site_position(sites, parent),
                                                site_position(sites, number), rays)) > 0.0f) {
            return true;
        }
    }
    return false;
}

static void site_look(const lmb_sites *sites, int32_t number, uint64_t *rays)
{
    const lmb_tracer *tracer = sites->transport->tracer;
    lmb_site *const site = &sites->site[number];
    int32_t even[3];
    const bool inside = is_in_box(sites, sites->points.point[number]);
    site->position =
        lmb_placement_relocate(tracer, site_position(sites, number), lmb_sites_spacing(sites, site->level), rays);
    if (inside && even_point(sites, sites->points.point[number], even)) {
        const int32_t probe = lmb_probe_index_find(&sites->even->level[0].index, even);
        site->validity = probe >= 0 ? sites->even->validity[probe] : 0.0f;
        site->free = site->validity >= LMB_PROBES_MIN_VALIDITY;
    } else if (inside || !sites->has_seeds) {
        site->free = true;
        site->validity =
            sites->everything_is_free ? 1.0f : lmb_placement_validity(tracer, site->position, &site->free, rays);
        site->free = site->free && (!sites->has_seeds || site_is_reached(sites, number, rays));
    }
    site->validity = site->free ? site->validity : 0.0f;
    site->wanted = site->free && !lmb_scene_probes_excluded(lmb_tracer_scene(tracer), site_position(sites, number));
}

typedef struct look_work {
    const lmb_sites *sites;
    uint64_t *rays; /* [task] */
} look_work;

static void look_task(void *context, size_t task, int worker)
{
    (void)worker;
    const look_work *work = context;
    const lmb_sites *sites = work->sites;
    const int32_t first = sites->known + (int32_t)task * SITES_PER_TASK;
    const int32_t rest = sites->points.count - first;
    uint64_t rays = 0;
    for (int32_t i = 0; i < SITES_PER_TASK && i < rest; ++i) {
        site_look(sites, first + i, &rays);
    }
    work->rays[task] = rays;
}

/* Passes a part of the work on as a share of all. */
static bool share_report(void *context, const char *phase, double done)
{
    const lmb_sites *sites = context;
    (void)phase; /* of a list that bakes have, too */
    return sites->progress->report(sites->progress->context, "levels", sites->done + sites->share * done);
}

lmb_result lmb_sites_look(lmb_sites *sites)
{
    const size_t added = (size_t)(sites->points.count - sites->known);
    const size_t tasks = (added + SITES_PER_TASK - 1) / SITES_PER_TASK;
    look_work work = {sites, calloc(tasks + 1, sizeof *work.rays)};
    if (!work.rays) {
        return LMB_ERROR_MEMORY;
    }
    const lmb_result result = lmb_pool_run(sites->pool, tasks, look_task, &work, "levels", NULL);
    for (size_t i = 0; i < tasks; ++i) {
        sites->rays += work.rays[i];
    }
    sites->known = sites->points.count;
    free(work.rays);
    return result;
}

typedef struct light_list {
    const lmb_sites *sites;
    const int32_t *number;
} light_list;

static void light_site(const void *context, size_t element, lmb_gather_site *site)
{
    const light_list *list = context;
    const lmb_sites *sites = list->sites;
    const int32_t number = list->number[element];
    const lmb_site *from = &sites->site[number];
    site->point[0] =
        (lmb_gather_point){.position = from->position,
                           .min_light_distance = LIGHT_DISTANCE_SPACINGS * lmb_sites_spacing(sites, from->level)};
    site->count = 1;
}

lmb_result lmb_sites_gather(lmb_sites *sites, const lmb_gather_list *list, lmb_gathered *gathered)
{
    const lmb_gather_job job = lmb_gather_job_all(sites->transport, list, &sites->effort);
    const bool reports = sites->progress && sites->progress->report;
    const lmb_progress progress = {reports ? share_report : NULL, sites};
    lmb_gather_stats stats;
    const lmb_result result = lmb_gather_elements(&job, sites->pool, &progress, gathered, &stats);
    sites->rays += result == LMB_OK ? stats.rays : 0;
    return result;
}

static lmb_result light_some(lmb_sites *sites, const int32_t *number, size_t count, lmb_gathered *gathered)
{
    const light_list context = {sites, number};
    const lmb_gather_list list = {
        .name = "levels", .count = count, .most_points = 1, .find_site = light_site, .context = &context};
    const lmb_result result = lmb_sites_gather(sites, &list, gathered);
    if (result != LMB_OK) {
        return result;
    }
    for (size_t i = 0; i < count; ++i) {
        lmb_site *const site = &sites->site[number[i]];
        site->light = gathered[i].moments;
        site->difference = gathered[i].difference;
        memcpy(site->key_visibility, gathered[i].key_visibility, sizeof site->key_visibility);
        site->lit = true;
    }
    return LMB_OK;
}

lmb_result lmb_sites_light(lmb_sites *sites, const int32_t *number, size_t count)
{
    int32_t *const dark = malloc((count + 1) * sizeof *dark);
    lmb_gathered *const gathered = malloc((SITES_AT_ONCE + 1) * sizeof *gathered);
    lmb_result result = dark && gathered ? LMB_OK : LMB_ERROR_MEMORY;
    size_t dark_count = 0;
    for (size_t i = 0; i < count && result == LMB_OK; ++i) {
        lmb_site *const site = &sites->site[number[i]];
        if (site->free && !site->lit) {
            site->lit = true; /* a number may come twice */
            dark[dark_count++] = number[i];
        }
    }
    const double done = sites->done, share = sites->share;
    for (size_t first = 0; first < dark_count && result == LMB_OK; first += SITES_AT_ONCE) {
        const size_t rest = dark_count - first, part = rest < SITES_AT_ONCE ? rest : SITES_AT_ONCE;
        sites->done = done + share * (double)first / (double)dark_count;
        sites->share = share * (double)part / (double)dark_count;
        result = light_some(sites, dark + first, part, gathered);
    }
    sites->done = done;
    sites->share = share;
    free(dark);
    free(gathered);
    return result;
}
