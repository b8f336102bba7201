/* What filtering between texels does to lighting models whose channels are not linear in the light:
 *
 *     lambent_filtering ENV... [--turns N] [--models NAME,NAME,...] [-o PICTURE.png]
 *
 * Two neighbouring texels are the same surface under two turns of an environment. Between them channels are
 * interpolated, each by itself, and decoded at the surface's own normal. A model that is linear, or holds I_z, stays
 * between the two; AHD shines brighter than both (Roughton, Sloan, Silvennoinen and Shirley, SIGGRAPH 2024). One line
 * for each model, tabs between: its name; the overshoot, the most above the brighter of the two as a share of it: mean
 * over all pairs, their 95th percentile, the largest; and the largest undershoot below the darker one.
 *
 * Then the dominant light (Halo 3's) halfway between, against that of the mean harmonics: degrees, mean and 95th
 * percentile, of filtered unit directions and of the filtered linear band; and the filtered intensity's relative error,
 * mean and 95th percentile.
 *
 * The picture shows, for the pair of the 95th percentile of the first model, a strip of what is between: the truth on
 * top, then each model. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/image.h>
#include <lambent/vector.h>

#include "command.h"
#include "models_turn.h"
#include "output_file.h"
#include "tonemap.h"

static const char usage[] = "usage: lambent_filtering ENV... [--turns N] [--models NAME,...] [-o PICTURE.png]\n";

enum { STEPS = 32, MOST_MODELS = 64, MOST_TURNS = 4096, STRIP_WIDTH = 768, STRIP_HEIGHT = 64, STRIP_GAP = 4 };
static const lmb_vec3 up = {0.0f, 0.0f, 1.0f};

typedef struct filtering {
    const lmb_model *model[MOST_MODELS];
    int model_count;
    uint32_t turns;
    const char *picture;
    size_t pairs;
    lmb_sh3 (*light)[2];            /* [pair] of luminance, as texels have it */
    double *overshoot[MOST_MODELS]; /* [pair] */
    double *undershoot[MOST_MODELS];
} filtering;

static lmb_sh3_rgb grey(const lmb_sh3 *light)
{
    return (lmb_sh3_rgb){{*light, *light, *light}};
}

/* I_z where the second texel has that share. */
static double between(const lmb_model *model, const lmb_sh3 light[2], double share)
{
    float channel[2][LMB_MODEL_MOST_CHANNELS];
    lmb_rgb irradiance;
    for (int k = 0; k < 2; ++k) {
        const lmb_sh3_rgb radiance = grey(&light[k]);
        model->encode(&radiance, up, 0.0f, channel[k]);
    }
    for (int i = 0; i < model->channel_count; ++i) {
        channel[0][i] += (channel[1][i] - channel[0][i]) * (float)share;
    }
    model->evaluate(channel[0], up, &up, 1, &irradiance);
    return (double)irradiance.c[1];
}

static void pair_measure(filtering *work, int m, size_t pair)
{
    const lmb_model *model = work->model[m];
    const double first = between(model, work->light[pair], 0.0), last = between(model, work->light[pair], 1.0);
    double most = 0.0, least = 0.0;
    for (int step = 1; step < STEPS; ++step) {
        const double here = between(model, work->light[pair], (double)step / STEPS);
        most = fmax(most, here / fmax(first, last) - 1.0);
        least = fmax(least, 1.0 - here / fmin(first, last));
    }
    work->overshoot[m][pair] = isfinite(most) ? most : 0.0;
    work->undershoot[m][pair] = isfinite(least) ? least : 0.0;
}

static int doubles_compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void spread_print(double *value, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        sum += value[i];
    }
    qsort(value, count, sizeof *value, doubles_compare);
    printf("\t%.4f\t%.4f", sum / (double)count, value[(size_t)(0.95 * (double)count)]);
}

static void models_print(filtering *work)
{
    printf("# model\tovershoot\tp95\tmax\tundershoot_max\n");
    for (int m = 0; m < work->model_count; ++m) {
        printf("%s", lmb_model_full_name(work->model[m]));
        spread_print(work->overshoot[m], work->pairs);
        double least = 0.0;
        for (size_t i = 0; i < work->pairs; ++i) {
            least = fmax(least, work->undershoot[m][i]);
        }
        printf("\t%.4f\t%.4f\n", work->overshoot[m][work->pairs - 1], least);
    }
}

static double degrees_between(lmb_vec3 a, lmb_vec3 b)
{
    return atan2((double)lmb_vec3_length(lmb_vec3_cross(a, b)), (double)lmb_vec3_dot(a, b)) * 180.0 / LMB_PI;
}

/* What the row stores of a light: an intensity of each colour, then the linear band. */
static void dominant_of(const lmb_model *model, const lmb_sh3 *light, double *intensity, lmb_vec3 *band)
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    const lmb_sh3_rgb radiance = grey(light);
    model->encode(&radiance, up, 0.0f, channel);
    *intensity = (double)channel[1];
    *band = lmb_vec3_of(channel[3], channel[4], channel[5]);
}

enum { UNIT_DIRECTION, LINEAR_BAND, INTENSITY, DOMINANT_ERRORS };

static void dominant_measure(const lmb_model *model, const lmb_sh3 light[2], double error[DOMINANT_ERRORS])
{
    double intensity[3];
    lmb_vec3 band[3];
    lmb_sh3 mean;
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        mean.c[i] = 0.5f * (light[0].c[i] + light[1].c[i]);
    }
    dominant_of(model, &light[0], &intensity[0], &band[0]);
    dominant_of(model, &light[1], &intensity[1], &band[1]);
    dominant_of(model, &mean, &intensity[2], &band[2]);
    const lmb_vec3 units = lmb_vec3_add(lmb_vec3_unit_or(band[0], up), lmb_vec3_unit_or(band[1], up));
    error[UNIT_DIRECTION] = degrees_between(units, band[2]);
    error[LINEAR_BAND] = degrees_between(lmb_vec3_add(band[0], band[1]), band[2]);
    error[INTENSITY] = fabs(0.5 * (intensity[0] + intensity[1]) / intensity[2] - 1.0);
}

static lmb_result dominant_print(const filtering *work)
{
    static const char *const name[DOMINANT_ERRORS] = {"unit_direction_deg", "linear_band_deg", "intensity"};
    const lmb_model *model = lmb_model_for_lightmap("dominant");
    double *error = malloc(DOMINANT_ERRORS * work->pairs * sizeof *error);
    if (!error) {
        return LMB_ERROR_MEMORY;
    }
    for (size_t pair = 0; pair < work->pairs; ++pair) {
        double one[DOMINANT_ERRORS];
        dominant_measure(model, work->light[pair], one);
        for (size_t k = 0; k < DOMINANT_ERRORS; ++k) {
            error[k * work->pairs + pair] = one[k];
        }
    }
    printf("# dominant light\tmean\tp95\n");
    for (size_t k = 0; k < DOMINANT_ERRORS; ++k) {
        printf("%s", name[k]);
        spread_print(&error[k * work->pairs], work->pairs);
        putchar('\n');
    }
    free(error);
    return LMB_OK;
}

/* The pair whose overshoot is the 95th percentile of the first model's. */
static size_t typical_pair(const filtering *work)
{
    size_t best = 0, wanted = (size_t)(0.05 * (double)work->pairs);
    double found = -1.0;
    for (size_t i = 0; i < work->pairs; ++i) {
        size_t above = 0;
        for (size_t j = 0; j < work->pairs; ++j) {
            above += work->overshoot[0][j] > work->overshoot[0][i];
        }
        if (above >= wanted && work->overshoot[0][i] > found) {
            found = work->overshoot[0][i];
            best = i;
        }
    }
    return best;
}

static lmb_result picture_write(const filtering *work, lmb_error *error)
{
    const lmb_sh3 *light = work->light[typical_pair(work)];
    const int strips = work->model_count + 1, height = strips * (STRIP_HEIGHT + STRIP_GAP) - STRIP_GAP;
    uint8_t *srgb = calloc((size_t)height * STRIP_WIDTH, 3);
    if (!srgb) {
        return LMB_ERROR_MEMORY;
    }
    const double first = between(work->model[0], light, 0.0), last = between(work->model[0], light, 1.0);
    for (int strip = 0; strip < strips; ++strip) {
        for (int x = 0; x < STRIP_WIDTH; ++x) {
            const double share = (x + 0.5) / STRIP_WIDTH;
            const double value =
                strip == 0 ? first + (last - first) * share : between(work->model[strip - 1], light, share);
            const uint8_t byte = srgb_of_linear((float)(0.5 * value / fmax(first, last)));
            for (int y = 0; y < STRIP_HEIGHT; ++y) {
                memset(&srgb[3 * (x + STRIP_WIDTH * (strip * (STRIP_HEIGHT + STRIP_GAP) + y))], byte, 3);
            }
        }
    }
    const lmb_result result = lmb_png_write(work->picture, STRIP_WIDTH, height, srgb, error);
    free(srgb);
    return result;
}

static lmb_result lights_read(filtering *work, const char *path, size_t first, lmb_error *error)
{
    models_map *map = malloc(sizeof *map);
    models_turn *turn = malloc(sizeof *turn);
    lmb_result result = map && turn ? models_map_read(path, map, error) : LMB_ERROR_MEMORY;
    for (uint32_t k = 0; result == LMB_OK && k < work->turns; ++k) {
        for (uint32_t i = 0; i < 2; ++i) {
            models_turn_fill(turn, map, NULL, 2 * k + i, 0);
            work->light[first + k][i] = lmb_sh3_rgb_luminance(&turn->sh3[MODELS_LIGHTMAP]);
        }
    }
    free(map);
    free(turn);
    return result;
}

static void models_choose(filtering *work, lmb_arguments *arguments, const char *names)
{
    for (; names; names = strchr(names, ',') ? strchr(names, ',') + 1 : NULL) {
        char name[64];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(names, ","), names);
        const lmb_model *model = lmb_model_for_lightmap(name);
        if (!model || work->model_count == MOST_MODELS) {
            arguments_error(arguments, "--models: no lightmap has the model", name);
            return;
        }
        work->model[work->model_count++] = model;
    }
}

/* Every model of lightmaps, where none was named. */
static void models_complete(filtering *work)
{
    for (size_t i = 0; work->model_count < MOST_MODELS && i < lmb_model_count() && !work->picture; ++i) {
        if (lmb_model_at(i)->uses & LMB_MODEL_FOR_LIGHTMAP) {
            work->model[work->model_count++] = lmb_model_at(i);
        }
    }
}

static lmb_result all_measure(filtering *work, const char *const *path, size_t paths, lmb_error *error)
{
    work->pairs = paths * work->turns;
    work->light = malloc(work->pairs * sizeof *work->light);
    lmb_result result = work->light ? LMB_OK : LMB_ERROR_MEMORY;
    for (size_t i = 0; result == LMB_OK && i < paths; ++i) {
        result = lights_read(work, path[i], i * work->turns, error);
    }
    for (int m = 0; result == LMB_OK && m < work->model_count; ++m) {
        work->overshoot[m] = malloc(work->pairs * sizeof *work->overshoot[m]);
        work->undershoot[m] = malloc(work->pairs * sizeof *work->undershoot[m]);
        result = work->overshoot[m] && work->undershoot[m] ? LMB_OK : LMB_ERROR_MEMORY;
        for (size_t pair = 0; result == LMB_OK && pair < work->pairs; ++pair) {
            pair_measure(work, m, pair);
        }
    }
    if (result == LMB_OK && work->picture) {
        result = picture_write(work, error);
    }
    if (result == LMB_OK) {
        models_print(work);
        result = dominant_print(work);
    }
    return result;
}

int main(int count, char **values)
{
    static filtering work = {.turns = 256};
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "filtering", usage);
    const char **const path = malloc((size_t)(count + 1) * sizeof *path);
    lmb_shared_arguments shared = {.many_name = "ENV", .many = path};
    for (const char *next; path && (next = arguments_next(&arguments));) {
        if (strcmp(next, "--turns") == 0) {
            work.turns = (uint32_t)arguments_integer(&arguments, next, 1, MOST_TURNS);
        } else if (strcmp(next, "--models") == 0) {
            models_choose(&work, &arguments, arguments_text(&arguments, next));
        } else if (strcmp(next, "-o") == 0) {
            work.picture = arguments_text(&arguments, next);
        } else {
            arguments_shared(&arguments, next, &shared);
        }
    }
    if (path && arguments_complete(&arguments, &shared) && work.picture && work.model_count == 0) {
        arguments_error(&arguments, "missing option", "--models NAME,... of the picture");
    }
    lmb_error error = {""};
    int status = arguments_status(&arguments);
    if (!arguments.failed && !arguments.help) {
        if (work.model_count == 0) {
            models_complete(&work);
        }
        const lmb_result result = path ? all_measure(&work, path, shared.many_count, &error) : LMB_ERROR_MEMORY;
        status = result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
    }
    for (int m = 0; m < work.model_count; ++m) {
        free(work.overshoot[m]);
        free(work.undershoot[m]);
    }
    free(work.light);
    free(path);
    return status;
}
