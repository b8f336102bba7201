#include "allocation_fail.h"

#include <stdatomic.h>
#include <stddef.h>

static atomic_long asked, failing = -1;

void allocation_fail_after(long count)
{
    if (count >= 0) {
        atomic_store(&asked, 0);
    }
    atomic_store(&failing, count);
}

long allocation_count(void)
{
    return atomic_load(&asked);
}

bool allocation_fails_now(void)
{
    const long at = atomic_load(&failing);
    return at >= 0 && atomic_fetch_add(&asked, 1) == at;
}

static bool new_takes_part;

void allocation_fail_new(bool takes_part)
{
    new_takes_part = takes_part;
}

bool allocation_new_fails_now(void)
{
    return new_takes_part && allocation_fails_now();
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

void *__wrap_malloc(size_t size)
{
    return allocation_fails_now() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return allocation_fails_now() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *block, size_t size)
{
    return allocation_fails_now() ? NULL : __real_realloc(block, size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return allocation_fails_now() ? NULL : __real_aligned_alloc(alignment, size);
}
