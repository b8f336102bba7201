#include <lambent/model.h>

#include <stdio.h>
#include <string.h>

#include "model/models.h"

static const lmb_model *const table[] = {
    &lmb_model_irradz_hhd,
    &lmb_model_irradz_disc,
    &lmb_model_hhd_closed_fitted,
    &lmb_model_hlsh,
    &lmb_model_hlsh_fitted,
    &lmb_model_sh3,
    &lmb_model_hhd_closed_gram,
    &lmb_model_hhd_channels_gram,
    &lmb_model_hhd_three_gram,
    &lmb_model_hhd_searched_gram,
    &lmb_model_hhd_searched_azimuth,
    &lmb_model_hhd_searched_channels,
    &lmb_model_ahd_searched,
    &lmb_model_ahd_shipped,
    &lmb_model_hlsh_t2,
    &lmb_model_hlsh_light,
    &lmb_model_sh3_gram,
    &lmb_model_sh3_fit,
    &lmb_model_sh3_ratios,
    &lmb_model_sh3_shared_ratios,
    &lmb_model_sh3_window,
    &lmb_model_sh3_kept,
    &lmb_model_sh3_ao,
    &lmb_model_sh3_bent,
    &lmb_model_sh3_halo3,
    &lmb_model_zh3_gram,
    &lmb_model_zh3_unoccluded,
    &lmb_model_zh3_hallucinated_gram,
    &lmb_model_zh3_hallucinated_unoccluded,
    &lmb_model_geomerics_gram,
    &lmb_model_geomerics_unoccluded,
    &lmb_model_sh2,
    &lmb_model_sh2_fit,
    &lmb_model_sh2_linear,
    &lmb_model_sh2_unoccluded,
    &lmb_model_h6_gram,
    &lmb_model_h4_gram,
    &lmb_model_sg5_gram,
    &lmb_model_cube_gram,
    &lmb_model_cube_unoccluded,
    &lmb_model_rnm,
    &lmb_model_rnm_light,
    &lmb_model_scalar,
    &lmb_model_dominant,
};

const char *const lmb_numbered_channels[LMB_MODEL_MOST_CHANNELS] = {
    "c00", "c01", "c02", "c03", "c04", "c05", "c06", "c07", "c08", "c09", "c10",
    "c11", "c12", "c13", "c14", "c15", "c16", "c17", "c18", "c19", "c20", "c21",
    "c22", "c23", "c24", "c25", "c26", "c27", "c28", "c29", "c30", "c31", "c32"};

void lmb_model_average(const lmb_model *model, float *channel, float total)
{
    if (model->average) {
        model->average(channel, total);
    } else {
        for (int i = 0; i < model->channel_count; ++i) {
            channel[i] /= total;
        }
    }
}

size_t lmb_model_count(void)
{
    return sizeof table / sizeof table[0];
}

const lmb_model *lmb_model_at(size_t index)
{
    return table[index];
}

const char *lmb_model_full_name(const lmb_model *model)
{
    return model->full_name ? model->full_name : model->name;
}

static bool is_called(const lmb_model *model, const char *name)
{
    return strcmp(model->name, name) == 0 || strcmp(lmb_model_full_name(model), name) == 0 ||
           (model->short_name && strcmp(model->short_name, name) == 0);
}

const lmb_model *lmb_model_find(const char *name, unsigned uses)
{
    const lmb_model *other = NULL;
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        if (!is_called(table[i], name)) {
            continue;
        }
        if (table[i]->uses & uses) {
            return table[i];
        }
        other = other ? other : table[i];
    }
    return other;
}

const lmb_model *lmb_model_for_lightmap(const char *name)
{
    const lmb_model *model = lmb_model_find(name, LMB_MODEL_FOR_LIGHTMAP);
    if (!model || !(model->uses & LMB_MODEL_FOR_LIGHTMAP)) {
        char clipped[64];
        snprintf(clipped, sizeof clipped, "%s.gram", name);
        model = lmb_model_find(clipped, LMB_MODEL_FOR_LIGHTMAP);
    }
    return model && (model->uses & LMB_MODEL_FOR_LIGHTMAP) ? model : NULL;
}

const lmb_model *lmb_model_default(lmb_model_use use)
{
    size_t i = 0;
    while (i + 1 < lmb_model_count() && !(table[i]->default_uses & (unsigned)use)) {
        ++i;
    }
    return table[i];
}
