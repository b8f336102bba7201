/* Gathering at many elements, whatever they are: probes of a volume, texels of a lightmap, some of these for a trial.
 *
 * Which elements there are, and where each is gathered at, is a list's business; how many samples each takes, and the
 * order in which that is decided, is the same for all. What was gathered stays as it is until it is finished (dilated,
 * encoded), so that a part of a bake can be done, kept, and gone on from. */
#ifndef LAMBENT_GATHER_ELEMENTS_H
#define LAMBENT_GATHER_ELEMENTS_H

#include <lambent/gather_sh3.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How many samples elements get: `samples`, the pilot, and then up to `max_samples` as the standard error of the pilot
 * wants them for the tolerance: relative to the length of the moments, with those of key lights, or to `floor` where
 * they are shorter. */
typedef struct lmb_gather_effort {
    uint32_t samples;     /* > 0; rounded up: to a multiple of LMB_GATHER_REPLICATES, or of blocks of them where there
                             may be more */
    uint32_t max_samples; /* not above `samples`: just those */
    double tolerance;
    double floor; /* as lmb_gathered.squared_light, not squared */
} lmb_gather_effort;

/* Samples for an element of such a pilot, were it alone to decide: for forecasts. */
uint32_t lmb_gather_effort_samples(const lmb_gather_effort *effort, const lmb_gathered *pilot);

/* Where one element is gathered at: its light is the mean over these points, which share kind and normal. */
enum { LMB_GATHER_MOST_POINTS = 64 };
typedef struct lmb_gather_site {
    lmb_gather_point *point; /* room for the list's `most_points` */
    uint32_t count;          /* to be set, > 0 */
    bool moved;              /* to be set: out of a solid */
    bool brief;              /* to be set: a quarter of the samples will do */
    uint64_t rays;           /* to be added to */
} lmb_gather_site;

/* Elements in an order in which neighbours follow each other. */
typedef struct lmb_gather_list {
    const char *name; /* of the work, for progress */
    size_t count;
    uint32_t most_points; /* of an element, up to LMB_GATHER_MOST_POINTS */
    void (*find_site)(const void *context, size_t element, lmb_gather_site *site); /* from any thread */
    const void *context;
} lmb_gather_list;

/* Elements are gathered in groups of neighbours. What each takes after its pilot is decided by the pilots of the
 * *others* of its group: an element that went on for as long as its own samples looked too few would end, for good,
 * where these found no light, and so be too dark on average, without its error estimate knowing. By the others' it
 * depends on nothing that it found itself: light that one of sixty pilots finds is looked for by all, and mean and
 * error estimate stay unbiased. An element alone takes `max_samples`. */
enum { LMB_GATHER_GROUP = 64, LMB_GATHER_GROUP_MOST = 2 * LMB_GATHER_GROUP - 1 };

/* Groups that `count` elements make, and the first element of group `group`; the last takes the rest. */
size_t lmb_gather_group_count(size_t count);
size_t lmb_gather_group_first(size_t count, size_t group);

/* What is gathered: whole groups of a list, so that it is the same whatever else is gathered with it. */
typedef struct lmb_gather_job {
    const lmb_transport *transport;
    const lmb_gather_list *list;
    const lmb_gather_effort *effort;
    size_t first_group;
    size_t group_count;
} lmb_gather_job;

/* All of a list. */
lmb_gather_job lmb_gather_job_all(const lmb_transport *transport, const lmb_gather_list *list,
                                  const lmb_gather_effort *effort);

typedef struct lmb_gather_stats {
    uint64_t elements;
    uint64_t moved; /* elements that were moved out of solids */
    uint64_t samples;
    uint64_t rays;
    double squared_error; /* summed over the elements, as lmb_gathered has them */
    double squared_light;
} lmb_gather_stats;

/* Sums of errors and lengths over what was gathered, once it has changed. */
void lmb_gather_stats_renew(lmb_gather_stats *stats, const lmb_gathered *gathered, size_t count);

/* What was gathered in several groups, together. */
lmb_gather_stats lmb_gather_stats_sum(const lmb_gather_stats *stats, size_t count);

/* Gathers at the job's elements; gathered[i] is that of the i-th of them. The same for any number of threads.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_gather_elements(const lmb_gather_job *job, lmb_pool *pool, const lmb_progress *progress,
                               lmb_gathered *gathered, lmb_gather_stats *stats);

/* The same with stats for each of the job's groups, [group_count]. */
lmb_result lmb_gather_elements_by_group(const lmb_gather_job *job, lmb_pool *pool, const lmb_progress *progress,
                                        lmb_gathered *gathered, lmb_gather_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
