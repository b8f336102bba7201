// Radiosity normal mapping and self-shadowed bump maps for shaders: what rnm.h has, for GLSL and HLSL. Put lambent.glsl
// before it; lambent.hlsl has both.
#ifndef LAMBENT_RNM_GLSL
#define LAMBENT_RNM_GLSL

// What a lightmap texel stores, and the slopes in the world that it is of.
struct LmbRnm {
    vec3 light1;
    vec3 light2;
    vec3 light3;
};

struct LmbSlopes {
    vec3 b1;
    vec3 b2;
    vec3 b3;
};

// Of a tangent, a bitangent and a normal, unit and orthogonal (lmb_rnm_slopes_in_axes).
LmbSlopes lmbRnmSlopesInAxes(vec3 tangent, vec3 bitangent, vec3 nv)
{
    vec3 up = 0.57735026919 * nv;
    LmbSlopes slopes;
    slopes.b1 = 0.81649658093 * tangent + up;
    slopes.b2 = -0.40824829046 * tangent + 0.70710678119 * bitangent + up;
    slopes.b3 = -0.40824829046 * tangent - 0.70710678119 * bitangent + up;
    return slopes;
}

// Those that lightmaps are stored on (lmb_rnm_slopes).
LmbSlopes lmbRnmSlopes(vec3 nv)
{
    vec3 x = vec3(0.48, -0.6, 0.64);
    vec3 y = vec3(0.8, 0.0, -0.6);
    vec3 s = vec3(0.36, 0.8, 0.48) + nv;
    s += nv * (0.5 * dot(s, s) - dot(s, nv));
    float squared = dot(s, s);
    if (!(squared > 1.17549435e-38)) {
        return lmbRnmSlopesInAxes(x, -y, nv);
    }
    return lmbRnmSlopesInAxes(x - s * (2.0 * dot(x, s) / squared), y - s * (2.0 * dot(y, s) / squared), nv);
}

// Irradiance on n (lmb_rnm_evaluate).
vec3 lmbRnmEvaluate(LmbRnm rnm, LmbSlopes slopes, vec3 n)
{
    vec3 w = max(vec3(dot(n, slopes.b1), dot(n, slopes.b2), dot(n, slopes.b3)), vec3(0.0, 0.0, 0.0));
    w *= w;
    float total = w.x + w.y + w.z;
    if (!(total > 0.0)) {
        return vec3(0.0, 0.0, 0.0);
    }
    return lmbLight((w.x * rnm.light1 + w.y * rnm.light2 + w.z * rnm.light3) / total);
}

// The same by a texel of a self-shadowed bump map, whose axes the slopes are in (lmb_ssbump_evaluate).
vec3 lmbSsbumpEvaluate(LmbRnm rnm, vec3 weight)
{
    return lmbLight(weight.x * rnm.light1 + weight.y * rnm.light2 + weight.z * rnm.light3);
}

#endif
