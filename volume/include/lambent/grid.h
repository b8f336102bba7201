/* A probe grid while it is being built, edited or converted: sparse probes on a world-aligned lattice.
 *
 * Lattice point (i,j,k) lies at (i,j,k) * spacing in world space, so grids of one spacing always line up. The grid
 * covers the box min .. min + size - 1 of lattice points; probes exist at some of them. */
#ifndef LAMBENT_GRID_H
#define LAMBENT_GRID_H

#include <stddef.h>
#include <stdint.h>

#include <lambent/error.h>
#include <lambent/sh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_grid {
    float spacing;         /* metres, > 0 */
    int32_t min[3];        /* lattice coordinates of the box's first point */
    int32_t size[3];       /* lattice points per axis, >= 1 */
    int32_t *probe_at;     /* [x + size[0] (y + size[1] z)], relative to min: probe number or -1 */
    int32_t probe_count;
    int32_t (*lattice)[3]; /* [probe]: lattice coordinates, absolute */
    lmb_sh3_rgb *radiance; /* [probe] */
    lmb_vec3d origin;      /* world place that lmb_grid_position counts from, 0 when created; no file holds it */
    float *validity;       /* [probe] share of rays that see no back face: 1 in the open, 0 in a solid. A probe below
                              LMB_GRID_MIN_VALIDITY was not baked: its radiance is dilated from its neighbours */
} lmb_grid;

#define LMB_GRID_MIN_VALIDITY 0.5f

/* A box of lattice points without probes. @return LMB_ERROR_ARGUMENT (size or spacing out of range, more than 2^31 - 1
 * points), _MEMORY */
lmb_result lmb_grid_create(float spacing, const int32_t min[3], const int32_t size[3], lmb_grid **grid);

/* Adds probes, with zero radiance and validity 0, at every point of the box whose `wanted` byte is not 0 (laid out as
 * probe_at), in the order of probe_at. Call once. @return LMB_ERROR_ARGUMENT (called twice), _MEMORY */
lmb_result lmb_grid_add_probes(lmb_grid *grid, const uint8_t *wanted);

/* NULL is allowed. */
void lmb_grid_destroy(lmb_grid *grid);

/* Number of the probe at an absolute lattice point, or -1 when there is none or it is outside. */
int32_t lmb_grid_probe_at(const lmb_grid *grid, int32_t x, int32_t y, int32_t z);

/* World position of a probe less grid->origin, metres: found in double, rounded last. */
lmb_vec3 lmb_grid_position(const lmb_grid *grid, int32_t probe);

/* Walks the whole grid and checks every invariant above; finite radiance too. @return LMB_ERROR_FORMAT with the place
 * in `error` */
lmb_result lmb_grid_validate(const lmb_grid *grid, lmb_error *error);

/* Gives every probe with validity below LMB_GRID_MIN_VALIDITY the mean radiance of its 26 neighbours that have light
 * (valid, or filled by an earlier pass), nearer ones weighing more, pass after pass until nothing changes. Probes
 * that no valid one reaches keep zero radiance. The result does not depend on the order of probes.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_grid_dilate(lmb_grid *grid);

#ifdef __cplusplus
}
#endif

#endif
