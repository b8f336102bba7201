#include "lightmap/chart_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/mesh_weld.h"

/* A triangle lower than this part of its longest side has no normal to speak of, in float positions. */
static const double FLATTEST = 1e-6;
/* Vertex normals that are further apart than 40 degrees make a hard edge. */
static const double HARD_EDGE_COS = 0.76604444311897804;

/* An edge of a triangle, between welded vertices low < high. */
typedef struct half_edge {
    uint32_t low, high;
    uint32_t triangle;
    uint8_t corner;
    uint8_t forward; /* 1: runs from low to high */
    uint8_t taken;
} half_edge;

static void difference(lmb_vec3 a, lmb_vec3 b, double d[3])
{
    d[0] = (double)a.x - (double)b.x;
    d[1] = (double)a.y - (double)b.y;
    d[2] = (double)a.z - (double)b.z;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void triangle_measure(const lmb_mesh *mesh, uint32_t t, double normal[3], double *area)
{
    const uint32_t *const v = mesh->triangle[t];
    double u[3];
    double w[3];
    double third[3];
    difference(mesh->position[v[1]], mesh->position[v[0]], u);
    difference(mesh->position[v[2]], mesh->position[v[0]], w);
    difference(mesh->position[v[2]], mesh->position[v[1]], third);
    const double cross[3] = {u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]};
    const double length = sqrt(dot(cross, cross));
    const double longest = fmax(dot(u, u), fmax(dot(w, w), dot(third, third)));
    const bool flat = !(length > FLATTEST * longest);
    *area = flat ? 0.0 : 0.5 * length;
    for (int i = 0; i < 3; ++i) {
        normal[i] = flat ? 0.0 : cross[i] / length;
    }
}

static int half_edge_compare(const void *a, const void *b)
{
    const half_edge *const p = a;
    const half_edge *const q = b;
    if (p->low != q->low) {
        return p->low < q->low ? -1 : 1;
    }
    if (p->high != q->high) {
        return p->high < q->high ? -1 : 1;
    }
    if (p->triangle != q->triangle) {
        return p->triangle < q->triangle ? -1 : 1;
    }
    return (p->corner > q->corner) - (p->corner < q->corner);
}

static bool normals_are_close(lmb_vec3 a, lmb_vec3 b)
{
    return (double)a.x * (double)b.x + (double)a.y * (double)b.y + (double)a.z * (double)b.z >= HARD_EDGE_COS;
}

/* Whether shading runs on across the edge, at both of its ends. */
static bool edge_is_soft(const lmb_mesh *mesh, const half_edge *p, const half_edge *q)
{
    const uint32_t *const a = mesh->triangle[p->triangle];
    const uint32_t *const b = mesh->triangle[q->triangle];
    return normals_are_close(mesh->normal[a[p->corner]], mesh->normal[b[(q->corner + 1) % 3]]) &&
           normals_are_close(mesh->normal[a[(p->corner + 1) % 3]], mesh->normal[b[q->corner]]);
}

/* Pairs the triangles around one edge, each with the one that continues it best. Walls that are modelled twice, back
 * to back, have four; edges where very many meet are left open. */
static void edges_pair(const lmb_mesh *mesh, half_edge *edges, size_t count, chart_mesh *out)
{
    if (count > 16) {
        return;
    }
    for (size_t i = 0; i < count; ++i) {
        half_edge *best = NULL;
        double best_cos = -2.0;
        for (size_t j = 0; j < count && edges[i].forward; ++j) {
            const double cosine = dot(out->normal[edges[i].triangle], out->normal[edges[j].triangle]);
            if (!edges[j].forward && !edges[j].taken && cosine > best_cos) {
                best = &edges[j];
                best_cos = cosine;
            }
        }
        if (best) {
            best->taken = 1;
            out->across[edges[i].triangle][edges[i].corner] = best->triangle;
            out->across[best->triangle][best->corner] = edges[i].triangle;
            if (edge_is_soft(mesh, &edges[i], best)) {
                out->neighbour[edges[i].triangle][edges[i].corner] = best->triangle;
                out->neighbour[best->triangle][best->corner] = edges[i].triangle;
            }
        }
    }
}

static half_edge half_edge_of(const lmb_mesh *mesh, const uint32_t *weld, uint32_t triangle, uint8_t corner)
{
    const uint32_t from = weld[mesh->triangle[triangle][corner]];
    const uint32_t to = weld[mesh->triangle[triangle][(corner + 1) % 3]];
    return (half_edge){from < to ? from : to, from < to ? to : from, triangle, corner, from < to, 0};
}

/* The edges of triangles that have area, in order: first by their lower vertex, of which each has few. `first` has room
 * for every vertex and one more. Returns how many. */
static size_t half_edges_sort(const lmb_mesh *mesh, const chart_mesh *out, size_t *first, half_edge *edges)
{
    memset(first, 0, (mesh->vertex_count + (size_t)1) * sizeof *first);
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        for (uint8_t c = 0; c < 3 && out->area[t] > 0.0; ++c) {
            ++first[half_edge_of(mesh, out->weld, t, c).low + 1];
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        first[v + 1] += first[v];
    }
    const size_t count = first[mesh->vertex_count];
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        for (uint8_t c = 0; c < 3 && out->area[t] > 0.0; ++c) {
            const half_edge edge = half_edge_of(mesh, out->weld, t, c);
            edges[first[edge.low]++] = edge;
        }
    }
    /* Each vertex' first is where the next one's was. */
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        const size_t begin = v > 0 ? first[v - 1] : 0;
        qsort(edges + begin, first[v] - begin, sizeof *edges, half_edge_compare);
    }
    return count;
}

lmb_result lmb_chart_mesh_make(const lmb_mesh *mesh, chart_mesh *out)
{
    const size_t triangles = mesh->triangle_count;
    *out = (chart_mesh){.triangle_count = mesh->triangle_count};
    out->weld = malloc((mesh->vertex_count + (size_t)1) * sizeof *out->weld);
    out->neighbour = malloc((triangles + 1) * sizeof *out->neighbour);
    out->across = malloc((triangles + 1) * sizeof *out->across);
    out->normal = malloc((triangles + 1) * sizeof *out->normal);
    out->area = malloc((triangles + 1) * sizeof *out->area);
    half_edge *const edges = malloc((3 * triangles + 1) * sizeof *edges);
    size_t *const firsts = malloc((mesh->vertex_count + (size_t)1) * sizeof *firsts);
    if (!out->weld || !out->neighbour || !out->across || !out->normal || !out->area || !edges || !firsts ||
        !lmb_mesh_weld(mesh, out->weld)) {
        free(edges);
        free(firsts);
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        triangle_measure(mesh, t, out->normal[t], &out->area[t]);
        for (int e = 0; e < 3; ++e) {
            out->neighbour[t][e] = out->across[t][e] = -1;
        }
    }
    const size_t count = half_edges_sort(mesh, out, firsts, edges);
    for (size_t first = 0; first < count;) {
        size_t end = first + 1;
        while (end < count && edges[end].low == edges[first].low && edges[end].high == edges[first].high) {
            ++end;
        }
        edges_pair(mesh, edges + first, end - first, out);
        first = end;
    }
    free(edges);
    free(firsts);
    return LMB_OK;
}

void lmb_chart_mesh_free(chart_mesh *mesh)
{
    free(mesh->weld);
    free(mesh->neighbour);
    free(mesh->across);
    free(mesh->normal);
    free(mesh->area);
    *mesh = (chart_mesh){0};
}
