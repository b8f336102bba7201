// The constants, a count of positions and they, then the words; of each position 32 numbers.
LmbVolumeTexture volumeRead()
{
    LmbVolumeTexture v;
    v.origin = vec3(lmbFloat(0u), lmbFloat(1u), lmbFloat(2u));
    v.inverseSpacing = lmbFloat(3u);
    v.first = vec3(lmbFloat(4u), lmbFloat(5u), lmbFloat(6u));
    v.scale = lmbFloat(7u);
    v.last = vec3(lmbFloat(8u), lmbFloat(9u), lmbFloat(10u));
    v.slack = lmbFloat(11u);
    v.lastCell = uvec3(lmbInput(12u), lmbInput(13u), lmbInput(14u));
    v.keyLights = lmbInput(15u);
    v.entries = uvec3(lmbInput(16u), lmbInput(17u), lmbInput(18u));
    v.bands = lmbInput(19u);
    v.texels = uvec3(lmbInput(20u), lmbInput(21u), lmbInput(22u));
    v.parts = lmbInput(23u);
    v.tileY = lmbInput(24u);
    v.tileZ = lmbInput(25u);
    v.cells = lmbInput(26u);
    v.regionZ = lmbInput(27u);
    return v;
}

void lmbItem(uint item)
{
    uint count = lmbInput(28u);
    if (item >= count) {
        return;
    }
    LmbVolumeTexture v = volumeRead();
    LmbVolumeTexturePlace place;
    vec3 position = vec3(lmbFloat(32u + 3u * item), lmbFloat(33u + 3u * item), lmbFloat(34u + 3u * item));
    bool inside = lmbVolumeTextureFind(v, position, place);
    LmbVolumeTextureSample found = lmbVolumeTextureBlend(v, place);
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
