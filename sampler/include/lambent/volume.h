/* The run-time probe volume: a .lmb file (docs/formats.md) opened from memory or mapped, and sampled.
 *
 * Opening verifies the whole file: magic, version, checksum, every size and offset. After that nothing is allocated,
 * nothing is written, and any number of threads may sample one volume. */
#ifndef LAMBENT_VOLUME_H
#define LAMBENT_VOLUME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/api.h>
#include <lambent/key_light.h>
#include <lambent/result.h>
#include <lambent/sh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_volume lmb_volume;

enum { LMB_VOLUME_STORAGE_WORDS = 64 };

typedef struct lmb_volume_info {
    uint32_t version;     /* of the file format */
    uint64_t probe_count; /* that were baked and are stored, each counted once */
    uint32_t brick_count;
    lmb_vec3d bounds_min; /* metres, world space: of the lattice points */
    lmb_vec3d bounds_max;
    float scale; /* the power of two that stored radiance was divided by */
    uint64_t file_bytes;
    uint32_t key_light_count;
    float spacing;        /* metres, of the finest level's probes */
    uint32_t level_count; /* each next level has twice the spacing of the one before */
    uint32_t cut_count;   /* cells that geometry parts */
    bool is_compact;      /* coefficients above the first are bytes */
} lmb_volume_info;

/* Memory for a handle, from the caller: a member of a game's own struct, an entry of a pool, a static. Its contents
 * are private. */
typedef struct lmb_volume_storage {
    uint64_t private_words[LMB_VOLUME_STORAGE_WORDS];
} lmb_volume_storage;

/* Opens a volume that lies in memory. `data` is not copied: it must outlive the volume and be 16-byte aligned
 * (malloc and mmap are). `*volume` is set only on LMB_OK. Safe for untrusted data of any size. The handle, a
 * lmb_volume_storage, is the only memory that opening needs, and comes from malloc.
 * @return LMB_ERROR_FORMAT, _TRUNCATED, _VERSION, _CHECKSUM, _MEMORY, _ARGUMENT (NULL or misaligned) */
LMB_API lmb_result lmb_volume_open_memory(const void *data, size_t size, lmb_volume **volume);

/* The same with the handle in `storage`, which must outlive the volume and must not be moved: nothing is allocated.
 * `storage` is written only on LMB_OK; it may be used again after lmb_volume_close, which frees nothing here, and may
 * as well be left out.
 * @return as above, never _MEMORY */
LMB_API lmb_result lmb_volume_open_memory_in(lmb_volume_storage *storage, const void *data, size_t size,
                                             lmb_volume **volume);

/* Maps the file and opens it, the handle from malloc. `path` is UTF-8 (on POSIX: bytes). @return as
 * lmb_volume_open_memory, and LMB_ERROR_IO */
LMB_API lmb_result lmb_volume_open_file(const char *path, lmb_volume **volume);

/* Frees the handle and unmaps the file, not the caller's memory. NULL is allowed. */
LMB_API void lmb_volume_close(lmb_volume *volume);

LMB_API lmb_volume_info lmb_volume_get_info(const lmb_volume *volume);

/* Metres between probes at a position, the finest level's where there are none; outside of the bounds, at the nearest
 * position within. */
LMB_API float lmb_volume_spacing_at(const lmb_volume *volume, lmb_vec3d position);

/* The key lights, whose direct light the stored radiance leaves out; how many there are. Those beyond are 0. */
LMB_API uint32_t lmb_volume_key_lights(const lmb_volume *volume, lmb_key_light light[LMB_KEY_LIGHTS_MOST]);

/* Trilinear SH3 radiance at `position`, without the direct light of key lights.
 * @return true inside the baked volume; false outside (or NaN), where `radiance` gets the light of the nearest position
 *         in the bounds, or 0 where the cell there holds no probes. Never NaN or infinity. `volume` and `radiance`
 *         must not be NULL (asserted only). */
LMB_API bool lmb_volume_sample(const lmb_volume *volume, lmb_vec3 position, lmb_sh3_rgb *radiance);

/* The same at a position in double. A float at 1000 km from the world's origin is exact to 6 cm, at 10 000 km to 1 m:
 * levels out there are sampled by this. Where the position is a float's value, both give the same bits. */
LMB_API bool lmb_volume_sample_at(const lmb_volume *volume, lmb_vec3d position, lmb_sh3_rgb *radiance);

/* The same, and what is seen of each key light there, trilinear too: 0 to 1, for lmb_key_light_irradiance. 0 where
 * there are no probes, and of lights that there are not. */
LMB_API bool lmb_volume_sample_with_keys(const lmb_volume *volume, lmb_vec3d position, lmb_sh3_rgb *radiance,
                                         float visibility[LMB_KEY_LIGHTS_MOST]);

/* Several volumes of one level, each with a weight: sets of lights that are dimmed, switched and, from two bakes,
 * blended. Harmonics are added before anything is made of them: the sum is exact, which that of solved models is not.
 * Weights are finite and not negative. Key lights are not in it: each volume has its own, of its weight.
 * @return true inside of all of them; never NaN */
LMB_API bool lmb_volume_blend(const lmb_volume *const *volume, const float *weight, uint32_t count, lmb_vec3d position,
                              lmb_sh3_rgb *radiance);

/* Many at once, in any order: the bits of single calls, sooner, as what later positions need is fetched from memory
 * while earlier ones are added up. It pays where positions are far apart; nearby ones are in the caches anyway, so that
 * there is nothing to sort. Nothing is allocated.
 * `radiance` gets `count` samples; `visibility` and `inside`, what lmb_volume_sample_with_keys gives and returns for
 * each, or NULL. */
LMB_API void lmb_volume_sample_batch(const lmb_volume *volume, const lmb_vec3d *position, size_t count,
                                     lmb_sh3_rgb *radiance, float (*visibility)[LMB_KEY_LIGHTS_MOST], bool *inside);

/* Irradiance on a unit normal straight away, from the whole sphere, without key lights: what lmb_sh3_rgb_irradiance
 * makes of lmb_volume_sample_at, but for the last bits, and sooner. For what has no occlusion: particles, vertices far
 * away, many objects on a server. Never NaN or negative, whatever position and normal.
 * @return as lmb_volume_sample */
LMB_API bool lmb_volume_irradiance(const lmb_volume *volume, lmb_vec3d position, lmb_vec3 normal, lmb_rgb *irradiance);

/* Many at once, each with a normal of its own: the bits of single calls. `inside` may be NULL. */
LMB_API void lmb_volume_irradiance_batch(const lmb_volume *volume, const lmb_vec3d *position, const lmb_vec3 *normal,
                                         size_t count, lmb_rgb *irradiance, bool *inside);

/* What a shader needs to sample the volume by itself, with shader/lambent_sampling.glsl: words for a storage buffer,
 * which are the file as it is, and constants, LmbVolume there, for a uniform buffer. */
typedef struct lmb_volume_gpu_constants {
    float origin[3]; /* in spacings of the finest level, from the shader's origin */
    float inverse_spacing;
    float first[3]; /* of the box, from there */
    float scale;
    float last[3];
    uint32_t key_lights;
    uint32_t last_cell[3];
    uint32_t probe_units;
    uint32_t entries[3]; /* of the directory: along y and z to the next block, and before the first */
    uint32_t is_compact;
    uint32_t directory, bricks, probes, cut_offsets, cuts; /* where they begin, in words; 0: there are none */
    float slack; /* spacings that a position may be off the box and count as inside, as floats round */
    uint32_t padding[2];
} lmb_volume_gpu_constants;

typedef struct lmb_volume_gpu {
    const void *words; /* little-endian; the volume's, until it is closed */
    size_t bytes;
    lmb_volume_gpu_constants constants;
} lmb_volume_gpu;

/* `world_origin` is where the shader counts its positions from: floats tell an eighth of a spacing apart within some
 * 10^6 spacings of it. Volumes of up to 16 GB, and no position of the box more than 2^24 spacings from its first one.
 */
LMB_API lmb_volume_gpu lmb_volume_get_gpu(const lmb_volume *volume, lmb_vec3d world_origin);

#ifdef __cplusplus
}
#endif

#endif
