/* Which UVs each mesh uses, how many texels each instance gets of those it asks for, and where they are. */
#include "lightmap/lightmap_internal.h"
#include "lightmap/lightmap_textures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/affine.h"

/* TEXCOORD_1 gets at least this many texels for one unit of UV, however small the instance. */
enum { MIN_DENSITY = 8 };

/* At most this many for one unit, so that UVs in texels are exact enough in float. */
enum { MAX_DENSITY = 1 << 20 };

/* UVs are checked at their region's resolution, within what is worth the time. */
enum { MIN_CHECK_RESOLUTION = 256, MAX_CHECK_RESOLUTION = 4096 };

enum { MIN_IMAGE_SIZE = 16, MAX_IMAGE_SIZE = 16384 };

/* Texels of all images: 4 GB of them. */
#define MAX_TEXELS (UINT64_C(1) << 27)

/* Charts that do not fit an image are made again, each time coarser. */
enum { CHART_ATTEMPTS = 24 };

static double mesh_uv_area(const lmb_mesh *mesh, const lmb_vec2 *corner_uv)
{
    double area = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const lmb_vec2 a = lmb_texels_corner_uv(mesh, corner_uv, t, 0);
        const lmb_vec2 b = lmb_texels_corner_uv(mesh, corner_uv, t, 1);
        const lmb_vec2 c = lmb_texels_corner_uv(mesh, corner_uv, t, 2);
        const double ux = (double)b.x - (double)a.x, uy = (double)b.y - (double)a.y;
        const double vx = (double)c.x - (double)a.x, vy = (double)c.y - (double)a.y;
        area += 0.5 * fabs(ux * vy - uy * vx);
    }
    return area;
}

/* What the instances of each mesh ask of it. */
typedef struct layout_work {
    lmb_lightmap *lightmap;
    double *instance_area; /* [instance] square metres */
    double *texels;        /* [instance] that its area asks for */
    double *most_texels;   /* [mesh] that an instance asks for; < 0: it has none */
    double *uv_area;       /* [mesh] of the UVs that it uses */
    int32_t *resolution;   /* [mesh] of its charts; 0: it has none */
    double *chart_share;   /* [mesh] of the density asked for that its charts have */
    lmb_layout_losses losses;
    lmb_error *error;
} layout_work;

static lmb_result out_of_memory(lmb_error *error)
{
    return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for the lightmap");
}

/* Texels along one unit of UV. */
static int32_t uv_density(double texels, double uv_area)
{
    const double density = ceil(sqrt(texels / uv_area));
    return density >= MAX_DENSITY ? MAX_DENSITY : density > MIN_DENSITY ? (int32_t)density : MIN_DENSITY;
}

/* Islands that are small at a density of texels for one unit of UV. Nobody asks where nobody listens. */
static double small_uv_area(double density)
{
    return LMB_SMALL_ISLAND_TEXELS / (density * density);
}

static lmb_result charts_islands_find(layout_work *work, uint32_t number, const lmb_charts *charts)
{
    const lmb_lightmap *lightmap = work->lightmap;
    return lightmap->settings.warnings.warn
               ? lmb_uv_islands_of_charts(charts, lightmap->scene->meshes[number].triangle_count,
                                          small_uv_area(charts->resolution), &work->losses.islands[number])
               : LMB_OK;
}

static lmb_result own_islands_find(layout_work *work, uint32_t number)
{
    const lmb_lightmap *lightmap = work->lightmap;
    const double density = uv_density(work->most_texels[number], work->uv_area[number]);
    return !lightmap->settings.warnings.warn ||
                   lmb_uv_islands_find(&lightmap->scene->meshes[number], small_uv_area(density),
                                       &work->losses.islands[number]) == LMB_OK
               ? LMB_OK
               : out_of_memory(work->error);
}

static lmb_result mesh_make_charts(layout_work *work, uint32_t number)
{
    lmb_lightmap *lightmap = work->lightmap;
    const lmb_mesh *mesh = &lightmap->scene->meshes[number];
    const lmb_affine identity = {{{1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}}};
    const double own_area = lmb_mesh_area(mesh, &identity);
    const int32_t padding = lightmap->settings.padding;
    const double room = lightmap->settings.max_image_size - 2 * padding;
    const double asked = sqrt(work->most_texels[number] / own_area);
    double density = fmin(asked, room / sqrt(own_area));
    for (int attempt = 0; attempt < CHART_ATTEMPTS && density > 0.0 && isfinite(density); ++attempt) {
        lmb_charts charts;
        const lmb_result result = lmb_charts_make(mesh, (float)density, 2 * padding, lightmap->settings.pool, &charts);
        if (result != LMB_OK) {
            return lmb_error_set(work->error, result, "cannot make lightmap charts for mesh '%s': %s", mesh->name,
                                 lmb_result_text(result));
        }
        if (charts.resolution <= (int32_t)room) {
            if (charts_islands_find(work, number, &charts) != LMB_OK) {
                lmb_charts_free(&charts);
                return out_of_memory(work->error);
            }
            lightmap->corner_uv[number] = charts.corner_uv;
            lightmap->chart_count += charts.chart_count;
            charts.corner_uv = NULL;
            work->resolution[number] = charts.resolution;
            work->chart_share[number] = density / asked;
            lmb_charts_free(&charts);
            return LMB_OK;
        }
        density *= 0.95 * room / charts.resolution;
        lmb_charts_free(&charts);
    }
    return lmb_error_set(work->error, LMB_ERROR_UNSUPPORTED,
                         "the lightmap charts of mesh '%s' do not fit an image of %d texels a side", mesh->name,
                         (int)lightmap->settings.max_image_size);
}

/* Decides which UVs a mesh uses. */
static lmb_result mesh_choose_uv(layout_work *work, uint32_t number)
{
    lmb_lightmap *lightmap = work->lightmap;
    const lmb_mesh *mesh = &lightmap->scene->meshes[number];
    const double uv_area = mesh->uv[1] ? mesh_uv_area(mesh, NULL) : 0.0;
    int32_t resolution = MIN_CHECK_RESOLUTION;
    if (uv_area > 0.0 && isfinite(uv_area)) {
        const int32_t density = uv_density(work->most_texels[number], uv_area);
        resolution = density < MIN_CHECK_RESOLUTION   ? MIN_CHECK_RESOLUTION
                     : density > MAX_CHECK_RESOLUTION ? MAX_CHECK_RESOLUTION
                                                      : density;
    }
    lmb_uv_fault fault = LMB_UV_GOOD;
    const lmb_result result = lmb_uv_check(mesh, resolution, &fault);
    if (result != LMB_OK) {
        return lmb_error_set(work->error, result, "cannot check the lightmap UVs of mesh '%s': %s", mesh->name,
                             lmb_result_text(result));
    }
    if (fault == LMB_UV_GOOD && !(uv_area > 0.0)) {
        fault = LMB_UV_DEGENERATE;
    }
    lightmap->fault[number] = fault;
    work->uv_area[number] = uv_area;
    return fault == LMB_UV_GOOD ? own_islands_find(work, number) : mesh_make_charts(work, number);
}

/* The whole texels around a mesh's UVs. */
static lmb_texel_grid mesh_grid(const lmb_lightmap *lightmap, uint32_t number, int32_t density)
{
    const lmb_mesh *mesh = &lightmap->scene->meshes[number];
    double low[2] = {HUGE_VAL, HUGE_VAL};
    double high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        for (int k = 0; k < 3; ++k) {
            const lmb_vec2 uv = lmb_texels_corner_uv(mesh, lightmap->corner_uv[number], t, k);
            low[0] = fmin(low[0], (double)uv.x * density);
            low[1] = fmin(low[1], (double)uv.y * density);
            high[0] = fmax(high[0], (double)uv.x * density);
            high[1] = fmax(high[1], (double)uv.y * density);
        }
    }
    const int32_t x = (int32_t)floor(low[0]);
    const int32_t y = (int32_t)floor(low[1]);
    const int32_t width = (int32_t)ceil(high[0]) - x;
    const int32_t height = (int32_t)ceil(high[1]) - y;
    return (lmb_texel_grid){density, x, y, width > 0 ? width : 1, height > 0 ? height : 1};
}

/* The grid of one instance: as dense as asked for, or as an image holds, and then it says so. */
static lmb_texel_grid instance_grid(const layout_work *work, uint32_t instance)
{
    const lmb_lightmap *lightmap = work->lightmap;
    const uint32_t mesh = lightmap->scene->instances[instance].mesh;
    double *share = &work->losses.density_share[instance];
    if (work->resolution[mesh] > 0) {
        const double smaller = sqrt(work->most_texels[mesh] / work->texels[instance]);
        *share = fmin(work->chart_share[mesh] * smaller, 1.0);
        return mesh_grid(lightmap, mesh, work->resolution[mesh]);
    }
    const int32_t room = lightmap->settings.max_image_size - 2 * lightmap->settings.padding;
    int32_t density = uv_density(work->texels[instance], work->uv_area[mesh]);
    lmb_texel_grid grid = mesh_grid(lightmap, mesh, density);
    while (grid.width > room || grid.height > room) {
        const int32_t longest = grid.width > grid.height ? grid.width : grid.height;
        /* A texel less than in proportion: both ends are rounded outwards. */
        const int32_t lower = (int32_t)((double)density * (room - 1) / longest);
        density = lower < density ? lower : density - 1;
        grid = mesh_grid(lightmap, mesh, density);
    }
    const double asked = sqrt(work->texels[instance] / work->uv_area[mesh]);
    *share = fmin(density / asked, 1.0);
    return grid;
}

/* Sizes and grids of all regions. */
static lmb_result regions_size(const layout_work *work, lmb_texel_grid *grids)
{
    lmb_lightmap *lightmap = work->lightmap;
    uint64_t texels = 0;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        lightmap->region[i] = (lmb_lightmap_region){.image = -1};
        if (!lmb_instance_has_region(lightmap->scene, i)) {
            continue;
        }
        grids[i] = instance_grid(work, i);
        lightmap->region[i].width = grids[i].width;
        lightmap->region[i].height = grids[i].height;
        const int32_t padding = 2 * lightmap->settings.padding;
        texels += (uint64_t)(grids[i].width + padding) * (uint64_t)(grids[i].height + padding);
    }
    if (texels > MAX_TEXELS) {
        const double fewer = 0.9 * (double)lightmap->settings.texels_per_m * sqrt((double)MAX_TEXELS / (double)texels);
        return lmb_error_set(work->error, LMB_ERROR_UNSUPPORTED,
                             "the lightmap would have %llu texels at %g a metre, more than %llu: ask for %.4g a metre",
                             (unsigned long long)texels, (double)lightmap->settings.texels_per_m,
                             (unsigned long long)MAX_TEXELS, fewer);
    }
    return LMB_OK;
}

/* Offsets and scales of packed regions. */
static void regions_place(lmb_lightmap *lightmap, const lmb_texel_grid *grids)
{
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        lmb_lightmap_region *region = &lightmap->region[i];
        if (region->image < 0) {
            continue;
        }
        const double width = lightmap->image[region->image].width;
        const double height = lightmap->image[region->image].height;
        region->scale.x = (float)(grids[i].density / width);
        region->scale.y = (float)(grids[i].density / height);
        region->offset.x = (float)((region->x - grids[i].shift_x) / width);
        region->offset.y = (float)((region->y - grids[i].shift_y) / height);
    }
}

lmb_texel_grid lmb_lightmap_grid(const lmb_lightmap *lightmap, uint32_t instance)
{
    const lmb_lightmap_region *region = &lightmap->region[instance];
    const lmb_lightmap_image *image = &lightmap->image[region->image];
    /* Whole numbers by construction: rounding takes float's error away. */
    return (lmb_texel_grid){
        .density = (int32_t)lround((double)region->scale.x * image->width),
        .shift_x = region->x - (int32_t)lround((double)region->offset.x * image->width),
        .shift_y = region->y - (int32_t)lround((double)region->offset.y * image->height),
        .width = region->width,
        .height = region->height,
    };
}

static bool grid_equals(const lmb_texel_grid *a, const lmb_texel_grid *b)
{
    return a->density == b->density && a->shift_x == b->shift_x && a->shift_y == b->shift_y && a->width == b->width &&
           a->height == b->height;
}

static uint64_t grid_count_covered(const lmb_lightmap *lightmap, uint32_t mesh, const lmb_texel_grid *grid,
                                   lmb_texel_source *source)
{
    lmb_texels_cover(&lightmap->scene->meshes[mesh], lightmap->corner_uv[mesh], grid, source);
    uint64_t covered = 0;
    for (size_t k = 0; k < (size_t)grid->width * (size_t)grid->height; ++k) {
        covered += source[k].triangle != LMB_TEXEL_UNCOVERED;
    }
    return covered;
}

/* Counts covered texels. Instances of a mesh mostly have the grid of the one before. */
static lmb_result covered_count(lmb_lightmap *lightmap)
{
    const lmb_scene *scene = lightmap->scene;
    size_t largest = 1;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const size_t texels = (size_t)lightmap->region[i].width * (size_t)lightmap->region[i].height;
        largest = texels > largest ? texels : largest;
    }
    lmb_texel_source *source = malloc(largest * sizeof *source);
    lmb_texel_grid *last = calloc((size_t)scene->mesh_count + 1u, sizeof *last);
    uint64_t *last_covered = calloc((size_t)scene->mesh_count + 1u, sizeof *last_covered);
    const bool enough = source && last && last_covered;
    for (uint32_t i = 0; enough && i < scene->instance_count; ++i) {
        if (lightmap->region[i].image < 0) {
            continue;
        }
        const uint32_t mesh = scene->instances[i].mesh;
        const lmb_texel_grid grid = lmb_lightmap_grid(lightmap, i);
        if (!grid_equals(&grid, &last[mesh])) {
            last[mesh] = grid;
            last_covered[mesh] = grid_count_covered(lightmap, mesh, &grid, source);
        }
        lightmap->covered_texel_count += last_covered[mesh];
    }
    free(source);
    free(last);
    free(last_covered);
    return enough ? LMB_OK : LMB_ERROR_MEMORY;
}

/* A texel's side in metres, as the mean over each instance. */
static void texel_sizes_find(const layout_work *work)
{
    const lmb_lightmap *lightmap = work->lightmap;
    const lmb_scene *scene = lightmap->scene;
    for (uint32_t m = 0; m < scene->mesh_count; ++m) {
        if (work->most_texels[m] >= 0.0) { /* the others need no UVs, and may have none */
            work->uv_area[m] = mesh_uv_area(&scene->meshes[m], lightmap->corner_uv[m]);
        }
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (lightmap->region[i].image >= 0) {
            const double uv_area = work->uv_area[scene->instances[i].mesh];
            const double size = sqrt(work->instance_area[i] / uv_area) / lmb_lightmap_grid(lightmap, i).density;
            lightmap->region[i].texel_size = isfinite(size) ? (float)size : 0.0f;
        }
    }
}

static lmb_result layout_run(layout_work *work, lmb_texel_grid *grids)
{
    lmb_lightmap *lightmap = work->lightmap;
    const lmb_scene *scene = lightmap->scene;
    for (uint32_t m = 0; m < scene->mesh_count; ++m) {
        work->most_texels[m] = -1.0;
        work->losses.first_instance[m] = UINT32_MAX;
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (lmb_instance_has_region(scene, i)) {
            const uint32_t mesh = scene->instances[i].mesh;
            const double density = lmb_lightmap_density_asked(lightmap, i);
            work->instance_area[i] = lmb_instance_area(scene, i);
            work->texels[i] = work->instance_area[i] * density * density;
            work->most_texels[mesh] = fmax(work->most_texels[mesh], work->texels[i]);
            uint32_t *first = &work->losses.first_instance[mesh];
            *first = *first < i ? *first : i;
        }
    }
    lmb_result result = LMB_OK;
    for (uint32_t m = 0; m < scene->mesh_count && result == LMB_OK; ++m) {
        if (work->most_texels[m] >= 0.0) {
            result = mesh_choose_uv(work, m);
        }
    }
    if (result == LMB_OK) {
        result = regions_size(work, grids);
    }
    if (result != LMB_OK) {
        return result;
    }
    if (lmb_lightmap_pack(lightmap) != LMB_OK) {
        return out_of_memory(work->error);
    }
    regions_place(lightmap, grids);
    texel_sizes_find(work);
    if (covered_count(lightmap) != LMB_OK) {
        return out_of_memory(work->error);
    }
    lmb_lightmap_warn_of_steps(lightmap);
    lmb_lightmap_warn(lightmap, &work->losses);
    return LMB_OK;
}

static bool settings_are_valid(const lmb_lightmap_settings *settings)
{
    const int32_t size = settings->max_image_size;
    return settings->texels_per_m > 0.0f && isfinite(settings->texels_per_m) && size >= MIN_IMAGE_SIZE &&
           size <= MAX_IMAGE_SIZE && (size & (size - 1)) == 0 && settings->padding >= 0 &&
           settings->padding <= LMB_LIGHTMAP_MAX_PADDING && settings->padding < size / 4;
}

lmb_result lmb_lightmap_create(const lmb_scene *scene, const lmb_lightmap_settings *settings, lmb_lightmap **lightmap,
                               lmb_error *error)
{
    if (!settings_are_valid(settings)) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT,
                             "lightmaps need texels per metre > 0, images of a power of two from %d to %d texels, and "
                             "padding of up to %d texels and less than a quarter of an image",
                             MIN_IMAGE_SIZE, MAX_IMAGE_SIZE, (int)LMB_LIGHTMAP_MAX_PADDING);
    }
    if (!lmb_lightmap_textures_are_here(settings->format)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "this build has no %s lightmaps: astcenc was not there",
                             lmb_lightmap_format_name(settings->format));
    }
    if (settings->format != LMB_LIGHTMAP_EXR && settings->model && !lmb_lightmap_textures_hold(settings->model)) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "no textures hold lightmaps in the model %s",
                             settings->model->name);
    }
    const size_t instances = (size_t)scene->instance_count + 1u;
    const size_t meshes = (size_t)scene->mesh_count + 1u;
    lmb_lightmap *created = calloc(1, sizeof *created);
    lmb_texel_grid *grids = calloc(instances, sizeof *grids);
    layout_work work = {
        .lightmap = created,
        .instance_area = calloc(instances, sizeof(double)),
        .texels = calloc(instances, sizeof(double)),
        .most_texels = calloc(meshes, sizeof(double)),
        .uv_area = calloc(meshes, sizeof(double)),
        .resolution = calloc(meshes, sizeof(int32_t)),
        .chart_share = calloc(meshes, sizeof(double)),
        .losses = {calloc(instances, sizeof(double)), calloc(meshes, sizeof(lmb_uv_islands)),
                   calloc(meshes, sizeof(uint32_t))},
        .error = error,
    };
    lmb_result result = LMB_ERROR_MEMORY;
    if (created) {
        created->scene = scene;
        created->settings = *settings;
        created->model = settings->model ? settings->model : lmb_lightmap_default_model(settings->format);
        created->settings.padding = settings->padding > 0 ? settings->padding : 1;
        created->key_light_count = lmb_scene_key_lights(scene, created->key_light);
        created->region = calloc(instances, sizeof *created->region);
        created->corner_uv = calloc(meshes, sizeof *created->corner_uv);
        created->fault = calloc(meshes, sizeof *created->fault);
    }
    if (created && created->region && created->corner_uv && created->fault && grids && work.instance_area &&
        work.texels && work.most_texels && work.uv_area && work.resolution && work.chart_share &&
        work.losses.density_share && work.losses.islands && work.losses.first_instance) {
        result = layout_run(&work, grids);
    } else {
        out_of_memory(error);
    }
    free(grids);
    free(work.instance_area);
    free(work.texels);
    free(work.most_texels);
    free(work.uv_area);
    free(work.resolution);
    free(work.chart_share);
    free(work.losses.density_share);
    free(work.losses.islands);
    free(work.losses.first_instance);
    if (result != LMB_OK) {
        lmb_lightmap_destroy(created);
        return result;
    }
    *lightmap = created;
    return LMB_OK;
}

void lmb_lightmap_destroy(lmb_lightmap *lightmap)
{
    if (!lightmap) {
        return;
    }
    for (uint32_t m = 0; lightmap->corner_uv && m < lightmap->scene->mesh_count; ++m) {
        free(lightmap->corner_uv[m]);
    }
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        free(lightmap->image[i].plane);
        free(lightmap->image[i].state);
        free(lightmap->image[i].error);
        for (int k = 0; k < LMB_LIGHTMAP_MOST_MODELS; ++k) {
            free(lightmap->image[i].other[k]);
        }
    }
    free(lightmap->image);
    free(lightmap->region);
    free(lightmap->corner_uv);
    free(lightmap->fault);
    free(lightmap);
}

size_t lmb_lightmap_largest_region(const lmb_lightmap *lightmap)
{
    size_t largest = 1;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const size_t texels = (size_t)lightmap->region[i].width * (size_t)lightmap->region[i].height;
        largest = texels > largest ? texels : largest;
    }
    return largest;
}
