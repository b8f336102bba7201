/* Packing regions into images. */
#include "lightmap/chart_widths.h"
#include "lightmap/lightmap_internal.h"

#include <stdlib.h>

/* Trimmed images are a multiple of this many texels, which block compression asks for. */
enum { IMAGE_MULTIPLE = 4 };

/* The regions, as whole boxes that keep their turn: several nodes share the UVs of a mesh. Returns how many; `*enough`
 * is whether the memory was. */
static size_t items_collect(const lmb_lightmap *lightmap, chart_item *items, bool *enough)
{
    size_t count = 0;
    *enough = true;
    for (uint32_t i = 0; i < lightmap->scene->instance_count && *enough; ++i) {
        const lmb_lightmap_region *region = &lightmap->region[i];
        if (region->width > 0) {
            items[count].id = i;
            items[count].turns = 1;
            *enough = lmb_chart_shape_make_box(region->width, region->height, items[count].shape);
            ++count;
        }
    }
    lmb_chart_items_sort(items, count);
    return count;
}

/* Gives the regions that have a place to the image; the others stay in `items`, in order. Returns how many those are.
 */
static size_t image_take(lmb_lightmap *lightmap, int32_t image, chart_item *items, const chart_widths *job)
{
    const int32_t padding = lightmap->settings.padding;
    size_t left = 0;
    for (size_t i = 0; i < job->count; ++i) {
        if (job->place[i].turn < 0) {
            const chart_item item = items[i];
            items[i] = items[left];
            items[left++] = item;
            continue;
        }
        lmb_lightmap_region *const region = &lightmap->region[items[i].id];
        region->image = image;
        region->x = job->place[i].x - padding; /* the border is nobody's neighbour */
        region->y = job->place[i].y - padding;
    }
    return left;
}

static bool planes_make(const lmb_lightmap *lightmap, lmb_lightmap_image *image, size_t texels)
{
    image->plane = calloc(texels * (size_t)lmb_lightmap_plane_count(lightmap), sizeof *image->plane);
    image->state = calloc(texels, sizeof *image->state);
    bool enough = image->plane && image->state;
    const lmb_lightmap_settings *settings = &lightmap->settings;
    for (int k = 0; enough && k < LMB_LIGHTMAP_MOST_MODELS && settings->other[k]; ++k) {
        image->other[k] = calloc(texels * (size_t)(settings->other[k]->channel_count + (int)lightmap->key_light_count),
                                 sizeof *image->other[k]);
        enough = image->other[k] != NULL;
    }
    if (enough && settings->error) {
        image->error = calloc(texels, sizeof *image->error);
        enough = image->error != NULL;
    }
    return enough;
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
        if (!planes_make(lightmap, image, texels)) {
            return LMB_ERROR_MEMORY;
        }
    }
    return LMB_OK;
}

lmb_result lmb_lightmap_pack(lmb_lightmap *lightmap)
{
    const size_t most = (size_t)lightmap->scene->instance_count + 1u;
    chart_item *const items = calloc(most, sizeof *items);
    chart_place *const places = malloc(most * sizeof *places);
    bool enough = items && places;
    const size_t count = enough ? items_collect(lightmap, items, &enough) : 0;
    lmb_result result = enough ? LMB_OK : LMB_ERROR_MEMORY;
    int32_t images = 0;
    for (size_t left = count; left > 0 && result == LMB_OK; ++images) {
        chart_widths job = {.items = items,
                            .count = left,
                            .gutter = 2 * lightmap->settings.padding,
                            .most = lightmap->settings.max_image_size + 2 * lightmap->settings.padding,
                            .pool = lightmap->settings.pool,
                            .place = places};
        result = lmb_chart_widths_pack(&job);
        if (result == LMB_ERROR_ARGUMENT) { /* more than one image: as much as goes into this one */
            result = lmb_chart_widths_fill(&job);
        }
        left = result == LMB_OK ? image_take(lightmap, images, items, &job) : left;
    }
    if (result == LMB_OK) {
        result = images_make(lightmap, images);
    }
    lmb_chart_items_free(items, count);
    free(places);
    return result;
}
