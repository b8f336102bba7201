#include <lambent/sequence.h>

#include <string.h>

#include "base/vectorised.h"

uint64_t lmb_mix(uint64_t a, uint64_t b)
{
    uint64_t x = a * UINT64_C(0x9e3779b97f4a7c15) + b + UINT64_C(0x632be59bd9b4e019);
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

uint64_t lmb_stream_of_position(uint64_t seed, lmb_vec3 position)
{
    /* + 0.0f makes -0 and 0 the same position. */
    const float coordinate[3] = {position.x + 0.0f, position.y + 0.0f, position.z + 0.0f};
    uint64_t stream = lmb_mix(seed, 0);
    for (int axis = 0; axis < 3; ++axis) {
        uint32_t bits;
        memcpy(&bits, &coordinate[axis], sizeof bits);
        stream = lmb_mix(stream, bits);
    }
    return stream;
}

static uint32_t bits_reverse(uint32_t x)
{
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

/* Nested uniform scrambling of bit-reversed digits: each step lets a bit depend on lower ones only, which are the more
 * significant digits. Constants from Burley 2020, listing 3. */
static uint32_t scramble_reversed(uint32_t x, uint32_t seed)
{
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

static uint32_t scramble(uint32_t x, uint32_t seed)
{
    return bits_reverse(scramble_reversed(bits_reverse(x), seed));
}

/* The second Sobol dimension's generator matrix is Pascal's triangle mod 2, a Taylor shift by one over GF(2), which
 * factors into one butterfly per index bit. The result is bit-reversed. */
static uint32_t sobol_second_reversed(uint32_t index)
{
    index ^= (index & 0xaaaaaaaau) >> 1;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xff00ff00u) >> 8;
    index ^= (index & 0xffff0000u) >> 16;
    return index;
}

LMB_VECTORISED
void lmb_sequence_2d_batch(uint64_t stream, uint32_t first, uint32_t count, uint32_t pair, float *restrict x,
                           float *restrict y)
{
    const uint32_t order = (uint32_t)lmb_mix(stream, 2 * (uint64_t)pair);
    const uint64_t digits = lmb_mix(stream, 2 * (uint64_t)pair + 1);
    const uint32_t digits_x = (uint32_t)digits;
    const uint32_t digits_y = (uint32_t)(digits >> 32);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t shuffled = scramble(first + i, order);
        /* The first Sobol dimension is the bit-reversed index. */
        x[i] = lmb_unit_float(bits_reverse(scramble_reversed(shuffled, digits_x)));
        y[i] = lmb_unit_float(bits_reverse(scramble_reversed(sobol_second_reversed(shuffled), digits_y)));
    }
}

void lmb_sequence_2d(uint64_t stream, uint32_t index, uint32_t pair, float point[2])
{
    lmb_sequence_2d_batch(stream, index, 1, pair, &point[0], &point[1]);
}

float lmb_random(uint64_t stream, uint32_t index, uint32_t dimension, uint32_t count)
{
    const uint64_t counter = ((uint64_t)dimension << 32) | count;
    return lmb_unit_float((uint32_t)(lmb_mix(lmb_mix(stream ^ UINT64_C(0x5851f42d4c957f2d), index), counter) >> 32));
}
