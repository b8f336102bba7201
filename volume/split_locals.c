/* Local sets of a volume that is split: each goes into one tile, as it is. */
#include "split_internal.h"

#include <lambent/local_set_format.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const lmb_volume_locals *locals_of(const lmb_splitting *splitting)
{
    return (const lmb_volume_locals *)(const void *)(splitting->source + splitting->layout.locals);
}

static uint32_t locals_count(const lmb_splitting *splitting)
{
    return splitting->header->local_bytes > 0 ? locals_of(splitting)->count : 0;
}

static const lmb_volume_local *locals_list(const lmb_splitting *splitting)
{
    return (const lmb_volume_local *)(const void *)(locals_of(splitting) + 1);
}

static const char *locals_names(const lmb_splitting *splitting)
{
    return (const char *)(locals_list(splitting) + locals_count(splitting));
}

static uint32_t probes_of(const lmb_volume_local *local)
{
    return local->size[0] * local->size[1] * local->size[2];
}

/* On the finest lattice, as positions are told by the sampler. */
static void middle_of(const lmb_splitting *splitting, const lmb_volume_local *local, double middle[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        double at = local->origin[axis];
        for (int step = 0; step < 3; ++step) {
            at += 0.5 * (local->size[step] - 1.0) * (double)local->step[step][axis];
        }
        middle[axis] = at * (1.0 / (double)splitting->tiles.spacing);
    }
}

/* Squared cells from a place to the box of a tile. */
static double tile_distance(const lmb_splitting *splitting, const double place[3], const lmb_tiles_entry *tile)
{
    int32_t min[3], size[3];
    double distance = 0.0;
    lmb_tiles_box(&splitting->tiles, tile->at, min, size);
    for (int axis = 0; axis < 3; ++axis) {
        const double before = min[axis] - place[axis], behind = -before - (size[axis] - 1.0);
        const double beyond = fmax(fmax(before, behind), 0.0);
        distance += beyond * beyond;
    }
    return distance;
}

lmb_result lmb_split_locals_place(lmb_splitting *splitting, const lmb_tiles_entry *tile)
{
    const uint32_t count = locals_count(splitting);
    if (count == 0) {
        return LMB_OK;
    }
    splitting->local_tile = malloc(count * sizeof *splitting->local_tile);
    if (!splitting->local_tile) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < count; ++i) {
        double middle[3], nearest = INFINITY;
        middle_of(splitting, &locals_list(splitting)[i], middle);
        splitting->local_tile[i] = 0;
        for (uint32_t k = 0; k < splitting->tiles.tile_count; ++k) {
            const double distance = tile_distance(splitting, middle, &tile[k]);
            if (distance <= nearest) { /* at a border the cell is the last one's */
                nearest = distance;
                splitting->local_tile[i] = k;
            }
        }
    }
    return LMB_OK;
}

/* What a tile has of them. */
typedef struct locals_sum {
    uint32_t count;
    uint32_t name_bytes; /* filled up to a multiple of 4 */
    uint64_t probes;
} locals_sum;

static locals_sum locals_add(const lmb_splitting *splitting, uint32_t number)
{
    locals_sum sum = {0, 0, 0};
    for (uint32_t i = 0; i < locals_count(splitting); ++i) {
        const lmb_volume_local *const local = &locals_list(splitting)[i];
        if (splitting->local_tile[i] == number) {
            sum.count += 1;
            sum.name_bytes += (uint32_t)strlen(locals_names(splitting) + local->name) + 1;
            sum.probes += probes_of(local);
        }
    }
    sum.name_bytes = (sum.name_bytes + 3) / 4 * 4;
    return sum;
}

uint64_t lmb_split_locals_bytes(const lmb_splitting *splitting, uint32_t number)
{
    const locals_sum sum = locals_add(splitting, number);
    return sum.count > 0 ? sizeof(lmb_volume_locals) + sum.count * sizeof(lmb_volume_local) + sum.name_bytes +
                               sum.probes * splitting->header->probe_bytes
                         : 0;
}

void lmb_split_locals_write(const lmb_splitting *splitting, uint32_t number, unsigned char *to)
{
    const locals_sum sum = locals_add(splitting, number);
    if (sum.count == 0) {
        return;
    }
    const size_t probe_bytes = splitting->header->probe_bytes;
    const unsigned char *const from = (const unsigned char *)locals_names(splitting) + locals_of(splitting)->name_bytes;
    const lmb_volume_locals head = {sum.count, sum.name_bytes};
    unsigned char *entry = to + sizeof head;
    unsigned char *const names = entry + sum.count * sizeof(lmb_volume_local);
    unsigned char *const probes = names + sum.name_bytes;
    uint32_t name = 0, probe = 0;
    memcpy(to, &head, sizeof head);
    for (uint32_t i = 0; i < locals_count(splitting); ++i) {
        if (splitting->local_tile[i] != number) {
            continue;
        }
        lmb_volume_local local = locals_list(splitting)[i];
        const size_t length = strlen(locals_names(splitting) + local.name) + 1;
        memcpy(names + name, locals_names(splitting) + local.name, length);
        memcpy(probes + probe * probe_bytes, from + local.probe_first * probe_bytes, probes_of(&local) * probe_bytes);
        local.name = name;
        local.probe_first = probe;
        memcpy(entry, &local, sizeof local);
        entry += sizeof local;
        name += (uint32_t)length;
        probe += probes_of(&local);
    }
}
