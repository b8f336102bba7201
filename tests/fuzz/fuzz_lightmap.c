/* What a folder of a bake holds beside its volume: bake.json, whose settings are read, and lightmap.json, which is held
 * against the level's lightmap. Read settings that make a lightmap make one. */
#define _POSIX_C_SOURCE 200809L
#include "fuzz.h"

#include <string.h>
#include <sys/stat.h>

#include <cjson/cJSON.h>
#include <lambent/gltf.h>
#include <lambent/lightmap.h>

#include "lightmap/lightmap_read.h"
#include "run/bake_settings_internal.h"
#include "scenes/levels.h"

static lmb_scene *scene;
static lmb_lightmap *lightmap;

static void level_make(void)
{
    static const char path[] = LMB_TEST_OUTPUT_DIR "/fuzz_lightmap.glb";
    lmb_error error = {{0}};
    FUZZ_CHECK(lmb_level_quad_light(path, 2.0f, 5.0f, &error) == LMB_OK, "%s", error.message);
    FUZZ_CHECK(lmb_gltf_load(path, NULL, &scene, &error) == LMB_OK, "%s", error.message);
    const lmb_lightmap_settings settings = {.texels_per_m = 2.0f, .max_image_size = 64, .padding = 1};
    FUZZ_CHECK(lmb_lightmap_create(scene, &settings, &lightmap, &error) == LMB_OK, "%s", error.message);
    remove(path);
}

static void settings_read(const char *text, size_t size)
{
    cJSON *const root = cJSON_ParseWithLength(text, size);
    lmb_bake_settings settings;
    if (root && lmb_bake_settings_read(cJSON_GetObjectItemCaseSensitive(root, "settings"), &settings)) {
        FUZZ_CHECK(settings.level.path, "no level");
        cJSON_Delete(lmb_bake_settings_json(&settings, 1));
        /* The limits on what a lightmap may be are lmb_lightmap_create's; those it lets through may take their time. */
        const lmb_lightmap_settings wanted = {.texels_per_m =
                                                  settings.texels_per_m < 8.0f ? settings.texels_per_m : 8.0f,
                                              .max_image_size = settings.max_image_size,
                                              .padding = settings.padding};
        lmb_lightmap *made = NULL;
        lmb_error error = {{0}};
        const lmb_result result = lmb_lightmap_create(scene, &wanted, &made, &error);
        FUZZ_CHECK((result == LMB_OK) == (made != NULL), "%d", result);
        lmb_lightmap_destroy(made);
    }
    cJSON_Delete(root);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lmb_error error = {{0}};
    if (!scene) {
        level_make();
    }
    const lmb_result result = lmb_lightmap_json_check(lightmap, "lightmap.json", (const char *)data, size, &error);
    FUZZ_CHECK(result == LMB_OK || strncmp(error.message, "lightmap.json: ", 15) == 0, "%s", error.message);
    settings_read((const char *)data, size);
    return 0;
}

static void lightmap_seed(void)
{
    static const char folder[] = LMB_TEST_OUTPUT_DIR "/fuzz_lightmap";
    mkdir(folder, 0777);
    lmb_error error = {{0}};
    uint64_t bytes = 0;
    FUZZ_CHECK(lmb_lightmap_write(lightmap, folder, NULL, &bytes, &error) == LMB_OK, "%s", error.message);
    fuzz_seed_file(LMB_TEST_OUTPUT_DIR "/fuzz_lightmap/lightmap.json");
}

static void settings_seed(void)
{
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.level.path = "level.glb";
    settings.level.environment = "#ffffff";
    settings.level.exclude[0] = "Cam*";
    settings.level.exclude_count = 1;
    settings.seeds[0] = (lmb_vec3d){1.0, 2.0, 3.0};
    settings.seed_count = 1;
    settings.lightmaps = true;
    settings.texels_per_m = 4.0f;
    settings.max_image_size = 256;
    settings.padding = 2;
    cJSON *const root = cJSON_CreateObject();
    cJSON_AddItemToObject(root, "settings", lmb_bake_settings_json(&settings, 7));
    char *const text = cJSON_PrintUnformatted(root);
    FUZZ_CHECK(text, "out of memory");
    fuzz_seed(text, strlen(text));
    cJSON_free(text);
    cJSON_Delete(root);
}

void fuzz_seeds(void)
{
    level_make();
    lightmap_seed();
    settings_seed();
}
