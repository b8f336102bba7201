/* Oracles for the sampler's maths, in double and independent of it: the SH basis from GSL's associated Legendre
 * functions, quadrature over cones about any axis, and repeatable random numbers. */
#ifndef LMB_TESTS_SH_ORACLE_H
#define LMB_TESTS_SH_ORACLE_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <gsl/gsl_integration.h>
#include <gsl/gsl_sf_legendre.h>

#include <lambent/sh.h>

#define ORACLE_PI 3.14159265358979323846

typedef struct ovec {
    double x, y, z;
} ovec;

typedef struct onode {
    ovec direction;
    double weight; /* solid angle */
} onode;

typedef struct orule {
    onode *nodes;
    size_t count;
} orule;

static inline double ovec_dot(ovec a, ovec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline ovec ovec_mix(ovec a, double s, ovec b, double t)
{
    return (ovec){s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z};
}

static inline ovec ovec_unit(ovec a)
{
    const double length = sqrt(ovec_dot(a, a));
    return (ovec){a.x / length, a.y / length, a.z / length};
}

static inline ovec ovec_cross(ovec a, ovec b)
{
    return (ovec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* Two unit vectors that make a right-handed frame with unit `axis`. */
static inline void ovec_frame(ovec axis, ovec *x, ovec *y)
{
    const ovec other = fabs(axis.x) < 0.5 ? (ovec){1, 0, 0} : (ovec){0, 1, 0};
    *x = ovec_unit(ovec_cross(other, axis));
    *y = ovec_cross(axis, *x);
}

static inline lmb_vec3 ovec_float(ovec a)
{
    return (lmb_vec3){(float)a.x, (float)a.y, (float)a.z};
}

static inline ovec ovec_of(lmb_vec3 a)
{
    return (ovec){(double)a.x, (double)a.y, (double)a.z};
}

/* The real orthonormal basis with Condon-Shortley signs, up to band 2. */
static inline void oracle_basis(ovec d, double basis[9])
{
    double p[32];
    if (gsl_sf_legendre_array_n(2) > sizeof p / sizeof p[0] ||
        gsl_sf_legendre_array_e(GSL_SF_LEGENDRE_SPHARM, 2, fmax(-1.0, fmin(1.0, d.z)), -1.0, p) != 0) {
        fprintf(stderr, "GSL cannot give Legendre functions\n");
        exit(1);
    }
    const double phi = atan2(d.y, d.x);
    for (int l = 0; l <= 2; ++l) {
        for (int m = -l; m <= l; ++m) {
            const double legendre = p[gsl_sf_legendre_array_index((size_t)l, (size_t)abs(m))];
            const double turn = m > 0 ? sqrt(2.0) * cos(m * phi) : m < 0 ? sqrt(2.0) * sin(-m * phi) : 1.0;
            basis[l * l + l + m] = legendre * turn;
        }
    }
}

static inline double oracle_evaluate(const double c[9], ovec d)
{
    double basis[9];
    oracle_basis(d, basis);
    double sum = 0.0;
    for (int i = 0; i < 9; ++i) {
        sum += c[i] * basis[i];
    }
    return sum;
}

/* Nodes for directions with cos_min < w.axis < cos_max: Gauss-Legendre in the cosine, even steps about the axis.
 * Exact for polynomials of degree < min(2 cosines, turns). */
static inline orule oracle_zone(ovec axis, double cos_min, double cos_max, size_t cosines, size_t turns)
{
    orule rule = {malloc(cosines * turns * sizeof(onode)), cosines * turns};
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(cosines);
    if (!rule.nodes || !table) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    ovec x, y;
    ovec_frame(axis, &x, &y);
    for (size_t i = 0; i < cosines; ++i) {
        double cosine, weight;
        gsl_integration_glfixed_point(cos_min, cos_max, i, &cosine, &weight, table);
        const double sine = sqrt(fmax(0.0, 1.0 - cosine * cosine));
        for (size_t j = 0; j < turns; ++j) {
            const double phi = 2.0 * ORACLE_PI * ((double)j + 0.5) / (double)turns;
            const ovec ring = ovec_mix(x, sine * cos(phi), y, sine * sin(phi));
            rule.nodes[i * turns + j] =
                (onode){ovec_mix(ring, 1.0, axis, cosine), weight * 2.0 * ORACLE_PI / (double)turns};
        }
    }
    gsl_integration_glfixed_table_free(table);
    return rule;
}

static inline void oracle_rule_free(orule rule)
{
    free(rule.nodes);
}

/* Repeatable uniform numbers in [0, 1): SplitMix64. */
static inline double oracle_random(uint64_t *state)
{
    uint64_t z = (*state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static inline ovec oracle_random_direction(uint64_t *state)
{
    const double z = 2.0 * oracle_random(state) - 1.0;
    const double phi = 2.0 * ORACLE_PI * oracle_random(state);
    const double r = sqrt(1.0 - z * z);
    return (ovec){r * cos(phi), r * sin(phi), z};
}

/* A random float direction and the same in double, so that both sides see the same numbers. */
static inline ovec oracle_random_normal(uint64_t *state, lmb_vec3 *normal)
{
    *normal = ovec_float(oracle_random_direction(state));
    return ovec_unit(ovec_of(*normal));
}

/* Coefficients in [-1, 1), l0 moved up by `brightness`, as floats and as the same numbers in double. */
static inline lmb_sh3 oracle_random_sh3(uint64_t *state, double brightness, double c[9])
{
    lmb_sh3 sh;
    for (int i = 0; i < 9; ++i) {
        sh.c[i] = (float)(2.0 * oracle_random(state) - 1.0 + (i == 0 ? brightness : 0.0));
        c[i] = (double)sh.c[i];
    }
    return sh;
}

/* Floats that break careless code: every edge of float and of half, signs, NaN and infinities. */
static const float oracle_nasty[] = {
    0.0f,           -0.0f,           1.0f,     -1.0f,     1e-45f,   -1e-45f, 1e-38f, 1.17549435e-38f,
    5.96e-8f,       6.1e-5f,         65504.f,  -65504.f,  222208.f, 1e19f,   -1e19f, 1e30f,
    3.40282347e38f, -3.40282347e38f, INFINITY, -INFINITY, NAN,
};
enum { ORACLE_NASTY_COUNT = sizeof oracle_nasty / sizeof oracle_nasty[0] };

#endif
