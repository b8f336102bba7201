/* Baking probes. */
#ifndef LAMBENT_PROBES_BAKE_H
#define LAMBENT_PROBES_BAKE_H

#include <lambent/gather_elements.h>
#include <lambent/probes.h>
#include <lambent/regions.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A probe of a local set. */
typedef struct lmb_list_local {
    uint32_t set, probe;
} lmb_list_local;

/* What light is gathered at: the probes of which `validity` says that they are worth it, and that do not hang,
 * relocated out of geometry nearby; then the points of regions; then probes of local sets. All that is pointed to must
 * outlive them. */
typedef struct lmb_probe_list {
    const lmb_probes *probes;
    const lmb_regions *regions; /* NULL: none */
    const lmb_tracer *tracer;
    size_t count; /* of all three */
    size_t probe_count;
    int32_t *probe;        /* these, in their order, in which neighbours follow each other */
    size_t local_first;    /* element */
    lmb_list_local *local; /* [count - local_first] */
    uint32_t set; /* of lights, that lmb_probe_list_finish fills: 0, unless the caller says another after creating it */
} lmb_probe_list;

/* `regions`: NULL where cells are not cut. @return LMB_ERROR_MEMORY */
lmb_result lmb_probe_list_create(const lmb_probes *probes, const lmb_regions *regions, const lmb_tracer *tracer,
                                 lmb_probe_list *list);
void lmb_probe_list_free(lmb_probe_list *list);

/* To be gathered at. */
lmb_gather_list lmb_probe_list_elements(const lmb_probe_list *list);

/* Takes noise off what was gathered, [count], at probes (lambent/denoise.h): fitting evens out that of points of
 * regions, and probes of local sets have surfaces of their own about them. @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_probe_list_denoise(const lmb_probe_list *list, lmb_pool *pool, const lmb_progress *progress,
                                  lmb_gathered *gathered);

/* Puts into the list's probes and set what was gathered, [count], with the scene's key lights, dilates the rest of the
 * set, fits what regions are to hold, and fills local sets, which hold the first set of lights alone.
 * @return LMB_ERROR_ARGUMENT (the probes have no such set; nothing has changed), _MEMORY, _INTERRUPTED */
lmb_result lmb_probe_list_finish(const lmb_probe_list *list, const lmb_gathered *gathered, lmb_pool *pool,
                                 lmb_probes *probes);

/* Gathers at the probes with that effort, and finishes set 0: probes without regions or denoising.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_probes_bake(lmb_probes *probes, const lmb_transport *transport, const lmb_gather_effort *effort,
                           lmb_pool *pool, const lmb_progress *progress, lmb_gather_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
