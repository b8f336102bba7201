#include <lambent/probe_local.h>

#include "volume_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PROBES = LMB_LOCAL_SET_SIDE * LMB_LOCAL_SET_SIDE * LMB_LOCAL_SET_SIDE };

static void local_free(lmb_probe_local *local)
{
    free(local->name);
    free(local->validity);
    free(local->radiance);
    free(local->key_visibility);
}

void lmb_probes_free_locals(lmb_probes *probes)
{
    for (uint32_t i = 0; i < probes->local_count; ++i) {
        local_free(&probes->local[i]);
    }
    free(probes->local);
}

lmb_result lmb_probes_add_local(lmb_probes *probes, const char *name, int32_t node, int32_t place,
                                const lmb_local_frame *frame)
{
    assert(probes && name && frame);
    if (!lmb_local_frame_is_valid(frame) || node < 0 || place < 0 || probes->local_count == INT32_MAX) {
        return LMB_ERROR_ARGUMENT;
    }
    const size_t count = lmb_local_frame_count(frame), name_size = strlen(name) + 1;
    lmb_probe_local added = {.name = malloc(name_size),
                             .node = node,
                             .place = place,
                             .frame = *frame,
                             .validity = calloc(count, sizeof *added.validity),
                             .radiance = calloc(count, sizeof *added.radiance),
                             .key_visibility = calloc(count, sizeof *added.key_visibility)};
    const bool good = added.name && added.validity && added.radiance && added.key_visibility;
    lmb_probe_local *const more =
        good ? realloc(probes->local, ((size_t)probes->local_count + 1) * sizeof *more) : NULL;
    if (!more) {
        local_free(&added);
        return LMB_ERROR_MEMORY;
    }
    memcpy(added.name, name, name_size);
    probes->local = more;
    probes->local[probes->local_count++] = added;
    return LMB_OK;
}

int32_t lmb_probes_find_local(const lmb_probes *probes, int32_t node, int32_t place)
{
    for (uint32_t i = 0; i < probes->local_count; ++i) {
        if (probes->local[i].node == node && probes->local[i].place == place) {
            return (int32_t)i;
        }
    }
    return -1;
}

float lmb_probes_locals_largest(const lmb_probes *probes)
{
    float largest = 0.0f;
    for (uint32_t i = 0; i < probes->local_count; ++i) {
        const lmb_probe_local *const local = &probes->local[i];
        for (uint32_t k = 0; k < lmb_local_frame_count(&local->frame) * 3 * LMB_SH3_COUNT; ++k) {
            const lmb_sh3_rgb *const light = &local->radiance[k / (3 * LMB_SH3_COUNT)];
            largest = fmaxf(largest, fabsf(light->channel[k / LMB_SH3_COUNT % 3].c[k % LMB_SH3_COUNT]));
        }
    }
    return largest;
}

/* --------------------------------------------------------------------------------------------------- dilation */

/* Adds a share of one probe's light, and of what it sees of key lights, to another's. */
static void light_add(const lmb_sh3_rgb *from, const float from_seen[LMB_KEY_LIGHTS_MOST], float share, lmb_sh3_rgb *to,
                      float seen[LMB_KEY_LIGHTS_MOST])
{
    for (int k = 0; k < 3 * LMB_SH3_COUNT; ++k) {
        to->channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT] +=
            share * from->channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT];
    }
    for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
        seen[key] = fminf(seen[key] + share * from_seen[key], 1.0f);
    }
}

/* The neighbours of a probe that earlier passes lit, with weights. @return how many */
static uint32_t neighbours_find(const lmb_local_frame *frame, const uint8_t *pass, uint8_t before, uint32_t probe,
                                uint32_t neighbour[27], float weight[27])
{
    const int32_t size[3] = {(int32_t)frame->size[0], (int32_t)frame->size[1], (int32_t)frame->size[2]};
    const int32_t at[3] = {(int32_t)probe % size[0], (int32_t)probe / size[0] % size[1],
                           (int32_t)probe / size[0] / size[1]};
    uint32_t found = 0;
    for (int32_t n = 0; n < 27; ++n) {
        const int32_t off[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        const int32_t x = at[0] + off[0], y = at[1] + off[1], z = at[2] + off[2];
        if (n == 13 || x < 0 || y < 0 || z < 0 || x >= size[0] || y >= size[1] || z >= size[2]) {
            continue;
        }
        const uint32_t other = (uint32_t)(x + size[0] * (y + size[1] * z));
        if (pass[other] != 0 && pass[other] < before) {
            neighbour[found] = other;
            weight[found++] = 1.0f / (float)(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]);
        }
    }
    return found;
}

/* @return whether it has light now */
static bool probe_dilate(lmb_probe_local *local, const uint8_t *pass, uint8_t own_pass, uint32_t probe)
{
    uint32_t neighbour[27];
    float weight[27], sum = 0.0f;
    const uint32_t found = neighbours_find(&local->frame, pass, own_pass, probe, neighbour, weight);
    for (uint32_t i = 0; i < found; ++i) {
        sum += weight[i];
    }
    memset(&local->radiance[probe], 0, sizeof *local->radiance);
    memset(&local->key_visibility[probe], 0, sizeof *local->key_visibility);
    for (uint32_t i = 0; i < found; ++i) {
        light_add(&local->radiance[neighbour[i]], local->key_visibility[neighbour[i]], weight[i] / sum,
                  &local->radiance[probe], local->key_visibility[probe]);
    }
    return found > 0;
}

/* @return false: no probe is valid */
static bool local_dilate(lmb_probe_local *local)
{
    const uint32_t count = lmb_local_frame_count(&local->frame);
    uint8_t pass[MOST_PROBES]; /* in which it got light, from 1 on; 0: none yet */
    uint32_t lit = 0;
    for (uint32_t i = 0; i < count; ++i) {
        pass[i] = local->validity[i] >= LMB_PROBES_MIN_VALIDITY;
        lit += pass[i];
    }
    const bool any = lit > 0;
    for (uint8_t own = 2; any && lit < count; ++own) {
        for (uint32_t i = 0; i < count; ++i) {
            if (pass[i] == 0 && probe_dilate(local, pass, own, i)) {
                pass[i] = own;
                ++lit;
            }
        }
    }
    return any;
}

/* What the levels have at its places. */
static void local_from_levels(const lmb_probes *probes, lmb_probe_local *local)
{
    for (uint32_t i = 0; i < lmb_local_frame_count(&local->frame); ++i) {
        int32_t probe[8];
        double fraction[3];
        memset(&local->radiance[i], 0, sizeof *local->radiance);
        memset(&local->key_visibility[i], 0, sizeof *local->key_visibility);
        if (!probes->radiance[0] ||
            !lmb_probes_around(probes, lmb_local_frame_position(&local->frame, i), probe, fraction)) {
            continue;
        }
        for (int corner = 0; corner < 8; ++corner) {
            double weight = 1.0;
            for (int axis = 0; axis < 3; ++axis) {
                weight *= corner >> axis & 1 ? fraction[axis] : 1.0 - fraction[axis];
            }
            light_add(&probes->radiance[0][probe[corner]], probes->key_visibility[probe[corner]], (float)weight,
                      &local->radiance[i], local->key_visibility[i]);
        }
    }
}

void lmb_probes_dilate_locals(lmb_probes *probes)
{
    assert(probes);
    for (uint32_t i = 0; i < probes->local_count; ++i) {
        if (!local_dilate(&probes->local[i])) {
            local_from_levels(probes, &probes->local[i]);
        }
    }
}

/* ------------------------------------------------------------------------------------------------- the walker */

static bool probe_is_sane(const lmb_probes *probes, const lmb_probe_local *local, uint32_t probe)
{
    bool sane = local->validity[probe] >= 0.0f && local->validity[probe] <= 1.0f;
    for (int k = 0; k < 3 * LMB_SH3_COUNT; ++k) {
        sane = sane && isfinite(local->radiance[probe].channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT]);
    }
    for (uint32_t key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
        const float seen = local->key_visibility[probe][key];
        sane = sane && seen >= 0.0f && seen <= (key < probes->key_light_count ? 1.0f : 0.0f);
    }
    return sane;
}

lmb_result lmb_probes_validate_locals(const lmb_probes *probes, lmb_error *error)
{
    for (uint32_t i = 0; i < probes->local_count; ++i) {
        const lmb_probe_local *const local = &probes->local[i];
        if (!local->name || !local->validity || !local->radiance || !local->key_visibility || local->node < 0 ||
            local->place < 0 || !lmb_local_frame_is_valid(&local->frame)) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: local set %u has no frame, or not all of its arrays",
                                 i);
        }
        for (uint32_t k = 0; k < lmb_local_frame_count(&local->frame); ++k) {
            if (!probe_is_sane(probes, local, k)) {
                return lmb_error_set(error, LMB_ERROR_FORMAT,
                                     "probes: local set '%s', probe %u: its light, validity or what is seen of key "
                                     "lights is out of range",
                                     local->name, k);
            }
        }
    }
    return LMB_OK;
}
