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

#define LMB_VOLUME LmbVolumeTexture
#define LMB_PLACE LmbVolumeTexturePlace
#define LMB_FOUND LmbVolumeTextureSample
#define LMB_FIND lmbVolumeTextureFind
#define LMB_BLEND lmbVolumeTextureBlend
#include "volume_item.glsl"
