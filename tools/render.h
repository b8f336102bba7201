/* Pictures of a baked level. */
#ifndef LMB_TOOLS_RENDER_H
#define LMB_TOOLS_RENDER_H

#include "camera.h"
#include "shade.h"

typedef enum lmb_render_mode {
    RENDER_FINAL,      /* surfaces by lightmaps, objects by probes */
    RENDER_LIGHTMAP,   /* the stored irradiance, as on white paper */
    RENDER_PROBES,     /* surfaces by probes too */
    RENDER_REFERENCE,  /* the truth, as far as surfaces reflect diffusely once more towards the camera */
    RENDER_DIFFERENCE, /* final - reference, signed */
    RENDER_MISMATCH,   /* irradiance by probes - that of lightmaps, relative to the latter's luminance */
    RENDER_DENSITY     /* a checker of the lightmap's texels */
} lmb_render_mode;

/* Samples of a pixel are shared among so many rays, evenly: rounded up. */
enum { RENDER_RAYS_PER_PIXEL = 16 };

typedef struct lmb_render_settings {
    lmb_camera camera;
    lmb_render_mode mode;
    int32_t width, height; /* pixels, > 0 */
    uint32_t samples;      /* light samples a pixel of reference and difference, > 0 */
} lmb_render_settings;

/* Draws into `rgb`, 3 floats a pixel, row 0 on top; each pixel is the mean of 16 stratified rays. `shader`'s
 * irradiance_only and reference_samples are set here. `*reference_mean` gets the mean luminance of the reference in
 * RENDER_DIFFERENCE, else 0. The picture does not depend on the pool's threads.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result render_picture(const lmb_shader *shader, const lmb_render_settings *settings, lmb_pool *pool,
                          const lmb_progress *progress, float *rgb, double *reference_mean);

#endif
