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
    ranges->candidates = 0;
    for (int z = -1; z <= 1; ++z) {
        for (int y = -1; y <= 1; ++y) {
            /* Three along x follow each other. */
            const int64_t step = (int64_t)z * (INT64_C(1) << (2 * AXIS_BITS)) + (int64_t)y * (INT64_C(1) << AXIS_BITS);
            const uint64_t middle = cells->key[cell] + (uint64_t)step;
            const uint32_t begin = cell_from(cells, middle - 1), end = cell_from(cells, middle + 2);
            if (begin < end) {
                ranges->first[ranges->count] = cells->first[begin];
                ranges->end[ranges->count] = cells->first[end];
                ranges->candidates += ranges->end[ranges->count] - ranges->first[ranges->count];
                ++ranges->count;
            }
        }
    }
}

/* Of points that follow each other, which are neighbours of `point`. */
LMB_VECTORISED
static void points_test(const lmb_neighbour_cells *cells, const lmb_denoise_point *point, uint32_t first,
                        uint32_t count, int32_t *near)
{
    const float *const x = cells->x + first, *const y = cells->y + first, *const z = cells->z + first;
    const float *const nx = cells->nx + first, *const ny = cells->ny + first, *const nz = cells->nz + first;
    const lmb_vec3 p = point->position, n = point->normal;
    const float per_metre = 1.0f / point->spacing, reach_squared = cells->reach * cells->reach;
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

void lmb_neighbours_find(const lmb_neighbour_cells *cells, const lmb_neighbour_ranges *ranges, uint32_t rank,
                         lmb_neighbours *found)
{
    const lmb_denoise_point point = {{cells->x[rank], cells->y[rank], cells->z[rank]},
                                     {cells->nx[rank], cells->ny[rank], cells->nz[rank]},
                                     cells->spacing[rank]};
    uint32_t count = 0, candidate = 0;
    found->rank[count++] = rank;
    for (uint32_t range = 0; range < ranges->count; ++range) {
        for (uint32_t first = ranges->first[range]; first < ranges->end[range]; first += TESTED_AT_ONCE) {
            const uint32_t left = ranges->end[range] - first, tested = left < TESTED_AT_ONCE ? left : TESTED_AT_ONCE;
            int32_t near[TESTED_AT_ONCE];
            uint32_t kept[TESTED_AT_ONCE], kept_count = 0;
            points_test(cells, &point, first, tested, near);
            for (uint32_t i = 0; i < tested; ++i) { /* no branches: they would be guessed wrong half of the time */
                kept[kept_count] = i;
                kept_count += (uint32_t)near[i] & (first + i != rank);
            }
            for (uint32_t i = 0; i < kept_count && count < LMB_NEIGHBOURS_MOST; ++i) {
                found->rank[count] = first + kept[i];
                found->candidate[count++] = candidate + kept[i];
            }
            candidate += tested;
        }
    }
    found->count = count;
}

/* From where they are in space to where they are from the first of them. */
LMB_VECTORISED
static void steps_make(lmb_neighbours *found, lmb_vec3 position, const lmb_vec3 axis[3], float per_metre)
{
    float *const x = found->x, *const y = found->y, *const z = found->z, *const square = found->square;
    const lmb_vec3 a = axis[0], b = axis[1], c = axis[2];
    for (uint32_t i = 0; i < found->count; ++i) {
        const float sx = (x[i] - position.x) * per_metre;
        const float sy = (y[i] - position.y) * per_metre;
        const float sz = (z[i] - position.z) * per_metre;
        x[i] = sx * a.x + sy * a.y + sz * a.z;
        y[i] = sx * b.x + sy * b.y + sz * b.z;
        z[i] = sx * c.x + sy * c.y + sz * c.z;
        square[i] = sx * sx + sy * sy + sz * sz;
    }
}

void lmb_neighbours_place(const lmb_neighbour_cells *cells, lmb_neighbours *found)
{
    const uint32_t self = found->rank[0];
    const lmb_vec3 position = {cells->x[self], cells->y[self], cells->z[self]};
    const lmb_vec3 normal = {cells->nx[self], cells->ny[self], cells->nz[self]};
    found->flat = lmb_vec3_dot(normal, normal) > 0.0f;
    lmb_vec3 axis[3] = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    if (found->flat) {
        lmb_vec3_frame(normal, &axis[0], &axis[1]);
        axis[2] = lmb_vec3_of(0.0f, 0.0f, 0.0f);
    }
    for (uint32_t i = 0; i < found->count; ++i) {
        const uint32_t rank = found->rank[i];
        found->x[i] = cells->x[rank];
        found->y[i] = cells->y[rank];
        found->z[i] = cells->z[rank];
    }
    steps_make(found, position, axis, 1.0f / cells->spacing[self]);
}

void lmb_neighbours_within(const lmb_neighbours *found, float radius, lmb_neighbours_part *part)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < found->count; ++i) { /* no branches here either */
        part->place[kept] = i;
        kept += found->square[i] < radius * radius;
    }
    part->count = kept;
}
