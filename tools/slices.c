#include "slices.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <lambent/file.h>
#include <lambent/image.h>
#include <lambent/lattice.h>

#include "tonemap.h"

/* Pixels: about so many for the longer side of a picture, and no more than so many for a cell of the finest level. */
enum { SIDE = 1200, CELL_MOST = 48 };

/* Cells that are smaller have no borders, pixels. */
#define BORDER_CELL 6.0

/* A plane of pixels through the world. */
typedef struct view {
    int right, up, along;                /* axes; `along` is the slice's */
    double right_start, up_start, pixel; /* metres */
    double at;
    bool flipped; /* row 0 is the lowest */
    int32_t width, height;
} view;

static const char *const picture_names[SLICE_PICTURES] = {"levels.png", "regions.png", "validity.png",
                                                          "irradiance.png"};

/* World box of all levels. */
static void bounds_of(const lmb_probes *probes, double low[3], double high[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = INFINITY;
        high[axis] = -INFINITY;
        for (uint32_t i = 0; i < probes->level_count; ++i) {
            const lmb_lattice *const lattice = &probes->level[i].lattice;
            const double spacing = (double)lattice->spacing;
            low[axis] = fmin(low[axis], lattice->min[axis] * spacing);
            high[axis] = fmax(high[axis], ((double)lattice->min[axis] + lattice->size[axis] - 1) * spacing);
        }
    }
}

static view view_make(const lmb_probes *probes, const lmb_slice *slice)
{
    view made = {.right = slice->axis == 0 ? 2 : 0, .up = slice->axis == 1 ? 2 : 1, .along = slice->axis};
    double low[3], high[3];
    bounds_of(probes, low, high);
    const double width = high[made.right] - low[made.right], height = high[made.up] - low[made.up];
    const double finest = (double)probes->level[0].lattice.spacing;
    made.pixel = fmax(fmax(width, height) / SIDE, finest / CELL_MOST);
    if (made.pixel < finest) {
        made.pixel = finest / ceil(finest / made.pixel); /* whole pixels to a cell */
    }
    made.width = (int32_t)fmax(1.0, ceil(width / made.pixel - 1e-6));
    made.height = (int32_t)fmax(1.0, ceil(height / made.pixel - 1e-6));
    made.right_start = low[made.right];
    made.up_start = low[made.up];
    made.flipped = made.up == 2;
    /* Not on a face of cells, where it would be up to rounding which ones are seen. */
    made.at = slice->has_at ? slice->at : (floor(0.5 * (low[made.along] + high[made.along]) / finest) + 0.5) * finest;
    return made;
}

static lmb_vec3d view_position(const view *seen, int32_t x, int32_t y)
{
    const int32_t row = seen->flipped ? y : seen->height - 1 - y;
    double at[3];
    at[seen->along] = seen->at;
    at[seen->right] = seen->right_start + (x + 0.5) * seen->pixel;
    at[seen->up] = seen->up_start + (row + 0.5) * seen->pixel;
    return (lmb_vec3d){at[0], at[1], at[2]};
}

static void colour_set(uint8_t *srgb, const uint8_t colour[3], double share, double white)
{
    for (int c = 0; c < 3; ++c) {
        srgb[c] = (uint8_t)lrint(share * (colour[c] + white * (255 - colour[c])));
    }
}

static void level_colour(const lmb_probe_cell *cell, bool border, uint8_t *srgb)
{
    static const uint8_t colours[6][3] = {{214, 73, 51},  {233, 160, 52}, {150, 184, 70},
                                          {52, 152, 142}, {58, 102, 181}, {122, 80, 168}};
    colour_set(srgb, colours[cell->level % 6], border ? 0.6 : 1.0, cell->cut >= 0 ? 0.5 : 0.0);
}

static void region_colour(const lmb_probes *probes, const lmb_probe_cell *cell, bool border, uint8_t *srgb)
{
    static const uint8_t plain[3] = {70, 70, 70}, single[3] = {140, 140, 140};
    static const uint8_t colours[8][3] = {{230, 97, 1},   {94, 60, 153},  {27, 158, 119}, {231, 41, 138},
                                          {102, 166, 30}, {31, 120, 180}, {230, 171, 2},  {166, 118, 29}};
    const bool is_parted = cell->cut >= 0 && probes->cut.cell[cell->cut].plane_count > 0;
    colour_set(srgb, is_parted ? colours[cell->region % 8] : cell->cut >= 0 ? single : plain, border ? 0.6 : 1.0, 0.0);
}

static void validity_colour(const lmb_probes *probes, const lmb_probe_cell *cell, uint8_t *srgb)
{
    const int corner =
        (cell->fraction[0] >= 0.5 ? 1 : 0) | (cell->fraction[1] >= 0.5 ? 2 : 0) | (cell->fraction[2] >= 0.5 ? 4 : 0);
    const int32_t probe = cell->probe[corner];
    const bool is_ghost = probe >= probes->count - probes->ghost_count;
    const uint8_t grey = (uint8_t)lrintf(255.0f * probes->validity[probe]);
    const uint8_t colour[3] = {is_ghost ? grey / 3 : grey, is_ghost ? (uint8_t)(60 + grey / 2) : grey,
                               is_ghost ? (uint8_t)(120 + grey / 2) : grey};
    memcpy(srgb, colour, 3);
}

/* The mean over all normals of normalised irradiance is that of radiance over all directions: Y00 = 1/(2 sqrt(pi))
 * times coefficient 0. */
static void light_of(const lmb_probes *probes, lmb_vec3d at, float rgb[3])
{
    const lmb_sh3_rgb light = lmb_probes_light(probes, 0, at);
    for (int c = 0; c < 3; ++c) {
        rgb[c] = fmaxf(0.28209479f * light.channel[c].c[0], 0.0f);
    }
}

static void pixel_draw(const lmb_probes *probes, const view *seen, int32_t x, int32_t y, const lmb_slice_pictures *to,
                       float *light)
{
    const size_t pixel = 3 * ((size_t)y * (size_t)seen->width + (size_t)x);
    const lmb_vec3d at = view_position(seen, x, y);
    lmb_probe_cell cell;
    if (!lmb_probes_cell(probes, at, &cell)) {
        return;
    }
    const double in_cell = seen->pixel / (double)probes->level[cell.level].lattice.spacing;
    const bool border =
        in_cell * BORDER_CELL < 1.0 && (cell.fraction[seen->right] < in_cell || cell.fraction[seen->up] < in_cell);
    level_colour(&cell, border, &to->srgb[SLICE_LEVELS][pixel]);
    region_colour(probes, &cell, border, &to->srgb[SLICE_REGIONS][pixel]);
    validity_colour(probes, &cell, &to->srgb[SLICE_VALIDITY][pixel]);
    light_of(probes, at, &light[pixel]);
}

lmb_result slice_draw(const lmb_probes *probes, const lmb_slice *slice, lmb_slice_pictures *pictures)
{
    const view seen = view_make(probes, slice);
    const size_t pixels = (size_t)seen.width * (size_t)seen.height;
    lmb_slice_pictures made = {.width = seen.width, .height = seen.height, .at = seen.at};
    float *const light = calloc(3 * pixels, sizeof *light);
    bool good = light != NULL;
    for (int i = 0; i < SLICE_PICTURES; ++i) {
        made.srgb[i] = calloc(pixels, 3);
        good = good && made.srgb[i];
    }
    for (int32_t y = 0; good && y < seen.height; ++y) {
        for (int32_t x = 0; x < seen.width; ++x) {
            pixel_draw(probes, &seen, x, y, &made, light);
        }
    }
    if (good) {
        picture_tonemap(light, pixels, exposure_of_picture(light, pixels), made.srgb[SLICE_IRRADIANCE]);
        *pictures = made;
    } else {
        slice_free(&made);
    }
    free(light);
    return good ? LMB_OK : LMB_ERROR_MEMORY;
}

void slice_free(lmb_slice_pictures *pictures)
{
    for (int i = 0; i < SLICE_PICTURES; ++i) {
        free(pictures->srgb[i]);
    }
    *pictures = (lmb_slice_pictures){0};
}

lmb_result slice_write(const lmb_slice_pictures *pictures, const char *folder, lmb_error *error)
{
    if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot be made: %s", folder, strerror(errno));
    }
    lmb_result result = LMB_OK;
    for (int i = 0; result == LMB_OK && i < SLICE_PICTURES; ++i) {
        char *const path = lmb_file_in(folder, picture_names[i]);
        result = path ? lmb_png_write(path, pictures->width, pictures->height, pictures->srgb[i], error)
                      : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
        free(path);
    }
    return result;
}
