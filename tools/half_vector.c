#include "half_vector.h"

#include <math.h>

#include <lambent/vector.h>

double dielectric_reflectance(double f0, double cosine)
{
    const double root = sqrt(f0), index = (1.0 + root) / fmax(1.0 - root, 1e-6);
    const double inside = sqrt(1.0 - (1.0 - cosine * cosine) / (index * index));
    const double s = (cosine - index * inside) / (cosine + index * inside);
    const double p = (index * cosine - inside) / (index * cosine + inside);
    return index * cosine > 0.0 ? 0.5 * (s * s + p * p) : 1.0;
}

/* Slopes t have the density exp(-t^2/m^2) 2t/m^2. */
bool half_vector_pick(float roughness, lmb_vec3 normal, lmb_vec3 view, const float u[2], half_vector_sample *picked)
{
    lmb_vec3 tangent, bitangent;
    lmb_vec3_frame(normal, &tangent, &bitangent);
    const double nv = fmax((double)lmb_vec3_dot(normal, view), 1e-6);
    const double slope = (double)roughness * sqrt(-log(1.0 - (double)u[0]));
    const double up = 1.0 / sqrt(1.0 + slope * slope), turn = 2.0 * LMB_PI * (double)u[1];
    const lmb_vec3 across = lmb_vec3_mad(lmb_vec3_scale(tangent, (float)cos(turn)), bitangent, (float)sin(turn));
    const lmb_vec3 half_vector = lmb_vec3_mad(lmb_vec3_scale(normal, (float)up), across, (float)(up * slope));
    const double along = (double)lmb_vec3_dot(view, half_vector);
    picked->towards = lmb_vec3_mad(lmb_vec3_scale(view, -1.0f), half_vector, (float)(2.0 * along));
    picked->along = fmin(along, 1.0);
    const double nl = (double)lmb_vec3_dot(normal, picked->towards);
    /* G (V.H) / ((N.V) (N.H)) */
    picked->arrives = fmin(2.0, fmin(along / (nv * up), 2.0 * nl / nv));
    return along > 0.0 && nl > 0.0;
}

bool half_vector_respond(float roughness, lmb_vec3 normal, lmb_vec3 view, lmb_vec3 towards,
                         half_vector_response *response)
{
    const lmb_vec3 half_vector = lmb_vec3_unit_or(lmb_vec3_add(view, towards), normal);
    const double m2 = (double)roughness * (double)roughness;
    const double nv = fmax((double)lmb_vec3_dot(normal, view), 1e-6), nl = (double)lmb_vec3_dot(normal, towards);
    const double up = (double)lmb_vec3_dot(normal, half_vector), along = (double)lmb_vec3_dot(view, half_vector);
    if (!(nl > 0.0 && up > 0.0 && along > 0.0)) {
        return false;
    }
    const double up2 = up * up;
    const double slopes = exp((up2 - 1.0) / (up2 * m2)) / (LMB_PI * m2 * up2 * up2);
    response->reflects = slopes * fmin(1.0, 2.0 * up * fmin(nv, nl) / along) / (4.0 * nv);
    response->along = fmin(along, 1.0);
    response->density = slopes * up / (4.0 * along);
    return true;
}
