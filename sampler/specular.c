#include <lambent/specular.h>

#include <float.h>

#include "sh_internal.h"
#include "specular_tables.h"

/* Of the table's numbers. */
#define VALUE_STEP (1.0f / 16384.0f)

/* Of what the mean radiance gives, in the environment layer. */
#define ENVIRONMENT_LEAST 0.5f

/* The angles of a surface lit from one direction, and the view that goes with them. */
typedef struct facing {
    float light;      /* N.L > 0 */
    float view;       /* N.V >= 0 */
    float half_up;    /* N.H */
    float half_along; /* V.H = L.H */
} facing;

/* Cosine of the view, at or above the horizon. */
static float view_cosine(lmb_vec3 normal, lmb_vec3 view)
{
    return lmb_saturate(lmb_vec3_dot(normal, view));
}

/* @return whether the light is on the surface's side, and all else is a number. */
static bool facing_of(lmb_vec3 normal, lmb_vec3 view, lmb_vec3 light, facing *found)
{
    const lmb_vec3 half_vector = lmb_vec3_unit_or(lmb_vec3_add(view, light), normal);
    found->light = lmb_vec3_dot(normal, light);
    found->view = view_cosine(normal, view);
    found->half_up = lmb_vec3_dot(normal, half_vector);
    found->half_along = lmb_vec3_dot(view, half_vector);
    return found->light > 0.0f && found->half_up > 0.0f && found->half_along > 0.0f;
}

/* Of an unpolarised wave on a dielectric whose reflectance along the normal is f0 (Cook and Torrance 1981). */
static float fresnel(float f0, float cosine)
{
    const float root = sqrtf(lmb_saturate(f0));
    if (!(root < 0.9999f)) {
        return 1.0f;
    }
    const float c = lmb_saturate(cosine);
    const float index = (1.0f + root) / (1.0f - root);
    const float g = sqrtf(index * index + c * c - 1.0f);
    if (!(g > 0.0f)) {
        return 0.0f; /* f0 = 0: both sides are one */
    }
    const float across = (g - c) / (g + c);
    const float along = (c * (g + c) - 1.0f) / (c * (g - c) + 1.0f);
    return 0.5f * across * across * (1.0f + along * along);
}

static float analytic_roughness(const lmb_specular *specular)
{
    return lmb_larger(lmb_saturate(specular->roughness), LMB_SPECULAR_LEAST_ROUGHNESS);
}

/* Of a light that is seen through `lobe`, which counts normalised irradiance. */
static lmb_rgb light_reflected(const lmb_key_light *light, float lobe, const lmb_specular *specular, float cosine)
{
    lmb_rgb radiance;
    for (int c = 0; c < 3; ++c) {
        radiance.c[c] = lmb_light_clamped(light->irradiance.c[c] * fresnel(specular->f0.c[c], cosine) * lobe);
    }
    return radiance;
}

lmb_rgb lmb_specular_light(const lmb_key_light *light, float visibility, const lmb_specular *specular,
                           lmb_vec3 vertex_normal, lmb_vec3 normal, lmb_vec3 view)
{
    facing at;
    if (!(lmb_vec3_dot(vertex_normal, light->direction) > 0.0f) || !facing_of(normal, view, light->direction, &at)) {
        return lmb_rgb_of(0.0f, 0.0f, 0.0f);
    }
    const float m = analytic_roughness(specular);
    const float up2 = at.half_up * at.half_up;
    const float slope2 = lmb_larger(1.0f - up2, 0.0f) / up2;
    const float distribution = expf(-slope2 / (m * m)) / (m * m * up2 * up2); /* times pi, which irradiance lacks */
    const float twice = 2.0f * at.half_up / at.half_along;
    const float masked = lmb_smaller(twice * at.view, lmb_smaller(twice * at.light, 1.0f));
    /* G/(N.V): where the view is along the horizon the first of the three counts. */
    const float arrives = at.view > 1e-6f ? masked / at.view : twice;
    return light_reflected(light, 0.25f * distribution * arrives * visibility, specular, at.half_along);
}

static lmb_vec3 mirrored_view(lmb_vec3 normal, lmb_vec3 view)
{
    return lmb_vec3_mad(lmb_vec3_scale(view, -1.0f), normal, 2.0f * lmb_vec3_dot(normal, view));
}

lmb_rgb lmb_specular_light_phong(const lmb_key_light *light, float visibility, const lmb_specular *specular,
                                 lmb_vec3 vertex_normal, lmb_vec3 normal, lmb_vec3 view)
{
    const float cosine = lmb_vec3_dot(mirrored_view(normal, view), light->direction);
    facing at;
    if (!(lmb_vec3_dot(vertex_normal, light->direction) > 0.0f && cosine > 0.0f) ||
        !facing_of(normal, view, light->direction, &at)) {
        return lmb_rgb_of(0.0f, 0.0f, 0.0f);
    }
    const float m = analytic_roughness(specular);
    const float cosine2 = cosine * cosine;
    const float lobe =
        expf(-lmb_larger(1.0f - cosine2, 0.0f) / (cosine2 * m * m)) / (m * m * cosine2 * cosine); /* times pi */
    return light_reflected(light, lobe * visibility, specular, at.half_along);
}

lmb_key_light lmb_sh3_rgb_dominant_light(const lmb_sh3_rgb *radiance)
{
    const lmb_sh3 luminance = lmb_sh3_rgb_luminance(radiance);
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    const lmb_vec3 linear = lmb_sh_linear(luminance.c);
    const bool has_direction = lmb_vec3_dot(linear, linear) > 0.0f;
    lmb_key_light dominant = {lmb_vec3_unit_or(linear, up), {{0.0f, 0.0f, 0.0f}}};
    for (int c = 0; c < 3 && has_direction; ++c) {
        /* sum Y_i(d)^2 = 9/(4 pi); over pi once more for the normalised irradiance. */
        const float sum = lmb_sh3_evaluate(&radiance->channel[c], dominant.direction);
        dominant.irradiance.c[c] = lmb_light_clamped(sum * (4.0f / 9.0f));
    }
    return dominant;
}

float lmb_sh3_rgb_light_visibility(const lmb_sh3_rgb *radiance, const lmb_key_light *light)
{
    const lmb_sh3 luminance = lmb_sh3_rgb_luminance(radiance);
    const float seen = lmb_sh3_evaluate(&luminance, light->direction) * (4.0f / 9.0f);
    return lmb_saturate(seen / lmb_larger(lmb_luminance(light->irradiance), FLT_MIN));
}

enum { LMB_SPECULAR_BASES = LMB_SPECULAR_VALUES / 2 };

/* A lobe's twelve numbers between the nodes of the table (docs/maths.md has them). */
typedef struct specular_lobe {
    float value[LMB_SPECULAR_VALUES];
} specular_lobe;

/* Where a coordinate in [0, 1] lies between nodes. */
typedef struct between_nodes {
    int first;
    float second_share;
} between_nodes;

static between_nodes nodes_find(float coordinate, int count)
{
    const float at = coordinate * (float)(count - 1);
    const int first = at < (float)(count - 2) ? (int)at : count - 2;
    return (between_nodes){first, at - (float)first};
}

static specular_lobe lobe_find(float roughness, float cosine)
{
    const between_nodes row = nodes_find(sqrtf(lmb_saturate(roughness)), LMB_SPECULAR_ROWS);
    const between_nodes column = nodes_find(0.5f * (cosine + sqrtf(cosine)), LMB_SPECULAR_COLUMNS);
    const int16_t(*const low)[LMB_SPECULAR_VALUES] = &lmb_specular_table[row.first][column.first];
    const int16_t(*const high)[LMB_SPECULAR_VALUES] = &lmb_specular_table[row.first + 1][column.first];
    const float right = VALUE_STEP * column.second_share, left = VALUE_STEP - right;
    specular_lobe lobe;
    for (int i = 0; i < LMB_SPECULAR_VALUES; ++i) {
        const float below = left * (float)low[0][i] + right * (float)low[1][i];
        const float above = left * (float)high[0][i] + right * (float)high[1][i];
        lobe.value[i] = below + (above - below) * row.second_share;
    }
    return lobe;
}

/* The view about the normal. */
typedef struct view_frame {
    lmb_vec3 normal;
    lmb_vec3 aside; /* the part of the view across the normal; its length is the sine */
    float sine2;
} view_frame;

/* What the lobes see of harmonics about the normal, on the side that the view is not on: the six that mirror symmetry
 * leaves, as the table has them. */
static void light_in_frame(const lmb_sh3 *radiance, const view_frame *frame, float light[LMB_SPECULAR_BASES])
{
    const lmb_vec3 v = lmb_sh_linear(radiance->c);
    const lmb_vec3 by_normal = lmb_sh3_quadratic_times(radiance, frame->normal);
    const lmb_vec3 by_aside = lmb_sh3_quadratic_times(radiance, frame->aside);
    const float along = lmb_vec3_dot(by_normal, frame->normal);
    light[0] = radiance->c[0];
    light[1] = lmb_vec3_dot(v, frame->normal);
    light[2] = -lmb_vec3_dot(v, frame->aside);
    light[3] = along * (float)(0.5 / LMB_SH_N20);
    light[4] = -lmb_vec3_dot(by_normal, frame->aside) * (float)(2.0 / LMB_SH_N2);
    light[5] = (2.0f * lmb_vec3_dot(by_aside, frame->aside) + frame->sine2 * along) * (float)(0.5 / LMB_SH_N22);
}

/* The area layer, which counts no less than a share of what the mean radiance gives. */
static lmb_rgb area_reflected(const lmb_sh3_rgb *radiance, const lmb_specular *specular, lmb_vec3 normal, lmb_vec3 view,
                              float least_share)
{
    const lmb_vec3 aside = lmb_vec3_mad(view, normal, -lmb_vec3_dot(normal, view));
    const view_frame frame = {normal, aside, lmb_vec3_dot(aside, aside)};
    const specular_lobe lobe = lobe_find(specular->roughness, view_cosine(normal, view));
    lmb_rgb reflected;
    for (int c = 0; c < 3; ++c) {
        float light[LMB_SPECULAR_BASES], constant = 0.0f, schlick = 0.0f;
        light_in_frame(&radiance->channel[c], &frame, light);
        for (int i = 0; i < LMB_SPECULAR_BASES; ++i) {
            constant += lobe.value[i] * light[i];
            schlick += lobe.value[LMB_SPECULAR_BASES + i] * light[i];
        }
        const float f0 = lmb_saturate(specular->f0.c[c]);
        const float mean = (f0 * lobe.value[0] + (1.0f - f0) * lobe.value[LMB_SPECULAR_BASES]) * light[0];
        const float sum = f0 * constant + (1.0f - f0) * schlick;
        reflected.c[c] = lmb_light_clamped(lmb_larger(sum, least_share * mean));
    }
    return reflected;
}

lmb_rgb lmb_specular_area(const lmb_sh3_rgb *radiance, const lmb_specular *specular, lmb_vec3 normal, lmb_vec3 view)
{
    return area_reflected(radiance, specular, normal, view, 0.0f);
}

lmb_rgb lmb_specular_area_phong(const lmb_sh3_rgb *radiance, const lmb_specular *specular, lmb_vec3 normal,
                                lmb_vec3 view)
{
    const float m = lmb_saturate(specular->roughness), s = m * m;
    /* The lobe's means of P_1 and P_2 of cos(a) (docs/maths.md), to 1e-4. */
    const float linear = (1.0f + s * (2.217397f + s * 0.358538f)) / (1.0f + s * (2.715846f + s * 1.002374f));
    const float quadratic = (1.0f + s * (1.917728f - s * 0.474775f)) / (1.0f + s * (3.412533f + s * 1.778441f));
    const lmb_vec3 mirrored = mirrored_view(normal, view);
    const float beside = 1.0f - view_cosine(normal, view), beside2 = beside * beside;
    const float schlick = beside2 * beside2 * beside;
    lmb_rgb reflected;
    for (int c = 0; c < 3; ++c) {
        lmb_sh3 blurred = radiance->channel[c];
        for (int i = 1; i < LMB_SH3_COUNT; ++i) {
            blurred.c[i] *= i < LMB_SH2_COUNT ? linear : quadratic;
        }
        const float f0 = lmb_saturate(specular->f0.c[c]);
        reflected.c[c] = lmb_light_clamped((f0 + (1.0f - f0) * schlick) * lmb_sh3_evaluate(&blurred, mirrored));
    }
    return reflected;
}

lmb_rgb lmb_specular_environment(lmb_rgb map, const lmb_sh3_rgb *radiance, const lmb_specular *specular,
                                 lmb_vec3 normal, lmb_vec3 view)
{
    lmb_rgb reflected = area_reflected(radiance, specular, normal, view, ENVIRONMENT_LEAST);
    for (int c = 0; c < 3; ++c) {
        reflected.c[c] = lmb_light_clamped(reflected.c[c] * map.c[c]);
    }
    return reflected;
}

lmb_rgb lmb_specular_environment_divisor(const lmb_sh3_rgb *radiance, float roughness, lmb_vec3 direction)
{
    const lmb_specular mirror = {roughness, {{1.0f, 1.0f, 1.0f}}};
    return area_reflected(radiance, &mirror, direction, direction, ENVIRONMENT_LEAST);
}

/* How far along a ray a coordinate meets the side of a box that it goes towards. */
static float side_distance(float position, float direction, float low, float high)
{
    return direction > 0.0f ? (high - position) / direction : direction < 0.0f ? (low - position) / direction : FLT_MAX;
}

lmb_vec3 lmb_specular_proxy_direction(const lmb_specular_proxy *proxy, lmb_vec3 position, lmb_vec3 mirrored)
{
    const lmb_vec3 low = proxy->low, high = proxy->high, at = proxy->position;
    const lmb_vec3 inside = {lmb_larger(lmb_smaller(position.x, high.x), low.x),
                             lmb_larger(lmb_smaller(position.y, high.y), low.y),
                             lmb_larger(lmb_smaller(position.z, high.z), low.z)};
    const float x = side_distance(inside.x, mirrored.x, low.x, high.x);
    const float y = side_distance(inside.y, mirrored.y, low.y, high.y);
    const float z = side_distance(inside.z, mirrored.z, low.z, high.z);
    const float distance = lmb_smaller(x, lmb_smaller(y, z));
    return lmb_vec3_unit_or(lmb_vec3_mad(lmb_vec3_sub(inside, at), mirrored, distance), mirrored);
}

void lmb_specular_textures(float rgba[LMB_SPECULAR_TEXTURES][LMB_SPECULAR_ROWS][LMB_SPECULAR_COLUMNS][4])
{
    static const int value[LMB_SPECULAR_TEXTURES][4] = {{0, 1, 2, 3}, {6, 7, 8, 9}, {4, 5, 10, 11}};
    for (int t = 0; t < LMB_SPECULAR_TEXTURES; ++t) {
        for (int row = 0; row < LMB_SPECULAR_ROWS; ++row) {
            for (int column = 0; column < LMB_SPECULAR_COLUMNS; ++column) {
                for (int i = 0; i < 4; ++i) {
                    rgba[t][row][column][i] = VALUE_STEP * (float)lmb_specular_table[row][column][value[t][i]];
                }
            }
        }
    }
}
