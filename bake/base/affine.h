/* Affine transforms of points and vectors, in double. */
#ifndef LMB_AFFINE_H
#define LMB_AFFINE_H

#include <lambent/affine.h>
#include <lambent/vector.h>

static inline lmb_vec3 affine_point(const lmb_affine *t, lmb_vec3 p)
{
    const double x = (double)p.x, y = (double)p.y, z = (double)p.z;
    return lmb_vec3_of((float)(t->m[0][0] * x + t->m[0][1] * y + t->m[0][2] * z + t->m[0][3]),
                       (float)(t->m[1][0] * x + t->m[1][1] * y + t->m[1][2] * z + t->m[1][3]),
                       (float)(t->m[2][0] * x + t->m[2][1] * y + t->m[2][2] * z + t->m[2][3]));
}

static inline lmb_vec3 affine_vector(const lmb_affine *t, lmb_vec3 v)
{
    const double x = (double)v.x, y = (double)v.y, z = (double)v.z;
    return lmb_vec3_of((float)(t->m[0][0] * x + t->m[0][1] * y + t->m[0][2] * z),
                       (float)(t->m[1][0] * x + t->m[1][1] * y + t->m[1][2] * z),
                       (float)(t->m[2][0] * x + t->m[2][1] * y + t->m[2][2] * z));
}

#endif
