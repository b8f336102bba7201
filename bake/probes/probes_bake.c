#include <lambent/probes_bake.h>

#include <stdlib.h>
#include <string.h>

#include <lambent/denoise.h>
#include <lambent/key_lights.h>
#include <lambent/placement.h>
#include <lambent/probe_locals.h>

/* A probe speaks for the space within half its footprint. */
#define LIGHT_DISTANCE_FOOTPRINTS 0.5f

/* Valid probes of local sets, behind all others. */
static lmb_result locals_list(lmb_probe_list *list)
{
    const lmb_probes *const probes = list->probes;
    size_t most = 0;
    for (uint32_t set = 0; set < probes->local_count; ++set) {
        most += lmb_local_frame_count(&probes->local[set].frame);
    }
    list->local = malloc((most + 1) * sizeof *list->local);
    list->count = list->local_first;
    for (uint32_t set = 0; list->local && set < probes->local_count; ++set) {
        for (uint32_t i = 0; i < lmb_local_frame_count(&probes->local[set].frame); ++i) {
            if (probes->local[set].validity[i] >= LMB_PROBES_MIN_VALIDITY) {
                list->local[list->count++ - list->local_first] = (lmb_list_local){set, i};
            }
        }
    }
    return list->local ? LMB_OK : LMB_ERROR_MEMORY;
}

lmb_result lmb_probe_list_create(const lmb_probes *probes, const lmb_regions *regions, const lmb_tracer *tracer,
                                 lmb_probe_list *list)
{
    *list = (lmb_probe_list){.probes = probes,
                             .regions = regions,
                             .tracer = tracer,
                             .probe = malloc(((size_t)probes->count + 1) * sizeof *list->probe)};
    if (!list->probe) {
        return LMB_ERROR_MEMORY;
    }
    for (int32_t i = 0; i < probes->count - probes->ghost_count; ++i) {
        lmb_probe_parents parents;
        const bool hangs = regions ? lmb_regions_hangs(regions, i) : lmb_probes_hangs(probes, i, &parents);
        if (probes->validity[i] >= LMB_PROBES_MIN_VALIDITY && !hangs) {
            list->probe[list->probe_count++] = i;
        }
    }
    size_t points = 0;
    if (regions) {
        lmb_regions_points(regions, &points);
    }
    list->local_first = list->probe_count + points;
    const lmb_result result = locals_list(list);
    if (result != LMB_OK) {
        lmb_probe_list_free(list);
    }
    return result;
}

void lmb_probe_list_free(lmb_probe_list *list)
{
    free(list->probe);
    free(list->local);
    list->probe = NULL;
    list->local = NULL;
}

/* The point of a region that an element is, or NULL: it is a probe. */
static const lmb_region_point *region_point(const lmb_probe_list *list, size_t element)
{
    size_t count;
    return element < list->probe_count || element >= list->local_first
               ? NULL
               : &lmb_regions_points(list->regions, &count)[element - list->probe_count];
}

static void element_site(const void *context, size_t element, lmb_gather_site *site)
{
    const lmb_probe_list *list = context;
    const lmb_region_point *const inside = region_point(list, element);
    site->count = 1;
    if (inside) {
        site->brief = true; /* each value has several points, and several values each point */
        site->point[0] = (lmb_gather_point){.position = inside->position,
                                            .min_light_distance = LIGHT_DISTANCE_FOOTPRINTS * inside->spacing};
        return;
    }
    if (element >= list->local_first) {
        const lmb_list_local *const local = &list->local[element - list->local_first];
        const lmb_local_frame *const frame = &list->probes->local[local->set].frame;
        site->point[0] =
            (lmb_gather_point){.position = lmb_probe_local_site(list->tracer, frame, local->probe, &site->rays),
                               .min_light_distance = LIGHT_DISTANCE_FOOTPRINTS * lmb_probe_local_footprint(frame)};
        return;
    }
    const int32_t probe = list->probe[element];
    const lmb_vec3 position = lmb_probes_position(list->probes, probe);
    const float footprint = lmb_probes_footprint(list->probes, probe);
    site->point[0] =
        (lmb_gather_point){.position = lmb_placement_relocate(list->tracer, position, footprint, &site->rays),
                           .min_light_distance = LIGHT_DISTANCE_FOOTPRINTS * footprint};
}

lmb_gather_list lmb_probe_list_elements(const lmb_probe_list *list)
{
    return (lmb_gather_list){
        .name = "probes", .count = list->count, .most_points = 1, .find_site = element_site, .context = list};
}

lmb_result lmb_probe_list_denoise(const lmb_probe_list *list, lmb_pool *pool, const lmb_progress *progress,
                                  lmb_gathered *gathered)
{
    lmb_denoise_point *const points = malloc((list->probe_count + 1) * sizeof *points);
    if (!points) {
        return LMB_ERROR_MEMORY;
    }
    for (size_t i = 0; i < list->probe_count; ++i) {
        lmb_gather_point at;
        lmb_gather_site site = {.point = &at};
        element_site(list, i, &site);
        points[i] =
            (lmb_denoise_point){.position = at.position, .spacing = lmb_probes_footprint(list->probes, list->probe[i])};
    }
    const lmb_result result = lmb_denoise_in_space(points, list->probe_count, list->tracer, pool, progress, gathered);
    free(points);
    return result;
}

static void probes_fill(const lmb_probe_list *list, const lmb_gathered *gathered, lmb_probes *probes)
{
    for (size_t i = 0; i < list->probe_count; ++i) {
        probes->radiance[list->set][list->probe[i]] = gathered[i].moments;
        memcpy(probes->key_visibility[list->probe[i]], gathered[i].key_visibility, sizeof gathered[i].key_visibility);
    }
}

static void locals_fill(const lmb_probe_list *list, const lmb_gathered *gathered, lmb_probes *probes)
{
    for (size_t i = list->local_first; i < list->count; ++i) {
        const lmb_list_local *const at = &list->local[i - list->local_first];
        lmb_probe_local *const local = &probes->local[at->set];
        local->radiance[at->probe] = gathered[i].moments;
        memcpy(local->key_visibility[at->probe], gathered[i].key_visibility, sizeof gathered[i].key_visibility);
    }
    lmb_probes_dilate_locals(probes);
}

lmb_result lmb_probe_list_finish(const lmb_probe_list *list, const lmb_gathered *gathered, lmb_pool *pool,
                                 lmb_probes *probes)
{
    if (list->set >= probes->set_count) {
        return LMB_ERROR_ARGUMENT;
    }
    probes->key_light_count = lmb_scene_key_lights(lmb_tracer_scene(list->tracer), probes->key_light);
    probes_fill(list, gathered, probes);
    /* The list's set alone: others have been fitted where this one is dilated. */
    lmb_probes own = *probes;
    own.set_count = 1;
    own.radiance = &probes->radiance[list->set];
    lmb_result result = lmb_probes_dilate(&own);
    if (result == LMB_OK && list->regions) {
        probes_fill(list, gathered, probes); /* dilation takes a probe at a coarser cell's wall for one of its own */
        result = lmb_regions_fit(list->regions, gathered + list->probe_count, list->set, pool, probes);
    }
    if (result == LMB_OK && list->set == 0) {
        locals_fill(list, gathered, probes);
    }
    return result;
}

lmb_result lmb_probes_bake(lmb_probes *probes, const lmb_transport *transport, const lmb_gather_effort *effort,
                           lmb_pool *pool, const lmb_progress *progress, lmb_gather_stats *stats)
{
    lmb_probe_list list;
    lmb_result result = lmb_probe_list_create(probes, NULL, transport->tracer, &list);
    if (result != LMB_OK) {
        return result;
    }
    lmb_gathered *gathered = malloc((list.count + 1) * sizeof *gathered);
    result = LMB_ERROR_MEMORY;
    if (gathered) {
        const lmb_gather_list elements = lmb_probe_list_elements(&list);
        const lmb_gather_job job = lmb_gather_job_all(transport, &elements, effort);
        result = lmb_gather_elements(&job, pool, progress, gathered, stats);
    }
    if (result == LMB_OK) {
        result = lmb_probe_list_finish(&list, gathered, pool, probes);
    }
    free(gathered);
    lmb_probe_list_free(&list);
    return result;
}
