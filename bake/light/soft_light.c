#include "light/soft_light.h"

#include <math.h>

#include <lambent/vector.h>

#include "base/trig.h"

float lmb_light_extent(const lmb_light *light)
{
    if (light->type != LMB_LIGHT_DIRECTIONAL) {
        return light->radius;
    }
    double sine, cosine;
    lmb_sincos(0.5 * (double)light->angle_rad, &sine, &cosine);
    return (float)sine;
}

/* Cosine of an angle up to pi/2. */
static float cosine_of(float sine)
{
    return sqrtf(lmb_larger((1.0f - sine) * (1.0f + sine), 0.0f));
}

/* `below`: 1 - the cosine of the angle to `axis`; without the cancellation that a narrow cone would suffer. */
static lmb_vec3 direction_about(lmb_vec3 axis, float below, float turns)
{
    lmb_vec3 tangent, bitangent;
    lmb_vec3_frame(axis, &tangent, &bitangent);
    const float away = sqrtf(lmb_larger(below * (2.0f - below), 0.0f));
    float sine, cosine;
    lmb_turn_sincos(turns, &sine, &cosine);
    const lmb_vec3 side = lmb_vec3_add(lmb_vec3_scale(tangent, cosine * away), lmb_vec3_scale(bitangent, sine * away));
    return lmb_vec3_unit_or(lmb_vec3_mad(side, axis, 1.0f - below), axis);
}

/* 1 - the cosine of a cone's half angle. */
static float cone_height(float sine)
{
    return sine * sine / (1.0f + cosine_of(sine));
}

lmb_light_point lmb_sun_point(lmb_vec3 to_sun, float sine, const float u[2])
{
    /* L times the solid angle 2 pi (1 - cos), where L = E / (pi sine^2). */
    return (lmb_light_point){.direction = direction_about(to_sun, u[0] * cone_height(sine), u[1]),
                             .factor = 2.0f / (1.0f + cosine_of(sine))};
}

lmb_light_point lmb_lamp_point(lmb_vec3 centre, float radius, lmb_vec3 position, float min_distance, const float u[2])
{
    const lmb_vec3 to_centre = lmb_vec3_sub(centre, position);
    const float distance = lmb_vec3_length(to_centre);
    const lmb_vec3 axis = lmb_vec3_unit_or(to_centre, lmb_vec3_of(0.0f, 1.0f, 0.0f));
    const float counted = lmb_larger(lmb_larger(distance, radius), min_distance);
    const bool outside = distance > radius;
    const float sine = outside ? radius / distance : 1.0f;
    lmb_light_point point;
    point.direction = direction_about(axis, u[0] * (outside ? cone_height(sine) : 2.0f), u[1]);
    /* L times the solid angle 2 pi (1 - cos), where L = I / (pi radius^2); 4 pi from inside. */
    point.factor = (outside ? 2.0f / (1.0f + cosine_of(sine)) : 4.0f) / counted / counted;
    const float along = lmb_vec3_dot(point.direction, to_centre);
    const lmb_vec3 off = lmb_vec3_mad(to_centre, point.direction, -along);
    const float half_chord = sqrtf(lmb_larger(radius * radius - lmb_vec3_dot(off, off), 0.0f));
    point.end =
        lmb_vec3_mad(position, point.direction, lmb_larger(outside ? along - half_chord : along + half_chord, 0.0f));
    return point;
}
