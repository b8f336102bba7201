#include "run/kept_sites.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

enum { ELEMENTS_PER_TASK = 256 };

typedef struct sites_work {
    const lmb_gather_list *list;
    const lmb_vec3d *box;
    lmb_vec3d origin;
    lmb_kept_sites *sites;
    lmb_gather_point *point; /* [worker][most_points] */
    uint64_t *rays, *moved;  /* [worker] */
} sites_work;

static uint64_t point_hash(uint64_t hash, const lmb_gather_point *point)
{
    const float value[5] = {point->position.x, point->position.y, point->position.z, point->min_light_distance,
                            point->hemisphere ? 1.0f : 0.0f};
    hash = lmb_hash(hash, value, sizeof value);
    return point->hemisphere ? lmb_hash(hash, &point->normal, sizeof point->normal) : hash;
}

static bool point_is_inside(const sites_work *work, const lmb_gather_point *point)
{
    const lmb_vec3d *const low = &work->box[0], *const high = &work->box[1], *const from = &work->origin;
    const lmb_vec3d at = {from->x + (double)point->position.x, from->y + (double)point->position.y,
                          from->z + (double)point->position.z};
    return at.x >= low->x && at.x <= high->x && at.y >= low->y && at.y <= high->y && at.z >= low->z && at.z <= high->z;
}

static void site_look(const sites_work *work, size_t element, int worker)
{
    lmb_gather_site site = {.point = &work->point[(size_t)worker * work->list->most_points]};
    work->list->find_site(work->list->context, element, &site);
    uint64_t hash = lmb_hash(LMB_HASH_SEED, &work->origin, sizeof work->origin);
    hash = lmb_hash(hash, &(uint8_t){site.brief}, 1);
    bool inside = false;
    for (uint32_t i = 0; i < site.count; ++i) {
        hash = point_hash(hash, &site.point[i]);
        inside = inside || point_is_inside(work, &site.point[i]);
    }
    work->sites->hash[element] = hash;
    work->sites->inside[element] = inside;
    work->rays[worker] += site.rays;
    work->moved[worker] += site.moved;
}

static void sites_task(void *context, size_t task, int worker)
{
    const sites_work *const work = context;
    const size_t first = task * ELEMENTS_PER_TASK, left = work->list->count - first;
    for (size_t i = 0; i < (left < ELEMENTS_PER_TASK ? left : ELEMENTS_PER_TASK); ++i) {
        site_look(work, first + i, worker);
    }
}

static lmb_result sites_look(sites_work *work, lmb_pool *pool, lmb_gather_stats *stats)
{
    const size_t count = work->list->count, workers = (size_t)lmb_pool_threads(pool);
    const size_t tasks = (count + ELEMENTS_PER_TASK - 1) / ELEMENTS_PER_TASK;
    work->point = malloc((workers * work->list->most_points + 1) * sizeof *work->point);
    work->rays = calloc(workers, sizeof *work->rays);
    work->moved = calloc(workers, sizeof *work->moved);
    const bool good = work->point && work->rays && work->moved && work->sites->hash && work->sites->inside;
    const lmb_result result =
        good ? lmb_pool_run(pool, tasks, sites_task, work, work->list->name, NULL) : LMB_ERROR_MEMORY;
    for (size_t i = 0; good && i < workers; ++i) {
        stats->rays += work->rays[i];
        stats->moved += work->moved[i];
    }
    free(work->point);
    free(work->rays);
    free(work->moved);
    return result;
}

lmb_result lmb_kept_sites_find(const lmb_gather_list *list, const lmb_level *level, const lmb_vec3d box[2],
                               lmb_kept_sites *sites, lmb_gather_stats *stats)
{
    *sites = (lmb_kept_sites){.count = list->count,
                              .hash = malloc((list->count + 1) * sizeof *sites->hash),
                              .inside = malloc(list->count + 1)};
    sites_work work = {.list = list, .box = box, .origin = level->scene->origin, .sites = sites};
    const lmb_result result = sites_look(&work, level->pool, stats);
    if (result != LMB_OK) {
        lmb_kept_sites_free(sites);
    }
    return result;
}

void lmb_kept_sites_free(lmb_kept_sites *sites)
{
    free(sites->hash);
    free(sites->inside);
    *sites = (lmb_kept_sites){0};
}

typedef struct site_entry {
    uint64_t hash;
    size_t element;
} site_entry;

static int entry_compare(const void *a, const void *b)
{
    const site_entry *const p = a, *const q = b;
    return p->hash != q->hash ? (p->hash > q->hash ? 1 : -1) : (p->element > q->element) - (p->element < q->element);
}

/* NULL: out of memory. */
static site_entry *entries_sort(const void *hash, size_t count)
{
    site_entry *const entry = malloc((count + 1) * sizeof *entry);
    for (size_t i = 0; entry && i < count; ++i) {
        memcpy(&entry[i].hash, (const unsigned char *)hash + i * sizeof entry->hash, sizeof entry->hash);
        entry[i].element = i;
    }
    if (entry) {
        qsort(entry, count, sizeof *entry, entry_compare);
    }
    return entry;
}

lmb_result lmb_kept_sites_match(const lmb_kept_sites *sites, const void *other, size_t other_count, size_t *same)
{
    site_entry *const now = entries_sort(sites->hash, sites->count), *const then = entries_sort(other, other_count);
    const lmb_result result = now && then ? LMB_OK : LMB_ERROR_MEMORY;
    size_t at = 0;
    for (size_t i = 0; result == LMB_OK && i < sites->count; ++i) {
        while (at < other_count && then[at].hash < now[i].hash) {
            ++at;
        }
        const bool found = at < other_count && then[at].hash == now[i].hash;
        same[now[i].element] = found ? then[at++].element : LMB_KEPT_NOT_THERE;
    }
    free(now);
    free(then);
    return result;
}
