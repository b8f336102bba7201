/* The rows of the table. A new model is a file of its own, a line here and one in model.c. */
#ifndef LMB_MODELS_H
#define LMB_MODELS_H

#include <lambent/model.h>

/* Names of channels that have none of their own. */
extern const char *const lmb_numbered_channels[LMB_MODEL_MOST_CHANNELS];
/* What lightmaps need of a row whose channels are all linear in the light: they filter as they are. */
#define LMB_LINEAR_ROW(channels)                                                                                       \
    .uses = LMB_MODEL_FOR_LIGHTMAP, .channel_name = lmb_numbered_channels,                                             \
    .part = (const lmb_model_part[]){{.name = "light", .count = channels}, {.name = NULL}}, .light_count = channels,   \
    .convention = "light / lambent:scale, in the model's own order"

extern const lmb_model lmb_model_irradz_hhd;
extern const lmb_model lmb_model_irradz_disc;
extern const lmb_model lmb_model_hhd_closed_fitted;
extern const lmb_model lmb_model_hlsh;
extern const lmb_model lmb_model_hlsh_fitted;
extern const lmb_model lmb_model_sh3;
extern const lmb_model lmb_model_hhd_closed_gram;
extern const lmb_model lmb_model_hhd_channels_gram;
extern const lmb_model lmb_model_hhd_three_gram;
extern const lmb_model lmb_model_hhd_searched_gram;
extern const lmb_model lmb_model_hhd_searched_azimuth;
extern const lmb_model lmb_model_hhd_searched_channels;
extern const lmb_model lmb_model_ahd_searched;
extern const lmb_model lmb_model_ahd_shipped;
extern const lmb_model lmb_model_hlsh_t2;
extern const lmb_model lmb_model_hlsh_light;
extern const lmb_model lmb_model_sh3_gram;
extern const lmb_model lmb_model_sh3_fit;
extern const lmb_model lmb_model_sh3_ratios;
extern const lmb_model lmb_model_sh3_shared_ratios;
extern const lmb_model lmb_model_sh3_window;
extern const lmb_model lmb_model_sh3_kept;
extern const lmb_model lmb_model_sh3_ao;
extern const lmb_model lmb_model_sh3_bent;
extern const lmb_model lmb_model_sh3_halo3;
extern const lmb_model lmb_model_zh3_gram;
extern const lmb_model lmb_model_zh3_unoccluded;
extern const lmb_model lmb_model_zh3_hallucinated_gram;
extern const lmb_model lmb_model_zh3_hallucinated_unoccluded;
extern const lmb_model lmb_model_geomerics_gram;
extern const lmb_model lmb_model_geomerics_unoccluded;
extern const lmb_model lmb_model_sh2;
extern const lmb_model lmb_model_sh2_fit;
extern const lmb_model lmb_model_sh2_linear;
extern const lmb_model lmb_model_sh2_unoccluded;
extern const lmb_model lmb_model_h6_gram;
extern const lmb_model lmb_model_h4_gram;
extern const lmb_model lmb_model_sg5_gram;
extern const lmb_model lmb_model_cube_gram;
extern const lmb_model lmb_model_cube_unoccluded;
extern const lmb_model lmb_model_rnm;
extern const lmb_model lmb_model_rnm_light;
extern const lmb_model lmb_model_scalar;
extern const lmb_model lmb_model_dominant;

#endif
