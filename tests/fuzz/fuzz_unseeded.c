/* libFuzzer takes its seeds from files, which fuzz_<name> --write makes. */
#include "fuzz.h"

void fuzz_seed(const void *data, size_t size)
{
    (void)data;
    (void)size;
}

void fuzz_seed_file(const char *path)
{
    (void)path;
}
