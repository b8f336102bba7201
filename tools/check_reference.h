/* The path tracer's irradiance at a point, well enough known to judge what was stored of it. */
#ifndef LMB_TOOLS_CHECK_REFERENCE_H
#define LMB_TOOLS_CHECK_REFERENCE_H

#include <lambent/gather_sh3.h>

enum { CHECK_NORMALS = 8 };

/* Irradiance on the normals of one point. */
typedef struct irradiance_set {
    lmb_rgb at[CHECK_NORMALS];
} irradiance_set;

typedef struct check_reference {
    const lmb_transport *transport; /* that traces paths to their ends */
    uint32_t samples;               /* of each half, and up to CHECK_MORE_SAMPLES times as many where they leave it
                                       uncertain by more than CHECK_REFERENCE_NOISE */
    double mean_light;              /* about: of the level; what is dark is so beside it */
    bool without_keys;              /* leaves out the direct light of key lights */
} check_reference;

enum { CHECK_MORE_SAMPLES = 16 };

/* Of the light at a point, the reference's own noise there at most, if the samples suffice. */
#define CHECK_REFERENCE_NOISE 0.02

/* The reference at a point, as two independent halves. */
void check_reference_gather(const check_reference *reference, const lmb_gather_point *point, const lmb_vec3 *normals,
                            irradiance_set half[2]);

#endif
