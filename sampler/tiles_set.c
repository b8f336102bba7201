/* Tiles that come and go while others are sampled.
 *
 * When a cleared volume is sampled no more is told by time, a count. Threads enter at the time it is then, and are
 * counted by whether that is even or odd. Time goes on from t to t + 1 when none is left that entered at t - 1. A
 * volume that was cleared at t is found by threads that entered until then; at t + 2 they have left. */
#include "tiles_internal.h"

#include <assert.h>
#include <string.h>

/* Whether a volume is the tile, as far as sampling depends on it. */
static bool is_tile(const lmb_tiles_header *header, const lmb_tiles_entry *entry, const lmb_volume_header *volume)
{
    int32_t min[3], size[3];
    lmb_tiles_box(header, entry->at, min, size);
    return volume->spacing == header->spacing && volume->scale == header->scale &&
           volume->level_count == header->level_count && volume->probe_form == header->probe_form &&
           volume->key_light_count == header->key_light_count &&
           memcmp(volume->key_light, header->key_light, sizeof header->key_light) == 0 &&
           memcmp(volume->min, min, sizeof min) == 0 && memcmp(volume->size, size, sizeof size) == 0;
}

lmb_result lmb_volume_tiles_set(lmb_volume_tiles *tiles, uint32_t tile, lmb_volume *volume, lmb_volume **former)
{
    const bool arguments_are_valid = tiles && volume && former && tile < tiles->header->tile_count;
    assert(arguments_are_valid);
    if (!arguments_are_valid) {
        return LMB_ERROR_ARGUMENT;
    }
    const lmb_tiles_entry *const entry = &tiles->entry[tile];
    if (!is_tile(tiles->header, entry, volume->header)) {
        return LMB_ERROR_FORMAT;
    }
    if (volume->header->checksum != entry->checksum || volume->header->file_bytes != entry->file_bytes) {
        return LMB_ERROR_CHECKSUM;
    }
    lmb_volume_derive(volume, tiles->origin_cell, tiles->slack);
    *former = lmb_atomic_exchange(&tiles->volume[tile], volume);
    return LMB_OK;
}

lmb_volume *lmb_volume_tiles_clear(lmb_volume_tiles *tiles, uint32_t tile)
{
    assert(tiles && tile < tiles->header->tile_count);
    return lmb_atomic_exchange(&tiles->volume[tile], NULL);
}

bool lmb_volume_tiles_is_set(const lmb_volume_tiles *tiles, uint32_t tile)
{
    assert(tiles && tile < tiles->header->tile_count);
    return lmb_atomic_load(&tiles->volume[tile]) != NULL;
}

uint32_t lmb_volume_tiles_enter(lmb_volume_tiles *tiles)
{
    assert(tiles);
    for (;;) {
        const uint32_t time = lmb_atomic_read(&tiles->time);
        lmb_atomic_add(&tiles->readers[time % 2].count, 1);
        if (lmb_atomic_read(&tiles->time) == time) {
            return time;
        }
        lmb_atomic_add(&tiles->readers[time % 2].count, UINT32_MAX); /* it went on meanwhile: once more */
    }
}

void lmb_volume_tiles_leave(lmb_volume_tiles *tiles, uint32_t entered)
{
    assert(tiles);
    lmb_atomic_add(&tiles->readers[entered % 2].count, UINT32_MAX);
}

/* Writes the time, though it stays, so that who lets it go on has seen what was cleared before. */
uint32_t lmb_volume_tiles_mark(lmb_volume_tiles *tiles)
{
    assert(tiles);
    return lmb_atomic_add(&tiles->time, 0);
}

bool lmb_volume_tiles_is_quiet(lmb_volume_tiles *tiles, uint32_t mark)
{
    assert(tiles);
    for (;;) {
        const uint32_t time = lmb_atomic_read(&tiles->time);
        if (time - mark >= 2) {
            return true;
        }
        if (lmb_atomic_read(&tiles->readers[(time + 1) % 2].count) != 0) {
            return false;
        }
        lmb_atomic_replace(&tiles->time, time, time + 1);
    }
}
