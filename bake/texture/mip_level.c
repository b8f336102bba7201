#include "texture/mip_level.h"

#include <stdlib.h>
#include <string.h>

bool lmb_mip_level_create(int32_t width, int32_t height, int planes, mip_level *level)
{
    *level = (mip_level){width, height, planes, NULL, NULL};
    level->value = calloc(mip_level_texels(level) * (size_t)planes + 1, sizeof *level->value);
    level->coverage = calloc(mip_level_texels(level), sizeof *level->coverage);
    if (!level->value || !level->coverage) {
        lmb_mip_level_free(level);
        return false;
    }
    return true;
}

void lmb_mip_level_free(mip_level *level)
{
    free(level->value);
    free(level->coverage);
    memset(level, 0, sizeof *level);
}

/* Along one side: the texels that a new one reaches over, three at most, and how much of each, 0 to 1. */
typedef struct mip_reach {
    int32_t first;
    int count;
    float share[3];
} mip_reach;

static mip_reach reach_of(int32_t at, int32_t side, int32_t half)
{
    /* In units of 1 / half texels, whole numbers: the new texel is `side` of them long, the old ones `half`. */
    const int64_t begin = (int64_t)at * side, end = begin + side;
    mip_reach reach = {.first = (int32_t)(begin / half)};
    for (int64_t k = reach.first; k * half < end && reach.count < 3; ++k) {
        const int64_t low = k * half > begin ? k * half : begin;
        const int64_t high = (k + 1) * half < end ? (k + 1) * half : end;
        reach.share[reach.count++] = (float)(high - low) / (float)half;
    }
    return reach;
}

static void texel_halve(const mip_level *from, mip_level *to, int32_t x, int32_t y)
{
    const mip_reach across = reach_of(x, from->width, to->width), down = reach_of(y, from->height, to->height);
    const size_t at = (size_t)y * (size_t)to->width + (size_t)x;
    float total = 0.0f, area = 0.0f;
    for (int j = 0; j < down.count; ++j) {
        for (int i = 0; i < across.count; ++i) {
            const size_t source = (size_t)(down.first + j) * (size_t)from->width + (size_t)(across.first + i);
            const float share = across.share[i] * down.share[j];
            const float weight = share * from->coverage[source];
            area += share;
            total += weight;
            for (int p = 0; p < from->planes; ++p) {
                to->value[(size_t)p * mip_level_texels(to) + at] +=
                    weight * from->value[(size_t)p * mip_level_texels(from) + source];
            }
        }
    }
    to->coverage[at] = total / area;
    for (int p = 0; p < from->planes && total > 0.0f; ++p) {
        to->value[(size_t)p * mip_level_texels(to) + at] /= total;
    }
}

bool lmb_mip_level_halve(const mip_level *from, mip_level *to)
{
    const int32_t width = from->width > 1 ? from->width / 2 : 1, height = from->height > 1 ? from->height / 2 : 1;
    if (!lmb_mip_level_create(width, height, from->planes, to)) {
        return false;
    }
    for (int32_t y = 0; y < height; ++y) {
        for (int32_t x = 0; x < width; ++x) {
            texel_halve(from, to, x, y);
        }
    }
    return true;
}
