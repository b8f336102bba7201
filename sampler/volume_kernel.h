/* Sampling as it is compiled once for each set of instructions: in plain C, and faster where the processor has more.
 * All give the same bits. */
#ifndef LMB_VOLUME_KERNEL_H
#define LMB_VOLUME_KERNEL_H

#include <lambent/volume.h>
#include <lambent/volume_format.h>

/* A batch whose positions are of several volumes, each of the form that the calls are for. */
typedef struct lmb_volume_batch {
    const lmb_volume *const *volume; /* [position], or NULL: that one is outside */
    const lmb_vec3d *position;
    size_t count;
    lmb_sh3_rgb *radiance;
    float (*visibility)[LMB_KEY_LIGHTS_MOST]; /* or NULL */
    bool *inside;                             /* or NULL */
} lmb_volume_batch;

typedef struct lmb_volume_calls {
    /* The position comes in registers: three doubles in a struct would not. */
    bool (*sample)(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance);
    bool (*sample_with_keys)(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance,
                             float *visibility);
    /* As lmb_volume_sample_batch. */
    void (*batch)(const lmb_volume *volume, const lmb_vec3d *position, size_t count, lmb_sh3_rgb *radiance,
                  float (*visibility)[LMB_KEY_LIGHTS_MOST], bool *inside);
    /* As lmb_volume_irradiance and lmb_volume_irradiance_batch. */
    bool (*irradiance)(const lmb_volume *volume, double x, double y, double z, const lmb_vec3 *normal,
                       lmb_rgb *irradiance);
    void (*irradiance_batch)(const lmb_volume *volume, const lmb_vec3d *position, const lmb_vec3 *normal, size_t count,
                             lmb_rgb *irradiance, bool *inside);
    /* The batches where each position has a volume of its own. */
    void (*batch_of)(const lmb_volume_batch *batch);
    void (*irradiance_batch_of)(const lmb_volume *const *volume, const lmb_vec3d *position, const lmb_vec3 *normal,
                                size_t count, lmb_rgb *irradiance, bool *inside);
} lmb_volume_calls;

typedef struct lmb_volume_kernel {
    const char *name;
    const lmb_volume_calls
        *plain; /* of volumes without key lights, whose probes lie at a distance that compilers know */
    const lmb_volume_calls *keyed; /* with */
    const lmb_volume_calls *compact;
} lmb_volume_kernel;

extern const lmb_volume_kernel lmb_volume_kernel_scalar;

/* AVX2 and F16C. NULL: the library was built without it. */
extern const lmb_volume_kernel *const lmb_volume_kernel_avx2;

/* AVX-512 F, VL and DQ. NULL likewise. */
extern const lmb_volume_kernel *const lmb_volume_kernel_avx512;

/* NULL: this is no AArch64. */
extern const lmb_volume_kernel *const lmb_volume_kernel_neon;

static inline const lmb_volume_calls *lmb_volume_kernel_calls(const lmb_volume_kernel *kernel,
                                                              const lmb_volume_header *header)
{
    return header->probe_form == LMB_VOLUME_COMPACT ? kernel->compact
           : header->key_light_count > 0            ? kernel->keyed
                                                    : kernel->plain;
}

/* The fastest that this processor runs. Asks the processor each time. */
const lmb_volume_kernel *lmb_volume_kernel_choose(void);

#endif
