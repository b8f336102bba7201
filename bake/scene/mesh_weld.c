#include "scene/mesh_weld.h"

#include <stdlib.h>
#include <string.h>

static uint32_t position_bits(float value)
{
    const float positive_zero = value + 0.0f; /* -0 and 0 are the same place */
    uint32_t bits;
    memcpy(&bits, &positive_zero, sizeof bits);
    return bits;
}

static uint32_t position_hash(lmb_vec3 p)
{
    uint32_t hash = 2166136261U;
    const uint32_t words[3] = {position_bits(p.x), position_bits(p.y), position_bits(p.z)};
    for (int i = 0; i < 3; ++i) {
        hash = (hash ^ words[i]) * 0x9e3779b1U;
        hash ^= hash >> 15;
    }
    return hash;
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
        size_t slot = position_hash(p) & (size - 1);
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
