#include "solve/surface_stored.h"

#include <stdlib.h>

#include "light/emitters_internal.h"
#include "surface/surface_light_internal.h"

static void piece_move(lmb_stored *stored, lmb_cell_piece *piece)
{
    uint8_t last = piece->last;
    LMB_STORED(stored, piece->point);
    LMB_STORED(stored, piece->side);
    LMB_STORED(stored, piece->starts);
    LMB_STORED(stored, last);
    piece->last = last != 0;
}

/* What tells light of this level from that of another. */
static void head_move(lmb_stored *stored, lmb_surface_light *light, bool *has_pieces, bool *has_sun)
{
    const uint32_t own[2] = {light->triangle_count, light->cell_count};
    uint32_t counts[2] = {own[0], own[1]};
    uint8_t flags = (uint8_t)(*has_pieces | *has_sun << 1);
    LMB_STORED(stored, counts);
    LMB_STORED(stored, flags);
    LMB_STORED(stored, light->piece_count);
    lmb_stored_expect(stored, counts[0] == own[0] && counts[1] == own[1] && flags < 4);
    lmb_stored_expect(stored, light->piece_count <= 2 * (uint64_t)light->cell_count * LMB_CELL_MOST_PIECES &&
                                  (light->piece_count == 0 || (flags & 1) != 0));
    *has_pieces = (flags & 1) != 0;
    *has_sun = (flags & 2) != 0;
}

/* The light of patches: also what lmb_surface_light_allocate has made room for. */
static void patches_move(lmb_stored *stored, lmb_surface_light *light)
{
    const size_t patches = lmb_patch_count(light);
    lmb_stored_value(stored, light->irradiance, patches * sizeof *light->irradiance);
    lmb_stored_value(stored, light->openness, patches * sizeof *light->openness);
    if (light->sun) {
        lmb_stored_value(stored, light->sun, patches * sizeof *light->sun);
    }
}

void lmb_surface_light_write(const lmb_surface_light *light, lmb_stored *stored)
{
    lmb_surface_light own = *light; /* nothing of it is changed */
    bool has_pieces = light->first_piece != NULL, has_sun = light->sun != NULL;
    head_move(stored, &own, &has_pieces, &has_sun);
    if (has_pieces) {
        lmb_stored_array(stored, own.first_piece, 2 * (size_t)own.cell_count, sizeof *own.first_piece);
        for (uint32_t i = 0; i < own.piece_count; ++i) {
            lmb_cell_piece piece = own.piece[i];
            piece_move(stored, &piece);
        }
    }
    patches_move(stored, &own);
}

/* Pieces of a side follow each other, up to its last one, and sides come in their order. */
static bool pieces_are_sane(const lmb_surface_light *light)
{
    const uint32_t sides = 2 * light->cell_count;
    uint32_t next = 0;
    bool sane = true;
    for (uint32_t side = 0; side < sides && sane; ++side) {
        const uint32_t first = light->first_piece[side];
        if (first < LMB_SIDE_HOLE) {
            uint32_t count = 0;
            sane = first == next;
            do {
                sane = sane && next < light->piece_count && count < LMB_CELL_MOST_PIECES &&
                       light->piece[next].side == side;
                ++count;
            } while (sane && !light->piece[next++].last);
        }
    }
    return sane && next == light->piece_count;
}

static void pieces_read(lmb_stored *stored, lmb_surface_light *light)
{
    const size_t sides = 2 * (size_t)light->cell_count;
    light->first_piece = lmb_stored_array(stored, NULL, sides, sizeof *light->first_piece);
    light->piece = calloc((size_t)light->piece_count + 1, sizeof *light->piece);
    if (!light->piece) {
        stored->result = LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < light->piece_count && stored->result == LMB_OK; ++i) {
        piece_move(stored, &light->piece[i]);
    }
    if (stored->result != LMB_OK || !lmb_stored_expect(stored, pieces_are_sane(light))) {
        return;
    }
    for (uint32_t triangle = 0; triangle < light->triangle_count; ++triangle) {
        lmb_cell_grid *const grid = &light->grid[triangle];
        for (uint32_t side = 2 * grid->first; side < 2 * (grid + 1)->first && !grid->divided; ++side) {
            grid->divided = light->first_piece[side] != LMB_SIDE_WHOLE;
        }
    }
}

static bool openness_is_sane(const lmb_surface_light *light)
{
    bool sane = true;
    for (uint32_t patch = 0; patch < lmb_patch_count(light) && sane; ++patch) {
        sane = light->openness[patch] <= LMB_CELL_OPEN;
    }
    return sane;
}

static lmb_result light_read(lmb_surface_light *light, lmb_stored *stored)
{
    bool has_pieces = false, has_sun = false;
    head_move(stored, light, &has_pieces, &has_sun);
    if (stored->result == LMB_OK && has_pieces) {
        pieces_read(stored, light);
    }
    if (stored->result != LMB_OK) {
        return stored->result;
    }
    if (lmb_surface_light_allocate(light) != LMB_OK) {
        return LMB_ERROR_MEMORY;
    }
    if (has_sun) {
        light->sun = calloc((size_t)lmb_patch_count(light) + 1, sizeof *light->sun);
        if (!light->sun) {
            return LMB_ERROR_MEMORY;
        }
    }
    patches_move(stored, light);
    lmb_stored_expect(stored, openness_is_sane(light));
    return stored->result;
}

lmb_result lmb_surface_light_read(const lmb_transport *transport, const lmb_surface_light_settings *settings,
                                  lmb_pool *pool, lmb_stored *stored, lmb_surface_light **light, lmb_error *error)
{
    lmb_surface_light *read;
    lmb_result result =
        lmb_surface_light_create(transport->tracer, settings->cell_size, settings->max_cells, &read, error);
    if (result != LMB_OK) {
        return result;
    }
    if (transport->bounces != 0 && read->cell_count > 0) { /* as lmb_surface_light_solve has it */
        result = lmb_surface_light_find_albedos(read, transport->tracer, pool);
    }
    if (result == LMB_OK) {
        result = light_read(read, stored);
    }
    if (result == LMB_OK) {
        const bool aims = !lmb_emitters_go_without(transport->emitters, LMB_WITHOUT_CELL_AIM);
        result = lmb_surface_light_finish(read, transport->tracer, aims, pool);
    }
    if (result != LMB_OK) {
        lmb_surface_light_destroy(read);
        return lmb_error_set(error, result, "surface light: %s", lmb_result_text(result));
    }
    *light = read;
    return LMB_OK;
}
