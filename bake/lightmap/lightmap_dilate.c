/* Padding: texels that no triangle touches take the light of those around them, ring by ring. */
#include "lightmap/lightmap_internal.h"

#include <stdlib.h>
#include <string.h>

/* State of a texel that waits for its ring; no texel has it when the work is done. */
enum { TEXEL_QUEUED = LMB_TEXEL_DILATED + 1 };

/* A region with its padding, in an image's texels. */
typedef struct dilate_area {
    lmb_lightmap_image *image;
    const lmb_model *model;
    int planes;                       /* of the model's channels, and those of key lights */
    int32_t left, top, right, bottom; /* right and bottom are just outside */
} dilate_area;

/* Texels of a ring, as numbers in the image. */
typedef struct dilate_ring {
    uint32_t *pixel;
    size_t count;
} dilate_ring;

static bool area_has(const dilate_area *area, int32_t x, int32_t y)
{
    return x >= area->left && x < area->right && y >= area->top && y < area->bottom;
}

/* Adds a texel of the area that has light. Returns whether it has. */
static bool lit_add(const dilate_area *area, int32_t x, int32_t y, float *sum)
{
    const lmb_lightmap_image *image = area->image;
    const size_t at = (size_t)y * (size_t)image->width + (size_t)x;
    if (!area_has(area, x, y) || (image->state[at] != LMB_TEXEL_GATHERED && image->state[at] != LMB_TEXEL_DILATED)) {
        return false;
    }
    for (int c = 0; c < area->planes; ++c) {
        sum[c] += lmb_lightmap_plane(image, c)[at];
    }
    return true;
}

/* Makes of a texel the mean of the lit ones beside it, or, where there are none, of those at its corners. Those at its
 * corners may be across a wall from those beside it. */
static void around_mean(const dilate_area *area, uint32_t pixel)
{
    const lmb_lightmap_image *image = area->image;
    const lmb_model *model = area->model;
    const int32_t x = (int32_t)(pixel % (uint32_t)image->width);
    const int32_t y = (int32_t)(pixel / (uint32_t)image->width);
    float sum[LMB_MODEL_MOST_CHANNELS + LMB_KEY_LIGHTS_MOST] = {0.0f};
    int count = 0;
    for (int along = -1; along <= 1; along += 2) {
        count += lit_add(area, x + along, y, sum);
        count += lit_add(area, x, y + along, sum);
    }
    const bool none_beside = count == 0;
    for (int corner = 0; corner < 4 && none_beside; ++corner) {
        count += lit_add(area, x + (corner & 1 ? 1 : -1), y + (corner & 2 ? 1 : -1), sum);
    }
    const float total = (float)count;
    for (int c = model->channel_count; c < area->planes; ++c) {
        sum[c] /= total;
    }
    lmb_model_average(model, sum, total);
    for (int c = 0; c < area->planes; ++c) {
        lmb_lightmap_plane(image, c)[pixel] = sum[c];
    }
}

/* Queues the empty texels around a lit one. */
static void around_queue(const dilate_area *area, int32_t x, int32_t y, dilate_ring *ring)
{
    const lmb_lightmap_image *image = area->image;
    for (int32_t dy = -1; dy <= 1; ++dy) {
        for (int32_t dx = -1; dx <= 1; ++dx) {
            if (!area_has(area, x + dx, y + dy)) {
                continue;
            }
            const size_t at = (size_t)(y + dy) * (size_t)image->width + (size_t)(x + dx);
            if (image->state[at] == LMB_TEXEL_EMPTY) {
                image->state[at] = TEXEL_QUEUED;
                ring->pixel[ring->count++] = (uint32_t)at;
            }
        }
    }
}

/* Both rings hold up to all texels of the area. */
static void area_dilate(const dilate_area *area, dilate_ring ring, dilate_ring next)
{
    lmb_lightmap_image *image = area->image;
    ring.count = 0;
    for (int32_t y = area->top; y < area->bottom; ++y) {
        for (int32_t x = area->left; x < area->right; ++x) {
            if (image->state[(size_t)y * (size_t)image->width + (size_t)x] == LMB_TEXEL_GATHERED) {
                around_queue(area, x, y, &ring);
            }
        }
    }
    while (ring.count > 0) {
        /* The whole ring is worked out from what was lit before it. */
        for (size_t i = 0; i < ring.count; ++i) {
            around_mean(area, ring.pixel[i]);
        }
        next.count = 0;
        for (size_t i = 0; i < ring.count; ++i) {
            image->state[ring.pixel[i]] = LMB_TEXEL_DILATED;
        }
        for (size_t i = 0; i < ring.count; ++i) {
            const uint32_t width = (uint32_t)image->width;
            around_queue(area, (int32_t)(ring.pixel[i] % width), (int32_t)(ring.pixel[i] / width), &next);
        }
        const dilate_ring done = ring;
        ring = next;
        next = done;
    }
}

static dilate_area region_area(const lmb_lightmap *lightmap, const lmb_lightmap_region *region)
{
    const int32_t padding = lightmap->settings.padding;
    return (dilate_area){&lightmap->image[region->image],
                         lightmap->model,
                         lmb_lightmap_plane_count(lightmap),
                         region->x - padding,
                         region->y - padding,
                         region->x + region->width + padding,
                         region->y + region->height + padding};
}

lmb_result lmb_lightmap_dilate(lmb_lightmap *lightmap)
{
    size_t largest = 1;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const lmb_lightmap_region *region = &lightmap->region[i];
        const size_t padding = 2 * (size_t)lightmap->settings.padding;
        const size_t texels = ((size_t)region->width + padding) * ((size_t)region->height + padding);
        largest = texels > largest ? texels : largest;
    }
    const dilate_ring ring = {malloc(largest * sizeof(uint32_t)), 0};
    const dilate_ring next = {malloc(largest * sizeof(uint32_t)), 0};
    const bool enough = ring.pixel && next.pixel;
    for (uint32_t i = 0; enough && i < lightmap->scene->instance_count; ++i) {
        if (lightmap->region[i].image >= 0) {
            const dilate_area area = region_area(lightmap, &lightmap->region[i]);
            area_dilate(&area, ring, next);
        }
    }
    free(ring.pixel);
    free(next.pixel);
    return enough ? LMB_OK : LMB_ERROR_MEMORY;
}
