#include "base/directions.h"

#include <math.h>

#include <lambent/vector.h>

#include "base/trig.h"
#include "base/vectorised.h"

/* Height of the point of the unit sphere by the lobe's distribution over heights. */
static inline float lobe_height(lmb_lobe lobe, float u)
{
    switch (lobe) {
    case LMB_LOBE_SPHERE:
        return 1.0f - 2.0f * u;
    case LMB_LOBE_HEMISPHERE: /* its distribution function is (z + z^2)/2 */
        return 0.5f * (sqrtf(9.0f - 8.0f * u) - 1.0f);
    default:
        return sqrtf(1.0f - u);
    }
}

static inline void lobe_directions(lmb_lobe lobe, lmb_vec3 axis, const float *restrict x, const float *restrict y,
                                   uint32_t count, float *const direction[3])
{
    float *restrict to_x = direction[0], *restrict to_y = direction[1], *restrict to_z = direction[2];
    lmb_vec3 tangent, bitangent;
    lmb_vec3_frame(axis, &tangent, &bitangent);
    for (uint32_t i = 0; i < count; ++i) {
        const float z = lobe_height(lobe, x[i]);
        const float square = (1.0f - z) * (1.0f + z);
        const float r = sqrtf(square > 0.0f ? square : 0.0f);
        float s, c;
        lmb_turn_sincos(y[i], &s, &c);
        to_x[i] = tangent.x * (r * c) + bitangent.x * (r * s) + axis.x * z;
        to_y[i] = tangent.y * (r * c) + bitangent.y * (r * s) + axis.y * z;
        to_z[i] = tangent.z * (r * c) + bitangent.z * (r * s) + axis.z * z;
    }
}

LMB_VECTORISED
void lmb_directions_make(lmb_lobe lobe, lmb_vec3 axis, const float *x, const float *y, uint32_t count,
                         float *const direction[3])
{
    const lmb_vec3 up = {0.0f, 0.0f, 1.0f};
    switch (lobe) {
    case LMB_LOBE_SPHERE:
        lobe_directions(LMB_LOBE_SPHERE, up, x, y, count, direction);
        break;
    case LMB_LOBE_HEMISPHERE:
        lobe_directions(LMB_LOBE_HEMISPHERE, axis, x, y, count, direction);
        break;
    default:
        lobe_directions(LMB_LOBE_COSINE, axis, x, y, count, direction);
        break;
    }
}

lmb_vec3 lmb_direction_make(lmb_lobe lobe, lmb_vec3 axis, const float point[2])
{
    lmb_vec3 made;
    float *const direction[3] = {&made.x, &made.y, &made.z};
    lmb_directions_make(lobe, axis, &point[0], &point[1], 1, direction);
    return made;
}
