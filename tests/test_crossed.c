/* Everything that is read of a level, each thing with each other: levels of random parts are loaded and baked. What
 * only two features together can break, no test of one feature meets. */
#include <sys/stat.h>

#include <lambent/environment.h>
#include <lambent/file.h>
#include <lambent/probes_bake.h>
#include <lambent/placement.h>
#include <lambent/surface_solve.h>

#include "crossed_level.h"
#include "lightmap_fixture.h"

#define FOLDER LMB_TEST_OUTPUT_DIR "/crossed"
#define LEVEL FOLDER "/crossed.gltf"

enum { LEVELS = 2000, SAMPLES = 4, MAX_PROBES = 27 };

static uint32_t warning_count, faulty_warnings;

static void warning_look(void *context, const char *line)
{
    (void)context;
    ++warning_count;
    const size_t length = strlen(line);
    faulty_warnings += length == 0 || line[length - 1] == '.' || strchr(line, '\n') != NULL;
}

static const lmb_warnings listen = {warning_look, NULL};

/* What was loaded against what was written. */
static void scene_check(const crossed_level *level, const lmb_scene *scene, uint64_t seed)
{
    uint32_t static_instances = 0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        static_instances += !scene->instances[i].dynamic;
    }
    CHECK(scene->instance_count == level->instances, "seed %llu: %u, not %u", (unsigned long long)seed,
          scene->instance_count, level->instances);
    CHECK(static_instances == level->static_instances, "seed %llu: %u, not %u", (unsigned long long)seed,
          static_instances, level->static_instances);
    CHECK(scene->light_count == level->lights, "seed %llu: %u, not %u", (unsigned long long)seed, scene->light_count,
          level->lights);
    CHECK(scene->seed_point_count == level->seeds, "seed %llu: %u, not %u", (unsigned long long)seed,
          scene->seed_point_count, level->seeds);
}

static bool is_sane(lmb_rgb light)
{
    return isfinite(light.c[0]) && isfinite(light.c[1]) && isfinite(light.c[2]) && light.c[0] >= 0.0f &&
           light.c[1] >= 0.0f && light.c[2] >= 0.0f;
}

static void probes_bake(const level_fixture *level, uint64_t seed)
{
    const lmb_placement_settings settings = {.max_probes = MAX_PROBES};
    const lmb_gather_effort effort = {.samples = SAMPLES};
    lmb_error fault = {""};
    lmb_probes *probes = NULL;
    lmb_placement_stats placed;
    lmb_gather_stats stats;
    lmb_result result = lmb_placement_make(level->tracer, &settings, level->pool, &probes, &placed, &fault);
    if (result == LMB_ERROR_UNSUPPORTED) {
        return; /* nothing that stands still has bounds */
    }
    CHECK(result == LMB_OK, "seed %llu: %s", (unsigned long long)seed, fault.message);
    if (result != LMB_OK) {
        return;
    }
    result = lmb_probes_bake(probes, &level->transport, &effort, level->pool, NULL, &stats);
    CHECK(result == LMB_OK, "seed %llu", (unsigned long long)seed);
    bool finite = true;
    for (int32_t i = 0; i < probes->count; ++i) {
        for (int k = 0; k < 27; ++k) {
            finite = finite && isfinite(probes->radiance[0][i].channel[k / 9].c[k % 9]);
        }
    }
    CHECK(finite, "seed %llu: probes", (unsigned long long)seed);
    lmb_probes_destroy(probes);
}

static void lightmap_files(const baked *bake, uint64_t seed)
{
    lmb_error fault = {""};
    uint64_t bytes = 0;
    CHECK(lmb_lightmap_write(bake->lightmap, FOLDER, NULL, &bytes, &fault) == LMB_OK, "seed %llu: %s",
          (unsigned long long)seed, fault.message);
    lmb_lightmap *again = NULL;
    if (lmb_lightmap_create(bake->level.scene, &bake->lightmap->settings, &again, &fault) == LMB_OK) {
        CHECK(lmb_lightmap_read(again, FOLDER, &fault) == LMB_OK, "seed %llu: %s", (unsigned long long)seed,
              fault.message);
    }
    lmb_lightmap_destroy(again);
    bool charts = false;
    for (uint32_t m = 0; m < bake->level.scene->mesh_count; ++m) {
        charts |= bake->lightmap->corner_uv[m] != NULL;
    }
    lmb_scene *rewritten = NULL;
    if (charts && lmb_gltf_load(FOLDER "/level_uv2.glb", NULL, &rewritten, &fault) == LMB_OK) {
        CHECK(rewritten->instance_count == bake->level.scene->instance_count &&
                  rewritten->light_count == bake->level.scene->light_count,
              "seed %llu: level_uv2.glb", (unsigned long long)seed);
        lmb_scene_destroy(rewritten);
    } else {
        CHECK(!charts, "seed %llu: level_uv2.glb: %s", (unsigned long long)seed, fault.message);
    }
}

/* Every instance that stands still and has triangles, and no other, gets its texels. */
static void lightmap_check(baked *bake, bool files, uint64_t seed)
{
    const lmb_scene *scene = bake->level.scene;
    if (!lightmap_make(bake, 0.5f, 64) || !lightmap_bake(bake, SAMPLES)) {
        CHECK(false, "seed %llu: lightmap", (unsigned long long)seed);
        return;
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const bool wanted = !scene->instances[i].dynamic && scene->meshes[scene->instances[i].mesh].triangle_count > 0;
        CHECK((bake->lightmap->region[i].image >= 0) == wanted, "seed %llu: instance %u", (unsigned long long)seed, i);
        const lmb_irradz texel = sample_irradz(bake->lightmap, i, 0, 0.3f, 0.3f);
        const float weight = texel.ambient_weight;
        CHECK(is_sane(texel.irradiance_z) && weight >= 0.0f && weight <= 1.0f + 1e-6f, /* filtered, so rounded */
              "seed %llu: instance %u: %g", (unsigned long long)seed, i, (double)weight);
    }
    count_state(bake->lightmap, LMB_TEXEL_GATHERED);
    if (files) {
        lightmap_files(bake, seed);
    }
}

static void level_bake(baked *bake, uint64_t seed)
{
    level_fixture *level = &bake->level;
    lmb_surface_light *surface = NULL;
    if (seed % 2) {
        const lmb_surface_light_settings settings = {.max_cells = 8};
        lmb_surface_light_stats stats;
        lmb_error fault = {""};
        CHECK(lmb_surface_light_solve(&level->transport, &settings, level->pool, &surface, &stats, &fault) == LMB_OK,
              "seed %llu: %s", (unsigned long long)seed, fault.message);
        level->transport.surface = surface;
    }
    const lmb_rgb light = traced_irradiance(level, (lmb_vec3){0.1f, 0.2f, 0.3f}, (lmb_vec3){0.0f, 1.0f, 0.0f}, 64);
    CHECK(is_sane(light), "seed %llu: %g %g %g", (unsigned long long)seed, (double)light.c[0], (double)light.c[1],
          (double)light.c[2]);
    if (seed % 64 == 0) { /* placement alone takes longer than all the rest */
        probes_bake(level, seed);
    }
    lightmap_check(bake, seed % 32 == 1, seed);
    lmb_surface_light_destroy(surface);
}

/* Not by lmb_file_write, which waits for the disk. */
static bool text_write(const crossed_level *level)
{
    FILE *file = fopen(LEVEL, "wb");
    const bool written = file && fwrite(level->text, 1, level->length, file) == level->length;
    return file && fclose(file) == 0 && written;
}

static bool level_load(crossed_level *written, level_fixture *level, uint64_t seed)
{
    memset(level, 0, sizeof *level);
    crossed_make(written, seed);
    const lmb_gltf_options options = {.warnings = listen};
    lmb_error error = {""};
    lmb_result result = text_write(written) ? LMB_OK : LMB_ERROR_WRITE;
    if (result == LMB_OK) {
        result = lmb_gltf_load(LEVEL, &options, &level->scene, &error);
    }
    if (result == LMB_OK) {
        result = lmb_scene_validate(level->scene, &error);
    }
    if (result == LMB_OK && seed % 3 == 0) {
        result = lmb_scene_set_environment(level->scene, "#8090a0", &error);
    }
    if (result == LMB_OK) {
        scene_check(written, level->scene, seed);
        result = lmb_tracer_create(level->scene, NULL, 1, &level->tracer, &error);
    }
    if (result == LMB_OK) {
        result = lmb_emitters_create(level->tracer, &level->emitters);
    }
    if (result == LMB_OK) {
        result = lmb_pool_create(1, &level->pool);
    }
    CHECK(result == LMB_OK, "seed %llu: %s", (unsigned long long)seed, error.message);
    if (result != LMB_OK) {
        level_fixture_close(level);
        return false;
    }
    level->transport = (lmb_transport){.tracer = level->tracer, .emitters = level->emitters, .bounces = -1};
    return true;
}

static void test_crossed(void)
{
    static crossed_level written;
    unsigned char bytes[CROSSED_BUFFER_SIZE];
    lmb_error fault = {""};
    mkdir(LMB_TEST_OUTPUT_DIR, 0777);
    mkdir(FOLDER, 0777);
    crossed_buffer(bytes);
    CHECK(lmb_file_write(FOLDER "/crossed.bin", bytes, sizeof bytes, &fault) == LMB_OK, "%s", fault.message);
    uint32_t moving = 0, lit = 0;
    for (uint64_t seed = 1; seed <= LEVELS; ++seed) {
        const int failures = test_failures;
        baked bake = {0};
        if (level_load(&written, &bake.level, seed)) {
            moving += written.static_instances < written.instances;
            lit += lmb_scene_has_light(bake.level.scene);
            level_bake(&bake, seed);
        }
        baked_close(&bake);
        if (test_failures > failures) {
            fprintf(stderr, "seed %llu: the level is %s\n", (unsigned long long)seed, LEVEL);
            return;
        }
    }
    CHECK(moving > LEVELS / 10 && lit > LEVELS / 3, "%u levels with moving parts, %u with light", moving, lit);
    CHECK(warning_count > LEVELS / 10 && faulty_warnings == 0, "%u warnings, %u of them faulty", warning_count,
          faulty_warnings);
}

static const test_case cases[] = {
    {"crossed features", test_crossed},
};

TEST_MAIN(cases)
