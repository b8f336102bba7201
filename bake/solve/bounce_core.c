#include "solve/bounce_core.h"

#include <stdlib.h>
#include <string.h>

/* Moves rows that nobody sees to the end of `order`, the first found last, and with them those that nobody else sees.
 * `seen` is [row] by how many links. @return how many are left */
static uint32_t rest_find(const lmb_bounce_rows *rows, uint32_t *seen, uint32_t *order)
{
    uint32_t found = rows->count; /* order[found] and after: not seen by any that are left */
    for (uint32_t i = 0; i < rows->count; ++i) {
        if (seen[i] == 0) {
            order[--found] = i;
        }
    }
    for (uint32_t next = rows->count; next > found; --next) {
        const uint32_t row = order[next - 1];
        for (size_t k = rows->first[row]; k < rows->first[row + 1]; ++k) {
            if (--seen[rows->links[k].target] == 0) {
                order[--found] = rows->links[k].target;
            }
        }
    }
    return found;
}

static void links_fill(const lmb_bounce_rows *rows, const uint32_t *core_row, lmb_bounce_core *core)
{
    size_t count = 0;
    for (uint32_t i = 0; i < core->count; ++i) {
        const uint32_t row = core->order[i];
        core->first[i] = count;
        core->samples[i] = rows->samples[row];
        core->direct[i] = rows->light[row];
        for (size_t k = rows->first[row]; k < rows->first[row + 1]; ++k) {
            const lmb_link *link = &rows->links[k];
            core->links[count++] = (lmb_core_link){
                core_row[link->target], {(float)link->weight[0], (float)link->weight[1], (float)link->weight[2]}};
        }
    }
    core->first[core->count] = count;
}

static lmb_result core_fill(const lmb_bounce_rows *rows, bool all, uint32_t *seen, lmb_bounce_core *core)
{
    for (size_t k = 0; k < rows->first[rows->count] && !all; ++k) {
        ++seen[rows->links[k].target];
    }
    core->count = all ? rows->count : rest_find(rows, seen, core->order);
    size_t links = 0;
    for (uint32_t i = 0, next = 0; i < rows->count; ++i) {
        if (all || seen[i] > 0) {
            core->order[next] = i;
            links += rows->first[i + 1] - rows->first[i];
            seen[i] = next++;
        }
    }
    core->first = malloc(((size_t)core->count + 1) * sizeof *core->first);
    core->links = malloc((links + 1) * sizeof *core->links);
    core->samples = malloc(((size_t)core->count + 1) * sizeof *core->samples);
    core->direct = malloc(((size_t)core->count + 1) * sizeof *core->direct);
    if (!core->first || !core->links || !core->samples || !core->direct) {
        return LMB_ERROR_MEMORY;
    }
    links_fill(rows, seen, core);
    return LMB_OK;
}

lmb_result lmb_bounce_core_make(const lmb_bounce_rows *rows, bool all, lmb_bounce_core *core)
{
    uint32_t *const seen = calloc((size_t)rows->count + 1, sizeof *seen);
    *core = (lmb_bounce_core){.order = malloc(((size_t)rows->count + 1) * sizeof *core->order)};
    const lmb_result result = seen && core->order ? core_fill(rows, all, seen, core) : LMB_ERROR_MEMORY;
    free(seen);
    return result;
}

void lmb_bounce_core_free(lmb_bounce_core *core)
{
    free(core->first);
    free(core->links);
    free(core->samples);
    free(core->direct);
    free(core->order);
    *core = (lmb_bounce_core){.count = 0};
}

void lmb_bounce_core_spread(const lmb_bounce_core *core, const lmb_bounce_rows *rows, const lmb_rgb *light)
{
    for (uint32_t i = 0; i < core->count; ++i) {
        rows->light[core->order[i]] = light[i];
    }
    for (uint32_t i = core->count; i < rows->count; ++i) {
        const uint32_t row = core->order[i];
        for (size_t k = rows->first[row]; k < rows->first[row + 1]; ++k) {
            const lmb_link *link = &rows->links[k];
            for (int c = 0; c < 3; ++c) {
                const float weight = (float)link->weight[c] / (65535.0f * rows->samples[row]);
                rows->light[row].c[c] += weight * rows->light[link->target].c[c];
            }
        }
    }
}

size_t lmb_bounce_core_bytes(uint32_t rows, size_t links)
{
    const lmb_bounce_core core = {.count = rows};
    return links * sizeof *core.links +
           rows * (sizeof *core.first + sizeof *core.samples + sizeof *core.direct + 2 * sizeof *core.order);
}
