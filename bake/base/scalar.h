/* Numbers that the baker's files share. */
#ifndef LMB_SCALAR_H
#define LMB_SCALAR_H

#define LMB_PI 3.14159265358979323846
#define LMB_PI_F 3.14159265358979323846f

/* The larger and the smaller of two numbers: single instructions, which fmaxf and fminf with their rules for NaN are
 * not. */
static inline float float_larger(float a, float b)
{
    return a > b ? a : b;
}

static inline float float_smaller(float a, float b)
{
    return a < b ? a : b;
}

#endif
