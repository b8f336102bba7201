/* A test program is a table of cases. A check that fails prints where and with which values, and the others go on;
 * the exit status is 1 when any failed. A case that cannot run here (no test data) says so with `test_skip`; a program
 * in which every case skipped exits with 77, which CTest shows as skipped. */
#ifndef LMB_TESTS_HARNESS_H
#define LMB_TESTS_HARNESS_H

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

typedef struct test_case {
    const char *name;
    void (*run)(void);
} test_case;

static int test_failures;
static const char *test_skip_reason;

#define CHECK(condition, ...)                                                                                          \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            ++test_failures;                                                                                           \
            fprintf(stderr, "%s:%d: failed: %s: ", __FILE__, __LINE__, #condition);                                    \
            fprintf(stderr, __VA_ARGS__);                                                                              \
            fputc('\n', stderr);                                                                                       \
        }                                                                                                              \
    } while (0)

/* |actual - expected| <= tolerance, and neither is NaN; the message names the inputs. */
#define CHECK_NEAR(actual, expected, tolerance, ...)                                                                   \
    do {                                                                                                               \
        const double near_actual = (double)(actual);                                                                   \
        const double near_expected = (double)(expected);                                                               \
        if (!(fabs(near_actual - near_expected) <= (double)(tolerance))) {                                             \
            ++test_failures;                                                                                           \
            fprintf(stderr, "%s:%d: %s is %.9g, expected %.9g +- %.3g: ", __FILE__, __LINE__, #actual, near_actual,    \
                    near_expected, (double)(tolerance));                                                               \
            fprintf(stderr, __VA_ARGS__);                                                                              \
            fputc('\n', stderr);                                                                                       \
        }                                                                                                              \
    } while (0)

static inline void test_skip(const char *reason)
{
    test_skip_reason = reason;
}

static inline int test_main(const test_case *cases, size_t count)
{
    int failed = 0;
    size_t skipped = 0;
    for (size_t i = 0; i < count; ++i) {
        test_failures = 0;
        test_skip_reason = NULL;
        cases[i].run();
        if (test_failures > 0) {
            ++failed;
            printf("FAIL %s (%d checks)\n", cases[i].name, test_failures);
        } else if (test_skip_reason) {
            ++skipped;
            printf("skip %s: %s\n", cases[i].name, test_skip_reason);
        } else {
            printf("ok   %s\n", cases[i].name);
        }
        fflush(stdout);
    }
    return failed > 0 ? 1 : skipped == count ? 77 : 0;
}

#define TEST_MAIN(cases)                                                                                               \
    int main(void)                                                                                                     \
    {                                                                                                                  \
        return test_main(cases, sizeof(cases) / sizeof(cases)[0]);                                                     \
    }

#endif
