#include "gltf/gltf_container.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static uint32_t read_u32(const unsigned char *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

lmb_result lmb_gltf_container_split(const char *path, lmb_gltf_bytes file, lmb_gltf_bytes *json, lmb_gltf_bytes *bin,
                                    lmb_error *error)
{
    *json = (lmb_gltf_bytes){file.data, file.size, NULL};
    *bin = (lmb_gltf_bytes){NULL, 0, NULL};
    if (file.size < 4 || memcmp(file.data, "glTF", 4) != 0) {
        return LMB_OK;
    }
    if (file.size < 20) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: GLB header: the file ends after %zu bytes", path, file.size);
    }
    if (read_u32(file.data + 4) != 2) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: GLB header: version %u, not 2", path,
                             read_u32(file.data + 4));
    }
    const size_t length = read_u32(file.data + 8);
    if (length > file.size || length < 20) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: GLB header: says %zu bytes, the file has %zu", path, length,
                             file.size);
    }
    size_t offset = 12;
    for (unsigned chunk = 0; length - offset >= 8; ++chunk) {
        const size_t size = read_u32(file.data + offset);
        const unsigned char *const type = file.data + offset + 4;
        if (size > length - offset - 8) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: GLB chunk %u: says %zu bytes, %zu are left", path, chunk,
                                 size, length - offset - 8);
        }
        const unsigned char *const contents = file.data + offset + 8;
        if (chunk == 0) {
            if (memcmp(type, "JSON", 4) != 0) {
                return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: GLB chunk 0: not JSON", path);
            }
            *json = (lmb_gltf_bytes){contents, size, NULL};
        } else if (chunk == 1 && memcmp(type, "BIN\0", 4) == 0) {
            *bin = (lmb_gltf_bytes){contents, size, NULL};
        }
        offset += 8 + size;
    }
    if (offset != length) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: GLB: %zu bytes after the last chunk", path, length - offset);
    }
    return LMB_OK;
}

static void put_u32(unsigned char *to, size_t value)
{
    for (int i = 0; i < 4; ++i) {
        to[i] = (unsigned char)(value >> 8 * i);
    }
}

/* The header and the contents of a chunk; what pads it is there. */
static void put_chunk(unsigned char *to, const char type[4], size_t padded_size, lmb_gltf_bytes contents)
{
    put_u32(to, padded_size);
    memcpy(to + 4, type, 4);
    memcpy(to + 8, contents.data, contents.size);
}

unsigned char *lmb_gltf_container_join(const char *json, lmb_gltf_bytes bin, size_t *size)
{
    const lmb_gltf_bytes text = {(const unsigned char *)json, strlen(json), NULL};
    const size_t json_padded = (text.size + 3) / 4 * 4, bin_padded = (bin.size + 3) / 4 * 4;
    const size_t total = 12 + 8 + json_padded + (bin.size ? 8 + bin_padded : 0);
    unsigned char *const glb = total <= LMB_GLTF_MAX_SIZE ? calloc(total, 1) : NULL;
    if (!glb) {
        return NULL;
    }
    memcpy(glb, "glTF", 4);
    put_u32(glb + 4, 2);
    put_u32(glb + 8, total);
    memset(glb + 20, ' ', json_padded);
    put_chunk(glb + 12, "JSON", json_padded, text);
    if (bin.size > 0) {
        put_chunk(glb + 20 + json_padded, "BIN\0", bin_padded, bin);
    }
    *size = total;
    return glb;
}
