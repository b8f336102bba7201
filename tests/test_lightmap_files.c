/* The lightmap's files: written, read back, refused when they are another layout's or broken. */
#define _POSIX_C_SOURCE 200809L
#include "lightmap_fixture.h"

#include <sys/stat.h>

#include <lambent/file.h>

static void empty_level(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_empty.glb");
    const char *directory = OUTPUT("lightmap_empty");
    mkdir(directory, 0777);
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    add_sun(builder, 1.0f);
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    baked bake;
    if (!baked_open(&bake, path, written, &error, (baked_settings){.texels_per_m = 1.0f, .samples = 8, .threads = 2})) {
        return;
    }
    CHECK(bake.lightmap->image_count == 0 && bake.stats.elements == 0, "%d images", (int)bake.lightmap->image_count);
    CHECK(lmb_lightmap_settings_default(bake.level.scene).texels_per_m > 0.0f, "no default");
    uint64_t bytes = 0;
    CHECK(lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK && bytes > 0, "%s",
          error.message);
    CHECK(lmb_lightmap_read(bake.lightmap, directory, &error) == LMB_OK, "%s", error.message);
    baked_close(&bake);
}

static void charts_go_into_a_level(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_charts.glb");
    const char *directory = OUTPUT("lightmap_charts");
    mkdir(directory, 0777);
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 2)) {
        return;
    }
    for (uint32_t m = 0; m < bake.level.scene->mesh_count; ++m) {
        uv_break(&bake.level.scene->meshes[m], LMB_UV_MISSING);
    }
    uint64_t bytes = 0;
    lmb_scene *again = NULL;
    if (lightmap_make(&bake, 8.0f, 1024) &&
        lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK &&
        lmb_gltf_load(OUTPUT("lightmap_charts/level_uv2.glb"), NULL, &again, &error) == LMB_OK) {
        CHECK(again->mesh_count == bake.level.scene->mesh_count, "%u meshes", again->mesh_count);
        for (uint32_t m = 0; m < again->mesh_count && m < bake.level.scene->mesh_count; ++m) {
            const lmb_mesh *mesh = &again->meshes[m];
            CHECK(mesh->triangle_count == bake.level.scene->meshes[m].triangle_count && mesh->uv[1], "mesh %u", m);
            for (uint32_t k = 0; mesh->uv[1] && k < 3 * mesh->triangle_count; ++k) {
                const lmb_vec2 found = mesh->uv[1][mesh->triangle[k / 3][k % 3]];
                CHECK_NEAR(found.x, bake.lightmap->corner_uv[m][k].x, 0.0, "mesh %u corner %u", m, k);
                CHECK_NEAR(found.y, bake.lightmap->corner_uv[m][k].y, 0.0, "mesh %u corner %u", m, k);
            }
        }
    } else {
        CHECK(false, "%s", error.message);
    }
    lmb_scene_destroy(again);
    baked_close(&bake);
}

/* fp16 keeps 11 bits; below 2^-14 it steps by 2^-24. */
static bool half_near(float stored, float value, float scale)
{
    return fabsf(stored - value) <= fmaxf(fabsf(value) * 0x1p-11f, scale * 0x1p-25f) * 1.001f;
}

static void check_read_back(const lmb_lightmap *written, const char *directory)
{
    lmb_error error = {""};
    lmb_lightmap *read = NULL;
    if (lmb_lightmap_create(written->scene, &written->settings, &read, &error) != LMB_OK ||
        lmb_lightmap_read(read, directory, &error) != LMB_OK) {
        CHECK(false, "%s", error.message);
        lmb_lightmap_destroy(read);
        return;
    }
    for (int32_t i = 0; i < written->image_count; ++i) {
        const lmb_lightmap_image *a = &written->image[i];
        const lmb_lightmap_image *b = &read->image[i];
        float brightest = 0.0f;
        const size_t texels = (size_t)a->width * (size_t)a->height;
        for (size_t k = 0; k < 3 * texels; ++k) {
            brightest = fmaxf(brightest, lmb_lightmap_plane(a, (int)(k % 3))[k / 3]);
        }
        const float scale = fmaxf(brightest / 16384.0f, 1.0f);
        size_t wrong = 0;
        for (size_t k = 0; k < texels; ++k) {
            const lmb_irradz x = image_irradz(a, k);
            const lmb_irradz y = image_irradz(b, k);
            bool good = half_near(y.ambient_weight, x.ambient_weight, 1.0f) &&
                        half_near(y.direction.x, x.direction.x, 1.0f) &&
                        half_near(y.direction.y, x.direction.y, 1.0f) &&
                        half_near(y.direction.z, x.direction.z, 1.0f) && a->state[k] == b->state[k];
            for (int c = 0; c < 3; ++c) {
                good = good && half_near(y.irradiance_z.c[c], x.irradiance_z.c[c], scale);
            }
            wrong += !good;
        }
        CHECK(wrong == 0, "%zu texels of image %d", wrong, (int)i);
    }
    lmb_lightmap_destroy(read);
}

static void files_read_back(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_files.glb");
    const char *directory = OUTPUT("lightmap files \xc3\xa9");
    mkdir(directory, 0777);
    baked bake;
    if (!baked_open(&bake, path, lmb_level_cornell(path, &error), &error,
                    (baked_settings){.texels_per_m = 8.0f, .samples = 16, .threads = 2})) {
        return;
    }
    uint64_t bytes = 0;
    const lmb_result written = lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error);
    CHECK(written == LMB_OK && bytes > 0, "%s", error.message);
    check_read_back(bake.lightmap, directory);

    /* Another density is another layout, and nothing of the lightmap changes. */
    const lmb_lightmap_settings other = {.texels_per_m = 9.0f, .max_image_size = 1024};
    lmb_lightmap *lightmap = NULL;
    if (lmb_lightmap_create(bake.level.scene, &other, &lightmap, &error) == LMB_OK) {
        CHECK(lmb_lightmap_read(lightmap, directory, &error) == LMB_ERROR_FORMAT, "another layout was read");
        CHECK(strstr(error.message, "lightmap.json"), "%s", error.message);
        CHECK(lmb_lightmap_read(lightmap, OUTPUT("nowhere"), &error) == LMB_ERROR_IO, "%s", error.message);
        CHECK(count_state(lightmap, LMB_TEXEL_EMPTY) ==
                  (uint64_t)lightmap->image[0].width * (uint64_t)lightmap->image[0].height,
              "a failed read left texels");
        CHECK(lmb_lightmap_write(lightmap, OUTPUT("nowhere"), NULL, &bytes, &error) == LMB_ERROR_WRITE, "%s",
              error.message);
        lmb_lightmap_destroy(lightmap);
    }
    baked_close(&bake);
}

static void files_broken_are_refused(void)
{
    static const char *const TEXTS[] = {
        "",
        "{",
        "[]",
        "{\"format\": \"lambent lightmap\"}",
        "{\"format\": \"lambent lightmap\", \"version\": 1, \"encoding\": \"irradz-hhd\"}",
        "{\"format\": \"lambent lightmap\", \"version\": 1000, \"encoding\": \"irradz-hhd\", \"images\": [], "
        "\"nodes\": []}",
        "{\"format\": \"lambent lightmap\", \"version\": 2, \"encoding\": \"irradz-hhd\", "
        "\"images\": [3, null], \"nodes\": {}}",
        "{\"format\": \"lambent lightmap\", \"version\": 2, \"encoding\": \"irradz-hhd\", "
        "\"images\": [], \"nodes\": [{\"offset\": [1]}]}"};
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_broken.glb");
    const char *directory = OUTPUT("lightmap_broken");
    mkdir(directory, 0777);
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 1)) {
        return;
    }
    if (lightmap_make(&bake, 4.0f, 1024)) {
        for (size_t i = 0; i < sizeof TEXTS / sizeof TEXTS[0]; ++i) {
            CHECK(lmb_file_write(OUTPUT("lightmap_broken/lightmap.json"), TEXTS[i], strlen(TEXTS[i]), &error) == LMB_OK,
                  "%s", error.message);
            CHECK(lmb_lightmap_read(bake.lightmap, directory, &error) == LMB_ERROR_FORMAT, "text %zu", i);
        }
    }
    baked_close(&bake);
}

static void sunlight_fits(void)
{
    static const float LUX[] = {1e6f, 1e-6f, 2e5f};
    for (size_t i = 0; i < sizeof LUX / sizeof LUX[0]; ++i) {
        lmb_error error = {""};
        const char *path = OUTPUT("lightmap_bright.glb");
        const char *directory = OUTPUT("lightmap_bright");
        mkdir(directory, 0777);
        baked bake;
        if (!baked_open(&bake, path, write_tiles(path, LUX[i], &error), &error,
                        (baked_settings){.texels_per_m = 2.0f, .samples = 8, .threads = 1})) {
            return;
        }
        uint64_t bytes = 0;
        CHECK(lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK, "%s", error.message);
        check_read_back(bake.lightmap, directory);
        CHECK_NEAR(sample_irradz(bake.lightmap, 0, 0, 0.3f, 0.3f).irradiance_z.c[0], (double)LUX[i] / 3.14159265358979,
                   1e-3 * (double)LUX[i], "%g lux", (double)LUX[i]);
        baked_close(&bake);
    }
}

static void check_files_equal(const char *a, const char *b)
{
    unsigned char *data_a = NULL, *data_b = NULL;
    size_t size_a = 0, size_b = 0;
    lmb_error error = {""};
    const bool read =
        lmb_file_read(a, &data_a, &size_a, &error) == LMB_OK && lmb_file_read(b, &data_b, &size_b, &error) == LMB_OK;
    CHECK(read, "%s", error.message);
    CHECK(read && size_a == size_b && memcmp(data_a, data_b, size_a) == 0, "%s and %s differ", a, b);
    free(data_a);
    free(data_b);
}

static void threads_make_no_difference(void)
{
    static const int THREADS[] = {1, 2, 7};
    static const char *const DIRECTORIES[] = {OUTPUT("lightmap_t1"), OUTPUT("lightmap_t2"), OUTPUT("lightmap_t7")};
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_threads.glb");
    uint64_t moved = 0;
    uint64_t rays = 0;
    for (size_t i = 0; i < 3; ++i) {
        mkdir(DIRECTORIES[i], 0777);
        baked bake;
        if (!baked_open(&bake, path, lmb_level_cornell(path, &error), &error,
                        (baked_settings){.texels_per_m = 8.0f, .samples = 16, .threads = THREADS[i]})) {
            return;
        }
        uint64_t bytes = 0;
        CHECK(lmb_lightmap_write(bake.lightmap, DIRECTORIES[i], NULL, &bytes, &error) == LMB_OK, "%s", error.message);
        CHECK(i == 0 || (bake.stats.rays == rays && bake.stats.moved == moved), "%d threads", THREADS[i]);
        rays = bake.stats.rays;
        moved = bake.stats.moved;
        baked_close(&bake);
    }
    check_files_equal(OUTPUT("lightmap_t1/lightmap_0.exr"), OUTPUT("lightmap_t2/lightmap_0.exr"));
    check_files_equal(OUTPUT("lightmap_t1/lightmap_0.exr"), OUTPUT("lightmap_t7/lightmap_0.exr"));
    check_files_equal(OUTPUT("lightmap_t1/lightmap.json"), OUTPUT("lightmap_t2/lightmap.json"));
    check_files_equal(OUTPUT("lightmap_t1/lightmap.json"), OUTPUT("lightmap_t7/lightmap.json"));
}

/* A level baked with 16 samples in the default model, HLSH and SH3, with errors. */
static bool models_bake(baked *bake, const char *path, lmb_result written, lmb_error *error)
{
    memset(bake, 0, sizeof *bake);
    if (!level_fixture_open(&bake->level, path, written, error, 2)) {
        return false;
    }
    const lmb_lightmap_settings settings = {.texels_per_m = 4.0f,
                                            .max_image_size = 256,
                                            .other = {lmb_model_for_lightmap("hlsh"), lmb_model_for_lightmap("sh3")},
                                            .error = true};
    const bool made = lmb_lightmap_create(bake->level.scene, &settings, &bake->lightmap, error) == LMB_OK &&
                      lmb_lightmap_bake(bake->lightmap, &bake->level.transport, &(lmb_gather_effort){.samples = 16},
                                        bake->level.pool, NULL, &bake->stats) == LMB_OK;
    CHECK(made, "%s", error->message);
    if (!made) {
        baked_close(bake);
    }
    return made;
}

/* What OpenEXR's own tool says of a file's header. */
static void header_shown(const char *path, char *shown, size_t size)
{
    char command[512];
    snprintf(command, sizeof command, "exrheader '%s'", path);
    FILE *pipe = popen(command, "r");
    size_t length = 0;
    if (pipe) {
        length = fread(shown, 1, size - 1, pipe);
        CHECK(pclose(pipe) == 0, "exrheader %s failed", path);
    }
    shown[length] = '\0';
}

/* The picture has R, G and B alone, which every program opens; so has what fits four channels. */
static void exrheader_shows_channels(void)
{
    static const struct {
        const char *file;
        const char *has[6];
        const char * not [6];
    } FILES[] = {
        {OUTPUT("lightmap_header/lightmap_0.exr"),
         {"R, 16-bit", "G, 16-bit", "B, 16-bit", "lambent:scale", "irradz-hhd"},
         {"A, 16-bit", "w, 16-bit", "d.X"}},
        {OUTPUT("lightmap_header/lightmap_0_hhd.exr"), {"R, 16-bit", "G, 16-bit", "B, 16-bit", "A, 16-bit"}, {"d.X"}},
        {OUTPUT("lightmap_header/lightmap_0_sh3.gram.exr"), {"c26, 16-bit", "sh3.gram", "lambent:scale"}, {NULL}},
        {OUTPUT("lightmap_header/lightmap_0_error.exr"), {"Y, 16-bit"}, {"R, 16-bit"}},
    };
    if (system("exrheader >/dev/null 2>&1 </dev/null") == 127 << 8) {
        test_skip("exrheader is not installed");
        return;
    }
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_header.glb");
    mkdir(OUTPUT("lightmap_header"), 0777);
    baked bake;
    if (!models_bake(&bake, path, write_tiles(path, 1.0f, &error), &error)) {
        return;
    }
    uint64_t bytes = 0;
    CHECK(lmb_lightmap_write(bake.lightmap, OUTPUT("lightmap_header"), NULL, &bytes, &error) == LMB_OK, "%s",
          error.message);
    for (size_t i = 0; i < sizeof FILES / sizeof FILES[0]; ++i) {
        char shown[8192];
        header_shown(FILES[i].file, shown, sizeof shown);
        for (int k = 0; k < 6; ++k) {
            CHECK(!FILES[i].has[k] || strstr(shown, FILES[i].has[k]), "no '%s' in:\n%s", FILES[i].has[k], shown);
            CHECK(!FILES[i].not [k] || !strstr(shown, FILES[i].not [k]), "'%s' in:\n%s", FILES[i].not [k], shown);
        }
    }
    baked_close(&bake);
}

/* Models that are baked together are what each is by itself. */
static void models_together_are_models_apart(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_models.glb");
    baked together;
    if (!models_bake(&together, path, lmb_level_cornell(path, &error), &error)) {
        return;
    }
    for (int k = -1; k < 2; ++k) {
        const lmb_model *model = k < 0 ? together.lightmap->model : together.lightmap->settings.other[k];
        lmb_lightmap_settings settings = together.lightmap->settings;
        settings.model = model;
        memset(settings.other, 0, sizeof settings.other);
        settings.error = false;
        lmb_lightmap *apart = NULL;
        CHECK(lmb_lightmap_create(together.level.scene, &settings, &apart, &error) == LMB_OK, "%s", error.message);
        lmb_gather_stats stats;
        CHECK(apart && lmb_lightmap_bake(apart, &together.level.transport, &(lmb_gather_effort){.samples = 16},
                                         together.level.pool, NULL, &stats) == LMB_OK,
              "bakes");
        const lmb_lightmap_image *one = &together.lightmap->image[0], *two = apart ? &apart->image[0] : NULL;
        const size_t count = (size_t)one->width * (size_t)one->height;
        CHECK(two && memcmp(k < 0 ? one->plane : one->other[k], two->plane,
                            count * (size_t)model->channel_count * sizeof(float)) == 0,
              "%s", model->name);
        lmb_lightmap_destroy(apart);
    }
    /* Errors where texels were gathered, and only there. */
    const lmb_lightmap_image *image = &together.lightmap->image[0];
    double sum = 0.0, gathered = 0.0;
    for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; ++i) {
        CHECK(image->error[i] >= 0.0f && (image->state[i] == LMB_TEXEL_GATHERED || image->error[i] == 0.0f),
              "texel %zu: %g", i, (double)image->error[i]);
        sum += (double)image->error[i];
        gathered += image->state[i] == LMB_TEXEL_GATHERED;
    }
    CHECK(sum / gathered > 0.01 && sum / gathered < 0.5, "mean error of 16 samples: %g", sum / gathered);
    baked_close(&together);
}

/* Of a folder that holds several models, any is read; of one that was not written, the lightmap keeps what it has. */
static void other_models_are_read(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_others.glb");
    const char *directory = OUTPUT("lightmap_others");
    mkdir(directory, 0777);
    static const char *const names[] = {"rnm", "sh2.fit", "hlsh"};
    enum { OTHERS = sizeof names / sizeof names[0] };
    baked bake = {.lightmap = NULL};
    if (!level_fixture_open(&bake.level, path, write_tiles(path, 3.0f, &error), &error, 1)) {
        return;
    }
    lmb_lightmap_settings settings = {.texels_per_m = 4.0f, .max_image_size = 256};
    for (int k = 0; k < OTHERS; ++k) {
        settings.other[k] = lmb_model_for_lightmap(names[k]);
    }
    lmb_lightmap *read = NULL;
    uint64_t bytes = 0;
    CHECK(lmb_lightmap_create(bake.level.scene, &settings, &bake.lightmap, &error) == LMB_OK &&
              lightmap_bake(&bake, 16) &&
              lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK &&
              lmb_lightmap_create(bake.level.scene, &settings, &read, &error) == LMB_OK &&
              lmb_lightmap_read(read, directory, &error) == LMB_OK,
          "%s", error.message);
    for (int k = 0; k < OTHERS && read; ++k) {
        const lmb_model *model = settings.other[k];
        CHECK(lmb_lightmap_read_model(read, model, directory, &error) == LMB_OK && read->model == model, "%s: %s",
              names[k], error.message);
        const lmb_lightmap_image *image = &bake.lightmap->image[0];
        const size_t texels = (size_t)image->width * (size_t)image->height;
        size_t wrong = 0;
        for (size_t i = 0; i < (size_t)model->channel_count * texels; ++i) {
            const bool picture = model->irradiance_first && i < 3 * texels; /* shared with the lightmap's own */
            wrong += !half_near(read->image[0].plane[i], picture ? image->plane[i] : image->other[k][i], 1.0f);
        }
        CHECK(wrong == 0, "%s: %zu numbers", names[k], wrong);
    }
    const lmb_model *last = read ? read->model : NULL;
    CHECK(read && lmb_lightmap_read_model(read, lmb_model_for_lightmap("sh3"), directory, &error) == LMB_ERROR_FORMAT &&
              strstr(error.message, "'sh3") && read->model == last,
          "%s", error.message);
    const lmb_hit hit = {.instance = 0, .triangle = 0, .u = 0.3f, .v = 0.3f};
    float channel[LMB_MODEL_MOST_CHANNELS];
    CHECK(read && lmb_lightmap_sample(read, &hit, channel) && channel[0] > 0.5f, "it still has its light");
    lmb_lightmap_destroy(read);
    baked_close(&bake);
}

static const test_case CASES[] = {
    {"other models are read", other_models_are_read},
    {"models together are models apart", models_together_are_models_apart},
    {"an empty level", empty_level},
    {"charts go into a level", charts_go_into_a_level},
    {"files read back", files_read_back},
    {"broken files are refused", files_broken_are_refused},
    {"sunlight fits", sunlight_fits},
    {"threads make no difference", threads_make_no_difference},
    {"exrheader shows the channels", exrheader_shows_channels},
};

TEST_MAIN(CASES)
