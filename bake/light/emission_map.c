#include "light/emission_map.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/texture.h>
#include <lambent/vector.h>

/* Weights are summed as whole numbers, so that what is dark stays exactly dark. */
#define WEIGHT_ONE (1 << 20)

/* Tints are rounded to this part of the largest channel. */
#define TINT_STEPS 4.0f

/* More than texture look-ups round. */
#define CUTOFF_SLACK 1e-5f

/* Rows of texels that a row of cells depends on: its own and its neighbours. */
enum { ROWS = 3 };

struct lmb_emission_map {
    int32_t size[2];
    lmb_wrap wrap[2];
    uint64_t *sum; /* [row][column], (size[0] + 1) x (size[1] + 1): of all cells above and left of it */
};

static const lmb_texture_image *image_at(const lmb_scene *scene, int32_t index)
{
    if (index < 0 || (uint32_t)index >= scene->image_count) {
        return NULL;
    }
    const lmb_texture_image *image = &scene->images[index];
    return image->rgba && image->width > 0 && image->height > 0 ? image : NULL;
}

/* Whether each texel of one covers just one of the other. */
static bool textures_coincide(const lmb_scene *scene, const lmb_texture *a, const lmb_texture *b)
{
    const lmb_texture_image *image_a = image_at(scene, a->image), *image_b = image_at(scene, b->image);
    if (!image_a || !image_b || image_a->width != image_b->width || image_a->height != image_b->height ||
        a->uv_set != b->uv_set || a->wrap_u != b->wrap_u || a->wrap_v != b->wrap_v || a->nearest != b->nearest) {
        return false;
    }
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (!(fabsf(a->transform[i][j] - b->transform[i][j]) <= 0.0f)) {
                return false;
            }
        }
    }
    return true;
}

static void tint_set(lmb_emission_key *key, const lmb_material *material)
{
    const float largest = lmb_rgb_max(material->emissive);
    for (int c = 0; c < 3; ++c) {
        key->tint[c] = key->emission >= 0 ? ceilf(TINT_STEPS * (material->emissive.c[c] / largest)) / TINT_STEPS : 1.0f;
    }
}

bool lmb_emission_key_of(const lmb_scene *scene, const lmb_material *material, lmb_emission_key *key,
                         const lmb_texture **texture)
{
    const lmb_texture *emission = &material->emissive_texture, *base = &material->base_color_texture;
    const bool is_emission = image_at(scene, emission->image) != NULL;
    const bool is_alpha = material->alpha_mode != LMB_ALPHA_OPAQUE && image_at(scene, base->image) != NULL &&
                          (!is_emission || textures_coincide(scene, emission, base));
    if (!is_emission && !is_alpha) {
        return false;
    }
    *texture = is_emission ? emission : base;
    *key = (lmb_emission_key){.emission = is_emission ? emission->image : -1,
                              .alpha = is_alpha ? base->image : -1,
                              .wrap_u = (*texture)->wrap_u,
                              .wrap_v = (*texture)->wrap_v,
                              .nearest = (*texture)->nearest,
                              .is_masked = is_alpha && material->alpha_mode == LMB_ALPHA_MASK};
    tint_set(key, material);
    if (key->is_masked) {
        /* By the texture's alpha alone: vertex colours only lower it. No factor, no alpha. */
        const float factor = material->base_color[3];
        key->cutoff = material->alpha_cutoff <= 0.0f ? 0.0f : factor > 0.0f ? material->alpha_cutoff / factor : 2.0f;
    }
    return true;
}

bool lmb_emission_key_equal(const lmb_emission_key *a, const lmb_emission_key *b)
{
    return a->emission == b->emission && a->alpha == b->alpha && a->wrap_u == b->wrap_u && a->wrap_v == b->wrap_v &&
           a->nearest == b->nearest && a->is_masked == b->is_masked &&
           memcmp(&a->cutoff, &b->cutoff, sizeof a->cutoff) == 0 && memcmp(a->tint, b->tint, sizeof a->tint) == 0;
}

/* The row or column just outside an image that stands there. */
static int32_t texel_wrapped(int32_t i, int32_t size, lmb_wrap wrap)
{
    if (wrap == LMB_WRAP_REPEAT) {
        return i < 0 ? size - 1 : i < size ? i : 0;
    }
    return i < 0 ? 0 : i < size ? i : size - 1;
}

/* What a map is made from, row by row. Rows have one texel more at either end. */
typedef struct map_source {
    const lmb_emission_key *key;
    const lmb_texture_image *emission, *alpha;
    int32_t width, height;
    float scale[3];     /* of the emission's channels: white gives 1 */
    float *light[ROWS]; /* row y is in light[y % ROWS] */
    float *alphas[ROWS];
} map_source;

static void row_read(const map_source *source, int32_t y)
{
    const int32_t row = texel_wrapped(y, source->height, source->key->wrap_v);
    float *light = source->light[(y + ROWS) % ROWS], *alphas = source->alphas[(y + ROWS) % ROWS];
    for (int32_t x = -1; x <= source->width; ++x) {
        const int32_t column = texel_wrapped(x, source->width, source->key->wrap_u);
        const size_t texel = 4 * ((size_t)row * (size_t)source->width + (size_t)column);
        light[x + 1] = 1.0f;
        alphas[x + 1] = 1.0f;
        if (source->emission) {
            light[x + 1] = 0.0f;
            for (int c = 0; c < 3; ++c) {
                light[x + 1] += source->scale[c] * lmb_srgb_to_linear(source->emission->rgba[texel + (size_t)c]);
            }
        }
        if (source->alpha) {
            alphas[x + 1] = (float)source->alpha->rgba[texel + 3] / 255.0f;
        }
    }
}

static float opacity_of(const lmb_emission_key *key, float alpha)
{
    return !key->is_masked ? alpha : alpha >= key->cutoff - CUTOFF_SLACK ? 1.0f : 0.0f;
}

/* Values of a filtered texture at a cell's corners, the middles of its edges and its own: between these it is bilinear.
 */
static void cell_points(float *const rows[ROWS], int32_t x, int32_t y, float point[3][3])
{
    float along[ROWS][3];
    for (int j = 0; j < ROWS; ++j) {
        const float *texel = &rows[(y - 1 + j + ROWS) % ROWS][x];
        along[j][0] = 0.5f * (texel[0] + texel[1]);
        along[j][1] = texel[1];
        along[j][2] = 0.5f * (texel[1] + texel[2]);
    }
    for (int i = 0; i < 3; ++i) {
        point[0][i] = 0.5f * (along[0][i] + along[1][i]);
        point[1][i] = along[1][i];
        point[2][i] = 0.5f * (along[1][i] + along[2][i]);
    }
}

static float cell_weight(const map_source *source, int32_t x, int32_t y)
{
    static const float share[3] = {0.25f, 0.5f, 0.25f}; /* the trapezoidal rule, exact where one of them is even */
    if (source->key->nearest) {
        return source->light[y % ROWS][x + 1] * opacity_of(source->key, source->alphas[y % ROWS][x + 1]);
    }
    float light[3][3], alpha[3][3];
    cell_points(source->light, x, y, light);
    cell_points(source->alphas, x, y, alpha);
    float sum = 0.0f, most_light = 0.0f, most_opaque = 0.0f;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
            const float opacity = opacity_of(source->key, alpha[j][i]);
            sum += share[j] * share[i] * light[j][i] * opacity;
            most_light = lmb_larger(most_light, light[j][i]);
            most_opaque = lmb_larger(most_opaque, opacity);
        }
    }
    /* Between a point that only gives light and one that is only opaque there is some of both. */
    return lmb_larger(sum, most_light * most_opaque / WEIGHT_ONE);
}

static uint64_t weight_whole(float weight)
{
    const float whole = ceilf(weight * WEIGHT_ONE);
    return whole < (float)WEIGHT_ONE ? (uint64_t)whole : WEIGHT_ONE;
}

static void sums_make(const map_source *source, uint64_t *sum)
{
    const size_t pitch = (size_t)source->width + 1;
    row_read(source, -1);
    row_read(source, 0);
    for (int32_t y = 0; y < source->height; ++y) {
        row_read(source, y + 1);
        const uint64_t *above = sum + (size_t)y * pitch;
        uint64_t *here = sum + ((size_t)y + 1) * pitch;
        uint64_t row = 0;
        for (int32_t x = 0; x < source->width; ++x) {
            row += weight_whole(cell_weight(source, x, y));
            here[x + 1] = above[x + 1] + row;
        }
    }
}

static void scale_set(map_source *source)
{
    const float *tint = source->key->tint;
    const float white = lmb_luminance(lmb_rgb_of(tint[0], tint[1], tint[2]));
    for (int c = 0; c < 3; ++c) {
        lmb_rgb channel = lmb_rgb_of(0.0f, 0.0f, 0.0f);
        channel.c[c] = tint[c];
        source->scale[c] = lmb_luminance(channel) / white;
    }
}

lmb_result lmb_emission_map_create(const lmb_scene *scene, const lmb_emission_key *key, lmb_emission_map **map)
{
    map_source source = {.key = key, .emission = image_at(scene, key->emission), .alpha = image_at(scene, key->alpha)};
    const lmb_texture_image *image = source.emission ? source.emission : source.alpha;
    assert(image);
    source.width = image->width;
    source.height = image->height;
    scale_set(&source);
    const size_t row = (size_t)image->width + 2;
    float *rows = malloc(2 * ROWS * row * sizeof *rows);
    lmb_emission_map *created = calloc(1, sizeof *created);
    uint64_t *sum = calloc(((size_t)image->width + 1) * ((size_t)image->height + 1), sizeof *sum);
    if (!rows || !created || !sum) {
        free(rows);
        free(created);
        free(sum);
        return LMB_ERROR_MEMORY;
    }
    for (size_t k = 0; k < ROWS; ++k) {
        source.light[k] = rows + 2 * k * row;
        source.alphas[k] = rows + (2 * k + 1) * row;
    }
    sums_make(&source, sum);
    free(rows);
    *created = (lmb_emission_map){{image->width, image->height}, {key->wrap_u, key->wrap_v}, sum};
    *map = created;
    return LMB_OK;
}

void lmb_emission_map_destroy(lmb_emission_map *map)
{
    if (map) {
        free(map->sum);
        free(map);
    }
}

int32_t lmb_emission_map_size(const lmb_emission_map *map, int axis)
{
    return map->size[axis];
}

/* Rows or columns of the image that a range covers, each so many times. */
typedef struct span {
    int32_t first, end;
    double times;
} span;
enum { SPANS = 3 };

static int span_add(span *spans, int count, int64_t first, int64_t end, int64_t times)
{
    if (end > first && times > 0) {
        spans[count++] = (span){(int32_t)first, (int32_t)end, (double)times};
    }
    return count;
}

static int spans_clamped(int64_t first, int64_t end, int32_t size, span spans[SPANS])
{
    const int64_t low = first < 0 ? 0 : first < size ? first : size;
    const int64_t high = end < 0 ? 0 : end < size ? end : size;
    int count = span_add(spans, 0, low, high, 1);
    count = span_add(spans, count, 0, 1, first < 0 ? (end < 0 ? end : 0) - first : 0);
    return span_add(spans, count, size - 1, size, end > size ? end - (first > size ? first : size) : 0);
}

/* Part of one repetition of the image. */
static int span_repeated(int64_t first, int64_t end, int32_t size, bool mirrored, span *spans, int count)
{
    const int64_t tile = first >= 0 ? first / size : -((size - 1 - first) / size);
    first -= tile * size;
    end -= tile * size;
    return mirrored && tile % 2 != 0 ? span_add(spans, count, size - end, size - first, 1)
                                     : span_add(spans, count, first, end, 1);
}

static int spans_find(int64_t first, int64_t end, int32_t size, lmb_wrap wrap, span spans[SPANS])
{
    if (wrap == LMB_WRAP_CLAMP) {
        return spans_clamped(first, end, size, spans);
    }
    const bool mirrored = wrap == LMB_WRAP_MIRROR;
    const int64_t into = first >= 0 ? first % size : size - 1 - (-1 - first) % size;
    const int64_t next = first - into + size; /* where the next repetition begins */
    if (end <= next) {
        return span_repeated(first, end, size, mirrored, spans, 0);
    }
    const int64_t whole = (end - next) / size;
    int count = span_repeated(first, next, size, mirrored, spans, 0);
    count = span_add(spans, count, 0, size, whole);
    return end > next + whole * size ? span_repeated(next + whole * size, end, size, mirrored, spans, count) : count;
}

double lmb_emission_map_sum(const lmb_emission_map *map, const lmb_texel_range *range)
{
    span across[SPANS], down[SPANS];
    const int columns = spans_find(range->first[0], range->end[0], map->size[0], map->wrap[0], across);
    const int rows = spans_find(range->first[1], range->end[1], map->size[1], map->wrap[1], down);
    const size_t pitch = (size_t)map->size[0] + 1;
    double sum = 0.0;
    for (int j = 0; j < rows; ++j) {
        const uint64_t *top = map->sum + (size_t)down[j].first * pitch;
        const uint64_t *bottom = map->sum + (size_t)down[j].end * pitch;
        for (int i = 0; i < columns; ++i) {
            const uint64_t inside =
                (bottom[across[i].end] - bottom[across[i].first]) - (top[across[i].end] - top[across[i].first]);
            sum += down[j].times * across[i].times * (double)inside;
        }
    }
    return sum;
}

double lmb_emission_map_mean(const lmb_emission_map *map, const lmb_texel_range *range)
{
    const double cells =
        ((double)range->end[0] - (double)range->first[0]) * ((double)range->end[1] - (double)range->first[1]);
    return lmb_emission_map_sum(map, range) / (cells * WEIGHT_ONE);
}
