#version 450
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Inputs { uint inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { float outputs[]; };

#define lmbAsFloat uintBitsToFloat
#include "volume_buffers.glsl"

uint lmbVolumeWord(uint index)
{
    return lmbWord(index);
}

#include "lambent.glsl"
#include "lambent_sampling.glsl"
#include "volume_cases.glsl"

void main()
{
    lmbItem(gl_GlobalInvocationID.x);
}
