/* How a node's transform places what hangs on it. */
#include "gltf/gltf_transform.h"

#include <math.h>

/* Below this share of its largest element cubed, a transform's determinant is rounding. */
#define FLAT_DETERMINANT 1e-15

/* Below this share of the largest element squared, its cofactors are too: two axes are gone. */
#define LINE_COFACTOR 1e-12

/* Transforms smaller than this are nothing. */
#define SMALLEST_SCALE 1e-18

/* What a flat transform is made thick by, in shares of its largest element. */
#define THICKNESS 1e-6

lmb_affine lmb_gltf_product(const lmb_affine *a, const lmb_affine *b)
{
    lmb_affine c;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 4; ++j) {
            c.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] + a->m[i][2] * b->m[2][j] +
                        (j == 3 ? a->m[i][3] : 0.0);
        }
    }
    return c;
}

lmb_affine lmb_gltf_compose(const double t[3], const double q[4], const double s[3])
{
    const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const double k = norm > 0.0 ? 2.0 / norm : 0.0;
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double r[3][3] = {{1 - k * (y * y + z * z), k * (x * y - z * w), k * (x * z + y * w)},
                            {k * (x * y + z * w), 1 - k * (x * x + z * z), k * (y * z - x * w)},
                            {k * (x * z - y * w), k * (y * z + x * w), 1 - k * (x * x + y * y)}};
    lmb_affine m;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            m.m[i][j] = r[i][j] * s[j];
        }
        m.m[i][3] = t[i];
    }
    return m;
}

/* Up to `count` floats in place of what is there; false when one is not finite. */
static bool floats_take(const float *from, int count, double *values)
{
    for (int i = 0; from && i < count; ++i) {
        values[i] = (double)from[i];
        if (!(fabs(values[i]) < LMB_GLTF_FARTHEST)) {
            return false;
        }
    }
    return true;
}

bool lmb_gltf_inverse(const lmb_affine *t, lmb_affine *inverse)
{
    lmb_affine cofactor, found;
    const double determinant = lmb_gltf_cofactors(t, &cofactor);
    bool is_finite = determinant != 0.0 && isfinite(determinant);
    for (int row = 0; row < 3; ++row) {
        found.m[row][3] = 0.0;
        for (int column = 0; column < 3; ++column) {
            found.m[row][column] = cofactor.m[column][row] / determinant;
            found.m[row][3] -= found.m[row][column] * t->m[column][3];
        }
        is_finite = is_finite && isfinite(found.m[row][3]);
    }
    if (is_finite) {
        *inverse = found;
    }
    return is_finite;
}

bool lmb_gltf_instancing_transform(const float *translation, const float *rotation, const float *scale,
                                   lmb_affine *transform, float *reach)
{
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    if (!floats_take(translation, 3, t) || !floats_take(rotation, 4, q) || !floats_take(scale, 3, s)) {
        return false;
    }
    *transform = lmb_gltf_compose(t, q, s);
    *reach = (float)fmax(fmax(fabs(t[0]), fabs(t[1])), fabs(t[2]));
    return true;
}

lmb_vec3 lmb_gltf_forward(const lmb_affine *to_world)
{
    double away[3], length = 0.0;
    for (int i = 0; i < 3; ++i) {
        away[i] = -to_world->m[i][2];
        length += away[i] * away[i];
    }
    length = sqrt(length);
    return length > 0.0 ? (lmb_vec3){(float)(away[0] / length), (float)(away[1] / length), (float)(away[2] / length)}
                        : (lmb_vec3){0.0f, 0.0f, -1.0f};
}

double lmb_gltf_cofactors(const lmb_affine *t, lmb_affine *cofactor)
{
    *cofactor = (lmb_affine){{{0}}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor->m[i][j] = t->m[i1][j1] * t->m[i2][j2] - t->m[i1][j2] * t->m[i2][j1];
        }
    }
    return t->m[0][0] * cofactor->m[0][0] + t->m[0][1] * cofactor->m[0][1] + t->m[0][2] * cofactor->m[0][2];
}

/* The largest element of the linear part. */
static double linear_size(const lmb_affine *t)
{
    double size = 0.0;
    for (int k = 0; k < 9; ++k) {
        size = fmax(size, fabs(t->m[k / 3][k % 3]));
    }
    return size;
}

static bool is_flat(double determinant, double size)
{
    return !(fabs(determinant) > FLAT_DETERMINANT * size * size * size);
}

/* The cofactors of a flat transform are n k^T, n across what it maps to and k across what it keeps of: a little of that
 * makes it thick. Its sign is the one that mirrors nothing. false when it flattens more than one axis. */
static bool thicken(lmb_affine *t, const lmb_affine *cofactor, double size)
{
    int row = 0, column = 0;
    for (int k = 0; k < 9; ++k) {
        if (fabs(cofactor->m[k / 3][k % 3]) > fabs(cofactor->m[row][column])) {
            row = k / 3;
            column = k % 3;
        }
    }
    const double largest = cofactor->m[row][column];
    if (!(fabs(largest) > LINE_COFACTOR * size * size)) {
        return false;
    }
    double across = 0.0, along = 0.0;
    for (int i = 0; i < 3; ++i) {
        across += cofactor->m[i][column] * cofactor->m[i][column];
        along += cofactor->m[row][i] * cofactor->m[row][i];
    }
    const double scale = copysign(THICKNESS * size / sqrt(across * along), largest);
    for (int k = 0; k < 9; ++k) {
        t->m[k / 3][k % 3] += scale * cofactor->m[k / 3][column] * cofactor->m[row][k % 3];
    }
    return true;
}

lmb_gltf_rank lmb_gltf_transform_rank(const lmb_affine *t)
{
    lmb_affine cofactor;
    const double determinant = lmb_gltf_cofactors(t, &cofactor), size = linear_size(t);
    return !(size > SMALLEST_SCALE) ? LMB_GLTF_NOTHING : is_flat(determinant, size) ? LMB_GLTF_FLAT : LMB_GLTF_SOLID;
}

bool lmb_gltf_instance_place(const lmb_affine *to_world, const lmb_vec3 *shift, lmb_instance *instance)
{
    const double size = linear_size(to_world);
    instance->to_world = *to_world;
    double determinant = lmb_gltf_cofactors(&instance->to_world, &instance->normal_to_world);
    if (!(size > SMALLEST_SCALE)) {
        return false;
    }
    if (is_flat(determinant, size)) {
        if (!thicken(&instance->to_world, &instance->normal_to_world, size)) {
            return false;
        }
        determinant = lmb_gltf_cofactors(&instance->to_world, &instance->normal_to_world);
    }
    for (int k = 0; k < 9; ++k) {
        instance->normal_to_world.m[k / 3][k % 3] /= determinant;
    }
    instance->mirrored = determinant < 0.0;
    for (int i = 0; i < 3; ++i) {
        double *const row = instance->to_world.m[i];
        row[3] = row[0] * (double)shift->x + row[1] * (double)shift->y + row[2] * (double)shift->z + row[3];
    }
    return true;
}
