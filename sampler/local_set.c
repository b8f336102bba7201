#include <lambent/local_set.h>

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include <lambent/vector.h>

lmb_local_frame lmb_local_frame_of_box(lmb_vec3d centre, const lmb_vec3 half[3], const uint32_t size[3])
{
    lmb_local_frame frame = {.origin = centre};
    for (int axis = 0; axis < 3; ++axis) {
        assert(size[axis] >= 1 && size[axis] <= LMB_LOCAL_SET_SIDE);
        const float cells = size[axis] > 1 ? (float)(size[axis] - 1) : 1.0f;
        frame.size[axis] = size[axis];
        frame.step[axis] = lmb_vec3_scale(half[axis], 2.0f / cells);
        if (size[axis] > 1) {
            frame.origin.x -= (double)half[axis].x;
            frame.origin.y -= (double)half[axis].y;
            frame.origin.z -= (double)half[axis].z;
        }
    }
    return frame;
}

/* A share of their lengths that the dot product of two steps may be. */
#define RIGHT_ANGLE_ERROR 1e-3f

/* MinGW's isfinite warns of doubles. */
static bool is_finite(double value)
{
    return fabs(value) <= DBL_MAX;
}

bool lmb_local_frame_is_valid(const lmb_local_frame *frame)
{
    assert(frame);
    bool valid = is_finite(frame->origin.x) && is_finite(frame->origin.y) && is_finite(frame->origin.z);
    float squared[3];
    for (int axis = 0; axis < 3; ++axis) {
        const lmb_vec3 step = frame->step[axis];
        squared[axis] = lmb_vec3_dot(step, step);
        valid = valid && frame->size[axis] >= 1 && frame->size[axis] <= LMB_LOCAL_SET_SIDE &&
                squared[axis] >= FLT_MIN && squared[axis] <= FLT_MAX;
        for (int before = 0; before < axis; ++before) {
            const float most = RIGHT_ANGLE_ERROR * sqrtf(squared[axis]) * sqrtf(squared[before]);
            valid = valid && fabsf(lmb_vec3_dot(step, frame->step[before])) <= most;
        }
    }
    return valid;
}

static lmb_vec3 vector_turned(lmb_vec3 v, const lmb_vec3 turn[3])
{
    return lmb_vec3_mad(lmb_vec3_mad(lmb_vec3_scale(turn[0], v.x), turn[1], v.y), turn[2], v.z);
}

lmb_local_frame lmb_local_frame_moved(const lmb_local_frame *frame, lmb_vec3d from, lmb_vec3d to,
                                      const lmb_vec3 turn[3])
{
    assert(frame && turn);
    const lmb_vec3 way = {(float)(frame->origin.x - from.x), (float)(frame->origin.y - from.y),
                          (float)(frame->origin.z - from.z)};
    const lmb_vec3 now = vector_turned(way, turn);
    lmb_local_frame moved = *frame;
    moved.origin.x = to.x + (double)now.x;
    moved.origin.y = to.y + (double)now.y;
    moved.origin.z = to.z + (double)now.z;
    for (int axis = 0; axis < 3; ++axis) {
        moved.step[axis] = vector_turned(frame->step[axis], turn);
    }
    return moved;
}

uint32_t lmb_local_frame_count(const lmb_local_frame *frame)
{
    return frame->size[0] * frame->size[1] * frame->size[2];
}

lmb_vec3d lmb_local_frame_position(const lmb_local_frame *frame, uint32_t probe)
{
    const uint32_t at[3] = {probe % frame->size[0], probe / frame->size[0] % frame->size[1],
                            probe / frame->size[0] / frame->size[1]};
    lmb_vec3d position = frame->origin;
    for (int axis = 0; axis < 3; ++axis) {
        position.x += (double)at[axis] * (double)frame->step[axis].x;
        position.y += (double)at[axis] * (double)frame->step[axis].y;
        position.z += (double)at[axis] * (double)frame->step[axis].z;
    }
    return position;
}

uint32_t lmb_local_set_resample(const lmb_volume *volume, const lmb_local_frame *frame, lmb_sh3_rgb *radiance,
                                float (*visibility)[LMB_KEY_LIGHTS_MOST])
{
    assert(volume && frame && radiance);
    enum { BATCH = 64 };
    const uint32_t count = lmb_local_frame_count(frame);
    uint32_t inside_count = 0;
    for (uint32_t first = 0; first < count; first += BATCH) {
        const uint32_t some = count - first < BATCH ? count - first : BATCH;
        lmb_vec3d position[BATCH];
        bool inside[BATCH];
        for (uint32_t i = 0; i < some; ++i) {
            position[i] = lmb_local_frame_position(frame, first + i);
        }
        lmb_volume_sample_batch(volume, position, some, radiance + first, visibility ? visibility + first : NULL,
                                inside);
        for (uint32_t i = 0; i < some; ++i) {
            inside_count += inside[i];
        }
    }
    return inside_count;
}

/* The cell along an axis that a position's distance from the origin is in, and where in it. */
static uint32_t cell_along(const lmb_local_frame *frame, int axis, lmb_vec3 way, float *fraction)
{
    const lmb_vec3 step = frame->step[axis];
    const float last = (float)(frame->size[axis] - 1), squared = lmb_vec3_dot(step, step);
    float at = squared > 0.0f ? lmb_vec3_dot(way, step) / squared : 0.0f;
    at = at > 0.0f ? at : 0.0f; /* NaN too */
    at = at < last ? at : last;
    const uint32_t cell = (uint32_t)at < frame->size[axis] - 1 ? (uint32_t)at : frame->size[axis] - 1;
    *fraction = at - (float)cell;
    return cell;
}

/* The probes around a position that have a weight: those that have none may not be there. @return how many */
static uint32_t around_find(const lmb_local_frame *frame, lmb_vec3d position, uint32_t probe[8], float weight[8])
{
    const lmb_vec3 way = {(float)(position.x - frame->origin.x), (float)(position.y - frame->origin.y),
                          (float)(position.z - frame->origin.z)};
    uint32_t cell[3], found = 0;
    float t[3];
    for (int axis = 0; axis < 3; ++axis) {
        cell[axis] = cell_along(frame, axis, way, &t[axis]);
    }
    for (uint32_t corner = 0; corner < 8; ++corner) {
        float product = 1.0f;
        uint32_t at[3];
        for (uint32_t axis = 0; axis < 3; ++axis) {
            const uint32_t high = corner >> axis & 1u;
            product *= high ? t[axis] : 1.0f - t[axis];
            at[axis] = cell[axis] + high;
        }
        if (product > 0.0f) {
            probe[found] = at[0] + frame->size[0] * (at[1] + frame->size[1] * at[2]);
            weight[found++] = product;
        }
    }
    return found;
}

/* Harmonics as plain numbers, which compilers make vectors of. */
enum { NUMBERS = sizeof(lmb_sh3_rgb) / sizeof(float) };

static void light_add(const lmb_sh3_rgb *from, float weight, float sum[NUMBERS])
{
    float number[NUMBERS];
    memcpy(number, from, sizeof number);
    for (int k = 0; k < NUMBERS; ++k) {
        sum[k] += weight * number[k];
    }
}

void lmb_local_set_sample_with_keys(const lmb_local_frame *frame, const lmb_sh3_rgb *radiance,
                                    const float (*visibility)[LMB_KEY_LIGHTS_MOST], lmb_vec3d position,
                                    lmb_sh3_rgb *light, float seen[LMB_KEY_LIGHTS_MOST])
{
    assert(frame && radiance && light && (!visibility || seen));
    uint32_t probe[8];
    float weight[8];
    const uint32_t count = around_find(frame, position, probe, weight);
    float sum[NUMBERS] = {0.0f};
    for (uint32_t i = 0; i < count; ++i) {
        light_add(&radiance[probe[i]], weight[i], sum);
    }
    memcpy(light, sum, sizeof sum);
    for (uint32_t key = 0; visibility && key < LMB_KEY_LIGHTS_MOST; ++key) {
        float share = 0.0f;
        for (uint32_t i = 0; i < count; ++i) {
            share += weight[i] * visibility[probe[i]][key];
        }
        seen[key] = share < 1.0f ? share : 1.0f;
    }
}

void lmb_local_set_sample(const lmb_local_frame *frame, const lmb_sh3_rgb *radiance, lmb_vec3d position,
                          lmb_sh3_rgb *light)
{
    lmb_local_set_sample_with_keys(frame, radiance, NULL, position, light, NULL);
}
