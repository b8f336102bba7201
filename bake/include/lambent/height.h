/* Height maps: pictures whose grey is a height. Row 0 is the top. */
#ifndef LAMBENT_HEIGHT_H
#define LAMBENT_HEIGHT_H

#include <stdint.h>

#include <lambent/error.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_height_map {
    int32_t width;
    int32_t height;
    float *value; /* [x + width y], 0 black to 1 white, malloc'ed */
} lmb_height_map;

/* Reads a PNG of 8 or 16 bits, grey or in colours, whose luma counts; alpha does not.
 * @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED (too many pixels), _MEMORY */
lmb_result lmb_height_map_read(const char *path, lmb_height_map *map, lmb_error *error);

/* Frees the heights; the struct may then be reused. */
void lmb_height_map_free(lmb_height_map *map);

#ifdef __cplusplus
}
#endif

#endif
