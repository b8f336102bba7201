#include "lambent.hlsl"

[[vk::binding(0, 0)]] RWStructuredBuffer<float> inputs : register(u0);
[[vk::binding(1, 0)]] RWStructuredBuffer<float> outputs : register(u1);

float lmbRead(uint index)
{
    return inputs[index];
}

void lmbWrite(uint index, float value)
{
    outputs[index] = value;
}

#define vec2 float2
#define vec3 float3
#define vec4 float4
#include "cases.glsl"

[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID)
{
    lmbItem(id.x);
}
