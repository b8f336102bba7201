/* Local sets that were baked into a volume: verifying them on opening, and reading one. */
#include <lambent/local_set.h>

#include "volume_internal.h"
#include "volume_probe_internal.h"

#include <lambent/local_set_format.h>

#include <assert.h>
#include <string.h>

_Static_assert(sizeof(lmb_volume_locals) == 8 && sizeof(lmb_volume_local) == 96, "neither has padding");
_Static_assert(LMB_LOCAL_SET_MOST == LMB_LOCAL_SET_SIDE * LMB_LOCAL_SET_SIDE * LMB_LOCAL_SET_SIDE,
               "in every direction");

static const lmb_volume_locals *locals_of(const lmb_volume *volume)
{
    return (const lmb_volume_locals *)(const void *)volume->locals;
}

static const lmb_volume_local *locals_list(const lmb_volume *volume)
{
    return (const lmb_volume_local *)(const void *)(volume->locals + sizeof(lmb_volume_locals));
}

static const char *locals_names(const lmb_volume *volume)
{
    return (const char *)(locals_list(volume) + locals_of(volume)->count);
}

static const unsigned char *locals_probes(const lmb_volume *volume)
{
    return (const unsigned char *)locals_names(volume) + locals_of(volume)->name_bytes;
}

static lmb_local_frame frame_of(const lmb_volume_local *local)
{
    lmb_local_frame frame = {.origin = {local->origin[0], local->origin[1], local->origin[2]}};
    for (int axis = 0; axis < 3; ++axis) {
        const float *const step = local->step[axis];
        frame.step[axis].x = step[0];
        frame.step[axis].y = step[1];
        frame.step[axis].z = step[2];
        frame.size[axis] = local->size[axis];
    }
    return frame;
}

/* Coefficients and, of halfs, nothing else: bytes of compact probes and of key lights may be any. */
static bool probes_are_finite(const lmb_volume *volume, uint64_t count)
{
    const size_t halfs = volume->header->probe_form == LMB_VOLUME_COMPACT ? 3 : LMB_PROBE_COEFFICIENTS;
    bool finite = true;
    for (size_t i = 0; finite && i < (size_t)count; ++i) {
        finite = lmb_volume_halfs_are_finite(locals_probes(volume) + i * volume->header->probe_bytes, halfs);
    }
    return finite;
}

bool lmb_volume_locals_are_sane(const lmb_volume *volume)
{
    const uint64_t bytes = volume->header->local_bytes;
    if (bytes == 0) {
        return true;
    }
    if (bytes < sizeof(lmb_volume_locals)) {
        return false;
    }
    const lmb_volume_locals *const head = locals_of(volume);
    const uint64_t before_names = sizeof *head + (uint64_t)head->count * sizeof(lmb_volume_local);
    if (head->count < 1 || head->name_bytes < 1 || head->name_bytes % 4 != 0 || before_names > bytes ||
        head->name_bytes > bytes - before_names || locals_names(volume)[head->name_bytes - 1] != '\0') {
        return false;
    }
    uint64_t probes = 0;
    bool sane = true;
    for (uint32_t i = 0; sane && i < head->count; ++i) {
        const lmb_volume_local *const local = &locals_list(volume)[i];
        const lmb_local_frame frame = frame_of(local);
        sane = lmb_local_frame_is_valid(&frame) && local->name < head->name_bytes && local->probe_first == probes &&
               local->node >= 0 && local->place >= 0 && local->reserved[0] == 0 && local->reserved[1] == 0;
        probes += sane ? lmb_local_frame_count(&frame) : 0;
    }
    return sane && bytes - before_names - head->name_bytes == probes * volume->header->probe_bytes &&
           probes_are_finite(volume, probes);
}

uint32_t lmb_volume_local_set_count(const lmb_volume *volume)
{
    assert(volume);
    return volume->locals ? locals_of(volume)->count : 0;
}

uint32_t lmb_volume_local_set_find(const lmb_volume *volume, const char *name)
{
    assert(volume && name);
    const uint32_t count = lmb_volume_local_set_count(volume);
    uint32_t index = 0;
    while (index < count && strcmp(locals_names(volume) + locals_list(volume)[index].name, name) != 0) {
        ++index;
    }
    return index;
}

lmb_local_set lmb_volume_local_set_get(const lmb_volume *volume, uint32_t index)
{
    assert(volume && index < lmb_volume_local_set_count(volume));
    const lmb_volume_local *const local = &locals_list(volume)[index];
    const lmb_local_set set = {locals_names(volume) + local->name, local->node, local->place, frame_of(local)};
    return set;
}

void lmb_volume_local_set_light(const lmb_volume *volume, uint32_t index, lmb_sh3_rgb *radiance,
                                float (*visibility)[LMB_KEY_LIGHTS_MOST])
{
    assert(volume && index < lmb_volume_local_set_count(volume) && radiance);
    const lmb_volume_local *const local = &locals_list(volume)[index];
    const uint32_t count = local->size[0] * local->size[1] * local->size[2];
    const size_t stride = volume->header->probe_bytes;
    for (uint32_t i = 0; i < count; ++i) {
        const unsigned char *const probe = locals_probes(volume) + (local->probe_first + (size_t)i) * stride;
        lmb_volume_probe_read(volume, probe, &radiance[i], visibility ? visibility[i] : NULL);
    }
}
