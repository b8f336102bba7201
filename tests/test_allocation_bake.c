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
#include "folder_fixture.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/allocation_bake"
#define LEVEL OUTPUT "/level.glb"
#define BAKED OUTPUT "/baked"
#define TRIED OUTPUT "/tried"

/* Failures of one kind of work that are tried, spread over all of its allocations. */
enum { MOST_TRIES = 100 };

static lmb_result bake_into(const char *folder_name, lmb_error *error)
{
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.level.path = LEVEL;
    settings.level.threads = 1;
    settings.level.environment = "#404040";
    settings.spacing = 2.0f;
    settings.samples = settings.max_samples = 4;
    settings.lightmaps = true;
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
    const long tries = count < MOST_TRIES ? count : MOST_TRIES;
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

static void every_allocation_fails(void)
{
    lmb_error error = {{0}};
    mkdir(OUTPUT, 0777);
    CHECK_RUN(0, NULL, "rm -rf " BAKED " " TRIED);
    if (lmb_level_quad_light(LEVEL, 2.0f, 5.0f, &error) != LMB_OK || bake_into(BAKED, &error) != LMB_OK) {
        CHECK(false, "%s", error.message);
        return;
    }
    allocation_fail_new(true);
    each_fails("load", load_try);
    allocation_fail_new(false);
    each_fails("bake", bake_try);
    each_fails("open", open_try);
}

static const test_case cases[] = {{"every_allocation_fails", every_allocation_fails}};
TEST_MAIN(cases)
