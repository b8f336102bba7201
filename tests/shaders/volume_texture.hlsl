#include "lambent.hlsl"

[[vk::binding(0, 0)]] RWStructuredBuffer<uint> inputs : register(u0);
[[vk::binding(1, 0)]] RWStructuredBuffer<float> outputs : register(u1);
[[vk::binding(2, 0)]] Texture3D<float4> atlas : register(t2); // its parts above each other
[[vk::binding(2, 0)]] SamplerState filter : register(s2);

#define lmbAsFloat asfloat
#include "volume_buffers.glsl"

uint lmbVolumeTextureWord(uint index)
{
    return lmbWord(index);
}

#ifdef LMB_VOLUME_TEXTURE_FETCH
float4 lmbVolumeTexelFetch(uint part, uint3 texel)
{
    return atlas.Load(int4(texel.x, texel.y, texel.z + part * inputs[22u], 0));
}
#else
float4 lmbVolumeTexel(uint part, float3 at)
{
    float3 size = float3(inputs[20u], inputs[21u], inputs[22u] * inputs[23u]);
    return atlas.SampleLevel(filter, (at + float3(0.0, 0.0, float(part * inputs[22u]))) / size, 0.0);
}
#endif

#include "lambent_volume_texture.glsl"
#define vec3 float3
#define uvec3 uint3
#include "volume_texture_cases.glsl"

[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID)
{
    lmbItem(id.x);
}
