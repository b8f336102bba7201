/* Vectors in double, where a difference of floats or a sign must be exact. */
#ifndef LMB_VEC3D_H
#define LMB_VEC3D_H

#include <lambent/types.h>

static inline lmb_vec3d vec3d_between(lmb_vec3d from, lmb_vec3d to)
{
    return (lmb_vec3d){to.x - from.x, to.y - from.y, to.z - from.z};
}

static inline lmb_vec3d vec3d_of(lmb_vec3 v)
{
    return (lmb_vec3d){(double)v.x, (double)v.y, (double)v.z};
}

static inline lmb_vec3d vec3d_cross(lmb_vec3d a, lmb_vec3d b)
{
    return (lmb_vec3d){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double vec3d_dot(lmb_vec3d a, lmb_vec3d b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

#endif
