/* Makes one allocation of a program fail. Link allocation_fail.c and allocation_fail.cc with the options of
 * lmb_allocation_test (CMakeLists.txt). */
#ifndef LMB_TESTS_ALLOCATION_FAIL_H
#define LMB_TESTS_ALLOCATION_FAIL_H

#include <limits.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* From here on so many allocations succeed, of all threads together; then one fails. -1: none does, and none counts. */
void allocation_fail_after(long count);

/* How many were asked for since the last count that was not -1. */
long allocation_count(void);

/* Whether C++'s `new` takes part, which it does not at first. */
void allocation_fail_new(bool takes_part);

/* Counts one. */
bool allocation_fails_now(void);
bool allocation_new_fails_now(void);

#ifdef __cplusplus
}
#endif

#endif
