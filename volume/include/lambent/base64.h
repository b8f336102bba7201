/* Bytes as text: base64 of RFC 4648, section 4. */
#ifndef LAMBENT_BASE64_H
#define LAMBENT_BASE64_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Characters of so many bytes, with padding and without a NUL. */
size_t lmb_base64_length(size_t size);

/* Writes lmb_base64_length(size) characters and a NUL. */
void lmb_base64_encode(const void *data, size_t size, char *text);

/* Reads a text up to its NUL; padding may be missing. `bytes` has room for 3/4 of its length. `*size` is how many there
 * are. @return false on any other character; then `bytes` may hold anything */
bool lmb_base64_decode(const char *text, unsigned char *bytes, size_t *size);

#ifdef __cplusplus
}
#endif

#endif
