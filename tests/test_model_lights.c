/* Rows of the table of models that are not linear in the light, and what every row must do whatever it is given. */
#include "model_oracle.h"

#include <lambent/occlusion.h>

static const lmb_vec3 up = {0.0f, 0.0f, 1.0f};

static lmb_vec3 tilted(double angle_deg, double turn_deg)
{
    const double a = angle_deg * ORACLE_PI / 180.0, t = turn_deg * ORACLE_PI / 180.0;
    return (lmb_vec3){(float)(sin(a) * cos(t)), (float)(sin(a) * sin(t)), (float)cos(a)};
}

/* The fit over the hemisphere of +z that a texel has of a hemisphere light of radiance `ambient` and a light of
 * normalised irradiance `directional` along d: its moments are exact. */
static lmb_sh3 texel_light(double ambient, double directional, lmb_vec3 d)
{
    double basis[9];
    lmb_sh3 moments = {{0.0f}};
    const orule rule = oracle_zone((ovec){0, 0, 1}, 0.0, 1.0, 8, 16);
    for (size_t k = 0; k < rule.count; ++k) {
        oracle_basis(rule.nodes[k].direction, basis);
        for (int i = 0; i < 9; ++i) {
            moments.c[i] += (float)(ambient * rule.nodes[k].weight * basis[i]);
        }
    }
    oracle_rule_free(rule);
    oracle_basis(ovec_of(d), basis);
    for (int i = 0; i < 9; ++i) {
        moments.c[i] += (float)(directional * ORACLE_PI * basis[i]);
    }
    return lmb_sh3_fit_hemisphere(&moments, up);
}

static double hhd_irradiance(double ambient, double directional, lmb_vec3 d, ovec n)
{
    return ambient * 0.5 * (1.0 + n.z) + directional * fmax(ovec_dot(ovec_of(d), n), 0.0);
}

/* A light that is an HHD is found as it is, by each way for it to have colour that can hold it. */
static void hhd_finds_what_it_is(void)
{
    static const struct {
        const char *name;
        double ambient[3], directional[3];
        double turn_deg[3];
    } table[] = {
        {"hhd.closed.gram", {1.0, 0.5, 2.0}, {3.0, 1.5, 6.0}, {40.0, 40.0, 40.0}},
        {"hhd.channels.gram", {1.0, 0.5, 2.0}, {3.0, 1.5, 6.0}, {40.0, 40.0, 40.0}},
        {"hhd.three.gram", {1.0, 0.5, 2.0}, {3.0, 4.0, 0.3}, {40.0, 200.0, 300.0}},
    };
    uint64_t random = 20;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        for (double angle = 0.0; angle < 80.0; angle += 19.0) {
            lmb_sh3_rgb radiance;
            lmb_vec3 d[3];
            for (int c = 0; c < 3; ++c) {
                d[c] = tilted(angle, table[i].turn_deg[c]);
                radiance.channel[c] = texel_light(table[i].ambient[c], table[i].directional[c], d[c]);
            }
            float channel[LMB_MODEL_MOST_CHANNELS];
            oracle_row(table[i].name)->encode(&radiance, up, 0.0f, channel);
            for (int j = 0; j < 20; ++j) {
                lmb_vec3 normal;
                const ovec n = oracle_random_normal(&random, &normal);
                lmb_rgb found;
                oracle_row(table[i].name)->evaluate(channel, up, &normal, 1, &found);
                for (int c = 0; c < 3; ++c) {
                    CHECK_NEAR(found.c[c], hhd_irradiance(table[i].ambient[c], table[i].directional[c], d[c], n), 3e-4,
                               "%s, %g degrees, colour %d", table[i].name, angle, c);
                }
            }
        }
    }
}

/* C_a of each colour, where their shares of ambient light differ but the direction does not: only the luminance's own
 * direction is shared, which is that of the lights. */
static void hhd_channels_differ(void)
{
    const double ambient[3] = {0.2, 1.0, 3.0}, directional[3] = {3.0, 1.0, 0.5};
    const lmb_vec3 d = tilted(50.0, 70.0);
    lmb_sh3_rgb radiance;
    for (int c = 0; c < 3; ++c) {
        radiance.channel[c] = texel_light(ambient[c], directional[c], d);
    }
    float channel[LMB_MODEL_MOST_CHANNELS];
    oracle_row("hhd.channels.gram")->encode(&radiance, up, 0.0f, channel);
    for (int c = 0; c < 3; ++c) {
        CHECK_NEAR(channel[c], ambient[c], 3e-4, "C_a of colour %d", c);
        CHECK_NEAR(channel[3 + c], directional[c], 3e-4, "C_d of colour %d", c);
    }
}

/* Squared error over the hemisphere of an ambient and a directional light that hold I_z, best C_d, by quadrature. */
typedef struct fit_oracle {
    double clipped[9];
    double i_z;
    bool hemisphere; /* HHD; else AHD */
    orule rule;
} fit_oracle;

static double ambient_at(const fit_oracle *fit, ovec n)
{
    return fit->hemisphere ? 0.5 * (1.0 + n.z) : 1.0;
}

static double fit_error(const fit_oracle *fit, ovec d)
{
    double rr = 0.0, rg = 0.0, gg = 0.0;
    for (size_t k = 0; k < fit->rule.count; ++k) {
        const ovec n = fit->rule.nodes[k].direction;
        const double a = ambient_at(fit, n);
        const double r = oracle_irradiance(fit->clipped, 3, n) - fit->i_z * a, g = fmax(ovec_dot(n, d), 0.0) - d.z * a;
        rr += fit->rule.nodes[k].weight * r * r;
        rg += fit->rule.nodes[k].weight * r * g;
        gg += fit->rule.nodes[k].weight * g * g;
    }
    double directional = fmax(rg / gg, 0.0);
    if (directional * d.z > fit->i_z) {
        directional = fit->i_z / d.z;
    }
    return rr - directional * (2.0 * rg - directional * gg);
}

static double row_error(const fit_oracle *fit, const lmb_model *model, const lmb_sh3_rgb *radiance)
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    double sum = 0.0;
    model->encode(radiance, up, 0.0f, channel);
    for (size_t k = 0; k < fit->rule.count; ++k) {
        const lmb_vec3 normal = ovec_float(fit->rule.nodes[k].direction);
        lmb_rgb found;
        model->evaluate(channel, up, &normal, 1, &found);
        const double off = (double)found.c[1] - oracle_irradiance(fit->clipped, 3, fit->rule.nodes[k].direction);
        sum += fit->rule.nodes[k].weight * off * off;
    }
    return sum;
}

/* A search is as good as trying every degree of the angle in the plane, or of all directions. */
static void searches_find_the_best(void)
{
    uint64_t random = 21;
    double in_plane = 0.0, all_around = 0.0;
    for (int k = 0; k < 12; ++k) {
        fit_oracle fit = {.rule = oracle_zone((ovec){0, 0, 1}, 0.0, 1.0, 24, 48)};
        double c[9];
        lmb_sh3 light = oracle_random_sh3(&random, 4.0, c);
        const lmb_sh3_rgb radiance = oracle_grey(light);
        oracle_clip(c, 3, (ovec){0, 0, 1}, 0.0, fit.clipped);
        fit.i_z = oracle_irradiance_z(fit.clipped, (ovec){0, 0, 1});
        const double turn = atan2(-fit.clipped[1], -fit.clipped[3]);
        for (int hemisphere = 0; hemisphere < 2; ++hemisphere) {
            fit.hemisphere = hemisphere;
            double best = INFINITY, anywhere = INFINITY;
            for (int degree = 0; degree <= 90; ++degree) {
                const double a = degree * ORACLE_PI / 180.0;
                best = fmin(best, fit_error(&fit, (ovec){sin(a) * cos(turn), sin(a) * sin(turn), cos(a)}));
                for (int around = 0; around < 360 && degree % 3 == 0; around += 6) {
                    const double t = around * ORACLE_PI / 180.0;
                    anywhere = fmin(anywhere, fit_error(&fit, (ovec){sin(a) * cos(t), sin(a) * sin(t), cos(a)}));
                }
            }
            const lmb_model *model = oracle_row(hemisphere ? "hhd.searched.gram" : "ahd.searched");
            const double found = row_error(&fit, model, &radiance);
            CHECK(found <= 1.002 * best + 1e-5, "%s, light %d: %g, but %g is there", model->name, k, found, best);
            if (hemisphere) {
                const double free = row_error(&fit, oracle_row("hhd.searched.azimuth"), &radiance);
                CHECK(free <= 1.002 * anywhere + 1e-5, "azimuth, light %d: %g, but %g is there", k, free, anywhere);
                in_plane += found;
                all_around += free;
            }
        }
        oracle_rule_free(fit.rule);
    }
    CHECK(all_around < in_plane, "%g with azimuth, %g without", all_around, in_plane);
}

/* Each colour of hhd.searched.channels is the least squares fit along the shared direction. */
static void searched_channels(void)
{
    uint64_t random = 22;
    for (int k = 0; k < 10; ++k) {
        lmb_sh3_rgb radiance;
        double c[3][9];
        for (int i = 0; i < 3; ++i) {
            radiance.channel[i] = oracle_random_sh3(&random, 6.0, c[i]);
        }
        float channel[LMB_MODEL_MOST_CHANNELS];
        oracle_row("hhd.searched.channels")->encode(&radiance, up, 0.0f, channel);
        const ovec d = ovec_of((lmb_vec3){channel[6], channel[7], channel[8]});
        for (int i = 0; i < 3; ++i) {
            fit_oracle fit = {.hemisphere = true, .rule = oracle_zone((ovec){0, 0, 1}, 0.0, 1.0, 24, 48)};
            oracle_clip(c[i], 3, (ovec){0, 0, 1}, 0.0, fit.clipped);
            fit.i_z = oracle_irradiance_z(fit.clipped, (ovec){0, 0, 1});
            double error = 0.0;
            for (size_t n = 0; n < fit.rule.count; ++n) {
                const ovec w = fit.rule.nodes[n].direction;
                const double light =
                    (double)channel[i] * 0.5 * (1.0 + w.z) + (double)channel[3 + i] * fmax(ovec_dot(w, d), 0.0);
                error += fit.rule.nodes[n].weight * pow(light - oracle_irradiance(fit.clipped, 3, w), 2.0);
            }
            CHECK_NEAR(error, fit_error(&fit, d), 1e-4 + 2e-3 * error, "light %d, colour %d", k, i);
            CHECK_NEAR((double)channel[i] + (double)channel[3 + i] * d.z, fit.i_z, 1e-5, "I_z, light %d", k);
            oracle_rule_free(fit.rule);
        }
    }
}

/* AHD as games shipped it: the direction of the linear band, I_z exact, the weight by quadrature over the sphere. */
static void ahd_as_shipped(void)
{
    uint64_t random = 23;
    const orule sphere = oracle_zone((ovec){0, 0, 1}, -1.0, 1.0, 48, 96);
    for (int k = 0; k < 20; ++k) {
        double c[9], clipped[9];
        lmb_sh3 light = oracle_random_sh3(&random, 4.0, c);
        light.c[2] = (float)(c[2] = fabs(c[2])); /* from above */
        const lmb_sh3_rgb radiance = oracle_grey(light);
        oracle_clip(c, 3, (ovec){0, 0, 1}, 0.0, clipped);
        const double i_z = oracle_irradiance_z(clipped, (ovec){0, 0, 1});
        const ovec d = ovec_unit((ovec){-c[3], -c[1], c[2]});
        if (d.z < 0.06) {
            continue;
        }
        double rg = 0.0, gg = 0.0;
        for (size_t i = 0; i < sphere.count; ++i) {
            const ovec n = sphere.nodes[i].direction;
            const double g = fmax(ovec_dot(n, d), 0.0) - d.z;
            rg += sphere.nodes[i].weight * g * (oracle_irradiance(c, 3, n) - i_z);
            gg += sphere.nodes[i].weight * g * g;
        }
        const double directional = fmin(fmax(rg / gg, 0.0), i_z / d.z);
        lmb_vec3 normal;
        const ovec n = oracle_random_normal(&random, &normal);
        CHECK_NEAR(oracle_answer(oracle_row("ahd.shipped"), &radiance, up, 0.0f, normal),
                   i_z - directional * d.z + directional * fmax(ovec_dot(n, d), 0.0), 2e-3, "light %d", k);
        CHECK_NEAR(oracle_answer(oracle_row("ahd.shipped"), &radiance, up, 0.0f, up), i_z, 1e-5, "I_z, light %d", k);
    }
    oracle_rule_free(sphere);
}

/* Of all light about the direction of the linear band ZH3 keeps the mean of each circle, so that circles of its
 * irradiance have the mean that SH3's have. */
static void zh3_keeps_the_zonal(void)
{
    uint64_t random = 24;
    for (int k = 0; k < 20; ++k) {
        double c[9], clipped[9];
        const lmb_sh3_rgb radiance = oracle_grey(oracle_random_sh3(&random, 9.0, c));
        lmb_vec3 n_v;
        const ovec axis_v = oracle_random_normal(&random, &n_v);
        oracle_clip(c, 3, axis_v, 0.0, clipped);
        for (int clips = 0; clips < 2; ++clips) {
            const double *used = clips ? clipped : c;
            const ovec axis = ovec_unit((ovec){-used[3], -used[1], used[2]});
            const lmb_model *model = oracle_row(clips ? "zh3.gram" : "zh3.unoccluded");
            for (double height = -0.9; height < 1.0; height += 0.45) {
                const orule circle = oracle_zone(axis, height - 1e-9, height + 1e-9, 1, 16);
                double found = 0.0, expected = 0.0;
                for (size_t i = 0; i < circle.count; ++i) {
                    const ovec n = circle.nodes[i].direction;
                    found += oracle_answer(model, &radiance, n_v, 0.0f, ovec_float(n)) / 16.0;
                    expected += oracle_irradiance(used, 3, n) / 16.0;
                }
                oracle_rule_free(circle);
                CHECK_NEAR(found, expected, 5e-6, "%s, light %d, height %g", model->name, k, height);
            }
        }
    }
}

/* What ZH3 guesses: nothing of constant light; of others k = l0 r (0.08 + 0.6 r) along the linear band. */
static void zh3_guesses(void)
{
    const lmb_model *model = oracle_row("zh3.hallucinated.unoccluded");
    const lmb_vec3 d = tilted(35.0, 110.0);
    lmb_sh3 light = {{0.0f}};
    light.c[0] = 2.0f * (float)sqrt(ORACLE_PI);
    lmb_sh3_rgb radiance = oracle_grey(light);
    CHECK_NEAR(oracle_answer(model, &radiance, up, 0.0f, d), 1.0, 1e-6, "constant light");
    lmb_sh3_add_light(&light, d, 3.0f);
    radiance = oracle_grey(light);
    const double l0 = (double)light.c[0], r = sqrt(3.0 / (4.0 * ORACLE_PI)) * 3.0 / l0;
    const double k = l0 * r * (0.08 + 0.6 * r);
    uint64_t random = 25;
    for (int j = 0; j < 20; ++j) {
        lmb_vec3 normal;
        const double cosine = ovec_dot(oracle_random_normal(&random, &normal), ovec_of(d));
        const double expected = l0 / sqrt(4.0 * ORACLE_PI) + 2.0 / 3.0 * 3.0 / (4.0 * ORACLE_PI) * 3.0 * cosine +
                                0.25 * k * sqrt(5.0 / (16.0 * ORACLE_PI)) * (3.0 * cosine * cosine - 1.0);
        CHECK_NEAR(oracle_answer(model, &radiance, up, 0.0f, normal), expected, 3e-6, "normal %d", j);
    }
}

/* Geomerics' irradiance: constant light is itself, one light is 4 R0 q^3, and the mean over all normals is R0. */
static void geomerics(void)
{
    const lmb_model *model = oracle_row("geomerics.unoccluded");
    const lmb_vec3 d = tilted(60.0, 10.0);
    lmb_sh3 light = {{2.0f * (float)sqrt(ORACLE_PI)}};
    lmb_sh3_rgb radiance = oracle_grey(light);
    CHECK_NEAR(oracle_answer(model, &radiance, up, 0.0f, d), 1.0, 1e-6, "constant light");
    light = (lmb_sh3){{0.0f}};
    lmb_sh3_add_light(&light, d, 4.0f * (float)ORACLE_PI);
    radiance = oracle_grey(light);
    uint64_t random = 26;
    for (int j = 0; j < 20; ++j) {
        lmb_vec3 normal;
        const ovec n = oracle_random_normal(&random, &normal);
        const double q = 0.5 * (1.0 + ovec_dot(n, ovec_of(d)));
        CHECK_NEAR(oracle_answer(model, &radiance, up, 0.0f, normal), 4.0 * q * q * q, 1e-5, "one light, normal %d", j);
    }
    for (int k = 0; k < 5; ++k) {
        double c[9], mean = 0.0;
        radiance = oracle_grey(oracle_random_sh3(&random, 2.0, c));
        const orule sphere = oracle_zone((ovec){0, 0, 1}, -1.0, 1.0, 32, 64);
        for (size_t i = 0; i < sphere.count; ++i) {
            mean += sphere.nodes[i].weight / (4.0 * ORACLE_PI) *
                    oracle_answer(model, &radiance, up, 0.0f, ovec_float(sphere.nodes[i].direction));
        }
        oracle_rule_free(sphere);
        CHECK_NEAR(mean, c[0] / sqrt(4.0 * ORACLE_PI), 1e-5, "light %d", k);
    }
}

/* The dominant light is along the clipped light's linear band, as bright as least squares over nine harmonics has it;
 * of two texels' channels the mean points where their mean light does. */
static void dominant_light(void)
{
    const lmb_model *model = oracle_row("dominant");
    uint64_t random = 32;
    for (int k = 0; k < 40; ++k) {
        double c[2][9], clipped[2][9], mean[9];
        float channel[2][LMB_MODEL_MOST_CHANNELS];
        lmb_vec3 n_v;
        const ovec axis = oracle_random_normal(&random, &n_v);
        for (int t = 0; t < 2; ++t) {
            const lmb_sh3_rgb radiance = oracle_grey(oracle_random_sh3(&random, 4.0, c[t]));
            oracle_clip(c[t], 3, axis, 0.0, clipped[t]);
            model->encode(&radiance, n_v, 0.0f, channel[t]);
            const ovec d = ovec_unit((ovec){-clipped[t][3], -clipped[t][1], clipped[t][2]});
            double basis[9], product = 0.0, square = 0.0;
            oracle_basis(d, basis);
            for (int i = 0; i < 9; ++i) {
                product += clipped[t][i] * basis[i];
                square += basis[i] * basis[i];
            }
            CHECK_NEAR(channel[t][1], fmax(product / square, 0.0), 2e-5, "light %d", k);
            lmb_rgb facing;
            const lmb_vec3 normal = ovec_float(d);
            model->evaluate(channel[t], n_v, &normal, 1, &facing);
            CHECK_NEAR(facing.c[1], fmax(product / square, 0.0) / ORACLE_PI, 2e-5, "light %d faces it", k);
        }
        for (int i = 0; i < 9; ++i) {
            mean[i] = clipped[0][i] + clipped[1][i];
        }
        const ovec d = ovec_unit((ovec){-mean[3], -mean[1], mean[2]});
        const ovec found = ovec_unit((ovec){(double)channel[0][3] + (double)channel[1][3],
                                            (double)channel[0][4] + (double)channel[1][4],
                                            (double)channel[0][5] + (double)channel[1][5]});
        CHECK_NEAR(ovec_dot(d, found), 1.0, 1e-5, "light %d: filtered direction", k);
    }
}

/* What clips is what does not, of clipped light. */
static void clips_first(void)
{
    static const char *const names[] = {"zh3", "zh3.hallucinated", "geomerics", "cube"};
    uint64_t random = 29;
    for (int k = 0; k < 40; ++k) {
        double c[9], clipped[9];
        const lmb_sh3_rgb radiance = oracle_grey(oracle_random_sh3(&random, 6.0, c));
        const double cone_cos = k % 2 ? 0.0 : oracle_random(&random);
        lmb_vec3 n_v, normal;
        const ovec axis = oracle_random_normal(&random, &n_v);
        oracle_random_normal(&random, &normal);
        oracle_clip(c, 3, axis, cone_cos, clipped);
        lmb_sh3 seen;
        for (int i = 0; i < 9; ++i) {
            seen.c[i] = (float)clipped[i];
        }
        const lmb_sh3_rgb clipped_radiance = oracle_grey(seen);
        for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
            char gram[40], unoccluded[40];
            snprintf(gram, sizeof gram, "%s.gram", names[i]);
            snprintf(unoccluded, sizeof unoccluded, "%s.unoccluded", names[i]);
            CHECK_NEAR(oracle_answer(oracle_row(gram), &radiance, n_v, (float)cone_cos, normal),
                       oracle_answer(oracle_row(unoccluded), &clipped_radiance, n_v, 0.0f, normal), 2e-5,
                       "%s, light %d, c = %g", gram, k, cone_cos);
        }
    }
}

/* Every row: light, and nothing else, of whatever it is given. */
static void check_row(const lmb_model *model, const float *channel, lmb_vec3 n_v, const char *what, int k)
{
    const lmb_vec3 normal[5] = {
        n_v, {-n_v.x, -n_v.y, -n_v.z}, {1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -1.0f}, {0.6f, 0.0f, 0.8f}};
    lmb_rgb found[5];
    model->evaluate(channel, n_v, normal, 5, found);
    for (int i = 0; i < 5; ++i) {
        for (int c = 0; c < 3; ++c) {
            CHECK(found[i].c[c] >= 0.0f && found[i].c[c] <= FLT_MAX, "%s, %s %d, normal %d: %g", model->name, what, k,
                  i, (double)found[i].c[c]);
        }
    }
}

static void check_encoded(const lmb_model *model, const lmb_sh3_rgb *radiance, lmb_vec3 n_v, const char *what, int k)
{
    static const float cones[] = {0.0f, 0.5f, 0.999999f, 1.0f, -0.2f, 1.3f, NAN};
    for (size_t i = 0; model->encode && i < sizeof cones / sizeof cones[0]; ++i) {
        float channel[LMB_MODEL_MOST_CHANNELS];
        model->encode(radiance, n_v, cones[i], channel);
        check_row(model, channel, n_v, what, k);
    }
}

static void check_lights(const lmb_model *model, const lmb_directed_light *light, size_t count, lmb_vec3 n_v,
                         const char *what, int k)
{
    if (model->encode_light) {
        float channel[LMB_MODEL_MOST_CHANNELS];
        model->encode_light(light, count, n_v, channel);
        check_row(model, channel, n_v, what, k);
    }
}

static void hard_light_gives_light(void)
{
    for (size_t m = 0; m < lmb_model_count(); ++m) {
        const lmb_model *model = lmb_model_at(m);
        uint64_t random = 27;
        for (int degree = 0; degree <= 180;
             ++degree) { /* one light at every angle, dark, faint, bright; colours apart */
            lmb_sh3_rgb radiance = {{{{0.0f}}}};
            const lmb_vec3 d = tilted(degree, 30.0);
            const float strength[3] = {1e-20f, 1.0f, 1e6f};
            lmb_sh3_rgb_add_light(&radiance, d, (lmb_rgb){{strength[degree % 3], strength[0], strength[2]}});
            check_encoded(model, &radiance, up, "angle", degree);
            const lmb_directed_light light = {d, {{strength[0], strength[1], strength[2]}}};
            check_lights(model, &light, 1, up, "angle", degree);
        }
        for (int k = 0; k < 300; ++k) { /* ringing and negative l0; then floats that break careless code */
            lmb_sh3_rgb radiance;
            double c[9];
            lmb_directed_light light[4];
            for (int i = 0; i < 3; ++i) {
                radiance.channel[i] = oracle_random_sh3(&random, k % 3 - 1.0, c);
                if (k >= 150) {
                    const size_t j = (size_t)(oracle_random(&random) * 9.0);
                    radiance.channel[i].c[j] = oracle_nasty[(k + i) % ORACLE_NASTY_COUNT];
                }
            }
            for (int i = 0; i < 4; ++i) {
                light[i].direction = ovec_float(oracle_random_direction(&random));
                light[i].weight = (lmb_rgb){{oracle_nasty[k % ORACLE_NASTY_COUNT], 1.0f, -1.0f}};
            }
            const float longer[3] = {1.0f, 3.0f, 1e-3f};
            lmb_vec3 n_v;
            oracle_random_normal(&random, &n_v);
            n_v = (lmb_vec3){n_v.x * longer[k % 3], n_v.y * longer[k % 3], n_v.z * longer[k % 3]};
            n_v = k % 50 == 49 ? (lmb_vec3){0.0f, 0.0f, 0.0f} : n_v;
            check_encoded(model, &radiance, n_v, "random", k);
            check_lights(model, light, 4, n_v, "random", k);
        }
        const lmb_sh3_rgb dark = {{{{0.0f}}}};
        check_encoded(model, &dark, up, "dark", 0);
        check_lights(model, NULL, 0, up, "dark", 0);
    }
}

/* Every row: twice the light is twice the irradiance, and a cone that closes lets none through. */
static void rows_scale_and_close(void)
{
    uint64_t random = 28;
    for (size_t m = 0; m < lmb_model_count(); ++m) {
        const lmb_model *model = lmb_model_at(m);
        for (int k = 0; model->encode && k < 20; ++k) {
            double c[9];
            lmb_sh3_rgb radiance, more;
            for (int i = 0; i < 3; ++i) {
                radiance.channel[i] = oracle_random_sh3(&random, 4.0, c);
                for (int j = 0; j < 9; ++j) {
                    more.channel[i].c[j] = 1024.0f * radiance.channel[i].c[j];
                }
            }
            lmb_vec3 n_v, normal;
            oracle_random_normal(&random, &n_v);
            oracle_random_normal(&random, &normal);
            const double one = oracle_answer(model, &radiance, n_v, 0.3f, normal);
            CHECK_NEAR(oracle_answer(model, &more, n_v, 0.3f, normal), 1024.0 * one, 1e-4 * 1024.0, "%s, light %d",
                       model->name, k);
            if (model->cone) {
                CHECK_NEAR(oracle_answer(model, &radiance, n_v, 1.0f, n_v), 0.0, 1e-5, "%s closed", model->name);
            }
        }
    }
}

static const test_case cases[] = {
    {"hhd_finds_what_it_is", hhd_finds_what_it_is},
    {"hhd_channels_differ", hhd_channels_differ},
    {"searches_find_the_best", searches_find_the_best},
    {"searched_channels", searched_channels},
    {"ahd_as_shipped", ahd_as_shipped},
    {"zh3_keeps_the_zonal", zh3_keeps_the_zonal},
    {"zh3_guesses", zh3_guesses},
    {"geomerics", geomerics},
    {"dominant_light", dominant_light},
    {"clips_first", clips_first},
    {"hard_light_gives_light", hard_light_gives_light},
    {"rows_scale_and_close", rows_scale_and_close},
};

TEST_MAIN(cases)
