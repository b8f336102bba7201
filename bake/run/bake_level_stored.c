/* A level's solved light in a file. */
#include "run/bake_level_internal.h"

#include "base/clock.h"
#include "solve/surface_stored.h"

static void stats_move(lmb_stored *stored, lmb_surface_light_stats *stats)
{
    uint64_t bytes = stats->bytes_solving;
    LMB_STORED(stored, stats->cells);
    LMB_STORED(stored, stats->lit_sides);
    LMB_STORED(stored, stats->passes);
    LMB_STORED(stored, stats->rays);
    LMB_STORED(stored, bytes);
    stats->bytes_solving = (size_t)bytes;
}

void lmb_level_write_surface(const lmb_level *level, lmb_stored *stored)
{
    uint8_t is_solved = level->surface != NULL;
    LMB_STORED(stored, is_solved);
    if (is_solved) {
        lmb_surface_light_stats stats = level->surface_stats;
        stats_move(stored, &stats);
        lmb_surface_light_write(level->surface, stored);
    }
}

lmb_result lmb_level_read_surface(lmb_level *level, lmb_stored *stored, lmb_error *error)
{
    const double start = lmb_clock_seconds();
    uint8_t is_solved;
    LMB_STORED(stored, is_solved);
    if (stored->result != LMB_OK || !is_solved) {
        return stored->result;
    }
    lmb_surface_light_stats stats;
    lmb_surface_light *light;
    stats_move(stored, &stats);
    const lmb_surface_light_settings settings = lmb_surface_light_settings_default();
    const lmb_result result = lmb_surface_light_read(&level->transport, &settings, level->pool, stored, &light, error);
    if (result == LMB_OK) {
        level->surface_stats = stats;
        lmb_level_take_surface(level, light);
    }
    level->seconds_surface = lmb_clock_seconds() - start;
    return result;
}
