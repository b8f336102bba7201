#version 450
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Inputs { uint inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { float outputs[]; };
layout(binding = 2) uniform sampler3D atlas; // its parts above each other

#define lmbAsFloat uintBitsToFloat
#include "volume_buffers.glsl"

uint lmbVolumeTextureWord(uint index)
{
    return lmbWord(index);
}

#ifdef LMB_VOLUME_TEXTURE_FETCH
vec4 lmbVolumeTexelFetch(uint part, uvec3 texel)
{
    return texelFetch(atlas, ivec3(texel) + ivec3(0, 0, int(part * inputs[22u])), 0);
}
#else
vec4 lmbVolumeTexel(uint part, vec3 at)
{
    return textureLod(atlas, (at + vec3(0.0, 0.0, float(part * inputs[22u]))) / vec3(textureSize(atlas, 0)), 0.0);
}
#endif

#include "lambent.glsl"
#include "lambent_volume_texture.glsl"
#include "volume_texture_cases.glsl"

void main()
{
    lmbItem(gl_GlobalInvocationID.x);
}
