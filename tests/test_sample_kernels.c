/* Samples by every kernel that the library has here, and in batches, are the same bits: at all kinds of positions, with
 * probes missing and without, with key lights and without, in one level and in several, with cut cells, in both forms.
 */
#include "levels_fixture.h"
#include "harness.h"

#include <lambent/pack.h>
#include <lambent/vector.h>

#include "volume_internal.h"

#include <float.h>

enum { MOST_POSITIONS = 4000 };

typedef struct opened {
    unsigned char *data;
    lmb_volume *volume;
    lmb_vec3d position[MOST_POSITIONS];
} opened;

/* Half of them anywhere about the box, the others on its points and faces, just off them, far outside, or no numbers.
 */
static void positions_make(const lmb_lattice *lattice, uint64_t seed, lmb_vec3d *position)
{
    static const double odd[] = {
        0.0, -0.0, 1e-320, -1e-9, 1e-9, 1e30, -1e30, DBL_MAX, (double)INFINITY, -(double)INFINITY, (double)NAN};
    enum { ODD = sizeof odd / sizeof odd[0] };
    uint64_t state = seed;
    for (int i = 0; i < MOST_POSITIONS; ++i) {
        double at[3];
        for (int axis = 0; axis < 3; ++axis) {
            const double spread = fixture_random(&state) * (lattice->size[axis] + 1.0) - 1.0;
            const double on_point = floor(spread) + (i % 3 == 0 ? 1e-7 * (fixture_random(&state) - 0.5) : 0.0);
            at[axis] = (lattice->min[axis] + (i % 2 ? spread : on_point)) * (double)lattice->spacing;
        }
        if (i % 16 == 0) {
            at[i / 16 % 3] = odd[i / 48 % ODD];
        }
        position[i] = (lmb_vec3d){at[0], at[1], at[2]};
    }
}

static void volume_open(const lmb_probes *probes, lmb_volume_form form, opened *made)
{
    size_t size;
    const lmb_result result = lmb_pack_as(form, probes, &made->data, &size, NULL);
    CHECK(result == LMB_OK && lmb_volume_open_memory(made->data, size, &made->volume) == LMB_OK, "pack: %d", result);
    if (!made->volume) {
        abort();
    }
}

static opened volume_make(const lmb_lattice *lattice, double density, double magnitude, uint32_t keys,
                          lmb_volume_form form, uint64_t seed)
{
    opened made = {.data = NULL};
    lmb_probes *const probes = fixture_random_probes(lattice, density, 0.9, magnitude, seed);
    probes->key_light_count = keys;
    uint64_t state = seed + 17;
    for (uint32_t key = 0; key < keys; ++key) {
        probes->key_light[key] = (lmb_key_light){{0.0f, 1.0f, 0.0f}, {{1.0f, 2.0f, 3.0f}}};
        for (int32_t probe = 0; probe < probes->count; ++probe) {
            probes->key_visibility[probe][key] = (float)fixture_random(&state);
        }
    }
    volume_open(probes, form, &made);
    positions_make(lattice, seed + 5, made.position);
    lmb_probes_destroy(probes);
    return made;
}

static void volume_free(opened *made)
{
    lmb_volume_close(made->volume);
    free(made->data);
}

/* Of several levels, with cut cells. */
static opened levels_volume_make(const levels_recipe *recipe, lmb_volume_form form)
{
    opened made = {.data = NULL};
    lmb_probes *const probes = levels_make(recipe);
    volume_open(probes, form, &made);
    positions_make(&probes->level[0].lattice, recipe->seed + 5, made.position);
    lmb_probes_destroy(probes);
    return made;
}

static const struct {
    lmb_lattice lattice;
    double density, magnitude;
    uint32_t keys;
} cases[] = {
    {{.spacing = 1.0f, .min = {0, 0, 0}, .size = {2, 2, 2}}, 1.0, 1.0, 0},
    {{.spacing = 0.3f, .min = {-5, -6, -7}, .size = {13, 6, 10}}, 1.0, 100.0, 4},
    {{.spacing = 1.7f, .min = {3, 3, 3}, .size = {12, 11, 7}}, 0.8, 5.0, 1},
    {{.spacing = 0.25f, .min = {0, 0, 0}, .size = {30, 3, 17}}, 0.05, 5.0, 2},
    {{.spacing = 2.0f, .min = {0, 0, 0}, .size = {1, 9, 1}}, 1.0, 5.0, 0},
    {{.spacing = 1.0f, .min = {0, 0, 0}, .size = {6, 6, 6}}, 0.9, 1e7, 0},
    {{.spacing = 1.0f, .min = {0, 0, 0}, .size = {6, 6, 6}}, 0.9, 1e-9, 0},
    {{.spacing = 1.0f, .min = {0, 0, 0}, .size = {9, 9, 9}}, 1.0, 1e-5, 3},
    {{.spacing = 0.5f, .min = {20000, -30000, 7}, .size = {6, 7, 8}}, 0.8, 2.0, 1},
};
/* Each in both forms. */
enum { BOXES = sizeof cases / sizeof cases[0], VOLUMES = BOXES + LEVELS_RECIPES, CASES = 2 * VOLUMES };

static opened case_make(int number, uint64_t seed)
{
    const lmb_volume_form form = number < VOLUMES ? LMB_VOLUME_HALFS : LMB_VOLUME_COMPACT;
    const int k = number % VOLUMES;
    return k < BOXES ? volume_make(&cases[k].lattice, cases[k].density, cases[k].magnitude, cases[k].keys, form,
                                   seed + (uint64_t)k)
                     : levels_volume_make(&levels_recipes[k - BOXES], form);
}

/* What a call leaves. */
typedef struct sampled {
    lmb_sh3_rgb radiance;
    float visibility[LMB_KEY_LIGHTS_MOST];
    bool inside;
} sampled;

static bool equal(const sampled *a, const sampled *b)
{
    return memcmp(&a->radiance, &b->radiance, sizeof a->radiance) == 0 &&
           memcmp(a->visibility, b->visibility, sizeof a->visibility) == 0 && a->inside == b->inside;
}

static const lmb_volume_calls *calls_of(const lmb_volume_kernel *kernel, const lmb_volume *volume)
{
    return lmb_volume_kernel_calls(kernel, volume->header);
}

static sampled sample_by(const lmb_volume_kernel *kernel, const lmb_volume *volume, lmb_vec3d at)
{
    sampled got;
    memset(&got, 0x5a, sizeof got);
    got.inside = calls_of(kernel, volume)->sample_with_keys(volume, at.x, at.y, at.z, &got.radiance, got.visibility);
    return got;
}

/* Those that this processor runs, plain C first. */
static size_t kernels_here(const lmb_volume_kernel *kernel[3])
{
    const lmb_volume_kernel *const chosen = lmb_volume_kernel_choose();
    size_t count = 0;
    kernel[count++] = &lmb_volume_kernel_scalar;
    if (lmb_volume_kernel_avx2 && chosen != &lmb_volume_kernel_scalar) {
        kernel[count++] = lmb_volume_kernel_avx2;
    }
    if (chosen == lmb_volume_kernel_avx512 || chosen == lmb_volume_kernel_neon) {
        kernel[count++] = chosen;
    }
    return count;
}

static void kernel_check(const lmb_volume_kernel *kernel, const opened *made, int number)
{
    for (int i = 0; i < MOST_POSITIONS; ++i) {
        const lmb_vec3d at = made->position[i];
        const sampled plain = sample_by(&lmb_volume_kernel_scalar, made->volume, at);
        const sampled fast = sample_by(kernel, made->volume, at);
        sampled without = fast;
        without.inside = calls_of(kernel, made->volume)->sample(made->volume, at.x, at.y, at.z, &without.radiance);
        CHECK(equal(&plain, &fast), "%s, case %d at (%.9g, %.9g, %.9g)", kernel->name, number, at.x, at.y, at.z);
        CHECK(equal(&plain, &without), "%s without keys, case %d at (%.9g, %.9g, %.9g)", kernel->name, number, at.x,
              at.y, at.z);
    }
}

static void kernels_give_the_same_bits(void)
{
    const lmb_volume_kernel *const chosen = lmb_volume_kernel_choose();
    const lmb_volume_kernel *kernel[3];
    const size_t count = kernels_here(kernel);
    printf("     this processor: %s\n", chosen->name);
    if (chosen == &lmb_volume_kernel_scalar) {
        test_skip("plain C is all that runs here");
        return;
    }
    for (int k = 0; k < CASES; ++k) {
        opened made = case_make(k, 1);
        CHECK(made.volume->calls == calls_of(chosen, made.volume), "a volume is opened with it");
        for (size_t i = 1; i < count; ++i) {
            kernel_check(kernel[i], &made, k);
        }
        volume_free(&made);
    }
}

/* Of any length, around what is asked for ahead; with what may be left out, and without. */
static void batch_check(const lmb_volume_kernel *kernel, const opened *made, size_t first, size_t count)
{
    static lmb_sh3_rgb radiance[MOST_POSITIONS + 1];
    static float visibility[MOST_POSITIONS + 1][LMB_KEY_LIGHTS_MOST];
    static bool inside[MOST_POSITIONS + 1];
    const lmb_vec3d *const position = made->position + first;
    for (int outputs = 0; outputs < 4; ++outputs) {
        const bool with_visibility = outputs & 1, with_inside = outputs & 2;
        memset(radiance, 0x5a, sizeof radiance);
        memset(visibility, 0x5a, sizeof visibility);
        calls_of(kernel, made->volume)
            ->batch(made->volume, position, count, radiance, with_visibility ? visibility : NULL,
                    with_inside ? inside : NULL);
        for (size_t i = 0; i < count; ++i) {
            const sampled single = sample_by(kernel, made->volume, position[i]);
            sampled got = single;
            got.radiance = radiance[i];
            if (with_visibility) {
                memcpy(got.visibility, visibility[i], sizeof got.visibility);
            }
            got.inside = with_inside ? inside[i] : single.inside;
            CHECK(equal(&single, &got), "%s, %zu of %zu, outputs %d", kernel->name, i, count, outputs);
        }
        const unsigned char *const beyond = (const unsigned char *)&radiance[count];
        CHECK(beyond[0] == 0x5a && ((const unsigned char *)visibility[count])[0] == 0x5a, "%zu: one too many", count);
    }
}

static void batches_give_the_bits_of_single_calls(void)
{
    static const size_t counts[] = {0, 1, 2, 11, 12, 13, 15, 16, 17, 31, 32, 100, MOST_POSITIONS};
    const lmb_volume_kernel *kernel[3];
    const size_t kernels = kernels_here(kernel);
    for (int k = 0; k < CASES; ++k) {
        opened made = case_make(k, 50);
        for (size_t i = 0; i < sizeof counts / sizeof counts[0]; ++i) {
            const size_t first = (i * 37) % (MOST_POSITIONS - counts[i] + 1);
            for (size_t n = 0; n < kernels; ++n) {
                batch_check(kernel[n], &made, first, counts[i]);
            }
        }
        volume_free(&made);
    }
}

static lmb_vec3 random_normal(uint64_t *state)
{
    const lmb_vec3 n = {(float)(2.0 * fixture_random(state) - 1.0), (float)(2.0 * fixture_random(state) - 1.0),
                        (float)(2.0 * fixture_random(state) - 1.0)};
    return lmb_vec3_unit_or(n, (lmb_vec3){0.0f, 1.0f, 0.0f});
}

/* The same bits by every kernel and in batches, and what sampling and evaluating give, to some 1e-6 of the light. */
static void irradiance_is_that_of_samples(void)
{
    const lmb_volume_kernel *kernel[3];
    const size_t kernels = kernels_here(kernel);
    static lmb_vec3 normal[MOST_POSITIONS];
    static lmb_rgb batch[MOST_POSITIONS];
    static bool inside[MOST_POSITIONS];
    uint64_t state = 3;
    for (int i = 0; i < MOST_POSITIONS; ++i) {
        normal[i] = random_normal(&state);
    }
    for (int k = 0; k < CASES; ++k) {
        opened made = case_make(k, 90);
        lmb_volume_irradiance_batch(made.volume, made.position, normal, MOST_POSITIONS, batch, inside);
        for (int i = 0; i < MOST_POSITIONS; ++i) {
            const lmb_vec3d at = made.position[i];
            lmb_sh3_rgb light;
            const bool is_inside = lmb_volume_sample_at(made.volume, at, &light);
            const lmb_rgb expected = lmb_sh3_rgb_irradiance(&light, normal[i]);
            float size = 0.0f;
            for (int c = 0; c < 27; ++c) {
                size += fabsf(light.channel[c / 9].c[c % 9]);
            }
            for (int c = 0; c < 3; ++c) {
                CHECK_NEAR(batch[i].c[c], expected.c[c], 1e-6f * size, "case %d at (%.9g, %.9g, %.9g)", k, at.x, at.y,
                           at.z);
            }
            for (size_t n = 0; n < kernels; ++n) {
                lmb_rgb single;
                const bool found =
                    calls_of(kernel[n], made.volume)->irradiance(made.volume, at.x, at.y, at.z, &normal[i], &single);
                CHECK(found == is_inside && inside[i] == is_inside && memcmp(&single, &batch[i], sizeof single) == 0,
                      "%s, case %d at (%.9g, %.9g, %.9g)", kernel[n]->name, k, at.x, at.y, at.z);
            }
        }
        volume_free(&made);
    }
}

static void irradiance_of_broken_normals(void)
{
    static const float odd[] = {NAN, INFINITY, -INFINITY, 0.0f, FLT_MAX};
    opened made = case_make(1, 1);
    for (int i = 0; i < 5; ++i) {
        lmb_rgb light = {{-1.0f, -1.0f, -1.0f}};
        const lmb_vec3d low = lmb_volume_get_info(made.volume).bounds_min;
        lmb_volume_irradiance(made.volume, low, (lmb_vec3){odd[i], 1.0f, odd[(i + 1) % 5]}, &light);
        for (int c = 0; c < 3; ++c) {
            CHECK(light.c[c] >= 0.0f && light.c[c] <= FLT_MAX, "normal %d: %g", i, (double)light.c[c]);
        }
    }
    volume_free(&made);
}

static const test_case table[] = {
    {"kernels_give_the_same_bits", kernels_give_the_same_bits},
    {"batches_give_the_bits_of_single_calls", batches_give_the_bits_of_single_calls},
    {"irradiance_is_that_of_samples", irradiance_is_that_of_samples},
    {"irradiance_of_broken_normals", irradiance_of_broken_normals},
};
TEST_MAIN(table)
