#include <lambent/model.h>

#include <string.h>

#include "model/models.h"

static const lmb_model *const table[] = {
    &lmb_model_irradz_hhd,
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
    &lmb_model_sh2_linear,
    &lmb_model_sh2_unoccluded,
    &lmb_model_h6_gram,
    &lmb_model_h4_gram,
    &lmb_model_sg5_gram,
    &lmb_model_cube_gram,
    &lmb_model_cube_unoccluded,
    &lmb_model_rnm,
    &lmb_model_scalar,
};

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

const lmb_model *lmb_model_default(lmb_model_use use)
{
    size_t i = 0;
    while (i + 1 < lmb_model_count() && !(table[i]->default_uses & (unsigned)use)) {
        ++i;
    }
    return table[i];
}
