#include <lambent/gather_elements.h>

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "transport/gather_sh3_internal.h"

static bool effort_adapts(const lmb_gather_effort *effort)
{
    return effort->max_samples > effort->samples;
}

/* Of brief elements: a quarter of the samples, with (1/4)^(-2/3) times the error. */
#define BRIEF_PART 4
#define BRIEF_ERROR 2.52

static lmb_gather_effort effort_of(const lmb_gather_effort *effort, const lmb_gather_site *site)
{
    lmb_gather_effort own = *effort;
    if (site->brief) {
        own.samples = (effort->samples + BRIEF_PART - 1) / BRIEF_PART;
        own.max_samples = (effort->max_samples + BRIEF_PART - 1) / BRIEF_PART;
        own.tolerance *= BRIEF_ERROR;
    }
    return own;
}

static uint32_t effort_pilot(const lmb_gather_effort *effort)
{
    return lmb_replicate_share(effort->samples, effort_adapts(effort) ? LMB_GATHER_BLOCK : 1);
}

/* Samples of each replicate for a pilot's squared error relative to the light: it falls with the 4/3rd power of their
 * number, as measured over the levels of docs/testing.md; the nearest power of two. */
static uint32_t effort_share(const lmb_gather_effort *effort, double squared_error)
{
    const uint32_t pilot = effort_pilot(effort);
    const uint32_t most = lmb_replicate_share(effort->max_samples, LMB_GATHER_BLOCK);
    const double wanted = squared_error / (effort->tolerance * effort->tolerance);
    double times = 1.0;
    while (4.0 * times * times * times * times < wanted * wanted * wanted && times * pilot < most) {
        times *= 2.0;
    }
    return times * pilot < most ? (uint32_t)times * pilot : most > pilot ? most : pilot;
}

static double squared_light(const lmb_gather_effort *effort, const lmb_gathered *gathered)
{
    return fmax(gathered->squared_light, effort->floor * effort->floor);
}

static double error_share(double squared_error, double squared_light)
{
    return squared_light > 0.0 ? squared_error / squared_light : 0.0;
}

uint32_t lmb_gather_effort_samples(const lmb_gather_effort *effort, const lmb_gathered *pilot)
{
    const uint32_t share = effort_adapts(effort)
                               ? effort_share(effort, error_share(pilot->squared_error, squared_light(effort, pilot)))
                               : effort_pilot(effort);
    return LMB_GATHER_REPLICATES * share;
}

/* Of a group's pilots. */
typedef struct pilot_sums {
    double error, light; /* squared */
    double share;        /* of error in light, summed over elements */
} pilot_sums;

static void pilot_sums_add(pilot_sums *sums, const lmb_gather_effort *effort, const lmb_gathered *pilot, double sign)
{
    const double light = squared_light(effort, pilot);
    sums->error += sign * pilot->squared_error;
    sums->light += sign * light;
    sums->share += sign * error_share(pilot->squared_error, light);
}

/* Samples of each replicate of an element, by the others' pilots: the light that few of them have found makes their
 * whole error, and dark ones among bright ones have theirs. */
static uint32_t share_by_others(const lmb_gather_effort *effort, pilot_sums others, const lmb_gathered *own,
                                uint32_t count)
{
    if (count < 2) {
        return effort_share(effort, INFINITY);
    }
    pilot_sums_add(&others, effort, own, -1.0);
    const double mean_share = others.share / (count - 1);
    return effort_share(effort, fmax(mean_share, error_share(others.error, others.light)));
}

/* Of a group, on their way. */
typedef struct group_work {
    lmb_gather_site site[LMB_GATHER_GROUP_MOST];
    lmb_sh3_sums sums[LMB_GATHER_GROUP_MOST];
} group_work;

/* The elements' sites and pilots. */
static pilot_sums group_begin(const lmb_gather_job *job, size_t first, uint32_t count, group_work *work,
                              lmb_gathered *gathered)
{
    const lmb_gather_list *list = job->list;
    pilot_sums all = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < count; ++i) {
        lmb_gather_site *site = &work->site[i];
        site->rays = 0;
        site->moved = site->brief = false;
        list->find_site(list->context, first + i, site);
        const lmb_gather_effort effort = effort_of(job->effort, site);
        lmb_sh3_sums_begin(job->transport, site->point, site->count, effort_pilot(&effort), &work->sums[i]);
        lmb_sh3_sums_combine(&work->sums[i], &gathered[i]);
        pilot_sums_add(&all, job->effort, &gathered[i], 1.0);
    }
    return all;
}

static void group_gather(const lmb_gather_job *job, size_t first, uint32_t count, group_work *work,
                         lmb_gathered *gathered)
{
    const pilot_sums all = group_begin(job, first, count, work, gathered);
    for (uint32_t i = 0; i < count && effort_adapts(job->effort); ++i) {
        const lmb_gather_effort effort = effort_of(job->effort, &work->site[i]);
        const uint32_t share = share_by_others(&effort, all, &gathered[i], count);
        if (share > work->sums[i].taken) {
            lmb_sh3_sums_continue(job->transport, work->site[i].point, share, &work->sums[i]);
            lmb_sh3_sums_combine(&work->sums[i], &gathered[i]);
        }
    }
}

size_t lmb_gather_group_count(size_t total)
{
    return total < LMB_GATHER_GROUP ? total > 0 : total / LMB_GATHER_GROUP;
}

size_t lmb_gather_group_first(size_t total, size_t group)
{
    return group < lmb_gather_group_count(total) ? group * LMB_GATHER_GROUP : total;
}

lmb_gather_job lmb_gather_job_all(const lmb_transport *transport, const lmb_gather_list *list,
                                  const lmb_gather_effort *effort)
{
    return (lmb_gather_job){transport, list, effort, 0, lmb_gather_group_count(list->count)};
}

typedef struct elements_work {
    const lmb_gather_job *job;
    size_t first; /* element of the job */
    lmb_gathered *gathered;
    group_work *group;        /* [worker] */
    lmb_gather_point *points; /* [worker] of a group's elements */
    lmb_gather_stats *stats;  /* [group of the job] */
} elements_work;

static void stats_add(lmb_gather_stats *sum, const lmb_gather_stats *part)
{
    sum->elements += part->elements;
    sum->moved += part->moved;
    sum->samples += part->samples;
    sum->rays += part->rays;
    sum->squared_error += part->squared_error;
    sum->squared_light += part->squared_light;
}

static void group_task(void *context, size_t task, int worker)
{
    const elements_work *work = context;
    const lmb_gather_list *list = work->job->list;
    const size_t group = work->job->first_group + task;
    const size_t first = lmb_gather_group_first(list->count, group);
    const uint32_t count = (uint32_t)(lmb_gather_group_first(list->count, group + 1) - first);
    group_work *own = &work->group[worker];
    lmb_gathered *gathered = &work->gathered[first - work->first];
    for (uint32_t i = 0; i < count; ++i) {
        own->site[i].point = &work->points[((size_t)worker * LMB_GATHER_GROUP_MOST + i) * list->most_points];
    }
    group_gather(work->job, first, count, own, gathered);
    for (uint32_t i = 0; i < count; ++i) {
        const lmb_gather_stats one = {.elements = 1,
                                      .moved = own->site[i].moved,
                                      .samples = gathered[i].samples,
                                      .rays = own->site[i].rays + gathered[i].rays,
                                      .squared_error = gathered[i].squared_error,
                                      .squared_light = gathered[i].squared_light};
        stats_add(&work->stats[task], &one);
    }
}

lmb_gather_stats lmb_gather_stats_sum(const lmb_gather_stats *stats, size_t count)
{
    lmb_gather_stats sum = {0};
    for (size_t i = 0; i < count; ++i) {
        stats_add(&sum, &stats[i]);
    }
    return sum;
}

lmb_result lmb_gather_elements_by_group(const lmb_gather_job *job, lmb_pool *pool, const lmb_progress *progress,
                                        lmb_gathered *gathered, lmb_gather_stats *stats)
{
    const size_t workers = (size_t)lmb_pool_threads(pool);
    elements_work work = {
        .job = job,
        .first = lmb_gather_group_first(job->list->count, job->first_group),
        .gathered = gathered,
        .group = malloc(workers * sizeof *work.group),
        .points = malloc(workers * LMB_GATHER_GROUP_MOST * job->list->most_points * sizeof *work.points),
        .stats = stats,
    };
    assert(job->list->most_points > 0 && job->list->most_points <= LMB_GATHER_MOST_POINTS);
    lmb_result result = LMB_ERROR_MEMORY;
    if (work.group && work.points) {
        memset(stats, 0, job->group_count * sizeof *stats);
        result = lmb_pool_run(pool, job->group_count, group_task, &work, job->list->name, progress);
    }
    free(work.group);
    free(work.points);
    return result;
}

lmb_result lmb_gather_elements(const lmb_gather_job *job, lmb_pool *pool, const lmb_progress *progress,
                               lmb_gathered *gathered, lmb_gather_stats *stats)
{
    lmb_gather_stats *const group = malloc((job->group_count + 1) * sizeof *group);
    const lmb_result result =
        group ? lmb_gather_elements_by_group(job, pool, progress, gathered, group) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        *stats = lmb_gather_stats_sum(group, job->group_count);
    }
    free(group);
    return result;
}

void lmb_gather_stats_renew(lmb_gather_stats *stats, const lmb_gathered *gathered, size_t count)
{
    stats->squared_error = stats->squared_light = 0.0;
    for (size_t i = 0; i < count; ++i) {
        stats->squared_error += gathered[i].squared_error;
        stats->squared_light += gathered[i].squared_light;
    }
}
