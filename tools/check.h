/* The three promises, measured on a bake: how far what is stored is from the truth, how far probes are from lightmaps,
 * and how much light leaks.
 *
 * Every value is normalised irradiance on 8 normals at each point, without self-bounce. At surface points, n_v is the
 * gather point's normal, the normals are cosine-weighted around it up to 60 degrees, and only light above its horizon
 * counts. At free points the normals are spread over the sphere and all light counts. */
#ifndef LMB_TOOLS_CHECK_H
#define LMB_TOOLS_CHECK_H

#include <stdbool.h>

#include <lambent/lightmap.h>
#include <lambent/volume.h>

#include "check_statistics.h"
#include "local_light.h"

/* What is compared with what; the latter is what errors are relative to. All but the last at surface points. */
typedef enum check_pair {
    CHECK_PROBE_VS_REFERENCE,    /* volume -> hemisphere multiply -> the default model of surfaces */
    CHECK_LIGHTMAP_VS_REFERENCE, /* stored texels, bilinear */
    CHECK_PROBE_VS_LIGHTMAP,
    CHECK_COINCIDENT_PROBE_VS_LIGHTMAP, /* as probe, but its SH3 traced at the very point */
    CHECK_COINCIDENT_PROBE_VS_REFERENCE,
    CHECK_COINCIDENT_GRAM_VS_LIGHTMAP,  /* the same SH3 taken at their word: the default model of lightmaps */
    CHECK_COINCIDENT_PROBE_VS_TEXEL,    /* the same beside SH3 of the hemisphere alone, gathered at the very point as a
                                           texel's is, and encoded like it */
    CHECK_COINCIDENT_TEXEL_VS_LIGHTMAP, /* that beside the stored texels: their size, filtering, noise and seams */
    CHECK_COINCIDENT_TEXEL_VS_REFERENCE,
    CHECK_UNOCCLUDED_PROBE_VS_LIGHTMAP, /* volume, SH3 irradiance, no occlusion */
    CHECK_OBJECT_VS_REFERENCE,          /* volume -> the default model of objects */
    CHECK_PROBE_CONE_VS_LIGHTMAP,       /* as probe, with the cone of AO rays within one spacing */
    CHECK_VOLUME_VS_REFERENCE,          /* volume, SH3 irradiance, at free points */
    CHECK_PAIR_COUNT
} check_pair;

/* The JSON key of a pair, and whether it needs lightmaps. */
const char *check_pair_name(check_pair pair);
bool check_pair_needs_lightmap(check_pair pair);

/* What an eye would compare, in a few words. */
const char *check_pair_seen(check_pair pair);

/* What is checked. */
typedef struct check_subject {
    const lmb_transport *transport; /* that the bake gathered with; the reference is the path tracer in any case */
    const lmb_volume *volume;
    const lmb_lightmap *lightmap; /* NULL: none */
    lmb_pool *pool;
    const local_light *local; /* NULL: nothing is lit by local sets */
} check_subject;

typedef struct check_settings {
    uint32_t points;     /* on surfaces, and as many in free space; > 0 */
    uint32_t max_points; /* if more than `points`: as many again and again, up to so many, until the standard error of
                            each line's rel_rmse is below a tenth of it */
    uint32_t samples;    /* of each half of the reference; > 0. A coincident probe takes 16 times as many */
    uint64_t seed;
} check_settings;

check_settings check_settings_default(void);

typedef struct check_report {
    size_t points;                         /* surface points; 0 when the level has no opaque triangle */
    size_t free_points;                    /* found in the volume's free space */
    error_summary error[CHECK_PAIR_COUNT]; /* NaN where a pair has no points or needs lightmaps that are missing */
    size_t local_points;                   /* surface points on nodes that local sets light in place of texels */
    error_summary local;       /* these, lit so, beside the reference: by the default model of surfaces; NaN: none */
    error_summary local_field; /* the same points by the volume */
    leak_summary leak;         /* of the probe */
    double lightmap_leak;      /* NaN without lightmaps */
    double seam_step_median, seam_step_p95; /* NaN without lightmaps: across seams (lmb_seam_steps) */
    double coincident_std_error; /* root mean square of the traced SH3's standard error, over its root mean square:
                                    noise that counts as the coincident probe's error */
} check_report;

/* The figures depend on the level, the bake and the settings, not on the pool's threads.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result check_run(const check_subject *subject, const check_settings *settings, const lmb_progress *progress,
                     check_report *report);

#endif
