/* Local sets in the run-time file. */
#include "pack_internal.h"

#include <lambent/local_set_format.h>
#include <lambent/probe_local.h>

#include <string.h>

static size_t name_bytes(const lmb_probes *probes)
{
    size_t bytes = 0;
    for (uint32_t i = 0; i < probes->local_count; ++i) {
        bytes += strlen(probes->local[i].name) + 1;
    }
    return (bytes + 3) / 4 * 4;
}

uint64_t lmb_pack_locals_bytes(const lmb_probes *probes, const lmb_volume_header *header)
{
    if (probes->local_count == 0) {
        return 0;
    }
    uint64_t bytes = sizeof(lmb_volume_locals) + probes->local_count * sizeof(lmb_volume_local) + name_bytes(probes);
    for (uint32_t i = 0; i < probes->local_count; ++i) {
        bytes += (uint64_t)lmb_local_frame_count(&probes->local[i].frame) * header->probe_bytes;
    }
    return bytes;
}

static lmb_volume_local describe(const lmb_probe_local *local, uint32_t name, uint32_t probe_first)
{
    const lmb_local_frame *const frame = &local->frame;
    lmb_volume_local entry = {.origin = {frame->origin.x, frame->origin.y, frame->origin.z},
                              .node = local->node,
                              .place = local->place,
                              .name = name,
                              .probe_first = probe_first};
    for (int axis = 0; axis < 3; ++axis) {
        memcpy(entry.step[axis], &frame->step[axis], sizeof entry.step[axis]);
        entry.size[axis] = frame->size[axis];
    }
    return entry;
}

void lmb_pack_locals_write(const lmb_probes *probes, const lmb_volume_header *header, unsigned char *to)
{
    if (probes->local_count == 0) {
        return;
    }
    const lmb_volume_locals head = {probes->local_count, (uint32_t)name_bytes(probes)};
    unsigned char *const entries = to + sizeof head;
    unsigned char *const names = entries + probes->local_count * sizeof(lmb_volume_local);
    unsigned char *probe = names + head.name_bytes;
    uint32_t name = 0, probe_first = 0;
    memcpy(to, &head, sizeof head);
    for (uint32_t i = 0; i < probes->local_count; ++i) {
        const lmb_probe_local *const local = &probes->local[i];
        const lmb_volume_local entry = describe(local, name, probe_first);
        const uint32_t count = lmb_local_frame_count(&local->frame);
        const size_t length = strlen(local->name) + 1;
        memcpy(entries + i * sizeof entry, &entry, sizeof entry);
        memcpy(names + name, local->name, length);
        for (uint32_t k = 0; k < count; ++k, probe += header->probe_bytes) {
            lmb_pack_probe_write(header, &local->radiance[k], local->key_visibility[k], probe);
        }
        name += (uint32_t)length;
        probe_first += count;
    }
}
