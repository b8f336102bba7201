#include <lambent/uv_check.h>

#include <assert.h>
#include <math.h>
#include <stdlib.h>

/* How far outside [0, 1] a corner may lie: what exporters round. */
static const double RANGE_SLACK = 1e-3;
/* Share of the mesh's area, and of the covered texels, that may be at fault. */
static const double FAULT_SHARE = 0.01;
/* Less than this part of the area that the mesh's mean density would give counts as no area. */
static const double DEGENERATE_SHARE = 1e-6;

/* Corners are rounded to 1/256 texel: then the edge functions are exact in 64 bits, and a texel centre on an edge that
 * two triangles share belongs to exactly one of them. */
enum { SUBTEXELS = 256, MAX_CHECK_RESOLUTION = 1 << 15 };

typedef struct point {
    int64_t x, y;
} point;

typedef struct coverage {
    int32_t resolution;
    unsigned char *texels; /* 0, 1, or 2: covered more than once */
    size_t covered, twice;
} coverage;

const char *lmb_uv_fault_text(lmb_uv_fault fault)
{
    switch (fault) {
    case LMB_UV_GOOD:
        return "usable lightmap UVs";
    case LMB_UV_MISSING:
        return "no lightmap UVs";
    case LMB_UV_OUT_OF_RANGE:
        return "lightmap UVs outside the unit square";
    case LMB_UV_DEGENERATE:
        return "lightmap UVs without area";
    case LMB_UV_OVERLAPPING:
        return "overlapping lightmap UVs";
    }
    return "unknown fault of lightmap UVs";
}

static bool corner_is_in_range(lmb_vec2 uv)
{
    /* false for NaN */
    return (double)uv.x >= -RANGE_SLACK && (double)uv.x <= 1.0 + RANGE_SLACK && (double)uv.y >= -RANGE_SLACK &&
           (double)uv.y <= 1.0 + RANGE_SLACK;
}

static double world_area(const lmb_mesh *mesh, uint32_t t)
{
    const lmb_vec3 a = mesh->position[mesh->triangle[t][0]];
    const lmb_vec3 b = mesh->position[mesh->triangle[t][1]];
    const lmb_vec3 c = mesh->position[mesh->triangle[t][2]];
    const double u[3] = {(double)b.x - (double)a.x, (double)b.y - (double)a.y, (double)b.z - (double)a.z};
    const double v[3] = {(double)c.x - (double)a.x, (double)c.y - (double)a.y, (double)c.z - (double)a.z};
    const double cross[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    return 0.5 * sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
}

static double uv_area(const lmb_mesh *mesh, uint32_t t)
{
    const lmb_vec2 a = mesh->uv[1][mesh->triangle[t][0]];
    const lmb_vec2 b = mesh->uv[1][mesh->triangle[t][1]];
    const lmb_vec2 c = mesh->uv[1][mesh->triangle[t][2]];
    return 0.5 * fabs(((double)b.x - (double)a.x) * ((double)c.y - (double)a.y) -
                      ((double)b.y - (double)a.y) * ((double)c.x - (double)a.x));
}

static bool area_is_missing(const lmb_mesh *mesh)
{
    double world = 0.0;
    double uv = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        world += world_area(mesh, t);
        uv += uv_area(mesh, t);
    }
    double missing = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const double area = world_area(mesh, t);
        if (uv_area(mesh, t) * world <= DEGENERATE_SHARE * area * uv) {
            missing += area;
        }
    }
    return missing > FAULT_SHARE * world;
}

/* > 0 left of the edge; on it, 0 for one of the two directions that it can be walked in and -1 for the other. */
static int64_t edge_value(point from, point to, point p)
{
    const int64_t dx = to.x - from.x;
    const int64_t dy = to.y - from.y;
    const bool owns = dy > 0 || (dy == 0 && dx < 0);
    return dx * (p.y - from.y) - dy * (p.x - from.x) - (owns ? 0 : 1);
}

static int64_t clamp(int64_t value, int64_t low, int64_t high)
{
    return value < low ? low : value > high ? high : value;
}

static int64_t floor_divide(int64_t a, int64_t b)
{
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

static int64_t least(int64_t a, int64_t b, int64_t c)
{
    const int64_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

static void triangle_cover(coverage *map, point a, point b, point c)
{
    const int64_t doubled_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (doubled_area == 0) {
        return;
    }
    if (doubled_area < 0) {
        const point swapped = b;
        b = c;
        c = swapped;
    }
    const int64_t last = map->resolution - 1;
    const int64_t x0 = clamp(floor_divide(least(a.x, b.x, c.x), SUBTEXELS), 0, last);
    const int64_t y0 = clamp(floor_divide(least(a.y, b.y, c.y), SUBTEXELS), 0, last);
    const int64_t x1 = clamp(floor_divide(-least(-a.x, -b.x, -c.x), SUBTEXELS), 0, last);
    const int64_t y1 = clamp(floor_divide(-least(-a.y, -b.y, -c.y), SUBTEXELS), 0, last);
    for (int64_t y = y0; y <= y1; ++y) {
        unsigned char *const row = map->texels + (size_t)y * (size_t)map->resolution;
        for (int64_t x = x0; x <= x1; ++x) {
            const point centre = {x * SUBTEXELS + SUBTEXELS / 2, y * SUBTEXELS + SUBTEXELS / 2};
            if (edge_value(a, b, centre) >= 0 && edge_value(b, c, centre) >= 0 && edge_value(c, a, centre) >= 0) {
                map->covered += row[x] == 0 ? 1 : 0;
                map->twice += row[x] == 1 ? 1 : 0;
                row[x] = row[x] < 2 ? row[x] + 1 : 2;
            }
        }
    }
}

static point corner_round(lmb_vec2 uv, int32_t resolution)
{
    const double scale = (double)resolution * SUBTEXELS;
    return (point){(int64_t)floor((double)uv.x * scale + 0.5), (int64_t)floor((double)uv.y * scale + 0.5)};
}

lmb_result lmb_uv_check(const lmb_mesh *mesh, int32_t resolution, lmb_uv_fault *fault)
{
    assert(mesh && fault && resolution > 0 && resolution <= MAX_CHECK_RESOLUTION);
    if (resolution < 1 || resolution > MAX_CHECK_RESOLUTION) {
        return LMB_ERROR_ARGUMENT;
    }
    if (!mesh->uv[1]) {
        *fault = LMB_UV_MISSING;
        return LMB_OK;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        for (int c = 0; c < 3; ++c) {
            if (!corner_is_in_range(mesh->uv[1][mesh->triangle[t][c]])) {
                *fault = LMB_UV_OUT_OF_RANGE;
                return LMB_OK;
            }
        }
    }
    if (area_is_missing(mesh)) {
        *fault = LMB_UV_DEGENERATE;
        return LMB_OK;
    }
    coverage map = {resolution, calloc((size_t)resolution, (size_t)resolution), 0, 0};
    if (!map.texels) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const uint32_t *const v = mesh->triangle[t];
        triangle_cover(&map, corner_round(mesh->uv[1][v[0]], resolution), corner_round(mesh->uv[1][v[1]], resolution),
                       corner_round(mesh->uv[1][v[2]], resolution));
    }
    free(map.texels);
    *fault = (double)map.twice > FAULT_SHARE * (double)map.covered ? LMB_UV_OVERLAPPING : LMB_UV_GOOD;
    return LMB_OK;
}
