/* The numbers that a game gets from a volume: sampler_numbers FILE.lmb [NUMBERS.txt]
 *
 * Prints samples of the volume, and what the lighting models make of them, one line for each position. With
 * NUMBERS.txt, printed so by another build, compares instead: each number may differ by 1e-6 of the line's l0. This is
 * how builds for other processors and systems are told to give the same light. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/hhd.h>
#include <lambent/hlsh.h>
#include <lambent/occlusion.h>
#include <lambent/volume.h>

enum { POSITIONS = 24, MODELS = 32, NUMBERS = 3 * LMB_SH3_COUNT + 1 + MODELS };

static float *append_rgb(float *at, lmb_rgb colour)
{
    memcpy(at, colour.c, sizeof colour.c);
    return at + 3;
}

/* What is stored, and what it gives at `n`. */
static float *append_irradz(float *at, const lmb_irradz *irradz, lmb_vec3 n_v, lmb_vec3 n)
{
    at = append_rgb(at, irradz->irradiance_z);
    *at++ = irradz->ambient_weight;
    memcpy(at, &irradz->direction, sizeof irradz->direction);
    const lmb_hhd_rgb hhd = lmb_irradz_decode(irradz, n_v);
    return append_rgb(at + 3, lmb_hhd_rgb_evaluate(&hhd, n_v, n));
}

/* Inside first, then the 27 coefficients, then each model. */
static void numbers_at(const lmb_volume *volume, int i, float numbers[NUMBERS])
{
    static const lmb_vec3 normals[] = {{0.0f, 1.0f, 0.0f}, {0.6f, 0.0f, -0.8f}, {-0.48f, 0.6f, 0.64f}};
    const lmb_volume_info info = lmb_volume_get_info(volume);
    const lmb_vec3 low = {(float)info.bounds_min.x, (float)info.bounds_min.y, (float)info.bounds_min.z};
    const lmb_vec3 high = {(float)info.bounds_max.x, (float)info.bounds_max.y, (float)info.bounds_max.z};
    /* Spread by steps that are no part of each other; every eighth lies outside. */
    const float x = (float)(i * 7 % 24) / 23.0f + (i % 8 == 7 ? 1.0f : 0.0f);
    const float y = (float)(i * 11 % 24) / 23.0f, z = (float)(i * 5 % 24) / 23.0f;
    const lmb_vec3 position = {low.x + x * (high.x - low.x), low.y + y * (high.y - low.y),
                               low.z + z * (high.z - low.z)};
    const lmb_vec3 n_v = normals[i % 3], n = {0.36f, 0.48f, 0.8f};
    const float cone = lmb_cone_cos_from_visibility(0.25f * (float)(i % 5));

    lmb_sh3_rgb light;
    numbers[0] = lmb_volume_sample(volume, position, &light) ? 1.0f : 0.0f;
    memcpy(&numbers[1], &light, sizeof light);
    float *at = &numbers[1 + 3 * LMB_SH3_COUNT];
    at = append_rgb(at, lmb_sh3_rgb_irradiance(&light, n));
    const lmb_hlsh_rgb hlsh = lmb_hlsh_rgb_from_sh3(&light, n_v, cone);
    at = append_rgb(at, lmb_hlsh_rgb_evaluate(&hlsh, n_v, n));
    const lmb_irradz irradz = lmb_irradz_encode(&light, n_v, cone);
    at = append_irradz(at, &irradz, n_v, n);
    const lmb_hlsh_rgb probe_hlsh = lmb_hlsh_rgb_from_probe(&light, n_v, cone);
    at = append_rgb(at, lmb_hlsh_rgb_evaluate(&probe_hlsh, n_v, n));
    const lmb_irradz probe_irradz = lmb_irradz_from_probe(&light, n_v, cone);
    at = append_irradz(at, &probe_irradz, n_v, n);
    append_rgb(at, lmb_self_bounce((lmb_rgb){{0.5f, 0.6f, 0.7f}}, irradz.irradiance_z, n_v, n));
}

static void print_numbers(const lmb_volume *volume)
{
    for (int i = 0; i < POSITIONS; ++i) {
        float numbers[NUMBERS];
        numbers_at(volume, i, numbers);
        for (int k = 0; k < NUMBERS; ++k) {
            printf("%s%.9g", k > 0 ? " " : "", (double)numbers[k]);
        }
        printf("\n");
    }
}

/* @return how many numbers are off, or missing */
static int compare_numbers(const lmb_volume *volume, FILE *expected)
{
    int wrong = 0;
    float largest = 0.0f;
    for (int i = 0; i < POSITIONS; ++i) {
        float numbers[NUMBERS];
        numbers_at(volume, i, numbers);
        const float l0 = fmaxf(numbers[1], fmaxf(numbers[1 + LMB_SH3_COUNT], numbers[1 + 2 * LMB_SH3_COUNT]));
        for (int k = 0; k < NUMBERS; ++k) {
            float number = NAN;
            const int read = fscanf(expected, "%f", &number);
            const float difference = fabsf(numbers[k] - number);
            if (read != 1 || !(difference <= 1e-6f * l0)) {
                fprintf(stderr, "position %d, number %d is %.9g, expected %.9g\n", i, k, (double)numbers[k],
                        (double)number);
                ++wrong;
            }
            largest = fmaxf(largest, l0 > 0.0f ? difference / l0 : difference);
        }
    }
    printf("%d numbers, %d are off; the largest difference is %.3g of l0\n", POSITIONS * NUMBERS, wrong,
           (double)largest);
    return wrong;
}

int main(int count, char **values)
{
    lmb_volume *volume;
    const lmb_result opened = count > 1 ? lmb_volume_open_file(values[1], &volume) : LMB_ERROR_ARGUMENT;
    if (opened != LMB_OK) {
        fprintf(stderr, "sampler_numbers: %s: %s\n", count > 1 ? values[1] : "FILE.lmb", lmb_result_text(opened));
        return 1;
    }
    int wrong = 0;
    if (count == 2) {
        print_numbers(volume);
    } else {
        FILE *const expected = fopen(values[2], "r");
        if (!expected) {
            fprintf(stderr, "sampler_numbers: %s cannot be read\n", values[2]);
        }
        wrong = expected ? compare_numbers(volume, expected) : 1;
        if (expected) {
            fclose(expected);
        }
    }
    lmb_volume_close(volume);
    return wrong > 0 ? 1 : 0;
}
