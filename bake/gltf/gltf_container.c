#include "gltf/gltf_container.h"

#include <stdint.h>
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
