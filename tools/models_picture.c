#include "models_picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

#include <stb_image_write.h>

#include "tonemap.h"

/* Pixels of a disc, and of a cell of two. */
enum { DISC = 88, CELL_WIDTH = 2 * DISC, DISC_PIXELS = DISC * DISC, TRIED_TURNS = 15 };

/* The relative difference that is shown in full colour. */
#define FULL_DIFFERENCE 0.3f

static const lmb_vec3 up = {0.0f, 0.0f, 1.0f};

/* Discs from above, x to the right, y up; false outside. */
static bool disc_normal(int pixel, lmb_vec3 *normal)
{
    const float x = (float)(2 * (pixel % DISC) + 1) / DISC - 1.0f, y = 1.0f - (float)(2 * (pixel / DISC) + 1) / DISC;
    const float flat = x * x + y * y;
    *normal = lmb_vec3_of(x, y, sqrtf(lmb_larger(1.0f - flat, 0.0f)));
    return flat < 1.0f;
}

static lmb_rgb disc_truth(const models_turn *turn, lmb_vec3 normal)
{
    double sum[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < turn->light_count; ++i) {
        const float cosine = lmb_larger(lmb_vec3_dot(turn->light[i].direction, normal), 0.0f);
        for (int c = 0; c < 3; ++c) {
            sum[c] += (double)(cosine * turn->light[i].weight.c[c]) / LMB_PI;
        }
    }
    return lmb_rgb_of((float)sum[0], (float)sum[1], (float)sum[2]);
}

/* All cells of a picture, one below the other: the truth and its empty difference, then the models. */
typedef struct sheet {
    int cells;
    uint8_t *srgb;
    lmb_rgb *truth; /* [pixel of a disc] */
    float mean;     /* luminance of it */
} sheet;

static uint8_t *sheet_pixel(const sheet *all, int cell, int side, int pixel)
{
    const size_t row = (size_t)(cell * DISC + pixel / DISC);
    return &all->srgb[3 * (row * CELL_WIDTH + (size_t)(side * DISC + pixel % DISC))];
}

/* Light whose mean is shown at a third, and the difference of its luminance from the truth. */
static void cell_draw(const sheet *all, int cell, const lmb_rgb *light)
{
    for (int i = 0; i < DISC_PIXELS; ++i) {
        lmb_vec3 normal;
        uint8_t *const shown = sheet_pixel(all, cell, 0, i), *const off = sheet_pixel(all, cell, 1, i);
        memset(shown, 255, 3);
        memset(off, 255, 3);
        if (!disc_normal(i, &normal)) {
            continue;
        }
        float difference[3];
        for (int c = 0; c < 3; ++c) {
            shown[c] = srgb_of_linear(tone_curve(light[i].c[c] / (3.0f * all->mean)));
            difference[c] = (light[i].c[c] - all->truth[i].c[c]) / all->mean;
        }
        picture_difference_colour(difference, 1, FULL_DIFFERENCE, off);
    }
}

static void model_draw(const sheet *all, int cell, const lmb_model *model, const lmb_sh3_rgb *sh3)
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    lmb_rgb *const light = calloc(DISC_PIXELS, sizeof *light);
    if (!light) {
        return;
    }
    model->encode(sh3, up, 0.0f, channel);
    for (int i = 0; i < DISC_PIXELS; ++i) {
        lmb_vec3 normal;
        if (disc_normal(i, &normal)) {
            model->evaluate(channel, up, &normal, 1, &light[i]);
        }
    }
    cell_draw(all, cell, light);
    free(light);
}

static double turn_error(const models_turn *turn, const lmb_model *model, models_input input,
                         const lmb_vec3 normal[MODELS_NORMAL_COUNT])
{
    lmb_rgb found[MODELS_NORMAL_COUNT];
    double error = 0.0, reference = 0.0;
    models_apply(model, input, turn, normal, found);
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        const double own = (double)lmb_luminance(turn->reference[i]), off = (double)lmb_luminance(found[i]) - own;
        error += off * off;
        reference += own * own;
    }
    return reference > 0.0 ? sqrt(error / reference) : 0.0;
}

typedef struct tried_turn {
    double error;
    uint32_t index;
} tried_turn;

static int compare_tried(const void *a, const void *b)
{
    const tried_turn *x = a, *y = b;
    return (x->error > y->error) - (x->error < y->error);
}

/* Leaves the turn of the median error in `turn`. */
static tried_turn typical_turn(models_turn *turn, const models_settings *settings, const models_map *map,
                               models_input input)
{
    lmb_vec3 normal[MODELS_NORMAL_COUNT];
    models_normals(normal);
    const lmb_model *model =
        lmb_model_default(input == MODELS_LIGHTMAP ? LMB_MODEL_FOR_LIGHTMAP : LMB_MODEL_FOR_SURFACE);
    tried_turn tried[TRIED_TURNS];
    for (uint32_t i = 0; i < TRIED_TURNS; ++i) {
        models_turn_fill(turn, map, normal, i, settings->seed);
        tried[i] = (tried_turn){turn_error(turn, model, input, normal), i};
    }
    qsort(tried, TRIED_TURNS, sizeof *tried, compare_tried);
    models_turn_fill(turn, map, normal, tried[TRIED_TURNS / 2].index, settings->seed);
    return tried[TRIED_TURNS / 2];
}

/* Takes the whole PNG at once and writes it in base 64. */
static void png_take(void *context, void *data, int size)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    FILE *const page = context;
    const unsigned char *const bytes = data;
    for (int i = 0; i < size; i += 3) {
        const int left = size - i;
        const unsigned group = (unsigned)bytes[i] << 16 | (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0u) |
                               (left > 2 ? (unsigned)bytes[i + 2] : 0u);
        fputc(letters[group >> 18], page);
        fputc(letters[group >> 12 & 63u], page);
        fputc(left > 1 ? letters[group >> 6 & 63u] : '=', page);
        fputc(left > 2 ? letters[group & 63u] : '=', page);
    }
}

static bool model_is_shown(const lmb_model *model, models_input input)
{
    return model->encode && models_row_exists(model, input);
}

static lmb_result sheet_draw(sheet *all, const models_turn *turn, models_input input)
{
    double sum = 0.0;
    int inside = 0;
    for (int i = 0; i < DISC_PIXELS; ++i) {
        lmb_vec3 normal;
        if (disc_normal(i, &normal)) {
            all->truth[i] = disc_truth(turn, normal);
            sum += (double)lmb_luminance(all->truth[i]);
            ++inside;
        }
    }
    all->mean = lmb_larger((float)(sum / inside), 1e-30f);
    cell_draw(all, 0, all->truth);
    int cell = 1;
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        if (model_is_shown(lmb_model_at(i), input)) {
            model_draw(all, cell++, lmb_model_at(i), &turn->sh3[input]);
        }
    }
    return LMB_OK;
}

/* The picture as a style, and a cell of the page for each of its cells. */
static lmb_result sheet_write(FILE *page, int id, const sheet *all, models_input input)
{
    fprintf(page, "<style>.p%d{background-image:url(data:image/png;base64,", id);
    if (!stbi_write_png_to_func(png_take, page, CELL_WIDTH, all->cells * DISC, 3, all->srgb, 3 * CELL_WIDTH)) {
        return LMB_ERROR_MEMORY;
    }
    fprintf(page, ");width:%dpx;height:%dpx}</style>\n<div class=cells>\n", CELL_WIDTH, DISC);
    fprintf(page, "<figure><div class=p%d></div><figcaption>truth</figcaption></figure>\n", id);
    int cell = 1;
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        if (model_is_shown(lmb_model_at(i), input)) {
            fprintf(page,
                    "<figure><div class=p%d style='background-position:0 -%dpx'></div><figcaption>%s</figcaption>"
                    "</figure>\n",
                    id, DISC * cell++, lmb_model_full_name(lmb_model_at(i)));
        }
    }
    fputs("</div>\n", page);
    return LMB_OK;
}

lmb_result models_picture_write(FILE *page, int id, const models_settings *settings, const models_map *map,
                                models_input input)
{
    sheet all = {.cells = 1};
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        all.cells += model_is_shown(lmb_model_at(i), input) ? 1 : 0;
    }
    models_turn *const turn = malloc(sizeof *turn);
    all.srgb = malloc((size_t)(3 * CELL_WIDTH * DISC) * (size_t)all.cells);
    all.truth = calloc(DISC_PIXELS, sizeof *all.truth);
    lmb_result result = turn && all.srgb && all.truth ? LMB_OK : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        const tried_turn taken = typical_turn(turn, settings, map, input);
        fprintf(page, "<p>%s, turn %u: the default model is off by %.1f %%.</p>\n", models_input_name(input),
                taken.index, 100.0 * taken.error);
        result = sheet_draw(&all, turn, input);
    }
    if (result == LMB_OK) {
        result = sheet_write(page, id, &all, input);
    }
    free(turn);
    free(all.srgb);
    free(all.truth);
    return result;
}
