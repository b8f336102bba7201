// Lambent's run-time maths for shaders: what sampler/ computes, in the same order, for all three channels at once.
//
// GLSL 4.2 or newer, or ESSL 3.0; lambent.hlsl makes HLSL of the same text. Include it, or paste it: it needs no
// extension, reads no texture and has no state. sh.h, hhd.h, hlsh.h and occlusion.h say what each function means; here
// stands how it is called.
//
// Spherical harmonics are real and orthonormal WITH the Condon-Shortley signs, in world space (right-handed, +Y up), and
// hold radiance, a colour for each of nine coefficients in the order 00 | 1-1 10 11 | 2-2 2-1 20 21 22: probes as
// lmb_volume_sample returns them. Irradiance is normalised (E/pi): multiply by the albedo. nv is the surface's (vertex)
// normal, n the shading normal, both of unit length. coneCos is the cosine of a visibility cone's half angle about nv; 0
// is the whole hemisphere. No input that is finite gives NaN, infinity or negative light.

#ifndef LAMBENT_GLSL
#define LAMBENT_GLSL

#define LMB_FLT_MAX 3.402823466e38
#define LMB_IRRADZ_MIN_COS 0.05

struct LmbSh3 {
    vec3 c[9];
};

// A hemisphere light and a directional one: C_a (1 + nv.n)/2 + C_d max(0, n.d).
struct LmbHhd {
    vec3 ambient;
    vec3 directional;
    vec3 direction;
};

// What a lightmap texel stores. Filter each member, and decode what that gives as it is: the length of the direction
// counts.
struct LmbIrradz {
    vec3 irradianceZ;
    float ambientWeight;
    vec3 direction;
};

// A sun that the harmonics and the lightmap leave out: a unit vector towards it, and what it gives a surface that faces
// it and sees all of it, as lmb_volume_key_lights and lightmap.json have them.
struct LmbKeyLight {
    vec3 direction;
    vec3 irradiance;
};

// I_z t + C_a (1 - t) + c.n_perp, t = n.nv; tangentialX holds the x of c for red, green and blue, and so on.
struct LmbHlsh {
    vec3 irradianceZ;
    vec3 ambient;
    vec3 tangentialX;
    vec3 tangentialY;
    vec3 tangentialZ;
};

// A vector for each channel, by components.
struct LmbVectors {
    vec3 x;
    vec3 y;
    vec3 z;
};

float lmbSaturate(float a)
{
    return min(max(a, 0.0), 1.0);
}

// Light fit for a shader: in [0, FLT_MAX].
float lmbLight1(float light)
{
    return light > 0.0 ? min(light, LMB_FLT_MAX) : 0.0;
}

vec3 lmbLight(vec3 light)
{
    return vec3(lmbLight1(light.x), lmbLight1(light.y), lmbLight1(light.z));
}

float lmbLuminance(vec3 colour)
{
    return 0.2126 * colour.x + 0.7152 * colour.y + 0.0722 * colour.z;
}

// a / |a|, or the fallback where it has no direction. Scaled first, so that squares neither overflow nor vanish.
vec3 lmbUnitOr(vec3 a, vec3 fallback)
{
    float largest = max(abs(a.x), max(abs(a.y), abs(a.z)));
    if (!(largest > 0.0 && largest <= LMB_FLT_MAX)) {
        return fallback;
    }
    // In two steps: 1 / largest may overflow.
    vec3 scaled = a / largest;
    return scaled / length(scaled);
}

vec3 lmbPerpendicular(vec3 a, vec3 axis)
{
    vec3 once = a - axis * dot(a, axis);
    return once - axis * dot(once, axis);
}

vec3 lmbVectorsDot(LmbVectors a, vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// a + axis s
LmbVectors lmbVectorsAddAxis(LmbVectors a, vec3 axis, vec3 s)
{
    LmbVectors sum;
    sum.x = a.x + axis.x * s;
    sum.y = a.y + axis.y * s;
    sum.z = a.z + axis.z * s;
    return sum;
}

LmbVectors lmbVectorsScale(LmbVectors a, float s)
{
    LmbVectors scaled;
    scaled.x = a.x * s;
    scaled.y = a.y * s;
    scaled.z = a.z * s;
    return scaled;
}

LmbVectors lmbVectorsAdd(LmbVectors a, LmbVectors b)
{
    LmbVectors sum;
    sum.x = a.x + b.x;
    sum.y = a.y + b.y;
    sum.z = a.z + b.z;
    return sum;
}

// ---------------------------------------------------------------------------------------------- spherical harmonics

// Irradiance on n from the whole sphere, without occlusion (lmb_sh3_rgb_irradiance).
vec3 lmbSh3Irradiance(LmbSh3 sh, vec3 n)
{
    vec3 sum = 0.28209479177 * sh.c[0];
    sum += 0.66666666667 * 0.4886025119 * (n.z * sh.c[2] - n.y * sh.c[1] - n.x * sh.c[3]);
    sum += 0.25 * 1.0925484306 * (n.x * n.y * sh.c[4] - n.y * n.z * sh.c[5] - n.x * n.z * sh.c[7]);
    sum += 0.25 * (0.31539156525 * (3.0 * n.z * n.z - 1.0) * sh.c[6] +
                   0.5462742153 * (n.x * n.x - n.y * n.y) * sh.c[8]);
    return lmbLight(sum);
}

// The same of linear SH, the first four coefficients, as lightmaps of that model store it (lmb_sh2_rgb_irradiance).
vec3 lmbSh2Irradiance(vec3 c0, vec3 c1, vec3 c2, vec3 c3, vec3 n)
{
    return lmbLight(0.28209479177 * c0 + 0.66666666667 * 0.4886025119 * (n.z * c2 - n.y * c1 - n.x * c3));
}

// The parts of an SH3 that a cone about an axis turns into linear SH (docs/maths.md).
struct LmbAxial {
    vec3 l0;
    vec3 l1Zonal;
    vec3 l2Zonal;
    LmbVectors l1Tangential;
    LmbVectors l2Tangential;
};

LmbAxial lmbSh3AboutAxis(LmbSh3 sh, vec3 axis)
{
    LmbVectors v;
    v.x = -sh.c[3];
    v.y = -sh.c[1];
    v.z = sh.c[2];
    vec3 zonal = 0.31539156525 * sh.c[6];
    vec3 sectoral = 0.5462742153 * sh.c[8];
    vec3 xy = 0.5462742153 * sh.c[4];
    vec3 yz = -0.5462742153 * sh.c[5];
    vec3 xz = -0.5462742153 * sh.c[7];
    LmbVectors m;
    m.x = (sectoral - zonal) * axis.x + xy * axis.y + xz * axis.z;
    m.y = xy * axis.x - (zonal + sectoral) * axis.y + yz * axis.z;
    m.z = xz * axis.x + yz * axis.y + 2.0 * zonal * axis.z;
    LmbAxial l;
    l.l0 = sh.c[0];
    l.l1Zonal = lmbVectorsDot(v, axis);
    vec3 mZonal = lmbVectorsDot(m, axis);
    l.l2Zonal = mZonal * 1.5853309190; // 1 / (2 N20)
    l.l1Tangential = lmbVectorsAddAxis(v, axis, -l.l1Zonal);
    l.l2Tangential = lmbVectorsScale(lmbVectorsAddAxis(m, axis, -mZonal), 1.8305824657); // 2 / N2
    return l;
}

// -------------------------------------------------------------------------------------------------------- occlusion

// Of a cosine-weighted visibility, which ambient occlusion gives (lmb_cone_cos_from_visibility).
float lmbConeCosFromVisibility(float visibility)
{
    return sqrt(1.0 - lmbSaturate(visibility));
}

// Of a bent cone wholly above the horizon (lmb_cone_cos_from_bent_visibility).
float lmbConeCosFromBentVisibility(float visibility, float axisDotNormal)
{
    return sqrt(1.0 - lmbSaturate(visibility / axisDotNormal));
}

// Normalised moments of the light inside a cone about an axis, b_c and the vector b (lmb_sh3_multiply_cone,
// lmb_moments_from_sh2).
struct LmbMoments {
    vec3 bc;
    LmbVectors b;
};

LmbMoments lmbMomentsInCone(LmbSh3 sh, vec3 axis, float coneCos)
{
    float c = lmbSaturate(coneCos);
    float cc = c * c;
    float closing = 1.0 - c;
    float sineSquared = closing * (1.0 + c);
    LmbAxial l = lmbSh3AboutAxis(sh, axis);
    float g0010 = 0.43301270189 * sineSquared;
    vec3 zonal0 = 0.5 * closing * l.l0 + g0010 * l.l1Zonal + 0.55901699437 * c * sineSquared * l.l2Zonal;
    vec3 zonal1 = g0010 * l.l0 + 0.5 * closing * (1.0 + c + cc) * l.l1Zonal +
                  0.24206145914 * sineSquared * (1.0 + 3.0 * cc) * l.l2Zonal;
    LmbVectors tangential = lmbVectorsAdd(lmbVectorsScale(l.l1Tangential, 0.25 * closing * closing * (2.0 + c)),
                                          lmbVectorsScale(l.l2Tangential, 0.41926274578 * sineSquared * sineSquared));
    LmbMoments moments;
    moments.bc = zonal0 * 1.1283791671; // 2 / sqrt(pi)
    moments.b = lmbVectorsScale(lmbVectorsAddAxis(tangential, axis, zonal1), 0.65147001587); // 2 / sqrt(3 pi)
    return moments;
}

// --------------------------------------------------------------------------------------------------- HHD and IrradZ

struct LmbHhd1 {
    float ambient;
    float directional;
    vec3 direction;
};

// The light that has these moments, of one channel (lmb_hhd_solve).
LmbHhd1 lmbHhdSolve(float scalar, vec3 dipole, vec3 nv)
{
    LmbHhd1 hhd;
    hhd.ambient = 0.0;
    hhd.directional = 0.0;
    hhd.direction = nv;
    if (!(scalar > 0.0)) {
        return hhd;
    }
    float scale = max(max(scalar, abs(dipole.x)), max(abs(dipole.y), abs(dipole.z)));
    float bc = scalar / scale;
    vec3 b = dipole / scale;
    float iz = max(dot(b, nv), 0.0);
    vec3 bPerp = lmbPerpendicular(b, nv);
    float pSquared = dot(bPerp, bPerp);
    if (!(pSquared > 1.4210854715e-14)) { // FLT_EPSILON squared: the rounding of b
        bPerp = vec3(0.0, 0.0, 0.0);
        pSquared = 0.0;
    }
    float p = sqrt(pSquared);
    float x = bc - 2.0 * iz;
    float ambient;
    float directional;
    float height;
    if (pSquared + iz * iz > bc * bc) {
        ambient = 0.0;
        directional = sqrt(pSquared + iz * iz);
        height = iz;
    } else if (p < x) {
        ambient = iz;
        directional = p;
        height = 0.0;
    } else {
        float root = sqrt(x * x + 3.0 * pSquared);
        directional = (2.0 * root - x) / 3.0;
        ambient = max(0.5 * (bc - directional), 0.0);
        height = max((root - 2.0 * x) / 3.0, 0.0);
    }
    hhd.ambient = lmbLight1(ambient * scale);
    hhd.directional = lmbLight1(directional * scale);
    hhd.direction = lmbUnitOr(bPerp + nv * height, nv);
    return hhd;
}

// Unit d, tilted up until nv.d is LMB_IRRADZ_MIN_COS.
vec3 lmbTiltedAboveHorizon(vec3 d, vec3 nv)
{
    if (dot(d, nv) >= LMB_IRRADZ_MIN_COS) {
        return d;
    }
    vec3 flat_ = lmbUnitOr(lmbPerpendicular(d, nv), vec3(0.0, 0.0, 0.0));
    return lmbUnitOr(flat_ * sqrt(1.0 - LMB_IRRADZ_MIN_COS * LMB_IRRADZ_MIN_COS) + nv * LMB_IRRADZ_MIN_COS, nv);
}

LmbIrradz lmbIrradzOfMoments(LmbMoments moments, vec3 nv)
{
    LmbIrradz irradz;
    irradz.irradianceZ = lmbLight(lmbVectorsDot(moments.b, nv));
    vec3 b = vec3(lmbLuminance(moments.b.x), lmbLuminance(moments.b.y), lmbLuminance(moments.b.z));
    LmbHhd1 hhd = lmbHhdSolve(lmbLuminance(moments.bc), b, nv);
    irradz.direction = lmbTiltedAboveHorizon(hhd.direction, nv);
    irradz.ambientWeight = 1.0;
    if (hhd.directional > 0.0) {
        float iz = hhd.ambient + hhd.directional * max(dot(hhd.direction, nv), 0.0);
        float ratio = hhd.directional / iz * dot(irradz.direction, nv);
        irradz.ambientWeight = ratio < 1.0 ? 1.0 - ratio : 0.0;
    }
    return irradz;
}

// What a lightmap would store of that light, by the Gram multiply (lmb_irradz_encode). Nearer to the truth from a probe is
// lmbIrradzFromProbe of lambent_probe.glsl.
LmbIrradz lmbIrradzEncode(LmbSh3 sh, vec3 nv, float coneCos)
{
    return lmbIrradzOfMoments(lmbMomentsInCone(sh, nv, coneCos), nv);
}

// A texel, filtered or not, as a light (lmb_irradz_decode).
// The direction of a compressed texel, from its filtered point of the disc, -1 to 1 (lmb_disc_to_direction):
//     irradz.direction = lmbDiscToDirection(2.0 * texture(direction, uv).xy - 1.0, nv);
vec3 lmbDiscToDirection(vec2 p, vec3 nv)
{
    vec3 axis = vec3(-0.36, 0.8, -0.48);
    vec3 across = vec3(-0.8, 0.0, 0.6) * p.x + vec3(0.48, 0.6, 0.64) * p.y;
    vec3 turned = across - (axis + nv) * (dot(nv, across) / max(1.0 + dot(axis, nv), 1e-6));
    float height = max(1.0 - dot(p, p), LMB_IRRADZ_MIN_COS);
    return nv * height + turned * sqrt(1.0 + height);
}

LmbHhd lmbIrradzDecode(LmbIrradz irradz, vec3 nv)
{
    float w = lmbSaturate(irradz.ambientWeight);
    float agreed = lmbSaturate(dot(irradz.direction, nv) / LMB_IRRADZ_MIN_COS);
    float directional = (1.0 - w) * agreed * agreed;
    float ambient = w + (1.0 - w) * (1.0 - agreed * agreed);
    LmbHhd hhd;
    hhd.direction = lmbTiltedAboveHorizon(lmbUnitOr(irradz.direction, nv), nv);
    vec3 iz = lmbLight(irradz.irradianceZ);
    hhd.ambient = ambient * iz;
    hhd.directional = lmbLight(directional * iz / max(dot(hhd.direction, nv), LMB_IRRADZ_MIN_COS));
    return hhd;
}

// Irradiance on n (lmb_hhd_rgb_evaluate).
vec3 lmbHhdEvaluate(LmbHhd hhd, vec3 nv, vec3 n)
{
    return lmbLight(hhd.ambient * (0.5 + 0.5 * dot(nv, n)) + hhd.directional * max(dot(n, hhd.direction), 0.0));
}

// Both at once, for one normal a texel, without a root (lmb_irradz_evaluate).
vec3 lmbIrradzEvaluate(LmbIrradz irradz, vec3 nv, vec3 n)
{
    float height = dot(irradz.direction, nv);
    if (!(height >= LMB_IRRADZ_MIN_COS && height < 2.0)) {
        return lmbHhdEvaluate(lmbIrradzDecode(irradz, nv), nv, n);
    }
    float directional = 1.0 - lmbSaturate(irradz.ambientWeight);
    float hemisphere = 0.5 + 0.5 * dot(nv, n);
    float highlight = max(dot(n, irradz.direction), 0.0) / height;
    return lmbLight((hemisphere + directional * (highlight - hemisphere)) * irradz.irradianceZ);
}

// --------------------------------------------------------------------------------------------------------------- HLSH

// lmb_hlsh_rgb_from_sh3
LmbHlsh lmbHlshFromSh3(LmbSh3 sh, vec3 nv, float coneCos)
{
    float c = lmbSaturate(coneCos);
    float closing = 1.0 - c;
    float sineSquared = closing * (1.0 + c);
    LmbAxial l = lmbSh3AboutAxis(sh, nv);
    LmbHlsh hlsh;
    hlsh.irradianceZ = 0.28209479177 * sineSquared * l.l0 + 0.32573500794 * closing * (1.0 + c * (1.0 + c)) * l.l1Zonal +
                       0.15769578263 * sineSquared * (1.0 + 3.0 * c * c) * l.l2Zonal;
    hlsh.ambient = 0.0022038655607 * closing * (64.0 - c * (47.0 + c * 15.0)) * l.l0 +
                   0.00031810059369 * closing * (275.0 + c * (275.0 - c * (391.0 + c * 135.0))) * l.l1Zonal +
                   0.0024639966035 * closing * (-28.0 + c * (83.0 + c * (51.0 - c * (75.0 + c * 27.0)))) * l.l2Zonal;
    LmbVectors tangential = lmbVectorsAdd(
        lmbVectorsScale(l.l1Tangential, 0.00031810059369 * closing * closing * (647.0 + c * (526.0 + c * 135.0))),
        lmbVectorsScale(l.l2Tangential,
                        0.0085355346140 * closing * closing * (22.0 + c * (44.0 + c * (34.0 + c * 9.0)))));
    hlsh.tangentialX = tangential.x;
    hlsh.tangentialY = tangential.y;
    hlsh.tangentialZ = tangential.z;
    return hlsh;
}

// Irradiance on n (lmb_hlsh_rgb_evaluate).
vec3 lmbHlshEvaluate(LmbHlsh hlsh, vec3 nv, vec3 n)
{
    float t = dot(n, nv);
    return lmbLight(hlsh.irradianceZ * t + hlsh.ambient * (1.0 - t) + hlsh.tangentialX * n.x + hlsh.tangentialY * n.y +
                    hlsh.tangentialZ * n.z);
}

// Irradiance on n that a key light adds to any of the above; visibility is the share of it that is seen
// (lmb_key_light_irradiance).
vec3 lmbKeyLightIrradiance(LmbKeyLight light, float visibility, vec3 nv, vec3 n)
{
    float faced = dot(nv, light.direction) > 0.0 ? visibility : 0.0;
    return lmbLight(light.irradiance * (max(dot(n, light.direction), 0.0) * faced));
}

// Light that the surface reflects onto its own bumps (lmb_self_bounce).
vec3 lmbSelfBounce(vec3 albedo, vec3 irradianceZ, vec3 nv, vec3 n)
{
    return lmbLight(albedo * irradianceZ * (0.5 - 0.5 * dot(nv, n)));
}

#endif
