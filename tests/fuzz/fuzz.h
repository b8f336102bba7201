/* A fuzz target is one file, fuzz_<name>.c, that defines the two functions below. It is linked twice: with libFuzzer,
 * which looks for inputs (preset `fuzz`, tools/fuzz), and with fuzz_replay.c, which runs the target's own seeds, some
 * thousand mutations of them and the inputs that were found (tests/fuzz/corpus/<name>), in every build.
 *
 * A target aborts where what came out of an input is not sound; sanitizers see the rest. */
#ifndef LMB_TESTS_FUZZ_H
#define LMB_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* Runs one input, whatever its bytes are. @return 0, or -1: not worth keeping */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Calls fuzz_seed with each good input, made by code. */
void fuzz_seeds(void);

/* By whoever runs the target. */
void fuzz_seed(const void *data, size_t size);
/* The same of the contents of a file. */
void fuzz_seed_file(const char *path);

/* Ends the program where `condition` does not hold. */
#define FUZZ_CHECK(condition, ...)                                                                                     \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: %s: ", __FILE__, __LINE__, #condition);                                            \
            fprintf(stderr, __VA_ARGS__);                                                                              \
            fputc('\n', stderr);                                                                                       \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

#endif
