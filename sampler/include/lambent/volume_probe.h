/* The probes of a volume, one by one, as they are stored: for an engine that uploads them in a layout of its own.
 * lambent/volume_texture.h is a ready one.
 *
 * Probes have numbers from 0 on. A point may be stored several times (docs/formats.md says where), and has ghosts:
 * further probes, for the regions of cells that walls part. Corners that no bake was at, but that cells need, are
 * probes like the others. */
#ifndef LAMBENT_VOLUME_PROBE_H
#define LAMBENT_VOLUME_PROBE_H

#include <stdint.h>

#include <lambent/api.h>
#include <lambent/key_light.h>
#include <lambent/sh.h>
#include <lambent/types.h>
#include <lambent/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum lmb_volume_probe_kind {
    LMB_VOLUME_PROBE_NONE,  /* a gap between probes, which no cell has: all 0 */
    LMB_VOLUME_PROBE_POINT, /* of its level's lattice: the corner of cells */
    LMB_VOLUME_PROBE_GHOST  /* of one region of some cells: what light there would be at the point were no wall there */
} lmb_volume_probe_kind;

typedef struct lmb_volume_probe {
    lmb_vec3d position; /* metres, world space */
    float spacing;      /* metres, of its level */
    uint32_t level;     /* 0: the finest */
    lmb_volume_probe_kind kind;
} lmb_volume_probe;

/* How many are stored. More than lmb_volume_info.probe_count, which counts those that were baked, each once. */
LMB_API uint32_t lmb_volume_probe_count(const lmb_volume *volume);

/* Where all of them are: `probe` gets lmb_volume_probe_count entries. Goes through the whole volume once; allocates
 * nothing. */
LMB_API void lmb_volume_get_probes(const lmb_volume *volume, lmb_volume_probe *probe);

/* SH3 radiance of probe `index` (below the count), which is what lmb_volume_sample gives at a plain cell's corner, and
 * what it sees of each key light, 0 to 1, 0 of lights that there are not; `visibility` may be NULL. Finite. */
LMB_API void lmb_volume_get_probe(const lmb_volume *volume, uint32_t index, lmb_sh3_rgb *radiance,
                                  float visibility[LMB_KEY_LIGHTS_MOST]);

/* The same as half floats, which times lmb_volume_info.scale are the radiance: red 0..8, green 0..8, blue 0..8. Those
 * of the file; of a compact volume, whose numbers are no halfs, the nearest ones. Finite. */
LMB_API void lmb_volume_get_probe_halfs(const lmb_volume *volume, uint32_t index, uint16_t half[27]);

#ifdef __cplusplus
}
#endif

#endif
