#include <lambent/tile_files.h>

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>
#include <lambent/split.h>

#define INDEX_ENDING ".lmt"

char *lmb_tile_files_path(const char *index, const int32_t at[3])
{
    const size_t length = strlen(index), ending = sizeof INDEX_ENDING - 1;
    const bool ends = length > ending && strcmp(index + length - ending, INDEX_ENDING) == 0;
    const size_t stem = ends ? length - ending : length,
                 size = stem + sizeof "_-2147483648_-2147483648_-2147483648.lmb";
    char *const path = malloc(size);
    if (path) {
        snprintf(path, size, "%.*s_%d_%d_%d.lmb", (int)stem, index, at[0], at[1], at[2]);
    }
    return path;
}

/* ------------------------------------------------------------------------------------------------- writing */

typedef struct tile_writing {
    const char *index;
    lmb_tile_files_stats *stats;
    lmb_error *error;
    bool failed; /* and said so */
} tile_writing;

static lmb_result tile_write(void *context, const int32_t at[3], const unsigned char *data, size_t size)
{
    tile_writing *const writing = context;
    char *const path = lmb_tile_files_path(writing->index, at);
    const lmb_result result = path ? lmb_file_write(path, data, size, writing->error)
                                   : lmb_error_set(writing->error, LMB_ERROR_MEMORY, "out of memory");
    writing->stats->count += 1;
    writing->stats->bytes += size;
    writing->failed = result != LMB_OK;
    free(path);
    return result;
}

lmb_result lmb_tile_files_write(const unsigned char *volume, size_t size, double metres, const char *index,
                                lmb_tile_files_stats *stats, lmb_error *error)
{
    assert(volume && index && stats);
    lmb_volume_storage storage;
    lmb_volume *opened;
    unsigned char *data = NULL;
    size_t data_size = 0;
    tile_writing writing = {.index = index, .stats = stats, .error = error};
    const lmb_split_sink sink = {tile_write, &writing};
    lmb_result result = lmb_volume_open_memory_in(&storage, volume, size, &opened);
    if (result == LMB_OK) {
        const lmb_volume_info info = lmb_volume_get_info(opened);
        const int32_t cells = lmb_split_cells(&info, metres);
        *stats = (lmb_tile_files_stats){.tile_size = cells * (double)info.spacing};
        result = lmb_split(opened, (const int32_t[3]){cells, cells, cells}, &sink, &data, &data_size);
        lmb_volume_close(opened);
    }
    if (result == LMB_OK) {
        result = lmb_file_write(index, data, data_size, error);
    } else if (!writing.failed) {
        lmb_error_set(error, result, "%s: %s", index, lmb_result_text(result));
    }
    free(data);
    return result;
}

/* ------------------------------------------------------------------------------------------------- reading */

struct lmb_tile_files {
    char *index;
    unsigned char *data; /* of the index */
    lmb_volume_tiles *tiles;
    lmb_volume **volume; /* [tile] NULL: not needed yet */
    uint32_t count;
};

bool lmb_tile_files_is_index(const char *path)
{
    char magic[LMB_VOLUME_MAGIC_SIZE];
    FILE *const file = fopen(path, "rb");
    const bool is_index = file && fread(magic, 1, sizeof magic, file) == sizeof magic &&
                          memcmp(magic, LMB_TILES_MAGIC, sizeof magic) == 0;
    if (file) {
        fclose(file);
    }
    return is_index;
}

lmb_result lmb_tile_files_open(const char *index, lmb_tile_files **files, lmb_error *error)
{
    assert(index && files);
    size_t size = 0;
    lmb_tile_files *const opened = calloc(1, sizeof *opened);
    lmb_result result = opened ? lmb_file_read(index, &opened->data, &size, error) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = lmb_volume_tiles_open_memory(opened->data, size, &opened->tiles);
        if (result != LMB_OK) {
            lmb_error_set(error, result, "%s: %s", index, lmb_result_text(result));
        }
    }
    if (result == LMB_OK) {
        opened->count = lmb_volume_tiles_get_info(opened->tiles).tile_count;
        opened->volume = calloc(opened->count, sizeof *opened->volume);
        opened->index = malloc(strlen(index) + 1);
        result = opened->volume && opened->index ? LMB_OK : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        memcpy(opened->index, index, strlen(index) + 1);
        *files = opened;
        return LMB_OK;
    }
    lmb_tile_files_close(opened);
    return result == LMB_ERROR_MEMORY ? lmb_error_set(error, result, "out of memory") : result;
}

void lmb_tile_files_close(lmb_tile_files *files)
{
    if (!files) {
        return;
    }
    for (uint32_t i = 0; files->volume && i < files->count; ++i) {
        lmb_volume_close(files->volume[i]);
    }
    lmb_volume_tiles_close(files->tiles);
    free(files->volume);
    free(files->data);
    free(files->index);
    free(files);
}

const lmb_volume_tiles *lmb_tile_files_tiles(const lmb_tile_files *files)
{
    return files->tiles;
}

static lmb_result tile_open(lmb_tile_files *files, uint32_t tile, lmb_error *error)
{
    const lmb_volume_tile at = lmb_volume_tiles_get(files->tiles, tile);
    char *const path = lmb_tile_files_path(files->index, at.at);
    lmb_volume *volume = NULL, *former;
    if (!path) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    lmb_result result = lmb_volume_open_file(path, &volume);
    if (result != LMB_OK) {
        lmb_error_set(error, result, "%s: %s", path, lmb_result_text(result));
    } else {
        result = lmb_volume_tiles_set(files->tiles, tile, volume, &former);
        if (result != LMB_OK) {
            lmb_volume_close(volume);
            volume = NULL;
            lmb_error_set(error, result, "%s: not the tile of %s", path, files->index);
        }
    }
    files->volume[tile] = volume;
    free(path);
    return result;
}

lmb_result lmb_tile_files_need(lmb_tile_files *files, uint32_t tile, const lmb_volume **volume, lmb_error *error)
{
    const bool is_tile = tile != LMB_VOLUME_NO_TILE;
    assert(files && (!is_tile || tile < files->count));
    const lmb_result result = is_tile && !files->volume[tile] ? tile_open(files, tile, error) : LMB_OK;
    if (volume) {
        *volume = is_tile ? files->volume[tile] : NULL;
    }
    return result;
}
