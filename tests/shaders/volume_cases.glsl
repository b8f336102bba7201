// The volume's constants, a count of positions and they, then the file's words; of each position 32 numbers.
LmbVolume volumeRead()
{
    LmbVolume v;
    v.origin = vec3(lmbFloat(0u), lmbFloat(1u), lmbFloat(2u));
    v.inverseSpacing = lmbFloat(3u);
    v.first = vec3(lmbFloat(4u), lmbFloat(5u), lmbFloat(6u));
    v.scale = lmbFloat(7u);
    v.last = vec3(lmbFloat(8u), lmbFloat(9u), lmbFloat(10u));
    v.keyLights = lmbInput(11u);
    v.lastCell = uvec3(lmbInput(12u), lmbInput(13u), lmbInput(14u));
    v.probeUnits = lmbInput(15u);
    v.entries = uvec3(lmbInput(16u), lmbInput(17u), lmbInput(18u));
    v.isCompact = lmbInput(19u);
    v.directory = lmbInput(20u);
    v.bricks = lmbInput(21u);
    v.probes = lmbInput(22u);
    v.cutOffsets = lmbInput(23u);
    v.cuts = lmbInput(24u);
    v.slack = lmbFloat(25u);
    v.padding0 = v.padding1 = 0u;
    return v;
}

#define LMB_VOLUME LmbVolume
#define LMB_PLACE LmbVolumePlace
#define LMB_FOUND LmbVolumeSample
#define LMB_FIND lmbVolumeFind
#define LMB_BLEND lmbVolumeBlend
#include "volume_item.glsl"
