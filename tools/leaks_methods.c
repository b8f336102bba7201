#include "leaks_methods.h"

#include <string.h>

static lmb_result trilinear_prepare(const leaks_field *field, void **state, size_t *bytes)
{
    *state = field->volume;
    *bytes = field->packed_bytes;
    return LMB_OK;
}

static void trilinear_sample(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance)
{
    (void)normal;
    lmb_volume_sample(state, position, radiance);
}

const leaks_method leaks_trilinear = {
    .name = "trilinear",
    .about = "the product's",
    .prepare = trilinear_prepare,
    .sample = trilinear_sample,
};

static const leaks_method *const methods[] = {
    &leaks_trilinear, &leaks_masked, &leaks_masked_exact, &leaks_chebyshev, &leaks_regions,
};

const leaks_method *const *leaks_methods(size_t *count)
{
    *count = sizeof methods / sizeof methods[0];
    return methods;
}

const leaks_method *leaks_method_find(const char *name)
{
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; ++i) {
        if (strcmp(methods[i]->name, name) == 0) {
            return methods[i];
        }
    }
    return NULL;
}
