#include "level_blocks.h"

#include "level_builder_internal.h"

#include <stdlib.h>

/* The cells between the planes on which the blocks begin and end. */
typedef struct block_grid {
    const lmb_level_block *blocks;
    float *plane[3]; /* sorted, each once */
    size_t plane_count[3];
    int *owner; /* [cell] the last block that covers it, or -1 */
} block_grid;

static float axis_of(lmb_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static void set_axis(lmb_vec3 *v, int axis, float value)
{
    *(axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z) = value;
}

static int compare_floats(const void *left, const void *right)
{
    const float a = *(const float *)left;
    const float b = *(const float *)right;
    return (a > b) - (a < b);
}

static bool find_planes(block_grid *grid, int axis, size_t count)
{
    float *planes = malloc((2 * count + 1) * sizeof *planes);
    if (!planes) {
        return false;
    }
    for (size_t i = 0; i < count; ++i) {
        planes[2 * i] = axis_of(grid->blocks[i].min, axis);
        planes[2 * i + 1] = axis_of(grid->blocks[i].max, axis);
    }
    qsort(planes, 2 * count, sizeof *planes, compare_floats);
    size_t kept = 0;
    for (size_t i = 0; i < 2 * count; ++i) {
        if (kept == 0 || planes[i] > planes[kept - 1]) {
            planes[kept++] = planes[i];
        }
    }
    grid->plane[axis] = planes;
    grid->plane_count[axis] = kept;
    return true;
}

/* The last block that covers a cell, or -1 when there is none or the cell lies outside the grid. */
static int owner_at(const block_grid *grid, const size_t cell[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        if (cell[axis] >= grid->plane_count[axis] - 1) { /* also below the first plane, where the index has wrapped */
            return -1;
        }
    }
    return grid->owner[(cell[2] * grid->plane_count[1] + cell[1]) * grid->plane_count[0] + cell[0]];
}

static bool covers(const block_grid *grid, const lmb_level_block *block, const size_t cell[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        const float low = grid->plane[axis][cell[axis]];
        if (low < axis_of(block->min, axis) || low >= axis_of(block->max, axis)) {
            return false;
        }
    }
    return true;
}

static bool find_owners(block_grid *grid, size_t count)
{
    const size_t *planes = grid->plane_count;
    grid->owner = malloc((planes[0] * planes[1] * planes[2] + 1) * sizeof *grid->owner);
    if (!grid->owner) {
        return false;
    }
    for (size_t z = 0; z < planes[2]; ++z) {
        for (size_t y = 0; y < planes[1]; ++y) {
            for (size_t x = 0; x < planes[0]; ++x) {
                const size_t cell[3] = {x, y, z};
                int owner = (int)count - 1;
                while (owner >= 0 && !covers(grid, &grid->blocks[owner], cell)) {
                    --owner;
                }
                grid->owner[(z * planes[1] + y) * planes[0] + x] = owner;
            }
        }
    }
    return true;
}

/* The face on the lower side of a cell along `axis`: 0 where there is none, else 1 + material, negative when it looks
 * down the axis. */
static int face_below(const block_grid *grid, int axis, const size_t cell[3])
{
    size_t below_cell[3] = {cell[0], cell[1], cell[2]};
    --below_cell[axis];
    const int below = owner_at(grid, below_cell);
    const int above = owner_at(grid, cell);
    const bool solid_below = below >= 0 && grid->blocks[below].solid;
    const bool solid_above = above >= 0 && grid->blocks[above].solid;
    if (solid_below == solid_above) {
        return 0;
    }
    const int material =
        below > above ? grid->blocks[below].material[2 * axis + 1] : grid->blocks[above].material[2 * axis];
    return solid_below ? 1 + material : -(1 + material);
}

/* The cells from one to another, both included. */
typedef struct cell_range {
    size_t from[3], to[3];
} cell_range;

/* Emits a rectangle of cells of a plane across `axis`. */
static void add_face(lmb_level_builder *builder, int mesh, const block_grid *grid, int axis, const cell_range *cells,
                     int face)
{
    lmb_level_box box = {
        .material = {LMB_LEVEL_NONE, LMB_LEVEL_NONE, LMB_LEVEL_NONE, LMB_LEVEL_NONE, LMB_LEVEL_NONE, LMB_LEVEL_NONE}};
    for (int i = 0; i < 3; ++i) {
        set_axis(&box.min, i, grid->plane[i][cells->from[i]]);
        set_axis(&box.max, i, grid->plane[i][i == axis ? cells->from[i] : cells->to[i] + 1]);
    }
    box.material[2 * axis + (face > 0 ? 1 : 0)] = abs(face) - 1;
    level_add_box(builder, mesh, &box, true);
}

/* Joins equal faces of one plane into rectangles: along a first, then along b. `faces` is the plane, width cells wide.
 */
static void add_plane(lmb_level_builder *builder, int mesh, const block_grid *grid, int axis, size_t plane, int *faces)
{
    const int a = (axis + 1) % 3;
    const int b = (axis + 2) % 3;
    const size_t width = grid->plane_count[a] - 1;
    const size_t height = grid->plane_count[b] - 1;
    size_t cell[3] = {0};
    cell[axis] = plane;
    for (cell[b] = 0; cell[b] < height; ++cell[b]) {
        for (cell[a] = 0; cell[a] < width; ++cell[a]) {
            faces[cell[b] * width + cell[a]] = face_below(grid, axis, cell);
        }
    }
    for (size_t start = 0; start < width * height; ++start) {
        const int face = faces[start];
        const size_t a0 = start % width;
        const size_t b0 = start / width;
        size_t a1 = a0;
        size_t b1 = b0;
        if (face == 0) {
            continue;
        }
        while (a1 + 1 < width && faces[b0 * width + a1 + 1] == face) {
            ++a1;
        }
        for (bool same = true; same && b1 + 1 < height;) {
            for (size_t i = a0; i <= a1 && same; ++i) {
                same = faces[(b1 + 1) * width + i] == face;
            }
            b1 += same ? 1 : 0;
        }
        for (size_t j = b0; j <= b1; ++j) {
            for (size_t i = a0; i <= a1; ++i) {
                faces[j * width + i] = 0;
            }
        }
        cell_range cells;
        cells.from[axis] = cells.to[axis] = plane;
        cells.from[a] = a0;
        cells.from[b] = b0;
        cells.to[a] = a1;
        cells.to[b] = b1;
        add_face(builder, mesh, grid, axis, &cells, face);
    }
}

lmb_level_block lmb_level_block_of(bool solid, lmb_vec3 min, lmb_vec3 max, int material)
{
    return (lmb_level_block){min, max, solid, {material, material, material, material, material, material}};
}

void lmb_level_builder_add_blocks(lmb_level_builder *builder, int mesh, const lmb_level_block *blocks, size_t count)
{
    if (!builder || count == 0) {
        return;
    }
    block_grid grid = {.blocks = blocks};
    int *faces = NULL;
    bool ready = true;
    size_t largest = 1;
    for (int axis = 0; axis < 3 && ready; ++axis) {
        ready = find_planes(&grid, axis, count);
    }
    ready = ready && find_owners(&grid, count);
    for (int axis = 0; axis < 3 && ready; ++axis) {
        const size_t cells = grid.plane_count[axis] * grid.plane_count[(axis + 1) % 3];
        largest = cells > largest ? cells : largest;
    }
    faces = ready ? malloc(largest * sizeof *faces) : NULL;
    builder->failed |= faces == NULL;
    for (int axis = 0; axis < 3 && faces; ++axis) {
        for (size_t plane = 0; plane < grid.plane_count[axis]; ++plane) {
            add_plane(builder, mesh, &grid, axis, plane, faces);
        }
    }
    free(faces);
    free(grid.owner);
    for (int axis = 0; axis < 3; ++axis) {
        free(grid.plane[axis]);
    }
}
