/* Files whose header has their length and a checksum, as .lmb and .lmt have: bytes as they come hardly get past it. */
#ifndef LMB_TESTS_FUZZ_SEALED_H
#define LMB_TESTS_FUZZ_SEALED_H

#include <string.h>

#include <lambent/tiles_format.h>
#include <lambent/volume_format.h>

#include "fuzz.h"

_Static_assert(offsetof(lmb_tiles_header, file_bytes) == offsetof(lmb_volume_header, file_bytes), "other headers");
_Static_assert(offsetof(lmb_tiles_header, checksum) == offsetof(lmb_volume_header, checksum), "other headers");

/* Opens a copy of the input, aligned and of just its size, as it is and then with length and checksum put right. */
static inline void fuzz_sealed(const uint8_t *data, size_t size, void (*bytes_open)(const unsigned char *, size_t))
{
    unsigned char *const copy = calloc(size > 0 ? size : 1, 1);
    FUZZ_CHECK(copy, "%zu bytes", size);
    if (size > 0) {
        memcpy(copy, data, size);
    }
    bytes_open(copy, size);
    if (size >= offsetof(lmb_volume_header, checksum) + sizeof(uint64_t)) {
        const uint64_t bytes = size;
        memcpy(copy + offsetof(lmb_volume_header, file_bytes), &bytes, sizeof bytes);
        const uint64_t checksum = lmb_volume_hash(copy + LMB_VOLUME_CHECKSUM_START, size - LMB_VOLUME_CHECKSUM_START);
        memcpy(copy + offsetof(lmb_volume_header, checksum), &checksum, sizeof checksum);
        bytes_open(copy, size);
    }
    free(copy);
}

#endif
