#include "volume_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(lmb_volume) <= sizeof(lmb_volume_storage), "a handle fits what callers give for it");
_Static_assert(_Alignof(lmb_volume) <= _Alignof(lmb_volume_storage), "and is aligned there");

/* What sampling needs, from a sane header. */
static void derive_constants(lmb_volume *volume)
{
    const lmb_volume_header *const header = &volume->header;
    double farthest = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        volume->min[axis] = header->min[axis];
        volume->last[axis] = header->size[axis] - 1.0;
        farthest = fmax(farthest, fmax(fabs(volume->min[axis]), fabs(volume->min[axis] + volume->last[axis])));
    }
    volume->inverse_spacing = 1.0 / (double)header->spacing;
    volume->scale = header->scale;
    /* Four times the rounding of a float of that size, and never a share of a cell that matters. */
    volume->slack = fmin(farthest * 0x1p-22, 0x1p-6);
    for (int axis = 0; axis < 4; ++axis) {
        volume->nearest[axis] = -volume->slack;
        volume->farthest[axis] = volume->last[axis] + volume->slack;
    }
    volume->brick_step[0] = volume->bricks_along[0];
    volume->brick_step[1] = volume->bricks_along[0] * volume->bricks_along[1];
    volume->kernel = lmb_volume_kernel_choose();
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
    derive_constants(&opened);
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
            lmb_volume_unmap(volume->mapping, (size_t)volume->header.file_bytes);
        }
        if (volume->is_allocated) {
            free(volume);
        }
    }
}

lmb_volume_info lmb_volume_get_info(const lmb_volume *volume)
{
    assert(volume);
    const lmb_volume_header *const header = &volume->header;
    const lmb_lattice lattice = {.spacing = header->spacing,
                                 .min = {header->min[0], header->min[1], header->min[2]},
                                 .size = {header->size[0], header->size[1], header->size[2]}};
    const int32_t last[3] = {header->min[0] + (header->size[0] - 1), header->min[1] + (header->size[1] - 1),
                             header->min[2] + (header->size[2] - 1)};
    return (lmb_volume_info){
        .version = header->version,
        .probe_count = header->probe_count,
        .brick_count = header->brick_count,
        .bounds_min = lmb_lattice_position(&lattice, lattice.min),
        .bounds_max = lmb_lattice_position(&lattice, last),
        .scale = header->scale,
        .file_bytes = header->file_bytes,
        .key_light_count = volume->keys ? volume->keys->count : 0,
    };
}

uint32_t lmb_volume_key_lights(const lmb_volume *volume, lmb_key_light light[LMB_KEY_LIGHTS_MOST])
{
    assert(volume && light);
    if (!volume->keys) {
        memset(light, 0, LMB_KEY_LIGHTS_MOST * sizeof *light);
        return 0;
    }
    memcpy(light, volume->keys->light, sizeof volume->keys->light);
    return volume->keys->count;
}

float lmb_volume_spacing_at(const lmb_volume *volume, lmb_vec3d position)
{
    assert(volume);
    (void)position; /* the format has one spacing */
    return volume->header.spacing;
}
