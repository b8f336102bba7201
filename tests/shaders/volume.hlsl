#include "lambent.hlsl"

[[vk::binding(0, 0)]] RWStructuredBuffer<uint> inputs : register(u0);
[[vk::binding(1, 0)]] RWStructuredBuffer<float> outputs : register(u1);

uint lmbInput(uint index)
{
    return inputs[index];
}

float lmbFloat(uint index)
{
    return asfloat(inputs[index]);
}

void lmbWrite(uint index, float value)
{
    outputs[index] = value;
}

uint lmbVolumeWord(uint index)
{
    return inputs[32u + 3u * inputs[28u] + index];
}

#include "lambent_sampling.glsl"
#define vec3 float3
#define uvec3 uint3
#include "volume_cases.glsl"

[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID)
{
    lmbItem(id.x);
}
