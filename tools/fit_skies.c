#include "fit_skies.h"

#include <math.h>
#include <string.h>

#include <lambent/vector.h>

/* Directions fill the sphere evenly from +z down, so that a cone about +z is the first few of them; radiance is that
 * of so many small lights, which both the harmonics and the irradiance are exact for. */
enum { DIRECTIONS = 1024, SUN_POINTS = 24, MOST_SUNS = 16, MOST_WALLS = 2, MOST_STAINS = 10, MOST_WINDOWS = 3 };

/* Directions in the narrowest cone: 18 degrees, cosine 0.95. */
enum { NARROWEST_CONE = 25 };

typedef struct sky_turn {
    lmb_vec3 axis[3];
} sky_turn;

typedef struct sky_wall {
    lmb_vec3 axis;
    float height; /* directions with axis.w above it see the wall */
    float radiance;
} sky_wall;

typedef struct sky_stain {
    lmb_vec3 axis;
    float narrowness;
    float gain;
} sky_stain;

typedef struct sky_window {
    int face; /* 2 axis + (positive) */
    float low[2], high[2];
    float radiance;
} sky_window;

typedef struct sky_sun {
    lmb_vec3 point[SUN_POINTS];
    float weight; /* of each point: radiance times solid angle */
} sky_sun;

typedef struct sky {
    bool room;
    lmb_vec3 up;
    float zenith, horizon, bend; /* outdoors: from horizon to zenith by bend t + (1 - bend) t^2 */
    float ground, ground_slope;
    float face_distance[6], face_radiance[6];
    int window_count, stain_count, wall_count, sun_count;
    sky_window window[MOST_WINDOWS];
    sky_stain stain[MOST_STAINS];
    sky_wall wall[MOST_WALLS];
    sky_sun sun[MOST_SUNS];
} sky;

/* How a surface sees a sky. */
typedef struct sky_view {
    sky_turn turn;
    fit_context context;
    float wall[2];  /* radiance over I_z of the two halves of what takes the lower hemisphere's place */
    float split[2]; /* tangential, from the second half to the first */
    int cone_end;   /* the first direction outside the cone */
    float cone_cos;
} sky_view;

/* What it sees: l0, l1z, v, l2z, q, m, with positive axes, and what should be made of it. */
typedef struct seen_light {
    float l[9];
    float irradiance[FIT_NORMALS];
    float irradiance_z; /* of the whole hemisphere */
} seen_light;

float fit_normal[3][FIT_NORMALS];
static lmb_vec3 direction[DIRECTIONS];
static float basis[DIRECTIONS][9];
static float cosine[DIRECTIONS / 2][FIT_NORMALS];

/* SplitMix64 (Steele et al. 2014); in [0, 1). */
double fit_variate(uint64_t *state)
{
    *state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t z = (*state ^ (*state >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static float between(uint64_t *random, double low, double high)
{
    return (float)(low + (high - low) * fit_variate(random));
}

/* Even in the logarithm. */
static float magnitude_between(uint64_t *random, double low, double high)
{
    return (float)(low * pow(high / low, fit_variate(random)));
}

static int count_below(uint64_t *random, int end)
{
    return (int)(fit_variate(random) * end);
}

/* Point i of `count` that fill the sphere evenly from +z down. */
static lmb_vec3 spiral(int i, int count)
{
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double r = sqrt(1.0 - z * z), angle = i * 2.39996322972865332; /* the golden angle */
    return lmb_vec3_of((float)(r * cos(angle)), (float)(r * sin(angle)), (float)z);
}

static lmb_vec3 sphere_direction(uint64_t *random)
{
    const double z = 2.0 * fit_variate(random) - 1.0, angle = 2.0 * LMB_PI * fit_variate(random);
    const double r = sqrt(1.0 - z * z);
    return lmb_vec3_of((float)(r * cos(angle)), (float)(r * sin(angle)), (float)z);
}

static sky_turn random_turn(uint64_t *random)
{
    sky_turn t;
    lmb_vec3 x, y;
    t.axis[2] = sphere_direction(random);
    lmb_vec3_frame(t.axis[2], &x, &y);
    const double angle = 2.0 * LMB_PI * fit_variate(random);
    const float c = (float)cos(angle), s = (float)sin(angle);
    t.axis[0] = lmb_vec3_mad(lmb_vec3_scale(x, c), y, s);
    t.axis[1] = lmb_vec3_mad(lmb_vec3_scale(y, c), x, -s);
    return t;
}

static lmb_vec3 turned(const sky_turn *t, lmb_vec3 w)
{
    return lmb_vec3_of(lmb_vec3_dot(t->axis[0], w), lmb_vec3_dot(t->axis[1], w), lmb_vec3_dot(t->axis[2], w));
}

static void basis_at(lmb_vec3 w, float *y)
{
    const double n1 = sqrt(3.0 / (4.0 * LMB_PI)), n2 = sqrt(15.0 / (4.0 * LMB_PI));
    y[0] = (float)(0.5 / sqrt(LMB_PI));
    y[1] = (float)n1 * w.z;
    y[2] = (float)n1 * w.x;
    y[3] = (float)n1 * w.y;
    y[4] = (float)sqrt(5.0 / (16.0 * LMB_PI)) * (3.0f * w.z * w.z - 1.0f);
    y[5] = (float)n2 * w.x * w.z;
    y[6] = (float)n2 * w.y * w.z;
    y[7] = (float)(0.5 * n2) * (w.x * w.x - w.y * w.y);
    y[8] = (float)n2 * w.x * w.y;
}

static float cosine_at(int normal, lmb_vec3 w)
{
    return fmaxf(0.0f, fit_normal[0][normal] * w.x + fit_normal[1][normal] * w.y + fit_normal[2][normal] * w.z);
}

static void tables_make(void)
{
    for (int k = 0; k < FIT_NORMALS; ++k) {
        const lmb_vec3 n = spiral(k, 2 * FIT_NORMALS);
        fit_normal[0][k] = n.x;
        fit_normal[1][k] = n.y;
        fit_normal[2][k] = n.z;
    }
    for (int i = 0; i < DIRECTIONS; ++i) {
        direction[i] = spiral(i, DIRECTIONS);
        basis_at(direction[i], basis[i]);
        for (int k = 0; k < FIT_NORMALS && i < DIRECTIONS / 2; ++k) {
            cosine[i][k] = cosine_at(k, direction[i]);
        }
    }
}

static void room_make(uint64_t *random, sky *s)
{
    const float albedo = between(random, 0.1, 0.9);
    for (int f = 0; f < 6; ++f) {
        s->face_distance[f] = magnitude_between(random, 0.1, 1.0);
        s->face_radiance[f] = albedo * magnitude_between(random, 0.3, 3.0);
    }
    s->window_count = count_below(random, MOST_WINDOWS + 1);
    for (int i = 0; i < s->window_count; ++i) {
        sky_window *w = &s->window[i];
        w->face = count_below(random, 6);
        w->radiance = magnitude_between(random, 2.0, 60.0);
        for (int a = 0; a < 2; ++a) {
            const float middle = between(random, -1.0, 1.0), half = magnitude_between(random, 0.1, 1.0);
            w->low[a] = middle - half;
            w->high[a] = middle + half;
        }
    }
}

static void outdoors_make(uint64_t *random, sky *s)
{
    s->zenith = magnitude_between(random, 0.2, 2.0);
    s->horizon = magnitude_between(random, 0.2, 2.0);
    s->bend = between(random, 0.0, 2.0);
    if (fit_variate(random) < 0.15) { /* night, or nothing but what lamps and suns that are kept apart light */
        const float dark = magnitude_between(random, 0.001, 0.3);
        s->zenith *= dark;
        s->horizon *= dark;
    }
    s->ground = between(random, 0.02, 0.9) * magnitude_between(random, 0.4, 1.6);
    s->ground_slope = between(random, -0.5, 0.5);
}

/* `flux` is what all of the sky sends without it: integral of the radiance. */
static void sun_make(uint64_t *random, double flux, sky_sun *s)
{
    const float radius_deg = magnitude_between(random, 0.3, 60.0);
    const double height = 1.0 - cos((double)radius_deg * LMB_PI / 180.0);
    const sky_turn t = random_turn(random);
    for (int i = 0; i < SUN_POINTS; ++i) {
        const double z = 1.0 - height * (i + 0.5) / SUN_POINTS, angle = i * 2.39996322972865332;
        const double r = sqrt(1.0 - z * z);
        s->point[i] = turned(&t, lmb_vec3_of((float)(r * cos(angle)), (float)(r * sin(angle)), (float)z));
    }
    s->weight = (float)(flux / SUN_POINTS * (double)magnitude_between(random, 0.02, 10.0));
}

static float room_radiance(const sky *s, lmb_vec3 w)
{
    const float d[3] = {w.x, w.y, w.z};
    int face = 0;
    float nearest = 0.0f;
    for (int a = 0; a < 3; ++a) {
        const int f = 2 * a + (d[a] > 0.0f);
        const float closeness = fabsf(d[a]) / s->face_distance[f];
        if (closeness > nearest) {
            nearest = closeness;
            face = f;
        }
    }
    const float u = d[(face / 2 + 1) % 3] / nearest, v = d[(face / 2 + 2) % 3] / nearest;
    for (int i = 0; i < s->window_count; ++i) {
        const sky_window *win = &s->window[i];
        if (win->face == face && u > win->low[0] && u < win->high[0] && v > win->low[1] && v < win->high[1]) {
            return win->radiance;
        }
    }
    return s->face_radiance[face];
}

static float outdoor_radiance(const sky *s, lmb_vec3 w)
{
    const float t = lmb_vec3_dot(w, s->up);
    if (t < 0.0f) {
        return s->ground * (1.0f - s->ground_slope * t);
    }
    return s->horizon + (s->zenith - s->horizon) * (s->bend * t + (1.0f - s->bend) * t * t);
}

/* Everything but suns. */
static float radiance_at(const sky *s, lmb_vec3 w)
{
    for (int i = 0; i < s->wall_count; ++i) {
        if (lmb_vec3_dot(w, s->wall[i].axis) > s->wall[i].height) {
            return s->wall[i].radiance;
        }
    }
    float radiance = s->room ? room_radiance(s, w) : outdoor_radiance(s, w);
    for (int i = 0; i < s->stain_count; ++i) {
        const float lobe = 1.0f / (1.0f + s->stain[i].narrowness * (1.0f - lmb_vec3_dot(w, s->stain[i].axis)));
        radiance *= 1.0f + s->stain[i].gain * lobe * lobe;
    }
    return radiance;
}

static double sky_flux(const sky *s)
{
    double sum = 0.0;
    for (int i = 0; i < DIRECTIONS; i += 16) {
        sum += (double)radiance_at(s, direction[i]);
    }
    return sum * 16.0 * 4.0 * LMB_PI / DIRECTIONS;
}

static sky sky_make(uint64_t *random)
{
    sky s = {.room = fit_variate(random) < 0.35, .up = sphere_direction(random)};
    if (s.room) {
        room_make(random, &s);
    } else {
        outdoors_make(random, &s);
    }
    s.stain_count = count_below(random, MOST_STAINS + 1);
    for (int i = 0; i < s.stain_count; ++i) {
        s.stain[i].axis = sphere_direction(random);
        s.stain[i].narrowness = magnitude_between(random, 1.0, 100.0);
        s.stain[i].gain = fit_variate(random) < 0.5 ? between(random, -0.9, 0.0) : magnitude_between(random, 0.2, 10.0);
    }
    const int walls = fit_variate(random) < 0.4 ? 1 + count_below(random, MOST_WALLS) : 0;
    const double flux = sky_flux(&s);
    for (int i = 0; i < walls; ++i) {
        s.wall[i].axis = sphere_direction(random);
        s.wall[i].height = between(random, 0.0, 0.7);
        s.wall[i].radiance = (float)(flux / (4.0 * LMB_PI)) * between(random, 0.1, 0.9);
        s.wall[i].radiance *= magnitude_between(random, 0.3, 3.0);
    }
    s.wall_count = walls;
    /* None, a sun or two, or many lamps: of the latter nine numbers tell little, and what is fitted must know that. */
    const double suns = fit_variate(random);
    s.sun_count = suns < 0.25 ? 0 : suns < 0.65 ? 1 + count_below(random, 2) : 3 + count_below(random, MOST_SUNS - 2);
    for (int i = 0; i < s.sun_count; ++i) {
        sun_make(random, s.sun_count > 2 ? 0.2 * flux : flux, &s.sun[i]);
    }
    return s;
}

static void moments_add(seen_light *light, const float *y, float weight)
{
    for (int j = 0; j < 9; ++j) {
        light->l[j] += weight * y[j];
    }
}

static void irradiance_add(seen_light *light, const float *cosines, float weight)
{
    for (int k = 0; k < FIT_NORMALS; ++k) {
        light->irradiance[k] += weight / LMB_PI_F * cosines[k];
    }
}

static bool behind_wall(const sky *s, lmb_vec3 w)
{
    for (int i = 0; i < s->wall_count; ++i) {
        if (lmb_vec3_dot(w, s->wall[i].axis) > s->wall[i].height) {
            return true;
        }
    }
    return false;
}

static void suns_add(const sky *s, const sky_view *view, seen_light *light)
{
    const lmb_vec3 *axis = view->turn.axis;
    for (int i = 0; i < s->sun_count * SUN_POINTS; ++i) {
        const sky_sun *sun = &s->sun[i / SUN_POINTS];
        const lmb_vec3 from = sun->point[i % SUN_POINTS];
        /* The transpose of the turn: from the sky to the surface. */
        const lmb_vec3 w =
            lmb_vec3_mad(lmb_vec3_mad(lmb_vec3_scale(axis[0], from.x), axis[1], from.y), axis[2], from.z);
        if (behind_wall(s, from) || (view->context != FIT_OPEN && w.z <= 0.0f)) {
            continue;
        }
        float y[9];
        basis_at(w, y);
        moments_add(light, y, sun->weight);
        light->irradiance_z += sun->weight / LMB_PI_F * fmaxf(0.0f, w.z);
        if (w.z > view->cone_cos) {
            float cosines[FIT_NORMALS];
            for (int k = 0; k < FIT_NORMALS; ++k) {
                cosines[k] = cosine_at(k, w);
            }
            irradiance_add(light, cosines, sun->weight);
        }
    }
}

static seen_light see(const sky *s, const sky_view *view)
{
    const float solid_angle = 4.0f * LMB_PI_F / DIRECTIONS;
    seen_light light = {.irradiance_z = 0.0f};
    for (int i = 0; i < DIRECTIONS / 2; ++i) {
        const float weight = solid_angle * radiance_at(s, turned(&view->turn, direction[i]));
        moments_add(&light, basis[i], weight);
        light.irradiance_z += weight / LMB_PI_F * direction[i].z;
        if (i < view->cone_end) {
            irradiance_add(&light, cosine[i], weight);
        }
    }
    suns_add(s, view, &light);
    const float wall[2] = {view->wall[0] * light.irradiance_z, view->wall[1] * light.irradiance_z};
    for (int i = DIRECTIONS / 2; i < DIRECTIONS; ++i) {
        const lmb_vec3 w = direction[i];
        const float radiance = view->context == FIT_OPEN ? radiance_at(s, turned(&view->turn, w))
                                                         : wall[w.x * view->split[0] + w.y * view->split[1] < 0.0f];
        moments_add(&light, basis[i], solid_angle * radiance);
    }
    return light;
}

static fit_example example_of(const seen_light *light, const sky_view *view)
{
    const float scale = 1.0f / light->l[0];
    fit_example example = {.context = view->context};
    example.sh = (fit_sh3){.l1_zonal = scale * light->l[1],
                           .l2_zonal = scale * light->l[4],
                           .v = {scale * light->l[2], scale * light->l[3]},
                           .q = {scale * light->l[5], scale * light->l[6]},
                           .m = {scale * light->l[7], scale * light->l[8]},
                           .cone_cos = view->cone_cos};
    for (int k = 0; k < FIT_NORMALS; ++k) {
        example.irradiance[k] = scale * light->irradiance[k];
    }
    return example;
}

/* How all turns of one sky are seen: alike, so that their errors can be compared. */
static sky_view view_make(uint64_t *random, bool cones)
{
    sky_view v = {.context = FIT_OPEN, .cone_end = DIRECTIONS / 2};
    const double kind = fit_variate(random);
    if (kind > 0.4) {
        v.context = kind > 0.75 ? FIT_TWO_TONED : FIT_WALL;
    }
    if (cones) {
        v.cone_end = NARROWEST_CONE + count_below(random, DIRECTIONS / 2 - NARROWEST_CONE);
    }
    v.cone_cos = 1.0f - 2.0f * (float)v.cone_end / DIRECTIONS;
    return v;
}

static void view_turn(uint64_t *random, sky_view *v)
{
    v->turn = random_turn(random);
    float albedo = between(random, 0.1, 0.9);
    if (fit_variate(random) < 0.25) { /* lit by a sun too, whose light is kept apart from the probe's */
        albedo *= 1.0f + magnitude_between(random, 0.1, 20.0);
    }
    const float contrast = v->context == FIT_TWO_TONED ? between(random, 0.0, 1.0) : 0.0f;
    v->wall[0] = albedo * (1.0f + contrast);
    v->wall[1] = albedo * (1.0f - contrast);
    const double angle = 2.0 * LMB_PI * fit_variate(random);
    v->split[0] = (float)cos(angle);
    v->split[1] = (float)sin(angle);
}

/* Mean square of what a surface should get. In a cone that hardly any light comes through no less than a part of what
 * the hemisphere would give: nothing can be told there, and it must not count for all. */
static float mean_square(const seen_light *light, float cone_cos)
{
    float sum = 0.0f;
    for (int k = 0; k < FIT_NORMALS; ++k) {
        sum += light->irradiance[k] * light->irradiance[k] / FIT_NORMALS;
    }
    const float opening = 1.0f - cone_cos * cone_cos, whole = opening * light->irradiance_z;
    return cone_cos > 0.0f ? lmb_larger(sum, 0.3f * whole * whole) : sum;
}

void fit_examples_make(uint64_t seed, bool cones, size_t count, fit_example *examples)
{
    tables_make();
    uint64_t random = seed;
    for (size_t i = 0; i < count; i += FIT_TURNS) {
        const sky s = sky_make(&random);
        sky_view v = view_make(&random, cones);
        float l0[FIT_TURNS], square[FIT_TURNS], mean = 0.0f;
        for (size_t t = 0; t < FIT_TURNS; ++t) {
            view_turn(&random, &v);
            const seen_light light = see(&s, &v);
            examples[i + t] = example_of(&light, &v);
            l0[t] = light.l[0];
            square[t] = mean_square(&light, v.cone_cos);
            mean += square[t] / FIT_TURNS;
        }
        /* Errors count by the light of their sky, not of their own turn alone, which may face away from all of it. */
        for (size_t t = 0; t < FIT_TURNS; ++t) {
            examples[i + t].weight = l0[t] * l0[t] / (0.8f * mean + 0.2f * square[t]);
        }
    }
}
