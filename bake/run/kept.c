#include "run/kept.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include "run/bake_key.h"
#include "run/kept_file.h"
#include "run/kept_sites.h"

uint64_t lmb_kept_settings(const lmb_bake_settings *settings)
{
    lmb_bake_settings own = *settings;
    own.level.environment = NULL;
    own.level.light_scale = own.level.emission_scale = 1.0;
    return lmb_bake_key(&own, 0);
}

uint64_t lmb_kept_suns(const lmb_bake_record *record)
{
    uint64_t hash = LMB_HASH_SEED;
    for (uint32_t i = 0; i < record->key_light_count; ++i) {
        hash = lmb_hash(hash, &record->key_light[i].direction, sizeof record->key_light[i].direction);
        hash = lmb_hash(hash, &record->key_light[i].irradiance, sizeof record->key_light[i].irradiance);
    }
    return hash;
}

lmb_result lmb_kept_check(const lmb_kept *kept, bool probes, bool lightmaps, bool *suns_differ, lmb_error *error)
{
    const char *const list[2] = {probes ? "probes" : NULL, lightmaps ? "lightmaps" : NULL};
    *suns_differ = false;
    for (int i = 0; i < 2; ++i) {
        lmb_kept_head head;
        const lmb_result result = list[i] ? lmb_kept_file_head(kept, list[i], &head, error) : LMB_OK;
        if (result == LMB_ERROR_IO) {
            return lmb_error_set(error, LMB_ERROR_UNSUPPORTED,
                                 "%s: holds no gathered %s: only a bake with --keep-gathered, or --only, leaves them",
                                 kept->read_from, list[i]);
        }
        if (result != LMB_OK) {
            return result;
        }
        *suns_differ = *suns_differ || (list[i] && head.suns != kept->suns);
    }
    return LMB_OK;
}

/* Whole groups of a list, which are those of this one too: but for the last, each has as many elements. */
typedef struct some_groups {
    const lmb_gather_list *all;
    size_t *group;
    size_t group_count;
    size_t count; /* of elements */
} some_groups;

static size_t element_of(const some_groups *some, size_t element)
{
    const size_t at = element / LMB_GATHER_GROUP;
    const size_t group = at < some->group_count ? at : some->group_count - 1;
    return lmb_gather_group_first(some->all->count, some->group[group]) + (element - group * LMB_GATHER_GROUP);
}

static void some_site(const void *context, size_t element, lmb_gather_site *site)
{
    const some_groups *const some = context;
    some->all->find_site(some->all->context, element_of(some, element), site);
}

/* Those in which anything is gathered anew. */
static lmb_result groups_choose(some_groups *some, const size_t *same)
{
    const size_t groups = lmb_gather_group_count(some->all->count);
    some->group = malloc((groups + 1) * sizeof *some->group);
    for (size_t group = 0; some->group && group < groups; ++group) {
        const size_t first = lmb_gather_group_first(some->all->count, group);
        const size_t end = lmb_gather_group_first(some->all->count, group + 1);
        bool is_new = false;
        for (size_t i = first; i < end; ++i) {
            is_new = is_new || same[i] == LMB_KEPT_NOT_THERE;
        }
        if (is_new) {
            some->group[some->group_count++] = group;
            some->count += end - first;
        }
    }
    return some->group ? LMB_OK : LMB_ERROR_MEMORY;
}

/* A list on its way. */
typedef struct kept_work {
    const lmb_bake *bake;
    const lmb_gather_job *job;
    lmb_kept_sites sites;
    lmb_gathered *gathered;
    lmb_gather_stats *stats; /* rays and what was moved; all else last */
    lmb_kept_stats *what;
} kept_work;

/* Gathers these, into their places among all. */
static lmb_result groups_gather(const kept_work *work, const some_groups *some, const lmb_parts *parts,
                                lmb_error *error)
{
    const lmb_gather_job *const job = work->job;
    const lmb_gather_list list = {.name = job->list->name,
                                  .count = some->count,
                                  .most_points = job->list->most_points,
                                  .find_site = some_site,
                                  .context = some};
    const lmb_gather_job own = lmb_gather_job_all(job->transport, &list, job->effort);
    lmb_gathered *const records = malloc((some->count + 1) * sizeof *records);
    lmb_gather_stats stats = {0};
    const lmb_result result =
        records ? lmb_parts_gather(parts, &own, work->bake->level->pool, work->bake->progress, records, &stats, error)
                : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    for (size_t i = 0; result == LMB_OK && i < some->count; ++i) {
        work->gathered[element_of(some, i)] = records[i];
    }
    work->stats->rays += stats.rays;
    free(records);
    return result;
}

/* What lies in the box is as if the earlier bake did not have it. */
static void inside_forget(const kept_work *work, size_t *same)
{
    for (size_t i = 0; i < work->sites.count; ++i) {
        const bool inside = work->sites.inside[i] != 0;
        work->what->missing += !inside && same[i] == LMB_KEPT_NOT_THERE;
        same[i] = inside ? LMB_KEPT_NOT_THERE : same[i];
        work->what->taken += same[i] != LMB_KEPT_NOT_THERE;
    }
}

static void elements_take(const kept_work *work, const lmb_kept_file *file, const size_t *same)
{
    for (size_t i = 0; i < work->sites.count; ++i) {
        if (same[i] != LMB_KEPT_NOT_THERE) {
            memcpy(&work->gathered[i], file->gathered + same[i] * sizeof *work->gathered, sizeof *work->gathered);
        }
    }
}

/* Of the earlier bake depends which groups are gathered: its checksum is part of the parts' key. */
static lmb_result rest_gather(const kept_work *work, const lmb_kept_file *file, size_t *same, lmb_error *error)
{
    some_groups some = {.all = work->job->list};
    lmb_parts parts = work->bake->parts ? *work->bake->parts : (lmb_parts){0};
    parts.key = lmb_hash(parts.key, &file->head.checksum, sizeof file->head.checksum);
    inside_forget(work, same);
    lmb_result result = groups_choose(&some, same);
    result = result == LMB_OK ? groups_gather(work, &some, work->bake->parts ? &parts : NULL, error)
                              : lmb_error_set(error, result, "out of memory");
    if (result == LMB_OK) {
        elements_take(work, file, same);
    }
    free(some.group);
    return result;
}

static void stats_complete(const kept_work *work)
{
    work->stats->elements = work->sites.count;
    for (size_t i = 0; i < work->sites.count; ++i) {
        work->stats->samples += work->gathered[i].samples;
    }
    lmb_gather_stats_renew(work->stats, work->gathered, work->sites.count);
}

static lmb_result part_gather(const kept_work *work, lmb_error *error)
{
    lmb_kept_file file;
    lmb_result result = lmb_kept_file_read(work->bake->kept, work->job->list->name, &file, error);
    if (result != LMB_OK) {
        return result;
    }
    size_t *const same = malloc((work->sites.count + 1) * sizeof *same);
    result = same ? lmb_kept_sites_match(&work->sites, file.site, (size_t)file.head.count, same) : LMB_ERROR_MEMORY;
    result = result == LMB_OK ? rest_gather(work, &file, same, error) : lmb_error_set(error, result, "out of memory");
    if (result == LMB_OK) {
        stats_complete(work);
    }
    free(same);
    free(file.data);
    return result;
}

static lmb_result all_gather(const lmb_bake *bake, const lmb_gather_job *job, lmb_gathered *gathered,
                             lmb_gather_stats *stats, lmb_error *error)
{
    return lmb_parts_gather(bake->parts, job, bake->level->pool, bake->progress, gathered, stats, error);
}

lmb_result lmb_kept_gather(const lmb_bake *bake, const lmb_gather_job *job, lmb_gathered *gathered,
                           lmb_gather_stats *stats, lmb_kept_stats *what, lmb_error *error)
{
    const lmb_kept *const kept = bake->kept;
    *what = (lmb_kept_stats){0};
    if (!kept) {
        return all_gather(bake, job, gathered, stats, error);
    }
    lmb_gather_stats looked = {0};
    kept_work work = {.bake = bake, .job = job, .gathered = gathered, .stats = &looked, .what = what};
    lmb_result result = lmb_kept_sites_find(job->list, bake->level, kept->box, &work.sites, &looked);
    if (result != LMB_OK) {
        return lmb_error_set(error, result, "%s: %s", job->list->name, lmb_result_text(result));
    }
    if (kept->read_from) {
        result = part_gather(&work, error);
        *stats = looked;
    } else {
        result = all_gather(bake, job, gathered, stats, error);
    }
    if (result == LMB_OK && kept->write_to) {
        result = lmb_kept_file_write(kept, job->list->name, work.sites.count, work.sites.hash, gathered, error);
    }
    lmb_kept_sites_free(&work.sites);
    return result;
}
