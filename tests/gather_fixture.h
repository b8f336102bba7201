/* Gathering at points of a test's own, each an element. */
#ifndef LMB_TESTS_GATHER_FIXTURE_H
#define LMB_TESTS_GATHER_FIXTURE_H

#include <lambent/gather_elements.h>

static inline void gather_fixture_site(const void *context, size_t element, lmb_gather_site *site)
{
    site->point[0] = ((const lmb_gather_point *)context)[element];
    site->count = 1;
}

/* `*points` must outlive the list. */
static inline lmb_gather_list gather_fixture_list(const lmb_gather_point *points, size_t count)
{
    return (lmb_gather_list){
        .name = "points", .count = count, .most_points = 1, .find_site = gather_fixture_site, .context = points};
}

/* Gathers at all of them. */
static inline lmb_result gather_fixture_gather(const lmb_transport *transport, const lmb_gather_effort *effort,
                                               const lmb_gather_list *list, lmb_pool *pool, lmb_gathered *gathered)
{
    const lmb_gather_job job = lmb_gather_job_all(transport, list, effort);
    lmb_gather_stats stats;
    return lmb_gather_elements(&job, pool, NULL, gathered, &stats);
}

#endif
