/* All of a lightmap at once. */
#include <stdlib.h>

#include "lightmap/lightmap_internal.h"

lmb_result lmb_lightmap_bake(lmb_lightmap *lightmap, const lmb_transport *transport, const lmb_gather_effort *effort,
                             lmb_pool *pool, const lmb_progress *progress, lmb_gather_stats *stats)
{
    lmb_texel_list *list;
    lmb_result result = lmb_texel_list_create(lightmap, transport, effort, &list);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_gather_list elements = lmb_texel_list_elements(list);
    lmb_gathered *gathered = malloc((elements.count + 1) * sizeof *gathered);
    result = LMB_ERROR_MEMORY;
    if (gathered) {
        const lmb_gather_job job = lmb_gather_job_all(transport, &elements, effort);
        result = lmb_gather_elements(&job, pool, progress, gathered, stats);
    }
    if (result == LMB_OK) {
        result = lmb_texel_list_finish(list, gathered, pool, lightmap);
    }
    free(gathered);
    lmb_texel_list_destroy(list);
    return result;
}

lmb_result lmb_lightmap_mark(lmb_lightmap *lightmap)
{
    lmb_texel_source *source = malloc(lmb_lightmap_largest_region(lightmap) * sizeof *source);
    if (!source) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const lmb_lightmap_region *region = &lightmap->region[i];
        if (region->image < 0) {
            continue;
        }
        const lmb_lightmap_image *image = &lightmap->image[region->image];
        const uint32_t mesh = lightmap->scene->instances[i].mesh;
        const lmb_texel_grid grid = lmb_lightmap_grid(lightmap, i);
        lmb_texels_cover(&lightmap->scene->meshes[mesh], lightmap->corner_uv[mesh], &grid, source);
        const int32_t padding = lightmap->settings.padding;
        for (int32_t y = -padding; y < grid.height + padding; ++y) {
            for (int32_t x = -padding; x < grid.width + padding; ++x) {
                const bool covered = x >= 0 && y >= 0 && x < grid.width && y < grid.height &&
                                     source[(size_t)y * (size_t)grid.width + (size_t)x].triangle != LMB_TEXEL_UNCOVERED;
                const size_t at = (size_t)(region->y + y) * (size_t)image->width + (size_t)(region->x + x);
                image->state[at] = covered ? LMB_TEXEL_GATHERED : LMB_TEXEL_DILATED;
            }
        }
    }
    free(source);
    return LMB_OK;
}
