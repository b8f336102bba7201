/* Lightmaps in compressed textures: written and read back, the same for any number of threads, their mip levels without
 * a neighbour's light, and refused when they are broken. */
#define _POSIX_C_SOURCE 200809L
#include "lightmap_fixture.h"

#include <sys/stat.h>

#include <cjson/cJSON.h>
#include <lambent/block_texture.h>
#include <lambent/file.h>

/* A box with a lamp, baked in the model of textures, to be written as `format`. */
static bool cornell_bake(baked *bake, lmb_lightmap_format format, const lmb_model *model, int threads)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_textures.glb");
    memset(bake, 0, sizeof *bake);
    if (!level_fixture_open(&bake->level, path, lmb_level_cornell(path, &error), &error, threads)) {
        return false;
    }
    const lmb_lightmap_settings settings = {.texels_per_m = 16.0f,
                                            .max_image_size = 1024,
                                            .padding = 4,
                                            .format = format,
                                            .model = model,
                                            .pool = bake->level.pool};
    const bool made = lmb_lightmap_create(bake->level.scene, &settings, &bake->lightmap, &error) == LMB_OK &&
                      lightmap_bake(bake, 256);
    CHECK(made, "%s", error.message);
    return made;
}

static lmb_lightmap *read_again(const lmb_lightmap *written, const char *directory, lmb_result expected)
{
    lmb_error error = {""};
    lmb_lightmap *read = NULL;
    CHECK(lmb_lightmap_create(written->scene, &written->settings, &read, &error) == LMB_OK, "%s", error.message);
    const lmb_result result = read ? lmb_lightmap_read(read, directory, &error) : LMB_ERROR_MEMORY;
    CHECK(result == expected, "%s: %s", directory, error.message);
    return read;
}

/* Of texels that were not denoised, and differ from their neighbours by some per cent: root mean square errors of
 * covered texels: of light, relative to a texel's largest channel, and of the others. */
static void texels_compare(const lmb_lightmap *a, const lmb_lightmap *b, double *light, double *rest)
{
    const lmb_lightmap_image *x = &a->image[0], *y = &b->image[0];
    size_t count = 0;
    *light = *rest = 0.0;
    for (size_t i = 0; i < (size_t)x->width * (size_t)x->height; ++i) {
        if (x->state[i] != LMB_TEXEL_GATHERED) {
            continue;
        }
        double largest = 1e-3;
        for (int c = 0; c < 3; ++c) {
            largest = fmax(largest, (double)lmb_lightmap_plane(x, c)[i]);
        }
        for (int c = 0; c < a->model->channel_count; ++c) {
            const double off = (double)lmb_lightmap_plane(y, c)[i] - (double)lmb_lightmap_plane(x, c)[i];
            *(c < 3 ? light : rest) += c < 3 ? off * off / (largest * largest) : off * off;
        }
        ++count;
    }
    *light = sqrt(*light / (3.0 * (double)count));
    *rest = sqrt(*rest / (3.0 * (double)count));
}

static void textures_read_back(void)
{
    static const char *const directories[] = {NULL, OUTPUT("lightmap_ktx2"), OUTPUT("lightmap_dds"),
                                              OUTPUT("lightmap_astc")};
    for (int format = LMB_LIGHTMAP_KTX2; format < LMB_LIGHTMAP_FORMATS; ++format) {
        lmb_error error = {""};
        baked bake;
        uint64_t bytes = 0;
        if (format == LMB_LIGHTMAP_KTX2_ASTC && !lmb_block_format_is_here(LMB_BLOCK_ASTC)) {
            continue;
        }
        mkdir(directories[format], 0777);
        if (cornell_bake(&bake, (lmb_lightmap_format)format, NULL, 2)) {
            CHECK(bake.lightmap->model == lmb_model_default(LMB_MODEL_FOR_TEXTURE), "%s", bake.lightmap->model->name);
            CHECK(lmb_lightmap_write(bake.lightmap, directories[format], NULL, &bytes, &error) == LMB_OK, "%s",
                  error.message);
            lmb_lightmap *read = read_again(bake.lightmap, directories[format], LMB_OK);
            if (read) {
                double light, rest;
                texels_compare(bake.lightmap, read, &light, &rest);
                CHECK(light > 0.0 && light < 0.035, "light: %g", light);
                const double most = format == LMB_LIGHTMAP_KTX2_ASTC ? 0.04 : 0.02; /* one line for all three */
                CHECK(rest > 0.0 && rest < most, "weight and direction: %g", rest);
            }
            lmb_lightmap_destroy(read);
        }
        baked_close(&bake);
    }
}

/* SH3 over l0, in layers: of each colour 24, and those of luminance. The ratios lie in +-sqrt(3) and +-sqrt(5). */
static void sh3_reads_back(void)
{
    static const struct {
        const char *model, *directory;
        int layers; /* of band 1 */
    } kinds[] = {{"sh3.ratios", OUTPUT("lightmap_ratios"), 9}, {"sh3.shared-ratios", OUTPUT("lightmap_shared"), 3}};
    for (int k = 0; k < 2; ++k) {
        lmb_error error = {""};
        baked bake;
        uint64_t bytes = 0;
        mkdir(kinds[k].directory, 0777);
        if (cornell_bake(&bake, LMB_LIGHTMAP_KTX2, lmb_model_for_lightmap(kinds[k].model), 2)) {
            CHECK(lmb_lightmap_write(bake.lightmap, kinds[k].directory, NULL, &bytes, &error) == LMB_OK, "%s",
                  error.message);
            lmb_lightmap *read = read_again(bake.lightmap, kinds[k].directory, LMB_OK);
            double light = 0.0, rest = 0.0;
            if (read) {
                texels_compare(bake.lightmap, read, &light, &rest);
            }
            CHECK(light > 0.0 && light < 0.035, "%s: l0: %g", kinds[k].model, light);
            CHECK(rest > 0.0 && rest < 0.2, "%s: ratios: %g", kinds[k].model, rest);
            lmb_lightmap_destroy(read);
            char path[512];
            lmb_block_texture texture;
            lmb_block_container container;
            snprintf(path, sizeof path, "%s/lightmap_0_%s_linear.ktx2", kinds[k].directory, kinds[k].model);
            CHECK(lmb_block_texture_read(path, &texture, &container, &error) == LMB_OK, "%s", error.message);
            CHECK(texture.layers == kinds[k].layers && texture.format == LMB_BLOCK_BC4, "%s: %d layers", path,
                  texture.layers);
            lmb_block_texture_free(&texture);
        }
        baked_close(&bake);
    }
}

static void files_equal(const char *a, const char *b)
{
    unsigned char *data_a = NULL, *data_b = NULL;
    size_t size_a = 0, size_b = 1;
    lmb_error error = {""};
    const bool read =
        lmb_file_read(a, &data_a, &size_a, &error) == LMB_OK && lmb_file_read(b, &data_b, &size_b, &error) == LMB_OK;
    CHECK(read && size_a == size_b && memcmp(data_a, data_b, size_a) == 0, "%s and %s differ", a, b);
    free(data_a);
    free(data_b);
}

static void threads_make_no_difference(void)
{
    static const char *const directories[] = {OUTPUT("lightmap_textures_1"), OUTPUT("lightmap_textures_5")};
    static const char *const names[] = {"lightmap_0.ktx2", "lightmap_0_disc_ambient_weight.ktx2",
                                        "lightmap_0_disc_direction.ktx2", "lightmap.json"};
    for (int i = 0; i < 2; ++i) {
        lmb_error error = {""};
        uint64_t bytes = 0;
        baked bake;
        mkdir(directories[i], 0777);
        if (cornell_bake(&bake, LMB_LIGHTMAP_KTX2, NULL, i == 0 ? 1 : 5)) {
            CHECK(lmb_lightmap_write(bake.lightmap, directories[i], NULL, &bytes, &error) == LMB_OK, "%s",
                  error.message);
        }
        baked_close(&bake);
    }
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        char a[512], b[512];
        snprintf(a, sizeof a, "%s/%s", directories[0], names[i]);
        snprintf(b, sizeof b, "%s/%s", directories[1], names[i]);
        files_equal(a, b);
    }
}

/* Instances in turn get reddish and greenish light: 1 and 1/4. */
static void regions_paint(lmb_lightmap *lightmap)
{
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const lmb_lightmap_region *region = &lightmap->region[i];
        const int32_t padding = lightmap->settings.padding;
        for (int32_t y = -padding; region->image >= 0 && y < region->height + padding; ++y) {
            for (int32_t x = -padding; x < region->width + padding; ++x) {
                const lmb_lightmap_image *image = &lightmap->image[region->image];
                const size_t at = (size_t)(region->y + y) * (size_t)image->width + (size_t)(region->x + x);
                lmb_lightmap_plane(image, 0)[at] = i % 2 == 0 ? 1.0f : 0.25f;
                lmb_lightmap_plane(image, 1)[at] = i % 2 == 0 ? 0.25f : 1.0f;
                lmb_lightmap_plane(image, 2)[at] = 0.25f;
            }
        }
    }
}

/* How far what filtering a level reads anywhere on the regions' surfaces is from their own colour, at most. */
static double foreign_light(const lmb_lightmap *lightmap, const lmb_block_texture *texture, int32_t level,
                            float *const *plane)
{
    const int32_t width = lmb_block_texture_side(texture->width, level);
    const int32_t height = lmb_block_texture_side(texture->height, level);
    double worst = 0.0;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const lmb_lightmap_region *region = &lightmap->region[i];
        for (int32_t k = 0; region->image == 0 && k <= 4 * region->width * 4 * region->height; ++k) {
            const double u = region->x + 0.25 * (k % (4 * region->width));
            const double v = region->y + 0.25 * (k / (4 * region->width));
            const double x = u * width / texture->width - 0.5, y = v * height / texture->height - 0.5;
            double seen[2] = {0.0, 0.0};
            for (int corner = 0; corner < 4; ++corner) {
                const double column = floor(x) + corner % 2, row = floor(y) + corner / 2;
                const double weight = (1.0 - fabs(x - column)) * (1.0 - fabs(y - row));
                const size_t at = (size_t)fmin(fmax(row, 0.0), height - 1) * (size_t)width +
                                  (size_t)fmin(fmax(column, 0.0), width - 1);
                seen[0] += weight * (double)plane[0][at];
                seen[1] += weight * (double)plane[1][at];
            }
            const double own = seen[i % 2], other = seen[1 - i % 2];
            worst = fmax(worst, fmax(fabs(own - 1.0), fabs(other - 0.25)));
        }
    }
    return worst;
}

static void charts_do_not_bleed(void)
{
    static const int paddings[] = {1, 2, 3, 5, 6, 13}, levels[] = {1, 1, 2, 2, 3, 4};
    const char *directory = OUTPUT("lightmap_bleed");
    const char *path = OUTPUT("lightmap_bleed.glb");
    lmb_error error = {""};
    mkdir(directory, 0777);
    baked bake;
    if (!level_fixture_open(&bake.level, path, write_tiles(path, 1.0f, &error), &error, 2)) {
        return;
    }
    for (int p = 0; p < 6; ++p) {
        const lmb_lightmap_settings settings = {
            .texels_per_m = 9.0f, .max_image_size = 256, .padding = paddings[p], .format = LMB_LIGHTMAP_KTX2};
        uint64_t bytes = 0;
        CHECK(lmb_lightmap_create(bake.level.scene, &settings, &bake.lightmap, &error) == LMB_OK &&
                  lightmap_bake(&bake, 8),
              "%s", error.message);
        regions_paint(bake.lightmap);
        CHECK(lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK, "%s", error.message);
        lmb_block_texture texture;
        lmb_block_container container;
        CHECK(lmb_block_texture_read(OUTPUT("lightmap_bleed/lightmap_0.ktx2"), &texture, &container, &error) == LMB_OK,
              "%s", error.message);
        CHECK(texture.levels == levels[p], "padding of %d: %d levels", paddings[p], texture.levels);
        const size_t texels = (size_t)texture.width * (size_t)texture.height;
        float *const values = malloc(3 * texels * sizeof *values);
        float *const plane[3] = {values, values + texels, values + 2 * texels};
        for (int32_t level = 0; level < texture.levels; ++level) {
            lmb_block_texture_decode(&texture, level, 0, plane);
            const double worst = foreign_light(bake.lightmap, &texture, level, plane);
            /* A neighbour's light would be some tenths; blocks of three colours are off by some hundredths. */
            CHECK(worst < 0.03, "padding of %d, level %d: off by %g", paddings[p], level, worst);
        }
        free(values);
        lmb_block_texture_free(&texture);
        lmb_lightmap_destroy(bake.lightmap);
        bake.lightmap = NULL;
    }
    baked_close(&bake);
}

/* What the JSON says of the textures, and what is done when it or they are broken. */
static void broken_textures_are_refused(void)
{
    static const char *const wrong[] = {"\"scale\":\t0", "\"scale\":\t-1", "\"scale\":\t\"1\""};
    lmb_error error = {""};
    const char *directory = OUTPUT("lightmap_textures_broken");
    const char *json_path = OUTPUT("lightmap_textures_broken/lightmap.json");
    const char *texture_path = OUTPUT("lightmap_textures_broken/lightmap_0_disc_direction.ktx2");
    uint64_t bytes = 0;
    mkdir(directory, 0777);
    baked bake;
    if (!cornell_bake(&bake, LMB_LIGHTMAP_KTX2, NULL, 2)) {
        baked_close(&bake);
        return;
    }
    CHECK(lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK, "%s", error.message);
    unsigned char *text = NULL, *texture = NULL;
    size_t size = 0, texture_size = 0;
    CHECK(lmb_file_read(json_path, &text, &size, &error) == LMB_OK &&
              lmb_file_read(texture_path, &texture, &texture_size, &error) == LMB_OK,
          "%s", error.message);
    cJSON *root = cJSON_ParseWithLength((const char *)text, size);
    const cJSON *image = cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(root, "images"), 0);
    CHECK(strcmp(cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(root, "image_format")), "ktx2") == 0,
          "image_format");
    CHECK(strcmp(cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(image, "file")), "lightmap_0.ktx2") == 0,
          "file");
    cJSON_Delete(root);
    const char *scale = text ? strstr((const char *)text, "\"scale\":\t1,") : NULL;
    CHECK(scale, "no scale of 1");
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0] && scale; ++i) {
        char *changed = malloc(size + 16);
        const size_t before = (size_t)(scale - (const char *)text), after = before + strlen("\"scale\":\t1");
        const int length = snprintf(changed, size + 16, "%.*s%s%s", (int)before, (const char *)text, wrong[i],
                                    (const char *)text + after);
        CHECK(lmb_file_write(json_path, changed, (size_t)length, &error) == LMB_OK, "%s", error.message);
        lmb_lightmap_destroy(read_again(bake.lightmap, directory, LMB_ERROR_FORMAT));
        free(changed);
    }
    CHECK(lmb_file_write(json_path, text, size, &error) == LMB_OK, "%s", error.message);
    CHECK(lmb_file_write(texture_path, texture, texture_size - 16, &error) == LMB_OK, "%s", error.message);
    lmb_lightmap_destroy(read_again(bake.lightmap, directory, LMB_ERROR_FORMAT));
    remove(texture_path);
    lmb_lightmap_destroy(read_again(bake.lightmap, directory, LMB_ERROR_IO));
    free(texture);
    free(text);
    baked_close(&bake);
}

/* Another model of the lightmap, as pictures or textures beside its own: the mean of its first channel. */
static void beside_reads_back(const baked *bake, int other, double tolerance)
{
    lmb_error error = {""};
    const lmb_model *model = bake->lightmap->settings.other[other];
    lmb_lightmap *read = read_again(bake->lightmap, OUTPUT("lightmap_beside"), LMB_OK);
    const lmb_result result =
        read ? lmb_lightmap_read_model(read, model, OUTPUT("lightmap_beside"), &error) : LMB_ERROR_MEMORY;
    CHECK(result == LMB_OK, "%s: %s", model->name, error.message);
    const lmb_lightmap_image *image = &bake->lightmap->image[0];
    double written = 0.0, again = 0.0;
    for (size_t i = 0; result == LMB_OK && i < (size_t)image->width * (size_t)image->height; ++i) {
        if (image->state[i] == LMB_TEXEL_GATHERED) {
            written += (double)image->other[other][i];
            again += (double)lmb_lightmap_plane(&read->image[0], 0)[i];
        }
    }
    CHECK(result != LMB_OK || written > 0.0, "no light");
    CHECK_NEAR(again, written, tolerance * written, "%s", model->name);
    lmb_lightmap_destroy(read);
}

/* Models that textures do not hold are refused as the lightmap's own, and written as EXR beside it. */
static void other_models_stay_pictures(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_beside.glb");
    mkdir(OUTPUT("lightmap_beside"), 0777);
    baked bake;
    if (!level_fixture_open(&bake.level, path, write_tiles(path, 1.0f, &error), &error, 2)) {
        return;
    }
    lmb_lightmap_settings settings = {.texels_per_m = 4.0f,
                                      .max_image_size = 256,
                                      .format = LMB_LIGHTMAP_DDS,
                                      .model = lmb_model_for_lightmap("hlsh")};
    CHECK(lmb_lightmap_create(bake.level.scene, &settings, &bake.lightmap, &error) == LMB_ERROR_ARGUMENT, "no error");
    settings.model = NULL;
    settings.other[0] = lmb_model_for_lightmap("hlsh");
    settings.other[1] = lmb_model_for_lightmap("sh3");
    settings.other[2] = lmb_model_for_lightmap("sh3.ratios");
    uint64_t bytes = 0;
    CHECK(lmb_lightmap_create(bake.level.scene, &settings, &bake.lightmap, &error) == LMB_OK && lightmap_bake(&bake, 8),
          "%s", error.message);
    CHECK(lmb_lightmap_write(bake.lightmap, OUTPUT("lightmap_beside"), NULL, &bytes, &error) == LMB_OK, "%s",
          error.message);
    struct stat status;
    CHECK(stat(OUTPUT("lightmap_beside/lightmap_0_hlsh.exr"), &status) == 0, "no EXR");
    CHECK(stat(OUTPUT("lightmap_beside/lightmap_0.dds"), &status) == 0, "no DDS");
    beside_reads_back(&bake, 0, 0.002);
    beside_reads_back(&bake, 1, 0.002);
    beside_reads_back(&bake, 2, 0.05);
    baked_close(&bake);
}

static const test_case cases[] = {
    {"textures_read_back", textures_read_back},
    {"sh3_reads_back", sh3_reads_back},
    {"threads_make_no_difference", threads_make_no_difference},
    {"charts_do_not_bleed", charts_do_not_bleed},
    {"broken_textures_are_refused", broken_textures_are_refused},
    {"other_models_stay_pictures", other_models_stay_pictures},
};

TEST_MAIN(cases)
