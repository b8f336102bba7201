/* Rays in batches against single ones, and through see-through layers against what the layers let through by hand. */
#include <float.h>

#include "level_fixture.h"
#include "scenes/level_builder.h"
#include "variates.h"

static float between(uint64_t *state, float low, float high)
{
    return low + (high - low) * (float)variate_next(state);
}

static lmb_vec3 point_next(uint64_t *state)
{
    const float x = between(state, -1.0f, 1.0f), y = between(state, -1.0f, 1.0f);
    return (lmb_vec3){x, y, between(state, -1.0f, 1.0f)};
}

/* 3000 small triangles in a cube. */
static bool soup_open(level_fixture *level)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const lmb_level_material grey = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &grey);
    const int soup = lmb_level_builder_add_mesh(builder, "soup");
    uint64_t state = 1;
    for (int i = 0; i < 3000; ++i) {
        const lmb_vec3 a = point_next(&state), b = point_next(&state), c = point_next(&state);
        lmb_level_builder_add_triangle(builder, soup, material, a,
                                       (lmb_vec3){a.x + 0.1f * b.x, a.y + 0.1f * b.y, a.z + 0.1f * b.z},
                                       (lmb_vec3){a.x + 0.1f * c.x, a.y + 0.1f * c.y, a.z + 0.1f * c.z});
    }
    lmb_level_builder_place(builder, "soup", soup, (lmb_vec3){0, 0, 0});
    lmb_error error = {{0}};
    const char *path = LMB_TEST_OUTPUT_DIR "/soup.glb";
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    return level_fixture_open(level, path, written, &error, 1);
}

static lmb_ray_batch batch_next(uint64_t *state, uint32_t count)
{
    lmb_ray_batch rays = {.count = count};
    for (uint32_t i = 0; i < count; ++i) {
        const lmb_vec3 from = point_next(state), along = point_next(state);
        const float origin[3] = {from.x, from.y, from.z}, direction[3] = {along.x, along.y, along.z};
        for (int axis = 0; axis < 3; ++axis) {
            rays.origin[axis][i] = origin[axis];
            rays.direction[axis][i] = direction[axis];
        }
        rays.far_distance[i] = i % 3 == 0 ? FLT_MAX : between(state, 0.0f, 2.0f);
    }
    return rays;
}

static lmb_vec3 batch_vector(const float array[3][LMB_RAY_BATCH], uint32_t i)
{
    return (lmb_vec3){array[0][i], array[1][i], array[2][i]};
}

static void batches_hit_like_single_rays(void)
{
    level_fixture level;
    if (!soup_open(&level)) {
        return;
    }
    uint64_t state = 2;
    for (uint32_t count = 1; count <= LMB_RAY_BATCH; ++count) {
        const lmb_ray_batch rays = batch_next(&state, count);
        lmb_hit hit[LMB_RAY_BATCH];
        lmb_rgb share[LMB_RAY_BATCH];
        uint64_t traced = 0;
        lmb_trace_nearest_batch(level.tracer, &rays, hit);
        lmb_trace_transmittance_batch(level.tracer, &rays, share, &traced);
        CHECK(traced == count, "%llu rays for %u", (unsigned long long)traced, count);
        for (uint32_t i = 0; i < count; ++i) {
            lmb_hit one;
            const bool found = lmb_trace_nearest(level.tracer, batch_vector(rays.origin, i),
                                                 batch_vector(rays.direction, i), 0.0f, rays.far_distance[i], &one);
            CHECK(found == (hit[i].instance != LMB_HIT_NOTHING), "ray %u of %u", i, count);
            CHECK(share[i].c[0] == (found ? 0.0f : 1.0f), "share of ray %u of %u", i, count);
            CHECK(!found || (one.triangle == hit[i].triangle && one.u == hit[i].u && one.v == hit[i].v &&
                             one.distance == hit[i].distance && one.front == hit[i].front),
                  "hit of ray %u of %u", i, count);
        }
    }
    level_fixture_close(&level);
}

/* A horizontal pane from (x, z) on, and the share of light that it lets through. */
typedef struct pane {
    float x, z, size, y, share;
} pane;

enum { PANES = 40 };

static bool panes_open(level_fixture *level, pane panes[PANES])
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int mesh = lmb_level_builder_add_mesh(builder, "panes");
    uint64_t state = 3;
    for (int i = 0; i < PANES; ++i) {
        lmb_level_material glass = lmb_level_material_default();
        const bool opaque = i % 4 == 0;
        glass.alpha_mode = opaque ? LMB_LEVEL_OPAQUE : LMB_LEVEL_BLEND;
        glass.alpha = opaque ? 1.0f : 0.25f * (float)(i % 3 + 1);
        panes[i] = (pane){between(&state, -1.0f, 0.5f), between(&state, -1.0f, 0.5f), between(&state, 0.2f, 0.8f),
                          0.1f * (float)i, 1.0f - glass.alpha};
        const int material = lmb_level_builder_add_material(builder, &glass);
        lmb_level_builder_add_quad(builder, mesh, material,
                                   (lmb_vec3){panes[i].x, panes[i].y, panes[i].z + panes[i].size},
                                   (lmb_vec3){panes[i].size, 0, 0}, (lmb_vec3){0, 0, -panes[i].size});
    }
    lmb_level_builder_place(builder, "panes", mesh, (lmb_vec3){0, 0, 0});
    lmb_error error = {{0}};
    const char *path = LMB_TEST_OUTPUT_DIR "/panes.glb";
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    return level_fixture_open(level, path, written, &error, 1);
}

/* What a vertical ray between two heights leaves of light. */
static double panes_share(const pane panes[PANES], float x, float z, float low, float high)
{
    double share = 1.0;
    for (int i = 0; i < PANES; ++i) {
        const pane *p = &panes[i];
        if (p->y > low && p->y < high && x > p->x && x < p->x + p->size && z > p->z && z < p->z + p->size) {
            share *= (double)p->share;
        }
    }
    return share;
}

static void panes_multiply(void)
{
    level_fixture level;
    pane panes[PANES];
    if (!panes_open(&level, panes)) {
        return;
    }
    uint64_t state = 4;
    int dark = 0, bright = 0, dim = 0;
    for (int b = 0; b < 64; ++b) {
        lmb_ray_batch rays = {.count = LMB_RAY_BATCH};
        double expected[LMB_RAY_BATCH];
        for (uint32_t i = 0; i < rays.count; ++i) {
            const float x = between(&state, -1.2f, 1.5f), z = between(&state, -1.2f, 1.5f);
            const float low = 0.1f * floorf(between(&state, -1.0f, 40.0f)) + 0.05f;
            const float length = 0.1f * floorf(between(&state, 1.0f, 20.0f));
            rays.origin[0][i] = x;
            rays.origin[1][i] = low;
            rays.origin[2][i] = z;
            rays.direction[1][i] = length;
            rays.far_distance[i] = i % 2 ? 1.0f : FLT_MAX;
            expected[i] = panes_share(panes, x, z, low, i % 2 ? low + length : FLT_MAX);
            dark += expected[i] <= 0.0;
            bright += expected[i] >= 1.0;
            dim += expected[i] > 0.0 && expected[i] < 1.0;
        }
        lmb_rgb share[LMB_RAY_BATCH];
        uint64_t traced = 0;
        lmb_trace_transmittance_batch(level.tracer, &rays, share, &traced);
        for (uint32_t i = 0; i < rays.count; ++i) {
            CHECK_NEAR(share[i].c[1], expected[i], 1e-6, "batch %d, ray %u", b, i);
        }
    }
    CHECK(dark > 300 && bright > 300 && dim > 300, "%d dark, %d bright, %d dim", dark, bright, dim);
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"batches_hit_like_single_rays", batches_hit_like_single_rays},
    {"panes_multiply", panes_multiply},
};

TEST_MAIN(cases)
