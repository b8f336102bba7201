// Lambent's run-time maths for HLSL (shader model 5 or newer): lambent.glsl, which lies beside it, with HLSL's names.
#ifndef LAMBENT_HLSL
#define LAMBENT_HLSL

#define vec3 float3
#include "lambent.glsl"
#undef vec3

#endif
