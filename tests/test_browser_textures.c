/* Compressed textures against a browser, whose decoder and whose readers of files are not ours: what Chromium's WebGL
 * samples of blocks of any bits, and three.js of files that hold such blocks and of a baked level's lightmaps. Pages
 * are made of tests/browser/. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>

#include <lambent/block_texture.h>
#include <lambent/file.h>

#include "command_fixture.h"
#include "folder_fixture.h"
#include "variates.h"

#define OUT(name) LMB_TEST_OUTPUT_DIR "/browser_" name

enum { MOST_TEXTURES = 32 };

/* BC4 and BC5 are interpolated in whole 255ths there. */
static const float tolerance[] = {[LMB_BLOCK_BC4] = 1.01f / 255.0f, [LMB_BLOCK_BC5] = 1.01f / 255.0f, 0.0f};

/* As WebGL's extensions have them. */
static const unsigned webgl_formats[] = {[LMB_BLOCK_BC4] = 0x8DBB, [LMB_BLOCK_BC5] = 0x8DBD, [LMB_BLOCK_BC6H] = 0x8E8F};

/* What a page is to show. */
static struct {
    char name[128];
    lmb_block_texture texture;
    bool seen;
} asked[MOST_TEXTURES];
static int asked_count;

static lmb_block_texture *ask(const char *name)
{
    CHECK(asked_count < MOST_TEXTURES, "%s", name);
    const int i = asked_count < MOST_TEXTURES ? asked_count++ : 0;
    snprintf(asked[i].name, sizeof asked[i].name, "%s", name);
    asked[i].seen = false;
    return &asked[i].texture;
}

static void asked_clear(void)
{
    for (int i = 0; i < asked_count; ++i) {
        lmb_block_texture_free(&asked[i].texture);
    }
    asked_count = 0;
}

/* Bits as they come, but each mode of BC6H in turn, the reserved ones too. */
static bool any_bits_make(lmb_block_format format, int32_t layers, lmb_block_texture *texture)
{
    uint64_t random = 9 + (uint64_t)layers;
    const bool made = lmb_block_texture_create(format, 128, 64, layers, 3, texture) == LMB_OK;
    CHECK(made, "memory");
    for (size_t i = 0; made && i < texture->size; ++i) {
        texture->data[i] = (unsigned char)(256.0 * variate_next(&random));
    }
    for (size_t i = 0; made && i < texture->size / 16 && format == LMB_BLOCK_BC6H; ++i) {
        unsigned char *const first = &texture->data[16 * i];
        *first = (unsigned char)((*first & 0xE0) | (i % 32));
    }
    return made;
}

static void hexadecimal_write(FILE *page, const unsigned char *bytes, size_t size)
{
    fputs("data: '", page);
    for (size_t i = 0; i < size; ++i) {
        fprintf(page, "%02x", bytes[i]);
    }
    fputs("'", page);
}

static FILE *page_begin(const char *path)
{
    FILE *const page = fopen(path, "w");
    CHECK(page, "%s", path);
    if (page) {
        fputs("<!DOCTYPE html>\n<pre id=\"seen\"></pre>\n<script>\nconst textures = [\n", page);
    }
    return page;
}

static void page_end(FILE *page, bool three)
{
    fputs("];\n</script>\n<script src=\"" LMB_BROWSER_DIR "/textures.js\"></script>\n", page);
    if (three) {
        fputs("<script type=\"module\" src=\"" LMB_BROWSER_DIR "/three.js\"></script>\n", page);
    }
    fclose(page);
}

/* Blocks without a file. */
static void texture_write(FILE *page, const char *name, const lmb_block_texture *texture)
{
    fprintf(page, "{name: '%s', code: %u, width: %d, height: %d, layers: %d, levels: %d, channels: %d, starts: [", name,
            webgl_formats[texture->format], texture->width, texture->height, texture->layers, texture->levels,
            lmb_block_format_channels(texture->format));
    for (int32_t level = 0; level < texture->levels; ++level) {
        fprintf(page, "%zu, ", lmb_block_texture_level_start(texture, level));
    }
    fputs("], ", page);
    hexadecimal_write(page, texture->data, texture->size);
    fputs("},\n", page);
}

/* @return false where there is no browser, or it says that it cannot; `seen` is what the page shows, malloc'ed */
static bool page_run(const char *page, const char *shown, unsigned char **seen)
{
    static char printed[4096];
    char command[3072];
    size_t size = 0;
    lmb_error error = {""};
    *seen = NULL;
    if (LMB_CHROMIUM[0] == '\0') {
        test_skip("no Chromium (Debian: chromium)");
        return false;
    }
    snprintf(command, sizeof command,
             "timeout 300 '" LMB_CHROMIUM "' --headless --no-sandbox --disable-dev-shm-usage --use-gl=angle "
             "--use-angle=swiftshader --enable-unsafe-swiftshader --allow-file-access-from-files "
             "--user-data-dir='%s' --dump-dom 'file://%s' > '%s' 2> '%s.log'",
             OUT("profile"), page, shown, shown);
    const int status = run(printed, sizeof printed, command);
    CHECK(status == 0 && lmb_file_read(shown, seen, &size, &error) == LMB_OK, "%s: %d", command, status);
    if (*seen && strstr((const char *)*seen, "missing ")) {
        test_skip("this Chromium's WebGL samples no BC textures");
        free(*seen);
        *seen = NULL;
    }
    return *seen != NULL;
}

/* The texels of one line, in the order in which we decode. */
static void texels_compare(const char *bits, const lmb_block_texture *texture, const char *name)
{
    const int channels = lmb_block_format_channels(texture->format);
    const size_t texels = (size_t)texture->width * (size_t)texture->height;
    float *planes[3];
    for (int c = 0; c < 3; ++c) {
        planes[c] = calloc(texels, sizeof **planes);
    }
    for (int32_t i = 0; i < texture->levels * texture->layers && test_failures < 20; ++i) {
        const int32_t level = i / texture->layers, layer = i % texture->layers;
        const int32_t count =
            lmb_block_texture_side(texture->width, level) * lmb_block_texture_side(texture->height, level);
        lmb_block_texture_decode(texture, level, layer, planes);
        for (int32_t k = 0; k < count * channels && test_failures < 20; ++k, bits += 8) {
            char digits[9] = {0};
            strncpy(digits, bits, 8);
            CHECK(strlen(digits) == 8, "%s: level %d, layer %d ends at %d", name, level, layer, k);
            const uint32_t value = (uint32_t)strtoul(digits, NULL, 16);
            float got;
            memcpy(&got, &value, sizeof got);
            CHECK_NEAR(got, planes[k % channels][k / channels], tolerance[texture->format],
                       "%s: level %d, layer %d, texel %d, channel %d", name, level, layer, k / channels, k % channels);
        }
    }
    CHECK(test_failures > 0 || strspn(bits, "0123456789abcdef") == 0, "%s: more texels than it has", name);
    for (int c = 0; c < 3; ++c) {
        free(planes[c]);
    }
}

/* A line of sides and one of texels. */
static void lines_compare(const char *how, char *line, char **rest)
{
    char judge[32], name[128];
    int side[2], layers, levels, channels;
    if (sscanf(line, "%31s %127s %d %d %d %d %d", judge, name, &side[0], &side[1], &layers, &levels, &channels) != 7 ||
        strcmp(judge, how) != 0) {
        return;
    }
    const char *const bits = strtok_r(NULL, "\n", rest);
    for (int i = 0; bits && i < asked_count; ++i) {
        const lmb_block_texture *const texture = &asked[i].texture;
        if (strcmp(asked[i].name, name) != 0) {
            continue;
        }
        asked[i].seen = true;
        CHECK(side[0] == texture->width && side[1] == texture->height && layers == texture->layers &&
                  levels == texture->levels && channels == lmb_block_format_channels(texture->format),
              "%s: %s sees %d x %d, %d layers, %d levels, %d channels", name, how, side[0], side[1], layers, levels,
              channels);
        if (test_failures == 0) {
            texels_compare(bits, texture, name);
        }
    }
}

/* All that was asked is seen, as we decode it. */
static void seen_compare(const char *how, unsigned char *seen)
{
    char *rest = NULL;
    for (char *line = strtok_r((char *)seen, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        CHECK(strncmp(line, "failed ", 7) != 0, "%s", line);
        lines_compare(how, line, &rest);
    }
    for (int i = 0; i < asked_count; ++i) {
        CHECK(asked[i].seen, "%s: %s has not shown it", asked[i].name, how);
    }
}

static void webgl_decodes_any_bits_alike(void)
{
    unsigned char *seen = NULL;
    FILE *const page = page_begin(OUT("blocks.html"));
    for (int format = 0; page && format <= LMB_BLOCK_BC6H; ++format) {
        lmb_block_texture *const texture = ask(lmb_block_format_name((lmb_block_format)format));
        if (any_bits_make((lmb_block_format)format, 2, texture)) {
            texture_write(page, lmb_block_format_name((lmb_block_format)format), texture);
        }
    }
    if (page) {
        page_end(page, false);
        if (page_run(OUT("blocks.html"), OUT("blocks.txt"), &seen)) {
            seen_compare("blocks", seen);
        }
    }
    free(seen);
    asked_clear();
}

/* three.js' reader of DDS takes BC6H alone, and no layers. */
static bool three_reads(const lmb_block_texture *texture, lmb_block_container container)
{
    return container == LMB_BLOCK_KTX2 || (texture->format == LMB_BLOCK_BC6H && texture->layers == 1);
}

/* A file that is ours, and what we read of it. */
static void file_ask(FILE *page, const char *path, const char *name)
{
    lmb_error error = {""};
    lmb_block_texture texture;
    lmb_block_container container;
    unsigned char *bytes = NULL;
    size_t size = 0;
    if (lmb_block_texture_read(path, &texture, &container, &error) != LMB_OK ||
        lmb_file_read(path, &bytes, &size, &error) != LMB_OK) {
        CHECK(false, "%s", error.message);
        return;
    }
    if (three_reads(&texture, container)) {
        *ask(name) = texture;
        fprintf(page, "{name: '%s', ", name);
        hexadecimal_write(page, bytes, size);
        fputs("},\n", page);
    } else {
        lmb_block_texture_free(&texture);
    }
    free(bytes);
}

static void any_bits_files_ask(FILE *page)
{
    for (int i = 0; i < 2 * 2 * (LMB_BLOCK_BC6H + 1); ++i) {
        const lmb_block_container container = i % 2 ? LMB_BLOCK_DDS : LMB_BLOCK_KTX2;
        lmb_block_texture texture;
        lmb_error error = {""};
        char name[64], path[1024];
        if (!any_bits_make((lmb_block_format)(i / 4), 1 + i / 2 % 2, &texture)) {
            return;
        }
        snprintf(name, sizeof name, "%s_%d.%s", lmb_block_format_name(texture.format), texture.layers,
                 lmb_block_container_name(container));
        snprintf(path, sizeof path, "%s", OUT(""));
        snprintf(path + strlen(path), sizeof path - strlen(path), "%s", name);
        CHECK(lmb_block_texture_write(&texture, container, path, &error) == LMB_OK, "%s", error.message);
        lmb_block_texture_free(&texture);
        file_ask(page, path, name);
    }
}

/* What `lambent bake` writes of the Cornell box. */
static void lightmap_files_ask(FILE *page, const char *format, const char *folder)
{
    if (!CHECK_RUN(0, NULL,
                   "'%s' bake '%s' -o '%s' --lightmaps --no-probes --lightmap-format %s --padding 6 --quality draft "
                   "--texels-per-m 16 --quiet",
                   LMB_COMMAND, OUT("cornell.glb"), folder, format)) {
        return;
    }
    char path[2048];
    snprintf(path, sizeof path, "%s/lightmap", folder);
    DIR *const opened = opendir(path);
    CHECK(opened, "%s", path);
    for (const struct dirent *entry = opened ? readdir(opened) : NULL; entry; entry = readdir(opened)) {
        if (strstr(entry->d_name, ".ktx2") || strstr(entry->d_name, ".dds")) {
            snprintf(path, sizeof path, "%s/lightmap/%s", folder, entry->d_name);
            file_ask(page, path, entry->d_name);
        }
    }
    if (opened) {
        closedir(opened);
    }
}

static void three_reads_files_alike(void)
{
    lmb_error error = {""};
    unsigned char *seen = NULL;
    if (LMB_THREE_DIR[0] == '\0') {
        test_skip("no three.js (npm's package `three`; its folder is the CMake variable LMB_THREE_DIR)");
        return;
    }
    CHECK(lmb_level_cornell(OUT("cornell.glb"), &error) == LMB_OK, "%s", error.message);
    FILE *const page = page_begin(OUT("files.html"));
    if (!page) {
        return;
    }
    fputs("];\n</script>\n<script type=\"importmap\">{\"imports\": {\"three\": \"" LMB_THREE_DIR
          "/build/three.module.js\", \"three/addons/\": \"" LMB_THREE_DIR "/examples/jsm/\"}}</script>\n"
          "<script>\nconst files = [\n",
          page);
    any_bits_files_ask(page);
    lightmap_files_ask(page, "ktx2", OUT("ktx2"));
    lightmap_files_ask(page, "dds", OUT("dds"));
    page_end(page, true);
    if (page_run(OUT("files.html"), OUT("files.txt"), &seen)) {
        seen_compare("three.js", seen);
    }
    free(seen);
    asked_clear();
}

static const test_case cases[] = {
    {"webgl_decodes_any_bits_alike", webgl_decodes_any_bits_alike},
    {"three_reads_files_alike", three_reads_files_alike},
};

TEST_MAIN(cases)
