/* Emissive triangles with textures: what they give, and that their points are where it is. */
#include <lambent/surface.h>
#include <lambent/surface_solve.h>
#include <lambent/texture.h>

#include "emission_fixture.h"
#include "scenes/level_builder.h"
#include "variates.h"

#include "light/emission_map.h"
#include "light/emission_part.h"

#define PI 3.14159265358979323846

static uint8_t noise_at(int32_t x, int32_t y, uint64_t which)
{
    uint64_t state = (uint64_t)x * 7919u + (uint64_t)y * 104729u + which * 1299709u;
    return (uint8_t)(256.0 * variate_next(&state));
}

static void pixel_set(uint8_t rgba[4], uint8_t r, uint8_t g, uint8_t b, uint8_t a)
{
    rgba[0] = r;
    rgba[1] = g;
    rgba[2] = b;
    rgba[3] = a;
}

/* Six by four windows of 2 x 2 texels in 64 x 32. */
static void windows(int32_t x, int32_t y, uint8_t rgba[4])
{
    const bool lit = (x + 5) % 10 < 2 && x >= 5 && (y + 3) % 7 < 2 && y >= 4 && y < 27;
    const uint8_t value = lit ? 255 : 0;
    pixel_set(rgba, value, value, value, 255);
}

/* One column of texels, some of which is off. */
static void strip(int32_t x, int32_t y, uint8_t rgba[4])
{
    const uint8_t value = x == 711 && y % 64 < 48 ? 255 : 0;
    pixel_set(rgba, value, value, value, 255);
}

/* Few texels of many colours; alpha full of holes, not where the colours are. */
static void sparse(int32_t x, int32_t y, uint8_t rgba[4])
{
    const bool lit = noise_at(x, y, 0) < 30;
    pixel_set(rgba, lit ? noise_at(x, y, 1) : 0, lit ? noise_at(x, y, 2) : 0, lit ? noise_at(x, y, 3) : 0,
              noise_at(x / 2, y / 2, 4) < 100 ? 0 : noise_at(x, y, 5));
}

/* A single opaque texel. */
static void hole(int32_t x, int32_t y, uint8_t rgba[4])
{
    pixel_set(rgba, 255, 255, 255, x == 13 && y == 21 ? 255 : 0);
}

static void white(int32_t x, int32_t y, uint8_t rgba[4])
{
    (void)x;
    (void)y;
    pixel_set(rgba, 255, 255, 255, 255);
}

/* A corner of an atlas: its panel has 4 x 4 texels of its own. */
static void atlas(int32_t x, int32_t y, uint8_t rgba[4])
{
    const bool lit = x == 301 && y == 402;
    const bool other = x < 300 || x >= 304 || y < 400 || y >= 404;
    const uint8_t value = lit || other ? 255 : 0;
    pixel_set(rgba, value, value, value, 255);
}

#define WHOLE                                                                                                          \
    {                                                                                                                  \
        {0.0f, 1.0f},                                                                                                  \
        {                                                                                                              \
            1.0f, 0.0f                                                                                                 \
        }                                                                                                              \
    }
#define TEN                                                                                                            \
    {                                                                                                                  \
        {                                                                                                              \
            10.0f, 10.0f, 10.0f                                                                                        \
        }                                                                                                              \
    }

/* clang-format off */
static const panel_case panels[] = {
    {"windows", {64, 32, windows}, LMB_WRAP_REPEAT, true, WHOLE, .emissive = TEN},
    {"windows, filtered", {64, 32, windows}, LMB_WRAP_REPEAT, false, WHOLE, .emissive = TEN},
    {"strip", {1024, 1024, strip}, LMB_WRAP_CLAMP, true, WHOLE, .emissive = TEN,
     .lit = {709.0 / 1024, 714.0 / 1024}},
    {"strip, filtered", {1024, 1024, strip}, LMB_WRAP_CLAMP, false, WHOLE, .emissive = TEN,
     .lit = {709.0 / 1024, 714.0 / 1024}},
    {"repeated", {13, 17, sparse}, LMB_WRAP_REPEAT, false, {{-1.3f, 2.7f}, {2.1f, -0.6f}}, .emissive = TEN},
    {"repeated, nearest", {13, 17, sparse}, LMB_WRAP_REPEAT, true, {{-1.3f, 2.7f}, {2.1f, -0.6f}}, .emissive = TEN},
    {"mirrored", {13, 17, sparse}, LMB_WRAP_MIRROR, false, {{-1.3f, 2.7f}, {2.1f, -0.6f}}, .emissive = TEN},
    {"mirrored, nearest", {13, 17, sparse}, LMB_WRAP_MIRROR, true, {{-1.3f, 2.7f}, {2.1f, -0.6f}}, .emissive = TEN},
    {"clamped", {13, 17, sparse}, LMB_WRAP_CLAMP, false, {{-0.3f, 1.7f}, {2.1f, -0.6f}}, .emissive = TEN},
    {"clamped, nearest", {13, 17, sparse}, LMB_WRAP_CLAMP, true, {{-0.3f, 1.7f}, {2.1f, -0.6f}}, .emissive = TEN},
    {"turned", {32, 32, sparse}, LMB_WRAP_REPEAT, false, WHOLE,
     .transform = {{1.6f, -1.2f, 0.3f}, {1.2f, 1.6f, 0.1f}}, .emissive = TEN},
    {"part of a texel", {8, 8, windows}, LMB_WRAP_REPEAT, false, {{0.57f, 0.63f}, {0.60f, 0.61f}}, .emissive = TEN},
    {"part of a lit texel", {8, 8, windows}, LMB_WRAP_REPEAT, false, {{0.71f, 0.66f}, {0.78f, 0.60f}}, .emissive = TEN},
    {"seven texels", {64, 32, windows}, LMB_WRAP_REPEAT, false, {{0.06f, 0.2f}, {0.11f, 0.1f}}, .emissive = TEN},
    {"one colour of many", {64, 32, sparse}, LMB_WRAP_REPEAT, true, WHOLE, .emissive = {{20.0f, 0.0f, 0.0f}}},
    {"blended", {32, 32, sparse}, LMB_WRAP_REPEAT, false, WHOLE, .alpha_used = true, .alpha_mode = LMB_ALPHA_BLEND,
     .emissive = TEN},
    {"masked", {32, 32, sparse}, LMB_WRAP_REPEAT, false, WHOLE, .alpha_used = true, .alpha_mode = LMB_ALPHA_MASK,
     .cutoff = 0.5f, .emissive = TEN},
    {"masked, nearest", {32, 32, sparse}, LMB_WRAP_REPEAT, true, WHOLE, .alpha_used = true,
     .alpha_mode = LMB_ALPHA_MASK, .cutoff = 0.5f, .emissive = TEN},
    {"one opaque texel", {32, 32, hole}, LMB_WRAP_REPEAT, false, WHOLE, .emission_even = true, .alpha_used = true,
     .alpha_mode = LMB_ALPHA_MASK, .cutoff = 0.5f, .emissive = TEN},
    {"one blended texel", {32, 32, hole}, LMB_WRAP_REPEAT, false, WHOLE, .emission_even = true, .alpha_used = true,
     .alpha_mode = LMB_ALPHA_BLEND, .emissive = TEN},
    {"masked by its vertices", {32, 32, sparse}, LMB_WRAP_REPEAT, false, WHOLE, .alpha_used = true,
     .alpha_mode = LMB_ALPHA_MASK, .cutoff = 0.4f, .vertex_alpha = 0.5f, .emissive = TEN},
    {"blended by its vertices, see-through", {32, 32, sparse}, LMB_WRAP_REPEAT, false, WHOLE, .alpha_used = true,
     .alpha_mode = LMB_ALPHA_BLEND, .vertex_alpha = 0.2f, .transmission = 0.6f, .emissive = TEN},
    {"atlas", {1024, 1024, atlas}, LMB_WRAP_REPEAT, true, {{300.0f / 1024, 404.0f / 1024}, {304.0f / 1024, 400.0f / 1024}},
     .emissive = TEN},
    {"even", {16, 16, white}, LMB_WRAP_REPEAT, false, WHOLE, .emissive = TEN},
};
/* clang-format on */
enum { PANELS = sizeof panels / sizeof panels[0] };

/* Where the panel is seen from, looking at it. */
static const lmb_vec3 seen_from = {0.4f, 0.9f, 1.5f};
static const lmb_vec3 seen_along = {0.0f, 0.0f, -1.0f};

/* A point of the panel at shares (s, t) of its width and height. */
static lmb_hit panel_hit(double s, double t)
{
    lmb_hit hit = {.instance = 0, .triangle = t > s, .front = true};
    hit.u = (float)(t > s ? s : s - t);
    hit.v = (float)(t > s ? t - s : t);
    const double x = (double)PANEL_LEFT + s * (double)PANEL_WIDTH - (double)seen_from.x;
    const double y = t * (double)PANEL_HEIGHT - (double)seen_from.y, z = -(double)seen_from.z;
    hit.distance = (float)sqrt(x * x + y * y + z * z);
    return hit;
}

static lmb_vec3 hit_direction(const lmb_hit *hit, double s, double t)
{
    const float inverse = 1.0f / hit->distance;
    return (lmb_vec3){(PANEL_LEFT + (float)s * PANEL_WIDTH - seen_from.x) * inverse,
                      ((float)t * PANEL_HEIGHT - seen_from.y) * inverse, -seen_from.z * inverse};
}

/* Irradiance and density of the whole panel by brute force. */
typedef struct panel_sums {
    double irradiance; /* green */
    double density;    /* over all solid angle */
    double unseen;     /* share of irradiance from where no sample goes */
} panel_sums;

static panel_sums panel_add_up(const panel *made, const panel_case *wanted, int steps)
{
    panel_sums sums = {0};
    const lmb_triangle_query query = {seen_from, &seen_along, NULL};
    const double from = wanted->lit[0], width = wanted->lit[1] > 0.0 ? wanted->lit[1] - wanted->lit[0] : 1.0;
    const double area = (double)PANEL_WIDTH * (double)PANEL_HEIGHT * width / ((double)steps * steps);
    for (int j = 0; j < steps; ++j) {
        for (int i = 0; i < steps; ++i) {
            /* Off the texels' lines and the diagonal. */
            const double s = from + width * (i + 0.37) / steps, t = (j + 0.61) / steps;
            const lmb_hit hit = panel_hit(s, t);
            const lmb_vec3 direction = hit_direction(&hit, s, t);
            const lmb_mesh_point point = lmb_trace_mesh_point(
                made->tracer, &(lmb_hit){.instance = 0, .triangle = hit.triangle, .u = hit.u, .v = hit.v});
            const lmb_rgb emission = lmb_material_emission(&point);
            const double cosine = -(double)direction.z, distance = (double)hit.distance;
            const double angle = area * cosine / (distance * distance);
            const double light = (double)(emission.c[0] + emission.c[1] + emission.c[2]) / 3.0 *
                                 (double)lmb_material_coverage(&point).opacity * angle * cosine / PI;
            const double density = (double)lmb_emitters_triangle_density(made->emitters, &query, &hit, direction);
            sums.irradiance += light;
            sums.density += density * angle;
            sums.unseen += density > 0.0 ? 0.0 : light;
        }
    }
    sums.unseen /= sums.irradiance;
    return sums;
}

/* Aiming at light alone, without a ray that finds it by chance, gives all of it; and the density of each sample is what
 * the ray that finds it is told. */
static void aiming_finds_all(void)
{
    enum { SAMPLES = 16384, STEPS = 512 };
    for (int n = 0; n < PANELS; ++n) {
        const panel_case *wanted = &panels[n];
        panel made;
        if (!panel_open(&made, wanted)) {
            continue;
        }
        const panel_sums truth = panel_add_up(&made, wanted, STEPS);
        const lmb_triangle_query query = {seen_from, &seen_along, NULL};
        uint64_t state = 5;
        double sum = 0.0, squares = 0.0;
        int looked = 0, agreed = 0;
        for (int i = 0; i < SAMPLES; ++i) {
            const float choice = (float)variate_next(&state);
            const float x = (float)variate_next(&state), y = (float)variate_next(&state);
            lmb_light_sample sample;
            const lmb_triangle_choices choices = {1, &seen_from, &choice, &x, &y};
            lmb_emitters_sample_triangles(made.emitters, &query, &choices, &sample);
            if (!(sample.density > 0.0f)) {
                continue;
            }
            const double light = (double)(sample.radiance.c[0] + sample.radiance.c[1] + sample.radiance.c[2]) / 3.0 *
                                 -(double)sample.direction.z / PI / (double)sample.density;
            sum += light / SAMPLES;
            squares += light * light / SAMPLES;
            lmb_hit hit;
            if (i % 32 == 0 && lmb_trace_nearest(made.tracer, seen_from, sample.direction, 0.0f, 1e30f, &hit)) {
                const float density = lmb_emitters_triangle_density(made.emitters, &query, &hit, sample.direction);
                ++looked;
                agreed += fabsf(density / sample.density - 1.0f) < 2e-3f;
            }
        }
        /* Hits are rounded: some lie on the other side of a texel's edge. */
        CHECK(looked > 0 && agreed >= looked - looked / 100 - 2, "%s: densities of %d of %d hits", wanted->name, agreed,
              looked);
        const double error = sqrt(fmax(squares - sum * sum, 0.0) / SAMPLES);
        CHECK_NEAR(sum, truth.irradiance, 4.5 * error + 0.01 * truth.irradiance, "%s", wanted->name);
        CHECK(sum > 0.0 && error * sqrt((double)SAMPLES) < 2.5 * sum, "%s: a sample is off by %g", wanted->name,
              error * sqrt((double)SAMPLES) / sum);
        CHECK_NEAR(truth.density, 1.0, 0.03, "%s: density over all directions", wanted->name);
        CHECK(truth.unseen < 1e-3, "%s: %g of the light is never aimed at", wanted->name, truth.unseen);
        panel_close(&made);
    }
}

/* What lmb_texture_sample gives over a range of texels, summed over points of each. */
static double filtered_mean(const lmb_scene *scene, const lmb_texture *texture, const lmb_texel_range *range)
{
    enum { STEPS = 16 };
    const lmb_texture_image *image = &scene->images[0];
    double sum = 0.0;
    const int across = (range->end[0] - range->first[0]) * STEPS, down = (range->end[1] - range->first[1]) * STEPS;
    for (int j = 0; j < down; ++j) {
        for (int i = 0; i < across; ++i) {
            const lmb_vec2 uv = {((float)range->first[0] + ((float)i + 0.5f) / STEPS) / (float)image->width,
                                 ((float)range->first[1] + ((float)j + 0.5f) / STEPS) / (float)image->height};
            float rgba[4];
            lmb_texture_sample(scene, texture, uv, true, rgba);
            sum += (double)lmb_luminance((lmb_rgb){{rgba[0], rgba[1], rgba[2]}});
        }
    }
    return sum / ((double)across * down);
}

/* A map's means are those of the filtered texture, over and outside its edges. */
static void maps_hold_what_is_filtered(void)
{
    static const lmb_wrap wraps[] = {LMB_WRAP_REPEAT, LMB_WRAP_CLAMP, LMB_WRAP_MIRROR};
    uint64_t state = 3;
    for (int n = 0; n < 6; ++n) {
        const panel_case wanted = {"map", {7, 5, sparse}, wraps[n / 2], n % 2 == 1, WHOLE, .emissive = TEN};
        panel made;
        if (!panel_open(&made, &wanted)) {
            continue;
        }
        lmb_emission_key key;
        const lmb_texture *texture;
        lmb_emission_map *map = NULL;
        CHECK(lmb_emission_key_of(&made.scene, &made.material, &key, &texture), "a map");
        CHECK(lmb_emission_map_create(&made.scene, &key, &map) == LMB_OK, "memory");
        for (int i = 0; i < 60 && map; ++i) {
            lmb_texel_range range;
            for (int axis = 0; axis < 2; ++axis) {
                range.first[axis] = (int32_t)(40.0 * variate_next(&state)) - 20;
                range.end[axis] = range.first[axis] + 1 + (int32_t)(25.0 * variate_next(&state));
            }
            const double expected = filtered_mean(&made.scene, texture, &range);
            /* A map takes what is beyond a clamped edge for its outermost texels, half of which are nearer. */
            const bool beyond = wraps[n / 2] == LMB_WRAP_CLAMP && n % 2 == 0;
            CHECK_NEAR(lmb_emission_map_mean(map, &range), expected, beyond ? 0.12 : 1e-4,
                       "wrap %d, nearest %d: %d,%d to %d,%d", wraps[n / 2], n % 2, range.first[0], range.first[1],
                       range.end[0], range.end[1]);
        }
        lmb_emission_map_destroy(map);
        panel_close(&made);
    }
}

/* Chi-square of points of a triangle against their density, over bins of the triangle; what the density leaves of 1 is
 * how often no point is found. */
static void points_follow_their_density(void)
{
    enum { STEPS = 12, BINS = STEPS * STEPS, FINE = 64, SAMPLES = 100000 };
    static const int chosen[] = {0, 1, 4, 6, 8, 10, 13, 15, 16}; /* of `panels` */
    for (size_t n = 0; n < sizeof chosen / sizeof chosen[0]; ++n) {
        const panel_case *wanted = &panels[chosen[n]];
        panel made;
        if (!panel_open(&made, wanted)) {
            continue;
        }
        lmb_emission_key key;
        const lmb_texture *texture;
        lmb_emission_map *map = NULL;
        lmb_emission_lattice lattice;
        CHECK(lmb_emission_key_of(&made.scene, &made.material, &key, &texture) &&
                  lmb_emission_map_create(&made.scene, &key, &map) == LMB_OK &&
                  lmb_emission_lattice_of(&made.mesh, 1, texture, map, &lattice),
              "%s", wanted->name);
        const lmb_emission_part part = lmb_emission_part_whole(&lattice);
        double expected[BINS] = {0.0}, found[BINS] = {0.0}, left = 1.0, lost = 0.0;
        /* (s, t) of the unit square, folded to the triangle: each bin has the same area. */
        for (int k = 0; k < BINS * FINE * FINE; ++k) {
            const int i = k % (STEPS * FINE), j = k / (STEPS * FINE);
            const double a = (i + 0.5) / (STEPS * FINE), b = (j + 0.5) / (STEPS * FINE);
            double texel[2];
            lmb_emission_texel(&lattice, (float)(1.0 - a), (float)(a * b), texel);
            const double share = 2.0 * a * lmb_emission_part_density(map, &part, texel) / ((double)BINS * FINE * FINE);
            expected[i / FINE + STEPS * (j / FINE)] += share;
            left -= share;
        }
        uint64_t state = 17;
        for (int k = 0; k < SAMPLES; ++k) {
            const float u[2] = {(float)variate_next(&state), (float)variate_next(&state)};
            float weight[2], density;
            if (!lmb_emission_part_sample(map, &part, u, weight, &density)) {
                lost += 1.0 / SAMPLES;
                continue;
            }
            const double a = 1.0 - (double)weight[0], b = a > 0.0 ? (double)weight[1] / a : 0.0;
            const int i = (int)(a * STEPS), j = (int)(b * STEPS);
            found[(i < STEPS ? i : STEPS - 1) + STEPS * (j < STEPS ? j : STEPS - 1)] += 1.0;
        }
        double chi_square = 0.0;
        int bins = 0;
        for (int k = 0; k < BINS; ++k) {
            const double count = expected[k] * SAMPLES;
            if (count > 20.0) {
                /* The grid that the density is summed over misses up to half a percent of a bin. */
                chi_square += (found[k] - count) * (found[k] - count) / (count + 0.005 * 0.005 * count * count);
                ++bins;
            } else {
                CHECK(found[k] < 60.0, "%s: %g points in bin %d, expected %g", wanted->name, found[k], k, count);
            }
        }
        CHECK(bins > 2 && chi_square < bins + 5.0 * sqrt(2.0 * bins), "%s: chi-square %g of %d bins", wanted->name,
              chi_square, bins);
        CHECK_NEAR(lost, left, 0.004, "%s: points that are not found", wanted->name);
        lmb_emission_map_destroy(map);
        panel_close(&made);
    }
}

/* A texture that goes on for ever: what is far away sees its mean, and nearly every sample lands on a window. */
static void a_thousand_repetitions(void)
{
    enum { SAMPLES = 4096 };
    const panel_case wanted = {
        "a thousand times", {64, 32, windows}, LMB_WRAP_REPEAT, true, {{0.0f, 1000.0f}, {1000.0f, 0.0f}},
        .emissive = TEN};
    const panel_case even = {"white", {2, 2, white}, LMB_WRAP_REPEAT, true, WHOLE, .emissive = TEN};
    panel made, beside;
    if (!panel_open(&made, &wanted)) {
        return;
    }
    if (panel_open(&beside, &even)) {
        const panel_sums truth = panel_add_up(&beside, &even, 256);
        const lmb_triangle_query query = {seen_from, &seen_along, NULL};
        uint64_t state = 23;
        double sum = 0.0;
        int lit = 0;
        for (int i = 0; i < SAMPLES; ++i) {
            const float choice = (float)variate_next(&state);
            const float x = (float)variate_next(&state), y = (float)variate_next(&state);
            lmb_light_sample sample;
            const lmb_triangle_choices choices = {1, &seen_from, &choice, &x, &y};
            lmb_emitters_sample_triangles(made.emitters, &query, &choices, &sample);
            if (sample.density > 0.0f) {
                sum +=
                    (double)sample.radiance.c[1] * -(double)sample.direction.z / PI / (double)sample.density / SAMPLES;
                ++lit;
            }
        }
        /* Texture coordinates of a thousand in float are a thousandth of a texel off. */
        CHECK(lit > SAMPLES * 95 / 100, "%d of %d samples find light", lit, SAMPLES);
        CHECK_NEAR(sum, truth.irradiance * 96.0 / 2048.0, 0.03 * truth.irradiance * 96.0 / 2048.0, "its mean");
        panel_close(&beside);
    }
    panel_close(&made);
}

/* Irradiance over pi, on a floor at `point`, of an even rectangle in the plane z = 0 that stands above it: Lambert's
 * formula, a sum over its edges. */
static double rectangle_light(const double low[2], const double high[2], const double point[3])
{
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) {
        double end[2][3];
        for (int e = 0; e < 2; ++e) {
            const int corner = (k + e) % 4;
            end[e][0] = (corner == 1 || corner == 2 ? high[0] : low[0]) - point[0];
            end[e][1] = (corner >= 2 ? high[1] : low[1]) - point[1];
            end[e][2] = -point[2];
        }
        const double across[3] = {end[0][1] * end[1][2] - end[0][2] * end[1][1],
                                  end[0][2] * end[1][0] - end[0][0] * end[1][2],
                                  end[0][0] * end[1][1] - end[0][1] * end[1][0]};
        const double sine = sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]);
        const double cosine = end[0][0] * end[1][0] + end[0][1] * end[1][1] + end[0][2] * end[1][2];
        sum += atan2(sine, cosine) * across[1] / sine;
    }
    return fabs(sum) / (2.0 * PI);
}

/* A facade of 20 x 10 m with lit windows over a street, albedo of both; false on failure. */
static bool facade_open(level_fixture *level, float albedo)
{
    static uint8_t rgba[64 * 32 * 4];
    for (int32_t k = 0; k < 64 * 32; ++k) {
        windows(k % 64, k / 64, rgba + (size_t)(4 * k));
    }
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material wall = lmb_level_material_default(), ground = lmb_level_material_default();
    wall.base_color = ground.base_color = (lmb_rgb){{albedo, albedo, albedo}};
    wall.emission = (lmb_rgb){{50.0f, 50.0f, 50.0f}};
    wall.emissive_texture = lmb_level_builder_add_image(builder, "windows", 64, 32, rgba);
    wall.texture_size_m = 10.0f; /* once up, twice across */
    const int mesh = lmb_level_builder_add_mesh(builder, "street");
    lmb_level_builder_add_quad(builder, mesh, lmb_level_builder_add_material(builder, &wall), (lmb_vec3){-10, 0, 0},
                               (lmb_vec3){20, 0, 0}, (lmb_vec3){0, 10, 0});
    lmb_level_builder_add_quad(builder, mesh, lmb_level_builder_add_material(builder, &ground), (lmb_vec3){-10, 0, 20},
                               (lmb_vec3){20, 0, 0}, (lmb_vec3){0, 0, -20});
    lmb_level_builder_place(builder, "street", mesh, (lmb_vec3){0, 0, 0});
    lmb_error error = {{0}};
    const char *path = LMB_TEST_OUTPUT_DIR "/facade.glb";
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    return level_fixture_open(level, path, written, &error, 1);
}

/* Places of the street, and how much of the facade's windows each of them gets. */
enum { STREET_STEPS = 12, STREET = STREET_STEPS * STREET_STEPS };

static lmb_vec3 street_point(int k)
{
    return (lmb_vec3){-10.0f + 20.0f * ((float)(k % STREET_STEPS) + 0.5f) / STREET_STEPS, 1e-4f,
                      20.0f * ((float)(k / STREET_STEPS) + 0.5f) / STREET_STEPS};
}

static double windows_light(lmb_vec3 at)
{
    const double point[3] = {(double)at.x, (double)at.y, (double)at.z};
    double sum = 0.0;
    for (int32_t k = 0; k < 2 * 64 * 32; ++k) {
        const int32_t x = k % 128, y = k / 128;
        uint8_t rgba[4];
        windows(x % 64, y, rgba);
        const double low[2] = {-10.0 + 20.0 * x / 128.0, 10.0 - 10.0 * (y + 1) / 32.0};
        const double high[2] = {-10.0 + 20.0 * (x + 1) / 128.0, 10.0 - 10.0 * y / 32.0};
        sum += rgba[0] > 0 ? 50.0 * rectangle_light(low, high, point) : 0.0;
    }
    return sum;
}

/* Mean over the street, by few samples each. */
static double street_mean(const level_fixture *level, uint32_t samples)
{
    double sum = 0.0;
    for (int k = 0; k < STREET; ++k) {
        sum += (double)traced_irradiance(level, street_point(k), (lmb_vec3){0, 1, 0}, samples).c[1] / STREET;
    }
    return sum;
}

/* A street lit by windows alone is as bright as their sum, point by point. */
static void windows_light_a_street(void)
{
    level_fixture level;
    if (!facade_open(&level, 0.0f)) {
        return;
    }
    double expected = 0.0, squares = 0.0;
    for (int k = 0; k < STREET; ++k) {
        const lmb_vec3 point = street_point(k);
        const double truth = windows_light(point);
        const double found = (double)traced_irradiance(&level, point, (lmb_vec3){0, 1, 0}, 64).c[1];
        expected += truth / STREET;
        squares += (found - truth) * (found - truth) / STREET;
    }
    CHECK_NEAR(street_mean(&level, 512), expected, 0.01 * expected, "mean of the street");
    CHECK(sqrt(squares) < 0.14 * expected, "points are off by %g of the mean", sqrt(squares) / expected);
    level_fixture_close(&level);
}

/* With reflections the cached estimator finds what the path tracer finds. */
static void windows_light_a_street_and_more(void)
{
    level_fixture level;
    if (!facade_open(&level, 0.6f)) {
        return;
    }
    const double expected = street_mean(&level, 512);
    lmb_surface_light_stats stats;
    lmb_error error = {{0}};
    lmb_surface_light *light = NULL;
    const lmb_surface_light_settings settings = {.max_cells = 4096, .samples = 16};
    CHECK(lmb_surface_light_solve(&level.transport, &settings, level.pool, &light, &stats, &error) == LMB_OK, "%s",
          error.message);
    level.transport.surface = light;
    CHECK_NEAR(street_mean(&level, 64), expected, 0.01 * expected, "both estimators");
    lmb_surface_light_destroy(light);
    level_fixture_close(&level);
}

static void black(int32_t x, int32_t y, uint8_t rgba[4])
{
    (void)x;
    (void)y;
    pixel_set(rgba, 0, 0, 0, 255);
}

/* A texture without light is no light, and a single texel is one. */
static void black_textures_are_dark(void)
{
    static const struct {
        panel_case wanted;
        bool is_lit;
    } looked_at[] = {
        {{"black", {16, 16, black}, LMB_WRAP_REPEAT, false, WHOLE, .emissive = TEN}, false},
        {{"strip", {1024, 16, strip}, LMB_WRAP_REPEAT, false, WHOLE, .emissive = TEN}, true},
        {{"holes", {32, 32, hole}, LMB_WRAP_REPEAT, false, WHOLE, .emission_even = true, .emissive = TEN}, true},
    };
    for (size_t i = 0; i < sizeof looked_at / sizeof looked_at[0]; ++i) {
        panel made;
        if (panel_open(&made, &looked_at[i].wanted)) {
            CHECK(lmb_scene_has_light(&made.scene) == looked_at[i].is_lit, "%s", looked_at[i].wanted.name);
            CHECK((lmb_emitters_triangle_count(made.emitters) > 0) == looked_at[i].is_lit, "%s",
                  looked_at[i].wanted.name);
            panel_close(&made);
        }
    }
}

static const test_case cases[] = {
    {"black_textures_are_dark", black_textures_are_dark},
    {"maps_hold_what_is_filtered", maps_hold_what_is_filtered},
    {"points_follow_their_density", points_follow_their_density},
    {"aiming_finds_all", aiming_finds_all},
    {"a_thousand_repetitions", a_thousand_repetitions},
    {"windows_light_a_street", windows_light_a_street},
    {"windows_light_a_street_and_more", windows_light_a_street_and_more},
};

TEST_MAIN(cases)
