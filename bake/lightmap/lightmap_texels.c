/* Conservative rasterisation: which texels the triangles touch, and where each is sampled. */
#include "lightmap/lightmap_internal.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include <lambent/sequence.h>

/* A triangle that reaches less than this far into a texel (texels) does not touch it: rounding of UVs that are meant
 * to lie on the border. */
#define TOUCH_SLACK 1e-3

/* Sample points nearer to an edge than this (texels) are moved towards the middle of what is covered of their texel,
 * by this share of the way. */
#define EDGE_MARGIN (1.0 / 64.0)
#define EDGE_PULL 0.125

typedef lmb_texel_vertex texel_vertex;

/* A triangle cut by a texel's four sides. */
typedef struct texel_polygon {
    texel_vertex vertex[LMB_TEXEL_PIECE_MAX];
    int count;
} texel_polygon;

static texel_vertex vertex_lerp(texel_vertex a, texel_vertex b, double t)
{
    return (texel_vertex){a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.u + (b.u - a.u) * t, a.v + (b.v - a.v) * t};
}

/* A triangle this deep around a texel's centre (texels) covers all of it. */
#define WHOLE_DEPTH 0.7072

/* The part of a convex polygon on one side of an axis-aligned line: sign (x or y - bound) >= 0. */
static texel_polygon polygon_clip(const texel_polygon *polygon, bool along_y, double bound, double sign)
{
    texel_polygon kept = {.count = 0};
    for (int i = 0; i < polygon->count; ++i) {
        const texel_vertex a = polygon->vertex[i];
        const texel_vertex b = polygon->vertex[i + 1 < polygon->count ? i + 1 : 0];
        const double side_a = sign * ((along_y ? a.y : a.x) - bound);
        const double side_b = sign * ((along_y ? b.y : b.x) - bound);
        if (side_a >= 0.0) {
            kept.vertex[kept.count++] = a;
        }
        if ((side_a > 0.0 && side_b < 0.0) || (side_a < 0.0 && side_b > 0.0)) {
            kept.vertex[kept.count++] = vertex_lerp(a, b, side_a / (side_a - side_b));
        }
    }
    return kept;
}

static void polygon_range(const texel_polygon *polygon, bool along_y, double *low, double *high)
{
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (int i = 0; i < polygon->count; ++i) {
        const double value = along_y ? polygon->vertex[i].y : polygon->vertex[i].x;
        *low = value < *low ? value : *low;
        *high = value > *high ? value : *high;
    }
}

static double cross_2d(texel_vertex a, texel_vertex b, texel_vertex c)
{
    return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
}

/* What tells how far inside a triangle a point is. */
typedef struct triangle_edges {
    const texel_vertex *corner; /* [3] */
    double inverse_area;        /* 0 for a triangle without area */
    double inverse_length[3];   /* of the edge opposite each corner; negative where the corners run clockwise */
} triangle_edges;

static triangle_edges triangle_edges_make(const texel_vertex corner[3])
{
    const double area = cross_2d(corner[0], corner[1], corner[2]);
    triangle_edges edges = {.corner = corner};
    if (fabs(area) >= DBL_MIN) {
        edges.inverse_area = 1.0 / area;
        for (int k = 0; k < 3; ++k) {
            const texel_vertex a = corner[(k + 1) % 3];
            const texel_vertex b = corner[(k + 2) % 3];
            const double length = sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
            edges.inverse_length[k] = (area > 0.0 ? 1.0 : -1.0) / length;
        }
    }
    return edges;
}

static inline double double_between(double low, double number, double high)
{
    return number > low ? (number < high ? number : high) : low;
}

/* Barycentric weights of (x, y) in `*point`, and how far inside its nearest edge it is: negative outside. */
static double triangle_depth(const triangle_edges *edges, texel_vertex *point)
{
    const texel_vertex *corner = edges->corner;
    double doubled[3];
    double depth = edges->inverse_area != 0.0 ? HUGE_VAL : -HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        doubled[k] = cross_2d(*point, corner[(k + 1) % 3], corner[(k + 2) % 3]);
        const double inside = doubled[k] * edges->inverse_length[k];
        depth = inside < depth ? inside : depth;
    }
    point->u = doubled[1] * edges->inverse_area;
    point->v = doubled[2] * edges->inverse_area;
    return depth;
}

/* The point on a polygon's border that is nearest to `centre`. */
static texel_vertex border_nearest(const texel_polygon *polygon, texel_vertex centre)
{
    texel_vertex best = polygon->vertex[0];
    double best_squared = HUGE_VAL;
    for (int i = 0; i < polygon->count; ++i) {
        const texel_vertex a = polygon->vertex[i];
        const texel_vertex b = polygon->vertex[i + 1 < polygon->count ? i + 1 : 0];
        const double dx = b.x - a.x;
        const double dy = b.y - a.y;
        const double squared = dx * dx + dy * dy;
        const double along = squared > 0.0 ? ((centre.x - a.x) * dx + (centre.y - a.y) * dy) / squared : 0.0;
        const texel_vertex at = vertex_lerp(a, b, double_between(0.0, along, 1.0));
        const double distance = (at.x - centre.x) * (at.x - centre.x) + (at.y - centre.y) * (at.y - centre.y);
        if (distance < best_squared) {
            best_squared = distance;
            best = at;
        }
    }
    return best;
}

static texel_vertex polygon_middle(const texel_polygon *polygon)
{
    texel_vertex sum = {0.0, 0.0, 0.0, 0.0};
    for (int i = 0; i < polygon->count; ++i) {
        const texel_vertex at = polygon->vertex[i];
        sum = (texel_vertex){sum.x + at.x, sum.y + at.y, sum.u + at.u, sum.v + at.v};
    }
    const double n = polygon->count;
    return (texel_vertex){sum.x / n, sum.y / n, sum.u / n, sum.v / n};
}

/* Where the texel at (x, y) samples a triangle that covers `covered` of it. `centre` is the texel's, at `depth` in the
 * triangle. */
static lmb_texel_source texel_sample(const texel_polygon *covered, texel_vertex centre, double depth, uint32_t triangle)
{
    texel_vertex point = centre;
    if (depth < 0.0) {
        point = border_nearest(covered, centre);
        depth = 0.0;
    }
    const double distance =
        sqrt((point.x - centre.x) * (point.x - centre.x) + (point.y - centre.y) * (point.y - centre.y));
    if (depth < EDGE_MARGIN) {
        point = vertex_lerp(point, polygon_middle(covered), EDGE_PULL);
    }
    const float u = (float)double_between(0.0, point.u, 1.0);
    const float v = (float)double_between(0.0, point.v, 1.0 - (double)u);
    return (lmb_texel_source){triangle, u, v, (float)distance};
}

static bool range_touches(double low, double high, int32_t texel, double slack)
{
    return high > texel + slack && low < texel + 1 - slack;
}

static int32_t clamp_texel(double value, int32_t size)
{
    return value <= 0.0 ? 0 : value >= size - 1 ? size - 1 : (int32_t)value;
}

/* The part of a polygon between two lines a texel apart, and its range across them. */
static texel_polygon polygon_strip(const texel_polygon *polygon, bool along_y, int32_t texel, double *low, double *high)
{
    polygon_range(polygon, along_y, low, high);
    if (*low >= texel && *high <= texel + 1) {
        return *polygon;
    }
    const texel_polygon above = polygon_clip(polygon, along_y, texel, 1.0);
    const texel_polygon between = polygon_clip(&above, along_y, texel + 1, -1.0);
    polygon_range(&between, along_y, low, high);
    return between;
}

/* A triangle, its part in one row of texels, and by how much it must reach into one of them to count. */
typedef struct row_cover {
    const triangle_edges *edges;
    texel_polygon row;
    int32_t y;
    double slack;
    uint32_t triangle;
} row_cover;

/* Offers the triangle to the texel at `x`. Returns whether it reaches into it. */
static bool texel_cover(const row_cover *cover, int32_t x, lmb_texel_source *texel)
{
    const int32_t y = cover->y;
    const double slack = cover->slack;
    texel_polygon cell = {.count = 0};
    texel_vertex centre = {x + 0.5, y + 0.5, 0.0, 0.0};
    const double depth = triangle_depth(cover->edges, &centre);
    if (depth < WHOLE_DEPTH) {
        double low, high;
        cell = polygon_strip(&cover->row, false, x, &low, &high);
        if (cell.count == 0 || !range_touches(low, high, x, slack)) {
            return false;
        }
        polygon_range(&cell, true, &low, &high);
        if (!range_touches(low, high, y, slack)) {
            return false;
        }
    }
    const lmb_texel_source offer = texel_sample(&cell, centre, depth, cover->triangle);
    if (texel->triangle == LMB_TEXEL_UNCOVERED || offer.distance < texel->distance) {
        *texel = offer;
    }
    return true;
}

/* Offers a triangle to every texel that it reaches into by more than `slack`. Returns whether there was any. */
static bool triangle_cover(const texel_vertex corner[3], uint32_t triangle, const lmb_texel_grid *grid, double slack,
                           lmb_texel_source *source)
{
    const texel_polygon whole = {{corner[0], corner[1], corner[2]}, 3};
    const triangle_edges edges = triangle_edges_make(corner);
    double low, high;
    polygon_range(&whole, true, &low, &high);
    const int32_t last_row = clamp_texel(floor(high - slack), grid->height);
    bool touched = false;
    for (int32_t y = clamp_texel(floor(low + slack), grid->height); y <= last_row; ++y) {
        const row_cover cover = {&edges, polygon_strip(&whole, true, y, &low, &high), y, slack, triangle};
        if (cover.row.count == 0 || !range_touches(low, high, y, slack)) {
            continue;
        }
        polygon_range(&cover.row, false, &low, &high);
        const int32_t last = clamp_texel(floor(high - slack), grid->width);
        lmb_texel_source *texel = &source[(size_t)y * (size_t)grid->width];
        for (int32_t x = clamp_texel(floor(low + slack), grid->width); x <= last; ++x) {
            touched |= texel_cover(&cover, x, &texel[x]);
        }
    }
    return touched;
}

lmb_vec2 lmb_texels_corner_uv(const lmb_mesh *mesh, const lmb_vec2 *corner_uv, uint32_t triangle, int corner)
{
    assert(corner_uv || mesh->uv[1]);
    return corner_uv ? corner_uv[3 * (size_t)triangle + (size_t)corner] : mesh->uv[1][mesh->triangle[triangle][corner]];
}

static void triangle_in_texels(const lmb_mesh *mesh, const lmb_vec2 *corner_uv, const lmb_texel_grid *grid, uint32_t t,
                               texel_vertex corner[3])
{
    for (int k = 0; k < 3; ++k) {
        const lmb_vec2 uv = lmb_texels_corner_uv(mesh, corner_uv, t, k);
        corner[k] = (texel_vertex){(double)uv.x * grid->density - grid->shift_x,
                                   (double)uv.y * grid->density - grid->shift_y, k == 1, k == 2};
    }
}

void lmb_texels_pieces(const lmb_mesh *mesh, const lmb_vec2 *corner_uv, const lmb_texel_grid *grid, uint32_t triangle,
                       lmb_texel_piece_function visit, void *context)
{
    texel_polygon whole = {.count = 3};
    triangle_in_texels(mesh, corner_uv, grid, triangle, whole.vertex);
    for (int k = 0; k < 3; ++k) {
        whole.vertex[k].x -= 0.5;
        whole.vertex[k].y -= 0.5;
    }
    double low, high;
    polygon_range(&whole, true, &low, &high);
    const int32_t last_row = clamp_texel(floor(high) + 1.0, grid->height + 1) - 1;
    for (int32_t y = clamp_texel(floor(low) + 1.0, grid->height + 1) - 1; y <= last_row; ++y) {
        const texel_polygon row = polygon_strip(&whole, true, y, &low, &high);
        if (row.count == 0) {
            continue;
        }
        polygon_range(&row, false, &low, &high);
        const int32_t last = clamp_texel(floor(high) + 1.0, grid->width + 1) - 1;
        for (int32_t x = clamp_texel(floor(low) + 1.0, grid->width + 1) - 1; x <= last; ++x) {
            texel_polygon cell = polygon_strip(&row, false, x, &low, &high);
            for (int i = 0; i < cell.count; ++i) {
                cell.vertex[i].x -= x;
                cell.vertex[i].y -= y;
            }
            if (cell.count > 0) {
                visit(context, &(lmb_texel_piece){x, y, cell.count, cell.vertex});
            }
        }
    }
}

/* A point of a convex polygon, uniform over its area for uniform numbers; the first chooses the triangle of its fan. */
static texel_vertex polygon_point(const texel_polygon *polygon, const double fan_area[], double total, double first,
                                  double second)
{
    double left = first * total;
    int k = 0;
    while (k + 3 < polygon->count && left >= fan_area[k]) {
        left -= fan_area[k++];
    }
    const double share = fan_area[k] > 0.0 ? double_between(0.0, left / fan_area[k], 1.0) : 0.0;
    const double root = sqrt(share);
    const texel_vertex far_side = vertex_lerp(polygon->vertex[k + 1], polygon->vertex[k + 2], second);
    return vertex_lerp(polygon->vertex[0], far_side, root);
}

uint32_t lmb_texel_spread_points(const lmb_texel_spread *spread, uint64_t stream, uint32_t count, float (*weights)[2])
{
    assert(count <= LMB_RAY_BATCH);
    const int32_t x = spread->x, y = spread->y;
    texel_vertex corner[3];
    triangle_in_texels(spread->mesh, spread->corner_uv, spread->grid, spread->triangle, corner);
    texel_polygon covered = {{corner[0], corner[1], corner[2]}, 3};
    covered = polygon_clip(&covered, true, y, 1.0);
    covered = polygon_clip(&covered, true, y + 1, -1.0);
    covered = polygon_clip(&covered, false, x, 1.0);
    covered = polygon_clip(&covered, false, x + 1, -1.0);
    double fan_area[sizeof covered.vertex / sizeof covered.vertex[0]];
    double total = 0.0;
    for (int k = 0; k + 2 < covered.count; ++k) {
        fan_area[k] = fabs(cross_2d(covered.vertex[0], covered.vertex[k + 1], covered.vertex[k + 2]));
        total += fan_area[k];
    }
    if (!(total > 0.0)) {
        return 0;
    }
    const texel_vertex middle = polygon_middle(&covered);
    const triangle_edges edges = triangle_edges_make(corner);
    float first[LMB_RAY_BATCH], second[LMB_RAY_BATCH];
    lmb_sequence_2d_batch(stream, 0, count, 0, first, second);
    for (uint32_t i = 0; i < count; ++i) {
        texel_vertex point = polygon_point(&covered, fan_area, total, (double)first[i], (double)second[i]);
        if (triangle_depth(&edges, &point) < EDGE_MARGIN) {
            point = vertex_lerp(point, middle, EDGE_PULL);
        }
        weights[i][0] = (float)double_between(0.0, point.u, 1.0);
        weights[i][1] = (float)double_between(0.0, point.v, 1.0 - (double)weights[i][0]);
    }
    return count;
}

void lmb_texels_cover(const lmb_mesh *mesh, const lmb_vec2 *corner_uv, const lmb_texel_grid *grid,
                      lmb_texel_source *source)
{
    assert(grid->width > 0 && grid->height > 0);
    const size_t texels = (size_t)grid->width * (size_t)grid->height;
    for (size_t i = 0; i < texels; ++i) {
        source[i] = (lmb_texel_source){.triangle = LMB_TEXEL_UNCOVERED};
    }
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        texel_vertex corner[3];
        triangle_in_texels(mesh, corner_uv, grid, t, corner);
        /* A sliver may lie wholly in the slack of two texels: then it touches both. */
        if (!triangle_cover(corner, t, grid, TOUCH_SLACK, source)) {
            triangle_cover(corner, t, grid, -TOUCH_SLACK, source);
        }
    }
}
