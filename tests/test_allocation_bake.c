/* A whole bake of a small level, loading it, and opening the bake again, in which one allocation of ours after the
 * other fails: the result says so, the folder is as it was, and (under AddressSanitizer) nothing leaks. The linker
 * sends the allocations of what is linked statically here (--wrap); those of Embree, OpenVDB, tinygltf, OpenEXR and
 * cJSON are their own. C++'s `new` fails too while the level is loaded. In a bake it does not: what OpenVDB's headers
 * put into our file allocates in a destructor. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <unistd.h>

#include <lambent/bake.h>
#include <lambent/baked.h>
#include <lambent/gltf.h>

#include "allocation_fail.h"
#include "command_fixture.h"
#include "floor_fixture.h"
#include "folder_fixture.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/allocation_bake"
#define LEVEL OUTPUT "/level.glb"
#define BAKED OUTPUT "/baked"
#define TRIED OUTPUT "/tried"

/* Whether the bake has levels, cells that a wall parts, a set of lights, a key light, and compressed lightmaps. */
static bool is_rich;

/* Failures of one kind of work that are tried, spread over all of its allocations. */
enum { MOST_TRIES = 100, MOST_RICH_TRIES = 40 };

static lmb_result bake_into(const char *folder_name, lmb_error *error)
{
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.level.path = LEVEL;
    settings.level.threads = 1;
    settings.level.environment = "#404040";
    settings.level.key_lights = is_rich ? 1 : 0;
    settings.spacing = 2.0f;
    settings.min_spacing = is_rich ? 1.0f : 0.0f; /* next to the wall */
    settings.samples = settings.max_samples = 4;
    settings.lightmaps = true;
    settings.lightmap_format = is_rich ? LMB_LIGHTMAP_KTX2 : LMB_LIGHTMAP_EXR;
    settings.texels_per_m = 1.0f;
    lmb_bake_folder *folder = NULL;
    lmb_bake_record record;
    lmb_result result = lmb_bake_folder_open(folder_name, true, &folder, error);
    if (result == LMB_OK) {
        result = lmb_bake_run(&settings, folder, &(lmb_bake_listener){0}, &record, error);
    }
    lmb_bake_folder_close(folder);
    return result;
}

/* What a failed bake leaves is nothing, what a whole one leaves is removed. */
static lmb_result bake_try(lmb_error *error)
{
    const lmb_result result = bake_into(TRIED, error);
    allocation_fail_after(-1);
    CHECK((access(TRIED, F_OK) == 0) == (result == LMB_OK), "result %d: %s", result, error->message);
    if (result == LMB_OK) {
        CHECK_RUN(0, NULL, "rm -r " TRIED);
    }
    return result;
}

static lmb_result load_try(lmb_error *error)
{
    lmb_scene *scene = NULL;
    const lmb_result result = lmb_gltf_load(LEVEL, NULL, &scene, error);
    allocation_fail_after(-1);
    CHECK((result == LMB_OK) == (scene != NULL), "result %d: %s", result, error->message);
    lmb_scene_destroy(scene);
    return result;
}

static lmb_result open_try(lmb_error *error)
{
    lmb_baked baked;
    const lmb_result result = lmb_baked_open(LEVEL, BAKED, 1, NULL, &baked, error);
    allocation_fail_after(-1);
    if (result == LMB_OK) {
        lmb_baked_close(&baked);
    }
    return result;
}

/* How many allocations it makes when none fails. */
static long allocations_of(lmb_result (*work)(lmb_error *error))
{
    lmb_error error = {{0}};
    allocation_fail_after(LONG_MAX);
    const lmb_result result = work(&error);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK ? allocation_count() : 0;
}

/* OpenEXR asks us for the memory that it decodes with, and has the same word for none and for a broken table's size. */
static bool is_out_of_memory(lmb_result result, const lmb_error *error)
{
    return result == LMB_ERROR_MEMORY || (result == LMB_ERROR_FORMAT && strstr(error->message, "decode the EXR"));
}

static void each_fails(const char *name, lmb_result (*work)(lmb_error *error))
{
    const long count = allocations_of(work);
    const long most = is_rich ? MOST_RICH_TRIES : MOST_TRIES;
    const long tries = count < most ? count : most;
    long refused = 0;
    for (long i = 0; i < tries; ++i) {
        const long at = i * count / tries;
        lmb_error error = {{0}};
        allocation_fail_after(at);
        const lmb_result result = work(&error);
        CHECK(result == LMB_OK || (is_out_of_memory(result, &error) && error.message[0]),
              "%s: allocation %ld of %ld: result %d: %s", name, at, count, result, error.message);
        refused += result != LMB_OK;
    }
    printf("     %s: %ld allocations, %ld of %ld that failed end it\n", name, count, refused, tries);
    CHECK(count > 60 && 10 * refused >= 8 * tries, "%s: %ld of %ld failed", name, refused, tries);
}

/* A floor in the sun, with a glowing wall of a set of its own on it, and a lamp of another. */
static lmb_result rich_level_write(lmb_error *error)
{
    lmb_level_builder *const builder = floor_begin(0.5f, 8.0f);
    const lmb_level_light lights[2] = {
        {.name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = {{1.0f, 1.0f, 0.9f}}, .intensity = 3.0f},
        {.name = "lamp", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1.0f, 0.5f, 0.2f}}, .intensity = 20.0f}};
    for (int i = 0; i < 2; ++i) {
        lmb_level_node node = lmb_level_node_default(lights[i].name);
        node.light = lmb_level_builder_add_light(builder, &lights[i]);
        node.light_set = i == 0 ? NULL : "lamps";
        node.translation = (lmb_vec3){1.0f, 2.0f, 0.5f};
        lmb_level_look_along((lmb_vec3){0.3f, -1.0f, 0.2f}, node.rotation);
        lmb_level_builder_add_node(builder, &node);
    }
    lmb_level_material glow = lmb_level_material_default();
    glow.emission = (lmb_rgb){{0.2f, 2.0f, 0.4f}};
    glow.light_set = "signs";
    const int wall = lmb_level_builder_add_mesh(builder, "wall");
    const lmb_level_box box = lmb_level_box_of((lmb_vec3){-0.3f, 0, -2}, (lmb_vec3){-0.2f, 2, 2},
                                               lmb_level_builder_add_material(builder, &glow));
    lmb_level_builder_add_box(builder, wall, &box);
    lmb_level_builder_place(builder, "wall", wall, (lmb_vec3){0, 0, 0});
    const lmb_result result = lmb_level_builder_write(builder, LEVEL, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static void each_allocation_fails(bool rich)
{
    lmb_error error = {{0}};
    is_rich = rich;
    mkdir(OUTPUT, 0777);
    CHECK_RUN(0, NULL, "rm -rf " BAKED " " TRIED);
    const lmb_result written = rich ? rich_level_write(&error) : lmb_level_quad_light(LEVEL, 2.0f, 5.0f, &error);
    if (written != LMB_OK || bake_into(BAKED, &error) != LMB_OK) {
        CHECK(false, "%s", error.message);
        return;
    }
    allocation_fail_new(true);
    each_fails("load", load_try);
    allocation_fail_new(false);
    each_fails("bake", bake_try);
    each_fails("open", open_try);
}

static void every_allocation_fails(void)
{
    each_allocation_fails(false);
}

static void every_allocation_of_a_rich_bake_fails(void)
{
    each_allocation_fails(true);
}

static const test_case cases[] = {{"every_allocation_fails", every_allocation_fails},
                                  {"every_allocation_of_a_rich_bake_fails", every_allocation_of_a_rich_bake_fails}};
TEST_MAIN(cases)
