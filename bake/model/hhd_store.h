/* One ambient light and one directional light of each colour with a direction that they share, as channels. */
#ifndef LMB_MODEL_HHD_STORE_H
#define LMB_MODEL_HHD_STORE_H

#include <lambent/hhd.h>
#include <lambent/model.h>

/* C_a and C_d of each colour, then d. */
enum { LMB_HHD_AMBIENT, LMB_HHD_DIRECTIONAL = 3, LMB_HHD_DIRECTION = 6, LMB_HHD_CHANNELS = 9 };

/* What lightmaps need of a row of it. */
extern const char *const lmb_hhd_channel_names[LMB_HHD_CHANNELS];
extern const lmb_model_part lmb_hhd_parts[];
void lmb_hhd_average(float *channel, float total);
#define LMB_HHD_ROW                                                                                                    \
    .uses = LMB_MODEL_FOR_LIGHTMAP, .channel_name = lmb_hhd_channel_names, .part = lmb_hhd_parts,                      \
    .light_count = LMB_HHD_DIRECTION,                                                                                  \
    .convention = "a: C_a, d: C_d of each colour / lambent:scale; d.XYZ: direction in world space, +Y up",             \
    .average = lmb_hhd_average

static inline void lmb_hhd_store(const lmb_hhd_rgb *hhd, float *channel)
{
    for (int c = 0; c < 3; ++c) {
        channel[LMB_HHD_AMBIENT + c] = hhd->ambient.c[c];
        channel[LMB_HHD_DIRECTIONAL + c] = hhd->directional.c[c];
    }
    channel[LMB_HHD_DIRECTION] = hhd->direction.x;
    channel[LMB_HHD_DIRECTION + 1] = hhd->direction.y;
    channel[LMB_HHD_DIRECTION + 2] = hhd->direction.z;
}

static inline lmb_hhd_rgb lmb_hhd_stored(const float *channel)
{
    const float *a = &channel[LMB_HHD_AMBIENT], *d = &channel[LMB_HHD_DIRECTIONAL], *v = &channel[LMB_HHD_DIRECTION];
    return (lmb_hhd_rgb){{{a[0], a[1], a[2]}}, {{d[0], d[1], d[2]}}, {v[0], v[1], v[2]}};
}

/* C_a (1 + n_v.n)/2 + C_d max(0, n.d) */
void lmb_hhd_store_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                            lmb_rgb *irradiance);

/* How much of each colour there is in a light whose luminance was solved: by I_z, which stays exact so; of light at the
 * horizon, whose I_z is 0, by the scalar moment. */
float lmb_hhd_share(lmb_moments colour, lmb_moments luminance, lmb_vec3 vertex_normal);

#endif
