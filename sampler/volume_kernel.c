#include "volume_kernel.h"

#if defined(_MSC_VER) && defined(_M_X64)
#include <intrin.h>
#elif defined(__GNUC__) && defined(__x86_64__)
#include <cpuid.h>
#endif

/* Of the third register of leaf 1. */
#define HAS_F16C (1u << 29)

/* Of leaf 7's second register. */
enum { AVX2 = 1 << 5, AVX512F = 1 << 16, AVX512DQ = 1 << 17 };
#define HAS_AVX512VL (1u << 31)

typedef struct processor {
    bool has_avx2_and_f16c, has_avx512;
} processor;

static processor processor_ask(void)
{
#if defined(_MSC_VER) && defined(_M_X64)
    enum { OSXSAVE = 1 << 27, AVX = 1 << 28, YMM_SAVED = 0x06, ZMM_SAVED = 0xe6 };
    processor found = {false, false};
    int leaf[4];
    __cpuid(leaf, 0);
    if (leaf[0] < 7) {
        return found;
    }
    __cpuid(leaf, 1);
    const unsigned features = (unsigned)leaf[2];
    if (!(features & OSXSAVE) || !(features & AVX) || !(features & HAS_F16C)) {
        return found;
    }
    __cpuidex(leaf, 7, 0);
    const unsigned more = (unsigned)leaf[1];
    const uint64_t saved = _xgetbv(0);
    found.has_avx2_and_f16c = (more & AVX2) && (saved & YMM_SAVED) == YMM_SAVED;
    found.has_avx512 = found.has_avx2_and_f16c && (more & AVX512F) && (more & AVX512DQ) && (more & HAS_AVX512VL) &&
                       (saved & ZMM_SAVED) == ZMM_SAVED;
    return found;
#elif defined(__GNUC__) && defined(__x86_64__)
    unsigned a, b, features, d;
    processor found;
    /* The first asks the system too, whether it saves the registers; not every compiler's knows F16C. */
    found.has_avx2_and_f16c =
        __builtin_cpu_supports("avx2") && __get_cpuid(1, &a, &b, &features, &d) && (features & HAS_F16C) != 0;
    found.has_avx512 = found.has_avx2_and_f16c && __builtin_cpu_supports("avx512f") &&
                       __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
    return found;
#else
    return (processor){false, false};
#endif
}

const lmb_volume_kernel *lmb_volume_kernel_choose(void)
{
    if (lmb_volume_kernel_neon) {
        return lmb_volume_kernel_neon;
    }
    const processor found = processor_ask();
    if (lmb_volume_kernel_avx512 && found.has_avx512) {
        return lmb_volume_kernel_avx512;
    }
    return lmb_volume_kernel_avx2 && found.has_avx2_and_f16c ? lmb_volume_kernel_avx2 : &lmb_volume_kernel_scalar;
}
