/* Transforms of a level's nodes. */
#ifndef LAMBENT_AFFINE_H
#define LAMBENT_AFFINE_H

/* Row-major affine transform: p' = m[r][0] x + m[r][1] y + m[r][2] z + m[r][3]. */
typedef struct lmb_affine {
    double m[3][4];
} lmb_affine;

#endif
