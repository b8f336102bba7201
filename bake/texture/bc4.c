/* Two ends of 8 bits and an index of 3 bits a texel. With the first end above the second, the eight values are evenly
 * spaced from one to the other; else six are, and the last two are 0 and 1. */
#include "texture/bc4.h"

#include <math.h>
#include <stdbool.h>

enum { STEPS = 8, ROUNDS = 3, NUDGES = 4 };

typedef struct bc4_fit {
    const float *value; /* in 255ths */
    const float *weight;
    int best[2];
    uint8_t best_index[BC4_TEXELS];
    float best_error;
} bc4_fit;

/* In 255ths. */
static void steps_make(int first, int second, float steps[STEPS])
{
    const bool eight = first > second;
    const int between = eight ? STEPS : STEPS - 2;
    steps[0] = (float)first;
    steps[1] = (float)second;
    for (int i = 2; i < between; ++i) {
        steps[i] = (float)(first * (between - i) + second * (i - 1)) / (float)(between - 1);
    }
    if (!eight) {
        steps[STEPS - 2] = 0.0f;
        steps[STEPS - 1] = 255.0f;
    }
}

/* How far a step lies towards the second end; below 0: it is one of the constants. */
static float step_share(int index, bool eight)
{
    const int between = eight ? STEPS : STEPS - 2;
    return index == 0 ? 0.0f : index == 1 ? 1.0f : index < between ? (float)(index - 1) / (float)(between - 1) : -1.0f;
}

/* Chooses indices, and keeps them if they are the best so far. */
static float ends_judge(bc4_fit *fit, int first, int second, uint8_t index[BC4_TEXELS])
{
    float steps[STEPS];
    float error = 0.0f;
    steps_make(first, second, steps);
    for (int i = 0; i < BC4_TEXELS; ++i) {
        float nearest = INFINITY;
        index[i] = 0;
        for (int k = 0; k < STEPS; ++k) {
            const float off = steps[k] - fit->value[i];
            if (off * off < nearest) {
                nearest = off * off;
                index[i] = (uint8_t)k;
            }
        }
        error += fit->weight[i] * nearest;
    }
    if (error < fit->best_error) {
        fit->best_error = error;
        fit->best[0] = first;
        fit->best[1] = second;
        for (int i = 0; i < BC4_TEXELS; ++i) {
            fit->best_index[i] = index[i];
        }
    }
    return error;
}

static int rounded(float value)
{
    return value <= 0.0f ? 0 : value >= 255.0f ? 255 : (int)(value + 0.5f);
}

/* Weighted least squares of both ends for the indices; false where those do not say. */
static bool ends_refit(const bc4_fit *fit, const uint8_t index[BC4_TEXELS], bool eight, float ends[2])
{
    float aa = 0.0f, ab = 0.0f, bb = 0.0f, ax = 0.0f, bx = 0.0f;
    for (int i = 0; i < BC4_TEXELS; ++i) {
        const float b = step_share(index[i], eight), a = 1.0f - b;
        if (b >= 0.0f) {
            aa += fit->weight[i] * a * a;
            ab += fit->weight[i] * a * b;
            bb += fit->weight[i] * b * b;
            ax += fit->weight[i] * a * fit->value[i];
            bx += fit->weight[i] * b * fit->value[i];
        }
    }
    const float determinant = aa * bb - ab * ab;
    if (!(determinant > 1e-4f * aa * bb)) {
        return false;
    }
    ends[0] = (ax * bb - bx * ab) / determinant;
    ends[1] = (bx * aa - ax * ab) / determinant;
    return true;
}

/* Ends in the order that says which kind of block it is. */
static float ordered_judge(bc4_fit *fit, float low, float high, bool eight, uint8_t index[BC4_TEXELS])
{
    const int a = rounded(low), b = rounded(high);
    return eight ? ends_judge(fit, b, a, index) : ends_judge(fit, a, b, index);
}

static void kind_try(bc4_fit *fit, float low, float high, bool eight)
{
    uint8_t index[BC4_TEXELS];
    float error = ordered_judge(fit, low, high, eight, index);
    for (int round = 1; round < ROUNDS; ++round) {
        float ends[2];
        if (!ends_refit(fit, index, eight, ends)) {
            return;
        }
        const float next = ordered_judge(fit, fminf(ends[0], ends[1]), fmaxf(ends[0], ends[1]), eight, index);
        if (!(next < error)) {
            return;
        }
        error = next;
    }
}

/* Moves both ends a step at a time, for as long as that makes it better. */
static void best_nudge(bc4_fit *fit)
{
    uint8_t index[BC4_TEXELS];
    for (int round = 0; round < NUDGES; ++round) {
        const float before = fit->best_error;
        const int first = fit->best[0], second = fit->best[1];
        for (int move = 0; move < 9; ++move) {
            const int a = first + move / 3 - 1, b = second + move % 3 - 1;
            if (a >= 0 && b >= 0 && a <= 255 && b <= 255) {
                ends_judge(fit, a, b, index);
            }
        }
        if (!(fit->best_error < before)) {
            return;
        }
    }
}

/* The least and the largest of the values that count, without those that the constants are for. False: there are none.
 */
static bool range_find(const bc4_fit *fit, bool constants, float *low, float *high)
{
    bool any = false;
    for (int i = 0; i < BC4_TEXELS; ++i) {
        const float value = fit->value[i];
        if (fit->weight[i] > 0.0f && !(constants && (value < 0.5f || value > 254.5f))) {
            *low = any ? fminf(*low, value) : value;
            *high = any ? fmaxf(*high, value) : value;
            any = true;
        }
    }
    return any;
}

static void bytes_write(const bc4_fit *fit, uint8_t bytes[BC4_BYTES])
{
    uint64_t bits = (uint64_t)fit->best[0] | (uint64_t)fit->best[1] << 8;
    for (int i = 0; i < BC4_TEXELS; ++i) {
        bits |= (uint64_t)fit->best_index[i] << (16 + 3 * i);
    }
    for (int i = 0; i < BC4_BYTES; ++i) {
        bytes[i] = (uint8_t)(bits >> (8 * i));
    }
}

float lmb_bc4_encode(const float value[BC4_TEXELS], const float weight[BC4_TEXELS], uint8_t bytes[BC4_BYTES])
{
    float scaled[BC4_TEXELS];
    for (int i = 0; i < BC4_TEXELS; ++i) {
        scaled[i] = value[i] > 0.0f ? value[i] < 1.0f ? 255.0f * value[i] : 255.0f : 0.0f;
    }
    bc4_fit fit = {.value = scaled, .weight = weight, .best_error = INFINITY};
    float low = 0.0f, high = 0.0f;
    if (range_find(&fit, false, &low, &high)) {
        const bool extremes = low < 0.5f || high > 254.5f;
        kind_try(&fit, low, high, true);
        if (extremes && range_find(&fit, true, &low, &high)) {
            kind_try(&fit, low, high, false);
        }
        best_nudge(&fit);
    } else {
        fit.best_error = 0.0f;
    }
    bytes_write(&fit, bytes);
    return fit.best_error * (1.0f / (255.0f * 255.0f));
}

void lmb_bc4_decode(const uint8_t bytes[BC4_BYTES], float value[BC4_TEXELS])
{
    float steps[STEPS];
    uint64_t bits = 0;
    for (int i = 2; i < BC4_BYTES; ++i) {
        bits |= (uint64_t)bytes[i] << (8 * (i - 2));
    }
    steps_make(bytes[0], bytes[1], steps);
    for (int i = 0; i < BC4_TEXELS; ++i) {
        value[i] = steps[bits >> (3 * i) & 7] * (1.0f / 255.0f);
    }
}
