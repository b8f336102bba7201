#include "leaks_methods.h"

#include <stdlib.h>

/* Where no corner counts, light from behind a wall is better than a black hole. */
static void blend_seen(const leaks_field *field, const leaks_cell *cell, uint32_t seen, lmb_sh3_rgb *radiance)
{
    float weight[8], counted[8];
    leaks_weights(cell->t, weight);
    for (int i = 0; i < 8; ++i) {
        counted[i] = seen >> i & 1u ? weight[i] : 0.0f;
        weight[i] = cell->probe[i] >= 0 ? weight[i] : 0.0f;
    }
    if (!leaks_blend(field, cell->probe, counted, radiance) && !leaks_blend(field, cell->probe, weight, radiance)) {
        *radiance = (lmb_sh3_rgb){.channel = {{.c = {0.0f}}}};
    }
}

/* Bit i: corner i is seen from a point. */
static uint32_t corners_seen(const leaks_field *field, const leaks_cell *cell, lmb_vec3 from)
{
    uint32_t seen = 0;
    for (int i = 0; i < 8; ++i) {
        if (leaks_probe_is_valid(field, cell->probe[i]) &&
            leaks_sees(field->level->tracer, from, field->place[cell->probe[i]])) {
            seen |= 1u << i;
        }
    }
    return seen;
}

static lmb_result exact_prepare(const leaks_field *field, void **state, size_t *bytes)
{
    const leaks_field **kept = malloc(sizeof *kept);
    if (!kept) {
        return LMB_ERROR_MEMORY;
    }
    *kept = field;
    *state = kept;
    *bytes = field->packed_bytes;
    return LMB_OK;
}

static void exact_sample(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance)
{
    (void)normal;
    const leaks_field *field = *(const leaks_field *const *)state;
    const leaks_cell cell = leaks_cell_of(field, position);
    blend_seen(field, &cell, corners_seen(field, &cell, position), radiance);
}

const leaks_method leaks_masked_exact = {
    .name = "masked.exact",
    .about = "corners that are seen from the point, by rays: a bound, not to be stored",
    .prepare = exact_prepare,
    .sample = exact_sample,
    .release = free,
};

/* --- stored ---------------------------------------------------------------------------------------------------- */

typedef struct masks {
    const leaks_field *field;
    int32_t along[3];
    uint64_t mask[]; /* [cell] byte s: corners that eighth s of it sees */
} masks;

static size_t cell_index(const masks *all, const int32_t at[3])
{
    return (size_t)at[0] + (size_t)all->along[0] * ((size_t)at[1] + (size_t)all->along[1] * (size_t)at[2]);
}

/* What most of eight points of an eighth of a cell see that see anything, as those in a solid do not; where it is for
 * half of them, all of it. */
static uint32_t eighth_seen(const leaks_field *field, const leaks_cell *cell, int eighth)
{
    int votes[8] = {0}, voters = 0;
    for (int i = 0; i < 8; ++i) {
        const float x = 0.5f * (float)(eighth & 1) + 0.125f + 0.25f * (float)(i & 1);
        const float y = 0.5f * (float)(eighth >> 1 & 1) + 0.125f + 0.25f * (float)(i >> 1 & 1);
        const float z = 0.5f * (float)(eighth >> 2) + 0.125f + 0.25f * (float)(i >> 2);
        const uint32_t seen = corners_seen(field, cell, leaks_cell_point(field, cell->at, x, y, z));
        voters += seen != 0;
        for (int corner = 0; corner < 8; ++corner) {
            votes[corner] += (int)(seen >> corner & 1u);
        }
    }
    uint32_t most = 0;
    for (int corner = 0; corner < 8; ++corner) {
        most |= (uint32_t)(voters > 0 && 2 * votes[corner] >= voters) << corner;
    }
    return most;
}

/* A layer of cells. */
static void masks_fill(void *context, size_t layer, int worker)
{
    (void)worker;
    masks *const all = context;
    for (int32_t i = 0; i < all->along[0] * all->along[1]; ++i) {
        const int32_t at[3] = {i % all->along[0], i / all->along[0], (int32_t)layer};
        const leaks_cell cell = leaks_cell_at(all->field, at);
        uint64_t mask = 0;
        for (int eighth = 0; eighth < 8; ++eighth) {
            mask |= (uint64_t)eighth_seen(all->field, &cell, eighth) << 8 * eighth;
        }
        all->mask[cell_index(all, at)] = mask;
    }
}

static lmb_result masked_prepare(const leaks_field *field, void **state, size_t *bytes)
{
    int32_t along[3];
    leaks_cells_along(field, along);
    const size_t cells = (size_t)along[0] * (size_t)along[1] * (size_t)along[2];
    masks *const all = malloc(sizeof *all + cells * sizeof *all->mask);
    if (!all) {
        return LMB_ERROR_MEMORY;
    }
    *all = (masks){.field = field, .along = {along[0], along[1], along[2]}};
    const lmb_result result = lmb_pool_run(field->level->pool, (size_t)along[2], masks_fill, all, "masks", NULL);
    *state = all;
    *bytes = field->packed_bytes + cells * sizeof *all->mask;
    return result;
}

static void masked_sample(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance)
{
    (void)normal;
    const masks *all = state;
    const leaks_cell cell = leaks_cell_of(all->field, position);
    const int eighth = (cell.t[0] >= 0.5f) | (cell.t[1] >= 0.5f) << 1 | (cell.t[2] >= 0.5f) << 2;
    const uint64_t mask = all->mask[cell_index(all, cell.at)];
    blend_seen(all->field, &cell, (uint32_t)(mask >> 8 * eighth) & 0xffu, radiance);
}

const leaks_method leaks_masked = {
    .name = "masked",
    .about = "corners that are seen from the eighth of the cell, 64 bits a cell",
    .prepare = masked_prepare,
    .sample = masked_sample,
    .release = free,
};
