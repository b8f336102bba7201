/* Cobbles under a lightmap with directions, by a normal map and by a self-shadowed bump map:
 *
 *     lambent_bump_picture ENV... -o OUT.png
 *
 * ENV as --env takes it, a picture or daylight; a row for each. From left to right: the height map, the self-shadowed
 * bump map, one lightmap without bumps, radiosity normal mapping by the normal map, by the self-shadowed bump map, and
 * the truth (bump_truth.h). Prints what each is off, and how much more a normal map would be right with light that is
 * exact but for shadows: relative root mean square errors of luminance, as they are and with the truth's mean. Then
 * what lmb_self_bounce has of the light from bump to bump, which the picture leaves out, at an albedo of 0.8, and the
 * CPU time of lmb_ssbump_evaluate. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/hhd.h>
#include <lambent/image.h>
#include <lambent/sequence.h>
#include <lambent/ssbump.h>
#include <lambent/vector.h>

#include "bump_truth.h"
#include "cpu_time.h"
#include "tonemap.h"

enum { SIDE = 192, TEXELS = SIDE * SIDE, STONES = 6, MOST_ROWS = 4, BOUNCES = 4, BOUNCE_SAMPLES = 64 };

typedef enum bump_column {
    COLUMN_HEIGHT,
    COLUMN_SSBUMP,
    COLUMN_FLAT,
    COLUMN_NORMAL_MAP,
    COLUMN_SHADOWED,
    COLUMN_TRUTH,
    COLUMNS,
    WITHOUT_SHADOWS = COLUMNS /* measured only */
} bump_column;

static const char *const COLUMN_NAME[COLUMNS + 1] = {
    NULL, NULL, "no bumps", "normal map", "self-shadowed bump map", NULL, "normal map, exact light"};

typedef struct bump_picture {
    bump_floor bumps;
    float height[TEXELS];
    uint8_t ssbump[3 * TEXELS];
    lmb_rgb lit[COLUMNS + 1][TEXELS];
    uint8_t srgb[3 * COLUMNS * MOST_ROWS * TEXELS];
} bump_picture;

/* Where a stone of a grid lies, which repeats. */
static void stone_place(int column, int row, float place[2])
{
    const int across = (column + STONES) % STONES, down = (row + STONES) % STONES;
    float u[2];
    lmb_sequence_2d((uint64_t)(across + STONES * down), 5, 0, u);
    place[0] = ((float)column + 0.2f + 0.6f * u[0]) * SIDE / STONES;
    place[1] = ((float)row + 0.2f + 0.6f * u[1]) * SIDE / STONES;
}

/* A stone rises from where two are equally near, and is round on top. */
static void cobbles_make(float *height)
{
    for (int i = 0; i < TEXELS; ++i) {
        const float x = (float)(i % SIDE), y = (float)(i / SIDE);
        float nearest = INFINITY, second = INFINITY;
        for (int k = 0; k < 25; ++k) {
            float at[2];
            stone_place((int)x * STONES / SIDE + k % 5 - 2, (int)y * STONES / SIDE + k / 5 - 2, at);
            const float distance = hypotf(x - at[0], y - at[1]);
            second = distance < nearest ? nearest : lmb_smaller(second, distance);
            nearest = lmb_smaller(nearest, distance);
        }
        const float rise = lmb_saturate((second - nearest) / 20.0f);
        height[i] = sqrtf(rise * (2.0f - rise));
    }
}

static void row_light(bump_picture *picture, const specular_light *light)
{
    lmb_vec3 slope[LMB_RNM_SLOPES];
    const lmb_rnm rnm = bump_slope_light(light, slope);
    static float flat[TEXELS];
    const bump_floor level = {{SIDE, SIDE, flat}, 0.0f};
    const lmb_rgb no_bumps = bump_irradiance(&level, light, 0, 0, false);
    for (int i = 0; i < TEXELS; ++i) {
        const uint8_t *texel = picture->ssbump + 3 * i;
        const lmb_rgb weight = lmb_rgb_scale(lmb_rgb_of(texel[0], texel[1], texel[2]), 1.0f / 255.0f);
        const int x = i % SIDE, y = i / SIDE;
        picture->lit[COLUMN_HEIGHT][i] = lmb_rgb_of(picture->height[i], picture->height[i], picture->height[i]);
        picture->lit[COLUMN_SSBUMP][i] = weight;
        picture->lit[COLUMN_FLAT][i] = no_bumps;
        picture->lit[COLUMN_NORMAL_MAP][i] = lmb_rnm_evaluate(&rnm, slope, bump_normal(&picture->bumps, x, y));
        picture->lit[COLUMN_SHADOWED][i] = lmb_ssbump_evaluate(&rnm, weight);
        picture->lit[COLUMN_TRUTH][i] = bump_irradiance(&picture->bumps, light, x, y, true);
        picture->lit[WITHOUT_SHADOWS][i] = bump_irradiance(&picture->bumps, light, x, y, false);
    }
}

static void errors_print(const char *name, const lmb_rgb *lit, const lmb_rgb *truths)
{
    double mean[2] = {0.0, 0.0}, squares = 0.0, as_bright = 0.0, all = 0.0;
    for (int i = 0; i < TEXELS; ++i) {
        mean[0] += (double)lmb_luminance(lit[i]) / TEXELS;
        mean[1] += (double)lmb_luminance(truths[i]) / TEXELS;
    }
    for (int i = 0; i < TEXELS; ++i) {
        const double found = (double)lmb_luminance(lit[i]), truth = (double)lmb_luminance(truths[i]);
        squares += pow(found - truth, 2.0);
        as_bright += pow(found * mean[1] / mean[0] - truth, 2.0);
        all += truth * truth;
    }
    printf("%-28s%8.3f%8.3f\n", name, sqrt(squares / all), sqrt(as_bright / all));
}

/* Of the truth's own direct light, with the bounce of one number for the floor and without. */
static lmb_result bounce_print(const bump_picture *picture)
{
    static lmb_rgb truth[TEXELS], bounced[TEXELS];
    const lmb_rgb albedo = {{0.8f, 0.8f, 0.8f}};
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    memcpy(truth, picture->lit[COLUMN_TRUTH], sizeof truth);
    const lmb_result result = bump_bounces_add(&picture->bumps, albedo.c[0], BOUNCE_SAMPLES, BOUNCES, truth);
    for (int i = 0; i < TEXELS; ++i) {
        const lmb_vec3 normal = bump_normal(&picture->bumps, i % SIDE, i / SIDE);
        const lmb_rgb bounce = lmb_self_bounce(albedo, picture->lit[COLUMN_FLAT][i], up, normal);
        bounced[i] = lmb_rgb_add(picture->lit[COLUMN_TRUTH][i], bounce);
    }
    errors_print("truth without bounces", picture->lit[COLUMN_TRUTH], truth);
    errors_print("truth with lmb_self_bounce", bounced, truth);
    return result;
}

/* Over all texels, the best of some rounds. */
static void evaluation_time(const bump_picture *picture, const lmb_rnm *rnm)
{
    enum { ROUNDS = 50 };
    double best = INFINITY;
    volatile float sink = 0.0f;
    for (int round = 0; round < ROUNDS; ++round) {
        const double start = cpu_time_of_thread();
        float sum = 0.0f;
        for (int i = 0; i < TEXELS; ++i) {
            const lmb_rgb found = lmb_ssbump_evaluate(rnm, picture->lit[COLUMN_SSBUMP][i]);
            sum += found.c[0] + found.c[1] + found.c[2];
        }
        sink = sink + sum;
        best = fmin(best, cpu_time_of_thread() - start);
    }
    printf("%-28s%8.1f ns\n", "lmb_ssbump_evaluate", 1e9 * best / TEXELS);
}

/* Lit columns have the truth's exposure; the others are data, not light. */
static void row_draw(bump_picture *picture, int row)
{
    const float exposure = exposure_of_picture((const float *)picture->lit[COLUMN_TRUTH], TEXELS);
    static uint8_t drawn[3 * TEXELS];
    for (int column = 0; column < COLUMNS; ++column) {
        if (column > COLUMN_SSBUMP) {
            picture_tonemap((const float *)picture->lit[column], TEXELS, exposure, drawn);
        }
        for (int i = 0; i < 3 * TEXELS; ++i) {
            const float data = picture->lit[column][i / 3].c[i % 3];
            const int x = 3 * SIDE * column + i % (3 * SIDE), y = SIDE * row + i / (3 * SIDE);
            picture->srgb[3 * SIDE * COLUMNS * y + x] =
                column > COLUMN_SSBUMP ? drawn[i] : (uint8_t)(255.0f * data + 0.5f);
        }
    }
}

static lmb_result row_make(bump_picture *picture, const char *env, int row, lmb_error *error)
{
    static specular_light light;
    lmb_result result = specular_light_open(env, &light, error);
    if (result == LMB_OK) {
        row_light(picture, &light);
        row_draw(picture, row);
        printf("%s\n%-28s%8s%8s\n", env, "", "rmse", "scaled");
        for (int column = COLUMN_FLAT; column <= WITHOUT_SHADOWS; ++column) {
            if (column != COLUMN_TRUTH) {
                errors_print(COLUMN_NAME[column], picture->lit[column], picture->lit[COLUMN_TRUTH]);
            }
        }
        result = bounce_print(picture);
        lmb_vec3 slope[LMB_RNM_SLOPES];
        const lmb_rnm rnm = bump_slope_light(&light, slope);
        evaluation_time(picture, &rnm);
        specular_light_close(&light);
    }
    return result;
}

static lmb_result bumps_make(bump_picture *picture)
{
    const lmb_ssbump_settings settings = {.scale_texels = 12.0f, .wrap = true};
    picture->bumps = (bump_floor){{SIDE, SIDE, picture->height}, settings.scale_texels};
    cobbles_make(picture->height);
    lmb_pool *pool = NULL;
    lmb_result result = lmb_pool_create(0, &pool);
    if (result == LMB_OK) {
        result = lmb_ssbump_make(&picture->bumps.map, &settings, pool, NULL, picture->ssbump);
    }
    lmb_pool_destroy(pool);
    return result;
}

int main(int count, char **values)
{
    static bump_picture picture;
    const int rows = count - 3;
    if (rows < 1 || rows > MOST_ROWS || strcmp(values[count - 2], "-o") != 0) {
        fprintf(stderr, "usage: lambent_bump_picture ENV... -o OUT.png\n");
        return 2;
    }
    lmb_error error = {""};
    lmb_result result = bumps_make(&picture);
    for (int row = 0; row < rows && result == LMB_OK; ++row) {
        result = row_make(&picture, values[1 + row], row, &error);
    }
    if (result == LMB_OK) {
        result = lmb_png_write(values[count - 1], SIDE * COLUMNS, SIDE * rows, picture.srgb, &error);
    }
    if (result != LMB_OK) {
        fprintf(stderr, "lambent_bump_picture: %s\n", error.message[0] ? error.message : lmb_result_text(result));
    }
    return result == LMB_OK ? 0 : 1;
}
