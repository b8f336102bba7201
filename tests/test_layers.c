/* Light through many see-through layers, against what their alphas and tints multiply to. */
#include <float.h>
#include <stdlib.h>

#include <lambent/probes_bake.h>
#include <lambent/placement.h>

#include "level_fixture.h"
#include "scenes/level_builder.h"
#include "variates.h"

static const lmb_vec3 up = {0, 1, 0};
static const char *const level_path = LMB_TEST_OUTPUT_DIR "/layers.glb";

/* `count` horizontal cards of 20 m, from y = 1 on, `step` apart. */
static void cards_add(lmb_level_builder *builder, const lmb_level_material *material, int count, float step)
{
    const int index = lmb_level_builder_add_material(builder, material);
    const int mesh = lmb_level_builder_add_mesh(builder, "cards");
    for (int i = 0; i < count; ++i) {
        lmb_level_builder_add_quad(builder, mesh, index, (lmb_vec3){-10, 1.0f + step * (float)i, 10},
                                   (lmb_vec3){20, 0, 0}, (lmb_vec3){0, 0, -20});
    }
    lmb_level_builder_place(builder, "cards", mesh, (lmb_vec3){0, 0, 0});
}

static bool cards_open(level_fixture *level, const lmb_level_material *material, int count, float step,
                       const char *environment)
{
    lmb_error error = {{0}};
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    cards_add(builder, material, count, step);
    const lmb_result written = lmb_level_builder_write(builder, level_path, &error);
    lmb_level_builder_destroy(builder);
    CHECK(written == LMB_OK, "%s", error.message);
    return written == LMB_OK && level_fixture_load(level, level_path, environment, 1);
}

static lmb_level_material fog(float alpha)
{
    lmb_level_material material = lmb_level_material_default();
    material.base_color = (lmb_rgb){{0, 0, 0}};
    material.alpha_mode = LMB_LEVEL_BLEND;
    material.alpha = alpha;
    return material;
}

static lmb_level_material glass(lmb_rgb tint)
{
    lmb_level_material material = lmb_level_material_default();
    material.base_color = tint;
    material.transmission = 1.0f;
    return material;
}

/* A shadow ray and a ray by chance through N cards of alpha a: (1 - a)^N arrives. One walk, or one for 64. */
static void cards_multiply(void)
{
    static const struct {
        float alpha;
        int count;
        uint64_t walks;
    } stacks[] = {{0.5f, 1, 1},     {0.5f, 10, 1},  {0.01f, 64, 1}, {0.02f, 100, 2},
                  {0.002f, 300, 5}, {0.0f, 300, 1}, {1.0f, 3, 1}};
    for (size_t k = 0; k < sizeof stacks / sizeof stacks[0]; ++k) {
        const lmb_level_material material = fog(stacks[k].alpha);
        level_fixture level;
        if (!cards_open(&level, &material, stacks[k].count, 0.05f, "#ffffff")) {
            return;
        }
        const double expected = pow(1.0 - (double)stacks[k].alpha, stacks[k].count);
        const lmb_vec3 origin = {0.3f, 0, 0.1f};
        uint64_t rays = 0;
        const lmb_rgb share = lmb_trace_transmittance_along(level.tracer, origin, up, FLT_MAX, &rays);
        CHECK_NEAR(share.c[1], expected, 1e-4 * expected, "%d of %g", stacks[k].count, (double)stacks[k].alpha);
        CHECK(rays == stacks[k].walks, "%d of %g: %llu walks", stacks[k].count, (double)stacks[k].alpha,
              (unsigned long long)rays);
        enum { RAYS = 20000 };
        double sum = 0.0;
        rays = 0;
        for (uint32_t i = 0; i < RAYS; ++i) {
            sum += (double)lmb_radiance(&level.transport, origin, up, 7, i, &rays).c[1] / RAYS;
        }
        CHECK_NEAR(sum, expected, 4.0 * sqrt(expected * (1.0 - expected) / RAYS) + 1e-6, "%d of %g by chance",
                   stacks[k].count, (double)stacks[k].alpha);
        CHECK(rays == RAYS, "%llu rays by chance", (unsigned long long)rays);
        level_fixture_close(&level);
    }
}

/* Tinted panes multiply colour by colour, aimed at or met by chance, and with more of them than one walk keeps. */
static void tints_multiply(void)
{
    static const int counts[] = {1, 5, 64, 65, 130};
    const lmb_rgb tint = {{0.99f, 0.98f, 0.97f}};
    for (size_t k = 0; k < sizeof counts / sizeof counts[0]; ++k) {
        const lmb_level_material material = glass(tint);
        level_fixture level;
        if (!cards_open(&level, &material, counts[k], 0.05f, "#ffffff")) {
            return;
        }
        uint64_t rays = 0;
        const lmb_rgb share =
            lmb_trace_transmittance_along(level.tracer, (lmb_vec3){0.3f, 0, 0.1f}, up, FLT_MAX, &rays);
        lmb_rgb chanced = {{0, 0, 0}};
        enum { RAYS = 256 };
        lmb_ray_batch batch = {.count = LMB_RAY_BATCH};
        uint64_t chance[LMB_RAY_BATCH];
        lmb_hit hit[LMB_RAY_BATCH];
        lmb_rgb shares[LMB_RAY_BATCH];
        for (uint32_t i = 0; i < batch.count; ++i) {
            batch.origin[0][i] = 0.1f * (float)i;
            batch.direction[1][i] = 1.0f;
            batch.far_distance[i] = FLT_MAX;
            chance[i] = i;
        }
        lmb_trace_through_batch(level.tracer, &batch, chance, hit, shares, &rays);
        for (int c = 0; c < 3; ++c) {
            const double expected = pow((double)tint.c[c], counts[k]);
            CHECK_NEAR(share.c[c], expected, 1e-4 * expected, "%d panes, channel %d", counts[k], c);
            for (int i = 0; i < RAYS; ++i) {
                chanced.c[c] +=
                    lmb_radiance(&level.transport, (lmb_vec3){0.3f, 0, 0.1f}, up, 3, (uint32_t)i, &rays).c[c] /
                    (float)RAYS;
            }
            /* Nothing stops at clear glass: what arrives is the product each time. */
            CHECK_NEAR(chanced.c[c], expected, 1e-4 * expected, "%d panes by chance, channel %d", counts[k], c);
            for (uint32_t i = 0; i < batch.count; ++i) {
                CHECK(hit[i].instance == LMB_HIT_NOTHING, "%d panes, ray %u", counts[k], i);
                CHECK_NEAR(shares[i].c[c], expected, 1e-4 * expected, "%d panes, ray %u, channel %d", counts[k], i, c);
            }
        }
        level_fixture_close(&level);
    }
}

/* Cards in one place count once, and so does one whose two triangles meet under the ray. */
static void places_count_once(void)
{
    static const struct {
        int count;
        float step, x, z;
        double expected;
    } rays[] = {{1, 0.05f, 0, 0, 0.5},           {1, 0.05f, 2.5f, 2.5f, 0.5}, {1, 0.05f, 2.5f, -2.5f, 0.5},
                {4, 0.05f, 2.5f, -2.5f, 0.0625}, {3, 0.0f, 0.3f, 0.1f, 0.5},  {80, 0.0f, 0.3f, 0.1f, 0.5}};
    for (size_t k = 0; k < sizeof rays / sizeof rays[0]; ++k) {
        const lmb_level_material material = fog(0.5f);
        level_fixture level;
        if (!cards_open(&level, &material, rays[k].count, rays[k].step, NULL)) {
            return;
        }
        uint64_t traced = 0;
        const lmb_rgb share =
            lmb_trace_transmittance_along(level.tracer, (lmb_vec3){rays[k].x, 0, rays[k].z}, up, FLT_MAX, &traced);
        CHECK_NEAR(share.c[0], rays[k].expected, 1e-6, "ray %zu", k);
        level_fixture_close(&level);
    }
}

/* A card of MASK texture, half of it holes: rays pass where the texture says, aimed at or by chance. */
static void holes_let_through(void)
{
    uint8_t pixels[8 * 8][4];
    for (int i = 0; i < 64; ++i) {
        const bool leaf = (i % 8 < 4) != (i / 8 < 4);
        const uint8_t texel[4] = {60, 160, 50, leaf ? 255 : 0};
        memcpy(pixels[i], texel, 4);
    }
    lmb_error error = {{0}};
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material leaves = lmb_level_material_default();
    leaves.alpha_mode = LMB_LEVEL_MASK;
    leaves.alpha_cutoff = 0.5f;
    leaves.texture_size_m = 20.0f;
    leaves.base_color_texture = lmb_level_builder_add_image(builder, "leaves", 8, 8, pixels[0]);
    cards_add(builder, &leaves, 2, 0.5f);
    const lmb_result written = lmb_level_builder_write(builder, level_path, &error);
    lmb_level_builder_destroy(builder);
    level_fixture level;
    if (!level_fixture_open(&level, level_path, written, &error, 1)) {
        return;
    }
    lmb_ray_batch batch = {.count = 0};
    const uint64_t chance[LMB_RAY_BATCH] = {1};
    lmb_hit hit[LMB_RAY_BATCH];
    lmb_rgb share[LMB_RAY_BATCH], through[LMB_RAY_BATCH];
    for (uint32_t i = 0; i < LMB_RAY_BATCH; ++i) {
        batch.origin[0][i] = -8.75f + 2.5f * (float)(i % 8);
        batch.origin[2][i] = -8.75f + 2.5f * (float)(i / 8);
        batch.direction[1][i] = 1.0f;
        batch.far_distance[i] = FLT_MAX;
        ++batch.count;
    }
    uint64_t rays = 0;
    lmb_trace_transmittance_batch(level.tracer, &batch, share, &rays);
    lmb_trace_through_batch(level.tracer, &batch, chance, hit, through, &rays);
    CHECK(rays == 2 * LMB_RAY_BATCH, "%llu rays", (unsigned long long)rays);
    for (uint32_t i = 0; i < batch.count; ++i) {
        const bool leaf = (batch.origin[0][i] < 0.0f) != (batch.origin[2][i] < 0.0f);
        CHECK_NEAR(share[i].c[0], leaf ? 0.0 : 1.0, 0.0, "ray %u", i);
        CHECK((hit[i].instance != LMB_HIT_NOTHING) == leaf, "ray %u by chance", i);
        CHECK_NEAR(through[i].c[0], 1.0, 0.0, "ray %u by chance", i);
        CHECK(!leaf || (hit[i].distance > 0.99f && hit[i].distance < 1.01f), "ray %u: the nearer card", i);
    }
    level_fixture_close(&level);
}

/* Panes of all kinds, turned every way, around the origin. */
static bool shards_write(void)
{
    lmb_error error = {{0}};
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material kinds[4] = {lmb_level_material_default(), fog(0.3f), glass((lmb_rgb){{0.9f, 0.7f, 0.5f}}),
                                   fog(0.8f)};
    kinds[2].transmission = 0.7f;
    const int mesh = lmb_level_builder_add_mesh(builder, "shards");
    int material[4];
    for (int k = 0; k < 4; ++k) {
        material[k] = lmb_level_builder_add_material(builder, &kinds[k]);
    }
    uint64_t state = 3;
    for (int i = 0; i < 400; ++i) {
        float n[9];
        for (int c = 0; c < 9; ++c) {
            n[c] = (float)(2.0 * variate_next(&state) - 1.0);
        }
        lmb_level_builder_add_quad(builder, mesh, material[i % 8 ? 1 + i % 3 : 0],
                                   (lmb_vec3){3 * n[0], 3 * n[1], 3 * n[2]}, (lmb_vec3){n[3], n[4], n[5]},
                                   (lmb_vec3){n[6], n[7], n[8]});
    }
    lmb_level_builder_place(builder, "shards", mesh, (lmb_vec3){0, 0, 0});
    const lmb_result written = lmb_level_builder_write(builder, level_path, &error);
    lmb_level_builder_destroy(builder);
    CHECK(written == LMB_OK, "%s", error.message);
    return written == LMB_OK;
}

static lmb_vec3 vector_next(uint64_t *state)
{
    const float x = (float)(2.0 * variate_next(state) - 1.0), y = (float)(2.0 * variate_next(state) - 1.0);
    return (lmb_vec3){x, y, (float)(2.0 * variate_next(state) - 1.0)};
}

/* With every instruction set: rays of a batch find what single rays do, bit by bit, and by the mean over many chances
 * what shadow rays do. */
static void batches_pass_like_single_rays(void)
{
    static const char *const sets[] = {"sse2", "sse4.2", "avx", "avx2", NULL};
    lmb_error error = {{0}};
    lmb_scene *scene = NULL;
    if (!shards_write() || lmb_gltf_load(level_path, NULL, &scene, &error) != LMB_OK) {
        CHECK(false, "%s", error.message);
        return;
    }
    for (size_t k = 0; k < sizeof sets / sizeof sets[0]; ++k) {
        lmb_tracer *tracer = NULL;
        if (lmb_tracer_create(scene, sets[k], 1, &tracer, &error) != LMB_OK) {
            continue; /* not on this machine */
        }
        CHECK(lmb_tracer_has_layers(tracer), "layers");
        uint64_t state = 5;
        for (uint32_t count = 1; count <= LMB_RAY_BATCH; ++count) {
            lmb_ray_batch batch = {.count = count};
            uint64_t chance[LMB_RAY_BATCH], rays = 0;
            lmb_hit hit[LMB_RAY_BATCH];
            lmb_rgb share[LMB_RAY_BATCH], through[LMB_RAY_BATCH];
            lmb_vec3 from[LMB_RAY_BATCH], along[LMB_RAY_BATCH];
            for (uint32_t i = 0; i < count; ++i) {
                from[i] = vector_next(&state);
                along[i] = vector_next(&state);
                chance[i] = (uint64_t)(variate_next(&state) * 1e15);
                const float origin[3] = {from[i].x, from[i].y, from[i].z}, d[3] = {along[i].x, along[i].y, along[i].z};
                for (int axis = 0; axis < 3; ++axis) {
                    batch.origin[axis][i] = origin[axis];
                    batch.direction[axis][i] = d[axis];
                }
                batch.far_distance[i] = FLT_MAX;
            }
            lmb_trace_transmittance_batch(tracer, &batch, share, &rays);
            lmb_trace_through_batch(tracer, &batch, chance, hit, through, &rays);
            for (uint32_t i = 0; i < count; ++i) {
                lmb_hit one;
                lmb_rgb left = {{1, 1, 1}};
                const bool found =
                    lmb_trace_through(tracer, &(lmb_ray){from[i], along[i]}, chance[i], &one, &left, &rays);
                const lmb_rgb aimed = lmb_trace_transmittance_along(tracer, from[i], along[i], FLT_MAX, &rays);
                CHECK(memcmp(&aimed, &share[i], sizeof aimed) == 0, "%s: share of ray %u of %u", sets[k], i, count);
                CHECK(memcmp(&left, &through[i], sizeof left) == 0, "%s: ray %u of %u by chance", sets[k], i, count);
                CHECK(found == (hit[i].instance != LMB_HIT_NOTHING), "%s: ray %u of %u", sets[k], i, count);
                CHECK(!found || (one.triangle == hit[i].triangle && one.distance == hit[i].distance),
                      "%s: hit of ray %u of %u", sets[k], i, count);
            }
        }
        for (int i = 0; i < 20; ++i) {
            enum { TRIES = 20000 };
            const lmb_vec3 from = vector_next(&state), along = vector_next(&state);
            uint64_t rays = 0;
            const lmb_rgb expected = lmb_trace_transmittance_along(tracer, from, along, FLT_MAX, &rays);
            double sum[3] = {0, 0, 0};
            for (uint64_t t = 0; t < TRIES; ++t) {
                lmb_hit hit;
                lmb_rgb left = {{1, 1, 1}};
                const bool found = lmb_trace_through(tracer, &(lmb_ray){from, along}, (t + 1) * 977 + 7 * (uint64_t)i,
                                                     &hit, &left, &rays);
                for (int c = 0; c < 3 && !found; ++c) {
                    sum[c] += (double)left.c[c] / TRIES;
                }
            }
            for (int c = 0; c < 3; ++c) {
                const double mean = (double)expected.c[c];
                CHECK_NEAR(sum[c], mean, 4.5 * sqrt(mean * (1.0 - mean) / TRIES) + 1e-6, "ray %d, channel %d", i, c);
            }
        }
        lmb_tracer_destroy(tracer);
    }
    lmb_scene_destroy(scene);
}

/* Probes among the shards: the same bytes for any number of threads. */
static void threads_do_not_matter(void)
{
    static const int threads[] = {1, 2, 7};
    lmb_probes *bakes[3] = {NULL, NULL, NULL};
    if (!shards_write()) {
        return;
    }
    for (int i = 0; i < 3; ++i) {
        level_fixture level;
        lmb_error error = {{0}};
        if (!level_fixture_load(&level, level_path, "#8090a0", threads[i])) {
            return;
        }
        lmb_placement_settings settings = lmb_placement_settings_default();
        settings.spacing = 0.7f;
        lmb_placement_stats placement;
        lmb_gather_stats baked;
        lmb_result result = lmb_placement_make(level.tracer, &settings, level.pool, &bakes[i], &placement, &error);
        if (result == LMB_OK) {
            result = lmb_probes_bake(bakes[i], &level.transport, &(lmb_gather_effort){.samples = 32}, level.pool, NULL,
                                     &baked);
        }
        CHECK(result == LMB_OK, "%d threads: %s", threads[i], error.message);
        CHECK(i == 0 || (bakes[0] && bakes[i] && bakes[0]->count == bakes[i]->count &&
                         memcmp(bakes[0]->radiance[0], bakes[i]->radiance[0],
                                (size_t)bakes[0]->count * sizeof *bakes[0]->radiance[0]) == 0),
              "%d threads differ from 1", threads[i]);
        level_fixture_close(&level);
    }
    for (int i = 0; i < 3; ++i) {
        lmb_probes_destroy(bakes[i]);
    }
}

static const test_case cases[] = {
    {"cards_multiply", cards_multiply},
    {"tints_multiply", tints_multiply},
    {"places_count_once", places_count_once},
    {"holes_let_through", holes_let_through},
    {"batches_pass_like_single_rays", batches_pass_like_single_rays},
    {"threads_do_not_matter", threads_do_not_matter},
};

TEST_MAIN(cases)
