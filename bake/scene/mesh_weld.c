#include "scene/mesh_weld.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

static uint64_t position_hash(lmb_vec3 p)
{
    const float positive_zero[3] = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}; /* -0 and 0 are the same position */
    return lmb_hash(LMB_HASH_SEED, positive_zero, sizeof positive_zero);
}

bool lmb_mesh_weld(const lmb_mesh *mesh, uint32_t *weld)
{
    size_t size = 16;
    while (size < 2 * (size_t)mesh->vertex_count) {
        size *= 2;
    }
    uint32_t *const table = malloc(size * sizeof *table); /* vertex + 1, or 0 */
    if (!table) {
        return false;
    }
    memset(table, 0, size * sizeof *table);
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        const lmb_vec3 p = mesh->position[v];
        size_t slot = (size_t)position_hash(p) & (size - 1);
        weld[v] = v;
        while (table[slot] != 0) {
            const lmb_vec3 q = mesh->position[table[slot] - 1];
            if (p.x == q.x && p.y == q.y && p.z == q.z) {
                weld[v] = table[slot] - 1;
                break;
            }
            slot = (slot + 1) & (size - 1);
        }
        if (weld[v] == v) {
            table[slot] = v + 1;
        }
    }
    free(table);
    return true;
}
