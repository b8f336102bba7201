#include "bench_tiles.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/pack.h>
#include <lambent/split.h>
#include <lambent/tiles.h>

enum { CELLS_WANTED = 32 };

/* Tiles and the memory that they lie in. */
typedef struct owned_tiles {
    lmb_volume_tiles *tiles;
    unsigned char *index;
    unsigned char **data; /* [tile] */
    uint32_t count;
    double bytes;
} owned_tiles;

static void sample_single(const void *data, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    const lmb_volume_tiles *const tiles = ((const owned_tiles *)data)->tiles;
    for (size_t i = 0; i < count; ++i) {
        const lmb_vec3d at = {(double)position[i].x, (double)position[i].y, (double)position[i].z};
        lmb_volume_tiles_sample(tiles, at, &radiance[i]);
    }
}

static void sample_batch(const void *data, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    lmb_vec3d at[BENCH_CHUNK];
    for (size_t i = 0; i < count; ++i) {
        at[i] = (lmb_vec3d){(double)position[i].x, (double)position[i].y, (double)position[i].z};
    }
    lmb_volume_tiles_sample_batch(((const owned_tiles *)data)->tiles, at, count, radiance, NULL, NULL);
}

static void tiles_destroy(void *data)
{
    owned_tiles *const owned = data;
    for (uint32_t i = 0; i < owned->count; ++i) {
        if (owned->tiles) {
            lmb_volume_close(lmb_volume_tiles_clear(owned->tiles, i));
        }
        free(owned->data[i]);
    }
    lmb_volume_tiles_close(owned->tiles);
    free(owned->data);
    free(owned->index);
    free(owned);
}

static lmb_result tile_keep(void *context, const int32_t at[3], const unsigned char *data, size_t size)
{
    (void)at; /* they come in the order of their numbers */
    owned_tiles *const owned = context;
    unsigned char **const more = realloc(owned->data, (owned->count + 1) * sizeof *more);
    unsigned char *const copy = aligned_alloc(LMB_VOLUME_ALIGNMENT, size);
    owned->data = more ? more : owned->data;
    if (!more || !copy) {
        free(copy);
        return LMB_ERROR_MEMORY;
    }
    memcpy(copy, data, size);
    owned->data[owned->count++] = copy;
    owned->bytes += (double)size;
    return LMB_OK;
}

static lmb_result volume_split(const lmb_volume *volume, owned_tiles *owned)
{
    const int32_t brick = LMB_BRICK_CELLS << (lmb_volume_get_info(volume).level_count - 1);
    const int32_t cells = brick > CELLS_WANTED ? brick : CELLS_WANTED / brick * brick;
    const lmb_split_sink sink = {tile_keep, owned};
    size_t size = 0;
    lmb_result result = lmb_split(volume, (const int32_t[3]){cells, cells, cells}, &sink, &owned->index, &size);
    if (result == LMB_OK) {
        owned->bytes += (double)size;
        result = lmb_volume_tiles_open_memory(owned->index, size, &owned->tiles);
    }
    return result;
}

static lmb_result tiles_set(owned_tiles *owned)
{
    lmb_result result = LMB_OK;
    for (uint32_t i = 0; i < owned->count && result == LMB_OK; ++i) {
        const size_t size = (size_t)lmb_volume_tiles_get(owned->tiles, i).file_bytes;
        lmb_volume *volume = NULL, *former;
        result = lmb_volume_open_memory(owned->data[i], size, &volume);
        if (result == LMB_OK) {
            result = lmb_volume_tiles_set(owned->tiles, i, volume, &former);
        }
        if (result != LMB_OK) {
            lmb_volume_close(volume);
        }
    }
    return result;
}

lmb_result bench_tiles_create(const lmb_probes *probes, const char *const name[2], lmb_bench_sampler sampler[2])
{
    owned_tiles *const owned = calloc(1, sizeof *owned);
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_volume *volume = NULL;
    lmb_result result = owned ? lmb_pack(probes, &data, &size, NULL) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = lmb_volume_open_memory(data, size, &volume);
    }
    if (result == LMB_OK) {
        result = volume_split(volume, owned);
    }
    if (result == LMB_OK) {
        result = tiles_set(owned);
    }
    lmb_volume_close(volume);
    free(data);
    if (result == LMB_OK) {
        sampler[0] = (lmb_bench_sampler){name[0], owned, owned->bytes, sample_single, tiles_destroy};
        sampler[1] = (lmb_bench_sampler){name[1], owned, owned->bytes, sample_batch, NULL};
    } else if (owned) {
        tiles_destroy(owned);
    }
    return result;
}
