#include "base/stored.h"

#include <stdlib.h>
#include <string.h>

lmb_stored lmb_stored_of(unsigned char *data, size_t size)
{
    return (lmb_stored){.reads = true, .data = data, .size = size};
}

void lmb_stored_free(lmb_stored *stored)
{
    if (!stored->reads) {
        free(stored->data);
    }
    *stored = (lmb_stored){.result = LMB_OK};
}

static void fail(lmb_stored *stored, lmb_result result)
{
    stored->result = stored->result == LMB_OK ? result : stored->result;
}

static bool room_make(lmb_stored *stored, size_t size)
{
    if (size > stored->room - stored->size) {
        const size_t room = 2 * (stored->room + size) + 4096;
        unsigned char *const data = realloc(stored->data, room);
        if (!data) {
            fail(stored, LMB_ERROR_MEMORY);
            return false;
        }
        stored->data = data;
        stored->room = room;
    }
    return true;
}

/* Whether so many values are left to be read. */
static bool is_left(lmb_stored *stored, size_t count, size_t size)
{
    if (stored->result == LMB_OK && (size == 0 || count <= (stored->size - stored->at) / size)) {
        return true;
    }
    fail(stored, LMB_ERROR_TRUNCATED);
    return false;
}

static void bytes_write(lmb_stored *stored, const void *bytes, size_t size)
{
    if (size > 0 && stored->result == LMB_OK && room_make(stored, size)) {
        memcpy(stored->data + stored->size, bytes, size);
        stored->size += size;
    }
}

static void bytes_read(lmb_stored *stored, void *bytes, size_t size)
{
    if (size > 0) {
        memcpy(bytes, stored->data + stored->at, size);
        stored->at += size;
    }
}

void lmb_stored_value(lmb_stored *stored, void *value, size_t size)
{
    if (!stored->reads) {
        bytes_write(stored, value, size);
    } else if (is_left(stored, 1, size)) {
        bytes_read(stored, value, size);
    } else {
        memset(value, 0, size);
    }
}

void *lmb_stored_array(lmb_stored *stored, void *values, size_t count, size_t size)
{
    if (!stored->reads) {
        bytes_write(stored, values, count * size);
        return values;
    }
    if (!is_left(stored, count, size)) {
        return NULL;
    }
    void *const read = malloc((count + 1) * size);
    if (!read) {
        fail(stored, LMB_ERROR_MEMORY);
        return NULL;
    }
    bytes_read(stored, read, count * size);
    return read;
}

bool lmb_stored_expect(lmb_stored *stored, bool holds)
{
    if (!holds) {
        fail(stored, LMB_ERROR_FORMAT);
    }
    return stored->result == LMB_OK;
}
