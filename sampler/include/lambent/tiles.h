/* A volume in tiles, for worlds that are streamed: an index (docs/formats.md), and a .lmb for each tile that is opened
 * and closed while other threads sample. Cells belong to one tile each, and a tile holds all the probes that its cells
 * interpolate: what is sampled is the undivided volume's light, bit for bit, with no step from tile to tile.
 *
 * Positions in a tile that is not set are outside: 0 and false, as in a volume where no probe was baked around.
 *
 * Nothing is allocated after opening. Sampling, entering, leaving, setting and clearing may be done by any number of
 * threads at once. Of a tile that is cleared, the volume may be closed when nobody samples it any more. A game
 * whose frames end for all threads at once closes it after the frame that it was cleared in. Others let threads enter
 * before they sample and leave after it, once for many samples, and ask when those that were in have left:
 *
 *     lmb_volume *const old = lmb_volume_tiles_clear(tiles, tile);
 *     const uint32_t mark = lmb_volume_tiles_mark(tiles);
 *     ...                                                         now and then, until it is true:
 *     if (lmb_volume_tiles_is_quiet(tiles, mark)) {
 *         lmb_volume_close(old);
 *     } */
#ifndef LAMBENT_TILES_H
#define LAMBENT_TILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_volume_tiles lmb_volume_tiles;

#define LMB_VOLUME_NO_TILE UINT32_C(0xffffffff)

typedef struct lmb_volume_tiles_info {
    uint32_t tile_count;
    lmb_vec3d bounds_min; /* metres, world space: of the undivided volume's lattice points */
    lmb_vec3d bounds_max;
    lmb_vec3d tile_size; /* metres; tiles begin at multiples of it */
    float spacing;       /* metres, of the finest level's probes */
    uint32_t level_count;
    uint32_t key_light_count;
    bool is_compact;
    uint64_t file_bytes; /* of the index */
    uint64_t tile_bytes; /* of all tiles */
} lmb_volume_tiles_info;

typedef struct lmb_volume_tile {
    int32_t at[3]; /* its first point in the world is at * tile_size; its file's name has these numbers */
    lmb_vec3d bounds_min, bounds_max; /* metres: of its lattice points, those that it shares with its neighbours too */
    uint64_t file_bytes;
} lmb_volume_tile;

/* Verifies an index in memory, which must be 16-byte aligned, and says how many bytes its handle needs: some hundred
 * and a pointer for each tile. Safe for untrusted data of any size.
 * @return LMB_ERROR_FORMAT, _TRUNCATED, _VERSION, _CHECKSUM, _ARGUMENT (NULL or misaligned) */
LMB_API lmb_result lmb_volume_tiles_memory(const void *index, size_t size, size_t *bytes);

/* Opens it, without tiles yet, with the handle in `memory`: as many bytes as lmb_volume_tiles_memory says, 16-byte
 * aligned. Both must outlive the handle and stay where they are. Nothing is allocated.
 * @return as above, _ARGUMENT also where `bytes` are too few */
LMB_API lmb_result lmb_volume_tiles_open_memory_in(void *memory, size_t bytes, const void *index, size_t size,
                                                   lmb_volume_tiles **tiles);

/* The same with the handle from malloc. @return as above, and LMB_ERROR_MEMORY */
LMB_API lmb_result lmb_volume_tiles_open_memory(const void *index, size_t size, lmb_volume_tiles **tiles);

/* Frees the handle where it came from malloc. It closes no volume. NULL is allowed. */
LMB_API void lmb_volume_tiles_close(lmb_volume_tiles *tiles);

LMB_API lmb_volume_tiles_info lmb_volume_tiles_get_info(const lmb_volume_tiles *tiles);

/* A tile by its number, 0 up to the count. */
LMB_API lmb_volume_tile lmb_volume_tiles_get(const lmb_volume_tiles *tiles, uint32_t tile);

/* The tile that a position is sampled by, be it set or not; outside of the bounds, the one of the nearest position
 * within. LMB_VOLUME_NO_TILE where there are no probes, and of NaN. */
LMB_API uint32_t lmb_volume_tiles_find(const lmb_volume_tiles *tiles, lmb_vec3d position);

/* As lmb_volume_key_lights; all tiles have the same. */
LMB_API uint32_t lmb_volume_tiles_key_lights(const lmb_volume_tiles *tiles, lmb_key_light light[LMB_KEY_LIGHTS_MOST]);

/* Gives a tile its volume, which was opened as any other: from here on it is sampled. The volume is prepared for that,
 * so no other thread may use it until then; it may be sampled by itself as well. `*former` gets what was set there
 * before, for the caller to close later, or NULL.
 * @return LMB_ERROR_ARGUMENT (NULL, no such tile), _FORMAT (another tile, or not a tile of this volume), _CHECKSUM (the
 *         tile, but of another bake) */
LMB_API lmb_result lmb_volume_tiles_set(lmb_volume_tiles *tiles, uint32_t tile, lmb_volume *volume,
                                        lmb_volume **former);

/* Takes a tile's volume out, and returns it; NULL: there was none. */
LMB_API lmb_volume *lmb_volume_tiles_clear(lmb_volume_tiles *tiles, uint32_t tile);

/* Whether a tile has a volume at this moment. */
LMB_API bool lmb_volume_tiles_is_set(const lmb_volume_tiles *tiles, uint32_t tile);

/* Before a thread samples and after it, where volumes are closed by lmb_volume_tiles_is_quiet; for as many samples as
 * there are to take, not for each. A thread that stays in for long keeps all volumes that are cleared meanwhile.
 * lmb_volume_tiles_leave takes what lmb_volume_tiles_enter gave. */
LMB_API uint32_t lmb_volume_tiles_enter(lmb_volume_tiles *tiles);
LMB_API void lmb_volume_tiles_leave(lmb_volume_tiles *tiles, uint32_t entered);

/* A mark behind everything that this thread has cleared, and whether all threads have left that entered before it. Does
 * not wait. Marks are told apart for 2^31 of them. */
LMB_API uint32_t lmb_volume_tiles_mark(lmb_volume_tiles *tiles);
LMB_API bool lmb_volume_tiles_is_quiet(lmb_volume_tiles *tiles, uint32_t mark);

/* As lmb_volume_sample_at, lmb_volume_sample_with_keys, lmb_volume_irradiance and their batches, with the bits that
 * these give of the undivided volume wherever tiles are set. */
LMB_API bool lmb_volume_tiles_sample(const lmb_volume_tiles *tiles, lmb_vec3d position, lmb_sh3_rgb *radiance);
LMB_API bool lmb_volume_tiles_sample_with_keys(const lmb_volume_tiles *tiles, lmb_vec3d position, lmb_sh3_rgb *radiance,
                                               float visibility[LMB_KEY_LIGHTS_MOST]);
LMB_API void lmb_volume_tiles_sample_batch(const lmb_volume_tiles *tiles, const lmb_vec3d *position, size_t count,
                                           lmb_sh3_rgb *radiance, float (*visibility)[LMB_KEY_LIGHTS_MOST],
                                           bool *inside);
LMB_API bool lmb_volume_tiles_irradiance(const lmb_volume_tiles *tiles, lmb_vec3d position, lmb_vec3 normal,
                                         lmb_rgb *irradiance);
LMB_API void lmb_volume_tiles_irradiance_batch(const lmb_volume_tiles *tiles, const lmb_vec3d *position,
                                               const lmb_vec3 *normal, size_t count, lmb_rgb *irradiance, bool *inside);

#ifdef __cplusplus
}
#endif

#endif
