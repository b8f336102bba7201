/* What of a level looks like a mistake, once rays can be traced. */
#include <math.h>
#include <stdlib.h>

#include <lambent/sequence.h>
#include <lambent/trace.h>
#include <lambent/vector.h>

#include "base/trig.h"
#include "base/directions.h"
#include "trace/inside_out.h"
#include "trace/trace_internal.h"

/* So many of a kind are named; the others are counted. */
enum { MOST_NAMED = 5 };

/* What surrounds a lamp within this part of the level's diagonal is its own housing: 5 cm in a room of 10 m. */
#define HOUSING_SHARE 0.005f

static void others_warn(const lmb_warnings *warnings, uint32_t count, const char *what)
{
    if (count > MOST_NAMED) {
        lmb_warn(warnings, "%u more %s", count - MOST_NAMED, what);
    }
}

static void inside_out_warn(const lmb_tracer *tracer, const lmb_warnings *warnings)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (lmb_tracer_facing(tracer, i) == LMB_FACING_WRONG && count++ < MOST_NAMED) {
            lmb_warn(warnings,
                     "node '%s' is wound inside out: its texels are on the inner side, where no light is; turn its "
                     "triangles round, or make its material double-sided",
                     scene->instances[i].name);
        }
    }
    others_warn(warnings, count, "nodes are wound inside out");
}

static void partly_inside_out_warn(const lmb_tracer *tracer, const lmb_warnings *warnings)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    uint8_t *const facing = calloc((size_t)scene->instance_count + 1, sizeof *facing);
    if (!facing || lmb_inside_out_parts_find(tracer, facing) != LMB_OK) {
        free(facing); /* a warning less; the work itself will say that memory is short */
        return;
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (facing[i] != LMB_FACING_AS_WOUND && count++ < MOST_NAMED) {
            lmb_warn(warnings,
                     "node '%s' is wound inside out in parts: their texels are on the inner side, where no light is; "
                     "turn their triangles round",
                     scene->instances[i].name);
        }
    }
    others_warn(warnings, count, "nodes are wound inside out in parts");
    free(facing);
}

/* Directions in which a lamp shines. */
static void lamp_directions(const lmb_light *light, float *const direction[3])
{
    float x[LMB_RAY_BATCH], y[LMB_RAY_BATCH];
    lmb_sequence_2d_batch(lmb_stream_of_position(0, light->position), 0, LMB_RAY_BATCH, 0, x, y);
    if (light->type == LMB_LIGHT_POINT) {
        lmb_directions_make(LMB_LOBE_SPHERE, lmb_vec3_of(0.0f, 0.0f, 1.0f), x, y, LMB_RAY_BATCH, direction);
        return;
    }
    lmb_vec3 tangent, bitangent;
    lmb_vec3_frame(light->direction, &tangent, &bitangent);
    for (uint32_t i = 0; i < LMB_RAY_BATCH; ++i) {
        const float cosine = 1.0f - x[i] * (1.0f - light->cos_outer);
        const float flat = sqrtf(lmb_larger(1.0f - cosine * cosine, 0.0f));
        float s, c;
        lmb_turn_sincos(y[i], &s, &c);
        const lmb_vec3 side = lmb_vec3_add(lmb_vec3_scale(tangent, c * flat), lmb_vec3_scale(bitangent, s * flat));
        const lmb_vec3 along = lmb_vec3_mad(side, light->direction, cosine);
        direction[0][i] = along.x;
        direction[1][i] = along.y;
        direction[2][i] = along.z;
    }
}

/* Whether all that a lamp sends out meets something opaque within `reach`; `*hit` is the farthest. */
static bool lamp_is_shut_in(const lmb_tracer *tracer, const lmb_light *light, float reach, lmb_hit *farthest)
{
    lmb_ray_batch rays;
    lmb_hit hit[LMB_RAY_BATCH];
    float *const direction[3] = {rays.direction[0], rays.direction[1], rays.direction[2]};
    lamp_directions(light, direction);
    rays.count = LMB_RAY_BATCH;
    for (uint32_t i = 0; i < LMB_RAY_BATCH; ++i) {
        rays.origin[0][i] = light->position.x;
        rays.origin[1][i] = light->position.y;
        rays.origin[2][i] = light->position.z;
        rays.far_distance[i] = reach;
    }
    lmb_trace_nearest_batch(tracer, &rays, hit);
    *farthest = hit[0];
    for (uint32_t i = 0; i < LMB_RAY_BATCH; ++i) {
        if (hit[i].instance == LMB_HIT_NOTHING || lmb_tracer_is_see_through(tracer, hit[i].instance, hit[i].triangle)) {
            return false;
        }
        *farthest = hit[i].distance > farthest->distance ? hit[i] : *farthest;
    }
    return true;
}

static void lamps_warn(const lmb_tracer *tracer, const lmb_warnings *warnings)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    const float reach = HOUSING_SHARE * lmb_vec3_length(lmb_vec3_sub(scene->bounds_max, scene->bounds_min));
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        const lmb_light *light = &scene->lights[i];
        lmb_hit farthest;
        if (light->type == LMB_LIGHT_DIRECTIONAL || !(lmb_rgb_max(light->intensity) > 0.0f) ||
            !lamp_is_shut_in(tracer, light, reach, &farthest) || count++ >= MOST_NAMED) {
            continue;
        }
        lmb_warn(
            warnings,
            "light '%s' at %g, %g, %g is shut in: opaque surfaces (node '%s') are all around it within %.2g m, and "
            "its light does not get out",
            light->name, (double)light->position.x, (double)light->position.y, (double)light->position.z,
            scene->instances[farthest.instance].name, (double)farthest.distance);
    }
    others_warn(warnings, count, "lights are shut in");
}

void lmb_tracer_warn(const lmb_tracer *tracer, const lmb_warnings *warnings)
{
    if (!warnings || !warnings->warn ||
        !(lmb_tracer_scene(tracer)->bounds_min.x <= lmb_tracer_scene(tracer)->bounds_max.x)) {
        return;
    }
    inside_out_warn(tracer, warnings);
    partly_inside_out_warn(tracer, warnings);
    lamps_warn(tracer, warnings);
}
