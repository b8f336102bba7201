/* Elements are gathered in parts or at once, and know what the points that they start at cost. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/probes_bake.h>
#include <lambent/placement.h>

#include "harness.h"
#include "lightmap_fixture.h"

/* Gathers at all of a list's groups in three parts, the last first. */
static bool parts_gather(const level_fixture *level, const lmb_gather_list *list, const lmb_gather_effort *effort,
                         lmb_gathered *gathered)
{
    lmb_gather_job job = lmb_gather_job_all(&level->transport, list, effort);
    const size_t groups = job.group_count;
    const size_t first[4] = {0, groups / 3, groups / 3 + 1, groups};
    static const int order[3] = {2, 0, 1};
    CHECK(groups > 3, "%zu groups", groups);
    for (int k = 0; k < 3; ++k) {
        lmb_gather_stats stats;
        job.first_group = first[order[k]];
        job.group_count = first[order[k] + 1] - first[order[k]];
        const size_t at = lmb_gather_group_first(list->count, job.first_group);
        const size_t end = lmb_gather_group_first(list->count, job.first_group + job.group_count);
        if (lmb_gather_elements(&job, level->pool, NULL, &gathered[at], &stats) != LMB_OK) {
            return false;
        }
        CHECK(stats.elements == end - at, "%llu elements of part %d", (unsigned long long)stats.elements, order[k]);
    }
    return true;
}

static void lightmap_in_parts(void)
{
    static const lmb_gather_effort effort = {.samples = 16, .max_samples = 64, .tolerance = 0.05};
    static const char path[] = OUTPUT("gather_lightmap.glb");
    lmb_error error = {{0}};
    baked whole = {.lightmap = NULL};
    if (!level_fixture_open(&whole.level, path, lmb_level_cornell(path, &error), &error, 2)) {
        return;
    }
    baked parts = whole;
    lmb_texel_list *list = NULL;
    lmb_gathered *gathered = NULL;
    if (lightmap_make(&whole, 8.0f, 1024) && lightmap_make(&parts, 8.0f, 1024) &&
        lmb_texel_list_create(parts.lightmap, &parts.level.transport, &effort, &list) == LMB_OK) {
        const lmb_gather_list elements = lmb_texel_list_elements(list);
        gathered = malloc(elements.count * sizeof *gathered);
        CHECK(lmb_lightmap_bake(whole.lightmap, &whole.level.transport, &effort, whole.level.pool, NULL,
                                &whole.stats) == LMB_OK,
              "whole");
        CHECK(gathered && parts_gather(&parts.level, &elements, &effort, gathered) &&
                  lmb_texel_list_finish(list, gathered, parts.level.pool, parts.lightmap) == LMB_OK,
              "parts");
        for (int32_t i = 0; i < whole.lightmap->image_count; ++i) {
            const lmb_lightmap_image *a = &whole.lightmap->image[i], *b = &parts.lightmap->image[i];
            CHECK(images_equal(whole.lightmap->model, a, b), "image %d", (int)i);
        }
    }
    free(gathered);
    lmb_texel_list_destroy(list);
    lmb_lightmap_destroy(parts.lightmap);
    baked_close(&whole);
}

static void probes_in_parts(void)
{
    static const lmb_gather_effort effort = {.samples = 16, .max_samples = 64, .tolerance = 0.05};
    static const char path[] = OUTPUT("gather_probes.glb");
    lmb_error error = {{0}};
    level_fixture level;
    lmb_probes *probes = NULL;
    lmb_placement_stats placed;
    if (!level_fixture_open(&level, path, lmb_level_cornell(path, &error), &error, 2)) {
        return;
    }
    const lmb_placement_settings settings = {.spacing = 0.1f, .max_probes = 100000};
    const lmb_result result = lmb_placement_make(level.tracer, &settings, level.pool, &probes, &placed, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    if (result == LMB_OK) {
        lmb_gather_stats stats;
        CHECK(lmb_probes_bake(probes, &level.transport, &effort, level.pool, NULL, &stats) == LMB_OK, "whole");
        const size_t bytes = (size_t)probes->count * sizeof *probes->radiance[0];
        lmb_sh3_rgb *whole = malloc(bytes);
        memcpy(whole, probes->radiance[0], bytes);
        memset(probes->radiance[0], 0, bytes);
        lmb_probe_list list;
        CHECK(lmb_probe_list_create(probes, NULL, level.tracer, &list) == LMB_OK, "memory");
        const lmb_gather_list elements = lmb_probe_list_elements(&list);
        lmb_gathered *gathered = malloc(elements.count * sizeof *gathered);
        CHECK(parts_gather(&level, &elements, &effort, gathered) &&
                  lmb_probe_list_finish(&list, gathered, level.pool, probes) == LMB_OK &&
                  memcmp(whole, probes->radiance[0], bytes) == 0,
              "%zu probes", list.count);
        memset(probes->radiance[0], 0, bytes);
        list.set = 1;
        CHECK(lmb_probe_list_finish(&list, gathered, level.pool, probes) == LMB_ERROR_ARGUMENT,
              "a set that is not there");
        uint32_t set = 0;
        CHECK(lmb_probes_add_set(probes, &set) == LMB_OK && set == 1, "a set");
        CHECK(lmb_probe_list_finish(&list, gathered, level.pool, probes) == LMB_OK &&
                  memcmp(whole, probes->radiance[1], bytes) == 0 &&
                  probes->radiance[0][list.probe[0]].channel[0].c[0] == 0.0f,
              "another set, and no other");
        lmb_probe_list_free(&list);
        free(gathered);
        free(whole);
        lmb_probes_destroy(probes);
    }
    level_fixture_close(&level);
}

/* A black floor of 2 m, and in the sun over it a roof whose edges lie on no texel's. */
static lmb_result roof_write(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.25f);
    const int material = plain_material(builder, 0.0f);
    const int floor = lmb_level_builder_add_mesh(builder, "floor"), roof = lmb_level_builder_add_mesh(builder, "roof");
    lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){-1, 0, 1}, (lmb_vec3){2, 0, 0},
                               (lmb_vec3){0, 0, -2});
    const lmb_level_box box =
        lmb_level_box_of((lmb_vec3){-0.43f, 1, -0.57f}, (lmb_vec3){0.61f, 1.05f, 0.37f}, material);
    lmb_level_builder_add_box(builder, roof, &box);
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    lmb_level_builder_place(builder, "roof", roof, (lmb_vec3){0, 0, 0});
    add_sun(builder, 3.0f);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* What a shadow's edge costs lies in the points of a texel that are asked, which all its samples share. The estimate
 * of that is within a factor of 1.5 of how far bakes of other seeds lie apart. */
static void points_are_in_the_estimate(void)
{
    enum { SEEDS = 24, MOST = 512 };
    static const lmb_gather_effort effort = {.samples = 512};
    static const char path[] = OUTPUT("gather_roof.glb");
    static lmb_gathered gathered[SEEDS][MOST];
    lmb_error error = {{0}};
    baked bake = {.lightmap = NULL};
    if (!level_fixture_open(&bake.level, path, roof_write(path, &error), &error, 2)) {
        return;
    }
    size_t count = 0;
    double estimated = 0.0, apart = 0.0;
    for (uint64_t seed = 0; seed < SEEDS && (bake.lightmap || lightmap_make(&bake, 4.0f, 1024)); ++seed) {
        lmb_texel_list *list = NULL;
        lmb_gather_stats stats;
        bake.level.transport.seed = seed;
        CHECK(lmb_texel_list_create(bake.lightmap, &bake.level.transport, &effort, &list) == LMB_OK, "memory");
        const lmb_gather_list elements = lmb_texel_list_elements(list);
        const lmb_gather_job job = lmb_gather_job_all(&bake.level.transport, &elements, &effort);
        count = elements.count;
        CHECK(count <= MOST && lmb_gather_elements(&job, bake.level.pool, NULL, gathered[seed], &stats) == LMB_OK,
              "%zu texels", count);
        estimated += stats.squared_error / SEEDS;
        lmb_texel_list_destroy(list);
    }
    for (size_t i = 0; i < count; ++i) {
        for (int c = 0; c < 3; ++c) {
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                double sum = 0.0, squares = 0.0;
                for (int seed = 0; seed < SEEDS; ++seed) {
                    const double moment = (double)gathered[seed][i].moments.channel[c].c[k];
                    sum += moment;
                    squares += moment * moment;
                }
                apart += (squares - sum * sum / SEEDS) / (SEEDS - 1);
            }
        }
    }
    const double ratio = sqrt(estimated / apart);
    printf("     estimated %.2f of what it is\n", ratio);
    CHECK(apart > 0.0 && ratio < 1.5 && ratio > 1.0 / 1.5, "estimated %.2f of what it is", ratio);
    baked_close(&bake);
}

static const test_case cases[] = {
    {"lightmap_in_parts", lightmap_in_parts},
    {"probes_in_parts", probes_in_parts},
    {"points_are_in_the_estimate", points_are_in_the_estimate},
};

TEST_MAIN(cases)
