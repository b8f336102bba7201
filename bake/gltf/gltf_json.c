#include "gltf/gltf_json.h"

#include <stdarg.h>
#include <stdio.h>

void lmb_gltf_where(char where[LMB_GLTF_WHERE_SIZE], const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(where, LMB_GLTF_WHERE_SIZE, format, arguments);
    va_end(arguments);
}

uint32_t lmb_gltf_uint(const cJSON *object, const char *name, uint32_t missing)
{
    const cJSON *const item = cJSON_GetObjectItemCaseSensitive(object, name);
    return cJSON_IsNumber(item) ? (uint32_t)item->valuedouble : missing;
}

cJSON *lmb_gltf_extension(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(object, "extensions"), name);
}
