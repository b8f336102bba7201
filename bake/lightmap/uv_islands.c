/* How many islands lightmap UVs have, and how many of them are small. */
#include "lightmap/uv_islands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double triangle_uv_area(lmb_vec2 a, lmb_vec2 b, lmb_vec2 c)
{
    return 0.5 * fabs(((double)b.x - (double)a.x) * ((double)c.y - (double)a.y) -
                      ((double)b.y - (double)a.y) * ((double)c.x - (double)a.x));
}

/* Islands without any area are none. */
static lmb_uv_islands islands_count(const double *area, size_t count, double small_uv_area)
{
    lmb_uv_islands islands = {0, 0, 0.0};
    double all = 0.0, small = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const bool is_small = area[i] < small_uv_area;
        islands.count += area[i] > 0.0;
        islands.small_count += area[i] > 0.0 && is_small;
        all += area[i];
        small += is_small ? area[i] : 0.0;
    }
    islands.small_share = all > 0.0 ? small / all : 0.0;
    return islands;
}

lmb_result lmb_uv_islands_of_charts(const lmb_charts *charts, uint32_t triangle_count, double small_uv_area,
                                    lmb_uv_islands *islands)
{
    double *const area = calloc((size_t)charts->chart_count + 1u, sizeof *area);
    if (!area) {
        return LMB_ERROR_MEMORY;
    }
    for (size_t t = 0; t < triangle_count; ++t) {
        const lmb_vec2 *const uv = &charts->corner_uv[3 * t];
        area[charts->chart[t]] += triangle_uv_area(uv[0], uv[1], uv[2]);
    }
    *islands = islands_count(area, charts->chart_count, small_uv_area);
    free(area);
    return LMB_OK;
}

static uint32_t root_find(uint32_t *parent, uint32_t item)
{
    while (parent[item] != item) {
        parent[item] = parent[parent[item]]; /* halves the way for the next one */
        item = parent[item];
    }
    return item;
}

static size_t uv_hash(lmb_vec2 uv)
{
    const float parts[2] = {uv.x + 0.0f, uv.y + 0.0f}; /* -0 and 0 are the same place */
    uint64_t bits;
    memcpy(&bits, parts, sizeof bits);
    bits *= UINT64_C(0x9e3779b97f4a7c15);
    return (size_t)(bits ^ bits >> 32);
}

/* Makes vertices with equal UVs one: normals or materials may split them where the island goes on. False: no memory. */
static bool vertices_weld(const lmb_mesh *mesh, uint32_t *parent)
{
    size_t size = 16;
    while (size < 2 * (size_t)mesh->vertex_count) {
        size *= 2;
    }
    uint32_t *const table = calloc(size, sizeof *table); /* vertex + 1, or 0 */
    for (uint32_t v = 0; table && v < mesh->vertex_count; ++v) {
        const lmb_vec2 uv = mesh->uv[1][v];
        size_t slot = uv_hash(uv) & (size - 1);
        while (table[slot] != 0 &&
               !(mesh->uv[1][table[slot] - 1].x == uv.x && mesh->uv[1][table[slot] - 1].y == uv.y)) {
            slot = (slot + 1) & (size - 1);
        }
        parent[v] = table[slot] != 0 ? table[slot] - 1 : v;
        table[slot] = table[slot] != 0 ? table[slot] : v + 1;
    }
    free(table);
    return table != NULL;
}

lmb_result lmb_uv_islands_find(const lmb_mesh *mesh, double small_uv_area, lmb_uv_islands *islands)
{
    uint32_t *const parent = malloc(((size_t)mesh->vertex_count + 1u) * sizeof *parent);
    double *const area = calloc((size_t)mesh->vertex_count + 1u, sizeof *area); /* of the island whose root it is */
    const bool enough = parent && area && vertices_weld(mesh, parent);
    for (uint32_t t = 0; enough && t < mesh->triangle_count; ++t) {
        const uint32_t root = root_find(parent, mesh->triangle[t][0]);
        for (int k = 1; k < 3; ++k) {
            parent[root_find(parent, mesh->triangle[t][k])] = root;
        }
    }
    for (uint32_t t = 0; enough && t < mesh->triangle_count; ++t) {
        const uint32_t *const v = mesh->triangle[t];
        area[root_find(parent, v[0])] += triangle_uv_area(mesh->uv[1][v[0]], mesh->uv[1][v[1]], mesh->uv[1][v[2]]);
    }
    if (enough) {
        *islands = islands_count(area, mesh->vertex_count, small_uv_area);
    }
    free(parent);
    free(area);
    return enough ? LMB_OK : LMB_ERROR_MEMORY;
}
