#include "volume_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(lmb_volume) <= sizeof(lmb_volume_storage), "a handle fits what callers give for it");
_Static_assert(_Alignof(lmb_volume) <= _Alignof(lmb_volume_storage), "and is aligned there");

void lmb_volume_origin(const int32_t min[3], uint32_t level_count, int32_t origin[3])
{
    const int32_t coarsest = LMB_BRICK_CELLS << (level_count - 1);
    for (int axis = 0; axis < 3; ++axis) {
        origin[axis] = lmb_volume_floor_divide(min[axis], coarsest) * coarsest;
    }
}

double lmb_volume_slack(const int32_t min[3], const int32_t size[3])
{
    double farthest = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        farthest = fmax(farthest, fmax(fabs((double)min[axis]), fabs(min[axis] + (size[axis] - 1.0))));
    }
    return fmin(farthest * 0x1p-22, 0x1p-6);
}

void lmb_volume_derive(lmb_volume *volume, const int32_t origin[3], double slack)
{
    const lmb_volume_header *const header = volume->header;
    size_t first_block[3];
    for (int axis = 0; axis < 3; ++axis) {
        const int32_t first = header->min[axis] - origin[axis];
        volume->origin[axis] = origin[axis];
        volume->first[axis] = first;
        volume->last[axis] = first + (header->size[axis] - 1.0);
        volume->last_cell[axis] = header->size[axis] > 1 ? first + (header->size[axis] - 2) : first;
        first_block[axis] = (size_t)(first / LMB_BRICK_CELLS);
    }
    for (int axis = 0; axis < 4; ++axis) {
        volume->nearest[axis] = volume->first[axis] - slack;
        volume->farthest[axis] = volume->last[axis] + slack;
    }
    volume->first_entry =
        first_block[0] + volume->entry_step[0] * first_block[1] + volume->entry_step[1] * first_block[2];
    volume->inverse_spacing = 1.0 / (double)header->spacing;
    volume->scale = header->scale;
    volume->calls = lmb_volume_kernel_calls(lmb_volume_kernel_choose(), header);
}

/* With the origin that a volume has by itself. */
static void derive_own(lmb_volume *volume)
{
    int32_t origin[3];
    lmb_volume_origin(volume->header->min, volume->header->level_count, origin);
    lmb_volume_derive(volume, origin, lmb_volume_slack(volume->header->min, volume->header->size));
}

lmb_result lmb_volume_open_memory_in(lmb_volume_storage *storage, const void *data, size_t size, lmb_volume **volume)
{
    const bool arguments_are_valid = storage && data && volume && (uintptr_t)data % 16 == 0;
    assert(arguments_are_valid);
    if (!arguments_are_valid) {
        return LMB_ERROR_ARGUMENT;
    }
    lmb_volume opened = {.mapping = NULL};
    const lmb_result result = lmb_volume_verify(data, size, &opened);
    if (result != LMB_OK) {
        return result;
    }
    derive_own(&opened);
    /* Copied as bytes: the caller declared the memory with another type. */
    memcpy(storage, &opened, sizeof opened);
    *volume = (lmb_volume *)storage;
    return LMB_OK;
}

lmb_result lmb_volume_open_memory(const void *data, size_t size, lmb_volume **volume)
{
    lmb_volume_storage *const storage = malloc(sizeof *storage);
    if (!storage) {
        return LMB_ERROR_MEMORY;
    }
    const lmb_result result = lmb_volume_open_memory_in(storage, data, size, volume);
    if (result != LMB_OK) {
        free(storage);
        return result;
    }
    (*volume)->is_allocated = true;
    return LMB_OK;
}

lmb_result lmb_volume_open_file(const char *path, lmb_volume **volume)
{
    assert(path && volume);
    if (!path || !volume) {
        return LMB_ERROR_ARGUMENT;
    }
    void *mapping;
    size_t size;
    lmb_result result = lmb_volume_map(path, &mapping, &size);
    if (result != LMB_OK) {
        return result;
    }
    result = lmb_volume_open_memory(mapping, size, volume);
    if (result != LMB_OK) {
        lmb_volume_unmap(mapping, size);
        return result;
    }
    (*volume)->mapping = mapping;
    return LMB_OK;
}

void lmb_volume_close(lmb_volume *volume)
{
    if (volume) {
        if (volume->mapping) {
            lmb_volume_unmap(volume->mapping, (size_t)volume->header->file_bytes);
        }
        if (volume->is_allocated) {
            free(volume);
        }
    }
}

lmb_volume_info lmb_volume_get_info(const lmb_volume *volume)
{
    assert(volume);
    const lmb_volume_header *const header = volume->header;
    const lmb_lattice lattice = {.spacing = header->spacing,
                                 .min = {header->min[0], header->min[1], header->min[2]},
                                 .size = {header->size[0], header->size[1], header->size[2]}};
    const int32_t last[3] = {header->min[0] + (header->size[0] - 1), header->min[1] + (header->size[1] - 1),
                             header->min[2] + (header->size[2] - 1)};
    return (lmb_volume_info){
        .version = header->version,
        .probe_count = header->probe_count,
        .brick_count = header->brick_count - 1,
        .bounds_min = lmb_lattice_position(&lattice, lattice.min),
        .bounds_max = lmb_lattice_position(&lattice, last),
        .scale = header->scale,
        .file_bytes = header->file_bytes,
        .key_light_count = header->key_light_count,
        .spacing = header->spacing,
        .level_count = header->level_count,
        .cut_count = header->cut_count,
        .is_compact = header->probe_form == LMB_VOLUME_COMPACT,
    };
}

uint32_t lmb_volume_key_lights(const lmb_volume *volume, lmb_key_light light[LMB_KEY_LIGHTS_MOST])
{
    assert(volume && light);
    memcpy(light, volume->header->key_light, sizeof volume->header->key_light);
    return volume->header->key_light_count;
}

float lmb_volume_spacing_at(const lmb_volume *volume, lmb_vec3d position)
{
    assert(volume);
    const double in[3] = {position.x, position.y, position.z};
    uint32_t cell[3], level;
    for (int axis = 0; axis < 3; ++axis) {
        const double at = in[axis] * volume->inverse_spacing - volume->origin[axis];
        const double clamped = at > volume->first[axis] ? fmin(at, volume->last[axis]) : volume->first[axis];
        const int32_t whole = (int32_t)clamped;
        cell[axis] = (uint32_t)(whole < volume->last_cell[axis] ? whole : volume->last_cell[axis]);
    }
    lmb_volume_brick_at(volume, cell, &level);
    return ldexpf(volume->header->spacing, (int)level);
}

lmb_volume_gpu lmb_volume_get_gpu(const lmb_volume *of, lmb_vec3d world_origin)
{
    assert(of);
    lmb_volume own = *of; /* a tile's origin may be too far off for floats */
    derive_own(&own);
    const lmb_volume *const volume = &own;
    const double from[3] = {world_origin.x, world_origin.y, world_origin.z};
    const uint32_t *const words = (const uint32_t *)volume->header;
    lmb_volume_gpu gpu = {.words = words, .bytes = (size_t)volume->header->file_bytes};
    lmb_volume_gpu_constants *const to = &gpu.constants;
    double farthest = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double origin = fabs(volume->origin[axis] - from[axis] * volume->inverse_spacing);
        farthest = fmax(farthest, origin + volume->last[axis]);
        to->origin[axis] = (float)(volume->origin[axis] - from[axis] * volume->inverse_spacing);
        to->first[axis] = (float)volume->first[axis];
        to->last[axis] = (float)volume->last[axis];
        to->last_cell[axis] = (uint32_t)volume->last_cell[axis];
    }
    to->slack = (float)fmin(farthest * 0x1p-22, 0x1p-6); /* four roundings, as lmb_volume_slack has it */
    to->inverse_spacing = (float)volume->inverse_spacing;
    to->scale = volume->scale;
    to->key_lights = volume->key_count;
    to->probe_units = volume->probe_units;
    to->entries[0] = (uint32_t)volume->entry_step[0];
    to->entries[1] = (uint32_t)volume->entry_step[1];
    to->entries[2] = (uint32_t)volume->first_entry;
    to->is_compact = volume->header->probe_form == LMB_VOLUME_COMPACT;
    to->directory = (uint32_t)(volume->directory - words);
    to->bricks = (uint32_t)((const uint32_t *)volume->bricks - words);
    to->probes = (uint32_t)((const uint32_t *)(const void *)volume->probes - words);
    to->cut_offsets = volume->cut_offsets ? (uint32_t)(volume->cut_offsets - words) : 0;
    to->cuts = (uint32_t)((const uint32_t *)(const void *)volume->cuts - words);
    return gpu;
}
