// Lambent's run-time maths for HLSL (shader model 5 or newer): the .glsl files beside it, with HLSL's names.
#ifndef LAMBENT_HLSL
#define LAMBENT_HLSL

#define vec2 float2
#define vec3 float3
#define vec4 float4
#include "lambent.glsl"
#include "lambent_networks.glsl"
#include "lambent_probe.glsl"
#include "lambent_specular.glsl"
#include "lambent_rnm.glsl"
#undef vec3
#undef vec4
#undef vec2

#endif
