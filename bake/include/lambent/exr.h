/* OpenEXR files of named channels: lightmaps and pictures of floats. */
#ifndef LAMBENT_EXR_H
#define LAMBENT_EXR_H

#include <stddef.h>
#include <stdint.h>

#include <lambent/error.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One named channel of an EXR: width x height floats, tightly packed. */
typedef struct lmb_exr_channel {
    const char *name; /* channels are stored sorted by name, as the format asks */
    const float *values;
} lmb_exr_channel;

/* A text or number attribute of an EXR's header. `text` NULL means a float attribute. */
typedef struct lmb_exr_attribute {
    const char *name;
    const char *text;
    float number;
} lmb_exr_attribute;

typedef struct lmb_exr_picture {
    int32_t width, height;
    const lmb_exr_channel *channels;
    size_t channel_count;
    const lmb_exr_attribute *attributes;
    size_t attribute_count;
} lmb_exr_picture;

/* Half-float scanline EXR, ZIP compressed, written beside and renamed; equal input gives equal bytes. Values beyond
 * fp16 are the caller's business (scale first): they are clamped to +-65504 here and counted in `*overflow_count`
 * (may be NULL); NaN is LMB_ERROR_ARGUMENT. @return LMB_ERROR_WRITE, _MEMORY, _ARGUMENT */
lmb_result lmb_exr_write(const char *path, const lmb_exr_picture *picture, size_t *overflow_count, lmb_error *error);

/* What is read beside the channels. */
typedef struct lmb_exr_header {
    int32_t width, height;
    float scale; /* the float attribute "lambent:scale", or 1 */
} lmb_exr_header;

/* The names of an EXR's channels, sorted; `*count` gets how many there are, of which `most` at most are given. */
enum { LMB_EXR_NAME_SIZE = 32 };
typedef struct lmb_exr_name {
    char text[LMB_EXR_NAME_SIZE]; /* longer ones are cut off */
} lmb_exr_name;
lmb_result lmb_exr_list_channels(const char *path, lmb_exr_name *names, size_t most, size_t *count, lmb_error *error);

/* Reads named channels of an EXR of ours back: values[i] gets width x height malloc'ed floats of channel names[i].
 * @return as lmb_image_read, and LMB_ERROR_FORMAT when a channel is missing */
lmb_result lmb_exr_read_channels(const char *path, const char *const *names, size_t count, float **values,
                                 lmb_exr_header *header, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
