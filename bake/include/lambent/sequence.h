/* Counter-based sampling points: Owen-scrambled (0,2)-sequences, padded to any number of dimensions.
 *
 * A point is a pure function of (stream, index, dimension): no state, so the same bytes come out of any number of
 * threads. Each dimension pair is the two-dimensional Sobol sequence, its index shuffled and its digits scrambled by
 * nested uniform (Owen 1995) scrambling through hashes (Laine and Karras 2011; Burley, "Practical Hash-based Owen
 * Scrambling", JCGT 2020). The first 2^k points of every pair are a (0,2)-net; pairs are independent of each other. */
#ifndef LAMBENT_SEQUENCE_H
#define LAMBENT_SEQUENCE_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Well-mixed 64-bit hash of two numbers (a finaliser after Stafford 2011 of their combination). */
uint64_t lmb_mix(uint64_t a, uint64_t b);

/* Uniform in [0, 1), from 32 random bits: the upper 24, by way of a signed integer, which vectors can convert. */
static inline float lmb_unit_float(uint32_t bits)
{
    return (float)(int32_t)(bits >> 8) * 0x1p-24f;
}

/* Barycentric coordinates, of the second and the third corner, of a point uniform in a triangle's area, from `point` in
 * [0, 1)^2 (Osada et al. 2002, "Shape distributions"). */
static inline void lmb_triangle_point(const float point[2], float *u, float *v)
{
    const float root = sqrtf(point[0]);
    *u = root * (1.0f - point[1]);
    *v = root * point[1];
}

/* The stream of a point in space: equal positions have equal streams, whatever the order of work. */
uint64_t lmb_stream_of_position(uint64_t seed, lmb_vec3 position);

/* One point in [0, 1)^2 of dimension pair `pair`. */
void lmb_sequence_2d(uint64_t stream, uint32_t index, uint32_t pair, float point[2]);

/* Points first .. first + count - 1 of it, as two arrays: the same variates, several at a time. */
void lmb_sequence_2d_batch(uint64_t stream, uint32_t first, uint32_t count, uint32_t pair, float *x, float *y);

/* An independent uniform variate in [0, 1), for decisions whose count is not known beforehand. */
float lmb_random(uint64_t stream, uint32_t index, uint32_t dimension, uint32_t count);

#ifdef __cplusplus
}
#endif

#endif
