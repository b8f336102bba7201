#include <lambent/result.h>

const char *lmb_result_text(lmb_result result)
{
    switch (result) {
    case LMB_OK:
        return "done";
    case LMB_ERROR_ARGUMENT:
        return "invalid argument";
    case LMB_ERROR_MEMORY:
        return "out of memory";
    case LMB_ERROR_IO:
        return "cannot be read";
    case LMB_ERROR_WRITE:
        return "cannot be written";
    case LMB_ERROR_FORMAT:
        return "not a valid file of this kind";
    case LMB_ERROR_TRUNCATED:
        return "file is truncated";
    case LMB_ERROR_VERSION:
        return "written by a newer version";
    case LMB_ERROR_CHECKSUM:
        return "checksum does not match";
    case LMB_ERROR_UNSUPPORTED:
        return "not supported";
    case LMB_ERROR_INTERRUPTED:
        return "interrupted";
    }
    return "unknown result";
}
