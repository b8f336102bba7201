#include "denoise/neighbours.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

#include "base/vectorised.h"

/* Bits of a cell's key for each axis; the rest say how many octaves below the largest its points' spacing is. */
enum { AXIS_BITS = 20, OCTAVES = 16 };
#define LAST_CELL ((double)((1 << AXIS_BITS) - 2))

/* Neighbours lie on one surface: their normals differ by less than 26 degrees, and they are no farther off each other's
 * plane than a bend between those normals explains. */
#define LEAST_COSINE 0.9f
#define OFF_PLANE_SPACINGS 0.02f
#define OFF_PLANE_SLOPE 0.01f
#define OFF_PLANE_BEND 0.6f

enum { TESTED_AT_ONCE = 256 };

typedef struct keyed_point {
    uint64_t key;
    uint32_t element;
} keyed_point;

static int keyed_compare(const void *a, const void *b)
{
    const keyed_point *const p = a, *const q = b;
    if (p->key != q->key) {
        return p->key > q->key ? 1 : -1;
    }
    return (p->element > q->element) - (p->element < q->element);
}

static uint64_t cell_key(uint32_t octave, uint64_t x, uint64_t y, uint64_t z)
{
    return (uint64_t)octave << (3 * AXIS_BITS) | z << (2 * AXIS_BITS) | y << AXIS_BITS | x;
}

/* Cells of an axis are counted from 1, so that those beside them have keys too. */
static uint64_t cell_along(float position, float least, double edge)
{
    const double cell = ((double)position - (double)least) / edge;
    return 1 + (uint64_t)(cell < 0.0 ? 0.0 : cell < LAST_CELL ? cell : LAST_CELL);
}

static void keys_set(const lmb_denoise_point *points, uint32_t count, float reach, keyed_point *keyed)
{
    lmb_vec3 least = points[0].position;
    float largest = 0.0f;
    for (uint32_t i = 0; i < count; ++i) {
        least = lmb_vec3_smaller(least, points[i].position);
        largest = lmb_larger(largest, points[i].spacing);
    }
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t octave = 0;
        double edge = (double)reach * (double)largest;
        for (; octave + 1 < OCTAVES && (double)reach * (double)points[i].spacing <= 0.5 * edge; ++octave) {
            edge *= 0.5;
        }
        const lmb_vec3 p = points[i].position;
        keyed[i] = (keyed_point){cell_key(octave, cell_along(p.x, least.x, edge), cell_along(p.y, least.y, edge),
                                          cell_along(p.z, least.z, edge)),
                                 i};
    }
    qsort(keyed, count, sizeof *keyed, keyed_compare);
}

static void point_put(lmb_neighbour_cells *cells, uint32_t rank, const lmb_denoise_point *point)
{
    cells->x[rank] = point->position.x;
    cells->y[rank] = point->position.y;
    cells->z[rank] = point->position.z;
    cells->nx[rank] = point->normal.x;
    cells->ny[rank] = point->normal.y;
    cells->nz[rank] = point->normal.z;
    cells->spacing[rank] = point->spacing;
}

lmb_result lmb_neighbour_cells_make(const lmb_denoise_point *points, uint32_t count, float reach,
                                    lmb_neighbour_cells *cells)
{
    const size_t room = (size_t)count + 1;
    keyed_point *const keyed = malloc(room * sizeof *keyed);
    *cells = (lmb_neighbour_cells){.count = count,
                                   .element = malloc(room * sizeof *cells->element),
                                   .x = malloc(room * sizeof *cells->x),
                                   .y = malloc(room * sizeof *cells->y),
                                   .z = malloc(room * sizeof *cells->z),
                                   .nx = malloc(room * sizeof *cells->nx),
                                   .ny = malloc(room * sizeof *cells->ny),
                                   .nz = malloc(room * sizeof *cells->nz),
                                   .spacing = malloc(room * sizeof *cells->spacing),
                                   .key = malloc(room * sizeof *cells->key),
                                   .first = malloc(room * sizeof *cells->first),
                                   .reach = reach};
    if (!keyed || !cells->element || !cells->x || !cells->y || !cells->z || !cells->nx || !cells->ny || !cells->nz ||
        !cells->spacing || !cells->key || !cells->first) {
        free(keyed);
        lmb_neighbour_cells_free(cells);
        return LMB_ERROR_MEMORY;
    }
    if (count > 0) {
        keys_set(points, count, reach, keyed);
    }
    for (uint32_t rank = 0; rank < count; ++rank) {
        cells->element[rank] = keyed[rank].element;
        point_put(cells, rank, &points[keyed[rank].element]);
        if (rank == 0 || keyed[rank].key != keyed[rank - 1].key) {
            cells->key[cells->cell_count] = keyed[rank].key;
            cells->first[cells->cell_count++] = rank;
        }
    }
    cells->first[cells->cell_count] = count;
    free(keyed);
    return LMB_OK;
}

void lmb_neighbour_cells_free(lmb_neighbour_cells *cells)
{
    free(cells->element);
    free(cells->x);
    free(cells->y);
    free(cells->z);
    free(cells->nx);
    free(cells->ny);
    free(cells->nz);
    free(cells->spacing);
    free(cells->key);
    free(cells->first);
    *cells = (lmb_neighbour_cells){.count = 0};
}

/* The first cell whose key is not below this one. */
static uint32_t cell_from(const lmb_neighbour_cells *cells, uint64_t key)
{
    uint32_t low = 0, high = cells->cell_count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (cells->key[middle] < key) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

void lmb_neighbour_ranges_find(const lmb_neighbour_cells *cells, uint32_t cell, lmb_neighbour_ranges *ranges)
{
    ranges->count = 0;
    for (int z = -1; z <= 1; ++z) {
        for (int y = -1; y <= 1; ++y) {
            /* Three along x follow each other. */
            const int64_t step = (int64_t)z * (INT64_C(1) << (2 * AXIS_BITS)) + (int64_t)y * (INT64_C(1) << AXIS_BITS);
            const uint64_t middle = cells->key[cell] + (uint64_t)step;
            const uint32_t begin = cell_from(cells, middle - 1), end = cell_from(cells, middle + 2);
            if (begin < end) {
                ranges->first[ranges->count] = cells->first[begin];
                ranges->end[ranges->count++] = cells->first[end];
            }
        }
    }
}

/* Of points that follow each other, which are neighbours of `point`. */
LMB_VECTORISED
static void points_test(const lmb_neighbour_cells *cells, const lmb_denoise_point *point, uint32_t first,
                        uint32_t count, float reach, int32_t *near)
{
    const float *const x = cells->x + first, *const y = cells->y + first, *const z = cells->z + first;
    const float *const nx = cells->nx + first, *const ny = cells->ny + first, *const nz = cells->nz + first;
    const lmb_vec3 p = point->position, n = point->normal;
    const float per_metre = 1.0f / point->spacing, reach_squared = reach * reach;
    const float least_cosine = lmb_vec3_dot(n, n) > 0.0f ? LEAST_COSINE : 0.0f; /* in space all are 0 */
    for (uint32_t i = 0; i < count; ++i) {
        const float sx = (x[i] - p.x) * per_metre, sy = (y[i] - p.y) * per_metre, sz = (z[i] - p.z) * per_metre;
        const float square = sx * sx + sy * sy + sz * sz;
        const float cosine = n.x * nx[i] + n.y * ny[i] + n.z * nz[i];
        const float rest = 1.0f - cosine, bend = sqrtf(2.0f * (rest > 0.0f ? rest : 0.0f));
        const float most = OFF_PLANE_SPACINGS + sqrtf(square) * (OFF_PLANE_SLOPE + OFF_PLANE_BEND * bend);
        const float off = fabsf(sx * n.x + sy * n.y + sz * n.z);
        near[i] = (square < reach_squared) & (cosine >= least_cosine) & (off <= most);
    }
}

uint32_t lmb_neighbours_find(const lmb_neighbour_cells *cells, const lmb_neighbour_ranges *ranges, uint32_t rank,
                             float reach, lmb_neighbour found[LMB_NEIGHBOURS_MOST])
{
    const lmb_denoise_point point = {{cells->x[rank], cells->y[rank], cells->z[rank]},
                                     {cells->nx[rank], cells->ny[rank], cells->nz[rank]},
                                     cells->spacing[rank]};
    const float per_metre = 1.0f / point.spacing;
    const bool in_space = !(lmb_vec3_dot(point.normal, point.normal) > 0.0f);
    lmb_vec3 tangent, bitangent;
    lmb_vec3_frame(in_space ? lmb_vec3_of(0.0f, 0.0f, 1.0f) : point.normal, &tangent, &bitangent);
    uint32_t count = 0;
    found[count++] = (lmb_neighbour){.rank = rank};
    for (uint32_t range = 0; range < ranges->count; ++range) {
        for (uint32_t first = ranges->first[range]; first < ranges->end[range]; first += TESTED_AT_ONCE) {
            const uint32_t left = ranges->end[range] - first, tested = left < TESTED_AT_ONCE ? left : TESTED_AT_ONCE;
            int32_t near[TESTED_AT_ONCE];
            uint32_t kept[TESTED_AT_ONCE], kept_count = 0;
            points_test(cells, &point, first, tested, reach, near);
            for (uint32_t i = 0; i < tested; ++i) { /* no branches: they would be guessed wrong half of the time */
                kept[kept_count] = first + i;
                kept_count += (uint32_t)near[i] & (first + i != rank);
            }
            for (uint32_t i = 0; i < kept_count && count < LMB_NEIGHBOURS_MOST; ++i) {
                const lmb_vec3 at = {cells->x[kept[i]], cells->y[kept[i]], cells->z[kept[i]]};
                const lmb_vec3 step = lmb_vec3_scale(lmb_vec3_sub(at, point.position), per_metre);
                found[count++] = (lmb_neighbour){kept[i], lmb_vec3_dot(step, tangent), lmb_vec3_dot(step, bitangent),
                                                 in_space ? step.z : 0.0f, lmb_vec3_dot(step, step)};
            }
        }
    }
    return count;
}
