#include "volume_internal.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

/* Far beyond what CreateFileW takes without the \\?\ prefix, and small enough for any stack. */
enum { PATH_CAPACITY = 2048 };

static lmb_result map_open_file(HANDLE file, void **mapping, size_t *size)
{
    LARGE_INTEGER bytes;
    if (GetFileType(file) != FILE_TYPE_DISK || !GetFileSizeEx(file, &bytes) || (uint64_t)bytes.QuadPart > SIZE_MAX) {
        return LMB_ERROR_IO;
    }
    if (bytes.QuadPart == 0) {
        return LMB_ERROR_TRUNCATED;
    }
    const HANDLE section = CreateFileMappingW(file, NULL, PAGE_READONLY, 0, 0, NULL);
    if (!section) {
        return LMB_ERROR_IO;
    }
    void *const view = MapViewOfFile(section, FILE_MAP_READ, 0, 0, 0);
    CloseHandle(section); /* the view keeps it */
    if (!view) {
        return LMB_ERROR_IO;
    }
    *mapping = view;
    *size = (size_t)bytes.QuadPart;
    return LMB_OK;
}

lmb_result lmb_volume_map(const char *path, void **mapping, size_t *size)
{
    wchar_t wide_path[PATH_CAPACITY];
    if (MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide_path, PATH_CAPACITY) == 0) {
        return LMB_ERROR_IO;
    }
    /* FILE_SHARE_DELETE: another program may rename a new file over this one, as on POSIX. */
    const HANDLE file = CreateFileW(wide_path, GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_DELETE, NULL, OPEN_EXISTING,
                                    FILE_ATTRIBUTE_NORMAL, NULL);
    if (file == INVALID_HANDLE_VALUE) {
        return LMB_ERROR_IO;
    }
    const lmb_result result = map_open_file(file, mapping, size);
    CloseHandle(file);
    return result;
}

void lmb_volume_unmap(void *mapping, size_t size)
{
    (void)size;
    UnmapViewOfFile(mapping);
}
