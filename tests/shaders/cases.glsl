// Runs the shader include on one item: reads INPUTS numbers, writes OUTPUTS (tests/test_shader.c has both lists).
// The wrapper defines lmbRead(index) and lmbWrite(index, value).

#define INPUTS 64
#define OUTPUTS 81

vec3 lmbRead3(uint at)
{
    return vec3(lmbRead(at), lmbRead(at + 1u), lmbRead(at + 2u));
}

void lmbWrite3(uint at, vec3 value)
{
    lmbWrite(at, value.x);
    lmbWrite(at + 1u, value.y);
    lmbWrite(at + 2u, value.z);
}

void lmbItem(uint item)
{
    uint from = item * uint(INPUTS);
    uint to = item * uint(OUTPUTS);
    LmbSh3 sh;
    for (uint i = 0u; i < 9u; ++i) {
        sh.c[i] = lmbRead3(from + 3u * i);
    }
    vec3 nv = lmbRead3(from + 27u);
    vec3 n = lmbRead3(from + 30u);
    float visibility = lmbRead(from + 33u);
    LmbIrradz texel;
    texel.irradianceZ = lmbRead3(from + 34u);
    texel.ambientWeight = lmbRead(from + 37u);
    texel.direction = lmbRead3(from + 38u);
    vec3 albedo = lmbRead3(from + 41u);
    float bent = lmbRead(from + 44u);

    float coneCos = lmbConeCosFromVisibility(visibility);
    lmbWrite(to, coneCos);
    lmbWrite(to + 1u, lmbConeCosFromBentVisibility(visibility, bent));
    lmbWrite3(to + 2u, lmbSh3Irradiance(sh, n));
    LmbIrradz irradz = lmbIrradzEncode(sh, nv, coneCos);
    lmbWrite3(to + 5u, irradz.irradianceZ);
    lmbWrite(to + 8u, irradz.ambientWeight);
    lmbWrite3(to + 9u, irradz.direction);
    lmbWrite3(to + 12u, lmbHhdEvaluate(lmbIrradzDecode(irradz, nv), nv, n));
    lmbWrite3(to + 15u, lmbHhdEvaluate(lmbIrradzDecode(texel, nv), nv, n));
    LmbHlsh hlsh = lmbHlshFromSh3(sh, nv, coneCos);
    lmbWrite3(to + 18u, hlsh.irradianceZ);
    lmbWrite3(to + 21u, lmbHlshEvaluate(hlsh, nv, n));
    lmbWrite3(to + 24u, lmbSelfBounce(albedo, texel.irradianceZ, nv, n));
    lmbWrite3(to + 27u, lmbIrradzEvaluate(texel, nv, n));
    LmbKeyLight key;
    key.direction = texel.direction;
    key.irradiance = texel.irradianceZ;
    lmbWrite3(to + 30u, lmbKeyLightIrradiance(key, visibility, nv, n));
    LmbIrradz fitted = lmbIrradzFromProbe(sh, nv, coneCos);
    lmbWrite3(to + 33u, fitted.irradianceZ);
    lmbWrite3(to + 36u, lmbIrradzEvaluate(fitted, nv, n));
    lmbWrite3(to + 39u, lmbHlshEvaluate(lmbHlshFromProbe(sh, nv, coneCos), nv, n));

    vec3 view = lmbRead3(from + 45u);
    float roughness = lmbRead(from + 48u);
    vec3 f0 = lmbRead3(from + 49u);
    LmbSpecularLobe lobe;
    lobe.constant0236 = vec4(lmbRead3(from + 52u), lmbRead(from + 55u));
    lobe.schlick0236 = vec4(lmbRead3(from + 56u), lmbRead(from + 59u));
    lobe.both78 = vec4(lmbRead3(from + 60u), lmbRead(from + 63u));
    lmbWrite3(to + 42u, lmbSpecularArea(sh, lobe, f0, n, view));
    LmbKeyLight dominant = lmbDominantLight(sh);
    lmbWrite3(to + 45u, dominant.irradiance);
    LmbSh3 rest = lmbWithoutLight(sh, dominant);
    lmbWrite3(to + 48u, lmbSh3Irradiance(rest, n));
    key.direction = lmbUnitOr(key.direction, nv);
    lmbWrite3(to + 51u, lmbSpecularLight(key, visibility, roughness, f0, nv, n, view));
    lmbWrite(to + 54u, lmbSpecularCoordinates(roughness, n, view).x);
    lmbWrite(to + 55u, lmbSpecularCoordinates(roughness, n, view).y);
    lmbWrite3(to + 56u, lmbSpecularEnvironment(albedo, sh, lobe, f0, n, view));
    LmbRnm rnm;
    rnm.light1 = texel.irradianceZ;
    rnm.light2 = albedo;
    rnm.light3 = max(sh.c[0], vec3(0.0, 0.0, 0.0));
    lmbWrite3(to + 59u, lmbRnmEvaluate(rnm, lmbRnmSlopes(nv), n));
    lmbWrite3(to + 62u, lmbSsbumpEvaluate(rnm, albedo));
    lmbWrite3(to + 65u, lmbSh2Irradiance(sh.c[0], sh.c[1], sh.c[2], sh.c[3], n));
    vec2 disc;
    disc.x = texel.direction.x;
    disc.y = texel.direction.y;
    lmbWrite3(to + 68u, lmbDiscToDirection(disc, nv));
    vec3 side = vec3(1.5, 1.5, 1.5);
    lmbWrite3(to + 71u, lmbSpecularProxyDirection(texel.direction, -side - albedo, side + f0, 2.0 * view, n));
    lmbWrite(to + 74u, lmbLightVisibility(sh, key));
    lmbWrite3(to + 75u, lmbSpecularLightPhong(key, visibility, roughness, f0, nv, n, view));
    lmbWrite3(to + 78u, lmbSpecularAreaPhong(sh, roughness, f0, n, view));
}
