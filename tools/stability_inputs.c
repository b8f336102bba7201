#include "stability_inputs.h"

#include <math.h>
#include <string.h>

#include <lambent/sequence.h>
#include <lambent/sh.h>
#include <lambent/vector.h>

/* Random numbers of one input. */
typedef struct variates {
    uint64_t index;
    uint32_t used;
} variates;

static double next(variates *u)
{
    return (double)lmb_random(UINT64_C(18), (uint32_t)(u->index >> 20), (uint32_t)(u->index & 0xfffff), u->used++);
}

static double between(variates *u, double low, double high)
{
    return low + (high - low) * next(u);
}

static lmb_vec3 direction(variates *u)
{
    const double z = between(u, -1.0, 1.0), turn = 2.0 * LMB_PI * next(u), radius = sqrt(1.0 - z * z);
    return lmb_vec3_unit_or(lmb_vec3_of((float)(radius * cos(turn)), (float)(radius * sin(turn)), (float)z),
                            lmb_vec3_of(0.0f, 1.0f, 0.0f));
}

/* The direction at an angle from n_v. */
static lmb_vec3 direction_at(variates *u, lmb_vec3 n_v, double angle)
{
    const lmb_vec3 across = lmb_vec3_unit_or(lmb_vec3_cross(n_v, direction(u)), n_v);
    return lmb_vec3_mad(lmb_vec3_scale(n_v, (float)cos(angle)), across, (float)sin(angle));
}

typedef struct making {
    variates u;
    lmb_vec3 n_v;
    lmb_sh3_rgb light;
    double cone_cos;
    double size; /* of n_v */
} making;

static lmb_rgb colour(variates *u, double scale)
{
    return (lmb_rgb){{(float)(scale * between(u, 0.05, 1.0)), (float)(scale * between(u, 0.05, 1.0)),
                      (float)(scale * between(u, 0.05, 1.0))}};
}

static void add_sky(making *m, double radiance)
{
    const lmb_rgb sky = colour(&m->u, radiance * 3.544907701811032); /* sqrt(4 pi): l0 of a constant */
    for (int c = 0; c < 3; ++c) {
        m->light.channel[c].c[0] += sky.c[c];
    }
}

static void add_lamps(making *m, int count)
{
    for (int i = 0; i < count; ++i) {
        lmb_sh3_rgb_add_light(&m->light, direction(&m->u), colour(&m->u, 3.0));
    }
}

static void make_level(making *m)
{
    add_sky(m, 0.5);
    add_lamps(m, 1 + (int)(4.0 * next(&m->u)));
}

static void make_any_coefficients(making *m)
{
    const double scale = pow(2.0, between(&m->u, -90.0, 90.0));
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            m->light.channel[c].c[i] = (float)(scale * between(&m->u, -1.0, 1.0));
        }
    }
}

static void make_ringing(making *m)
{
    make_level(m);
    for (int c = 0; c < 3; ++c) {
        for (int i = 1; i < LMB_SH3_COUNT; ++i) {
            m->light.channel[c].c[i] *= (float)between(&m->u, 0.0, 3.0);
        }
    }
}

static void make_delta(making *m)
{
    lmb_sh3_rgb_add_light(&m->light, direction_at(&m->u, m->n_v, LMB_PI * next(&m->u)), colour(&m->u, 1.0));
}

static void make_delta_on_axis(making *m)
{
    lmb_sh3_rgb_add_light(&m->light, direction_at(&m->u, m->n_v, pow(10.0, between(&m->u, -7.0, -1.0))),
                          colour(&m->u, 1.0));
}

static void make_delta_at_horizon(making *m)
{
    const double off = (next(&m->u) < 0.5 ? 1.0 : -1.0) * pow(10.0, between(&m->u, -7.0, -1.0));
    lmb_sh3_rgb_add_light(&m->light, direction_at(&m->u, m->n_v, 0.5 * LMB_PI + off), colour(&m->u, 1.0));
}

static void make_ring_at_horizon(making *m)
{
    const lmb_rgb light = colour(&m->u, 0.2);
    for (int i = 0; i < 16; ++i) {
        lmb_vec3 x, y;
        lmb_vec3_frame(m->n_v, &x, &y);
        const double turn = 2.0 * LMB_PI * i / 16.0;
        lmb_sh3_rgb_add_light(&m->light, lmb_vec3_mad(lmb_vec3_scale(x, (float)cos(turn)), y, (float)sin(turn)), light);
    }
}

/* As a hemisphere light has it, and hardly anything else: C_d -> 0. */
static void make_hemisphere(making *m)
{
    const lmb_rgb light = colour(&m->u, 1.0);
    lmb_sh3 basis = lmb_sh3_basis(m->n_v);
    for (int c = 0; c < 3; ++c) {
        m->light.channel[c].c[0] = 2.0f * light.c[c];
        for (int i = 1; i < 4; ++i) {
            m->light.channel[c].c[i] = 3.0f * light.c[c] * basis.c[i];
        }
    }
    lmb_sh3_rgb_add_light(&m->light, direction(&m->u), colour(&m->u, pow(10.0, between(&m->u, -9.0, -2.0))));
}

static void make_sun_beside_candle(making *m)
{
    lmb_sh3_rgb_add_light(&m->light, direction(&m->u), colour(&m->u, 1e6));
    lmb_sh3_rgb_add_light(&m->light, direction(&m->u), colour(&m->u, 1.0));
}

static void make_dark_or_denormal(making *m)
{
    if (next(&m->u) < 0.9) {
        make_any_coefficients(m);
        const float scale = (float)pow(2.0, between(&m->u, -60.0, -45.0));
        for (int c = 0; c < 3; ++c) {
            for (int i = 0; i < LMB_SH3_COUNT; ++i) {
                m->light.channel[c].c[i] *= scale;
            }
        }
    }
}

static void make_negative(making *m)
{
    make_level(m);
    const int c = (int)(3.0 * next(&m->u));
    m->light.channel[c].c[0] = -m->light.channel[c].c[0];
}

static void make_closing_cone(making *m)
{
    make_level(m);
    m->cone_cos = 1.0 - pow(10.0, between(&m->u, -8.0, -1.0));
}

static void make_cone_outside(making *m)
{
    make_level(m);
    m->cone_cos = next(&m->u) < 0.5 ? between(&m->u, -0.2, 0.0) : between(&m->u, 1.0, 1.2);
}

static void make_normal_not_unit(making *m)
{
    make_level(m);
    m->size = 1.0 + between(&m->u, -1e-3, 1e-3);
}

static const struct {
    const char *name;
    void (*make)(making *m);
} kinds[] = {
    {"light of a level", make_level},
    {"any coefficients", make_any_coefficients},
    {"light of a level", make_level},
    {"ringing", make_ringing},
    {"one light at any angle", make_delta},
    {"one light on the axis", make_delta_on_axis},
    {"one light at the horizon", make_delta_at_horizon},
    {"a ring at the horizon", make_ring_at_horizon},
    {"a hemisphere light", make_hemisphere},
    {"a sun beside a candle", make_sun_beside_candle},
    {"dark or denormal", make_dark_or_denormal},
    {"negative light", make_negative},
    {"a closing cone", make_closing_cone},
    {"a cone's cosine outside [0, 1]", make_cone_outside},
    {"a normal not quite unit", make_normal_not_unit},
};

static void put(lmb_vec3 v, double size, double at[3])
{
    at[0] = (double)(float)(size * (double)v.x);
    at[1] = (double)(float)(size * (double)v.y);
    at[2] = (double)(float)(size * (double)v.z);
}

const char *stability_input_make(uint64_t index, stability_input *input)
{
    const size_t kind = index % (sizeof kinds / sizeof kinds[0]);
    making m = {.u = {index, 0}, .cone_cos = 0.0, .size = 1.0};
    memset(input, 0, sizeof *input);
    m.n_v = direction(&m.u);
    if (next(&m.u) < 0.5) {
        m.cone_cos = next(&m.u);
    }
    kinds[kind].make(&m);
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            input->sh[c][i] = (double)m.light.channel[c].c[i];
        }
    }
    put(m.n_v, m.size, input->vertex_normal);
    put(m.n_v, 1.0, input->normal[0]);
    for (int k = 1; k < STABILITY_NORMALS; ++k) {
        put(direction(&m.u), 1.0, input->normal[k]);
    }
    input->cone_cos = (double)(float)m.cone_cos;
    return kinds[kind].name;
}

double stability_input_size(const stability_input *input)
{
    double size = 0.0;
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            size = fmax(size, fabs(input->sh[c][i]));
        }
    }
    return size;
}
