#include "lambent.hlsl"

[[vk::binding(0, 0)]] RWStructuredBuffer<uint> inputs : register(u0);
[[vk::binding(1, 0)]] RWStructuredBuffer<float> outputs : register(u1);

#define lmbAsFloat asfloat
#include "volume_buffers.glsl"

uint lmbVolumeWord(uint index)
{
    return lmbWord(index);
}

#include "lambent_sampling.glsl"
#define vec3 float3
#define uvec3 uint3
#include "volume_cases.glsl"

[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID)
{
    lmbItem(id.x);
}
