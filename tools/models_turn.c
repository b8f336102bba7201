#include "models_turn.h"

#include <math.h>
#include <string.h>

#include <lambent/occlusion.h>
#include <lambent/sequence.h>
#include <lambent/vector.h>

static const lmb_vec3 up = {0.0f, 0.0f, 1.0f};

const char *models_input_name(models_input input)
{
    static const char *const names[MODELS_INPUT_COUNT] = {"lightmap", "probe", "probe-wall", "probe-wall31"};
    return names[input];
}

void models_normals(lmb_vec3 normal[MODELS_NORMAL_COUNT])
{
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        const double z = ((double)i + 0.5) / MODELS_NORMAL_COUNT, r = sqrt(1.0 - z * z);
        const double turn = 2.0 * LMB_PI * fmod((double)i * 0.61803398874989485, 1.0);
        normal[i] = lmb_vec3_of((float)(r * cos(turn)), (float)(r * sin(turn)), (float)z);
    }
}

/* Rows of the rotation matrix. Roberts 2018 for the sequence, Shoemake 1992 ("Uniform random rotations") for the map.
 */
static void rotation_make(uint32_t index, uint64_t seed, lmb_vec3 row[3])
{
    static const double step[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    double u[3];
    for (int i = 0; i < 3; ++i) {
        const double moved = seed == 0 ? 0.0 : (double)lmb_random(seed, 0, (uint32_t)i, 0);
        u[i] = fmod(((double)index + 1.0) * step[i] + moved, 1.0);
    }
    const double outer = sqrt(u[0]), inner = sqrt(1.0 - u[0]);
    const double w = outer * cos(2.0 * LMB_PI * u[2]), x = inner * sin(2.0 * LMB_PI * u[1]);
    const double y = inner * cos(2.0 * LMB_PI * u[1]), z = outer * sin(2.0 * LMB_PI * u[2]);
    row[0] = lmb_vec3_of((float)(1.0 - 2.0 * (y * y + z * z)), (float)(2.0 * (x * y - w * z)),
                         (float)(2.0 * (x * z + w * y)));
    row[1] = lmb_vec3_of((float)(2.0 * (x * y + w * z)), (float)(1.0 - 2.0 * (x * x + z * z)),
                         (float)(2.0 * (y * z - w * x)));
    row[2] = lmb_vec3_of((float)(2.0 * (x * z - w * y)), (float)(2.0 * (y * z + w * x)),
                         (float)(1.0 - 2.0 * (x * x + y * y)));
}

/* Sums of light times basis, in double. */
typedef struct moments_rgb {
    double c[3][LMB_SH3_COUNT];
} moments_rgb;

static void moments_add(moments_rgb *sum, const lmb_directed_light *light)
{
    const lmb_sh3 basis = lmb_sh3_basis(light->direction);
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            sum->c[c][i] += (double)light->weight.c[c] * (double)basis.c[i];
        }
    }
}

static lmb_sh3_rgb moments_sh3(const moments_rgb *sum)
{
    lmb_sh3_rgb sh3;
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            sh3.channel[c].c[i] = (float)sum->c[c][i];
        }
    }
    return sh3;
}

/* Adds the lower hemisphere at radiance `light` (1 + contrast sign(x)): there the integrals of Y_00 and Y_10 are
 * sqrt(pi) and -sqrt(3 pi)/2, those of sign(x) Y_11 and sign(x) Y_21 -sqrt(3 pi)/2 and sqrt(15/(4 pi)) 4/3. */
static void wall_add(lmb_sh3_rgb *sh3, lmb_rgb light, double contrast)
{
    const double root_pi = sqrt(LMB_PI), half_root_3_pi = 0.5 * sqrt(3.0 * LMB_PI);
    const double tilted = sqrt(15.0 / (4.0 * LMB_PI)) * 4.0 / 3.0;
    for (int c = 0; c < 3; ++c) {
        const double radiance = (double)light.c[c];
        float *coefficient = sh3->channel[c].c;
        coefficient[0] += (float)(radiance * root_pi);
        coefficient[2] -= (float)(radiance * half_root_3_pi);
        coefficient[3] -= (float)(radiance * contrast * half_root_3_pi);
        coefficient[7] += (float)(radiance * contrast * tilted);
    }
}

/* All normals at once for each light, so that the compiler makes vectors of them. */
void models_turn_reference(const models_turn *turn, lmb_vec3 axis, float cone_cos,
                           const lmb_vec3 normal[MODELS_NORMAL_COUNT], lmb_rgb irradiance[MODELS_NORMAL_COUNT])
{
    float x[MODELS_NORMAL_COUNT], y[MODELS_NORMAL_COUNT], z[MODELS_NORMAL_COUNT];
    float sum[3][MODELS_NORMAL_COUNT] = {{0.0f}};
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        x[i] = normal[i].x;
        y[i] = normal[i].y;
        z[i] = normal[i].z;
    }
    for (size_t k = 0; k < turn->light_count; ++k) {
        const lmb_vec3 d = turn->light[k].direction;
        const lmb_rgb weight = lmb_rgb_scale(turn->light[k].weight, 1.0f / LMB_PI_F);
        if (!(lmb_vec3_dot(d, axis) > cone_cos)) {
            continue;
        }
        for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
            const float cosine = lmb_larger(x[i] * d.x + y[i] * d.y + z[i] * d.z, 0.0f);
            sum[0][i] += cosine * weight.c[0];
            sum[1][i] += cosine * weight.c[1];
            sum[2][i] += cosine * weight.c[2];
        }
    }
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        irradiance[i] = lmb_rgb_of(sum[0][i], sum[1][i], sum[2][i]);
    }
}

void models_turn_fill(models_turn *turn, const models_map *map, const lmb_vec3 *normal, uint32_t index, uint64_t seed)
{
    lmb_vec3 row[3];
    rotation_make(index, seed, row);
    moments_rgb upper = {{{0.0}}}, whole = {{{0.0}}};
    double irradiance[3] = {0.0, 0.0, 0.0};
    turn->light_count = 0;
    for (int i = 0; i < MODELS_MAP_PIXELS; ++i) {
        const lmb_directed_light *source = &map->light[i];
        const lmb_directed_light light = {{lmb_vec3_dot(row[0], source->direction),
                                           lmb_vec3_dot(row[1], source->direction),
                                           lmb_vec3_dot(row[2], source->direction)},
                                          source->weight};
        moments_add(&whole, &light);
        if (light.direction.z > 0.0f) {
            moments_add(&upper, &light);
            turn->light[turn->light_count++] = light;
            for (int c = 0; c < 3; ++c) {
                irradiance[c] += (double)light.weight.c[c] * (double)light.direction.z / LMB_PI;
            }
        }
    }
    const lmb_sh3_rgb clipped = moments_sh3(&upper);
    for (int c = 0; c < 3; ++c) {
        turn->sh3[MODELS_LIGHTMAP].channel[c] = lmb_sh3_fit_hemisphere(&clipped.channel[c], up);
    }
    const lmb_rgb wall =
        lmb_rgb_of(0.5f * (float)irradiance[0], 0.5f * (float)irradiance[1], 0.5f * (float)irradiance[2]);
    turn->sh3[MODELS_PROBE] = moments_sh3(&whole);
    turn->sh3[MODELS_PROBE_WALL] = turn->sh3[MODELS_PROBE_WALL31] = clipped;
    wall_add(&turn->sh3[MODELS_PROBE_WALL], wall, 0.0);
    wall_add(&turn->sh3[MODELS_PROBE_WALL31], wall, 0.5);
    if (normal) {
        models_turn_reference(turn, up, 0.0f, normal, turn->reference);
    }
}

static lmb_rgb grey_of(lmb_rgb colour)
{
    const float luminance = lmb_luminance(colour);
    return lmb_rgb_of(luminance, luminance, luminance);
}

void models_turn_make_grey(models_turn *turn)
{
    for (size_t i = 0; i < turn->light_count; ++i) {
        turn->light[i].weight = grey_of(turn->light[i].weight);
    }
    for (int i = 0; i < MODELS_INPUT_COUNT; ++i) {
        const lmb_sh3 luminance = lmb_sh3_rgb_luminance(&turn->sh3[i]);
        turn->sh3[i] = (lmb_sh3_rgb){{luminance, luminance, luminance}};
    }
    for (int i = 0; i < MODELS_NORMAL_COUNT; ++i) {
        turn->reference[i] = grey_of(turn->reference[i]);
    }
}
