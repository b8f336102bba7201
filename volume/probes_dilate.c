/* Dilation: light for the probes that could not be baked. Passes are found first, by walking outwards from the valid
 * probes; then each probe takes the mean of neighbours of earlier passes only, so that the order of probes does not
 * matter. */
#include <lambent/probes.h>

#include "volume_internal.h"

#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { NEIGHBOUR_COUNT = 26 };

/* Probe at offset `n` (x fastest, the probe itself left out), or -1; `*distance_squared` is 1, 2 or 3. */
static int32_t neighbour_of(const lmb_probes *probes, int32_t probe, int n, int *distance_squared)
{
    const int step = n < NEIGHBOUR_COUNT / 2 ? n : n + 1;
    const int offset[3] = {step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1};
    const lmb_probe_level *level = lmb_probes_level_of(probes, probe);
    int32_t point[3];
    *distance_squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t at = (int64_t)probes->point[probe][axis] + offset[axis];
        *distance_squared += offset[axis] * offset[axis];
        if (at < INT32_MIN || at > INT32_MAX) {
            return -1;
        }
        point[axis] = (int32_t)at;
    }
    return lmb_probes_find(probes, (uint32_t)(level - probes->level), point[0], point[1], point[2]);
}

void lmb_probes_dilation_passes(const lmb_probes *probes, int32_t *pass, int32_t *order, int32_t *reached)
{
    int32_t count = 0;
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        const bool is_ghost = probe >= probes->count - probes->ghost_count;
        lmb_probe_parents parents;
        const bool has_light =
            probes->validity[probe] >= LMB_PROBES_MIN_VALIDITY || lmb_probes_hangs(probes, probe, &parents);
        pass[probe] = !is_ghost && has_light ? 0 : -1;
        if (pass[probe] == 0) {
            order[count++] = probe;
        }
    }
    for (int32_t next = 0; next < count; ++next) {
        for (int n = 0; n < NEIGHBOUR_COUNT; ++n) {
            int distance_squared;
            const int32_t neighbour = neighbour_of(probes, order[next], n, &distance_squared);
            if (neighbour >= 0 && pass[neighbour] < 0) {
                pass[neighbour] = pass[order[next]] + 1;
                order[count++] = neighbour;
            }
        }
    }
    *reached = count;
}

/* Mean over neighbours of earlier passes, weighted by 1 / distance^2, summed in double in a fixed order. */
static void fill_probe(lmb_probes *probes, lmb_sh3_rgb *light, const int32_t *pass, int32_t probe)
{
    double sum[3][LMB_SH3_COUNT] = {{0.0}};
    double weights = 0.0;
    for (int n = 0; n < NEIGHBOUR_COUNT; ++n) {
        int distance_squared;
        const int32_t neighbour = neighbour_of(probes, probe, n, &distance_squared);
        if (neighbour < 0 || pass[neighbour] < 0 || pass[neighbour] >= pass[probe]) {
            continue;
        }
        const double weight = 1.0 / distance_squared;
        weights += weight;
        for (int channel = 0; channel < 3; ++channel) {
            for (int i = 0; i < LMB_SH3_COUNT; ++i) {
                sum[channel][i] += weight * (double)light[neighbour].channel[channel].c[i];
            }
        }
    }
    assert(weights > 0.0); /* a probe is reached through a neighbour of the pass before */
    for (int channel = 0; channel < 3; ++channel) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            light[probe].channel[channel].c[i] = (float)(sum[channel][i] / weights);
        }
    }
}

/* The same of what is seen of key lights. */
static void fill_visibility(lmb_probes *probes, const int32_t *pass, int32_t probe)
{
    double sum[LMB_KEY_LIGHTS_MOST] = {0.0};
    double weights = 0.0;
    for (int n = 0; n < NEIGHBOUR_COUNT; ++n) {
        int distance_squared;
        const int32_t neighbour = neighbour_of(probes, probe, n, &distance_squared);
        if (neighbour < 0 || pass[neighbour] < 0 || pass[neighbour] >= pass[probe]) {
            continue;
        }
        const double weight = 1.0 / distance_squared;
        weights += weight;
        for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
            sum[key] += weight * (double)probes->key_visibility[neighbour][key];
        }
    }
    for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
        probes->key_visibility[probe][key] = (float)(sum[key] / weights);
    }
}

static void probe_clear(lmb_probes *probes, int32_t probe)
{
    for (uint32_t set = 0; set < probes->set_count; ++set) {
        probes->radiance[set][probe] = (lmb_sh3_rgb){{{{0.0f}}}};
    }
    memset(probes->key_visibility[probe], 0, sizeof *probes->key_visibility);
}

/* `order` has this level's probes among all. */
static void dilate_level(lmb_probes *probes, const lmb_probe_level *level, const int32_t *pass, const int32_t *order,
                         int32_t reached)
{
    for (int32_t i = 0; i < reached; ++i) {
        const int32_t probe = order[i];
        if (pass[probe] == 0 || probe < level->first || probe >= level->first + level->count) {
            continue;
        }
        for (uint32_t set = 0; set < probes->set_count; ++set) {
            fill_probe(probes, probes->radiance[set], pass, probe);
        }
        if (probes->key_light_count > 0) {
            fill_visibility(probes, pass, probe);
        }
    }
    for (int32_t probe = level->first; probe < level->first + level->count; ++probe) {
        if (pass[probe] < 0) {
            probe_clear(probes, probe);
        }
    }
}

lmb_result lmb_probes_dilate(lmb_probes *probes)
{
    assert(probes);
    if (probes->count == 0) {
        return LMB_OK;
    }
    int32_t *const pass = malloc((size_t)probes->count * sizeof *pass);
    int32_t *const order = malloc((size_t)probes->count * sizeof *order);
    lmb_result result = LMB_ERROR_MEMORY;
    if (!pass || !order) {
        goto cleanup;
    }
    int32_t reached;
    lmb_probes_dilation_passes(probes, pass, order, &reached);
    for (uint32_t level = probes->level_count; level-- > 0;) {
        lmb_probes_hang_level(probes, level);
        dilate_level(probes, &probes->level[level], pass, order, reached);
    }
    result = LMB_OK;
cleanup:
    free(pass);
    free(order);
    return result;
}
