/* Bounces between rows, against a dense system solved by GSL and against plain sums. */
#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_linalg.h>

#include <lambent/sequence.h>

#include "harness.h"
#include "solve/bounces.h"

/* Each row sees so many others, one to three times. */
enum { ROWS = 600, SEEN = 16, MOST_TIMES = 3, LINKS = SEEN * MOST_TIMES };

/* Rows along a corridor that see others up to some way off. */
typedef struct corridor {
    uint32_t count;
    size_t *first;
    lmb_link *links;
    float *samples;
    lmb_rgb *direct;
} corridor;

static void corridor_free(corridor *made)
{
    free(made->first);
    free(made->links);
    free(made->samples);
    free(made->direct);
}

static float share(uint64_t a, uint64_t b)
{
    return (float)(lmb_mix(a, b) >> 40) / 16777216.0f;
}

/* Every surface reflects `albedo`; each channel has its own light at every tenth row. */
static corridor corridor_make(uint32_t count, uint32_t reach, float albedo)
{
    corridor made = {count, calloc(count + 1u, sizeof(size_t)), calloc((size_t)count * LINKS, sizeof(lmb_link)),
                     calloc(count, sizeof(float)), calloc(count, sizeof(lmb_rgb))};
    size_t links = 0;
    for (uint32_t i = 0; i < count; ++i) {
        for (uint32_t k = 0; k < SEEN; ++k) {
            const uint32_t target = i + (uint32_t)(share(i, k) * (float)(2 * reach + 1));
            lmb_link link = {.target = target < reach ? 0 : target - reach < count ? target - reach : count - 1};
            for (int c = 0; c < 3; ++c) {
                link.weight[c] = (uint16_t)(albedo * 65535.0f + 0.5f);
            }
            for (uint32_t times = 0; times < 1 + (i + k) % MOST_TIMES; ++times) {
                made.links[links++] = link;
            }
        }
        made.first[i + 1] = links;
        made.samples[i] = (float)(links - made.first[i]);
        for (uint32_t c = 0; c < 3; ++c) {
            made.direct[i].c[c] = (i + 3 * c) % 10 == 0 ? share(i, 1000 + c) : 0.0f;
        }
    }
    return made;
}

static lmb_rgb *corridor_sum(const corridor *made, int bounces, int threads, int *passes)
{
    lmb_rgb *light = malloc(made->count * sizeof *light);
    memcpy(light, made->direct, made->count * sizeof *light);
    lmb_pool *pool = NULL;
    CHECK(lmb_pool_create(threads, &pool) == LMB_OK, "a pool of %d", threads);
    const lmb_bounce_rows rows = {made->count, made->first, made->links, made->samples, light};
    CHECK(lmb_bounces_sum(&rows, bounces, pool, NULL, passes) == LMB_OK, "bounces of %u rows", made->count);
    lmb_pool_destroy(pool);
    return light;
}

/* (1 - T) x = d of one channel. */
static gsl_vector *dense_solve(const corridor *made, int channel)
{
    gsl_matrix *matrix = gsl_matrix_alloc(made->count, made->count);
    gsl_vector *direct = gsl_vector_alloc(made->count);
    gsl_vector *solution = gsl_vector_alloc(made->count);
    gsl_permutation *order = gsl_permutation_alloc(made->count);
    gsl_matrix_set_identity(matrix);
    for (uint32_t i = 0; i < made->count; ++i) {
        gsl_vector_set(direct, i, (double)made->direct[i].c[channel]);
        for (size_t k = made->first[i]; k < made->first[i + 1]; ++k) {
            const lmb_link *link = &made->links[k];
            const double part = link->weight[channel] / 65535.0 / (double)made->samples[i];
            *gsl_matrix_ptr(matrix, i, link->target) -= part;
        }
    }
    int sign;
    gsl_linalg_LU_decomp(matrix, order, &sign);
    gsl_linalg_LU_solve(matrix, order, direct, solution);
    gsl_permutation_free(order);
    gsl_vector_free(direct);
    gsl_matrix_free(matrix);
    return solution;
}

/* The largest relative error of a row. */
static double error_most(const corridor *made, const lmb_rgb *light)
{
    double most = 0.0;
    for (int c = 0; c < 3; ++c) {
        gsl_vector *solution = dense_solve(made, c);
        for (uint32_t i = 0; i < made->count; ++i) {
            const double expected = gsl_vector_get(solution, i);
            most = fmax(most, fabs((double)light[i].c[c] - expected) / (expected + 1e-9));
        }
        gsl_vector_free(solution);
    }
    return most;
}

/* Plain passes would take log(1000) / (1 - albedo), 7000 of the last, to leave out a thousandth. */
static void all_bounces_solve_the_system(void)
{
    static const float albedo[] = {0.0f, 0.5f, 0.9f, 0.99f, 0.999f};
    static const double bound[] = {1e-6, 2e-3, 0.01, 0.02, 0.1};
    static const uint32_t reach[] = {300, 100, 30, 10, 4};
    for (int i = 0; i < 25; ++i) {
        corridor made = corridor_make(ROWS, reach[i / 5], albedo[i % 5]);
        int passes;
        lmb_rgb *light = corridor_sum(&made, -1, 1, &passes);
        CHECK_NEAR(error_most(&made, light), 0.0, bound[i % 5], "albedo %g, reach %u, %d passes", (double)albedo[i % 5],
                   reach[i / 5], passes);
        CHECK(passes <= 400, "albedo %g, reach %u: %d passes", (double)albedo[i % 5], reach[i / 5], passes);
        free(light);
        corridor_free(&made);
    }
}

/* Chains of rows, each seen by the next alone and the last by nobody, beside rows that all see each other. */
static void rows_that_give_no_light_take_it(void)
{
    enum { CHAIN = 5 };
    corridor made = corridor_make(ROWS, 100, 0.9f);
    for (uint32_t i = 0; i < ROWS; ++i) {
        for (size_t k = made.first[i]; k < made.first[i + 1]; ++k) {
            lmb_link *link = &made.links[k];
            link->target -= link->target % CHAIN;
            if (i % CHAIN != 0 && k % 2 == 0) {
                link->target = i % 2 == 0 && i % CHAIN > 1 ? i - 2 : i - 1;
            }
        }
    }
    int passes;
    lmb_rgb *light = corridor_sum(&made, -1, 1, &passes);
    CHECK_NEAR(error_most(&made, light), 0.0, 0.01, "%d passes", passes);
    free(light);
    corridor_free(&made);
}

/* Mirrors around no light but what is already there would sum without end. */
static void trapped_light_harms_nobody_else(void)
{
    enum { TRAPPED = 8 };
    corridor made = corridor_make(ROWS, 30, 0.9f);
    for (uint32_t i = 0; i < ROWS; ++i) {
        for (size_t k = made.first[i]; k < made.first[i + 1]; ++k) {
            lmb_link *link = &made.links[k];
            const bool trapped = i >= ROWS - TRAPPED;
            link->target = trapped ? ROWS - TRAPPED + (uint32_t)(k % TRAPPED) : link->target % (ROWS - TRAPPED);
            for (int c = 0; c < 3 && trapped; ++c) {
                link->weight[c] = 65535;
            }
        }
    }
    int passes;
    lmb_rgb *light = corridor_sum(&made, -1, 1, &passes);
    for (uint32_t i = 0; i < ROWS; ++i) {
        for (int c = 0; c < 3; ++c) {
            CHECK(isfinite(light[i].c[c]) && light[i].c[c] >= 0.0f, "row %u", i);
        }
    }
    made.count = ROWS - TRAPPED;
    CHECK_NEAR(error_most(&made, light), 0.0, 0.01, "%d passes", passes);
    free(light);
    corridor_free(&made);
}

static void some_bounces_are_so_many(void)
{
    enum { BOUNCES = 5 };
    corridor made = corridor_make(ROWS, 30, 0.9f);
    int passes;
    lmb_rgb *light = corridor_sum(&made, BOUNCES, 1, &passes);
    CHECK(passes == BOUNCES, "%d passes", passes);
    double now[ROWS] = {0.0}, next[ROWS];
    for (int bounce = 0; bounce <= BOUNCES; ++bounce) {
        for (uint32_t i = 0; i < ROWS; ++i) {
            next[i] = (double)made.direct[i].c[0];
            for (size_t k = made.first[i]; k < made.first[i + 1]; ++k) {
                const lmb_link *link = &made.links[k];
                next[i] += link->weight[0] / 65535.0 / (double)made.samples[i] * now[link->target];
            }
        }
        memcpy(now, next, sizeof now);
    }
    for (uint32_t i = 0; i < ROWS; ++i) {
        CHECK_NEAR(light[i].c[0], now[i], 1e-5, "row %u", i);
    }
    free(light);
    corridor_free(&made);
}

static void threads_sum_the_same(void)
{
    corridor made = corridor_make(40000, 500, 0.95f);
    int passes[3];
    lmb_rgb *one = corridor_sum(&made, -1, 1, &passes[0]);
    static const int threads[] = {2, 7};
    for (int i = 0; i < 2; ++i) {
        lmb_rgb *light = corridor_sum(&made, -1, threads[i], &passes[1 + i]);
        CHECK(passes[1 + i] == passes[0], "%d threads: %d passes", threads[i], passes[1 + i]);
        CHECK(memcmp(light, one, made.count * sizeof *light) == 0, "%d threads", threads[i]);
        free(light);
    }
    free(one);
    corridor_free(&made);
}

static const test_case cases[] = {
    {"all_bounces_solve_the_system", all_bounces_solve_the_system},
    {"rows_that_give_no_light_take_it", rows_that_give_no_light_take_it},
    {"trapped_light_harms_nobody_else", trapped_light_harms_nobody_else},
    {"some_bounces_are_so_many", some_bounces_are_so_many},
    {"threads_sum_the_same", threads_sum_the_same},
};

TEST_MAIN(cases)
