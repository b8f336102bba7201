/* Which edges are seams, and what their two sides read. */
#include "lightmap/lightmap_seams.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>
#include <lambent/file.h>

/* Corners this near (texels) are the same. Normals that differ by less than 10 degrees are of one surface, unless its
 * triangles bend by more than 37: shading is smooth on bevels too, light is not. */
#define SAME_CORNER 0.02
#define SAME_NORMAL 0.985f
#define BENT_NORMAL 0.8f

/* Points on an edge, for each texel of its length. */
#define POINTS_PER_TEXEL 1.0

/* How far from the edge, and over the surface, the two sides must see each other (texels). */
#define BESIDE 0.5f
#define OVER 0.25f

/* The edge opposite to a corner of a triangle. */
typedef uint32_t mesh_edge; /* 3 triangle + corner */

/* Edges of a mesh that have no neighbour with the same UVs. */
typedef struct border {
    size_t count;
    mesh_edge *edge;
} border;

typedef struct edge_end {
    lmb_vec3 position;
    lmb_vec2 uv;
} edge_end;

/* An edge's ends in an order that both of its triangles agree on. */
static void edge_ends(const lmb_mesh *mesh, const lmb_vec2 *corner_uv, mesh_edge edge, edge_end end[2])
{
    const uint32_t triangle = edge / 3;
    for (uint32_t k = 0; k < 2; ++k) {
        const uint32_t corner = (edge + 1 + k) % 3;
        const lmb_vec3 p = mesh->position[mesh->triangle[triangle][corner]];
        const lmb_vec2 uv = lmb_texels_corner_uv(mesh, corner_uv, triangle, (int)corner);
        /* -0 and 0 are the same place. */
        end[k] = (edge_end){{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}, {uv.x + 0.0f, uv.y + 0.0f}};
    }
    if (memcmp(&end[0], &end[1], sizeof end[0]) > 0) {
        const edge_end first = end[0];
        end[0] = end[1];
        end[1] = first;
    }
}

static lmb_result border_find(const lmb_mesh *mesh, const lmb_vec2 *corner_uv, border *found)
{
    const size_t edges = 3 * (size_t)mesh->triangle_count;
    size_t size = 16;
    while (size < 2 * edges) {
        size *= 2;
    }
    uint32_t *const table = calloc(size, sizeof *table); /* edge + 1, or 0 */
    uint8_t *const inner = calloc(edges + 1, 1);
    found->edge = malloc((edges + 1) * sizeof *found->edge);
    for (size_t i = 0; table && inner && i < edges; ++i) {
        edge_end end[2], other[2];
        edge_ends(mesh, corner_uv, (mesh_edge)i, end);
        size_t slot = (size_t)lmb_hash(LMB_HASH_SEED, end, sizeof end) & (size - 1);
        for (; table[slot] != 0; slot = (slot + 1) & (size - 1)) {
            edge_ends(mesh, corner_uv, table[slot] - 1, other);
            if (memcmp(end, other, sizeof end) == 0) {
                inner[i] = inner[table[slot] - 1] = 1;
                break;
            }
        }
        table[slot] = table[slot] != 0 ? table[slot] : (uint32_t)i + 1;
    }
    const bool enough = table && inner && found->edge;
    found->count = 0;
    for (size_t i = 0; enough && i < edges; ++i) {
        if (!inner[i]) {
            found->edge[found->count++] = (mesh_edge)i;
        }
    }
    free(table);
    free(inner);
    return enough ? LMB_OK : LMB_ERROR_MEMORY;
}

/* A border edge in the world, found by where its middle is. */
typedef struct world_edge {
    uint64_t key;
    uint32_t instance;
    mesh_edge edge;
} world_edge;

typedef struct seam_search {
    const lmb_lightmap *lightmap;
    const lmb_tracer *tracer;
    border *border; /* [mesh] */
    size_t count;
    world_edge *edge;
    double cell;
} seam_search;

static int world_edge_compare(const void *a, const void *b)
{
    const world_edge *const p = a, *const q = b;
    if (p->key != q->key) {
        return p->key > q->key ? 1 : -1;
    }
    if (p->instance != q->instance) {
        return p->instance > q->instance ? 1 : -1;
    }
    return (p->edge > q->edge) - (p->edge < q->edge);
}

static lmb_hit edge_hit(const world_edge *edge, double t)
{
    const uint32_t from = (edge->edge + 1) % 3, to = (edge->edge + 2) % 3;
    double at[3] = {0.0, 0.0, 0.0};
    at[from] = 1.0 - t;
    at[to] = t;
    return (lmb_hit){.instance = edge->instance, .triangle = edge->edge / 3, .u = (float)at[1], .v = (float)at[2]};
}

/* Rounded, so that positions on round figures do not lie between two cells. */
static uint64_t middle_key(const seam_search *search, const world_edge *edge)
{
    lmb_vec3 corner[3];
    lmb_trace_corners(search->tracer, edge->instance, edge->edge / 3, corner);
    const lmb_vec3 a = corner[(edge->edge + 1) % 3], b = corner[(edge->edge + 2) % 3];
    const int64_t cell[3] = {(int64_t)floor(0.5 * ((double)a.x + (double)b.x) / search->cell + 0.5),
                             (int64_t)floor(0.5 * ((double)a.y + (double)b.y) / search->cell + 0.5),
                             (int64_t)floor(0.5 * ((double)a.z + (double)b.z) / search->cell + 0.5)};
    return lmb_hash(LMB_HASH_SEED, cell, sizeof cell);
}

static lmb_result borders_find(seam_search *search)
{
    const lmb_lightmap *lightmap = search->lightmap;
    const lmb_scene *scene = lightmap->scene;
    lmb_result result = LMB_OK;
    for (uint32_t i = 0; i < scene->instance_count && result == LMB_OK; ++i) {
        const uint32_t mesh = scene->instances[i].mesh;
        if (lightmap->region[i].image < 0) {
            continue;
        }
        if (!search->border[mesh].edge) {
            result = border_find(&scene->meshes[mesh], lightmap->corner_uv[mesh], &search->border[mesh]);
        }
        search->count += search->border[mesh].count;
    }
    return result;
}

static lmb_result world_edges_find(seam_search *search)
{
    const lmb_lightmap *lightmap = search->lightmap;
    search->edge = malloc((search->count + 1) * sizeof *search->edge);
    if (!search->edge) {
        return LMB_ERROR_MEMORY;
    }
    size_t count = 0;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const border *of = &search->border[lightmap->scene->instances[i].mesh];
        for (size_t k = 0; k < of->count && lightmap->region[i].image >= 0; ++k) {
            search->edge[count] = (world_edge){.instance = i, .edge = of->edge[k]};
            search->edge[count].key = middle_key(search, &search->edge[count]);
            ++count;
        }
    }
    qsort(search->edge, count, sizeof *search->edge, world_edge_compare);
    return LMB_OK;
}

/* Whether two edges are one, on a smooth surface; `*turned`: from its other end. */
static bool edges_meet(const seam_search *search, const world_edge *a, const world_edge *b, bool *turned)
{
    const float near = (float)(search->cell * search->cell);
    for (int turn = 0; turn < 2; ++turn) {
        bool meet = true;
        for (int end = 0; end < 2 && meet; ++end) {
            const lmb_hit hit_a = edge_hit(a, end), hit_b = edge_hit(b, turn ? 1 - end : end);
            const lmb_place p = lmb_trace_place(search->tracer, &hit_a), q = lmb_trace_place(search->tracer, &hit_b);
            const lmb_vec3 apart = lmb_vec3_sub(p.position, q.position);
            meet = lmb_vec3_dot(apart, apart) <= near &&
                   lmb_vec3_dot(p.shading_normal, q.shading_normal) >= SAME_NORMAL &&
                   lmb_vec3_dot(p.geometric_normal, q.geometric_normal) >= BENT_NORMAL;
        }
        if (meet) {
            *turned = turn == 1;
            return true;
        }
    }
    return false;
}

/* A point just over the surface, a little way from the edge into its triangle. */
static lmb_vec3 point_beside(const seam_search *search, const world_edge *edge, double t, float texel)
{
    const lmb_hit hit = edge_hit(edge, t);
    const lmb_place place = lmb_trace_place(search->tracer, &hit);
    lmb_vec3 corner[3];
    lmb_trace_corners(search->tracer, edge->instance, edge->edge / 3, corner);
    const lmb_vec3 inwards = lmb_vec3_sub(corner[edge->edge % 3], place.position);
    const float length = lmb_vec3_length(inwards);
    const float part = length > 0.0f ? lmb_smaller(BESIDE * texel / length, 0.5f) : 0.0f;
    const lmb_vec3 over = lmb_vec3_mad(place.position, place.geometric_normal, OVER * texel);
    return lmb_vec3_mad(over, inwards, part);
}

/* Whether one side is seen from the other, rather than behind a wall that stands on the edge. */
static bool sides_see(const seam_search *search, lmb_vec3 a, lmb_vec3 b)
{
    uint64_t rays = 0;
    return lmb_rgb_max(lmb_trace_transmittance(search->tracer, a, b, &rays)) > 0.0f;
}

static bool seams_make_room(lmb_seams *seams, size_t more)
{
    if (seams->count + more > seams->room) {
        const size_t room = 2 * (seams->count + more);
        lmb_seam_point *const larger = realloc(seams->point, room * sizeof *larger);
        if (!larger) {
            return false;
        }
        seams->point = larger;
        seams->room = room;
    }
    return true;
}

static lmb_result seam_add(const seam_search *search, const world_edge *a, const world_edge *b, bool turned,
                           lmb_seams *seams)
{
    const lmb_lightmap_region *region = search->lightmap->region;
    const lmb_hit first = edge_hit(a, 0.0), last = edge_hit(a, 1.0);
    const lmb_vec3 along =
        lmb_vec3_sub(lmb_trace_position(search->tracer, &last), lmb_trace_position(search->tracer, &first));
    const double texel = (double)lmb_smaller(region[a->instance].texel_size, region[b->instance].texel_size);
    const size_t before = seams->count;
    const size_t steps = 1 + (size_t)ceil(POINTS_PER_TEXEL * sqrt((double)lmb_vec3_dot(along, along)) / texel);
    if (!seams_make_room(seams, steps + 1)) {
        return LMB_ERROR_MEMORY;
    }
    for (size_t i = 0; i <= steps; ++i) {
        const double t = (double)i / (double)steps;
        const double t_b = turned ? 1.0 - t : t;
        if (!sides_see(search, point_beside(search, a, t, (float)texel), point_beside(search, b, t_b, (float)texel))) {
            continue;
        }
        const lmb_hit hit_a = edge_hit(a, t), hit_b = edge_hit(b, t_b);
        lmb_seam_point *point = &seams->point[seams->count++];
        lmb_lightmap_footprint_find(search->lightmap, &hit_a, &point->side[0]);
        lmb_lightmap_footprint_find(search->lightmap, &hit_b, &point->side[1]);
        point->normal = lmb_trace_place(search->tracer, &hit_a).shading_normal;
    }
    seams->edge_count += seams->count > before;
    return LMB_OK;
}

static lmb_result seams_pair(const seam_search *search, lmb_seams *seams)
{
    lmb_result result = LMB_OK;
    for (size_t i = 0; i < search->count; ++i) {
        for (size_t k = i + 1; k < search->count && search->edge[k].key == search->edge[i].key; ++k) {
            bool turned;
            if (result == LMB_OK && edges_meet(search, &search->edge[i], &search->edge[k], &turned)) {
                result = seam_add(search, &search->edge[i], &search->edge[k], turned, seams);
            }
        }
    }
    return result;
}

lmb_result lmb_seams_find(const lmb_lightmap *lightmap, const lmb_tracer *tracer, lmb_seams *seams)
{
    const uint32_t meshes = lightmap->scene->mesh_count;
    seam_search search = {.lightmap = lightmap,
                          .tracer = tracer,
                          .border = calloc((size_t)meshes + 1, sizeof *search.border),
                          .cell = SAME_CORNER / (double)lightmap->settings.texels_per_m};
    *seams = (lmb_seams){.count = 0};
    lmb_result result = search.border ? borders_find(&search) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = world_edges_find(&search);
    }
    if (result == LMB_OK) {
        result = seams_pair(&search, seams);
    }
    for (uint32_t i = 0; search.border && i < meshes; ++i) {
        free(search.border[i].edge);
    }
    free(search.border);
    free(search.edge);
    if (result != LMB_OK) {
        lmb_seams_free(seams);
    }
    return result;
}

void lmb_seams_free(lmb_seams *seams)
{
    free(seams->point);
    *seams = (lmb_seams){.count = 0};
}
