/* Solving E = D + T E: direct light D and the transport T by samples, then the bounces by multiplying. */
#include <lambent/surface_solve.h>

#include <stdlib.h>

#include <lambent/vector.h>

#include "light/emitters_internal.h"
#include "solve/light_rows.h"
#include "solve/surface_divide.h"
#include "surface/surface_light_internal.h"

/* Of patches that stay dark. */
#define NO_ROW UINT32_MAX

/* Numbers the lit patches from 0 without gaps, and gives how many there are. */
static uint32_t rows_number(const lmb_light_rows *rows, uint32_t *row_of)
{
    uint32_t count = 0;
    for (uint32_t patch = 0; patch < rows->patch_count; ++patch) {
        row_of[patch] = rows->row[patch] < rows->row[patch + 1] ? count++ : NO_ROW;
    }
    return count;
}

/* Moves what the patches have to their rows: the links that see something lit, of mixed ones only those of open
 * samples. `samples` has room for every row_of. */
static lmb_bounce_rows rows_compact(lmb_light_rows *rows, const uint32_t *row_of, float *samples)
{
    lmb_bounce_rows compact = {.first = rows->row, .samples = samples, .light = rows->direct};
    size_t kept = 0, begin = 0;
    for (uint32_t patch = 0; patch < rows->patch_count; ++patch) {
        const size_t end = rows->row[patch + 1];
        if (row_of[patch] != NO_ROW) {
            const bool mixed = rows->light->openness[patch] == LMB_CELL_MIXED;
            const lmb_rgb direct = mixed ? rows->open_direct[patch] : rows->direct[patch];
            rows->row[compact.count] = kept;
            for (size_t k = begin; k < end; ++k) {
                lmb_link link = rows->links[k];
                link.target = row_of[link.target];
                if (link.target != NO_ROW && lmb_link_weight(&link) > 0 && (link.open || !mixed)) {
                    rows->links[kept++] = link;
                }
            }
            const size_t counted = mixed ? lmb_links_open(rows->links + begin, rows->links + end) : end - begin;
            samples[compact.count] = (float)counted;
            rows->direct[compact.count] = lmb_rgb_scale(direct, 1.0f / samples[compact.count]);
            ++compact.count;
        }
        begin = end;
    }
    rows->row[compact.count] = kept;
    lmb_link *shorter = realloc(rows->links, (kept + 1) * sizeof *shorter);
    rows->links = shorter ? shorter : rows->links;
    compact.links = rows->links;
    return compact;
}

static lmb_result rows_bounce(lmb_light_rows *rows, lmb_pool *pool, const lmb_progress *progress, int *passes)
{
    const int bounces = rows->transport->bounces;
    uint32_t *row_of = malloc((rows->patch_count + 1u) * sizeof *row_of);
    const uint32_t count = row_of ? rows_number(rows, row_of) : 0;
    float *samples = malloc((count + 1u) * sizeof *samples);
    lmb_result result = LMB_ERROR_MEMORY;
    if (row_of && samples) {
        const lmb_bounce_rows compact = rows_compact(rows, row_of, samples);
        free(rows->open_direct);
        rows->open_direct = NULL;
        const size_t links = compact.first[compact.count];
        lmb_light_rows_count_bytes(rows, links,
                                   rows->patch_count * sizeof *row_of + count * sizeof *samples +
                                       lmb_bounces_bytes(count, links));
        /* The last bounce is that on the surface that is looked at. */
        result = lmb_bounces_sum(&compact, bounces < 0 ? -1 : bounces - 1, pool, progress, passes);
        for (uint32_t patch = 0; patch < rows->patch_count; ++patch) {
            rows->light->irradiance[patch] =
                row_of[patch] != NO_ROW ? compact.light[row_of[patch]] : lmb_rgb_of(0.0f, 0.0f, 0.0f);
        }
    }
    free(row_of);
    free(samples);
    return result;
}

static lmb_result rows_solve(lmb_light_rows *rows, uint32_t samples, lmb_pool *pool, const lmb_progress *progress,
                             int *passes)
{
    lmb_result result = lmb_surface_light_find_albedos(rows->light, rows->transport->tracer, pool);
    if (result == LMB_OK) {
        result = lmb_surface_light_divide(rows->light, rows->transport, pool, &rows->rays);
    }
    if (result == LMB_OK) {
        result = lmb_surface_light_allocate(rows->light);
    }
    if (result == LMB_OK) {
        result = lmb_light_rows_sample(rows, samples, pool, progress);
    }
    return result == LMB_OK ? rows_bounce(rows, pool, progress, passes) : result;
}

lmb_surface_light_settings lmb_surface_light_settings_default(void)
{
    return (lmb_surface_light_settings){.max_cells = 32768}; /* by lambent_convergence, `cells` */
}

lmb_result lmb_surface_light_solve(const lmb_transport *transport, const lmb_surface_light_settings *settings,
                                   lmb_pool *pool, lmb_surface_light **light, lmb_surface_light_stats *stats,
                                   lmb_error *error)
{
    lmb_surface_light *created;
    lmb_result result =
        lmb_surface_light_create(transport->tracer, settings->cell_size, settings->max_cells, &created, error);
    if (result != LMB_OK) {
        return result;
    }
    lmb_transport solving = *transport;
    solving.surface = created; /* of which the albedos are known */
    lmb_light_rows rows = {.transport = &solving, .light = created};
    int passes = 0;
    /* Without reflections nobody looks at what surfaces receive. */
    if (transport->bounces != 0 && created->cell_count > 0) {
        const uint32_t samples = settings->samples > 0 ? settings->samples : LMB_ROWS_SAMPLES;
        result = rows_solve(&rows, samples, pool, settings->progress, &passes);
    } else {
        result = lmb_surface_light_allocate(created);
    }
    lmb_light_rows_free(&rows);
    if (result == LMB_OK) {
        const bool aims = !lmb_emitters_go_without(transport->emitters, LMB_WITHOUT_CELL_AIM);
        result = lmb_surface_light_finish(created, transport->tracer, aims, pool);
    }
    if (result != LMB_OK) {
        lmb_surface_light_destroy(created);
        return lmb_error_set(error, result, "surface light: %s", lmb_result_text(result));
    }
    *light = created;
    *stats = (lmb_surface_light_stats){.cells = created->cell_count,
                                       .lit_sides = rows.lit_patches,
                                       .passes = passes,
                                       .rays = rows.rays,
                                       .bytes_solving = rows.most_bytes};
    return LMB_OK;
}
