/* What is decoded, and how large a picture may be. */
#ifndef LMB_IMAGE_BYTES_H
#define LMB_IMAGE_BYTES_H

#include <stddef.h>

/* More than any environment or lightmap has; keeps every size below in 32 bits for one channel. */
enum { LMB_IMAGE_MAX_SIDE = 1 << 16, LMB_IMAGE_MAX_PIXELS = 1 << 28 };

/* A file in memory. */
typedef struct lmb_image_bytes {
    const char *name; /* for messages */
    const unsigned char *data;
    size_t size;
} lmb_image_bytes;

#endif
