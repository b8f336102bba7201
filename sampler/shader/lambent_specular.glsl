// Specular reflection of harmonics and key lights (lambent/specular.h says what each function means), for GLSL and HLSL.
// Include it behind lambent.glsl. The lobes are in three textures of the game's, which lmb_specular_textures fills: with
// linear filtering and clamped edges, an LmbSpecularLobe is their three texels at lmbSpecularCoordinates.
//
// view is a unit vector towards the eye, f0 the reflectance along the normal, roughness the root mean square of the
// facets' slopes.

#ifndef LAMBENT_SPECULAR_GLSL
#define LAMBENT_SPECULAR_GLSL

// C and D of the harmonics 00, 10, 11, 20, and of 21 and 22 (docs/maths.md).
struct LmbSpecularLobe {
    vec4 constant0236;
    vec4 schlick0236;
    vec4 both78; // C of 21, 22, then D
};

// Where that is in the textures: across by the view, down by the roughness.
vec2 lmbSpecularCoordinates(float roughness, vec3 n, vec3 view)
{
    float c = lmbSaturate(dot(n, view));
    return vec2((0.5 + 3.5 * (c + sqrt(c))) / 8.0, (0.5 + 15.0 * sqrt(lmbSaturate(roughness))) / 16.0);
}

// The area layer, not below a share of what the mean radiance gives.
vec3 lmbSpecularAtLeast(LmbSh3 sh, LmbSpecularLobe lobe, vec3 f0, vec3 n, vec3 view, float leastShare)
{
    LmbVectors v;
    v.x = -sh.c[3];
    v.y = -sh.c[1];
    v.z = sh.c[2];
    vec3 aside = view - n * dot(n, view);
    // n^T M n, aside^T M n and aside^T M aside by products of components.
    vec3 zonal = 0.31539156525 * sh.c[6];
    vec3 sectoral = 0.5462742153 * sh.c[8];
    vec3 xx = sectoral - zonal;
    vec3 yy = -sectoral - zonal;
    vec3 nn = xx * (n.x * n.x) + yy * (n.y * n.y) + 2.0 * zonal * (n.z * n.z) +
              1.0925484306 * (sh.c[4] * (n.x * n.y) - sh.c[5] * (n.y * n.z) - sh.c[7] * (n.x * n.z));
    vec3 an = xx * (aside.x * n.x) + yy * (aside.y * n.y) + 2.0 * zonal * (aside.z * n.z) +
              0.5462742153 * (sh.c[4] * (aside.x * n.y + aside.y * n.x) - sh.c[5] * (aside.y * n.z + aside.z * n.y) -
                              sh.c[7] * (aside.x * n.z + aside.z * n.x));
    vec3 aa = xx * (aside.x * aside.x) + yy * (aside.y * aside.y) + 2.0 * zonal * (aside.z * aside.z) +
              1.0925484306 *
                  (sh.c[4] * (aside.x * aside.y) - sh.c[5] * (aside.y * aside.z) - sh.c[7] * (aside.x * aside.z));
    vec3 l1 = lmbVectorsDot(v, n);
    vec3 l3 = -lmbVectorsDot(v, aside);
    vec3 l6 = 1.5853309190 * nn;                                  // 1 / (2 N20)
    vec3 l7 = -1.8305824657 * an;                                 // 2 / N2
    vec3 l8 = 0.91529123286 * (2.0 * aa + dot(aside, aside) * nn); // 1 / (2 N22)
    vec3 constant = lobe.constant0236.x * sh.c[0] + lobe.constant0236.y * l1 + lobe.constant0236.z * l3 +
                    lobe.constant0236.w * l6 + lobe.both78.x * l7 + lobe.both78.y * l8;
    vec3 schlick = lobe.schlick0236.x * sh.c[0] + lobe.schlick0236.y * l1 + lobe.schlick0236.z * l3 +
                   lobe.schlick0236.w * l6 + lobe.both78.z * l7 + lobe.both78.w * l8;
    vec3 rest = vec3(1.0, 1.0, 1.0) - f0;
    vec3 mean = (f0 * lobe.constant0236.x + rest * lobe.schlick0236.x) * sh.c[0];
    return lmbLight(max(f0 * constant + rest * schlick, leastShare * mean));
}

// Radiance of the reflection of harmonics (lmb_specular_area).
vec3 lmbSpecularArea(LmbSh3 sh, LmbSpecularLobe lobe, vec3 f0, vec3 n, vec3 view)
{
    return lmbSpecularAtLeast(sh, lobe, f0, n, view, 0.0);
}

// The same by an environment map's texel in the mirrored direction (lmb_specular_environment), which is at the level
// lmbSpecularLevel of a map that `lambent cube` wrote.
vec3 lmbSpecularEnvironment(vec3 map, LmbSh3 sh, LmbSpecularLobe lobe, vec3 f0, vec3 n, vec3 view)
{
    return lmbLight(map * lmbSpecularAtLeast(sh, lobe, f0, n, view, 0.5));
}

// How far along a ray a coordinate meets the side of a box that it goes towards.
float lmbSideDistance(float position, float direction, float low, float high)
{
    return direction > 0.0 ? (high - position) / direction : (direction < 0.0 ? (low - position) / direction : 3.4e38);
}

// The direction in which a map at mapPosition has what a surface sees along its mirrored view, by the map's box
// (lmb_specular_proxy_direction): look the map up in it.
vec3 lmbSpecularProxyDirection(vec3 mapPosition, vec3 low, vec3 high, vec3 position, vec3 mirrored)
{
    vec3 inside = max(min(position, high), low);
    float along = min(lmbSideDistance(inside.x, mirrored.x, low.x, high.x),
                      min(lmbSideDistance(inside.y, mirrored.y, low.y, high.y),
                          lmbSideDistance(inside.z, mirrored.z, low.z, high.z)));
    return lmbUnitOr(inside - mapPosition + along * mirrored, mirrored);
}

float lmbSpecularLevel(float roughness)
{
    return log2(max(roughness, 0.05) / 0.05);
}

// What harmonics say of a direction (lmb_sh3_evaluate): a plain sum, negative where they ring.
vec3 lmbSh3Evaluate(LmbSh3 sh, vec3 d)
{
    return 0.28209479177 * sh.c[0] + 0.4886025119 * (d.z * sh.c[2] - d.y * sh.c[1] - d.x * sh.c[3]) +
           1.0925484306 * (d.x * d.y * sh.c[4] - d.y * d.z * sh.c[5] - d.x * d.z * sh.c[7]) +
           0.31539156525 * (3.0 * d.z * d.z - 1.0) * sh.c[6] + 0.5462742153 * (d.x * d.x - d.y * d.y) * sh.c[8];
}

// The area layer by Phong's lobe, without textures (lmb_specular_area_phong).
vec3 lmbSpecularAreaPhong(LmbSh3 sh, float roughness, vec3 f0, vec3 n, vec3 view)
{
    float m = lmbSaturate(roughness);
    float s = m * m;
    float linearShare = (1.0 + s * (2.217397 + s * 0.358538)) / (1.0 + s * (2.715846 + s * 1.002374));
    float quadraticShare = (1.0 + s * (1.917728 - s * 0.474775)) / (1.0 + s * (3.412533 + s * 1.778441));
    for (int i = 1; i < 9; ++i) {
        sh.c[i] *= i < 4 ? linearShare : quadraticShare;
    }
    float beside = 1.0 - lmbSaturate(dot(n, view));
    float schlick = beside * beside * beside * beside * beside;
    vec3 fresnel = f0 + (vec3(1.0, 1.0, 1.0) - f0) * schlick;
    return lmbLight(fresnel * lmbSh3Evaluate(sh, 2.0 * dot(n, view) * n - view));
}

// The directional light that is nearest to harmonics (lmb_sh3_rgb_dominant_light).
LmbKeyLight lmbDominantLight(LmbSh3 sh)
{
    LmbKeyLight dominant;
    vec3 d = vec3(-lmbLuminance(sh.c[3]), -lmbLuminance(sh.c[1]), lmbLuminance(sh.c[2]));
    bool hasDirection = dot(d, d) > 0.0;
    d = lmbUnitOr(d, vec3(0.0, 1.0, 0.0));
    vec3 sum = lmbSh3Evaluate(sh, d);
    dominant.direction = d;
    dominant.irradiance = hasDirection ? lmbLight(sum * 0.44444444444) : vec3(0.0, 0.0, 0.0);
    return dominant;
}

// How much of a lamp is seen whose direct light is in the harmonics (lmb_sh3_rgb_light_visibility). Its highlight is
// lmbSpecularLight with that; scaled by it, lmbWithoutLight takes it out of them.
float lmbLightVisibility(LmbSh3 sh, LmbKeyLight light)
{
    vec3 d = light.direction;
    vec3 sum = lmbSh3Evaluate(sh, d);
    return lmbSaturate(lmbLuminance(sum) * 0.44444444444 / max(lmbLuminance(light.irradiance), 1.1754944e-38));
}

// What harmonics hold without that light: lmb_key_light_add_to_sh3 with -1.
LmbSh3 lmbWithoutLight(LmbSh3 sh, LmbKeyLight light)
{
    vec3 d = light.direction;
    vec3 e = -3.14159265359 * light.irradiance;
    sh.c[0] += 0.28209479177 * e;
    sh.c[1] += -0.4886025119 * d.y * e;
    sh.c[2] += 0.4886025119 * d.z * e;
    sh.c[3] += -0.4886025119 * d.x * e;
    sh.c[4] += 1.0925484306 * d.x * d.y * e;
    sh.c[5] += -1.0925484306 * d.y * d.z * e;
    sh.c[6] += 0.31539156525 * (3.0 * d.z * d.z - 1.0) * e;
    sh.c[7] += -1.0925484306 * d.x * d.z * e;
    sh.c[8] += 0.5462742153 * (d.x * d.x - d.y * d.y) * e;
    return sh;
}

float lmbFresnel1(float f0, float cosine)
{
    float root = sqrt(lmbSaturate(f0));
    if (!(root < 0.9999)) {
        return 1.0;
    }
    float c = lmbSaturate(cosine);
    float index = (1.0 + root) / (1.0 - root);
    float g = sqrt(max(index * index + c * c - 1.0, 0.0));
    if (!(g > 0.0)) {
        return 0.0;
    }
    float across = (g - c) / (g + c);
    float along = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * across * across * (1.0 + along * along);
}

// Radiance of one light's highlight (lmb_specular_light). With the dominant light of a probe, visibility is 1.
vec3 lmbSpecularLight(LmbKeyLight light, float visibility, float roughness, vec3 f0, vec3 nv, vec3 n, vec3 view)
{
    float nl = dot(n, light.direction);
    vec3 h = lmbUnitOr(view + light.direction, n);
    float up = dot(n, h);
    float along = dot(view, h);
    if (!(dot(nv, light.direction) > 0.0 && nl > 0.0 && up > 0.0 && along > 0.0)) {
        return vec3(0.0, 0.0, 0.0);
    }
    float m = max(lmbSaturate(roughness), 0.02);
    float nview = lmbSaturate(dot(n, view));
    float up2 = up * up;
    float distribution = exp(-max(1.0 - up2, 0.0) / (up2 * m * m)) / (m * m * up2 * up2);
    float twice = 2.0 * up / along;
    float masked = min(twice * nview, min(twice * nl, 1.0));
    float arrives = nview > 1e-6 ? masked / nview : twice;
    vec3 fresnel = vec3(lmbFresnel1(f0.x, along), lmbFresnel1(f0.y, along), lmbFresnel1(f0.z, along));
    return lmbLight(light.irradiance * fresnel * (0.25 * distribution * arrives * visibility));
}

// The same with Phong's lobe (lmb_specular_light_phong).
vec3 lmbSpecularLightPhong(LmbKeyLight light, float visibility, float roughness, vec3 f0, vec3 nv, vec3 n, vec3 view)
{
    vec3 h = lmbUnitOr(view + light.direction, n);
    float along = dot(view, h);
    float cosine = 2.0 * dot(n, view) * dot(n, light.direction) - dot(view, light.direction);
    if (!(dot(nv, light.direction) > 0.0 && dot(n, light.direction) > 0.0 && dot(n, h) > 0.0 && along > 0.0 &&
          cosine > 0.0)) {
        return vec3(0.0, 0.0, 0.0);
    }
    float m = max(lmbSaturate(roughness), 0.02);
    float cosine2 = cosine * cosine;
    float lobe = exp(-max(1.0 - cosine2, 0.0) / (cosine2 * m * m)) / (m * m * cosine2 * cosine);
    vec3 fresnel = vec3(lmbFresnel1(f0.x, along), lmbFresnel1(f0.y, along), lmbFresnel1(f0.z, along));
    return lmbLight(light.irradiance * fresnel * (lobe * visibility));
}

#endif
