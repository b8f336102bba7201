/* A volume that is divided into tiles, all in memory. */
#ifndef LMB_TESTS_TILES_FIXTURE_H
#define LMB_TESTS_TILES_FIXTURE_H

#include <stdlib.h>
#include <string.h>

#include <lambent/pack.h>
#include <lambent/split.h>
#include <lambent/tiles.h>

#include "levels_fixture.h"

enum { TILES_MOST = 512 };

/* A volume, its tiles, and both opened. */
typedef struct divided {
    unsigned char *whole_data, *index;
    size_t whole_size, index_size;
    unsigned char *data[TILES_MOST];
    size_t size[TILES_MOST];
    int32_t at[TILES_MOST][3];
    uint32_t count;
    lmb_volume *whole, *volume[TILES_MOST];
    lmb_volume_tiles *tiles;
} divided;

static inline lmb_result tile_keep(void *context, const int32_t at[3], const unsigned char *data, size_t size)
{
    divided *const made = context;
    if (made->count == TILES_MOST) {
        return LMB_ERROR_WRITE;
    }
    made->data[made->count] = aligned_alloc(64, size);
    made->size[made->count] = size;
    memcpy(made->data[made->count], data, size);
    memcpy(made->at[made->count++], at, sizeof made->at[0]);
    return LMB_OK;
}

/* Tiles of so many bricks of the coarsest level along each axis. Aborts when they cannot be made. */
static inline void divided_of(const lmb_probes *probes, lmb_volume_form form, int32_t bricks, divided *made)
{
    const int32_t cells = bricks * (LMB_BRICK_CELLS << (probes->level_count - 1));
    memset(made, 0, sizeof *made);
    const lmb_split_sink sink = {tile_keep, made};
    bool good = lmb_pack_as(form, probes, &made->whole_data, &made->whole_size, NULL) == LMB_OK &&
                lmb_volume_open_memory(made->whole_data, made->whole_size, &made->whole) == LMB_OK &&
                lmb_split(made->whole, (const int32_t[3]){cells, cells, cells}, &sink, &made->index,
                          &made->index_size) == LMB_OK &&
                lmb_volume_tiles_open_memory(made->index, made->index_size, &made->tiles) == LMB_OK;
    for (uint32_t i = 0; good && i < made->count; ++i) {
        good = lmb_volume_open_memory(made->data[i], made->size[i], &made->volume[i]) == LMB_OK;
    }
    if (!good) {
        fprintf(stderr, "tiles cannot be made\n");
        abort();
    }
}

static inline void divided_make(const levels_recipe *recipe, lmb_volume_form form, int32_t bricks, divided *made)
{
    lmb_probes *const probes = levels_make(recipe);
    divided_of(probes, form, bricks, made);
    lmb_probes_destroy(probes);
}

static inline void divided_free(divided *made)
{
    lmb_volume_tiles_close(made->tiles);
    lmb_volume_close(made->whole);
    for (uint32_t i = 0; i < made->count; ++i) {
        lmb_volume_close(made->volume[i]);
        free(made->data[i]);
    }
    free(made->whole_data);
    free(made->index);
}

#endif
