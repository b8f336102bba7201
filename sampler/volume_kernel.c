#include "volume_kernel.h"

#if defined(_MSC_VER) && defined(_M_X64)
#include <intrin.h>
#elif defined(__GNUC__) && defined(__x86_64__)
#include <cpuid.h>
#endif

/* Bit of the third register of leaf 1. */
#define HAS_F16C (1u << 29)

static bool processor_has_avx2_and_f16c(void)
{
#if defined(_MSC_VER) && defined(_M_X64)
    enum { OSXSAVE = 1 << 27, AVX = 1 << 28, AVX2 = 1 << 5, YMM_SAVED = 6 };
    int leaf[4];
    __cpuid(leaf, 0);
    if (leaf[0] < 7) {
        return false;
    }
    __cpuid(leaf, 1);
    const unsigned features = (unsigned)leaf[2];
    const bool has = (features & OSXSAVE) && (features & AVX) && (features & HAS_F16C);
    __cpuidex(leaf, 7, 0);
    return has && (leaf[1] & AVX2) && (_xgetbv(0) & YMM_SAVED) == YMM_SAVED;
#elif defined(__GNUC__) && defined(__x86_64__)
    unsigned a, b, features, d;
    /* The first asks the system too, whether it saves the registers; not every compiler's knows F16C. */
    return __builtin_cpu_supports("avx2") && __get_cpuid(1, &a, &b, &features, &d) && (features & HAS_F16C) != 0;
#else
    return false;
#endif
}

const lmb_volume_kernel *lmb_volume_kernel_choose(void)
{
    return lmb_volume_kernel_avx2 && processor_has_avx2_and_f16c() ? lmb_volume_kernel_avx2 : &lmb_volume_kernel_scalar;
}
