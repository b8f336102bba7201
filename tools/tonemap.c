#include "tonemap.h"

#include <math.h>

#include <lambent/types.h>

static const float middle_grey = 0.18f;
static const float white_point = 6.0f;

static float pixel_luminance(const float *rgb, size_t pixel)
{
    return lmb_luminance((lmb_rgb){{rgb[3 * pixel], rgb[3 * pixel + 1], rgb[3 * pixel + 2]}});
}

float exposure_of_picture(const float *rgb, size_t pixel_count)
{
    double sum = 0.0;
    size_t lit = 0;
    for (size_t i = 0; i < pixel_count; ++i) {
        const float luminance = pixel_luminance(rgb, i);
        if (luminance > 0.0f && isfinite(luminance)) {
            sum += log2((double)luminance);
            ++lit;
        }
    }
    return lit > 0 ? (float)(log2((double)middle_grey) - sum / (double)lit) : 0.0f;
}

float tone_curve(float light)
{
    if (!(light > 0.0f)) {
        return 0.0f;
    }
    if (light >= white_point) {
        return 1.0f;
    }
    return light * (1.0f + light / (white_point * white_point)) / (1.0f + light);
}

uint8_t srgb_of_linear(float linear)
{
    if (!(linear > 0.0f)) {
        return 0;
    }
    const float value = fminf(linear, 1.0f);
    const float coded = value <= 0.0031308f ? 12.92f * value : 1.055f * powf(value, 1.0f / 2.4f) - 0.055f;
    return (uint8_t)lrintf(255.0f * fminf(coded, 1.0f));
}

void picture_tonemap(const float *rgb, size_t pixel_count, float exposure_ev, uint8_t *srgb)
{
    const float factor = exp2f(exposure_ev);
    for (size_t i = 0; i < 3 * pixel_count; ++i) {
        srgb[i] = srgb_of_linear(tone_curve(rgb[i] * factor));
    }
}

void picture_difference_colour(const float *rgb, size_t pixel_count, float full, uint8_t *srgb)
{
    for (size_t i = 0; i < pixel_count; ++i) {
        const float ratio = full > 0.0f ? pixel_luminance(rgb, i) / full : 0.0f;
        const float share = fminf(fmaxf(ratio, -1.0f), 1.0f);
        const uint8_t fade = (uint8_t)lrintf(255.0f * (1.0f - fabsf(share)));
        srgb[3 * i] = share < 0.0f ? fade : 255;
        srgb[3 * i + 1] = fade;
        srgb[3 * i + 2] = share > 0.0f ? fade : 255;
    }
}
