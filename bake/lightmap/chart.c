#include "lightmap/chart_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Faces lean at most 45 degrees from their chart's mean normal: none is flattened to less than 0.7 of its size. */
static const double MAX_LEAN_COS = 0.70710678118654752;

enum { LEAF_SIZE = 4, NONE = -1 };

typedef struct flat_triangle {
    chart_vec2 p[3]; /* counter-clockwise */
} flat_triangle;

typedef struct bounds {
    chart_vec2 low, high;
} bounds;

typedef struct ranked {
    double size;
    uint32_t triangle;
} ranked;

typedef struct coded {
    uint32_t morton;
    uint32_t member;
} coded;

typedef enum member_state { MEMBER_WAITING, MEMBER_ACCEPTED, MEMBER_REFUSED } member_state;

/* Everything that growing needs, allocated once. `members` are the triangles that the chart at hand may take. */
typedef struct grower {
    const lmb_mesh *mesh;
    chart_mesh faces;
    double overlap;  /* CHART_OVERLAP_TEXELS in units of the mesh */
    uint32_t *chart; /* [triangle] UINT32_MAX: none yet */
    uint32_t *visit; /* [triangle] number of the walk that met it last */
    uint32_t walk;
    uint32_t *members;    /* [member] triangle */
    uint32_t *member_of;  /* [triangle] member, where `visit` is the last walk */
    flat_triangle *flat;  /* [member] */
    unsigned char *state; /* [member] member_state */
    uint32_t *queue;      /* [member] */
    coded *order;         /* [member] sorted along a Morton curve: the leaves of the tree, LEAF_SIZE at a time */
    bounds *nodes;        /* binary tree: children of i are 2 i and 2 i + 1, leaves start at leaf_count */
    uint32_t leaf_count;  /* a power of two */
    uint32_t member_count;
} grower;

static void grower_free(grower *g)
{
    lmb_chart_mesh_free(&g->faces);
    free(g->chart);
    free(g->visit);
    free(g->members);
    free(g->member_of);
    free(g->flat);
    free(g->state);
    free(g->queue);
    free(g->order);
    free(g->nodes);
}

static lmb_result grower_make(const lmb_mesh *mesh, float texels_per_m, grower *g)
{
    const size_t count = mesh->triangle_count;
    size_t leaves = 1;
    while (leaves * LEAF_SIZE < count) {
        leaves *= 2;
    }
    *g = (grower){.mesh = mesh, .overlap = CHART_OVERLAP_TEXELS / (double)texels_per_m};
    g->chart = malloc(count * sizeof *g->chart);
    g->visit = calloc(count, sizeof *g->visit);
    g->members = malloc(count * sizeof *g->members);
    g->member_of = malloc(count * sizeof *g->member_of);
    g->flat = malloc(count * sizeof *g->flat);
    g->state = malloc(count * sizeof *g->state);
    g->queue = malloc(count * sizeof *g->queue);
    g->order = malloc(count * sizeof *g->order);
    g->nodes = malloc(2 * leaves * sizeof *g->nodes);
    if (!g->chart || !g->visit || !g->members || !g->member_of || !g->flat || !g->state || !g->queue || !g->order ||
        !g->nodes) {
        return LMB_ERROR_MEMORY;
    }
    memset(g->chart, 0xff, count * sizeof *g->chart);
    return lmb_chart_mesh_make(mesh, &g->faces);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Lists the free triangles around the seed, over soft edges, that lean little from `normal`. */
static void members_collect(grower *g, uint32_t seed, const double normal[3])
{
    ++g->walk;
    g->members[0] = seed;
    g->member_of[seed] = 0;
    g->visit[seed] = g->walk;
    g->member_count = 1;
    for (uint32_t next = 0; next < g->member_count; ++next) {
        for (int e = 0; e < 3; ++e) {
            const int64_t t = g->faces.neighbour[g->members[next]][e];
            if (t != NONE && g->visit[t] != g->walk && g->chart[t] == UINT32_MAX &&
                dot(g->faces.normal[t], normal) >= MAX_LEAN_COS) {
                g->visit[t] = g->walk;
                g->member_of[t] = g->member_count;
                g->members[g->member_count++] = (uint32_t)t;
            }
        }
    }
}

static void members_mean_normal(const grower *g, double mean[3])
{
    double sum[3] = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < g->member_count; ++i) {
        const uint32_t t = g->members[i];
        for (int c = 0; c < 3; ++c) {
            sum[c] += g->faces.area[t] * g->faces.normal[t][c];
        }
    }
    const double length = sqrt(dot(sum, sum));
    for (int c = 0; c < 3; ++c) {
        mean[c] = sum[c] / length;
    }
}

/* Two unit vectors such that (u, v, normal) is right-handed. */
static void plane_basis(const double normal[3], double u[3], double v[3])
{
    int least = 0;
    for (int c = 1; c < 3; ++c) {
        least = fabs(normal[c]) < fabs(normal[least]) ? c : least;
    }
    for (int c = 0; c < 3; ++c) {
        u[c] = (c == least ? 1.0 : 0.0) - normal[least] * normal[c];
    }
    const double length = sqrt(dot(u, u));
    for (int c = 0; c < 3; ++c) {
        u[c] /= length;
    }
    v[0] = normal[1] * u[2] - normal[2] * u[1];
    v[1] = normal[2] * u[0] - normal[0] * u[2];
    v[2] = normal[0] * u[1] - normal[1] * u[0];
}

/* Lays the members flat. Corners at the same place in the mesh come to lie at exactly the same place here. */
static void members_flatten(grower *g, const double normal[3])
{
    double u[3];
    double v[3];
    plane_basis(normal, u, v);
    for (uint32_t i = 0; i < g->member_count; ++i) {
        for (int c = 0; c < 3; ++c) {
            const lmb_vec3 p = g->mesh->position[g->mesh->triangle[g->members[i]][c]];
            const double at[3] = {(double)p.x, (double)p.y, (double)p.z};
            g->flat[i].p[c] = (chart_vec2){dot(at, u), dot(at, v)};
        }
        g->state[i] = MEMBER_WAITING;
    }
}

static bounds triangle_bounds(const flat_triangle *t)
{
    bounds box = {t->p[0], t->p[0]};
    for (int c = 1; c < 3; ++c) {
        box.low.x = fmin(box.low.x, t->p[c].x);
        box.low.y = fmin(box.low.y, t->p[c].y);
        box.high.x = fmax(box.high.x, t->p[c].x);
        box.high.y = fmax(box.high.y, t->p[c].y);
    }
    return box;
}

static bounds bounds_join(bounds a, bounds b)
{
    return (bounds){{fmin(a.low.x, b.low.x), fmin(a.low.y, b.low.y)},
                    {fmax(a.high.x, b.high.x), fmax(a.high.y, b.high.y)}};
}

static bool bounds_meet(const bounds *a, const bounds *b)
{
    return a->low.x <= b->high.x && b->low.x <= a->high.x && a->low.y <= b->high.y && b->low.y <= a->high.y;
}

/* Puts a zero between the bits of a 16-bit number. */
static uint32_t bits_spread(uint32_t x)
{
    x = (x | x << 8) & 0x00ff00ffU;
    x = (x | x << 4) & 0x0f0f0f0fU;
    x = (x | x << 2) & 0x33333333U;
    return (x | x << 1) & 0x55555555U;
}

static int coded_compare(const void *a, const void *b)
{
    const coded *const p = a;
    const coded *const q = b;
    if (p->morton != q->morton) {
        return p->morton < q->morton ? -1 : 1;
    }
    return (p->member > q->member) - (p->member < q->member);
}

/* A tree of bounding boxes over the flat members. */
static void tree_build(grower *g)
{
    const bounds nowhere = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    bounds all = nowhere;
    for (uint32_t i = 0; i < g->member_count; ++i) {
        all = bounds_join(all, triangle_bounds(&g->flat[i]));
    }
    const double extent = fmax(all.high.x - all.low.x, all.high.y - all.low.y);
    const double scale = extent > 0.0 ? 65535.0 / extent : 0.0;
    for (uint32_t i = 0; i < g->member_count; ++i) {
        const bounds box = triangle_bounds(&g->flat[i]);
        const uint32_t x = (uint32_t)(scale * (0.5 * (box.low.x + box.high.x) - all.low.x));
        const uint32_t y = (uint32_t)(scale * (0.5 * (box.low.y + box.high.y) - all.low.y));
        g->order[i] = (coded){bits_spread(x) | bits_spread(y) << 1, i};
    }
    qsort(g->order, g->member_count, sizeof *g->order, coded_compare);
    g->leaf_count = 1;
    while (g->leaf_count * LEAF_SIZE < g->member_count) {
        g->leaf_count *= 2;
    }
    for (uint32_t leaf = 0; leaf < g->leaf_count; ++leaf) {
        bounds box = nowhere;
        for (uint32_t i = leaf * LEAF_SIZE; i < (leaf + 1) * LEAF_SIZE && i < g->member_count; ++i) {
            box = bounds_join(box, triangle_bounds(&g->flat[g->order[i].member]));
        }
        g->nodes[g->leaf_count + leaf] = box;
    }
    for (uint32_t node = g->leaf_count - 1; node > 0; --node) {
        g->nodes[node] = bounds_join(g->nodes[2 * node], g->nodes[2 * node + 1]);
    }
}

static bool accepted_overlap(const grower *g, uint32_t member)
{
    const flat_triangle *const own = &g->flat[member];
    const bounds box = triangle_bounds(own);
    uint32_t stack[64];
    uint32_t depth = 0;
    stack[depth++] = 1;
    while (depth > 0) {
        const uint32_t node = stack[--depth];
        if (!bounds_meet(&g->nodes[node], &box)) {
            continue;
        }
        if (node < g->leaf_count) {
            stack[depth++] = 2 * node;
            stack[depth++] = 2 * node + 1;
            continue;
        }
        const uint32_t first = (node - g->leaf_count) * LEAF_SIZE;
        for (uint32_t i = first; i < first + LEAF_SIZE && i < g->member_count; ++i) {
            const uint32_t other = g->order[i].member;
            if (g->state[other] == MEMBER_ACCEPTED &&
                lmb_chart_triangles_overlap(own->p, g->flat[other].p, g->overlap)) {
                return true;
            }
        }
    }
    return false;
}

/* Takes members in the order of their distance from the seed in edges, except those that would cover what is already
 * there (ramps that wind over themselves). */
static void members_accept(grower *g, uint32_t seed, uint32_t number)
{
    uint32_t count = 1;
    g->queue[0] = g->member_of[seed];
    g->state[g->queue[0]] = MEMBER_ACCEPTED;
    g->chart[seed] = number;
    for (uint32_t next = 0; next < count; ++next) {
        const uint32_t from = g->members[g->queue[next]];
        for (int e = 0; e < 3; ++e) {
            const int64_t t = g->faces.neighbour[from][e];
            if (t == NONE || g->visit[t] != g->walk || g->state[g->member_of[t]] != MEMBER_WAITING) {
                continue;
            }
            const uint32_t member = g->member_of[t];
            if (accepted_overlap(g, member)) {
                g->state[member] = MEMBER_REFUSED;
            } else {
                g->state[member] = MEMBER_ACCEPTED;
                g->chart[t] = number;
                g->queue[count++] = member;
            }
        }
    }
}

/* Grows one chart and appends it; its scale makes the mean density what was asked for. */
static void chart_grow(grower *g, uint32_t seed, double texels_per_m, chart_layout *out)
{
    chart_flat *const flat = &out->charts[out->chart_count];
    double normal[3];
    members_collect(g, seed, g->faces.normal[seed]);
    members_mean_normal(g, normal);
    members_collect(g, seed, normal);
    members_flatten(g, normal);
    tree_build(g);
    members_accept(g, seed, (uint32_t)out->chart_count);
    double world_area = 0.0;
    double flat_area = 0.0;
    flat->first = out->corner_count;
    flat->count = 0;
    for (uint32_t i = 0; i < g->member_count; ++i) {
        if (g->state[i] != MEMBER_ACCEPTED) {
            continue;
        }
        const uint32_t t = g->members[i];
        memcpy(out->corners + flat->first + flat->count, g->flat[i].p, sizeof g->flat[i].p);
        out->triangles[(flat->first + flat->count) / 3] = t;
        flat->count += 3;
        world_area += g->faces.area[t];
        flat_area += g->faces.area[t] * dot(g->faces.normal[t], normal);
    }
    flat->scale = texels_per_m * sqrt(world_area / flat_area);
    out->corner_count += flat->count;
    ++out->chart_count;
}

static int ranked_compare(const void *a, const void *b)
{
    const ranked *const p = a;
    const ranked *const q = b;
    if (p->size != q->size) {
        return p->size > q->size ? -1 : 1;
    }
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

static lmb_result layout_make(grower *g, double texels_per_m, chart_layout *out)
{
    const size_t count = g->faces.triangle_count;
    ranked *const seeds = malloc(count * sizeof *seeds);
    *out = (chart_layout){.corners = malloc(3 * count * sizeof *out->corners),
                          .triangles = malloc(count * sizeof *out->triangles),
                          .charts = malloc(count * sizeof *out->charts)};
    if (!seeds || !out->corners || !out->triangles || !out->charts) {
        free(seeds);
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t t = 0; t < count; ++t) {
        seeds[t] = (ranked){g->faces.area[t], t};
    }
    qsort(seeds, count, sizeof *seeds, ranked_compare);
    for (size_t i = 0; i < count && seeds[i].size > 0.0; ++i) {
        if (g->chart[seeds[i].triangle] == UINT32_MAX) {
            chart_grow(g, seeds[i].triangle, texels_per_m, out);
        }
    }
    free(seeds);
    if (out->chart_count == 0) { /* nothing has an area: one texel for all */
        memset(out->corners, 0, 3 * sizeof *out->corners);
        out->triangles[0] = 0;
        out->charts[0] = (chart_flat){0, 3, 1.0};
        out->chart_count = 1;
        out->corner_count = 3;
        g->chart[0] = 0;
    }
    return LMB_OK;
}

/* Triangles without area become a point: the corner of a neighbour, or the first corner of all. `at` is scratch. */
static void degenerate_place(const grower *g, const chart_layout *flat, uint32_t *at, lmb_charts *charts)
{
    memset(at, 0xff, g->mesh->vertex_count * sizeof *at);
    for (size_t i = 0; i < flat->corner_count; ++i) {
        const uint32_t corner = 3 * flat->triangles[i / 3] + (uint32_t)(i % 3);
        const uint32_t vertex = g->faces.weld[g->mesh->triangle[corner / 3][corner % 3]];
        at[vertex] = at[vertex] == UINT32_MAX ? corner : at[vertex];
    }
    for (uint32_t t = 0; t < g->mesh->triangle_count; ++t) {
        if (g->chart[t] != UINT32_MAX) {
            continue;
        }
        uint32_t corner = 3 * flat->triangles[0];
        for (int c = 2; c >= 0; --c) {
            const uint32_t found = at[g->faces.weld[g->mesh->triangle[t][c]]];
            corner = found != UINT32_MAX ? found : corner;
        }
        charts->chart[t] = charts->chart[corner / 3];
        for (uint32_t c = 0; c < 3; ++c) {
            charts->corner_uv[3 * (size_t)t + c] = charts->corner_uv[corner];
        }
    }
}

static lmb_result charts_fill(const grower *g, const chart_layout *flat, int32_t resolution, lmb_charts *charts)
{
    const size_t count = g->mesh->triangle_count;
    lmb_charts made = {.chart_count = (uint32_t)flat->chart_count, .resolution = resolution};
    made.corner_uv = malloc(3 * count * sizeof *made.corner_uv);
    made.chart = malloc(count * sizeof *made.chart);
    uint32_t *const scratch = malloc((g->mesh->vertex_count + (size_t)1) * sizeof *scratch);
    if (!made.corner_uv || !made.chart || !scratch) {
        free(scratch);
        lmb_charts_free(&made);
        return LMB_ERROR_MEMORY;
    }
    memcpy(made.chart, g->chart, count * sizeof *made.chart);
    for (size_t i = 0; i < flat->corner_count; ++i) {
        const chart_vec2 p = flat->corners[i];
        made.corner_uv[3 * (size_t)flat->triangles[i / 3] + i % 3] =
            (lmb_vec2){(float)(p.x / resolution), (float)(p.y / resolution)};
    }
    degenerate_place(g, flat, scratch, &made);
    free(scratch);
    *charts = made;
    return LMB_OK;
}

lmb_result lmb_charts_make(const lmb_mesh *mesh, float texels_per_m, int32_t gutter_texels, lmb_pool *pool,
                           lmb_charts *charts)
{
    assert(mesh && charts);
    if (!(texels_per_m > 0.0f && texels_per_m < INFINITY) || gutter_texels < 0 || gutter_texels > 1024 ||
        mesh->triangle_count > UINT32_MAX / 8) {
        return LMB_ERROR_ARGUMENT;
    }
    if (mesh->triangle_count == 0) {
        *charts = (lmb_charts){.resolution = 4};
        return LMB_OK;
    }
    grower g;
    chart_layout flat = {0};
    int32_t resolution = 0;
    lmb_result result = grower_make(mesh, texels_per_m, &g);
    if (result == LMB_OK) {
        result = layout_make(&g, (double)texels_per_m, &flat);
    }
    if (result == LMB_OK) {
        result = lmb_chart_join(&g.faces, &flat, g.chart);
    }
    if (result == LMB_OK) {
        result = lmb_chart_pack(flat.charts, flat.chart_count, flat.corners, gutter_texels, pool, &resolution);
    }
    if (result == LMB_OK) {
        result = charts_fill(&g, &flat, resolution, charts);
    }
    free(flat.corners);
    free(flat.triangles);
    free(flat.charts);
    grower_free(&g);
    return result;
}

void lmb_charts_free(lmb_charts *charts)
{
    if (charts) {
        free(charts->corner_uv);
        free(charts->chart);
        *charts = (lmb_charts){0};
    }
}
