/* Lightmaps on geometry that is thinner than their texels, or bends within one: whatever bilinear filtering mixes
 * there, no more light comes out than there is. Under a white sky of 1 nothing on earth receives more than 1; where the
 * level is white too, everything receives just that. */
#include "lightmap_fixture.h"
#include "variates.h"

#include <lambent/surface.h>

/* Shading normals: n_v, four tilted by 30 degrees, four by 60. */
enum { NORMALS = 9, POINTS_PER_TRIANGLE = 24 };

/* A half round moulding of radius `radius` along a straight line. */
typedef struct moulding {
    lmb_vec3 from, along, side, out; /* along: the whole way; side, out: unit */
    float radius;
} moulding;

static lmb_vec3 mixed(lmb_vec3 a, double s, lmb_vec3 b, double t)
{
    return (lmb_vec3){(float)(s * (double)a.x + t * (double)b.x), (float)(s * (double)a.y + t * (double)b.y),
                      (float)(s * (double)a.z + t * (double)b.z)};
}

static lmb_vec3 unit(lmb_vec3 a)
{
    const double length = sqrt((double)a.x * (double)a.x + (double)a.y * (double)a.y + (double)a.z * (double)a.z);
    return mixed(a, 1.0 / length, a, 0.0);
}

static lmb_level_point moulding_point(const void *context, double u, double v)
{
    const moulding *shape = context;
    const double angle = 3.14159265358979323846 * v;
    const lmb_vec3 normal = mixed(shape->side, cos(angle), shape->out, sin(angle));
    const lmb_vec3 on_axis = mixed(shape->from, 1.0, shape->along, u);
    return (lmb_level_point){mixed(on_axis, 1.0, normal, (double)shape->radius), normal, unit(shape->along)};
}

static void add_moulding(lmb_level_builder *builder, int mesh, int material, const moulding *shape, int rows)
{
    const lmb_level_patch patch = {.columns = 4,
                                   .rows = rows,
                                   .width_m = 0.5f,
                                   .height_m = 3.14159f * shape->radius,
                                   .surface = moulding_point,
                                   .context = shape};
    lmb_level_builder_add_patch(builder, mesh, material, &patch);
}

/* A picture frame of half round mouldings on the wall z = 0. */
static void add_frame(lmb_level_builder *builder, int mesh, int material, lmb_vec3 low, float radius)
{
    const lmb_vec3 out = {0, 0, 1};
    const float end = 2.0f * radius; /* apart, so that no surface is inside of another */
    const moulding sides[4] = {
        {{low.x + end, low.y, low.z}, {0.5f - 2.0f * end, 0, 0}, {0, -1, 0}, out, radius},
        {{low.x + end, low.y + 0.4f, low.z}, {0.5f - 2.0f * end, 0, 0}, {0, -1, 0}, out, radius},
        {low, {0, 0.4f, 0}, {1, 0, 0}, out, radius},
        {{low.x + 0.5f, low.y, low.z}, {0, 0.4f, 0}, {1, 0, 0}, out, radius},
    };
    for (int i = 0; i < 4; ++i) {
        add_moulding(builder, mesh, material, &sides[i], 16);
    }
}

typedef void (*shape_function)(lmb_level_builder *builder, int mesh, int material);

static void add_thin_slabs(lmb_level_builder *builder, int mesh, int material)
{
    static const float THICKNESS[] = {0.002f, 0.005f, 0.01f, 0.02f, 0.05f};
    for (int i = 0; i < 5; ++i) {
        const float x = 0.15f * (float)i;
        const lmb_level_box box =
            lmb_level_box_of((lmb_vec3){x, 0, 0.2f}, (lmb_vec3){x + THICKNESS[i], 0.4f, 0.6f}, material);
        lmb_level_builder_add_box(builder, mesh, &box);
    }
}

static void add_stairs(lmb_level_builder *builder, int mesh, int material)
{
    for (int i = 0; i < 6; ++i) {
        const float y = 0.05f * (float)i;
        const lmb_level_box box =
            lmb_level_box_of((lmb_vec3){0.1f, y, 0.1f + y}, (lmb_vec3){0.6f, y + 0.05f, 0.15f + y}, material);
        lmb_level_builder_add_box(builder, mesh, &box);
    }
}

static void add_round_posts(lmb_level_builder *builder, int mesh, int material)
{
    static const float RADIUS[] = {0.001f, 0.004f, 0.012f, 0.025f, 0.06f};
    for (int i = 0; i < 5; ++i) {
        lmb_level_builder_add_cylinder(
            builder, mesh, material,
            &(lmb_level_cylinder){
                .base = {0.18f * (float)i, 0, 0.3f}, .radius = RADIUS[i], .height = 0.5f, .segments = 5 + 3 * i});
    }
}

static void add_balls(lmb_level_builder *builder, int mesh, int material)
{
    static const float RADIUS[] = {0.005f, 0.02f, 0.05f, 0.12f};
    for (int i = 0; i < 4; ++i) {
        lmb_level_builder_add_sphere(
            builder, mesh, material,
            &(lmb_level_sphere){.centre = {0.25f * (float)i, 0.15f, 0.3f}, .radius = RADIUS[i], .divisions = 2 + i});
    }
}

static void add_frames(lmb_level_builder *builder, int mesh, int material)
{
    add_frame(builder, mesh, material, (lmb_vec3){0.05f, 0.1f, 0.0f}, 0.002f);
    add_frame(builder, mesh, material, (lmb_vec3){0.12f, 0.15f, 0.0f}, 0.01f);
    add_frame(builder, mesh, material, (lmb_vec3){0.3f, 0.25f, 0.0f}, 0.03f);
}

static const struct {
    const char *name;
    shape_function add;
} SHAPES[] = {
    {"thin slabs", add_thin_slabs}, {"stairs", add_stairs}, {"round posts", add_round_posts},
    {"balls", add_balls},           {"frames", add_frames},
};
enum { SHAPE_COUNT = sizeof SHAPES / sizeof SHAPES[0] };

/* The shape before a wall and on a floor. The islands of its UVs are a millimetre apart: they share texels. */
static lmb_result write_shape(const char *path, shape_function add, float albedo, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.001f);
    const int material = plain_material(builder, albedo);
    const int mesh = lmb_level_builder_add_mesh(builder, "all");
    lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){-0.1f, 0, 0.8f}, (lmb_vec3){1, 0, 0},
                               (lmb_vec3){0, 0, -0.8f});
    lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){-0.1f, 0, 0}, (lmb_vec3){1, 0, 0},
                               (lmb_vec3){0, 0.7f, 0});
    add(builder, mesh, material);
    lmb_level_builder_place(builder, "all", mesh, (lmb_vec3){0, 0, 0});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static void normals_make(lmb_vec3 n, lmb_vec3 normals[NORMALS])
{
    const lmb_vec3 axis = fabsf(n.x) < 0.6f ? (lmb_vec3){1, 0, 0} : (lmb_vec3){0, 1, 0};
    const double along = (double)(axis.x * n.x + axis.y * n.y + axis.z * n.z);
    const lmb_vec3 x = unit(mixed(axis, 1.0, n, -along));
    const lmb_vec3 y = {n.y * x.z - n.z * x.y, n.z * x.x - n.x * x.z, n.x * x.y - n.y * x.x};
    normals[0] = n;
    for (int k = 0; k < 8; ++k) {
        const double turn = 3.14159265358979323846 * (k / 2) / 2.0 + (k % 2) * 0.785;
        const double tilt = 3.14159265358979323846 * (k < 4 ? 30.0 : 60.0) / 180.0;
        normals[k + 1] = mixed(n, cos(tilt), mixed(x, cos(turn), y, sin(turn)), sin(tilt));
    }
}

/* Irradiance all over the surfaces as a renderer decodes it: the largest, over the noise of I_z where that is above 1;
 * the mean; and the mean of light that is all ambient. */
typedef struct shine {
    double largest, mean, mean_ambient;
} shine;

static shine shine_measure(const baked *bake)
{
    const lmb_scene *scene = bake->level.scene;
    const uint32_t triangles = scene->meshes[0].triangle_count;
    uint64_t state = 5;
    shine found = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < triangles * POINTS_PER_TRIANGLE; ++i) {
        const uint32_t t = i / POINTS_PER_TRIANGLE;
        const float root = sqrtf((float)variate_next(&state)), across = (float)variate_next(&state);
        const float u = root * (1.0f - across), v = root * across;
        const lmb_vec3 n = lmb_trace_place(bake->level.tracer, &(lmb_hit){.instance = 0, .triangle = t, .u = u, .v = v})
                               .shading_normal;
        float channel[LMB_MODEL_MOST_CHANNELS];
        lmb_lightmap_sample(bake->lightmap, &(lmb_hit){.instance = 0, .triangle = t, .u = u, .v = v}, channel);
        const double noise = fmax(1.0, (double)channel[1]); /* green of I_z */
        lmb_vec3 normals[NORMALS];
        lmb_rgb light[NORMALS];
        normals_make(n, normals);
        bake->lightmap->model->evaluate(channel, n, normals, NORMALS, light);
        for (int k = 0; k < NORMALS; ++k) {
            const double irradiance = (double)light[k].c[1];
            found.largest = fmax(found.largest, irradiance / noise);
            /* Floor and wall are partly inside of what stands before them. */
            const double share = t < 4 ? 0.0 : 1.0 / (triangles - 4) / POINTS_PER_TRIANGLE / NORMALS;
            const double cosine = (double)(n.x * normals[k].x + n.y * normals[k].y + n.z * normals[k].z);
            found.mean += share * irradiance;
            found.mean_ambient += share * (0.5 + 0.5 * cosine);
        }
    }
    return found;
}

static void shine_check(int shape, float albedo, float density, bool own_uv, const lmb_model *model)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_shine.glb");
    baked bake;
    const lmb_result written = write_shape(path, SHAPES[shape].add, albedo, &error);
    CHECK(written == LMB_OK, "%s", error.message);
    if (written != LMB_OK || !level_fixture_load(&bake.level, path, "#ffffff", 2)) {
        return;
    }
    if (!own_uv) {
        uv_break(&bake.level.scene->meshes[0], LMB_UV_MISSING);
    }
    const lmb_lightmap_settings settings = {.texels_per_m = density, .max_image_size = 1024, .model = model};
    bake.lightmap = NULL;
    const lmb_result made = lmb_lightmap_create(bake.level.scene, &settings, &bake.lightmap, &error);
    CHECK(made == LMB_OK, "%s", error.message);
    if (made == LMB_OK && lightmap_bake(&bake, 256)) {
        const shine found = shine_measure(&bake);
        const char *uv = own_uv ? "own UVs" : "charts";
        printf("     %s, %s, albedo %g, %g texels/m, %s: %.4f at most, mean %.4f\n", model->name, SHAPES[shape].name,
               (double)albedo, (double)density, uv, found.largest, found.mean);
        CHECK(found.largest <= 1.01, "%s, %s, albedo %g, %g texels/m, %s: %g under a sky of 1", model->name,
              SHAPES[shape].name, (double)albedo, (double)density, uv, found.largest);
        if (albedo == 1.0f) {
            CHECK_NEAR(found.mean, found.mean_ambient, 0.01, "%s, %g texels/m, %s", SHAPES[shape].name, (double)density,
                       uv);
        }
    }
    lmb_lightmap_destroy(bake.lightmap);
    level_fixture_close(&bake.level);
}

static void all_shapes(float albedo, const lmb_model *model)
{
    for (int shape = 0; shape < SHAPE_COUNT; ++shape) {
        for (float density = 4.0f; density <= 32.0f; density *= 2.0f) {
            shine_check(shape, albedo, density, false, model);
            shine_check(shape, albedo, density, true, model);
        }
    }
}

static void white_level(void)
{
    all_shapes(1.0f, lmb_model_default(LMB_MODEL_FOR_LIGHTMAP));
}

static void black_level(void)
{
    all_shapes(0.0f, lmb_model_default(LMB_MODEL_FOR_LIGHTMAP));
}

static void white_level_for_textures(void)
{
    all_shapes(1.0f, lmb_model_default(LMB_MODEL_FOR_TEXTURE));
}

static void black_level_for_textures(void)
{
    all_shapes(0.0f, lmb_model_default(LMB_MODEL_FOR_TEXTURE));
}

static const test_case cases[] = {
    {"white level, white sky", white_level},
    {"black level, white sky", black_level},
    {"white level, white sky, textures' model", white_level_for_textures},
    {"black level, white sky, textures' model", black_level_for_textures},
};

TEST_MAIN(cases)
