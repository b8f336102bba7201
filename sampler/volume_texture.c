/* A volume as 3D textures: how large they are, and what is in them. */
#include <lambent/volume_texture.h>

#include "volume_cut_cell.h"
#include "volume_probe_internal.h"

#include <assert.h>

enum {
    NUMBERS = 4 * LMB_VOLUME_TEXTURE_PARTS_MOST, /* of a probe */
    REGION_POINTS = 2,                           /* texels of a region along each axis */
    BRICK_CELL_COUNT = 64,
    SIDE_STEP = 10 /* that bricks and regions both divide */
};

/* A word of the directory: tiles in bits 0 to 26, the level in 27 to 30, and whether some cell of the brick is cut or
 * not there. */
enum { TILE_BITS = 9, LEVEL_SHIFT = 27 };
#define NO_BRICK UINT32_C(0xffffffff)
#define HAS_CELLS UINT32_C(0x80000000)

/* A word of a cell: it is not there, it is the brick's texels, or else where its record is. */
enum { CELL_NONE, CELL_OWN };

/* Of a region: a block of its own, counted in blocks in bits 0 to 29, or the brick's texels. */
enum { REGION_BITS = 10 };
#define REGION_OWN UINT32_C(0xffffffff)

_Static_assert(LMB_VOLUME_TEXTURE_SIDE_MOST / LMB_BRICK_POINTS < 1 << TILE_BITS, "tiles have room in a word");
_Static_assert(LMB_VOLUME_TEXTURE_SIDE_MOST / REGION_POINTS <= 1 << REGION_BITS, "regions have room in a word");
_Static_assert(sizeof(lmb_volume_texture_constants) == 112, "the shader's struct has no gaps");

lmb_volume_texture_def lmb_volume_texture_default(void)
{
    return (lmb_volume_texture_def){.bands = 3, .side_most = LMB_VOLUME_TEXTURE_SIDE_MOST};
}

/* Words of a cut cell's record: the count of planes, three for each, one for each region. */
static uint32_t record_words(const lmb_volume_cut_cell *cut)
{
    return 1 + 3 * cut->plane_count + cut->region_count;
}

/* What is counted in a volume. */
typedef struct contents {
    uint64_t bricks, regions, record_words;
} contents;

static contents contents_count(const lmb_volume *volume)
{
    contents count = {.bricks = volume->header->brick_count - 1};
    for (uint32_t i = 1; i < volume->header->brick_count; ++i) {
        const lmb_volume_brick *const brick = &volume->bricks[i];
        for (uint32_t cell = 0; brick->cut != 0 && cell < BRICK_CELL_COUNT; ++cell) {
            if (!(brick->cut >> cell & 1u)) {
                continue;
            }
            const lmb_volume_cut_cell cut = lmb_volume_cut_cell_of(volume, brick, cell);
            count.record_words += record_words(&cut);
            for (uint32_t region = 0; region < cut.region_count; ++region) {
                uint32_t place[8];
                count.regions += lmb_volume_cut_cell_places(volume, &cut, region, place) != 0;
            }
        }
    }
    return count;
}

static uint64_t divided_up(uint64_t a, uint64_t b)
{
    return (a + b - 1) / b;
}

/* Bricks lie in layers of 5 texels, regions in layers of 2 above them; width and height are one multiple of SIDE_STEP.
 * The shape of fewest texels among those whose parts fit above each other in one texture, or else among all.
 * @return false: none is small enough */
static bool shape_find(const contents *count, uint32_t side_most, lmb_volume_texture_layout *layout)
{
    uint64_t fewest = UINT64_MAX;
    bool is_one = false;
    for (uint32_t side = SIDE_STEP; side <= side_most; side += SIDE_STEP) {
        const uint64_t tiles = side / LMB_BRICK_POINTS, blocks = side / REGION_POINTS;
        const uint64_t layers = divided_up(count->bricks, tiles * tiles);
        const uint64_t depth = LMB_BRICK_POINTS * layers + REGION_POINTS * divided_up(count->regions, blocks * blocks);
        const uint64_t texels = (uint64_t)side * side * depth;
        const bool fits_one = layout->parts * depth <= side_most;
        if (depth <= side_most && (fits_one > is_one || (fits_one == is_one && texels < fewest))) {
            fewest = texels;
            is_one = fits_one;
            layout->width = layout->height = side;
            layout->depth = (uint32_t)depth;
            layout->tiles[0] = layout->tiles[1] = (uint32_t)tiles;
            layout->tiles[2] = (uint32_t)layers;
        }
    }
    return fewest < UINT64_MAX;
}

lmb_result lmb_volume_texture_size(const lmb_volume *volume, const lmb_volume_texture_def *def,
                                   lmb_volume_texture_layout *layout)
{
    const bool arguments_are_valid = volume && def && layout && (def->bands == 2 || def->bands == 3) &&
                                     def->side_most >= LMB_VOLUME_TEXTURE_SIDE_LEAST &&
                                     def->side_most <= LMB_VOLUME_TEXTURE_SIDE_MOST;
    assert(arguments_are_valid);
    if (!arguments_are_valid) {
        return LMB_ERROR_ARGUMENT;
    }
    lmb_volume_layout file;
    lmb_volume_layout_find(volume->header, &file);
    const contents count = contents_count(volume);
    const uint64_t records = file.entries + BRICK_CELL_COUNT * count.bricks, words = records + count.record_words;
    lmb_volume_texture_layout found = {.bands = def->bands,
                                       .parts = (3 * def->bands * def->bands + volume->key_count + 3) / 4};
    if (words > UINT32_MAX || !shape_find(&count, def->side_most, &found)) {
        return LMB_ERROR_UNSUPPORTED;
    }
    found.part_bytes = UINT64_C(8) * found.width * found.height * found.depth;
    found.texture_bytes = found.parts * found.part_bytes;
    found.word_count = (uint32_t)words;
    found.cells = (uint32_t)file.entries;
    found.records = (uint32_t)records;
    found.regions = (uint32_t)count.regions;
    *layout = found;
    return LMB_OK;
}

/* A texture that is being filled. */
typedef struct filling {
    const lmb_volume *volume;
    const lmb_volume_texture_layout *layout;
    unsigned char *texels;
    uint32_t *words;
    uint32_t record; /* the next one, among the words */
    uint32_t region; /* likewise, among regions */
} filling;

/* A whole number up to 255 as a half, which holds it exactly. */
static uint16_t half_of_byte(uint32_t byte)
{
    return lmb_volume_half_of((float)byte);
}

/* A probe's numbers in the order of parts: coefficients 0 to 3 of red, of green, of blue; 4 to 7 likewise; 8 of each;
 * then what is seen of key lights. */
static void numbers_find(const filling *fill, uint32_t place, uint16_t number[NUMBERS])
{
    const unsigned char *const probe = lmb_volume_probe_at(fill->volume, place);
    const unsigned char *const seen = lmb_volume_probe_seen(fill->volume, probe);
    const uint32_t count = 3 * fill->layout->bands * fill->layout->bands;
    uint16_t half[LMB_PROBE_COEFFICIENTS];
    lmb_volume_probe_read_halfs(fill->volume, probe, half);
    memset(number, 0, NUMBERS * sizeof number[0]);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t channel = i < 24 ? i % 12 / 4 : i - 24, k = i < 24 ? 4 * (i / 12) + i % 4 : 8;
        number[i] = half[channel * LMB_SH3_COUNT + k];
    }
    for (uint32_t key = 0; key < fill->volume->key_count; ++key) {
        number[count + key] = half_of_byte(seen[key]);
    }
}

/* A probe as a texel of every part. */
static void texel_put(const filling *fill, uint32_t x, uint32_t y, uint32_t z, uint32_t place)
{
    enum { TEXEL = 8 };
    const lmb_volume_texture_layout *const layout = fill->layout;
    uint16_t number[NUMBERS];
    numbers_find(fill, place, number);
    unsigned char *to = fill->texels + TEXEL * (x + (uint64_t)layout->width * (y + (uint64_t)layout->height * z));
    for (uint32_t part = 0; part < layout->parts; ++part, to += layout->part_bytes) {
        memcpy(to, number + 4 * part, TEXEL);
    }
}

/* The texels of the cells of a brick that are interpolated among its own points. */
static void brick_texels_put(const filling *fill, const lmb_volume_brick *brick, uint64_t cells, const uint32_t tile[3])
{
    for (uint32_t row = 0; row < LMB_BRICK_ROWS; ++row) {
        const uint32_t y = row % LMB_BRICK_POINTS, z = row / LMB_BRICK_POINTS;
        const uint32_t points = lmb_volume_row_points(cells, y, z);
        for (uint32_t x = 0; x < LMB_BRICK_POINTS; ++x) {
            if (points >> x & 1u) {
                texel_put(fill, LMB_BRICK_POINTS * tile[0] + x, LMB_BRICK_POINTS * tile[1] + y,
                          LMB_BRICK_POINTS * tile[2] + z, brick->row[row] + x * fill->volume->probe_units);
            }
        }
    }
}

/* Gives a region the next block of eight texels. @return its word */
static uint32_t region_put(filling *fill, const uint32_t place[8])
{
    const lmb_volume_texture_layout *const layout = fill->layout;
    const uint32_t along = layout->width / REGION_POINTS, across = layout->height / REGION_POINTS;
    const uint32_t x = fill->region % along, y = fill->region / along % across, z = fill->region / along / across;
    const uint32_t first = LMB_BRICK_POINTS * layout->tiles[2];
    for (uint32_t i = 0; i < 8; ++i) {
        texel_put(fill, REGION_POINTS * x + i % 2, REGION_POINTS * y + i / 2 % 2, first + REGION_POINTS * z + i / 4,
                  place[i]);
    }
    ++fill->region;
    return x | y << REGION_BITS | z << 2 * REGION_BITS;
}

static uint32_t two_shorts(int16_t low, int16_t high)
{
    return (uint16_t)low | (uint32_t)(uint16_t)high << 16;
}

/* A cut cell's record and its regions' texels. @return whether one has the brick's own probes */
static bool cut_put(filling *fill, const lmb_volume_cut_cell *cut)
{
    uint32_t *to = fill->words + fill->record;
    bool has_own = false;
    *to++ = cut->plane_count;
    for (uint32_t i = 0; i < cut->plane_count; ++i) {
        const lmb_cell_plane *const plane = &cut->plane[i];
        *to++ = two_shorts(plane->normal[0], plane->normal[1]);
        *to++ = two_shorts(plane->normal[2], plane->offset);
        *to++ = plane->child[0] | (uint32_t)plane->child[1] << 8;
    }
    for (uint32_t region = 0; region < cut->region_count; ++region) {
        uint32_t place[8];
        const bool is_own = lmb_volume_cut_cell_places(fill->volume, cut, region, place) == 0;
        *to++ = is_own ? REGION_OWN : region_put(fill, place);
        has_own = has_own || is_own;
    }
    fill->record += record_words(cut);
    return has_own;
}

/* A brick's cells and all of their texels. */
static void brick_put(filling *fill, uint32_t number)
{
    const lmb_volume_brick *const brick = &fill->volume->bricks[number + 1];
    const uint32_t *const tiles = fill->layout->tiles;
    const uint32_t tile[3] = {number % tiles[0], number / tiles[0] % tiles[1], number / tiles[0] / tiles[1]};
    uint32_t *const word = fill->words + fill->layout->cells + BRICK_CELL_COUNT * number;
    uint64_t own = brick->plain;
    for (uint32_t cell = 0; cell < BRICK_CELL_COUNT; ++cell) {
        word[cell] = brick->plain >> cell & 1u ? CELL_OWN : CELL_NONE;
        if (brick->cut >> cell & 1u) {
            const lmb_volume_cut_cell cut = lmb_volume_cut_cell_of(fill->volume, brick, cell);
            word[cell] = fill->record;
            own |= (uint64_t)cut_put(fill, &cut) << cell;
        }
    }
    brick_texels_put(fill, brick, own, tile);
}

/* The directory's word of a block, from the file's. */
static uint32_t entry_of(const filling *fill, uint32_t word)
{
    const uint32_t number = word & ((UINT32_C(1) << LMB_VOLUME_LEVEL_SHIFT) - 1);
    const uint32_t *const tiles = fill->layout->tiles;
    if (number == 0) {
        return NO_BRICK;
    }
    const uint32_t x = (number - 1) % tiles[0], y = (number - 1) / tiles[0] % tiles[1],
                   z = (number - 1) / tiles[0] / tiles[1];
    return x | y << TILE_BITS | z << 2 * TILE_BITS | word >> LMB_VOLUME_LEVEL_SHIFT << LEVEL_SHIFT |
           (fill->volume->bricks[number].plain == UINT64_MAX ? 0 : HAS_CELLS);
}

void lmb_volume_texture_fill(const lmb_volume *volume, const lmb_volume_texture_layout *layout, void *texels,
                             uint32_t *words)
{
    assert(volume && layout && texels && words);
    filling fill = {.volume = volume, .layout = layout, .texels = texels, .words = words, .record = layout->records};
    memset(texels, 0, (size_t)layout->texture_bytes);
    for (uint32_t i = 0; i < layout->cells; ++i) {
        words[i] = entry_of(&fill, volume->directory[i]);
    }
    for (uint32_t number = 0; number + 1 < volume->header->brick_count; ++number) {
        brick_put(&fill, number);
    }
    assert(fill.record == layout->word_count && fill.region == layout->regions);
}

lmb_volume_texture_constants lmb_volume_texture_get_constants(const lmb_volume *volume,
                                                              const lmb_volume_texture_layout *layout,
                                                              lmb_vec3d world_origin)
{
    assert(volume && layout);
    const lmb_volume_gpu_constants place = lmb_volume_get_gpu(volume, world_origin).constants;
    lmb_volume_texture_constants to = {
        .inverse_spacing = place.inverse_spacing,
        .scale = place.scale,
        .slack = place.slack,
        .key_lights = place.key_lights,
        .bands = layout->bands,
        .texels = {layout->width, layout->height, layout->depth},
        .parts = layout->parts,
        .tiles = {layout->tiles[0], layout->tiles[0] * layout->tiles[1]},
        .cells = layout->cells,
        .region_z = LMB_BRICK_POINTS * layout->tiles[2],
    };
    memcpy(to.origin, place.origin, sizeof to.origin);
    memcpy(to.first, place.first, sizeof to.first);
    memcpy(to.last, place.last, sizeof to.last);
    memcpy(to.last_cell, place.last_cell, sizeof to.last_cell);
    memcpy(to.entries, place.entries, sizeof to.entries);
    return to;
}
