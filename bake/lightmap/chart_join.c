#include "lightmap/chart_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Charts smaller than this (texels) are joined to others: they are all border, and their gutters take several times
 * what they hold. */
static const double SMALL_TEXELS = 4.0;
/* Over edges that bend by at most 45 degrees: light of the two sides is mixed within a texel of it. */
static const double JOIN_COS = 0.7;
/* Narrower than this (texels) on average, a chart shows nothing of its own, and joins over any edge. */
static const double SLIVER_TEXELS = 0.125;
/* Smaller than this (texels), nothing is seen of a chart. */
static const double SPECK_TEXELS = 1.0 / 16.0;
/* Edges that are laid on each other may differ by so much in length, as a share. */
static const double EDGE_SHARE = 0.1;
/* Joined charts are this far apart, in texels: rounding and edges that differ do not make them overlap. */
static const double GAP_TEXELS = 0.01;

enum { MOST_EDGES = 4, MOST_ROUNDS = 4 };

/* Charts of more triangles than this are looked at strip by strip. */
enum { FEW_TRIANGLES = 32, MOST_STRIPS = 256 };

/* The triangles of a chart by the strips of its height that they reach into. */
typedef struct chart_strips {
    uint32_t count;    /* 0: not made */
    double low, scale; /* strip = (y - low) scale */
    uint32_t *first;   /* [strip], and one more */
    uint32_t *corner;  /* of the chart's triangles, relative to its first */
} chart_strips;

/* An edge that a chart may be joined over. */
typedef struct join_edge {
    double length;
    uint32_t triangle;
    int corner;
} join_edge;

/* A turn and then a shift of the plane. */
typedef struct motion {
    chart_vec2 turn; /* cosine and sine */
    chart_vec2 shift;
} motion;

typedef struct sized {
    double area;
    uint32_t chart;
} sized;

/* Groups of charts are lists, and have the number of their first. */
typedef struct joiner {
    const chart_mesh *mesh;
    chart_layout *layout;
    uint32_t *place;        /* [triangle] */
    uint32_t *group;        /* [chart] */
    uint32_t *next;         /* [chart] of the group; UINT32_MAX: the last */
    uint32_t *last;         /* [group] */
    double *area;           /* [group] square texels */
    chart_vec2 *low, *high; /* [chart] bounds */
    chart_strips *strips;   /* [chart] */
    sized *order;           /* [chart] */
    const uint32_t *chart;  /* [triangle] as it was before joining */
} joiner;

static double corner_cross(const chart_vec2 *p)
{
    return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
}

static void bounds_find(joiner *j, uint32_t chart)
{
    const chart_flat *const flat = &j->layout->charts[chart];
    const chart_vec2 *const corners = j->layout->corners + flat->first;
    j->low[chart] = j->high[chart] = corners[0];
    for (size_t i = 1; i < flat->count; ++i) {
        j->low[chart] = (chart_vec2){fmin(j->low[chart].x, corners[i].x), fmin(j->low[chart].y, corners[i].y)};
        j->high[chart] = (chart_vec2){fmax(j->high[chart].x, corners[i].x), fmax(j->high[chart].y, corners[i].y)};
    }
}

/* Brings all charts to texels, each a group of its own. */
static void joiner_start(joiner *j)
{
    chart_layout *const layout = j->layout;
    for (uint32_t c = 0; c < layout->chart_count; ++c) {
        chart_flat *const flat = &layout->charts[c];
        double doubled = 0.0;
        for (size_t i = flat->first; i < flat->first + flat->count; ++i) {
            layout->corners[i].x *= flat->scale;
            layout->corners[i].y *= flat->scale;
        }
        for (size_t i = flat->first; i < flat->first + flat->count; i += 3) {
            j->place[layout->triangles[i / 3]] = (uint32_t)(i / 3);
            doubled += corner_cross(layout->corners + i);
        }
        flat->scale = 1.0;
        j->group[c] = j->last[c] = c;
        j->next[c] = UINT32_MAX;
        j->area[c] = 0.5 * doubled;
        bounds_find(j, c);
    }
}

static chart_vec2 *triangle_corners(const joiner *j, uint32_t triangle)
{
    return j->layout->corners + 3 * (size_t)j->place[triangle];
}

static double distance(chart_vec2 a, chart_vec2 b)
{
    return sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
}

/* Keeps the longest edges, in order; of equal ones the first. */
static int edge_keep(join_edge *edges, int count, join_edge edge)
{
    int at = count < MOST_EDGES ? count : MOST_EDGES;
    for (; at > 0 && edges[at - 1].length < edge.length; --at) {
        if (at < MOST_EDGES) {
            edges[at] = edges[at - 1];
        }
    }
    if (at < MOST_EDGES) {
        edges[at] = edge;
    }
    return count < MOST_EDGES ? count + 1 : MOST_EDGES;
}

/* The corner of a triangle at which its edge to another begins. */
static int corner_to(const joiner *j, uint32_t triangle, uint32_t other)
{
    for (int e = 0; e < 2; ++e) {
        if (j->mesh->across[triangle][e] == (int64_t)other) {
            return e;
        }
    }
    return 2;
}

/* Narrower than anything that shows. */
static bool group_is_sliver(const joiner *j, uint32_t group)
{
    double length = 0.0;
    for (uint32_t c = group; c != UINT32_MAX; c = j->next[c]) {
        length += distance(j->low[c], j->high[c]);
    }
    return j->area[group] < SLIVER_TEXELS * length;
}

/* Slivers join what is larger over any edge, and specks whatever there is; but all sides of a small box keep their own
 * light. */
static bool edge_joins(const joiner *j, uint32_t group, bool sliver, uint32_t triangle, uint32_t other)
{
    const double *const n = j->mesh->normal[triangle];
    const double *const m = j->mesh->normal[other];
    return n[0] * m[0] + n[1] * m[1] + n[2] * m[2] >= JOIN_COS || j->area[group] < SPECK_TEXELS ||
           (sliver && !group_is_sliver(j, j->group[j->chart[other]]));
}

/* The longest edges of a group to others that it may be joined to. */
static int edges_find(const joiner *j, uint32_t group, join_edge edges[MOST_EDGES])
{
    const bool sliver = group_is_sliver(j, group);
    int count = 0;
    for (uint32_t c = group; c != UINT32_MAX; c = j->next[c]) {
        const chart_flat *const flat = &j->layout->charts[c];
        for (size_t i = flat->first; i < flat->first + flat->count; ++i) {
            const uint32_t t = j->layout->triangles[i / 3];
            const int64_t other = j->mesh->across[t][i % 3];
            if (other >= 0 && j->group[j->chart[other]] != group && edge_joins(j, group, sliver, t, (uint32_t)other)) {
                const size_t first = i / 3 * 3;
                const double length = distance(j->layout->corners[i], j->layout->corners[first + (i + 1) % 3]);
                count = edge_keep(edges, count, (join_edge){length, t, (int)(i % 3)});
            }
        }
    }
    return count;
}

/* Lays the edge of a triangle on the same edge of the one across: middle on middle, one direction, a gap between.
 * @return false: they are not the same here */
static bool motion_find(const joiner *j, const join_edge *edge, motion *found)
{
    const uint32_t other = (uint32_t)j->mesh->across[edge->triangle][edge->corner];
    const int corner = corner_to(j, other, edge->triangle);
    const chart_vec2 *const own = triangle_corners(j, edge->triangle);
    const chart_vec2 *const there = triangle_corners(j, other);
    const chart_vec2 a = own[edge->corner], b = own[(edge->corner + 1) % 3];
    const chart_vec2 to_a = there[(corner + 1) % 3], to_b = there[corner];
    const double length = distance(a, b), to_length = distance(to_a, to_b);
    if (!(length > 0.0 && to_length > 0.0) || fabs(length - to_length) > EDGE_SHARE * to_length) {
        return false;
    }
    const chart_vec2 d = {(b.x - a.x) / length, (b.y - a.y) / length};
    const chart_vec2 e = {(to_b.x - to_a.x) / to_length, (to_b.y - to_a.y) / to_length};
    const chart_vec2 turn = {d.x * e.x + d.y * e.y, d.x * e.y - d.y * e.x};
    const chart_vec2 middle = {0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
    /* The other side of the edge is on its right, as a is on its left. */
    found->turn = turn;
    found->shift.x = 0.5 * (to_a.x + to_b.x) - (turn.x * middle.x - turn.y * middle.y) - GAP_TEXELS * e.y;
    found->shift.y = 0.5 * (to_a.y + to_b.y) - (turn.y * middle.x + turn.x * middle.y) + GAP_TEXELS * e.x;
    return true;
}

static chart_vec2 motion_apply(const motion *by, chart_vec2 p)
{
    return (chart_vec2){by->turn.x * p.x - by->turn.y * p.y + by->shift.x,
                        by->turn.y * p.x + by->turn.x * p.y + by->shift.y};
}

static void strips_free(chart_strips *strips)
{
    free(strips->first);
    free(strips->corner);
    *strips = (chart_strips){0};
}

static uint32_t strip_of(const chart_strips *strips, double y)
{
    const double strip = (y - strips->low) * strips->scale;
    return strip <= 0.0 ? 0 : strip >= strips->count - 1 ? strips->count - 1 : (uint32_t)strip;
}

/* The strips that a triangle reaches into. */
static void strip_span(const chart_strips *strips, const chart_vec2 *p, uint32_t *from, uint32_t *to)
{
    *from = strip_of(strips, fmin(p[0].y, fmin(p[1].y, p[2].y)));
    *to = strip_of(strips, fmax(p[0].y, fmax(p[1].y, p[2].y)));
}

/* Counts, then fills: a counting sort. @return false: out of memory */
static bool strips_make(joiner *j, uint32_t chart)
{
    const chart_flat *const flat = &j->layout->charts[chart];
    const chart_vec2 *const corners = j->layout->corners + flat->first;
    chart_strips *const strips = &j->strips[chart];
    const double height = j->high[chart].y - j->low[chart].y;
    const double wanted = fmin(4.0 * sqrt((double)flat->count), MOST_STRIPS);
    *strips = (chart_strips){.count = (uint32_t)wanted, .low = j->low[chart].y};
    strips->scale = height > 0.0 ? strips->count / height : 0.0;
    strips->first = calloc((size_t)strips->count + 2, sizeof *strips->first);
    uint32_t from, to;
    for (size_t i = 0; strips->first && i < flat->count; i += 3) {
        strip_span(strips, corners + i, &from, &to);
        for (uint32_t k = from; k <= to; ++k) {
            ++strips->first[k + 2];
        }
    }
    for (uint32_t k = 0; strips->first && k < strips->count; ++k) {
        strips->first[k + 2] += strips->first[k + 1];
    }
    strips->corner = strips->first ? malloc(((size_t)strips->first[strips->count + 1] + 1) * sizeof(uint32_t)) : NULL;
    for (size_t i = 0; strips->corner && i < flat->count; i += 3) {
        strip_span(strips, corners + i, &from, &to);
        for (uint32_t k = from; k <= to; ++k) {
            strips->corner[strips->first[k + 1]++] = (uint32_t)i;
        }
    }
    if (!strips->corner) {
        strips_free(strips);
    }
    return strips->count > 0;
}

/* A triangle with its bounds. */
typedef struct boxed {
    chart_vec2 p[3];
    chart_vec2 low, high;
} boxed;

static bool boxed_hits(const boxed *own, const chart_vec2 *p)
{
    return fmin(p[0].x, fmin(p[1].x, p[2].x)) < own->high.x && fmax(p[0].x, fmax(p[1].x, p[2].x)) > own->low.x &&
           fmin(p[0].y, fmin(p[1].y, p[2].y)) < own->high.y && fmax(p[0].y, fmax(p[1].y, p[2].y)) > own->low.y &&
           lmb_chart_triangles_overlap(own->p, p, CHART_OVERLAP_TEXELS);
}

static bool boxed_hits_chart(joiner *j, const boxed *own, uint32_t chart)
{
    if (j->low[chart].x > own->high.x || j->low[chart].y > own->high.y || j->high[chart].x < own->low.x ||
        j->high[chart].y < own->low.y) {
        return false;
    }
    const chart_flat *const flat = &j->layout->charts[chart];
    const chart_vec2 *const corners = j->layout->corners + flat->first;
    const chart_strips *const strips = &j->strips[chart];
    if (flat->count <= 3 * FEW_TRIANGLES || (strips->count == 0 && !strips_make(j, chart))) {
        for (size_t i = 0; i < flat->count; i += 3) {
            if (boxed_hits(own, corners + i)) {
                return true;
            }
        }
        return false;
    }
    uint32_t from, to;
    strip_span(strips, own->p, &from, &to);
    for (uint32_t i = strips->first[from]; i < strips->first[to + 1]; ++i) {
        if (boxed_hits(own, corners + strips->corner[i])) {
            return true;
        }
    }
    return false;
}

/* Whether a group, moved, would cover a part of another. */
static bool groups_overlap(joiner *j, uint32_t group, const motion *by, uint32_t other)
{
    for (uint32_t c = group; c != UINT32_MAX; c = j->next[c]) {
        const chart_flat *const flat = &j->layout->charts[c];
        for (size_t i = flat->first; i < flat->first + flat->count; i += 3) {
            boxed own;
            for (size_t k = 0; k < 3; ++k) {
                const chart_vec2 p = own.p[k] = motion_apply(by, j->layout->corners[i + k]);
                own.low = k == 0 ? p : (chart_vec2){fmin(own.low.x, p.x), fmin(own.low.y, p.y)};
                own.high = k == 0 ? p : (chart_vec2){fmax(own.high.x, p.x), fmax(own.high.y, p.y)};
            }
            for (uint32_t d = other; d != UINT32_MAX; d = j->next[d]) {
                if (boxed_hits_chart(j, &own, d)) {
                    return true;
                }
            }
        }
    }
    return false;
}

static void groups_join(joiner *j, uint32_t group, const motion *by, uint32_t other)
{
    for (uint32_t c = group; c != UINT32_MAX; c = j->next[c]) {
        const chart_flat *const flat = &j->layout->charts[c];
        for (size_t i = flat->first; i < flat->first + flat->count; ++i) {
            j->layout->corners[i] = motion_apply(by, j->layout->corners[i]);
        }
        bounds_find(j, c);
        strips_free(&j->strips[c]);
        j->group[c] = other;
    }
    j->next[j->last[other]] = group;
    j->last[other] = j->last[group];
    j->area[other] += j->area[group];
}

static bool group_try(joiner *j, uint32_t group)
{
    join_edge edges[MOST_EDGES];
    const int count = edges_find(j, group, edges);
    for (int i = 0; i < count; ++i) {
        const uint32_t other = j->group[j->chart[j->mesh->across[edges[i].triangle][edges[i].corner]]];
        motion by;
        if (motion_find(j, &edges[i], &by) && !groups_overlap(j, group, &by, other)) {
            groups_join(j, group, &by, other);
            return true;
        }
    }
    return false;
}

static int sized_compare(const void *a, const void *b)
{
    const sized *const p = a;
    const sized *const q = b;
    if (p->area != q->area) {
        return p->area < q->area ? -1 : 1;
    }
    return (p->chart > q->chart) - (p->chart < q->chart);
}

/* Joins the smallest first. Returns how many were. */
static size_t groups_round(joiner *j)
{
    size_t count = 0, joined = 0;
    for (uint32_t c = 0; c < j->layout->chart_count; ++c) {
        if (j->group[c] == c && j->area[c] < SMALL_TEXELS) {
            j->order[count++] = (sized){j->area[c], c};
        }
    }
    qsort(j->order, count, sizeof *j->order, sized_compare);
    for (size_t i = 0; i < count; ++i) {
        const uint32_t c = j->order[i].chart;
        joined += j->group[c] == c && j->area[c] < SMALL_TEXELS && group_try(j, c);
    }
    return joined;
}

/* Brings the charts of each group together, and numbers the groups. */
static lmb_result layout_rebuild(joiner *j, uint32_t *chart)
{
    chart_layout *const layout = j->layout;
    chart_layout made = {.corners = malloc((layout->corner_count + 1) * sizeof *made.corners),
                         .triangles = malloc((layout->corner_count / 3 + 1) * sizeof *made.triangles),
                         .charts = malloc((layout->chart_count + 1) * sizeof *made.charts)};
    if (!made.corners || !made.triangles || !made.charts) {
        free(made.corners);
        free(made.triangles);
        free(made.charts);
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t g = 0; g < layout->chart_count; ++g) {
        if (j->group[g] != g) {
            continue;
        }
        const size_t first = made.corner_count;
        for (uint32_t c = g; c != UINT32_MAX; c = j->next[c]) {
            const chart_flat *const flat = &layout->charts[c];
            memcpy(made.corners + made.corner_count, layout->corners + flat->first, flat->count * sizeof *made.corners);
            for (size_t i = 0; i < flat->count; i += 3) {
                const uint32_t t = layout->triangles[(flat->first + i) / 3];
                made.triangles[(made.corner_count + i) / 3] = t;
                chart[t] = (uint32_t)made.chart_count;
            }
            made.corner_count += flat->count;
        }
        made.charts[made.chart_count++] = (chart_flat){first, made.corner_count - first, 1.0};
    }
    free(layout->corners);
    free(layout->triangles);
    free(layout->charts);
    *layout = made;
    return LMB_OK;
}

lmb_result lmb_chart_join(const chart_mesh *mesh, chart_layout *layout, uint32_t *chart)
{
    const size_t charts = layout->chart_count;
    joiner j = {.mesh = mesh,
                .layout = layout,
                .place = malloc(((size_t)mesh->triangle_count + 1) * sizeof *j.place),
                .group = malloc(charts * sizeof *j.group),
                .next = malloc(charts * sizeof *j.next),
                .last = malloc(charts * sizeof *j.last),
                .area = malloc(charts * sizeof *j.area),
                .low = malloc(charts * sizeof *j.low),
                .high = malloc(charts * sizeof *j.high),
                .strips = calloc(charts + 1, sizeof *j.strips),
                .order = malloc(charts * sizeof *j.order),
                .chart = chart};
    lmb_result result = LMB_ERROR_MEMORY;
    if (j.place && j.group && j.next && j.last && j.area && j.low && j.high && j.strips && j.order) {
        joiner_start(&j);
        for (int round = 0; round < MOST_ROUNDS && groups_round(&j) > 0; ++round) {
        }
        result = layout_rebuild(&j, chart);
    }
    free(j.place);
    free(j.group);
    free(j.next);
    free(j.last);
    free(j.area);
    free(j.low);
    free(j.high);
    for (size_t c = 0; j.strips && c < charts; ++c) {
        strips_free(&j.strips[c]);
    }
    free(j.strips);
    free(j.order);
    return result;
}
