/* Loops over arrays that the compiler turns into vector code. */
#ifndef LMB_VECTORISED_H
#define LMB_VECTORISED_H

/* Marks a function that is compiled once for every machine and once for those with AVX2; the right one is chosen when
 * the program starts. Results are the same bit by bit: each number of each array goes through the same IEEE operations,
 * without fused ones, however many go at once. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&               \
    !defined(__SANITIZE_THREAD__)
#define LMB_VECTORISED __attribute__((target_clones("avx2", "default")))
#else
#define LMB_VECTORISED
#endif

#endif
