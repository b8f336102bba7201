/* Dividing triangles into cells, and finding cells. */
#include "surface/surface_light_internal.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/surface.h>
#include <lambent/vector.h>

#include "surface/bright_cells.h"

enum { MAX_DIVISIONS = 16383, MAX_TRIANGLES = 1 << 24, MAX_CELLS = 1 << 30 };

/* The search for a cell size goes this far below the longest edge, to a precision of 1/256 octave. */
enum { SEARCH_OCTAVES = 16, SEARCH_STEPS = 12 };

/* Longest and shortest edge of a triangle. */
typedef struct edge_range {
    float longest;
    float shortest;
} edge_range;

static edge_range edges_measure(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle, uint32_t *apex)
{
    lmb_vec3 corner[3];
    lmb_trace_corners(tracer, instance, triangle, corner);
    edge_range range = {0.0f, INFINITY};
    *apex = 0;
    for (uint32_t k = 0; k < 3; ++k) {
        const float opposite = lmb_vec3_length(lmb_vec3_sub(corner[(k + 1) % 3], corner[(k + 2) % 3]));
        range.longest = fmaxf(range.longest, opposite);
        if (opposite < range.shortest) {
            range.shortest = opposite;
            *apex = k;
        }
    }
    return range;
}

static uint32_t divisions(float length, float cell_size)
{
    const float count = ceilf(length / cell_size);
    return count >= (float)MAX_DIVISIONS ? MAX_DIVISIONS : count > 1.0f ? (uint32_t)count : 1;
}

/* Cells beyond the first of each triangle. */
static uint64_t extra_cells(const edge_range *edges, uint32_t count, float cell_size)
{
    uint64_t cells = 0;
    for (uint32_t i = 0; i < count; ++i) {
        cells += (uint64_t)divisions(edges[i].longest, cell_size) * divisions(edges[i].shortest, cell_size) - 1;
    }
    return cells;
}

static float cell_size_choose(const edge_range *edges, uint32_t count, float cell_size, uint32_t max_cells)
{
    float longest = 0.0f;
    for (uint32_t i = 0; i < count; ++i) {
        longest = fmaxf(longest, edges[i].longest);
    }
    if (!(longest > 0.0f)) {
        return 1.0f;
    }
    if (cell_size > 0.0f && extra_cells(edges, count, cell_size) <= max_cells) {
        return cell_size;
    }
    float high = longest;
    float low = fmaxf(ldexpf(longest, -SEARCH_OCTAVES), cell_size);
    for (int step = 0; step < SEARCH_STEPS && low < high; ++step) {
        const float middle = sqrtf(low) * sqrtf(high);
        if (extra_cells(edges, count, middle) <= max_cells) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}

static bool triangles_count(lmb_surface_light *light, const lmb_scene *scene)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        light->triangle_first[i] = (uint32_t)count;
        if (!scene->instances[i].dynamic) {
            count += scene->meshes[scene->instances[i].mesh].triangle_count;
        }
        if (count > MAX_TRIANGLES) {
            return false;
        }
    }
    light->triangle_first[scene->instance_count] = (uint32_t)count;
    light->triangle_count = (uint32_t)count;
    return true;
}

static lmb_result triangles_divide(lmb_surface_light *light, const lmb_tracer *tracer, float cell_size,
                                   uint32_t max_cells)
{
    edge_range *edges = malloc((light->triangle_count + 1u) * sizeof *edges);
    if (!edges) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < light->instance_count; ++i) {
        for (uint32_t t = light->triangle_first[i]; t < light->triangle_first[i + 1]; ++t) {
            uint32_t apex;
            edges[t] = edges_measure(tracer, i, t - light->triangle_first[i], &apex);
            light->grid[t].apex = apex & 3u;
        }
    }
    light->cell_size = cell_size_choose(edges, light->triangle_count, cell_size, max_cells);
    for (uint32_t t = 0; t < light->triangle_count; ++t) {
        lmb_cell_grid *grid = &light->grid[t];
        grid->first = light->cell_count;
        grid->strips = divisions(edges[t].longest, light->cell_size) & MAX_DIVISIONS;
        grid->columns = divisions(edges[t].shortest, light->cell_size) & MAX_DIVISIONS;
        grid->cell_size = fmaxf(edges[t].longest / (float)grid->strips, edges[t].shortest / (float)grid->columns);
        light->cell_count += grid->strips * grid->columns;
    }
    light->grid[light->triangle_count].first = light->cell_count;
    free(edges);
    return LMB_OK;
}

lmb_result lmb_surface_light_allocate(lmb_surface_light *light)
{
    const size_t patches = (size_t)lmb_patch_count(light) + 1;
    light->irradiance = calloc(patches, sizeof *light->irradiance);
    light->radiance = calloc(patches, sizeof *light->radiance);
    light->openness = calloc(patches, sizeof *light->openness);
    return light->irradiance && light->radiance && light->openness ? LMB_OK : LMB_ERROR_MEMORY;
}

lmb_result lmb_surface_light_create(const lmb_tracer *tracer, float cell_size, uint32_t max_cells,
                                    lmb_surface_light **light, lmb_error *error)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    if (max_cells > MAX_CELLS - MAX_TRIANGLES) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "surface light: %u cells are too many", max_cells);
    }
    lmb_surface_light *created = calloc(1, sizeof *created);
    if (!created) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    created->instance_count = scene->instance_count;
    created->triangle_first = malloc((scene->instance_count + 1u) * sizeof *created->triangle_first);
    lmb_result result = created->triangle_first ? LMB_OK : LMB_ERROR_MEMORY;
    if (result == LMB_OK && !triangles_count(created, scene)) {
        lmb_surface_light_destroy(created);
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: more than %d triangles are too many to solve light for",
                             scene->path, MAX_TRIANGLES);
    }
    if (result == LMB_OK) {
        created->grid = calloc(created->triangle_count + 1u, sizeof *created->grid);
        created->albedo = calloc(created->triangle_count + 1u, sizeof *created->albedo);
        result = created->grid && created->albedo ? triangles_divide(created, tracer, cell_size, max_cells)
                                                  : LMB_ERROR_MEMORY;
    }
    if (result != LMB_OK) {
        lmb_surface_light_destroy(created);
        return lmb_error_set(error, result, "out of memory for surface light");
    }
    *light = created;
    return LMB_OK;
}

void lmb_surface_light_destroy(lmb_surface_light *light)
{
    if (light) {
        free(light->triangle_first);
        free(light->grid);
        free(light->albedo);
        free(light->first_piece);
        free(light->piece);
        free(light->irradiance);
        free(light->radiance);
        free(light->openness);
        free(light->sun);
        lmb_bright_cells_destroy(light->bright);
        free(light);
    }
}

size_t lmb_surface_light_bytes(const lmb_surface_light *light)
{
    return sizeof *light + (light->instance_count + 1u) * sizeof *light->triangle_first +
           (light->triangle_count + 1u) * (sizeof *light->grid + sizeof *light->albedo) +
           (light->first_piece ? 2 * (size_t)light->cell_count * sizeof *light->first_piece : 0) +
           light->piece_count * sizeof *light->piece +
           ((size_t)lmb_patch_count(light) + 1) * (sizeof *light->irradiance + sizeof *light->radiance +
                                                   sizeof *light->openness + (light->sun ? sizeof *light->sun : 0)) +
           lmb_bright_cells_bytes(light->bright);
}

float lmb_surface_light_cell_size(const lmb_surface_light *light)
{
    return light->cell_size;
}

bool lmb_surface_light_at(const lmb_surface_light *light, const lmb_tracer *tracer, const lmb_hit *hit, bool front,
                          lmb_rgb *irradiance)
{
    uint64_t rays = 0;
    uint32_t patch;
    if (!lmb_surface_light_patch(light, tracer, hit, front, &rays, &patch)) {
        return false;
    }
    *irradiance = light->irradiance[patch];
    return true;
}

/* The last of `count` rising values that is not above `target`; stride in bytes. */
static uint32_t last_not_above(const uint32_t *first, size_t stride, uint32_t count, uint32_t target)
{
    uint32_t low = 0;
    uint32_t high = count - 1;
    while (low < high) {
        const uint32_t middle = low + (high - low + 1) / 2;
        const uint32_t *at = (const uint32_t *)(const void *)((const char *)first + middle * stride);
        if (*at <= target) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    return low;
}

lmb_cell lmb_cell_find(const lmb_surface_light *light, uint32_t cell)
{
    const uint32_t triangle = last_not_above(&light->grid[0].first, sizeof *light->grid, light->triangle_count, cell);
    /* Instances without triangles begin where the next one does: the last of them is the one that has it. */
    const uint32_t instance =
        last_not_above(light->triangle_first, sizeof *light->triangle_first, light->instance_count, triangle);
    return (lmb_cell){instance, triangle - light->triangle_first[instance], cell - light->grid[triangle].first,
                      &light->grid[triangle]};
}

lmb_cell_part lmb_cell_part_of(const lmb_cell *cell)
{
    const lmb_cell_grid *grid = cell->grid;
    return (lmb_cell_part){.strip = (float)(cell->index / grid->columns),
                           .strips = (float)grid->strips,
                           .column = (float)(cell->index % grid->columns),
                           .columns = (float)grid->columns};
}

lmb_hit lmb_cell_point(const lmb_cell *cell, const float u[2])
{
    const uint32_t apex = cell->grid->apex;
    const lmb_cell_part part = lmb_cell_part_of(cell);
    float along, across;
    lmb_cell_part_point(&part, u, &along, &across);
    float weight[3];
    weight[apex] = 1.0f - along;
    weight[(apex + 1) % 3] = along * (1.0f - across);
    weight[(apex + 2) % 3] = along * across;
    return (lmb_hit){.instance = cell->instance, .triangle = cell->triangle, .u = weight[1], .v = weight[2]};
}

float lmb_cell_area(const lmb_cell *cell, const lmb_tracer *tracer)
{
    const lmb_cell_grid *grid = cell->grid;
    const float strip = (float)(cell->index / grid->columns);
    const float strips = (float)grid->strips;
    const float share = (2.0f * strip + 1.0f) / (strips * strips * (float)grid->columns);
    return lmb_trace_triangle_area(tracer, cell->instance, cell->triangle) * share;
}

float lmb_patch_area(const lmb_surface_light *light, const lmb_tracer *tracer, const lmb_cell *cell, uint32_t patch)
{
    const float area = lmb_cell_area(cell, tracer);
    const uint32_t sides = 2 * light->cell_count;
    if (patch < sides) {
        return area;
    }
    return area * (float)__builtin_popcount(light->piece[patch - sides].starts) / LMB_CELL_STARTS;
}

double lmb_surface_light_mean(const lmb_surface_light *light, const lmb_tracer *tracer)
{
    double sum = 0.0;
    double total = 0.0;
    for (uint32_t patch = 0; patch < lmb_patch_count(light); ++patch) {
        const double luminance = (double)lmb_luminance(light->irradiance[patch]);
        if (!(luminance > 0.0)) {
            continue;
        }
        const lmb_cell cell = lmb_cell_find(light, lmb_patch_side(light, patch) / 2);
        const double area = (double)lmb_patch_area(light, tracer, &cell, patch);
        if (isfinite(luminance * area)) {
            sum += luminance * area;
            total += area;
        }
    }
    return total > 0.0 ? sum / total : 0.0;
}
