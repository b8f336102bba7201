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

/* What a texel of a level covers of the image along one side: from `first` on, `count` texels, of the two at its ends a
 * share. */
typedef struct mip_reach {
    int32_t first, count;
    float first_share, last_share; /* alike where they are one */
} mip_reach;

static mip_reach reach_of(int32_t at, int32_t side, int32_t texels)
{
    /* In units of 1 / texels of the image's: whole numbers. A texel of the level is `side` of them long. */
    const int64_t begin = (int64_t)at * side, end = begin + side;
    const int64_t first = begin / texels, last = (end - 1) / texels;
    const int64_t first_end = (first + 1) * texels < end ? (first + 1) * texels : end;
    const int64_t last_begin = last * texels > begin ? last * texels : begin;
    return (mip_reach){(int32_t)first, (int32_t)(last - first + 1), (float)(first_end - begin) / (float)texels,
                       (float)(end - last_begin) / (float)texels};
}

static float reach_share(const mip_reach *reach, int32_t k)
{
    return k == 0 ? reach->first_share : k == reach->count - 1 ? reach->last_share : 1.0f;
}

static void texel_reduce(const mip_level *image, const mip_reach *across, const mip_reach *down, mip_level *level,
                         size_t at)
{
    const size_t from = mip_level_texels(image), to = mip_level_texels(level);
    float total = 0.0f, area = 0.0f;
    for (int32_t j = 0; j < down->count; ++j) {
        for (int32_t i = 0; i < across->count; ++i) {
            const size_t source = (size_t)(down->first + j) * (size_t)image->width + (size_t)(across->first + i);
            const float share = reach_share(across, i) * reach_share(down, j);
            const float weight = share * image->coverage[source];
            area += share;
            total += weight;
            for (int p = 0; p < image->planes && weight > 0.0f; ++p) {
                level->value[(size_t)p * to + at] += weight * image->value[(size_t)p * from + source];
            }
        }
    }
    level->coverage[at] = total / area;
    for (int p = 0; p < image->planes && total > 0.0f; ++p) {
        level->value[(size_t)p * to + at] /= total;
    }
}

bool lmb_mip_level_reduce(const mip_level *image, int32_t number, mip_level *level)
{
    const int32_t width = image->width >> number > 0 ? image->width >> number : 1;
    const int32_t height = image->height >> number > 0 ? image->height >> number : 1;
    if (!lmb_mip_level_create(width, height, image->planes, level)) {
        return false;
    }
    for (int32_t y = 0; y < height; ++y) {
        const mip_reach down = reach_of(y, image->height, height);
        for (int32_t x = 0; x < width; ++x) {
            const mip_reach across = reach_of(x, image->width, width);
            texel_reduce(image, &across, &down, level, (size_t)y * (size_t)width + (size_t)x);
        }
    }
    return true;
}
