/* Packing regions into images. */
#include "lightmap/lightmap_internal.h"

#include <stdlib.h>

/* Regions come sorted as stb_rect_pack sorts them, with the instance's number for ties: leaving its own sort out makes
 * the result independent of the C library's qsort. */
#define STBRP_SORT(items, count, size, compare)                                                                        \
    do {                                                                                                               \
        (void)(items);                                                                                                 \
        (void)(compare);                                                                                               \
    } while (0)
#define STBRP_STATIC
#define STB_RECT_PACK_IMPLEMENTATION
#include <stb_rect_pack.h>

/* Regions are offered to an image in batches; when a whole batch does not fit, the image counts as full. */
enum { PACK_BATCH = 256 };

/* Trimmed images are a multiple of this many texels, which block compression asks for. */
enum { IMAGE_MULTIPLE = 4 };

/* One region with its padding. */
typedef struct pack_item {
    int32_t width, height;
    uint32_t instance;
} pack_item;

/* Everything that a packing reads and writes. */
typedef struct pack_work {
    pack_item *items; /* sorted: tall before low, wide before narrow; those already placed are taken out */
    size_t count;
    lmb_lightmap_region *region;
    stbrp_node *nodes; /* [side] */
} pack_work;

static int item_compare(const void *left, const void *right)
{
    const pack_item *a = left;
    const pack_item *b = right;
    if (a->height != b->height) {
        return a->height > b->height ? -1 : 1;
    }
    if (a->width != b->width) {
        return a->width > b->width ? -1 : 1;
    }
    return a->instance < b->instance ? -1 : 1;
}

/* Offers one batch to the image; moves what did not fit to `left`. Returns how many that were. */
static size_t batch_pack(stbrp_context *context, const pack_item *items, size_t count, int32_t image,
                         lmb_lightmap_region *region, pack_item *left)
{
    stbrp_rect rects[PACK_BATCH];
    for (size_t i = 0; i < count; ++i) {
        rects[i] = (stbrp_rect){.id = (int)i, .w = items[i].width, .h = items[i].height};
    }
    stbrp_pack_rects(context, rects, (int)count);
    size_t left_count = 0;
    for (size_t i = 0; i < count; ++i) {
        const pack_item item = items[i];
        if (!rects[i].was_packed) {
            left[left_count++] = item;
            continue;
        }
        lmb_lightmap_region *place = &region[item.instance];
        place->image = image;
        place->x = rects[i].x + (item.width - place->width) / 2;
        place->y = rects[i].y + (item.height - place->height) / 2;
    }
    return left_count;
}

/* Fills one image of side x side texels; what did not fit stays in `items`, in order. */
static void image_pack(pack_work *work, int32_t image, int32_t side)
{
    stbrp_context context;
    stbrp_init_target(&context, side, side, work->nodes, side);
    size_t left = 0;
    size_t next = 0;
    while (next < work->count) {
        const size_t batch = work->count - next < PACK_BATCH ? work->count - next : PACK_BATCH;
        /* `left` never overtakes `next`: items move towards the front. */
        const size_t refused = batch_pack(&context, &work->items[next], batch, image, work->region, &work->items[left]);
        next += batch;
        left += refused;
        if (refused == PACK_BATCH) {
            break;
        }
    }
    while (next < work->count) {
        work->items[left++] = work->items[next++];
    }
    work->count = left;
}

static size_t items_collect(const lmb_lightmap *lightmap, pack_item *items)
{
    size_t count = 0;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const lmb_lightmap_region *region = &lightmap->region[i];
        if (region->width > 0) {
            const int32_t padding = 2 * lightmap->settings.padding;
            items[count++] = (pack_item){region->width + padding, region->height + padding, i};
        }
    }
    qsort(items, count, sizeof *items, item_compare);
    return count;
}

/* The smallest power-of-two side whose image could hold all items, or the largest allowed. */
static int32_t side_first(const pack_item *items, size_t count, int32_t max_side)
{
    int64_t area = 0;
    int32_t longest = 1;
    for (size_t i = 0; i < count; ++i) {
        area += (int64_t)items[i].width * items[i].height;
        longest = items[i].width > longest ? items[i].width : longest;
        longest = items[i].height > longest ? items[i].height : longest;
    }
    int32_t side = 1;
    while (side < max_side && (side < longest || (int64_t)side * side < area)) {
        side *= 2;
    }
    return side;
}

/* Trims images to what their regions use and makes them. */
static lmb_result images_make(lmb_lightmap *lightmap, int32_t count)
{
    lightmap->image = calloc((size_t)count + 1u, sizeof *lightmap->image);
    if (!lightmap->image) {
        return LMB_ERROR_MEMORY;
    }
    lightmap->image_count = count;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const lmb_lightmap_region *region = &lightmap->region[i];
        if (region->image >= 0) {
            lmb_lightmap_image *image = &lightmap->image[region->image];
            const int32_t right = region->x + region->width + lightmap->settings.padding;
            const int32_t bottom = region->y + region->height + lightmap->settings.padding;
            image->width = right > image->width ? right : image->width;
            image->height = bottom > image->height ? bottom : image->height;
        }
    }
    for (int32_t i = 0; i < count; ++i) {
        lmb_lightmap_image *image = &lightmap->image[i];
        image->width = (image->width + IMAGE_MULTIPLE - 1) / IMAGE_MULTIPLE * IMAGE_MULTIPLE;
        image->height = (image->height + IMAGE_MULTIPLE - 1) / IMAGE_MULTIPLE * IMAGE_MULTIPLE;
        const size_t texels = (size_t)image->width * (size_t)image->height;
        image->plane = calloc(texels * (size_t)lightmap->model->channel_count, sizeof *image->plane);
        image->state = calloc(texels, sizeof *image->state);
        if (!image->plane || !image->state) {
            return LMB_ERROR_MEMORY;
        }
    }
    return LMB_OK;
}

lmb_result lmb_lightmap_pack(lmb_lightmap *lightmap)
{
    const int32_t max_side = lightmap->settings.max_image_size;
    pack_item *items = calloc(2 * ((size_t)lightmap->scene->instance_count + 1u), sizeof *items);
    stbrp_node *nodes = calloc((size_t)max_side, sizeof *nodes);
    lmb_result result = LMB_ERROR_MEMORY;
    if (!items || !nodes) {
        goto cleanup;
    }
    const size_t count = items_collect(lightmap, items);
    pack_work work = {&items[count], 0, lightmap->region, nodes};
    int32_t images = 0;
    if (count > 0) {
        /* Ever larger single images, then as many of the largest as it takes. */
        for (int32_t side = side_first(items, count, max_side);; side *= 2) {
            for (size_t i = 0; i < count; ++i) {
                work.items[i] = items[i];
            }
            work.count = count;
            images = 0;
            do {
                image_pack(&work, images++, side);
            } while (work.count > 0 && side == max_side);
            if (work.count == 0) {
                break;
            }
        }
    }
    result = images_make(lightmap, images);

cleanup:
    free(items);
    free(nodes);
    return result;
}
