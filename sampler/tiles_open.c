#include "tiles_internal.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(lmb_tiles_header) == LMB_TILES_HEADER_BYTES && sizeof(lmb_tiles_entry) == 32,
               "neither has padding");

/* ---------------------------------------------------------------------------------------------- verifying */

static bool header_is_sane(const lmb_tiles_header *header)
{
    if (header->level_count < 1 || header->level_count > LMB_VOLUME_LEVELS_MOST ||
        header->probe_form >= LMB_VOLUME_FORMS || header->tile_count < 1 || header->reserved != 0 ||
        !lmb_volume_scales_are_sane(header->spacing, header->scale) ||
        !lmb_volume_key_lights_are_sane(header->key_light, header->key_light_count)) {
        return false;
    }
    const int32_t coarsest = LMB_BRICK_CELLS << (header->level_count - 1);
    for (int axis = 0; axis < 3; ++axis) {
        if (header->tile_cells[axis] < 1 || header->tile_cells[axis] % coarsest != 0) {
            return false;
        }
    }
    return true;
}

/* Each tile has one place of the grid, and each place at most one tile. */
static bool tiles_are_sane(const lmb_tiles_header *header, const lmb_tiles_layout *layout, const uint32_t *grid,
                           const lmb_tiles_entry *entry)
{
    uint64_t named = 0;
    for (uint64_t i = 0; i < layout->places; ++i) {
        named += grid[i] != 0;
    }
    bool sane = named == header->tile_count;
    for (uint32_t i = 0; sane && i < header->tile_count; ++i) {
        uint64_t place = 0;
        for (int axis = 2; axis >= 0; --axis) {
            const int64_t at = (int64_t)entry[i].at[axis] - layout->grid_first[axis];
            sane = sane && at >= 0 && at < layout->grid_size[axis];
            place = place * layout->grid_size[axis] + (uint64_t)at;
        }
        sane = sane && grid[place] == i + 1 && entry[i].reserved == 0;
    }
    return sane;
}

static lmb_result index_verify(const unsigned char *data, size_t size, lmb_tiles_layout *layout)
{
    static const lmb_volume_file_kind kind = {LMB_TILES_MAGIC, LMB_TILES_VERSION, LMB_TILES_VERSION,
                                              sizeof(lmb_tiles_header)};
    const lmb_result result = lmb_volume_envelope_check(data, size, &kind);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_tiles_header *const header = (const lmb_tiles_header *)data;
    if (!header_is_sane(header) || !lmb_tiles_layout_find(header, layout) || layout->end != size ||
        !lmb_volume_box_is_sane(header->min, header->size, header->level_count, header->spacing)) {
        return LMB_ERROR_FORMAT;
    }
    const bool sane = tiles_are_sane(header, layout, (const uint32_t *)(data + layout->grid),
                                     (const lmb_tiles_entry *)(data + layout->tiles));
    return sane ? LMB_OK : LMB_ERROR_FORMAT;
}

/* ------------------------------------------------------------------------------------------------ opening */

static size_t memory_bytes(uint32_t tile_count)
{
    return sizeof(lmb_volume_tiles) + tile_count * sizeof(lmb_atomic_pointer);
}

static void constants_derive(lmb_volume_tiles *tiles, const lmb_tiles_layout *layout)
{
    const lmb_tiles_header *const header = tiles->header;
    const lmb_volume_header kind = {.probe_form = header->probe_form, .key_light_count = header->key_light_count};
    lmb_volume_origin(header->min, header->level_count, tiles->origin_cell);
    for (int axis = 0; axis < 3; ++axis) {
        const int32_t origin = tiles->origin_cell[axis], first = header->min[axis] - origin;
        const double cells = header->tile_cells[axis];
        tiles->origin[axis] = origin;
        tiles->first[axis] = first;
        tiles->last[axis] = first + (header->size[axis] - 1.0);
        tiles->last_cell[axis] = header->size[axis] > 1 ? first + (header->size[axis] - 2) : first;
        tiles->to_grid[axis] = origin - layout->grid_first[axis] * cells + 0.5;
        tiles->inverse_tile[axis] = 1.0 / cells;
    }
    tiles->grid_step[0] = layout->grid_size[0];
    tiles->grid_step[1] = (size_t)layout->grid_size[0] * layout->grid_size[1];
    tiles->inverse_spacing = 1.0 / (double)header->spacing;
    tiles->slack = lmb_volume_slack(header->min, header->size);
    tiles->calls = lmb_volume_kernel_calls(lmb_volume_kernel_choose(), &kind);
}

lmb_result lmb_volume_tiles_memory(const void *index, size_t size, size_t *bytes)
{
    const bool arguments_are_valid = index && bytes && (uintptr_t)index % 16 == 0;
    assert(arguments_are_valid);
    if (!arguments_are_valid) {
        return LMB_ERROR_ARGUMENT;
    }
    lmb_tiles_layout layout;
    const lmb_result result = index_verify(index, size, &layout);
    if (result == LMB_OK) {
        *bytes = memory_bytes(((const lmb_tiles_header *)index)->tile_count);
    }
    return result;
}

lmb_result lmb_volume_tiles_open_memory_in(void *memory, size_t bytes, const void *index, size_t size,
                                           lmb_volume_tiles **tiles)
{
    const bool arguments_are_valid =
        memory && index && tiles && (uintptr_t)memory % 16 == 0 && (uintptr_t)index % 16 == 0;
    assert(arguments_are_valid);
    if (!arguments_are_valid) {
        return LMB_ERROR_ARGUMENT;
    }
    lmb_tiles_layout layout;
    const lmb_result result = index_verify(index, size, &layout);
    if (result != LMB_OK) {
        return result;
    }
    const unsigned char *const data = index;
    const lmb_tiles_header *const header = index;
    if (bytes < memory_bytes(header->tile_count)) {
        return LMB_ERROR_ARGUMENT;
    }
    lmb_volume_tiles *const opened = memory;
    memset(opened, 0, memory_bytes(header->tile_count)); /* no tile is set, nobody is in */
    opened->header = header;
    opened->grid = (const uint32_t *)(const void *)(data + layout.grid);
    opened->entry = (const lmb_tiles_entry *)(const void *)(data + layout.tiles);
    constants_derive(opened, &layout);
    *tiles = opened;
    return LMB_OK;
}

lmb_result lmb_volume_tiles_open_memory(const void *index, size_t size, lmb_volume_tiles **tiles)
{
    size_t bytes = 0;
    lmb_result result = tiles ? lmb_volume_tiles_memory(index, size, &bytes) : LMB_ERROR_ARGUMENT;
    if (result != LMB_OK) {
        return result;
    }
    void *const memory = malloc(bytes);
    if (!memory) {
        return LMB_ERROR_MEMORY;
    }
    result = lmb_volume_tiles_open_memory_in(memory, bytes, index, size, tiles);
    if (result != LMB_OK) {
        free(memory);
        return result;
    }
    (*tiles)->is_allocated = true;
    return LMB_OK;
}

void lmb_volume_tiles_close(lmb_volume_tiles *tiles)
{
    if (tiles && tiles->is_allocated) {
        free(tiles);
    }
}

/* ----------------------------------------------------------------------------------------- what it says */

static lmb_vec3d point_position(const lmb_tiles_header *header, const int64_t point[3])
{
    const double spacing = (double)header->spacing;
    return (lmb_vec3d){(double)point[0] * spacing, (double)point[1] * spacing, (double)point[2] * spacing};
}

static void box_bounds(const lmb_tiles_header *header, const int32_t min[3], const int32_t size[3], lmb_vec3d bounds[2])
{
    int64_t first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
        first[axis] = min[axis];
        last[axis] = first[axis] + size[axis] - 1;
    }
    bounds[0] = point_position(header, first);
    bounds[1] = point_position(header, last);
}

lmb_volume_tiles_info lmb_volume_tiles_get_info(const lmb_volume_tiles *tiles)
{
    assert(tiles);
    const lmb_tiles_header *const header = tiles->header;
    const int64_t cells[3] = {header->tile_cells[0], header->tile_cells[1], header->tile_cells[2]};
    lmb_vec3d bounds[2];
    box_bounds(header, header->min, header->size, bounds);
    lmb_volume_tiles_info info = {.tile_count = header->tile_count,
                                  .bounds_min = bounds[0],
                                  .bounds_max = bounds[1],
                                  .tile_size = point_position(header, cells),
                                  .spacing = header->spacing,
                                  .level_count = header->level_count,
                                  .key_light_count = header->key_light_count,
                                  .is_compact = header->probe_form == LMB_VOLUME_COMPACT,
                                  .file_bytes = header->file_bytes};
    for (uint32_t i = 0; i < header->tile_count; ++i) {
        info.tile_bytes += tiles->entry[i].file_bytes;
    }
    return info;
}

lmb_volume_tile lmb_volume_tiles_get(const lmb_volume_tiles *tiles, uint32_t tile)
{
    assert(tiles && tile < tiles->header->tile_count);
    const lmb_tiles_entry *const entry = &tiles->entry[tile];
    int32_t min[3], size[3];
    lmb_vec3d bounds[2];
    lmb_tiles_box(tiles->header, entry->at, min, size);
    box_bounds(tiles->header, min, size, bounds);
    return (lmb_volume_tile){{entry->at[0], entry->at[1], entry->at[2]}, bounds[0], bounds[1], entry->file_bytes};
}

uint32_t lmb_volume_tiles_find(const lmb_volume_tiles *tiles, lmb_vec3d position)
{
    assert(tiles);
    const bool is_number = position.x == position.x && position.y == position.y && position.z == position.z;
    return is_number ? tiles->grid[lmb_tiles_place(tiles, position)] - 1 : LMB_VOLUME_NO_TILE;
}

uint32_t lmb_volume_tiles_key_lights(const lmb_volume_tiles *tiles, lmb_key_light light[LMB_KEY_LIGHTS_MOST])
{
    assert(tiles && light);
    memcpy(light, tiles->header->key_light, sizeof tiles->header->key_light);
    return tiles->header->key_light_count;
}
