/* Self-shadowed bump maps: height maps whose open sky is known, seams, and the command. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <unistd.h>

#include <stb_image.h>
#include <stb_image_write.h>

#include <lambent/file.h>
#include <lambent/image.h>
#include <lambent/ssbump.h>

#include "command_fixture.h"
#include "variates.h"

#define OUT(name) LMB_TEST_OUTPUT_DIR "/ssbump_" name
#define PI 3.14159265358979323846

static lmb_height_map map_make(int32_t width, int32_t height)
{
    lmb_height_map map = {width, height, calloc((size_t)width * (size_t)height, sizeof(float))};
    CHECK(map.value, "memory");
    return map;
}

static uint8_t *bump_of(const lmb_height_map *map, float scale, bool wrap, int threads)
{
    uint8_t *rgb = malloc(3 * (size_t)map->width * (size_t)map->height);
    const lmb_ssbump_settings settings = {.scale_texels = scale, .wrap = wrap};
    lmb_pool *pool = NULL;
    CHECK(rgb && lmb_pool_create(threads, &pool) == LMB_OK &&
              lmb_ssbump_make(map, &settings, pool, NULL, rgb) == LMB_OK,
          "made");
    lmb_pool_destroy(pool);
    return rgb;
}

/* The tangent of the elevation that is hidden towards (x, y), x to the right and y up. */
typedef double (*horizon_function)(double x, double y, double parameter);

/* Weights where the normal is (-slope_x, 0, 1) and the horizon is known, by a sum over all directions above the plane.
 */
static void expect(horizon_function horizon, double parameter, double slope_x, double weight[3])
{
    enum { HEIGHTS = 500, TURNS = 1440 };
    double normal_sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double azimuth = 2.0 * PI * i / 3.0, flat = sqrt(2.0 / 3.0), up = sqrt(1.0 / 3.0);
        double all = 0.0, open = 0.0;
        for (int a = 0; a < HEIGHTS; ++a) {
            const double z = (a + 0.5) / HEIGHTS, r = sqrt(1.0 - z * z);
            for (int b = 0; b < TURNS; ++b) {
                const double turn = 2.0 * PI * (b + 0.5) / TURNS;
                const double cosine = flat * r * cos(turn - azimuth) + up * z;
                if (cosine >= 0.5) {
                    all += cosine;
                    open += z / r > horizon(cos(turn), sin(turn), parameter) ? cosine : 0.0;
                }
            }
        }
        const double facing = fmax(-slope_x * flat * cos(azimuth) + up, 0.0);
        weight[i] = facing * facing * open / all;
        normal_sum += facing * facing;
    }
    for (int i = 0; i < 3; ++i) {
        weight[i] /= normal_sum;
    }
}

static void check_texel(const uint8_t *rgb, const lmb_height_map *map, int32_t x, int32_t y, const double weight[3],
                        double tolerance)
{
    for (int i = 0; i < 3; ++i) {
        CHECK_NEAR(rgb[3 * (x + map->width * y) + i], 255.0 * weight[i], tolerance, "texel %d, %d, slope %d", (int)x,
                   (int)y, i + 1);
    }
}

static double nothing(double x, double y, double unused)
{
    (void)x;
    (void)y;
    (void)unused;
    return 0.0;
}

/* Whatever the level and the scale, a third each. */
static void flat(void)
{
    for (int level = 0; level < 3; ++level) {
        lmb_height_map map = map_make(17, 9);
        for (int i = 0; i < 17 * 9; ++i) {
            map.value[i] = 0.5f * (float)level;
        }
        uint8_t *rgb = bump_of(&map, 16.0f, level == 1, 2);
        int wrong = 0;
        for (int i = 0; i < 3 * 17 * 9; ++i) {
            wrong += rgb[i] != 85;
        }
        CHECK(wrong == 0, "%d of level %d", wrong, level);
        free(rgb);
        lmb_height_map_free(&map);
    }
    double weight[3];
    expect(nothing, 0.0, 0.0, weight);
    CHECK_NEAR(weight[0] + weight[1] + weight[2], 1.0, 1e-9, "the oracle's own");
}

enum { DEPTH = 16 };

/* A groove along y whose walls are `right` and as many texels to the left less 4. */
static double groove_horizon(double x, double y, double right)
{
    (void)y;
    return x > 0.0 ? DEPTH * x / right : DEPTH * -x / (right - 4.0);
}

static void groove(void)
{
    enum { WIDTH = 64, HEIGHT = 8, LEFT = 20, RIGHT = 40 };
    lmb_height_map map = map_make(WIDTH, HEIGHT);
    for (int y = 0; y < HEIGHT; ++y) {
        for (int x = 0; x < WIDTH; ++x) {
            map.value[x + WIDTH * y] = x > LEFT && x < RIGHT ? 0.0f : 1.0f;
        }
    }
    uint8_t *rgb = bump_of(&map, DEPTH, true, 2);
    double weight[3];
    for (int y = 0; y < HEIGHT; ++y) {
        expect(groove_horizon, 12.0, 0.0, weight);
        check_texel(rgb, &map, RIGHT - 12, y, weight, 1.0);
    }
    CHECK(weight[0] < 0.2 && weight[1] < weight[0] + 0.1 && weight[1] > weight[0], "a groove is dark: %g %g", weight[0],
          weight[1]);
    expect(nothing, 0.0, 0.0, weight);
    check_texel(rgb, &map, 5, 3, weight, 0.5);
    check_texel(rgb, &map, 50, 3, weight, 0.5);
    free(rgb);
    lmb_height_map_free(&map);
}

static double step_horizon(double x, double y, double distance)
{
    (void)y;
    return x > 0.0 ? DEPTH * x / distance : 0.0;
}

/* At its foot a step hides what it does; what is on top sees all. Not wrapped: the foot of the map's other side does
 * not. */
static void step(void)
{
    enum { WIDTH = 96, HEIGHT = 600, EDGE = 60, ROW = HEIGHT / 2 };
    lmb_height_map map = map_make(WIDTH, HEIGHT);
    for (int y = 0; y < HEIGHT; ++y) {
        for (int x = EDGE; x < WIDTH; ++x) {
            map.value[x + WIDTH * y] = 1.0f;
        }
    }
    uint8_t *rgb = bump_of(&map, DEPTH, false, 2);
    static const int distances[] = {2, 3, 8, 20, 50};
    double last = 0.0, weight[3];
    for (size_t i = 0; i < sizeof distances / sizeof distances[0]; ++i) {
        expect(step_horizon, distances[i], 0.0, weight);
        check_texel(rgb, &map, EDGE - distances[i], ROW, weight, 1.0);
        CHECK(weight[0] > last, "less is hidden farther away");
        last = weight[0];
        CHECK(weight[1] > weight[0], "B2 looks away from the step");
    }
    expect(nothing, 0.0, 0.0, weight);
    check_texel(rgb, &map, EDGE + 5, ROW, weight, 0.0);
    free(rgb);
    lmb_height_map_free(&map);
}

static double roof_horizon(double x, double y, double slope)
{
    (void)y;
    return fmax(slope * x, 0.0);
}

/* A bump that is a long roof, slope 1/2: on its flanks the normal and the horizon are known. */
static void roof(void)
{
    enum { WIDTH = 81, HEIGHT = 9, MIDDLE = 40 };
    lmb_height_map map = map_make(WIDTH, HEIGHT);
    for (int y = 0; y < HEIGHT; ++y) {
        for (int x = 0; x < WIDTH; ++x) {
            map.value[x + WIDTH * y] = fmaxf(1.0f - (float)abs(x - MIDDLE) / 32.0f, 0.0f);
        }
    }
    uint8_t *rgb = bump_of(&map, DEPTH, false, 2);
    double weight[3];
    for (int i = 0; i < 3; ++i) {
        const int off[3] = {30, 16, 4};
        expect(roof_horizon, 0.5, 0.5, weight); /* rises towards the right */
        check_texel(rgb, &map, MIDDLE - off[i], 4, weight, 1.0);
        double mirrored[3];
        expect(roof_horizon, -0.5, -0.5, mirrored);
        check_texel(rgb, &map, MIDDLE + off[i], 4, mirrored, 1.0);
        CHECK(mirrored[0] > 0.6 && weight[0] < 0.05, "it faces its own side: %g, %g", mirrored[0], weight[0]);
    }
    free(rgb);
    lmb_height_map_free(&map);
}

/* Bumps all over, for what must hold of any map. */
static lmb_height_map bumps_make(int32_t width, int32_t height)
{
    lmb_height_map map = map_make(width, height);
    uint64_t random = 7;
    for (int32_t i = 0; i < width * height; ++i) {
        map.value[i] = 0.3f * (float)variate_next(&random);
    }
    for (int32_t k = 0; k < 12; ++k) {
        const int32_t x = (int32_t)(variate_next(&random) * width), y = (int32_t)(variate_next(&random) * height);
        map.value[x + width * y] = 1.0f;
    }
    return map;
}

/* With wrap a map that is moved gives the bump map moved, to the byte: it has no seams. */
static void wraps_without_seams(void)
{
    enum { WIDTH = 40, HEIGHT = 23, X = 17, Y = 9 };
    lmb_height_map map = bumps_make(WIDTH, HEIGHT), moved = map_make(WIDTH, HEIGHT);
    for (int y = 0; y < HEIGHT; ++y) {
        for (int x = 0; x < WIDTH; ++x) {
            moved.value[(x + X) % WIDTH + WIDTH * ((y + Y) % HEIGHT)] = map.value[x + WIDTH * y];
        }
    }
    uint8_t *one = bump_of(&map, 12.0f, true, 1), *two = bump_of(&moved, 12.0f, true, 1);
    uint8_t *open = bump_of(&map, 12.0f, false, 1);
    int wrong = 0, differ = 0;
    for (int y = 0; y < HEIGHT; ++y) {
        for (int x = 0; x < WIDTH; ++x) {
            const int at = 3 * ((x + X) % WIDTH + WIDTH * ((y + Y) % HEIGHT)), from = 3 * (x + WIDTH * y);
            wrong += memcmp(&two[at], &one[from], 3) != 0;
            differ += memcmp(&open[from], &one[from], 3) != 0;
        }
    }
    CHECK(wrong == 0, "%d texels", wrong);
    CHECK(differ > WIDTH, "only %d texels see over the border", differ);
    free(one);
    free(two);
    free(open);
    lmb_height_map_free(&moved);
    lmb_height_map_free(&map);
}

/* Upside down, B2 and B3 change places. */
static void mirrored_maps(void)
{
    enum { SIDE = 32 };
    lmb_height_map map = bumps_make(SIDE, SIDE), mirror = map_make(SIDE, SIDE);
    for (int i = 0; i < SIDE * SIDE; ++i) {
        mirror.value[i] = map.value[i % SIDE + SIDE * (SIDE - 1 - i / SIDE)];
    }
    uint8_t *one = bump_of(&map, 12.0f, true, 1), *two = bump_of(&mirror, 12.0f, true, 1);
    for (int i = 0; i < SIDE * SIDE; ++i) {
        const uint8_t *a = &one[3 * i], *b = &two[3 * (i % SIDE + SIDE * (SIDE - 1 - i / SIDE))];
        CHECK(abs(a[0] - b[0]) <= 1 && abs(a[1] - b[2]) <= 1 && abs(a[2] - b[1]) <= 1, "texel %d", i);
    }
    /* A wall above hides B2's side, up to the left, and none of B3's. */
    lmb_height_map wall = map_make(9, 9);
    for (int x = 0; x < 9; ++x) {
        wall.value[x] = 1.0f;
    }
    uint8_t *below = bump_of(&wall, 16.0f, false, 1);
    CHECK(below[3 * (4 + 9 * 3) + 1] < 60 && below[3 * (4 + 9 * 3) + 2] >= 84, "%d %d", below[3 * (4 + 9 * 3) + 1],
          below[3 * (4 + 9 * 3) + 2]);
    free(below);
    free(one);
    free(two);
    lmb_height_map_free(&wall);
    lmb_height_map_free(&mirror);
    lmb_height_map_free(&map);
}

static void threads_make_no_difference(void)
{
    lmb_height_map map = bumps_make(50, 33);
    uint8_t *one = bump_of(&map, 20.0f, true, 1), *five = bump_of(&map, 20.0f, true, 5);
    CHECK(memcmp(one, five, 3 * 50 * 33) == 0, "five threads differ");
    free(one);
    free(five);
    lmb_height_map_free(&map);
}

static void put_chunk(unsigned char *file, size_t *size, const char *type, const unsigned char *data, size_t count)
{
    for (int i = 0; i < 4; ++i) {
        file[(*size)++] = (unsigned char)(count >> (24 - 8 * i));
    }
    memcpy(file + *size, type, 4);
    if (count > 0) {
        memcpy(file + *size + 4, data, count);
    }
    *size += 4 + count;
    memset(file + *size, 0, 4); /* stb_image reads no CRC */
    *size += 4;
}

/* A grey PNG of 16 bits, in one stored block. */
static bool png16_write(const char *path, int width, int height, const uint16_t *grey)
{
    static unsigned char file[65536], data[32768];
    const size_t row = 1 + 2 * (size_t)width, raw = row * (size_t)height;
    const unsigned char head[13] = {0, 0, 0, (unsigned char)width, 0, 0, 0, (unsigned char)height, 16, 0, 0, 0, 0};
    const unsigned char block[7] = {
        0x78, 1, 1, (unsigned char)raw, (unsigned char)(raw >> 8), (unsigned char)~raw, (unsigned char)(~raw >> 8)};
    size_t size = 0;
    static const unsigned char signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    memcpy(file, signature, sizeof signature);
    size = sizeof signature;
    put_chunk(file, &size, "IHDR", head, sizeof head);
    memcpy(data, block, sizeof block);
    for (int y = 0; y < height; ++y) {
        unsigned char *at = data + sizeof block + row * (size_t)y;
        *at++ = 0;
        for (int x = 0; x < width; ++x) {
            *at++ = (unsigned char)(grey[x + width * y] >> 8);
            *at++ = (unsigned char)grey[x + width * y];
        }
    }
    memset(data + sizeof block + raw, 0, 4);
    put_chunk(file, &size, "IDAT", data, sizeof block + raw + 4);
    put_chunk(file, &size, "IEND", NULL, 0);
    lmb_error error;
    return lmb_file_write(path, file, size, &error) == LMB_OK;
}

/* 8 bits and 16, grey and in colours. */
static void heights_are_read(void)
{
    lmb_error error = {""};
    lmb_height_map map = {0, 0, NULL};
    const uint8_t grey[6] = {0, 1, 127, 128, 254, 255};
    const uint8_t rgb[18] = {0, 0, 0, 1, 1, 1, 127, 127, 127, 128, 128, 128, 254, 254, 254, 255, 255, 255};
    const uint16_t deep[6] = {0, 1, 300, 32768, 65534, 65535};
    CHECK(stbi_write_png(OUT("grey.png"), 3, 2, 1, grey, 3) && stbi_write_png(OUT("rgb.png"), 3, 2, 3, rgb, 9) &&
              png16_write(OUT("deep.png"), 3, 2, deep),
          "written");
    for (int k = 0; k < 3; ++k) {
        const char *const path = k == 0 ? OUT("grey.png") : k == 1 ? OUT("rgb.png") : OUT("deep.png");
        CHECK(lmb_height_map_read(path, &map, &error) == LMB_OK && map.width == 3 && map.height == 2, "%s",
              error.message);
        for (int i = 0; i < 6 && map.value; ++i) {
            CHECK_NEAR(map.value[i], k == 2 ? deep[i] / 65535.0 : grey[i] / 255.0, 1e-7, "%s, %d", path, i);
        }
        lmb_height_map_free(&map);
    }
}

static void command(void)
{
    int width, height, channels;
    const uint8_t grey[16] = {0};
    CHECK(stbi_write_png(OUT("flat.png"), 4, 4, 1, grey, 4), "written");
    CHECK_RUN(0, "usage: lambent ssbump", "'%s' ssbump --help", LMB_COMMAND);
    CHECK_RUN(0, NULL, "'%s' ssbump '%s' -o '%s' --wrap --scale 4 --quiet", LMB_COMMAND, OUT("flat.png"),
              OUT("out.png"));
    uint8_t *read = stbi_load(OUT("out.png"), &width, &height, &channels, 0);
    CHECK(read && width == 4 && height == 4 && channels == 3 && read[0] == 85 && read[47] == 85, "the picture");
    stbi_image_free(read);
    CHECK_RUN(2, "HEIGHT.png", "'%s' ssbump", LMB_COMMAND);
    CHECK_RUN(2, "-o OUT.png", "'%s' ssbump a.png", LMB_COMMAND);
    CHECK_RUN(2, "-o takes a .png", "'%s' ssbump a.png -o b.jpg", LMB_COMMAND);
    CHECK_RUN(2, "--scale takes", "'%s' ssbump a.png -o b.png --scale -1", LMB_COMMAND);
    CHECK_RUN(1, "/dev/null/x.png", "'%s' ssbump '%s' -o /dev/null/x.png", LMB_COMMAND, OUT("flat.png"));
}

/* Bad input: one line, status 3, and the output stays what it was. */
static void bad_input(void)
{
    lmb_error error = {""};
    unsigned char *good = NULL;
    size_t size = 0;
    const uint16_t deep[64] = {1, 2, 3};
    CHECK(png16_write(OUT("whole.png"), 8, 8, deep) && lmb_file_read(OUT("whole.png"), &good, &size, &error) == LMB_OK,
          "%s", error.message);
    CHECK(lmb_file_write(OUT("kept.png"), "kept", 4, &error) == LMB_OK, "%s", error.message);
    lmb_height_map map = {0, 0, NULL};
    for (size_t cut = 0; cut < size; ++cut) { /* every truncation ends in an error, but for the CRCs at the end */
        CHECK(lmb_file_write(OUT("cut.png"), good, cut, &error) == LMB_OK, "%s", error.message);
        const lmb_result result = lmb_height_map_read(OUT("cut.png"), &map, &error);
        CHECK(result == LMB_ERROR_FORMAT || cut + 24 > size, "%zu of %zu bytes: %s", cut, size,
              lmb_result_text(result));
        lmb_height_map_free(&map);
    }
    CHECK(lmb_file_write(OUT("cut.png"), good, size / 2, &error) == LMB_OK, "%s", error.message);
    CHECK(lmb_file_write(OUT("text.png"), "height", 6, &error) == LMB_OK, "%s", error.message);
    CHECK_RUN(3, "text.png: not a PNG", "'%s' ssbump '%s' -o '%s'", LMB_COMMAND, OUT("text.png"), OUT("kept.png"));
    CHECK_RUN(3, "cut.png: a broken PNG", "'%s' ssbump '%s' -o '%s'", LMB_COMMAND, OUT("cut.png"), OUT("kept.png"));
    CHECK_RUN(3, "nowhere.png", "'%s' ssbump '%s' -o '%s'", LMB_COMMAND, OUT("nowhere.png"), OUT("kept.png"));
    CHECK_RUN(0, "1", "'%s' ssbump '%s' -o '%s' 2>&1 | wc -l", LMB_COMMAND, OUT("cut.png"), OUT("kept.png"));
    free(good);
    CHECK(lmb_file_read(OUT("kept.png"), &good, &size, &error) == LMB_OK && size == 4, "%s", error.message);
    free(good);
}

static const test_case cases[] = {
    {"flat", flat},
    {"groove", groove},
    {"step", step},
    {"roof", roof},
    {"wraps_without_seams", wraps_without_seams},
    {"mirrored_maps", mirrored_maps},
    {"threads_make_no_difference", threads_make_no_difference},
    {"heights_are_read", heights_are_read},
    {"command", command},
    {"bad_input", bad_input},
};

TEST_MAIN(cases)
