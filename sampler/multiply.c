#include <lambent/hhd.h>
#include <lambent/occlusion.h>

#include "multiply_weights.h"
#include "occlusion_internal.h"
#include "sh_internal.h"

enum {
    INVARIANTS = LMB_MULTIPLY_INVARIANTS,
    FIRST = LMB_MULTIPLY_FIRST,
    SECOND = LMB_MULTIPLY_SECOND,
    OUTPUTS = LMB_MULTIPLY_OUTPUTS
};

/* weight[0][u] x[0] + ... + weight[3][u] x[3], for one unit u. Sums are written out and loops run over units, so that
 * vector instructions take several units at once and give the same bits as others; as trees, so that few additions wait
 * for one another. */
#define SUM_4(weight, x, u)                                                                                            \
    (((weight)[0][u] * (x)[0] + (weight)[1][u] * (x)[1]) + ((weight)[2][u] * (x)[2] + (weight)[3][u] * (x)[3]))
#define SUM_8(weight, x, u) (SUM_4(weight, x, u) + SUM_4((weight) + 4, (x) + 4, u))
#define SUM_12(start, weight, x, u) (SUM_8(weight, x, u) + (SUM_4((weight) + 8, (x) + 8, u) + (start)))

_Static_assert(INVARIANTS == 8 && FIRST == 12 && SECOND == 12 && OUTPUTS == 4, "sums are as long as they are written");

/* `start` is what the first layer's sums start from; the last of `output` is the factor of Q v. */
static inline void network_run(const lmb_multiply_network *network, const float *start, const float *x, float *output)
{
    float first[FIRST], second[SECOND], part[4];
    for (int u = 0; u < FIRST; ++u) {
        first[u] = lmb_larger(start[u] + SUM_8(network->invariant, x, u), 0.0f);
    }
    for (int u = 0; u < SECOND; ++u) {
        second[u] = lmb_larger(SUM_12(network->second[u], network->first_weight, first, u), 0.0f);
    }
    for (int u = 0; u < OUTPUTS; ++u) {
        output[u] = SUM_12(network->output[u], network->second_weight, second, u);
    }
    const float *qv = network->qv_weight;
    for (int u = 0; u < 4; ++u) {
        part[u] = (qv[u] * second[u] + qv[4 + u] * second[4 + u]) + qv[8 + u] * second[8 + u];
    }
    output[OUTPUTS] = ((part[0] + part[1]) + (part[2] + part[3])) + network->qv;
}

static inline float clamped(float x, float low, float high)
{
    return lmb_smaller(lmb_larger(x, low), high);
}

/* The most that v.v, and q.q and tr Q^2 / 2, are for non-negative light. */
#define MOST_V_V 3.0f
#define MOST_Q_Q 3.75f

/* Light about an axis n, over l0. With V and M of sh_internal.h, z1 = n.V and mz = n.Mn, the tangential vectors are
 *
 *     v = V - z1 n     q = 2/N2 (Mn - mz n)
 *     Q v = 1/N22 [Mv - n (n.Mv) + mz/2 v]     Mv = MV - z1 Mn     n.Mv = N2/2 v.q
 *
 * (the tangential block of M has the trace -mz, half of which goes on each axis of Q). Only n, V, Mn and MV are ever
 * made: all else are their products. */
typedef struct axis_light {
    lmb_vec3 linear, quadratic, both; /* V, Mn, MV */
    float z1, mz;
    float square;        /* of bands 1 and 2 */
    float v_v, q_q, m_m; /* m_m = tr Q^2 / 2 */
    float v_q, v_mv, q_mv;
} axis_light;

static inline axis_light axis_light_of(const lmb_sh3 *sh, float band1, float band2, lmb_vec3 n)
{
    const float to_q = (float)(2.0 / LMB_SH_N2);
    axis_light l = {.linear = lmb_sh_linear(sh->c), .square = band1 + band2};
    l.quadratic = lmb_sh3_quadratic_times(sh, n);
    l.both = lmb_sh3_quadratic_times(sh, l.linear);
    l.z1 = lmb_vec3_dot(n, l.linear);
    l.mz = lmb_vec3_dot(n, l.quadratic);
    const float linear_quadratic = lmb_vec3_dot(l.linear, l.quadratic);
    const float quadratic_squared = lmb_vec3_dot(l.quadratic, l.quadratic);
    const float v_mn = linear_quadratic - l.z1 * l.mz;
    l.v_v = lmb_larger(band1 - l.z1 * l.z1, 0.0f);
    l.q_q = lmb_larger(to_q * to_q * (quadratic_squared - l.mz * l.mz), 0.0f);
    l.m_m = lmb_larger(band2 - (float)(0.25 / (LMB_SH_N20 * LMB_SH_N20)) * (l.mz * l.mz) - l.q_q, 0.0f);
    l.v_q = to_q * v_mn;
    l.v_mv = lmb_vec3_dot(l.linear, l.both) - l.z1 * (linear_quadratic + v_mn);
    l.q_mv = to_q * (lmb_vec3_dot(l.quadratic, l.both) - l.z1 * quadratic_squared - l.mz * v_mn);
    return l;
}

/* Factors that shorten v, q and Q to what non-negative light can have (docs/maths.md, Bounds and ringing). */
typedef struct shortening {
    float v, q, m;
} shortening;

static shortening shortening_of(const axis_light *l)
{
    return (shortening){l->v_v > MOST_V_V ? sqrtf(MOST_V_V / l->v_v) : 1.0f,
                        l->q_q > MOST_Q_Q ? sqrtf(MOST_Q_Q / l->q_q) : 1.0f,
                        l->m_m > MOST_Q_Q ? sqrtf(MOST_Q_Q / l->m_m) : 1.0f};
}

/* What the network says: factors of v, q and Q v as they are. */
typedef struct correction {
    float scalar, zonal, v, q, qv;
} correction;

/* What the network is told is clamped to the bounds: beyond, it was never asked. */
static inline correction correction_of(const axis_light *l, float c)
{
    const float half_mz = 0.5f * l->mz, to_sectoral = (float)(1.0 / LMB_SH_N22);
    float x[INVARIANTS] = {
        clamped(l->z1, (float)-LMB_SQRT_3, (float)LMB_SQRT_3),
        clamped((float)(0.5 / LMB_SH_N20) * l->mz, (float)(-0.5 * LMB_SQRT_5), (float)LMB_SQRT_5),
        l->v_v,
        l->q_q,
        l->v_q,
        l->m_m,
        to_sectoral * (l->v_mv + half_mz * l->v_v),
        to_sectoral * (l->q_mv + half_mz * l->v_q),
    };
    shortening s = {1.0f, 1.0f, 1.0f};
    if (l->v_v > MOST_V_V || l->q_q > MOST_Q_Q || l->m_m > MOST_Q_Q) {
        s = shortening_of(l);
        x[2] *= s.v * s.v;
        x[3] *= s.q * s.q;
        x[4] *= s.v * s.q;
        x[5] *= s.m * s.m;
        x[6] *= s.m * (s.v * s.v);
        x[7] *= s.m * (s.v * s.q);
    }
    float output[OUTPUTS + 1];
    network_run(&lmb_multiply_opened, lmb_multiply_opened.first, x, output);
    /* Nothing is left in light that is the same from everywhere, of which Gram is right, nor where the cone closes. */
    float axial = l->square / (l->square + LMB_MULTIPLY_EVEN_SQUARE), tangential = axial;
    if (c > 0.0f) {
        float start[FIRST], closing[OUTPUTS + 1];
        for (int u = 0; u < FIRST; ++u) {
            start[u] = lmb_multiply_closing.first[u] + lmb_multiply_closing.cone[u] * c;
        }
        network_run(&lmb_multiply_closing, start, x, closing);
        for (int i = 0; i <= OUTPUTS; ++i) {
            output[i] += c * closing[i];
        }
        axial *= 1.0f - c;
        tangential = axial * sqrtf((1.0f - c) * (1.0f + c));
    }
    return (correction){axial * output[0], axial * output[1], tangential * s.v * output[2],
                        tangential * s.q * output[3], tangential * (s.v * s.m) * output[OUTPUTS]};
}

/* Gram's moments of the cone of cosine c, and the correction. */
static inline lmb_moments axis_light_moments(const axis_light *l, lmb_vec3 n, float c)
{
    const lmb_linear_gram g = c > 0.0f ? lmb_linear_gram_of_cone(c) : lmb_linear_gram_of_cone(0.0f);
    const correction k = correction_of(l, c);
    const float to_vector = (float)(2.0 / (LMB_SQRT_3 * LMB_SQRT_PI)), z2 = (float)(0.5 / LMB_SH_N20) * l->mz;
    const float scalar = g.g00_00 + g.g00_10 * l->z1 + g.g00_20 * z2;
    const float zonal = g.g00_10 + g.g10_10 * l->z1 + g.g10_20 * z2;
    const float mv = (float)(1.0 / LMB_SH_N22) * k.qv;
    const float v = to_vector * g.gx_x + (k.v + 0.5f * l->mz * mv);
    const float mn = (float)(2.0 / LMB_SH_N2) * (to_vector * g.gx_xz + k.q);
    const float tangential_along = (l->z1 * v + l->mz * mn) + (float)(0.5 * LMB_SH_N2) * l->v_q * mv;
    const float along = (to_vector * zonal + k.zonal) - tangential_along;
    const lmb_vec3 of_linear = lmb_vec3_mad(lmb_vec3_scale(n, along), l->linear, v);
    const lmb_vec3 of_both = lmb_vec3_mad(lmb_vec3_scale(l->quadratic, mn - l->z1 * mv), l->both, mv);
    const lmb_vec3 vector = lmb_vec3_add(of_linear, of_both);
    return (lmb_moments){(float)(2.0 / LMB_SQRT_PI) * scalar + k.scalar, vector};
}

/* Sums of squares over l0 from which on the harmonics tell of no light at all, and what the network says is as good as
 * nothing beside them. */
#define NO_LIGHT 1e12f

lmb_moments lmb_moments_from_probe(const lmb_sh3 *radiance, lmb_vec3 vertex_normal, float cone_cos)
{
    const float c = lmb_unit_interval_or_zero(cone_cos), l0 = radiance->c[0];
    lmb_sh3 sh = {{1.0f}};
    for (int i = 1; i < LMB_SH3_COUNT; ++i) {
        sh.c[i] = radiance->c[i] / l0;
    }
    const float *s = sh.c;
    const float band1 = s[1] * s[1] + s[2] * s[2] + s[3] * s[3];
    const float band2 = s[4] * s[4] + s[5] * s[5] + s[6] * s[6] + s[7] * s[7] + s[8] * s[8];
    if (!(l0 >= FLT_MIN && band1 + band2 < NO_LIGHT)) {
        const lmb_sh2 clipped = lmb_sh3_multiply_cone(radiance, vertex_normal, c);
        return lmb_moments_from_sh2(&clipped);
    }
    const axis_light light = axis_light_of(&sh, band1, band2, vertex_normal);
    const lmb_moments over_l0 = axis_light_moments(&light, vertex_normal, c);
    return (lmb_moments){l0 * over_l0.scalar, lmb_vec3_scale(over_l0.vector, l0)};
}
