/* A small bake gives the bytes that tests/golden/bake.txt names, for any number of threads: by every compiler, at every
 * level of optimisation, with and without sanitizers. Embree's instruction set is pinned, as its last bits differ.
 *
 *     test_golden_bake --write     renews the file, where other bytes are meant */
#define _POSIX_C_SOURCE 200809L
#include <inttypes.h>
#include <stdint.h>

#include <lambent/file.h>

#include "command_fixture.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/golden_bake"
#define LEVEL OUTPUT "/room.glb"
#define BAKED OUTPUT "/baked"
#define GOLDEN LMB_GOLDEN_DIR "/bake.txt"

static const char *const files[] = {"probes.lmb",
                                    "probes.vdb",
                                    "lightmap/lightmap_0.exr",
                                    "lightmap/lightmap_0_hhd.exr",
                                    "lightmap/lightmap_0_keys.exr",
                                    "lightmap/lightmap.json"};
enum { FILE_COUNT = sizeof files / sizeof files[0] };

/* A sky of some colours above grey ground, and a sun of one pixel in it. */
static bool sky_make(void)
{
    enum { WIDTH = 256, HEIGHT = 128 };
    static unsigned char rgbe[HEIGHT][WIDTH][4];
    for (int y = 0; y < HEIGHT; ++y) {
        for (int x = 0; x < WIDTH; ++x) {
            const unsigned char sky[4] = {(unsigned char)(90 + y), 120, (unsigned char)(250 - x / 2), 128};
            const unsigned char ground[4] = {60, 55, 50, 127}, sun[4] = {200, 190, 160, 152};
            memcpy(rgbe[y][x], y == 30 && x == 70 ? sun : y < HEIGHT / 2 ? sky : ground, 4);
        }
    }
    FILE *const file = fopen(OUTPUT "/sky.hdr", "wb");
    const bool good = file && fputs("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 128 +X 256\n", file) >= 0 &&
                      fwrite(rgbe, sizeof rgbe, 1, file) == 1;
    const bool closed = file && fclose(file) == 0;
    CHECK(good && closed, "no sky");
    return good && closed;
}

static bool hashes_make(int threads, uint64_t hash[FILE_COUNT])
{
    if (!cornell_make(OUTPUT, LEVEL) || !sky_make() ||
        !CHECK_RUN(0, NULL,
                   "cd " OUTPUT " && rm -rf baked && " LMB_COMMAND
                   " bake room.glb -o baked --quiet --env sky.hdr --spacing 0.5 --samples 16 --lightmaps "
                   "--texels-per-m 6 --isa sse4.2 --threads %d",
                   threads)) {
        return false;
    }
    for (int i = 0; i < FILE_COUNT; ++i) {
        char path[1024];
        unsigned char *data = NULL;
        size_t size = 0;
        lmb_error error = {{0}};
        snprintf(path, sizeof path, BAKED "/%s", files[i]);
        if (lmb_file_read(path, &data, &size, &error) != LMB_OK) {
            CHECK(false, "%s", error.message);
            return false;
        }
        hash[i] = lmb_hash(LMB_HASH_SEED, data, size);
        free(data);
    }
    return true;
}

static bool golden_read(uint64_t golden[FILE_COUNT])
{
    FILE *const file = fopen(GOLDEN, "r");
    int read = 0;
    char name[64];
    while (file && read < FILE_COUNT && fscanf(file, "%63s %" SCNx64, name, &golden[read]) == 2 &&
           strcmp(name, files[read]) == 0) {
        ++read;
    }
    if (file) {
        fclose(file);
    }
    CHECK(read == FILE_COUNT, "%s: line %d", GOLDEN, read + 1);
    return read == FILE_COUNT;
}

static void bytes_are_golden(void)
{
    static const int threads[] = {1, 2, 7};
    uint64_t golden[FILE_COUNT], hash[FILE_COUNT];
    if (!golden_read(golden)) {
        return;
    }
    for (size_t t = 0; t < sizeof threads / sizeof threads[0]; ++t) {
        if (hashes_make(threads[t], hash)) {
            for (int i = 0; i < FILE_COUNT; ++i) {
                CHECK(hash[i] == golden[i], "%s by %d threads: %016" PRIx64 ", not %016" PRIx64, files[i], threads[t],
                      hash[i], golden[i]);
            }
        }
    }
}

static int golden_write(void)
{
    uint64_t hash[FILE_COUNT];
    FILE *const file = hashes_make(1, hash) ? fopen(GOLDEN, "w") : NULL;
    for (int i = 0; i < FILE_COUNT && file; ++i) {
        fprintf(file, "%s %016" PRIx64 "\n", files[i], hash[i]);
    }
    return file && fclose(file) == 0 ? 0 : 1;
}

static const test_case cases[] = {{"bytes_are_golden", bytes_are_golden}};

int main(int count, char **values)
{
    return count == 2 && strcmp(values[1], "--write") == 0 ? golden_write()
                                                           : test_main(cases, sizeof cases / sizeof cases[0]);
}
