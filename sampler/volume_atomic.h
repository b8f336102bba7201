/* What threads share that open tiles and sample: C11's atomics, and the same of MSVC, which has none of these. */
#ifndef LMB_VOLUME_ATOMIC_H
#define LMB_VOLUME_ATOMIC_H

#include <stdbool.h>
#include <stdint.h>

#if defined(_MSC_VER) && !defined(__clang__)

#include <intrin.h>

typedef void *volatile lmb_atomic_pointer;
typedef volatile long lmb_atomic_count;

static inline void *lmb_atomic_load(const lmb_atomic_pointer *from)
{
    void *const value = *from;
#if defined(_M_ARM64)
    __dmb(_ARM64_BARRIER_ISH);
#else
    _ReadWriteBarrier();
#endif
    return value;
}

static inline void *lmb_atomic_exchange(lmb_atomic_pointer *at, void *value)
{
    return _InterlockedExchangePointer(at, value);
}

static inline uint32_t lmb_atomic_add(lmb_atomic_count *to, uint32_t count)
{
    return (uint32_t)_InterlockedExchangeAdd(to, (long)count);
}

static inline uint32_t lmb_atomic_read(lmb_atomic_count *from)
{
    return lmb_atomic_add(from, 0);
}

static inline bool lmb_atomic_replace(lmb_atomic_count *at, uint32_t expected, uint32_t value)
{
    return _InterlockedCompareExchange(at, (long)value, (long)expected) == (long)expected;
}

#else

#include <stdatomic.h>

typedef _Atomic(void *) lmb_atomic_pointer;
typedef _Atomic(uint32_t) lmb_atomic_count;

/* What the thread has written that stored the pointer is seen from here on. */
static inline void *lmb_atomic_load(const lmb_atomic_pointer *from)
{
    return atomic_load_explicit(from, memory_order_acquire);
}

/* The former pointer. */
static inline void *lmb_atomic_exchange(lmb_atomic_pointer *at, void *value)
{
    return atomic_exchange(at, value);
}

/* The former count. */
static inline uint32_t lmb_atomic_add(lmb_atomic_count *to, uint32_t count)
{
    return atomic_fetch_add(to, count);
}

static inline uint32_t lmb_atomic_read(lmb_atomic_count *from)
{
    return atomic_load(from);
}

/* @return false: it was not what was expected, and stays */
static inline bool lmb_atomic_replace(lmb_atomic_count *at, uint32_t expected, uint32_t value)
{
    return atomic_compare_exchange_strong(at, &expected, value);
}

#endif

#endif
