/* Light transport against answers known by analysis, and against another path tracer. */
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include <lambent/file.h>
#include <lambent/probes_bake.h>
#include <lambent/placement.h>

#include "gather_fixture.h"
#include "harness.h"
#include "light/emitters_internal.h"
#include "scenes/levels.h"
#include "level_fixture.h"

#define PI 3.14159265358979323846

static const char *output_path(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/transport_%s.glb", LMB_TEST_OUTPUT_DIR, name);
    return path;
}

/* A furnace of albedo a and emission 1 has radiance 1/(1-a) in every direction: only l00 differs from 0. */
static void furnace_is_uniform(void)
{
    static const float albedos[] = {0.0f, 0.5f, 0.8f, 0.99f};
    for (size_t i = 0; i < sizeof albedos / sizeof albedos[0]; ++i) {
        lmb_error error;
        level_fixture level;
        const lmb_rgb one = {{1.0f, 1.0f, 1.0f}};
        CHECK(lmb_level_furnace(output_path("furnace"), 2.0f, albedos[i], one, false, &error) == LMB_OK, "%s",
              error.message);
        if (!level_fixture_load(&level, output_path("furnace"), NULL, 1)) {
            return;
        }
        const double radiance = 1.0 / (1.0 - (double)albedos[i]);
        const lmb_gather_point point = {.position = {0.3f, -0.2f, 0.5f}};
        lmb_gathered gathered;
        lmb_gather_sh3(&level.transport, &point, albedos[i] > 0.9f ? 16384 : 8192, &gathered);
        const double tolerance = (albedos[i] > 0.9f ? 0.05 : 0.015) * radiance;
        for (int c = 0; c < 3; ++c) {
            const float *l = gathered.moments.channel[c].c;
            CHECK_NEAR(l[0], 2.0 * sqrt(PI) * radiance, 2.0 * sqrt(PI) * tolerance, "albedo %g", (double)albedos[i]);
            for (int k = 1; k < 9; ++k) {
                CHECK_NEAR(l[k], 0.0, 4.0 * tolerance, "albedo %g, coefficient %d", (double)albedos[i], k);
            }
        }
        level_fixture_close(&level);
    }
}

/* After k bounces a furnace has (1 - a^(k+1))/(1 - a). */
static void bounces_are_counted(void)
{
    lmb_error error;
    level_fixture level;
    const lmb_rgb one = {{1.0f, 1.0f, 1.0f}};
    CHECK(lmb_level_furnace(output_path("bounces"), 2.0f, 0.8f, one, true, &error) == LMB_OK, "%s", error.message);
    if (!level_fixture_load(&level, output_path("bounces"), NULL, 1)) {
        return;
    }
    for (int bounces = 0; bounces < 6; ++bounces) {
        level.transport.bounces = bounces;
        const lmb_rgb irradiance =
            traced_irradiance(&level, (lmb_vec3){0.0f, 0.0f, 0.0f}, (lmb_vec3){0.0f, 1.0f, 0.0f}, 4096);
        CHECK_NEAR(irradiance.c[1], (1.0 - pow(0.8, bounces + 1)) / 0.2, 0.05, "bounces %d", bounces);
    }
    level_fixture_close(&level);
}

/* Under a constant sky of 1 the open ground receives exactly 1; looking down from above it, albedo. */
static void sky_lights_open_ground(void)
{
    lmb_error error;
    level_fixture level;
    CHECK(lmb_level_open_ground(output_path("ground"), 1000.0f, 0.5f, &error) == LMB_OK, "%s", error.message);
    if (!level_fixture_load(&level, output_path("ground"), "#ffffff", 1)) {
        return;
    }
    const lmb_vec3 above = {0.0f, 0.01f, 0.0f};
    const lmb_rgb up = traced_irradiance(&level, above, (lmb_vec3){0.0f, 1.0f, 0.0f}, 1024);
    const lmb_rgb down = traced_irradiance(&level, above, (lmb_vec3){0.0f, -1.0f, 0.0f}, 1024);
    CHECK_NEAR(up.c[0], 1.0, 0.01, "from above");
    CHECK_NEAR(down.c[0], 0.5, 0.005, "from the ground");
    level_fixture_close(&level);
}

/* A point light of intensity I in the middle of a diffuse sphere of radius R and albedo a: every wall point receives
 * E = I/R^2/(1-a), so the sphere's wall has radiance a E/pi. */
static void point_light_in_sphere(void)
{
    lmb_error error;
    level_fixture level;
    const double radius = 2.0, albedo = 0.6, intensity = 10.0;
    CHECK(lmb_level_sphere_room(output_path("sphere"), (float)radius, 24, (float)albedo, (float)intensity, &error) ==
              LMB_OK,
          "%s", error.message);
    if (!level_fixture_load(&level, output_path("sphere"), NULL, 1)) {
        return;
    }
    const double expected = intensity / (radius * radius) / (1.0 - albedo) / PI;
    static const lmb_vec3 directions[] = {{0.0f, 1.0f, 0.0f}, {0.6f, 0.0f, 0.8f}, {-0.48f, -0.64f, 0.6f}};
    for (size_t i = 0; i < sizeof directions / sizeof directions[0]; ++i) {
        const lmb_vec3 d = directions[i];
        const float distance = (float)radius * 0.995f;
        const lmb_vec3 position = {d.x * distance, d.y * distance, d.z * distance};
        const lmb_rgb irradiance = traced_irradiance(&level, position, (lmb_vec3){-d.x, -d.y, -d.z}, 4096);
        CHECK_NEAR(irradiance.c[2], expected, 0.02 * expected, "direction %g %g %g", (double)d.x, (double)d.y,
                   (double)d.z);
    }
    level_fixture_close(&level);
}

/* A sun of L lux at angle a gives L cos(a) / pi on the ground, without noise. */
static void sun_on_plane(void)
{
    static const lmb_vec3 directions[] = {{0.0f, -1.0f, 0.0f}, {3.0f, -4.0f, 0.0f}, {-1.0f, -0.5f, 2.0f}};
    for (size_t i = 0; i < sizeof directions / sizeof directions[0]; ++i) {
        lmb_error error;
        level_fixture level;
        const lmb_vec3 d = directions[i];
        CHECK(lmb_level_sun_plane(output_path("sun"), 0.5f, d, 100000.0f, &error) == LMB_OK, "%s", error.message);
        if (!level_fixture_load(&level, output_path("sun"), NULL, 1)) {
            return;
        }
        const double cosine = -(double)d.y / sqrt((double)(d.x * d.x + d.y * d.y + d.z * d.z));
        const lmb_rgb irradiance =
            traced_irradiance(&level, (lmb_vec3){0.1f, 0.001f, 0.2f}, (lmb_vec3){0.0f, 1.0f, 0.0f}, 16);
        CHECK_NEAR(irradiance.c[0], 100000.0 * cosine / PI, 0.1, "sun %g %g %g", (double)d.x, (double)d.y, (double)d.z);
        level_fixture_close(&level);
    }
}

/* Behind a wall of 1 mm it is exactly dark, in the corners too, where rounding could start rays outside the room. */
static void sealed_room_is_dark(void)
{
    lmb_error error;
    level_fixture level;
    lmb_two_rooms rooms = lmb_two_rooms_default();
    rooms.wall_m = 0.001f;
    rooms.green_radiance = 0.0f;
    CHECK(lmb_level_two_rooms(output_path("sealed"), &rooms, &error) == LMB_OK, "%s", error.message);
    if (!level_fixture_load(&level, output_path("sealed"), NULL, 2)) {
        return;
    }
    static const lmb_vec3 dark[] = {{2.0f, 1.5f, 0.0f}, {0.01f, 0.01f, 1.99f}, {0.01f, 2.99f, -1.99f}};
    for (size_t i = 0; i < sizeof dark / sizeof dark[0]; ++i) {
        const lmb_gather_point point = {.position = dark[i]};
        lmb_gathered gathered;
        lmb_gather_sh3_parallel(&level.transport, &point, 100000, level.pool, NULL, &gathered);
        CHECK(gathered.squared_length <= 0.0, "%g %g %g: %g", (double)dark[i].x, (double)dark[i].y, (double)dark[i].z,
              gathered.squared_length);
    }
    const lmb_gather_point lit = {.position = {-2.0f, 1.5f, 0.0f}};
    lmb_gathered gathered;
    lmb_gather_sh3(&level.transport, &lit, 64, &gathered);
    CHECK(gathered.moments.channel[0].c[0] > 0.1f, "the lit room: %g", (double)gathered.moments.channel[0].c[0]);
    level_fixture_close(&level);
}

/* For a probe, a light nearer than half a spacing counts as that far; the very point sees the inverse square. */
static void near_lights_stay_finite(void)
{
    lmb_error error;
    level_fixture level;
    CHECK(lmb_level_sphere_room(output_path("near"), 2.0f, 8, 0.0f, 10.0f, &error) == LMB_OK, "%s", error.message);
    if (!level_fixture_load(&level, output_path("near"), NULL, 1)) {
        return;
    }
    static const float distances[] = {0.0f, 0.01f, 0.25f, 1.0f};
    for (size_t i = 0; i < sizeof distances / sizeof distances[0]; ++i) {
        lmb_gather_point point = {.position = {distances[i], 0.0f, 0.0f}, .min_light_distance = 0.5f};
        lmb_gathered gathered;
        lmb_gather_sh3(&level.transport, &point, 8, &gathered);
        const double counted = fmax((double)distances[i], 0.5);
        const double expected = distances[i] > 0.0f ? 0.28209479 * 10.0 / (counted * counted) : 0.0;
        CHECK_NEAR(gathered.moments.channel[0].c[0], expected, 1e-3 * expected, "%g m", (double)distances[i]);
        point.min_light_distance = 0.0f;
        lmb_gather_sh3(&level.transport, &point, 8, &gathered);
        const double exact = distances[i] > 0.0f ? 0.28209479 * 10.0 / pow((double)distances[i], 2.0) : 0.0;
        CHECK_NEAR(gathered.moments.channel[0].c[0], exact, 1e-3 * exact, "%g m, exact", (double)distances[i]);
    }
    level_fixture_close(&level);
}

/* A light marked `indirect` gives the ground nothing, but what the ground reflects of it still arrives from below. */
static void indirect_lights_only_bounce(void)
{
    lmb_error error;
    level_fixture level;
    CHECK(lmb_level_sun_plane(output_path("indirect"), 0.5f, (lmb_vec3){0.0f, -1.0f, 0.0f}, 10.0f, &error) == LMB_OK,
          "%s", error.message);
    if (!level_fixture_load(&level, output_path("indirect"), NULL, 1)) {
        return;
    }
    level.scene->lights[0].indirect_only = true;
    const lmb_vec3 above = {0.1f, 0.01f, 0.2f};
    const lmb_rgb up = traced_irradiance(&level, above, (lmb_vec3){0.0f, 1.0f, 0.0f}, 256);
    const lmb_rgb down = traced_irradiance(&level, above, (lmb_vec3){0.0f, -1.0f, 0.0f}, 1024);
    CHECK_NEAR(up.c[0], 0.0, 1e-6, "direct");
    CHECK_NEAR(down.c[0], 0.5 * 10.0 / PI, 0.02, "reflected");
    level_fixture_close(&level);
}

/* Form factor from a point to a parallel square of side 2a at height h centred above it, by the corner formula of
 * Howell's catalogue: 4 corners of an a x a rectangle. */
static void quad_light_form_factor(void)
{
    static const float heights[] = {0.1f, 0.5f, 2.0f};
    for (size_t i = 0; i < sizeof heights / sizeof heights[0]; ++i) {
        lmb_error error;
        level_fixture level;
        CHECK(lmb_level_quad_light(output_path("quad"), heights[i], 7.0f, &error) == LMB_OK, "%s", error.message);
        if (!level_fixture_load(&level, output_path("quad"), NULL, 1)) {
            return;
        }
        level.transport.bounces = 0;
        const double a = 0.5 / (double)heights[i];
        const double leg = sqrt(1.0 + a * a);
        const double factor = 4.0 * (2.0 * a / leg * atan(a / leg)) / (2.0 * PI);
        const lmb_rgb irradiance =
            traced_irradiance(&level, (lmb_vec3){0.0f, 1e-5f, 0.0f}, (lmb_vec3){0.0f, 1.0f, 0.0f}, 4096);
        CHECK_NEAR(irradiance.c[0], 7.0 * factor, 7.0 * factor * 0.01, "height %g", (double)heights[i]);
        level_fixture_close(&level);
    }
}

static bool same_probes(const lmb_probes *a, const lmb_probes *b)
{
    return a->count == b->count &&
           memcmp(a->radiance[0], b->radiance[0], (size_t)a->count * sizeof *a->radiance[0]) == 0 &&
           memcmp(a->validity, b->validity, (size_t)a->count * sizeof *a->validity) == 0;
}

static void threads_do_not_matter(void)
{
    static const int threads[] = {1, 2, 7};
    lmb_probes *bakes[3] = {NULL, NULL, NULL};
    lmb_error error = {{0}};
    CHECK(lmb_level_cornell(output_path("cornell"), &error) == LMB_OK, "%s", error.message);
    for (int i = 0; i < 3; ++i) {
        level_fixture level;
        if (!level_fixture_load(&level, output_path("cornell"), NULL, threads[i])) {
            return;
        }
        lmb_placement_settings settings = lmb_placement_settings_default();
        settings.spacing = 0.5f;
        lmb_placement_stats placement;
        lmb_gather_stats baked;
        lmb_result result = lmb_placement_make(level.tracer, &settings, level.pool, &bakes[i], &placement, &error);
        if (result == LMB_OK) {
            result = lmb_probes_bake(bakes[i], &level.transport, &(lmb_gather_effort){.samples = 32}, level.pool, NULL,
                                     &baked);
        }
        CHECK(result == LMB_OK, "%d threads: %s", threads[i], error.message);
        CHECK(i == 0 || (bakes[0] && bakes[i] && same_probes(bakes[0], bakes[i])), "%d threads differ from 1",
              threads[i]);
        level_fixture_close(&level);
    }
    for (int i = 0; i < 3; ++i) {
        lmb_probes_destroy(bakes[i]);
    }
}

static cJSON *reference_open(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/references/%s", LMB_DATA_DIR, name);
    if (access(path, R_OK) != 0) {
        test_skip("no reference data here");
        return NULL;
    }
    unsigned char *text;
    size_t size;
    lmb_error error;
    const lmb_result result = lmb_file_read(path, &text, &size, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    cJSON *json = result == LMB_OK ? cJSON_ParseWithLength((const char *)text, size) : NULL;
    free(text);
    return json;
}

static void analytic_references(void)
{
    cJSON *json = reference_open("analytic.json");
    if (!json) {
        return;
    }
    char path[512];
    level_fixture level;
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    const cJSON *file;
    cJSON_ArrayForEach(file, cJSON_GetObjectItem(cJSON_GetObjectItem(json, "furnace"), "files"))
    {
        snprintf(path, sizeof path, "%s/references/analytic/%s", LMB_DATA_DIR, file->string);
        if (level_fixture_load(&level, path, NULL, 1)) {
            const lmb_rgb irradiance = traced_irradiance(&level, (lmb_vec3){0.1f, 0.2f, 0.3f}, up, 8192);
            CHECK_NEAR(irradiance.c[0], file->valuedouble, 0.015 * file->valuedouble, "%s", file->string);
            level_fixture_close(&level);
        }
    }
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(cJSON_GetObjectItem(json, "triangle_lights"), "cases"))
    {
        const char *name = cJSON_GetObjectItem(item, "file")->valuestring;
        const double expected = cJSON_GetObjectItem(item, "irradiance_at_origin_normal_+y")->valuedouble / PI;
        snprintf(path, sizeof path, "%s/references/%s", LMB_DATA_DIR, name);
        if (level_fixture_load(&level, path, NULL, 1)) {
            level.transport.bounces = 0;
            const lmb_rgb irradiance = traced_irradiance(&level, (lmb_vec3){0.0f, 1e-6f, 0.0f}, up, 16384);
            CHECK_NEAR(irradiance.c[0], expected, 0.005 * expected, "%s", name);
            level_fixture_close(&level);
        }
    }
    cJSON_Delete(json);
}

/* Their SH have all signs positive; ours the Condon-Shortley ones. */
static const double sign_of_reference[9] = {1, -1, 1, -1, 1, -1, 1, -1, 1};

/* The environments' own SH, by another reader and another integrator: settles orientation, sampling and decoding. */
static void environment_references(void)
{
    cJSON *json = reference_open("env_sh.json");
    lmb_error error;
    if (!json) {
        return;
    }
    CHECK(lmb_level_open_ground(output_path("speck"), 1e-4f, 0.5f, &error) == LMB_OK, "%s", error.message);
    const cJSON *environment;
    cJSON_ArrayForEach(environment, json)
    {
        char path[512];
        snprintf(path, sizeof path, "%s/envmaps/%s", LMB_DATA_DIR, environment->string);
        if (!cJSON_IsObject(environment) || access(path, R_OK) != 0) {
            continue;
        }
        level_fixture level;
        if (!level_fixture_load(&level, output_path("speck"), path, 2)) {
            continue;
        }
        const lmb_gather_point point = {.position = {0.0f, 100.0f, 0.0f}};
        lmb_gathered gathered;
        lmb_gather_sh3_parallel(&level.transport, &point, 65536, level.pool, NULL, &gathered);
        double off = 0.0, length = 0.0;
        for (int k = 0; k < 27; ++k) {
            const cJSON *coefficient = cJSON_GetArrayItem(cJSON_GetObjectItem(environment, "coeff"), k / 3);
            const double theirs = cJSON_GetArrayItem(coefficient, k % 3)->valuedouble * sign_of_reference[k / 3];
            const double difference = (double)gathered.moments.channel[k % 3].c[k / 3] - theirs;
            off += difference * difference;
            length += theirs * theirs;
        }
        CHECK_NEAR(sqrt(off / length), 0.0, 0.004, "%s", environment->string);
        level_fixture_close(&level);
    }
    cJSON_Delete(json);
}

static void cycles_probe_compare(const cJSON *probe)
{
    char path[512], environment[512];
    snprintf(path, sizeof path, "%s/%s", LMB_DATA_DIR, cJSON_GetObjectItem(probe, "scene")->valuestring);
    const cJSON *env = cJSON_GetObjectItem(probe, "environment");
    if (cJSON_IsString(env)) {
        snprintf(environment, sizeof environment, "%s/%s", LMB_DATA_DIR, env->valuestring);
    }
    level_fixture level;
    if (!level_fixture_load(&level, path, cJSON_IsString(env) ? environment : NULL, 2)) {
        return;
    }
    const cJSON *at = cJSON_GetObjectItem(probe, "position");
    const lmb_gather_point point = {.position = {(float)cJSON_GetArrayItem(at, 0)->valuedouble,
                                                 (float)cJSON_GetArrayItem(at, 1)->valuedouble,
                                                 (float)cJSON_GetArrayItem(at, 2)->valuedouble}};
    lmb_gathered gathered;
    lmb_gather_sh3_parallel(&level.transport, &point, 65536, level.pool, NULL, &gathered);
    double off = 0.0, length = 0.0;
    for (int k = 0; k < 9; ++k) {
        const cJSON *coefficient = cJSON_GetArrayItem(cJSON_GetObjectItem(probe, "coeff"), k);
        for (int c = 0; c < 3; ++c) {
            const double theirs = cJSON_GetArrayItem(coefficient, c)->valuedouble * sign_of_reference[k];
            const double difference = (double)gathered.moments.channel[c].c[k] - theirs;
            off += difference * difference;
            length += theirs * theirs;
        }
    }
    const double noise = cJSON_GetObjectItem(probe, "noise")->valuedouble;
    const double relative = sqrt(off / length);
    printf("     %s at %g %g %g: %.4f from Cycles (its noise %.4f, ours %.4f)\n",
           cJSON_GetObjectItem(probe, "scene")->valuestring, (double)point.position.x, (double)point.position.y,
           (double)point.position.z, relative, noise,
           lmb_relative_error(gathered.squared_error, gathered.squared_length));
    CHECK(relative <= noise + 0.01, "%g from Cycles, allowed %g", relative, noise + 0.01);
    level_fixture_close(&level);
}

static void cycles_probes(void)
{
    cJSON *json = reference_open("cycles_probes.json");
    if (!json) {
        return;
    }
    const cJSON *probe;
    cJSON_ArrayForEach(probe, cJSON_GetObjectItem(json, "probes"))
    {
        cycles_probe_compare(probe);
    }
    cJSON_Delete(json);
}

/* Of a group of probes around (0, 1, 0), gathered with that effort. */
typedef struct group_result {
    double relative_error;
    uint32_t least, most; /* samples */
    lmb_gather_point points[LMB_GATHER_GROUP];
    lmb_gathered gathered[LMB_GATHER_GROUP];
} group_result;

static group_result group_gather(const level_fixture *level, const lmb_gather_effort *effort)
{
    enum { COUNT = LMB_GATHER_GROUP };
    group_result result = {.least = UINT32_MAX};
    for (int i = 0; i < COUNT; ++i) {
        result.points[i] =
            (lmb_gather_point){.position = {0.05f * (float)(i % 8) - 0.2f, 1.0f, 0.05f * (float)(i / 8) - 0.2f}};
    }
    const lmb_gather_list list = gather_fixture_list(result.points, COUNT);
    CHECK(gather_fixture_gather(&level->transport, effort, &list, level->pool, result.gathered) == LMB_OK, "memory");
    double squared_error = 0.0, squared_length = 0.0;
    for (int i = 0; i < COUNT; ++i) {
        const lmb_gathered *gathered = &result.gathered[i];
        squared_error += gathered->squared_error;
        squared_length += gathered->squared_length;
        result.least = gathered->samples < result.least ? gathered->samples : result.least;
        result.most = gathered->samples > result.most ? gathered->samples : result.most;
    }
    result.relative_error = lmb_relative_error(squared_error, squared_length);
    return result;
}

/* As many samples are taken as the pilots want for the tolerance, or the most that there may be. */
static void effort_follows_the_error(void)
{
    lmb_error error = {{0}};
    level_fixture level;
    if (!level_fixture_open(&level, output_path("effort"), lmb_level_cornell(output_path("effort"), &error), &error,
                            1)) {
        return;
    }
    static const double tolerances[] = {0.5, 0.1, 0.05, 0.02};
    uint32_t before = 0;
    for (size_t i = 0; i < sizeof tolerances / sizeof tolerances[0]; ++i) {
        const lmb_gather_effort effort = {.samples = 64, .max_samples = 1 << 16, .tolerance = tolerances[i]};
        const group_result found = group_gather(&level, &effort);
        /* A pilot cannot tell how fast the error will fall: twice the tolerance is the worst that it may end with. */
        CHECK(found.relative_error <= 2.0 * tolerances[i] && found.least >= before, "tolerance %g: %g by %u samples",
              tolerances[i], found.relative_error, found.least);
        before = found.least;
        /* The same samples at once: the same light. */
        const lmb_gathered *gathered = &found.gathered[3];
        lmb_gathered fixed;
        lmb_gather_sh3(&level.transport, &found.points[3], gathered->samples, &fixed);
        CHECK(fixed.samples == gathered->samples && fixed.rays == gathered->rays, "%u samples", gathered->samples);
        CHECK_NEAR(fixed.moments.channel[0].c[0], gathered->moments.channel[0].c[0],
                   1e-5 * (double)fixed.moments.channel[0].c[0], "tolerance %g", tolerances[i]);
    }
    CHECK(before > 256, "%u samples at the last", before);
    const lmb_gather_effort bounded = {.samples = 8, .max_samples = 100, .tolerance = 1e-6};
    const uint32_t blocks = LMB_GATHER_REPLICATES * LMB_GATHER_BLOCK;
    const group_result most = group_gather(&level, &bounded);
    CHECK(most.least == (100 + blocks - 1) / blocks * blocks && most.most == most.least,
          "100 samples in whole blocks: %u to %u", most.least, most.most);
    const lmb_gather_effort dark = {.samples = 64, .max_samples = 1 << 16, .tolerance = 0.01, .floor = 1e6};
    const group_result few = group_gather(&level, &dark);
    CHECK(few.most == 64, "far below the floor: %u", few.most);
    level_fixture_close(&level);
}

/* Root of the summed squared differences of the moments. */
static double moments_apart(const lmb_gathered *a, const lmb_gathered *b)
{
    double squared = 0.0;
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            squared += pow((double)a->moments.channel[c].c[k] - (double)b->moments.channel[c].c[k], 2.0);
        }
    }
    return sqrt(squared);
}

/* A sky with one bright window on high. */
static const char *sky_with_a_window(void)
{
    static const char path[] = LMB_TEST_OUTPUT_DIR "/transport_window.hdr";
    static const char header[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n";
    unsigned char file[sizeof header - 1 + 8 * 16 * 4];
    memcpy(file, header, sizeof header - 1);
    for (int pixel = 0; pixel < 8 * 16; ++pixel) { /* the window is the last four of the third row */
        const unsigned char even[4] = {40, 60, 90, 128}, bright[4] = {200, 180, 120, 134};
        memcpy(file + sizeof header - 1 + 4 * pixel, pixel / 4 == 11 ? bright : even, 4);
    }
    lmb_error error = {{0}};
    CHECK(lmb_file_write(path, file, sizeof file, &error) == LMB_OK, "%s", error.message);
    return path;
}

/* What is left out to measure its worth changes the noise, not the light. */
static void ingredients_keep_the_light(void)
{
    static const struct {
        const char *name;
        unsigned without;
    } variants[] = {{"aimed sky", LMB_WITHOUT_ENVIRONMENT_AIM},
                    {"aimed triangles", LMB_WITHOUT_TRIANGLE_AIM},
                    {"light tree", LMB_WITHOUT_TRIANGLE_TREE},
                    {"sequence", LMB_WITHOUT_SEQUENCE}};
    lmb_error error = {{0}};
    level_fixture level;
    CHECK(lmb_level_cornell(output_path("ingredients"), &error) == LMB_OK, "%s", error.message);
    if (!level_fixture_load(&level, output_path("ingredients"), sky_with_a_window(), 1)) {
        return;
    }
    CHECK(lmb_emitters_triangle_count(level.emitters) > 1 && lmb_emitters_environment_sampled(level.emitters), "light");
    const lmb_gather_point point = {.position = {0.3f, 1.2f, 0.2f}};
    lmb_gathered with;
    lmb_gather_sh3(&level.transport, &point, 32768, &with);
    for (size_t i = 0; i < sizeof variants / sizeof variants[0]; ++i) {
        lmb_emitters *emitters = NULL;
        CHECK(lmb_emitters_create_without(level.tracer, variants[i].without, &emitters) == LMB_OK, "memory");
        CHECK((lmb_emitters_triangle_count(emitters) == 0) == (variants[i].without == LMB_WITHOUT_TRIANGLE_AIM) &&
                  lmb_emitters_environment_sampled(emitters) != (variants[i].without == LMB_WITHOUT_ENVIRONMENT_AIM),
              "%s", variants[i].name);
        lmb_transport transport = level.transport;
        transport.emitters = emitters;
        lmb_gathered without;
        lmb_gather_sh3(&transport, &point, 32768, &without);
        const double apart = moments_apart(&with, &without);
        const double noise = sqrt(with.squared_error + without.squared_error);
        CHECK(apart > 0.0 && apart < 3.0 * noise && noise < 0.05 * sqrt(with.squared_length), "%s: %g apart, noise %g",
              variants[i].name, apart, noise);
        lmb_emitters_destroy(emitters);
    }
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"furnace_is_uniform", furnace_is_uniform},
    {"bounces_are_counted", bounces_are_counted},
    {"sky_lights_open_ground", sky_lights_open_ground},
    {"point_light_in_sphere", point_light_in_sphere},
    {"sun_on_plane", sun_on_plane},
    {"sealed_room_is_dark", sealed_room_is_dark},
    {"near_lights_stay_finite", near_lights_stay_finite},
    {"indirect_lights_only_bounce", indirect_lights_only_bounce},
    {"quad_light_form_factor", quad_light_form_factor},
    {"threads_do_not_matter", threads_do_not_matter},
    {"analytic_references", analytic_references},
    {"environment_references", environment_references},
    {"cycles_probes", cycles_probes},
    {"effort_follows_the_error", effort_follows_the_error},
    {"ingredients_keep_the_light", ingredients_keep_the_light},
};

TEST_MAIN(cases)
