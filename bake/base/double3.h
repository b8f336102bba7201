/* Vectors in double, where a difference of floats or a sign must be exact. */
#ifndef LMB_DOUBLE3_H
#define LMB_DOUBLE3_H

#include <lambent/types.h>

typedef struct double3 {
    double x, y, z;
} double3;

static inline double3 double3_between(double3 from, double3 to)
{
    return (double3){to.x - from.x, to.y - from.y, to.z - from.z};
}

static inline double3 double3_of(lmb_vec3 v)
{
    return (double3){(double)v.x, (double)v.y, (double)v.z};
}

static inline double3 double3_cross(double3 a, double3 b)
{
    return (double3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double double3_dot(double3 a, double3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

#endif
