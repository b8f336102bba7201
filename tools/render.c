#include "render.h"

#include <float.h>
#include <stdlib.h>

#include <lambent/sequence.h>
#include <lambent/vector.h>

enum { TILE = 16, GRID = 4, RAYS_PER_PIXEL = GRID * GRID };
_Static_assert((int)RAYS_PER_PIXEL == (int)RENDER_RAYS_PER_PIXEL, "what the header says");

typedef struct render_work {
    lmb_shader shader;
    const lmb_render_settings *settings;
    float *rgb;
    int32_t tiles_across;
    double *reference_sum; /* [tile] luminance */
} render_work;

static lmb_rgb finite_or_black(lmb_rgb colour)
{
    for (int c = 0; c < 3; ++c) {
        colour.c[c] = isfinite(colour.c[c]) ? colour.c[c] : 0.0f;
    }
    return colour;
}

static lmb_light_source source_of(lmb_render_mode mode)
{
    return mode == RENDER_REFERENCE ? SOURCE_REFERENCE
           : mode == RENDER_PROBES  ? SOURCE_PROBES
           : mode == RENDER_DENSITY ? SOURCE_TEXELS
                                    : SOURCE_STORED;
}

/* What probes give more than lightmaps do, as a share of that; 0 where neither gives any. */
static lmb_rgb mismatch_of(const lmb_shader *shader, lmb_vec3 origin, lmb_vec3 direction)
{
    const lmb_rgb stored = finite_or_black(shade_ray(shader, SOURCE_STORED, origin, direction));
    const lmb_rgb probes = finite_or_black(shade_ray(shader, SOURCE_PROBES, origin, direction));
    const float light = lmb_luminance(stored);
    return lmb_rgb_scale(lmb_rgb_add(probes, lmb_rgb_scale(stored, -1.0f)), 1.0f / lmb_larger(light, FLT_MIN));
}

/* The pixel's value, the mean over its rays; adds the reference's luminance to `*reference_sum`. */
static lmb_rgb pixel_render(const render_work *work, int32_t x, int32_t y, double *reference_sum)
{
    const lmb_render_settings *settings = work->settings;
    const lmb_camera *camera = &settings->camera;
    const uint64_t stream = lmb_mix((uint64_t)(uint32_t)x, (uint64_t)(uint32_t)y);
    lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
    for (uint32_t i = 0; i < RAYS_PER_PIXEL; ++i) {
        const float jitter[2] = {lmb_random(stream, i, 0, 0), lmb_random(stream, i, 1, 0)};
        const float at_x = (float)x + ((float)(i % GRID) + jitter[0]) / (float)GRID;
        const float at_y = (float)y + ((float)(i / GRID) + jitter[1]) / (float)GRID;
        const lmb_vec3 direction = camera_direction(camera, settings->width, settings->height, at_x, at_y);
        lmb_rgb value;
        if (settings->mode == RENDER_DIFFERENCE) {
            const lmb_rgb truth =
                finite_or_black(shade_ray(&work->shader, SOURCE_REFERENCE, camera->position, direction));
            value = shade_ray(&work->shader, SOURCE_STORED, camera->position, direction);
            value = lmb_rgb_add(value, lmb_rgb_scale(truth, -1.0f));
            *reference_sum += (double)lmb_luminance(truth) / RAYS_PER_PIXEL;
        } else if (settings->mode == RENDER_MISMATCH) {
            value = mismatch_of(&work->shader, camera->position, direction);
        } else {
            value = shade_ray(&work->shader, source_of(settings->mode), camera->position, direction);
        }
        sum = lmb_rgb_add(sum, finite_or_black(value));
    }
    return lmb_rgb_scale(sum, 1.0f / (float)RAYS_PER_PIXEL);
}

static void tile_task(void *context, size_t task, int worker)
{
    (void)worker;
    render_work *work = context;
    const int32_t width = work->settings->width, height = work->settings->height;
    const int32_t left = (int32_t)(task % (size_t)work->tiles_across) * TILE;
    const int32_t top = (int32_t)(task / (size_t)work->tiles_across) * TILE;
    for (int32_t y = top; y < top + TILE && y < height; ++y) {
        for (int32_t x = left; x < left + TILE && x < width; ++x) {
            const lmb_rgb pixel = pixel_render(work, x, y, &work->reference_sum[task]);
            float *out = work->rgb + 3 * ((size_t)y * (size_t)width + (size_t)x);
            for (int c = 0; c < 3; ++c) {
                out[c] = pixel.c[c];
            }
        }
    }
}

lmb_result render_picture(const lmb_shader *shader, const lmb_render_settings *settings, lmb_pool *pool,
                          const lmb_progress *progress, float *rgb, double *reference_mean)
{
    render_work work = {.shader = *shader, .settings = settings, .rgb = rgb};
    work.shader.irradiance_only = settings->mode == RENDER_LIGHTMAP || settings->mode == RENDER_MISMATCH;
    work.shader.reference_samples = (settings->samples + RAYS_PER_PIXEL - 1) / RAYS_PER_PIXEL;
    work.tiles_across = (settings->width + TILE - 1) / TILE;
    const size_t tiles = (size_t)work.tiles_across * (size_t)((settings->height + TILE - 1) / TILE);
    work.reference_sum = calloc(tiles, sizeof *work.reference_sum);
    if (!work.reference_sum) {
        return LMB_ERROR_MEMORY;
    }
    const lmb_result result = lmb_pool_run(pool, tiles, tile_task, &work, "render", progress);
    if (result == LMB_OK) {
        double sum = 0.0;
        for (size_t i = 0; i < tiles; ++i) {
            sum += work.reference_sum[i];
        }
        *reference_mean = sum / ((double)settings->width * (double)settings->height);
    }
    free(work.reference_sum);
    return result;
}
