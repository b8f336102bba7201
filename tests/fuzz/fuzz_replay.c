/* Runs a fuzz target without libFuzzer:
 *
 *     fuzz_NAME [--mutations N] [FILE|FOLDER...]     its seeds, N changed ones, then the files
 *     fuzz_NAME --write FOLDER                       its seeds as files, for libFuzzer to begin with
 */
#define _POSIX_C_SOURCE 200809L
#include "fuzz.h"

#include <dirent.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

enum { MOST_SEEDS = 64, MOST_CHANGES = 6, MOST_GROWTH = 64 };

typedef struct bytes {
    uint8_t *data;
    size_t size;
} bytes;

static bytes seeds[MOST_SEEDS];
static size_t seed_count;
static unsigned long inputs_run;

void fuzz_seed(const void *data, size_t size)
{
    uint8_t *const copy = malloc(size + 1);
    FUZZ_CHECK(copy && seed_count < MOST_SEEDS, "%zu seeds", seed_count);
    if (size > 0) {
        memcpy(copy, data, size);
    }
    seeds[seed_count++] = (bytes){copy, size};
}

static bytes file_read(const char *path)
{
    FILE *const file = fopen(path, "rb");
    FUZZ_CHECK(file && fseek(file, 0, SEEK_END) == 0, "%s cannot be read", path);
    const long size = ftell(file);
    rewind(file);
    bytes read = {malloc((size_t)size + 1), (size_t)size};
    FUZZ_CHECK(read.data && fread(read.data, 1, read.size, file) == read.size, "%s cannot be read", path);
    fclose(file);
    return read;
}

void fuzz_seed_file(const char *path)
{
    const bytes read = file_read(path);
    fuzz_seed(read.data, read.size);
    free(read.data);
}

/* The input in memory of just its size, so that a sanitizer sees what reads beyond. */
static void input_run(const uint8_t *data, size_t size)
{
    uint8_t *const exact = malloc(size > 0 ? size : 1);
    FUZZ_CHECK(exact, "%zu bytes", size);
    memcpy(exact, data, size);
    LLVMFuzzerTestOneInput(exact, size);
    free(exact);
    ++inputs_run;
}

static uint64_t random_state = 1;

/* 0 .. limit - 1; SplitMix64 (Steele, Lea, Flood 2014). */
static size_t random_below(size_t limit)
{
    uint64_t z = random_state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (size_t)((z ^ z >> 31) % limit);
}

/* Numbers at which sizes and counts turn. */
static void number_set(bytes *input, size_t at)
{
    static const uint64_t numbers[] = {0,          1,          0x7f,       0x80,       0xff,          0x7fff,
                                       0x8000,     0xffff,     0x7fffffff, 0x80000000, 0xffffffff,    0xfffffffe,
                                       0x7f800000, 0x7fc00000, 0x10000000, 0x40000000, UINT64_MAX / 2};
    static const size_t widths[] = {1, 2, 4, 8};
    const uint64_t number = numbers[random_below(sizeof numbers / sizeof numbers[0])];
    const size_t width = widths[random_below(4)];
    for (size_t i = 0; i < width && at + i < input->size; ++i) {
        input->data[at + i] = (uint8_t)(number >> 8 * i);
    }
}

/* One change; `input` has room for MOST_GROWTH bytes more each time. */
static void input_change(bytes *input)
{
    static const uint8_t likely[] = "0123456789-.,:[]{}\"eE+";
    const size_t at = random_below(input->size), left = input->size - at;
    const size_t length = 1 + random_below(left < MOST_GROWTH ? left : MOST_GROWTH);
    switch (random_below(7)) {
    case 0:
        input->data[at] ^= (uint8_t)(1u << random_below(8));
        break;
    case 1:
        input->data[at] = (uint8_t)random_below(256);
        break;
    case 2:
        input->data[at] = likely[random_below(sizeof likely - 1)];
        break;
    case 3:
        number_set(input, at);
        break;
    case 4: /* taken out */
        memmove(input->data + at, input->data + at + length, left - length);
        input->size -= length;
        break;
    case 5: /* doubled */
        memmove(input->data + at + length, input->data + at, left);
        input->size += length;
        break;
    default: /* from elsewhere */
        memmove(input->data + at, input->data + random_below(input->size - length + 1), length);
    }
}

static void mutations_run(size_t count)
{
    for (size_t i = 0; i < count && seed_count > 0; ++i) {
        const bytes *const seed = &seeds[i % seed_count];
        bytes input = {malloc(seed->size + MOST_CHANGES * MOST_GROWTH + 1), seed->size};
        FUZZ_CHECK(input.data, "%zu bytes", seed->size);
        memcpy(input.data, seed->data, seed->size);
        for (size_t change = 1 + random_below(MOST_CHANGES); change > 0 && input.size > 0; --change) {
            input_change(&input);
        }
        if (random_below(16) == 0) {
            input.size = random_below(input.size + 1);
        }
        input_run(input.data, input.size);
        free(input.data);
    }
}

static void path_run(const char *path)
{
    DIR *const folder = opendir(path);
    if (!folder) {
        const bytes read = file_read(path);
        input_run(read.data, read.size);
        free(read.data);
        return;
    }
    for (const struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
        char inner[4096];
        snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name);
        if (entry->d_name[0] != '.') {
            path_run(inner);
        }
    }
    closedir(folder);
}

static int seeds_write(const char *folder)
{
    mkdir(folder, 0777);
    for (size_t i = 0; i < seed_count; ++i) {
        char path[4096];
        snprintf(path, sizeof path, "%s/seed_%02zu", folder, i);
        FILE *const file = fopen(path, "wb");
        if (!file || fwrite(seeds[i].data, 1, seeds[i].size, file) != seeds[i].size || fclose(file) != 0) {
            fprintf(stderr, "%s cannot be written\n", path);
            return 1;
        }
    }
    return 0;
}

/* A small input that wants gigabytes gets none, and the machine is not dragged down. Sanitizers reserve more. */
static void memory_limit(void)
{
#ifndef LMB_SANITIZED
    const struct rlimit limit = {(rlim_t)1 << 29, (rlim_t)1 << 29};
    setrlimit(RLIMIT_AS, &limit);
#endif
}

int main(int count, char **values)
{
    memory_limit();
    fuzz_seeds();
    int status = 0, at = 1;
    if (count == 3 && strcmp(values[1], "--write") == 0) {
        status = seeds_write(values[2]);
        at = count;
    } else {
        for (size_t i = 0; i < seed_count; ++i) {
            input_run(seeds[i].data, seeds[i].size);
        }
    }
    if (at + 1 < count && strcmp(values[at], "--mutations") == 0) {
        mutations_run(strtoul(values[at + 1], NULL, 10));
        at += 2;
    }
    for (; at < count; ++at) {
        path_run(values[at]);
    }
    for (size_t i = 0; i < seed_count; ++i) {
        free(seeds[i].data);
    }
    printf("%zu seeds, %lu inputs\n", seed_count, inputs_run);
    return status;
}
