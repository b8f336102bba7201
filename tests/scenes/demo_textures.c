#include "demo_textures.h"

#include "level_builder_internal.h"

#include <math.h>
#include <stdlib.h>

enum { SIZE = 256, BRICK_HEIGHT = SIZE / 8, BRICK_WIDTH = SIZE / 4, MORTAR = 4, PLANK = SIZE / 4, HOLE = SIZE / 4 };

static uint32_t hash(uint32_t x, uint32_t y, uint32_t salt)
{
    uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ salt * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

/* In [0, 1). */
static float random_at(int x, int y, uint32_t salt)
{
    return (float)(hash((uint32_t)x, (uint32_t)y, salt) >> 8) * 0x1p-24f;
}

/* Smooth noise in [0, 1) with cells of cell_x by cell_y pixels, which divide SIZE. */
static float noise(int x, int y, int cell_x, int cell_y, uint32_t salt)
{
    const int x0 = x / cell_x;
    const int y0 = y / cell_y;
    const int x1 = (x0 + 1) % (SIZE / cell_x);
    const int y1 = (y0 + 1) % (SIZE / cell_y);
    const float u = (float)(x % cell_x) / (float)cell_x;
    const float v = (float)(y % cell_y) / (float)cell_y;
    const float s = u * u * (3 - 2 * u);
    const float t = v * v * (3 - 2 * v);
    const float top = random_at(x0, y0, salt) * (1 - s) + random_at(x1, y0, salt) * s;
    const float bottom = random_at(x0, y1, salt) * (1 - s) + random_at(x1, y1, salt) * s;
    return top * (1 - t) + bottom * t;
}

static void set_pixel(uint8_t *rgba, float red, float green, float blue)
{
    const float channels[3] = {red, green, blue};
    for (int c = 0; c < 3; ++c) {
        const float clamped = channels[c] < 0 ? 0 : channels[c] > 1 ? 1 : channels[c];
        rgba[c] = (uint8_t)(clamped * 255 + 0.5f);
    }
    rgba[3] = 255;
}

static void plaster(int x, int y, uint8_t *rgba)
{
    const float shade = 0.9f + 0.05f * noise(x, y, 32, 32, 1) + 0.05f * noise(x, y, 4, 4, 2);
    set_pixel(rgba, shade, shade, shade * 0.98f);
}

static void tiles(int x, int y, uint8_t *rgba)
{
    const int tile = SIZE / 2;
    const bool joint = x % tile < 2 || y % tile < 2;
    const bool dark = (x / tile + y / tile) % 2 == 1;
    const float shade = (joint ? 0.45f : dark ? 0.4f : 0.85f) + 0.06f * (noise(x, y, 16, 16, 3) - 0.5f);
    set_pixel(rgba, shade, shade * 0.98f, shade * 0.93f);
}

static void wood(int x, int y, uint8_t *rgba)
{
    const int plank = y / PLANK;
    const bool joint = y % PLANK < 2;
    const float tone = 0.85f + 0.15f * random_at(plank, 0, 4);
    const float grain = 0.85f + 0.3f * noise((x + 37 * plank) % SIZE, y, 64, 4, 5) * noise(x, y, 128, 2, 6);
    const float shade = (joint ? 0.5f : 1) * tone * grain;
    set_pixel(rgba, 0.72f * shade, 0.53f * shade, 0.36f * shade);
}

/* Every other course is shifted by half a brick. */
static int brick_shifted(int x, int y)
{
    const int course = y / BRICK_HEIGHT;
    return (x + course % 2 * BRICK_WIDTH / 2) % SIZE;
}

/* Height of the wall in pixels: mortar at 0, bricks with rounded rims. */
static float brick_height(int x, int y)
{
    const int wrapped_x = (x + SIZE) % SIZE;
    const int wrapped_y = (y + SIZE) % SIZE;
    const int across = brick_shifted(wrapped_x, wrapped_y) % BRICK_WIDTH;
    const int up = wrapped_y % BRICK_HEIGHT;
    const int side = across < BRICK_WIDTH - 1 - across ? across : BRICK_WIDTH - 1 - across;
    const int end = up < BRICK_HEIGHT - 1 - up ? up : BRICK_HEIGHT - 1 - up;
    const int rim = (side < end ? side : end) - MORTAR / 2;
    const float raised = rim < 0 ? 0 : rim > 4 ? 4 : (float)rim;
    return 0.8f * raised + (rim < 0 ? 0.8f : 1.6f) * noise(wrapped_x, wrapped_y, 4, 4, 7);
}

static void brick(int x, int y, uint8_t *rgba)
{
    const int across = brick_shifted(x, y);
    const bool mortar = brick_height(x, y) < 0.8f;
    const float tone = 0.85f + 0.3f * random_at(across / BRICK_WIDTH, y / BRICK_HEIGHT, 8);
    const float shade = tone * (0.9f + 0.2f * noise(x, y, 8, 8, 9));
    if (mortar) {
        set_pixel(rgba, 0.75f, 0.73f, 0.7f);
    } else {
        set_pixel(rgba, 0.68f * shade, 0.46f * shade, 0.36f * shade);
    }
}

static void brick_normal(int x, int y, uint8_t *rgba)
{
    const float right = (brick_height(x + 1, y) - brick_height(x - 1, y)) / 2;
    const float down = (brick_height(x, y + 1) - brick_height(x, y - 1)) / 2;
    const float length = sqrtf(right * right + down * down + 1);
    /* Green points up the picture, rows run down. */
    set_pixel(rgba, 0.5f - 0.5f * right / length, 0.5f + 0.5f * down / length, 0.5f + 0.5f / length);
}

static void lattice(int x, int y, uint8_t *rgba)
{
    const int bar = HOLE / 8;
    const int across = x % HOLE;
    const int up = y % HOLE;
    set_pixel(rgba, 0.9f, 0.88f, 0.82f);
    rgba[3] = across < bar || across >= HOLE - bar || up < bar || up >= HOLE - bar ? 255 : 0;
}

int lmb_demo_texture_add(lmb_level_builder *builder, lmb_demo_texture texture)
{
    static const struct {
        const char *name;
        void (*pixel)(int x, int y, uint8_t *rgba);
    } kinds[] = {
        [LMB_DEMO_PLASTER] = {"plaster", plaster},
        [LMB_DEMO_TILES] = {"tiles", tiles},
        [LMB_DEMO_WOOD] = {"wood", wood},
        [LMB_DEMO_BRICK] = {"brick", brick},
        [LMB_DEMO_BRICK_NORMAL] = {"brick normal", brick_normal},
        [LMB_DEMO_LATTICE] = {"lattice", lattice},
    };
    if (!builder) {
        return LMB_LEVEL_NONE;
    }
    uint8_t *rgba = malloc((size_t)SIZE * SIZE * 4);
    if (!rgba) {
        builder->failed = true;
        return LMB_LEVEL_NONE;
    }
    for (int y = 0; y < SIZE; ++y) {
        for (int x = 0; x < SIZE; ++x) {
            kinds[texture].pixel(x, y, &rgba[4 * (y * SIZE + x)]);
        }
    }
    const int image = lmb_level_builder_add_image(builder, kinds[texture].name, SIZE, SIZE, rgba);
    free(rgba);
    return image;
}
