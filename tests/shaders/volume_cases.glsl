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

void lmbItem(uint item)
{
    uint count = lmbInput(28u);
    if (item >= count) {
        return;
    }
    LmbVolume v = volumeRead();
    LmbVolumePlace place;
    vec3 position = vec3(lmbFloat(32u + 3u * item), lmbFloat(33u + 3u * item), lmbFloat(34u + 3u * item));
    bool inside = lmbVolumeFind(v, position, place);
    LmbVolumeSample found = lmbVolumeBlend(v, place);
    lmbWrite(32u * item, inside ? 1.0 : 0.0);
    for (uint k = 0u; k < 9u; ++k) {
        lmbWrite(32u * item + 1u + k, found.radiance.c[k].x);
        lmbWrite(32u * item + 10u + k, found.radiance.c[k].y);
        lmbWrite(32u * item + 19u + k, found.radiance.c[k].z);
    }
    for (uint key = 0u; key < 4u; ++key) {
        lmbWrite(32u * item + 28u + key, found.visibility[key]);
    }
}
