#include <lambent/probes_bake.h>

#include <stdlib.h>
#include <string.h>

#include <lambent/denoise.h>
#include <lambent/key_lights.h>
#include <lambent/placement.h>

/* A probe speaks for the space within half its footprint. */
#define LIGHT_DISTANCE_FOOTPRINTS 0.5f

lmb_result lmb_probe_list_create(const lmb_probes *probes, const lmb_tracer *tracer, lmb_probe_list *list)
{
    *list = (lmb_probe_list){
        .probes = probes, .tracer = tracer, .probe = malloc(((size_t)probes->count + 1) * sizeof *list->probe)};
    if (!list->probe) {
        return LMB_ERROR_MEMORY;
    }
    for (int32_t i = 0; i < probes->count; ++i) {
        lmb_probe_parents parents;
        if (probes->validity[i] >= LMB_PROBES_MIN_VALIDITY && !lmb_probes_hangs(probes, i, &parents)) {
            list->probe[list->count++] = i;
        }
    }
    return LMB_OK;
}

void lmb_probe_list_free(lmb_probe_list *list)
{
    free(list->probe);
    list->probe = NULL;
}

static void probe_site(const void *context, size_t element, lmb_gather_site *site)
{
    const lmb_probe_list *list = context;
    const int32_t probe = list->probe[element];
    const lmb_vec3 position = lmb_probes_position(list->probes, probe);
    const float footprint = lmb_probes_footprint(list->probes, probe);
    site->point[0] =
        (lmb_gather_point){.position = lmb_placement_relocate(list->tracer, position, footprint, &site->rays),
                           .min_light_distance = LIGHT_DISTANCE_FOOTPRINTS * footprint};
    site->count = 1;
}

lmb_gather_list lmb_probe_list_elements(const lmb_probe_list *list)
{
    return (lmb_gather_list){
        .name = "probes", .count = list->count, .most_points = 1, .find_site = probe_site, .context = list};
}

lmb_result lmb_probe_list_denoise(const lmb_probe_list *list, lmb_pool *pool, const lmb_progress *progress,
                                  lmb_gathered *gathered)
{
    lmb_denoise_point *const points = malloc((list->count + 1) * sizeof *points);
    if (!points) {
        return LMB_ERROR_MEMORY;
    }
    for (size_t i = 0; i < list->count; ++i) {
        lmb_gather_point at;
        lmb_gather_site site = {.point = &at};
        probe_site(list, i, &site);
        points[i] =
            (lmb_denoise_point){.position = at.position, .spacing = lmb_probes_footprint(list->probes, list->probe[i])};
    }
    const lmb_result result = lmb_denoise_in_space(points, list->count, list->tracer, pool, progress, gathered);
    free(points);
    return result;
}

lmb_result lmb_probe_list_finish(const lmb_probe_list *list, const lmb_gathered *gathered, lmb_probes *probes)
{
    if (list->set >= probes->set_count) {
        return LMB_ERROR_ARGUMENT;
    }
    probes->key_light_count = lmb_scene_key_lights(lmb_tracer_scene(list->tracer), probes->key_light);
    for (size_t i = 0; i < list->count; ++i) {
        probes->radiance[list->set][list->probe[i]] = gathered[i].moments;
        memcpy(probes->key_visibility[list->probe[i]], gathered[i].key_visibility, sizeof gathered[i].key_visibility);
    }
    return lmb_probes_dilate(probes);
}

lmb_result lmb_probes_bake(lmb_probes *probes, const lmb_transport *transport, const lmb_gather_effort *effort,
                           lmb_pool *pool, const lmb_progress *progress, lmb_gather_stats *stats)
{
    lmb_probe_list list;
    lmb_result result = lmb_probe_list_create(probes, transport->tracer, &list);
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
        result = lmb_probe_list_finish(&list, gathered, probes);
    }
    free(gathered);
    lmb_probe_list_free(&list);
    return result;
}
