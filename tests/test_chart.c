/* Lightmap charts and the check of given UVs. The checks here rasterise in doubles, apart from what they judge. */
#define _POSIX_C_SOURCE 200809L

#include <stdint.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include <lambent/chart.h>
#include <lambent/uv_check.h>
#include <lambent/file.h>
#include <lambent/gltf.h>

#include "harness.h"

/* A mesh with its own arrays, large enough for what the builders below add. */
typedef struct builder {
    lmb_mesh mesh;
    uint32_t vertex_capacity, triangle_capacity;
} builder;

static builder builder_make(uint32_t vertices, uint32_t triangles)
{
    builder b = {.vertex_capacity = vertices, .triangle_capacity = triangles};
    b.mesh.position = calloc(vertices + 1, sizeof *b.mesh.position);
    b.mesh.normal = calloc(vertices + 1, sizeof *b.mesh.normal);
    b.mesh.uv[1] = calloc(vertices + 1, sizeof *b.mesh.uv[1]);
    b.mesh.triangle = calloc(triangles + 1, sizeof *b.mesh.triangle);
    if (!b.mesh.position || !b.mesh.normal || !b.mesh.uv[1] || !b.mesh.triangle) {
        abort();
    }
    return b;
}

static void builder_free(builder *b)
{
    free(b->mesh.position);
    free(b->mesh.normal);
    free(b->mesh.uv[1]);
    free(b->mesh.triangle);
}

static uint32_t vertex_add(builder *b, float x, float y, float z)
{
    const uint32_t v = b->mesh.vertex_count++;
    if (v >= b->vertex_capacity) {
        abort();
    }
    b->mesh.position[v] = (lmb_vec3){x, y, z};
    return v;
}

static void triangle_add(builder *b, uint32_t i, uint32_t j, uint32_t k)
{
    const uint32_t t = b->mesh.triangle_count++;
    if (t >= b->triangle_capacity) {
        abort();
    }
    b->mesh.triangle[t][0] = i;
    b->mesh.triangle[t][1] = j;
    b->mesh.triangle[t][2] = k;
}

/* i j / l k: two triangles, counter-clockwise i j k l. */
static void quad_add(builder *b, uint32_t i, uint32_t j, uint32_t k, uint32_t l)
{
    triangle_add(b, i, j, k);
    triangle_add(b, i, k, l);
}

static void cross_of(const lmb_mesh *mesh, uint32_t t, double n[3])
{
    const lmb_vec3 *const p = mesh->position;
    const uint32_t *const v = mesh->triangle[t];
    const double u[3] = {(double)p[v[1]].x - (double)p[v[0]].x, (double)p[v[1]].y - (double)p[v[0]].y,
                         (double)p[v[1]].z - (double)p[v[0]].z};
    const double w[3] = {(double)p[v[2]].x - (double)p[v[0]].x, (double)p[v[2]].y - (double)p[v[0]].y,
                         (double)p[v[2]].z - (double)p[v[0]].z};
    n[0] = u[1] * w[2] - u[2] * w[1];
    n[1] = u[2] * w[0] - u[0] * w[2];
    n[2] = u[0] * w[1] - u[1] * w[0];
}

/* Normals of shared vertices are averages; vertices of one face have its normal. */
static void normals_make(builder *b)
{
    double(*const sum)[3] = calloc(b->mesh.vertex_count + 1, sizeof *sum);
    for (uint32_t t = 0; t < b->mesh.triangle_count && sum; ++t) {
        double n[3];
        cross_of(&b->mesh, t, n);
        for (int c = 0; c < 3; ++c) {
            for (int k = 0; k < 3; ++k) {
                sum[b->mesh.triangle[t][c]][k] += n[k];
            }
        }
    }
    for (uint32_t v = 0; v < b->mesh.vertex_count && sum; ++v) {
        const double length = sqrt(sum[v][0] * sum[v][0] + sum[v][1] * sum[v][1] + sum[v][2] * sum[v][2]);
        b->mesh.normal[v] = length > 0.0 ? (lmb_vec3){(float)(sum[v][0] / length), (float)(sum[v][1] / length),
                                                      (float)(sum[v][2] / length)}
                                         : (lmb_vec3){0.0f, 0.0f, 1.0f};
    }
    free(sum);
}

static uint32_t random_next(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(*state >> 33);
}

static float random_unit(uint64_t *state)
{
    return (float)(random_next(state) % 65536) / 65536.0f;
}

/* ---- meshes ---- */

static builder cube_make(bool shared)
{
    static const int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    static const int face[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 3, 7, 6}, {1, 2, 6, 5}, {3, 0, 4, 7}};
    builder b = builder_make(32, 12);
    for (int i = 0; i < 8 && shared; ++i) {
        vertex_add(&b, (float)corner[i][0], (float)corner[i][1], (float)corner[i][2]);
    }
    for (int f = 0; f < 6; ++f) {
        uint32_t v[4];
        for (int k = 0; k < 4; ++k) {
            const int *const p = corner[face[f][k]];
            v[k] = shared ? (uint32_t)face[f][k] : vertex_add(&b, (float)p[0], (float)p[1], (float)p[2]);
        }
        quad_add(&b, v[0], v[1], v[2], v[3]);
    }
    normals_make(&b);
    return b;
}

static builder sphere_make(uint32_t rings, uint32_t sectors)
{
    builder b = builder_make((rings + 1) * (sectors + 1), 2 * rings * sectors);
    for (uint32_t r = 0; r <= rings; ++r) {
        for (uint32_t s = 0; s <= sectors; ++s) {
            const double theta = 3.14159265358979 * r / rings;
            const double phi = s == sectors ? 0.0 : 2.0 * 3.14159265358979 * s / sectors;
            const double ring = r == 0 || r == rings ? 0.0 : sin(theta);
            vertex_add(&b, (float)(ring * cos(phi)), (float)cos(theta), (float)(-ring * sin(phi)));
            b.mesh.normal[b.mesh.vertex_count - 1] = b.mesh.position[b.mesh.vertex_count - 1];
        }
    }
    for (uint32_t r = 0; r < rings; ++r) {
        for (uint32_t s = 0; s < sectors; ++s) {
            const uint32_t v = r * (sectors + 1) + s;
            quad_add(&b, v, v + sectors + 1, v + sectors + 2, v + 1); /* at the poles half of them have no area */
        }
    }
    return b;
}

/* A ramp that winds over itself: all normals look up, and the turns cover each other. */
static builder helix_make(uint32_t turns, uint32_t steps)
{
    builder b = builder_make(2 * (turns * steps + 1), 2 * turns * steps);
    for (uint32_t i = 0; i <= turns * steps; ++i) {
        const double phi = 2.0 * 3.14159265358979 * i / steps;
        const float y = 3.0f * (float)i / (float)steps;
        vertex_add(&b, (float)(2.0 * cos(phi)), y, (float)(-2.0 * sin(phi)));
        vertex_add(&b, (float)(5.0 * cos(phi)), y, (float)(-5.0 * sin(phi)));
        if (i > 0) {
            const uint32_t v = b.mesh.vertex_count - 4;
            quad_add(&b, v, v + 1, v + 3, v + 2);
        }
    }
    normals_make(&b);
    return b;
}

static builder terrain_make(uint32_t side, float height)
{
    uint64_t state = 7;
    builder b = builder_make((side + 1) * (side + 1), 2 * side * side);
    for (uint32_t z = 0; z <= side; ++z) {
        for (uint32_t x = 0; x <= side; ++x) {
            vertex_add(&b, 0.25f * (float)x, height * random_unit(&state), 0.25f * (float)z);
        }
    }
    for (uint32_t z = 0; z < side; ++z) {
        for (uint32_t x = 0; x < side; ++x) {
            const uint32_t v = z * (side + 1) + x;
            quad_add(&b, v, v + side + 1, v + side + 2, v + 1);
        }
    }
    normals_make(&b);
    return b;
}

static builder soup_make(uint32_t count)
{
    uint64_t state = 99;
    builder b = builder_make(3 * count, count);
    for (uint32_t t = 0; t < count; ++t) {
        const float at[3] = {20.0f * random_unit(&state), 20.0f * random_unit(&state), 20.0f * random_unit(&state)};
        for (int c = 0; c < 3; ++c) {
            const float x = at[0] + random_unit(&state);
            const float y = at[1] + random_unit(&state);
            vertex_add(&b, x, y, at[2] + random_unit(&state));
        }
        triangle_add(&b, 3 * t, 3 * t + 1, 3 * t + 2);
    }
    normals_make(&b);
    return b;
}

/* One half turn more and the strip has a single side. */
static builder moebius_make(uint32_t steps)
{
    builder b = builder_make(2 * steps, 2 * steps);
    for (uint32_t i = 0; i < steps; ++i) {
        const double phi = 2.0 * 3.14159265358979 * i / steps;
        for (int side = -1; side <= 1; side += 2) {
            const double radius = 3.0 + side * cos(0.5 * phi);
            vertex_add(&b, (float)(radius * cos(phi)), (float)(side * sin(0.5 * phi)), (float)(radius * sin(phi)));
        }
        const uint32_t v = 2 * i;
        if (i + 1 < steps) {
            quad_add(&b, v, v + 1, v + 3, v + 2);
        } else {
            quad_add(&b, v, v + 1, 0, 1);
        }
    }
    normals_make(&b);
    return b;
}

/* ---- checks ---- */

typedef struct flat {
    double p[3][2]; /* in texels, counter-clockwise */
} flat;

static double flat_area(const flat *f)
{
    return 0.5 * ((f->p[1][0] - f->p[0][0]) * (f->p[2][1] - f->p[0][1]) -
                  (f->p[1][1] - f->p[0][1]) * (f->p[2][0] - f->p[0][0]));
}

static double flat_length(const flat *f)
{
    double longest = 0.0;
    for (int e = 0; e < 3; ++e) {
        const int next = (e + 1) % 3;
        longest = fmax(longest, hypot(f->p[next][0] - f->p[e][0], f->p[next][1] - f->p[e][1]));
    }
    return longest;
}

/* How far inside all edges a point is (negative: outside the one that it is furthest outside of). */
static double flat_depth(const flat *f, double x, double y)
{
    double depth = flat_area(f) > 1e-9 ? HUGE_VAL : -HUGE_VAL;
    for (int e = 0; e < 3; ++e) {
        const double *const a = f->p[e];
        const double *const b = f->p[(e + 1) % 3];
        const double length = sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
        if (length > 0.0) {
            depth = fmin(depth, ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / length);
        }
    }
    return depth;
}

static flat flat_of(const lmb_charts *charts, uint32_t t)
{
    flat f;
    for (int c = 0; c < 3; ++c) {
        const lmb_vec2 uv = charts->corner_uv[3 * (size_t)t + (size_t)c];
        f.p[c][0] = (double)uv.x * charts->resolution;
        f.p[c][1] = (double)uv.y * charts->resolution;
    }
    return f;
}

static void flat_range(const flat *f, int axis, double *low, double *high)
{
    *low = fmin(f->p[0][axis], fmin(f->p[1][axis], f->p[2][axis]));
    *high = fmax(f->p[0][axis], fmax(f->p[1][axis], f->p[2][axis]));
}

/* No point of a lattice four times as fine as the texels lies inside two triangles, whatever their charts. */
static int points_covered_twice(const lmb_mesh *mesh, const lmb_charts *charts)
{
    const int fine = 4 * charts->resolution;
    int twice = 0;
    unsigned char *const seen = calloc((size_t)fine, (size_t)fine);
    for (uint32_t t = 0; t < mesh->triangle_count && seen; ++t) {
        const flat f = flat_of(charts, t);
        double x0, x1, y0, y1;
        flat_range(&f, 0, &x0, &x1);
        flat_range(&f, 1, &y0, &y1);
        for (int y = (int)(4.0 * y0); y <= (int)(4.0 * y1) && y < fine; ++y) {
            for (int x = (int)(4.0 * x0); x <= (int)(4.0 * x1) && x < fine; ++x) {
                if (flat_depth(&f, (x + 0.5) / 4.0, (y + 0.5) / 4.0) > 1e-3) {
                    unsigned char *const cell = &seen[(size_t)y * (size_t)fine + (size_t)x];
                    twice += *cell;
                    *cell = 1;
                }
            }
        }
    }
    free(seen);
    return twice;
}

/* How far a triangle reaches into a texel, by the axis that tells them apart best; negative: not at all. */
static double flat_reach(const flat *f, int x, int y)
{
    double x0, x1, y0, y1;
    flat_range(f, 0, &x0, &x1);
    flat_range(f, 1, &y0, &y1);
    double reach = fmin(fmin(x1 - x, x + 1 - x0), fmin(y1 - y, y + 1 - y0));
    for (int e = 0; e < 3; ++e) {
        const double *const a = f->p[e];
        const double *const b = f->p[(e + 1) % 3];
        const double dx = b[0] - a[0], dy = b[1] - a[1], length = hypot(dx, dy);
        if (length > 0.0) {
            const double middle = (dx * (y + 0.5 - a[1]) - dy * (x + 0.5 - a[0])) / length;
            reach = fmin(reach, middle + 0.5 * (fabs(dx) + fabs(dy)) / length);
        }
    }
    return reach;
}

/* Marks every texel that a triangle touches by more than rounding, then looks for another chart's marks around each. */
static int gutter_violations(const lmb_mesh *mesh, const lmb_charts *charts, int gutter)
{
    const int size = charts->resolution;
    int wrong = 0;
    uint32_t *const owner = calloc((size_t)size * (size_t)size, sizeof *owner);
    for (uint32_t t = 0; t < mesh->triangle_count && owner; ++t) {
        const flat f = flat_of(charts, t);
        double x0, x1, y0, y1;
        flat_range(&f, 0, &x0, &x1);
        flat_range(&f, 1, &y0, &y1);
        for (int y = (int)(y0 + 2e-3); y <= (int)(y1 - 2e-3) && y < size; ++y) {
            for (int x = (int)(x0 + 2e-3); x <= (int)(x1 - 2e-3) && x < size; ++x) {
                if (flat_reach(&f, x, y) > 2e-3) {
                    owner[(size_t)y * (size_t)size + (size_t)x] = charts->chart[t] + 1;
                    wrong += x < gutter || y < gutter || x >= size - gutter || y >= size - gutter;
                }
            }
        }
    }
    for (int y = 0; y < size && owner; ++y) {
        for (int x = 0; x < size; ++x) {
            const uint32_t own = owner[(size_t)y * (size_t)size + (size_t)x];
            for (int k = 1; k <= gutter && own != 0; ++k) { /* right and down along rows and columns */
                const uint32_t right = x + k < size ? owner[(size_t)y * (size_t)size + (size_t)(x + k)] : 0;
                const uint32_t down = y + k < size ? owner[(size_t)(y + k) * (size_t)size + (size_t)x] : 0;
                const uint32_t both =
                    x + k < size && y + k < size ? owner[(size_t)(y + k) * (size_t)size + (size_t)(x + k)] : 0;
                wrong += (right != 0 && right != own) + (down != 0 && down != own) + (both != 0 && both != own);
            }
        }
    }
    free(owner);
    return wrong;
}

static void triangles_check(const char *name, const lmb_mesh *mesh, const lmb_charts *charts, double texels_per_m)
{
    double *const world = calloc(charts->chart_count + 1, sizeof *world);
    double *const texels = calloc(charts->chart_count + 1, sizeof *texels);
    int outside = 0;
    int mirrored = 0;
    int stretched = 0;
    for (uint32_t t = 0; t < mesh->triangle_count && world && texels; ++t) {
        double n[3];
        cross_of(mesh, t, n);
        const double area = 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        const flat f = flat_of(charts, t);
        for (int c = 0; c < 3; ++c) {
            outside += !(f.p[c][0] >= 0.0 && f.p[c][1] >= 0.0 && f.p[c][0] <= charts->resolution &&
                         f.p[c][1] <= charts->resolution);
        }
        if (charts->chart[t] >= charts->chart_count) {
            CHECK(false, "%s: triangle %u is in chart %u of %u", name, t, charts->chart[t], charts->chart_count);
            continue;
        }
        world[charts->chart[t]] += area;
        texels[charts->chart[t]] += flat_area(&f);
        const double ratio = flat_area(&f) / (area * texels_per_m * texels_per_m);
        const bool large = area * texels_per_m * texels_per_m > 0.5;
        /* A sliver may be turned over by the rounding of its corners to float: one step of it times its length. */
        const double rounding = ldexp(charts->resolution, -23);
        mirrored += flat_area(&f) < -rounding * (1.0 + flat_length(&f));
        stretched += large && !(ratio > 0.69 && ratio < 1.45);
    }
    CHECK(outside == 0 && mirrored == 0 && stretched == 0, "%s: %d corners outside, %d mirrored, %d stretched", name,
          outside, mirrored, stretched);
    for (uint32_t i = 0; i < charts->chart_count && world && texels; ++i) {
        const double density = sqrt(texels[i] / world[i]);
        if (texels[i] > 4.0) {
            CHECK_NEAR(density / texels_per_m, 1.0, 0.01, "%s: density of chart %u", name, i);
        }
    }
    free(world);
    free(texels);
}

static uint64_t charts_hash(const lmb_mesh *mesh, const lmb_charts *charts)
{
    uint64_t hash = lmb_hash(LMB_HASH_SEED, charts->corner_uv, 3 * (size_t)mesh->triangle_count * sizeof(lmb_vec2));
    return lmb_hash(hash, charts->chart, (size_t)mesh->triangle_count * sizeof(uint32_t));
}

/* Makes charts twice and checks all that the header promises. Returns their number, 0 on failure. */
static uint32_t charts_check(const char *name, const lmb_mesh *mesh, float texels_per_m, int32_t gutter, uint64_t *hash)
{
    lmb_charts charts;
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    const lmb_result result = lmb_charts_make(mesh, texels_per_m, gutter, NULL, &charts);
    clock_gettime(CLOCK_MONOTONIC, &end);
    if (result != LMB_OK) {
        CHECK(false, "%s: result %d", name, (int)result);
        return 0;
    }
    triangles_check(name, mesh, &charts, (double)texels_per_m);
    CHECK(charts.resolution % 4 == 0, "%s: resolution %d", name, charts.resolution);
    CHECK(points_covered_twice(mesh, &charts) == 0, "%s: charts cover each other", name);
    CHECK(gutter_violations(mesh, &charts, gutter) == 0, "%s: gutter", name);
    double used = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const flat f = flat_of(&charts, t);
        used += flat_area(&f) / charts.resolution / charts.resolution;
    }
    const double seconds = (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    printf("     %s: %u triangles, %u charts, %d^2 texels, %.0f %% used, %.3f s\n", name, mesh->triangle_count,
           charts.chart_count, charts.resolution, 100.0 * used, seconds);
    lmb_charts again;
    lmb_pool *pool;
    CHECK(lmb_pool_create(3, &pool) == LMB_OK, "pool");
    if (lmb_charts_make(mesh, texels_per_m, gutter, pool, &again) == LMB_OK) {
        CHECK(charts_hash(mesh, &charts) == charts_hash(mesh, &again), "%s: not the same by three threads", name);
        lmb_charts_free(&again);
    }
    lmb_pool_destroy(pool);
    if (hash) {
        *hash = charts_hash(mesh, &charts);
    }
    const uint32_t count = charts.chart_count;
    lmb_charts_free(&charts);
    return count;
}

/* ---- cases ---- */

static void cubes(void)
{
    builder b = cube_make(false);
    CHECK(charts_check("cube", &b.mesh, 16.0f, 2, NULL) == 6, "one chart a side");
    CHECK(charts_check("small cube", &b.mesh, 1.0f, 2, NULL) == 6, "one texel a side");
    CHECK(charts_check("tiny cube", &b.mesh, 0.01f, 2, NULL) == 1, "one texel for what shows nothing");
    CHECK(charts_check("cube, no gutter", &b.mesh, 16.0f, 0, NULL) == 6, "no gutter");
    builder_free(&b);
    b = cube_make(true);
    CHECK(charts_check("cube, averaged normals", &b.mesh, 10.3f, 3, NULL) == 6, "lean separates the sides");
    builder_free(&b);
}

static void packing_is_tight_where_it_can_be(void)
{
    builder b = cube_make(false); /* six boxes of 16 + 2 texels: a square of 3 x 18 + 2 holds them */
    lmb_charts charts;
    if (lmb_charts_make(&b.mesh, 16.0f, 2, NULL, &charts) == LMB_OK) {
        CHECK(charts.resolution == 56, "resolution %d", charts.resolution);
        for (uint32_t t = 0; t < 12; ++t) { /* sides of whole texels lie on whole texels */
            const flat f = flat_of(&charts, t);
            for (int c = 0; c < 6; ++c) {
                const double at = f.p[c / 2][c % 2];
                CHECK_NEAR(at, floor(at + 0.5), 1e-4, "triangle %u", t);
            }
        }
        lmb_charts_free(&charts);
    }
    builder_free(&b);
}

/* A quad of its own vertices. */
static void square_add(builder *b, const float origin[3], const float u[3], const float v[3])
{
    uint32_t corner[4];
    for (int k = 0; k < 4; ++k) {
        const float along_u = k == 1 || k == 2 ? 1.0f : 0.0f, along_v = k >= 2 ? 1.0f : 0.0f;
        corner[k] =
            vertex_add(b, origin[0] + along_u * u[0] + along_v * v[0], origin[1] + along_u * u[1] + along_v * v[1],
                       origin[2] + along_u * u[2] + along_v * v[2]);
    }
    quad_add(b, corner[0], corner[1], corner[2], corner[3]);
}

/* A frame of 40 texels around a hole of 24, and what just fits into that with its gutters. */
static void packing_fills_holes(void)
{
    builder b = builder_make(64, 32);
    static const float joints[4][2] = {{8, 8}, {32, 8}, {32, 32}, {8, 32}};
    uint32_t outer[4], inner[4];
    for (int k = 0; k < 4; ++k) {
        outer[k] = vertex_add(&b, k == 1 || k == 2 ? 40.0f : 0.0f, k >= 2 ? 40.0f : 0.0f, 0);
        inner[k] = vertex_add(&b, joints[k][0], joints[k][1], 0);
    }
    for (int k = 0; k < 4; ++k) {
        quad_add(&b, outer[k], outer[(k + 1) % 4], inner[(k + 1) % 4], inner[k]);
    }
    for (int k = 0; k < 4; ++k) {
        square_add(&b, (float[3]){0, 0, (float)(k + 1)}, (float[3]){9, 0, 0}, (float[3]){0, 9, 0});
    }
    normals_make(&b);
    lmb_charts charts;
    CHECK(charts_check("frame", &b.mesh, 1.0f, 2, NULL) == 5, "a frame and four squares");
    if (lmb_charts_make(&b.mesh, 1.0f, 2, NULL, &charts) == LMB_OK) {
        CHECK(charts.resolution == 44, "resolution %d", charts.resolution);
        lmb_charts_free(&charts);
    }
    builder_free(&b);
}

/* Two walls of 20 x 20 texels at a right angle, with a strip at 45 degrees between them. */
static builder bevel_make(float width)
{
    builder b = builder_make(12, 6);
    const float d = 0.70710678f * width;
    square_add(&b, (float[3]){0, 0, 0}, (float[3]){20, 0, 0}, (float[3]){0, 0, -20});
    square_add(&b, (float[3]){0, 0, -20}, (float[3]){20, 0, 0}, (float[3]){0, d, -d});
    square_add(&b, (float[3]){0, d, -20 - d}, (float[3]){20, 0, 0}, (float[3]){0, 20, 0});
    normals_make(&b);
    return b;
}

static void small_charts_are_joined(void)
{
    static const struct {
        const char *name;
        float width;
        uint32_t charts;
    } cases[] = {{"hair bevel", 0.01f, 2}, {"narrow bevel", 0.15f, 2}, {"wide bevel", 2.0f, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        builder b = bevel_make(cases[i].width);
        const uint32_t count = charts_check(cases[i].name, &b.mesh, 1.0f, 2, NULL);
        CHECK(count == cases[i].charts, "%s: %u charts", cases[i].name, count);
        builder_free(&b);
    }
    /* A rim at a right angle joins the floor when it is a sliver, and has texels of its own when it shows. */
    static const float heights[] = {0.1f, 1.0f};
    for (int i = 0; i < 2; ++i) {
        builder b = builder_make(8, 4);
        square_add(&b, (float[3]){0, 0, 0}, (float[3]){20, 0, 0}, (float[3]){0, 0, -20});
        square_add(&b, (float[3]){0, 0, -20}, (float[3]){20, 0, 0}, (float[3]){0, heights[i], 0});
        normals_make(&b);
        const uint32_t count = charts_check("rim", &b.mesh, 0.7f, 2, NULL);
        CHECK(count == (i == 0 ? 1 : 2), "rim of %g: %u charts", (double)heights[i], count);
        builder_free(&b);
    }
}

static void curved_meshes(void)
{
    builder b = sphere_make(32, 64);
    const uint32_t count = charts_check("sphere", &b.mesh, 30.0f, 2, NULL);
    CHECK(count >= 6 && count <= 24, "sphere: %u charts", count);
    builder_free(&b);
    b = helix_make(4, 40);
    CHECK(charts_check("helix", &b.mesh, 8.0f, 2, NULL) >= 4, "a chart covers at most one turn");
    builder_free(&b);
    b = moebius_make(60);
    charts_check("moebius strip", &b.mesh, 12.0f, 2, NULL);
    builder_free(&b);
}

static void rough_meshes(void)
{
    builder b = terrain_make(40, 0.3f);
    charts_check("terrain", &b.mesh, 10.0f, 2, NULL);
    builder_free(&b);
    b = soup_make(2000);
    CHECK(charts_check("soup", &b.mesh, 6.0f, 1, NULL) == 2000, "nothing to join");
    builder_free(&b);
}

/* Three half planes that share an edge, a plane modelled twice back to back, and a plane given twice. */
static void non_manifold_meshes(void)
{
    builder b = builder_make(64, 64);
    const uint32_t low = vertex_add(&b, 0, 0, 0);
    const uint32_t high = vertex_add(&b, 0, 1, 0);
    static const float ends[3][2] = {{1, 0}, {-1, 0.2f}, {-1, -0.2f}};
    for (int i = 0; i < 3; ++i) {
        quad_add(&b, low, vertex_add(&b, ends[i][0], 0, ends[i][1]), vertex_add(&b, ends[i][0], 1, ends[i][1]), high);
    }
    normals_make(&b);
    charts_check("three at an edge", &b.mesh, 16.0f, 2, NULL);
    builder_free(&b);

    for (int back = 0; back < 2; ++back) {
        b = builder_make(64, 64);
        for (int layer = 0; layer < 2; ++layer) {
            uint32_t v[9];
            for (int i = 0; i < 9; ++i) {
                v[i] = vertex_add(&b, (float)(i % 3), 0, -(float)(i / 3));
            }
            for (int i = 0; i < 4; ++i) {
                const int k = i / 2 * 3 + i % 2;
                if (back && layer == 1) {
                    quad_add(&b, v[k], v[k + 3], v[k + 4], v[k + 1]);
                } else {
                    quad_add(&b, v[k], v[k + 1], v[k + 4], v[k + 3]);
                }
            }
        }
        normals_make(&b);
        CHECK(charts_check(back ? "back to back" : "given twice", &b.mesh, 8.0f, 2, NULL) == 2, "one chart a layer");
        builder_free(&b);
    }
}

static void degenerate_triangles_do_no_harm(void)
{
    builder b = cube_make(false);
    b.triangle_capacity = 12;
    builder more = builder_make(64, 64);
    for (uint32_t v = 0; v < b.mesh.vertex_count; ++v) {
        vertex_add(&more, b.mesh.position[v].x, b.mesh.position[v].y, b.mesh.position[v].z);
    }
    triangle_add(&more, 0, 0, 0);
    for (uint32_t t = 0; t < 12; ++t) {
        triangle_add(&more, b.mesh.triangle[t][0], b.mesh.triangle[t][1], b.mesh.triangle[t][2]);
    }
    triangle_add(&more, 5, 6, 5);
    const uint32_t far = vertex_add(&more, 9, 9, 9);
    triangle_add(&more, far, far, far);                          /* touches nothing */
    triangle_add(&more, 0, vertex_add(&more, 0.5f, 0.5f, 0), 2); /* on a diagonal */
    normals_make(&more);
    CHECK(charts_check("cube with degenerates", &more.mesh, 16.0f, 2, NULL) == 6, "no charts of their own");
    builder_free(&b);
    builder_free(&more);

    b = builder_make(8, 4);
    vertex_add(&b, 1, 1, 1);
    triangle_add(&b, 0, 0, 0);
    triangle_add(&b, 0, 0, 0);
    normals_make(&b);
    CHECK(charts_check("nothing but a point", &b.mesh, 16.0f, 2, NULL) == 1, "one chart");
    b.mesh.triangle_count = 0;
    lmb_charts charts;
    CHECK(lmb_charts_make(&b.mesh, 16.0f, 2, NULL, &charts) == LMB_OK && charts.chart_count == 0, "empty mesh");
    lmb_charts_free(&charts);
    builder_free(&b);
}

static void impossible_requests_are_refused(void)
{
    builder b = cube_make(false);
    static const struct {
        float density;
        int32_t gutter;
    } cases[] = {{0.0f, 2}, {-1.0f, 2}, {NAN, 2}, {INFINITY, 2}, {1e6f, 2}, {3e38f, 2}, {15000.0f, 2}, {10.0f, -1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_charts charts = {.resolution = 77};
        const lmb_result result = lmb_charts_make(&b.mesh, cases[i].density, cases[i].gutter, NULL, &charts);
        CHECK(result == LMB_ERROR_ARGUMENT && charts.resolution == 77, "case %zu: %d", i, (int)result);
    }
    builder_free(&b);
}

static void result_is_the_same_everywhere(void)
{
    uint64_t hash = 0;
    builder b = terrain_make(24, 0.4f);
    charts_check("golden terrain", &b.mesh, 9.0f, 2, &hash);
    CHECK(hash == UINT64_C(0xed827ef68ec46ea6), "terrain: 0x%016llx", (unsigned long long)hash);
    builder_free(&b);
    b = soup_make(300);
    charts_check("golden soup", &b.mesh, 5.0f, 1, &hash);
    CHECK(hash == UINT64_C(0x37f1cf836b03bb5e), "soup: 0x%016llx", (unsigned long long)hash);
    builder_free(&b);
}

static void large_meshes_take_seconds_at_most(void)
{
    builder b = terrain_make(224, 0.2f); /* 100 352 triangles, mostly in few charts */
    struct timespec start, end;
    lmb_charts charts;
    clock_gettime(CLOCK_MONOTONIC, &start);
    if (lmb_charts_make(&b.mesh, 8.0f, 2, NULL, &charts) == LMB_OK) {
        clock_gettime(CLOCK_MONOTONIC, &end);
        const double seconds = (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
        printf("     %u triangles, %u charts, %.2f s\n", b.mesh.triangle_count, charts.chart_count, seconds);
        CHECK(seconds < 20.0, "%.2f s", seconds);
        lmb_charts_free(&charts);
    }
    builder_free(&b);
}

/* ---- given UVs ---- */

static void given_uvs_are_judged(void)
{
    static const struct {
        const char *what;
        float uv[4][2]; /* of the first quad, and below of the second */
        float other[4][2];
        lmb_uv_fault fault;
    } cases[] = {
        {"side by side", {{0, 0}, {.5f, 0}, {.5f, 1}, {0, 1}}, {{.5f, 0}, {1, 0}, {1, 1}, {.5f, 1}}, LMB_UV_GOOD},
        {"mirrored", {{.5f, 0}, {0, 0}, {0, 1}, {.5f, 1}}, {{.5f, 0}, {1, 0}, {1, 1}, {.5f, 1}}, LMB_UV_GOOD},
        {"odd places",
         {{.013f, .017f}, {.47f, .11f}, {.44f, .93f}, {.07f, .88f}},
         {{.51f, .02f}, {.97f, .13f}, {.91f, .97f}, {.55f, .91f}},
         LMB_UV_GOOD},
        {"the same twice", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, LMB_UV_OVERLAPPING},
        {"mirrored onto it", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{1, 0}, {0, 0}, {0, 1}, {1, 1}}, LMB_UV_OVERLAPPING},
        {"5 % over",
         {{0, 0}, {.525f, 0}, {.525f, 1}, {0, 1}},
         {{.475f, 0}, {1, 0}, {1, 1}, {.475f, 1}},
         LMB_UV_OVERLAPPING},
        {"half a texel over",
         {{0, 0}, {.504f, 0}, {.504f, 1}, {0, 1}},
         {{.5f, 0}, {1, 0}, {1, 1}, {.5f, 1}},
         LMB_UV_GOOD},
        {"tiled", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, {{.5f, 0}, {1, 0}, {1, 1}, {.5f, 1}}, LMB_UV_OUT_OF_RANGE},
        {"negative",
         {{-.1f, 0}, {.5f, 0}, {.5f, 1}, {0, 1}},
         {{.5f, 0}, {1, 0}, {1, 1}, {.5f, 1}},
         LMB_UV_OUT_OF_RANGE},
        {"not a number",
         {{0, 0}, {.5f, 0}, {.5f, NAN}, {0, 1}},
         {{.5f, 0}, {1, 0}, {1, 1}, {.5f, 1}},
         LMB_UV_OUT_OF_RANGE},
        {"rounded",
         {{-1e-6f, 0}, {.5f, 0}, {.5f, 1.000001f}, {0, 1}},
         {{.5f, 0}, {1, 0}, {1, 1}, {.5f, 1}},
         LMB_UV_GOOD},
        {"one has none", {{0, 0}, {.5f, 0}, {.5f, 1}, {0, 1}}, {{1, 1}, {1, 1}, {1, 1}, {1, 1}}, LMB_UV_DEGENERATE},
        {"all in a line",
         {{0, 0}, {.5f, .5f}, {.25f, .25f}, {1, 1}},
         {{0, 0}, {.5f, .5f}, {.25f, .25f}, {1, 1}},
         LMB_UV_DEGENERATE},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        builder b = builder_make(8, 4);
        for (int quad = 0; quad < 2; ++quad) {
            uint32_t v[4];
            for (int k = 0; k < 4; ++k) {
                v[k] = vertex_add(&b, (float)(k == 1 || k == 2), (float)(k / 2), (float)quad);
                const float *const uv = quad ? cases[i].other[k] : cases[i].uv[k];
                b.mesh.uv[1][v[k]] = (lmb_vec2){uv[0], uv[1]};
            }
            quad_add(&b, v[0], v[1], v[2], v[3]);
        }
        lmb_uv_fault fault = (lmb_uv_fault)-1;
        CHECK(lmb_uv_check(&b.mesh, 128, &fault) == LMB_OK && fault == cases[i].fault, "%s: %s, expected %s",
              cases[i].what, lmb_uv_fault_text(fault), lmb_uv_fault_text(cases[i].fault));
        builder_free(&b);
    }
    builder b = cube_make(false);
    free(b.mesh.uv[1]);
    b.mesh.uv[1] = NULL;
    lmb_uv_fault fault = LMB_UV_GOOD;
    CHECK(lmb_uv_check(&b.mesh, 128, &fault) == LMB_OK && fault == LMB_UV_MISSING, "missing");
    builder_free(&b);
}

/* A fan of many triangles whose shared edges run through texel centres: each centre counts once. */
static void shared_edges_count_once(void)
{
    enum { SIDE = 8 };
    builder b = builder_make(4 * SIDE + 1, 4 * SIDE);
    const uint32_t middle = vertex_add(&b, 0, 0, 0);
    b.mesh.uv[1][middle] = (lmb_vec2){.5f + .5f / 16, .5f + .5f / 16}; /* a centre of 16 x 16 texels */
    for (int i = 0; i < 4 * SIDE; ++i) {
        const float along = (float)(i % SIDE) / SIDE;
        const float u[4] = {along, 1, 1 - along, 0};
        const float v[4] = {0, along, 1, 1 - along};
        const uint32_t k = vertex_add(&b, u[i / SIDE], v[i / SIDE], 0);
        b.mesh.uv[1][k] = (lmb_vec2){u[i / SIDE], v[i / SIDE]};
        triangle_add(&b, middle, k, i + 1 < 4 * SIDE ? k + 1 : 1);
    }
    lmb_uv_fault fault = LMB_UV_MISSING;
    CHECK(lmb_uv_check(&b.mesh, 16, &fault) == LMB_OK && fault == LMB_UV_GOOD, "%s", lmb_uv_fault_text(fault));
    builder_free(&b);
}

/* Our own charts pass our own check: two rasterisers, one answer. */
static void charts_pass_the_check(void)
{
    builder source = terrain_make(30, 0.5f);
    lmb_charts charts;
    if (lmb_charts_make(&source.mesh, 12.0f, 1, NULL, &charts) == LMB_OK) {
        builder b = builder_make(3 * source.mesh.triangle_count, source.mesh.triangle_count);
        for (uint32_t i = 0; i < 3 * source.mesh.triangle_count; ++i) {
            const lmb_vec3 p = source.mesh.position[source.mesh.triangle[i / 3][i % 3]];
            b.mesh.uv[1][vertex_add(&b, p.x, p.y, p.z)] = charts.corner_uv[i];
            if (i % 3 == 2) {
                triangle_add(&b, i - 2, i - 1, i);
            }
        }
        lmb_uv_fault fault = LMB_UV_MISSING;
        CHECK(lmb_uv_check(&b.mesh, charts.resolution, &fault) == LMB_OK && fault == LMB_UV_GOOD, "%s",
              lmb_uv_fault_text(fault));
        builder_free(&b);
        lmb_charts_free(&charts);
    }
    builder_free(&source);
}

/* Real levels: charts for every mesh that a level is likely to need them for, and a verdict on UVs that people made. */
static void real_levels(void)
{
    static const struct {
        const char *path;
        double texels_across;  /* the density: this many over the mesh's longest extent */
        lmb_uv_fault given[2]; /* of the first and of the other meshes that bring UVs */
    } cases[] = {
        /* The house's first mesh covers 1.4 % of its texels twice, at any resolution. */
        {"cornell_bevy/CornellBox.glb", 100, {LMB_UV_GOOD, LMB_UV_GOOD}},
        {"house_playcanvas/house.glb", 200, {LMB_UV_OVERLAPPING, LMB_UV_GOOD}},
        {"room_r3l/tile-game-room6.glb", 200, {LMB_UV_GOOD, LMB_UV_GOOD}},
        {"map_turbine/turbine.glb", 150, {LMB_UV_GOOD, LMB_UV_GOOD}},
        {"living_room_godot/living_room.glb", 200, {LMB_UV_GOOD, LMB_UV_GOOD}},
        {"zdm2_godot/zdm2.glb", 250, {LMB_UV_GOOD, LMB_UV_GOOD}},
        {"cornell_babylon/cornellBox.glb", 100, {LMB_UV_GOOD, LMB_UV_GOOD}},
        {"fps_level_cge/example_level.gltf", 100, {LMB_UV_GOOD, LMB_UV_GOOD}},
    };
    if (access(LMB_DATA_DIR "/scenes", R_OK) != 0) {
        test_skip("no levels here");
        return;
    }
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char path[1024];
        snprintf(path, sizeof path, LMB_DATA_DIR "/scenes/%s", cases[i].path);
        lmb_scene *scene = NULL;
        lmb_error error = {""};
        if (lmb_gltf_load(path, NULL, &scene, &error) != LMB_OK) {
            CHECK(false, "%s", error.message);
            continue;
        }
        for (uint32_t m = 0; m < scene->mesh_count; ++m) {
            const lmb_mesh *const mesh = &scene->meshes[m];
            double extent = 0.0;
            for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
                const lmb_vec3 p = mesh->position[v];
                const lmb_vec3 o = mesh->position[0];
                extent = fmax(extent, fmax(fabs((double)p.x - (double)o.x),
                                           fmax(fabs((double)p.y - (double)o.y), fabs((double)p.z - (double)o.z))));
            }
            if (mesh->triangle_count == 0 || extent <= 0.0) {
                continue;
            }
            char name[256];
            snprintf(name, sizeof name, "%.80s mesh %u", cases[i].path, m);
            charts_check(name, mesh, (float)(cases[i].texels_across / extent), 2, NULL);
            lmb_uv_fault fault = LMB_UV_MISSING;
            CHECK(lmb_uv_check(mesh, 512, &fault) == LMB_OK, "%s", name);
            const lmb_uv_fault expected = mesh->uv[1] ? cases[i].given[m > 0] : LMB_UV_MISSING;
            CHECK(fault == expected, "%s: %s", name, lmb_uv_fault_text(fault));
        }
        lmb_scene_destroy(scene);
    }
}

static const test_case CASES[] = {
    {"cubes", cubes},
    {"packing is tight where it can be", packing_is_tight_where_it_can_be},
    {"packing fills holes", packing_fills_holes},
    {"small charts are joined", small_charts_are_joined},
    {"curved meshes", curved_meshes},
    {"rough meshes", rough_meshes},
    {"non-manifold meshes", non_manifold_meshes},
    {"degenerate triangles do no harm", degenerate_triangles_do_no_harm},
    {"impossible requests are refused", impossible_requests_are_refused},
    {"result is the same everywhere", result_is_the_same_everywhere},
    {"large meshes take seconds at most", large_meshes_take_seconds_at_most},
    {"given uvs are judged", given_uvs_are_judged},
    {"shared edges count once", shared_edges_count_once},
    {"charts pass the check", charts_pass_the_check},
    {"real levels", real_levels},
};

TEST_MAIN(CASES)
