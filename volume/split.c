#include "split_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int32_t lmb_split_cells(const lmb_volume_info *info, double metres)
{
    enum { MOST = 1 << 30 };
    assert(info && info->level_count >= 1 && info->level_count <= LMB_VOLUME_LEVELS_MOST);
    const int32_t coarsest = LMB_BRICK_CELLS << (info->level_count - 1);
    const int32_t most_bricks = MOST / coarsest;
    const double bricks = round(metres / ((double)info->spacing * coarsest));
    return bricks >= 1.0 ? (bricks < most_bricks ? (int32_t)bricks * coarsest : MOST) : coarsest;
}

/* The place with a number in the grid. */
static void place_at(const lmb_tiles_layout *grid, uint64_t place, int32_t at[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        at[axis] = grid->grid_first[axis] + (int32_t)(place % grid->grid_size[axis]);
        place /= grid->grid_size[axis];
    }
}

/* Numbers the tiles that have bricks, in the order of their places. @return LMB_ERROR_MEMORY */
static lmb_result tiles_number(lmb_splitting *splitting, uint32_t **number)
{
    uint32_t *const found = calloc((size_t)splitting->grid.places, sizeof *found);
    if (!found) {
        return LMB_ERROR_MEMORY;
    }
    splitting->tiles.tile_count = 0;
    for (uint64_t place = 0; place < splitting->grid.places; ++place) {
        int32_t at[3];
        place_at(&splitting->grid, place, at);
        lmb_split_bricks(splitting, at);
        if (splitting->brick_count > 0) {
            found[place] = ++splitting->tiles.tile_count;
        }
    }
    *number = found;
    return splitting->tiles.tile_count > 0 ? LMB_OK : LMB_ERROR_FORMAT; /* no block names a brick */
}

/* An index of tiles whose files are not known yet. */
static lmb_result index_begin(lmb_splitting *splitting, unsigned char **data, size_t *size)
{
    uint32_t *number = NULL;
    lmb_result result = tiles_number(splitting, &number);
    unsigned char *image = NULL;
    if (result == LMB_OK) {
        lmb_tiles_layout_find(&splitting->tiles, &splitting->grid);
        *size = (size_t)splitting->grid.end;
        image = aligned_alloc(LMB_VOLUME_ALIGNMENT, *size);
        result = image ? LMB_OK : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        memset(image, 0, *size);
        memcpy(image + splitting->grid.grid, number, (size_t)splitting->grid.places * sizeof *number);
        lmb_tiles_entry *const tile = (lmb_tiles_entry *)(void *)(image + splitting->grid.tiles);
        for (uint64_t place = 0; place < splitting->grid.places; ++place) {
            if (number[place] > 0) {
                place_at(&splitting->grid, place, tile[number[place] - 1].at);
            }
        }
        *data = image;
    }
    free(number);
    return result;
}

static void index_finish(const lmb_splitting *splitting, unsigned char *data, size_t size)
{
    lmb_tiles_header header = splitting->tiles;
    memcpy(header.magic, LMB_TILES_MAGIC, sizeof header.magic);
    header.version = LMB_TILES_VERSION;
    header.header_bytes = LMB_TILES_HEADER_BYTES;
    header.file_bytes = size;
    memcpy(data, &header, sizeof header);
    header.checksum = lmb_volume_hash(data + LMB_VOLUME_CHECKSUM_START, size - LMB_VOLUME_CHECKSUM_START);
    memcpy(data, &header, sizeof header);
}

static lmb_result tiles_write(lmb_splitting *splitting, const lmb_split_sink *sink, unsigned char *index)
{
    lmb_tiles_entry *const tile = (lmb_tiles_entry *)(void *)(index + splitting->grid.tiles);
    lmb_result result = lmb_split_locals_place(splitting, tile);
    for (uint32_t i = 0; i < splitting->tiles.tile_count && result == LMB_OK; ++i) {
        unsigned char *data = NULL;
        size_t size = 0;
        lmb_split_bricks(splitting, tile[i].at);
        result = lmb_split_tile(splitting, &tile[i], i, &data, &size);
        if (result == LMB_OK) {
            tile[i].file_bytes = size;
            tile[i].checksum = ((const lmb_volume_header *)(const void *)data)->checksum;
            result = sink->write(sink->context, tile[i].at, data, size);
        }
        free(data);
    }
    return result;
}

/* @return LMB_ERROR_ARGUMENT (tile_cells), _VERSION, _MEMORY */
static lmb_result splitting_begin(lmb_splitting *splitting, const unsigned char *volume, const int32_t tile_cells[3])
{
    const lmb_volume_header *const header = (const lmb_volume_header *)(const void *)volume;
    if (header->version < 4) {
        return LMB_ERROR_VERSION;
    }
    splitting->source = volume;
    splitting->header = header;
    splitting->units = header->probe_bytes / LMB_PROBE_UNIT;
    splitting->tiles = (lmb_tiles_header){.spacing = header->spacing,
                                          .scale = header->scale,
                                          .level_count = header->level_count,
                                          .key_light_count = header->key_light_count,
                                          .probe_form = header->probe_form};
    memcpy(splitting->tiles.key_light, header->key_light, sizeof header->key_light);
    for (int axis = 0; axis < 3; ++axis) {
        splitting->tiles.min[axis] = header->min[axis];
        splitting->tiles.size[axis] = header->size[axis];
        splitting->tiles.tile_cells[axis] = tile_cells[axis];
        if (tile_cells[axis] < 1 || tile_cells[axis] % (LMB_BRICK_CELLS << (header->level_count - 1)) != 0) {
            return LMB_ERROR_ARGUMENT;
        }
    }
    if (!lmb_volume_layout_find(header, &splitting->layout) ||
        !lmb_tiles_layout_find(&splitting->tiles, &splitting->grid)) {
        return LMB_ERROR_ARGUMENT;
    }
    splitting->directory = (const uint32_t *)(const void *)(volume + splitting->layout.directory);
    splitting->brick = (const lmb_volume_brick *)(const void *)(volume + splitting->layout.bricks);
    splitting->brick_list = malloc(header->brick_count * sizeof *splitting->brick_list);
    splitting->brick_taken = calloc(header->brick_count, sizeof *splitting->brick_taken);
    splitting->probe_list = malloc(header->stored_count * sizeof *splitting->probe_list);
    splitting->probe_number = malloc(header->stored_count * sizeof *splitting->probe_number);
    if (!splitting->brick_list || !splitting->brick_taken || !splitting->probe_list || !splitting->probe_number) {
        return LMB_ERROR_MEMORY;
    }
    memset(splitting->probe_number, 0xff, header->stored_count * sizeof *splitting->probe_number);
    return LMB_OK;
}

lmb_result lmb_split(const lmb_volume *volume, const int32_t tile_cells[3], const lmb_split_sink *sink,
                     unsigned char **index, size_t *index_size)
{
    assert(volume && tile_cells && sink && index && index_size);
    lmb_splitting splitting = {.source = NULL};
    unsigned char *data = NULL;
    size_t data_size = 0;
    const void *const file = lmb_volume_get_gpu(volume, (lmb_vec3d){0.0, 0.0, 0.0}).words;
    lmb_result result = splitting_begin(&splitting, file, tile_cells);
    if (result == LMB_OK) {
        result = index_begin(&splitting, &data, &data_size);
    }
    if (result == LMB_OK) {
        result = tiles_write(&splitting, sink, data);
    }
    if (result == LMB_OK) {
        index_finish(&splitting, data, data_size);
        *index = data;
        *index_size = data_size;
    } else {
        free(data);
    }
    free(splitting.local_tile);
    free(splitting.brick_list);
    free(splitting.brick_taken);
    free(splitting.probe_list);
    free(splitting.probe_number);
    return result;
}
