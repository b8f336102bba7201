#version 450
#extension GL_GOOGLE_include_directive : require

#include "lambent.glsl"
#include "lambent_networks.glsl"
#include "lambent_probe.glsl"
#include "lambent_specular.glsl"
#include "lambent_rnm.glsl"

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Inputs { float inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { float outputs[]; };

float lmbRead(uint index)
{
    return inputs[index];
}

void lmbWrite(uint index, float value)
{
    outputs[index] = value;
}

#include "cases.glsl"

void main()
{
    lmbItem(gl_GlobalInvocationID.x);
}
