#include "leaks_methods.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/pack.h>

/* The finest level that is made, of the field's spacing, and in metres. */
#define LEVELS_FINEST 0.125f
#define LEVELS_FINEST_M 0.125f

static lmb_result trilinear_prepare(const leaks_field *field, void **state, size_t *bytes)
{
    *state = field->volume;
    *bytes = field->packed_bytes;
    return LMB_OK;
}

static void trilinear_sample(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance)
{
    (void)normal;
    lmb_volume_sample(state, position, radiance);
}

const leaks_method leaks_trilinear = {
    .name = "trilinear",
    .about = "eight probes, whatever is between",
    .prepare = trilinear_prepare,
    .sample = trilinear_sample,
};

/* The bake as a game has it. */
typedef struct game_volume {
    lmb_volume *volume;
    unsigned char *packed;
} game_volume;

static void regions_release(void *state)
{
    game_volume *const game = state;
    lmb_volume_close(game->volume);
    free(game->packed);
    free(game);
}

static lmb_result game_prepare(const lmb_probes *probes, void **state, size_t *bytes)
{
    game_volume *const game = calloc(1, sizeof *game);
    lmb_result result = LMB_ERROR_MEMORY;
    if (game) {
        result = lmb_pack(probes, &game->packed, bytes, NULL);
    }
    if (result == LMB_OK) {
        result = lmb_volume_open_memory(game->packed, *bytes, &game->volume);
    }
    if (result != LMB_OK && game) {
        regions_release(game);
        return result;
    }
    *state = game;
    return result;
}

static lmb_result regions_prepare(const leaks_field *field, void **state, size_t *bytes)
{
    return game_prepare(field->bake.probes, state, bytes);
}

static void regions_sample(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance)
{
    (void)normal;
    lmb_volume_sample(((const game_volume *)state)->volume, position, radiance);
}

const leaks_method leaks_regions = {
    .name = "regions",
    .about = "cells cut into regions, eight values each: probes, or ghosts fitted to light inside",
    .prepare = regions_prepare,
    .sample = regions_sample,
    .release = regions_release,
};

/* Levels from the field's spacing down, of the tolerance of the field's settings. */
static lmb_result levels_prepare(const leaks_field *field, void **state, size_t *bytes)
{
    lmb_bake_settings settings = field->bake.record.settings;
    settings.min_spacing = fmaxf(LEVELS_FINEST * settings.spacing, LEVELS_FINEST_M);
    lmb_bake bake = lmb_bake_begin(&settings, field->bake.level, NULL);
    lmb_error error;
    lmb_result result = lmb_bake_place(&bake, &error);
    if (result == LMB_OK) {
        result = lmb_bake_levels(&bake, &error);
    }
    if (result == LMB_OK) {
        result = lmb_bake_probes(&bake, &error);
    }
    if (result == LMB_OK) {
        result = game_prepare(bake.probes, state, bytes);
    }
    lmb_bake_end(&bake);
    return result;
}

const leaks_method leaks_levels = {
    .name = "levels",
    .about = "regions, and levels where light changes fast, down to an eighth of the spacing or 0.125 m",
    .prepare = levels_prepare,
    .sample = regions_sample,
    .release = regions_release,
};

static const leaks_method *const methods[] = {
    &leaks_trilinear, &leaks_masked, &leaks_masked_exact, &leaks_chebyshev, &leaks_regions, &leaks_levels,
};

const leaks_method *const *leaks_methods(size_t *count)
{
    *count = sizeof methods / sizeof methods[0];
    return methods;
}

const leaks_method *leaks_method_find(const char *name)
{
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; ++i) {
        if (strcmp(methods[i]->name, name) == 0) {
            return methods[i];
        }
    }
    return NULL;
}
