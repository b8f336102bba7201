#include "stability_run.h"

#include <lambent/model.h>

#ifndef STABILITY_RUN
#define STABILITY_RUN stability_run_float
#define STABILITY_EXPORT
#endif

static lmb_vec3 vector_of(const double v[3])
{
    const lmb_vec3 vector = {(float)v[0], (float)v[1], (float)v[2]};
    return vector;
}

STABILITY_EXPORT void STABILITY_RUN(size_t model, const stability_input *input, double irradiance[STABILITY_VALUES])
{
    const lmb_model *row = lmb_model_at(model);
    lmb_sh3_rgb radiance;
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            radiance.channel[c].c[i] = (float)input->sh[c][i];
        }
    }
    lmb_vec3 normals[STABILITY_NORMALS];
    for (int k = 0; k < STABILITY_NORMALS; ++k) {
        normals[k] = vector_of(input->normal[k]);
    }
    const lmb_vec3 vertex_normal = vector_of(input->vertex_normal);
    float channel[LMB_MODEL_MOST_CHANNELS];
    lmb_rgb light[STABILITY_NORMALS];
    row->encode(&radiance, vertex_normal, (float)input->cone_cos, channel);
    row->evaluate(channel, vertex_normal, normals, STABILITY_NORMALS, light);
    for (int k = 0; k < STABILITY_NORMALS; ++k) {
        for (int c = 0; c < 3; ++c) {
            irradiance[3 * k + c] = (double)light[k].c[c];
        }
    }
}
