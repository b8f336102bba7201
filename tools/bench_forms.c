#include "bench_forms.h"

#include <stdbool.h>
#include <stdlib.h>

#include <lambent/pack.h>
#include <lambent/volume.h>

/* A volume and the memory that it lies in. */
typedef struct owned_volume {
    lmb_volume *volume;
    unsigned char *data;
} owned_volume;

void bench_sample_single(const void *volume, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    for (size_t i = 0; i < count; ++i) {
        lmb_volume_sample(volume, position[i], &radiance[i]);
    }
}

void bench_sample_batch(const void *volume, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    lmb_vec3d at[BENCH_CHUNK];
    for (size_t i = 0; i < count; ++i) {
        at[i] = (lmb_vec3d){(double)position[i].x, (double)position[i].y, (double)position[i].z};
    }
    lmb_volume_sample_batch(volume, at, count, radiance, NULL, NULL);
}

static void sample_owned(const void *data, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    bench_sample_single(((const owned_volume *)data)->volume, position, count, radiance);
}

static void sample_owned_batch(const void *data, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    bench_sample_batch(((const owned_volume *)data)->volume, position, count, radiance);
}

static void owned_destroy(void *data)
{
    owned_volume *const owned = data;
    lmb_volume_close(owned->volume);
    free(owned->data);
    free(owned);
}

lmb_result bench_form_create(const lmb_probes *probes, lmb_volume_form form, const char *const name[2],
                             lmb_bench_sampler sampler[2])
{
    owned_volume *const owned = calloc(1, sizeof *owned);
    if (!owned) {
        return LMB_ERROR_MEMORY;
    }
    size_t size = 0;
    lmb_result result = lmb_pack_as(form, probes, &owned->data, &size, NULL);
    if (result == LMB_OK) {
        result = lmb_volume_open_memory(owned->data, size, &owned->volume);
    }
    if (result != LMB_OK) {
        owned_destroy(owned);
        return result;
    }
    sampler[0] = (lmb_bench_sampler){name[0], owned, (double)size, sample_owned, owned_destroy};
    sampler[1] = (lmb_bench_sampler){name[1], owned, (double)size, sample_owned_batch, NULL};
    return LMB_OK;
}
