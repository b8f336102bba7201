// What a probe's light is to a surface, for shaders: the fitted multiply of lmb_moments_from_probe, channel by channel,
// and what is made of it. Put lambent.glsl and lambent_networks.glsl before it; lambent.hlsl has all three. Some 700
// multiplications and additions a channel: for vertices, or once an object, rather than for pixels.
#ifndef LAMBENT_PROBE_GLSL
#define LAMBENT_PROBE_GLSL

#define LMB_MOST_V_V 3.0
#define LMB_MOST_Q_Q 3.75
#define LMB_NO_LIGHT 1.0e12
#define LMB_FLT_MIN 1.17549435e-38

// b_c and b of one channel.
struct LmbMoments1 {
    float bc;
    vec3 b;
};

LmbMoments1 lmbMomentsGram(LmbSh3 sh, vec3 n, float c, int channel)
{
    LmbMoments moments = lmbMomentsInCone(sh, n, c);
    LmbMoments1 one;
    one.bc = moments.bc[channel];
    one.b = vec3(moments.b.x[channel], moments.b.y[channel], moments.b.z[channel]);
    return one;
}

// Band 2 as a matrix, times a vector.
vec3 lmbQuadraticTimes(float s[9], vec3 n)
{
    float zonal = 0.31539156525 * s[6];
    float sectoral = 0.5462742153 * s[8];
    float xy = 0.5462742153 * s[4];
    float yz = -0.5462742153 * s[5];
    float xz = -0.5462742153 * s[7];
    return vec3((sectoral - zonal) * n.x + xy * n.y + xz * n.z, xy * n.x - (zonal + sectoral) * n.y + yz * n.z,
                xz * n.x + yz * n.y + 2.0 * zonal * n.z);
}

// lmb_moments_from_probe of one channel: 0 red, 1 green, 2 blue.
LmbMoments1 lmbMomentsFromProbe(LmbSh3 sh, vec3 n, float coneCos, int channel)
{
    float c = lmbSaturate(coneCos);
    float l0 = sh.c[0][channel];
    float s[9];
    s[0] = 1.0;
    float band1 = 0.0;
    float band2 = 0.0;
    for (int i = 1; i < 9; ++i) {
        s[i] = sh.c[i][channel] / l0;
        if (i < 4) {
            band1 += s[i] * s[i];
        } else {
            band2 += s[i] * s[i];
        }
    }
    if (!(l0 >= LMB_FLT_MIN && band1 + band2 < LMB_NO_LIGHT)) {
        return lmbMomentsGram(sh, n, c, channel);
    }
    // Light about the axis (sampler/multiply.c).
    vec3 first = vec3(-s[3], -s[1], s[2]);
    vec3 mn = lmbQuadraticTimes(s, n);
    vec3 both = lmbQuadraticTimes(s, first);
    float toQ = 1.8305824657; // 2 / N2
    float z1 = dot(n, first);
    float mz = dot(n, mn);
    float firstMn = dot(first, mn);
    float mnSquared = dot(mn, mn);
    float vMn = firstMn - z1 * mz;
    float vv = max(band1 - z1 * z1, 0.0);
    float qq = max(toQ * toQ * (mnSquared - mz * mz), 0.0);
    float mm = max(band2 - 2.5132741229 * (mz * mz) - qq, 0.0); // 1 / (4 N20^2)
    float vq = toQ * vMn;
    float vmv = dot(first, both) - z1 * (firstMn + vMn);
    float qmv = toQ * (dot(mn, both) - z1 * mnSquared - mz * vMn);
    // What the network is told, within the bounds of light.
    float sv = vv > LMB_MOST_V_V ? sqrt(LMB_MOST_V_V / vv) : 1.0;
    float sq = qq > LMB_MOST_Q_Q ? sqrt(LMB_MOST_Q_Q / qq) : 1.0;
    float sm = mm > LMB_MOST_Q_Q ? sqrt(LMB_MOST_Q_Q / mm) : 1.0;
    float toSectoral = 1.8305824657; // 1 / N22
    float z2 = 1.585330919 * mz;     // 1 / (2 N20)
    vec4 low = vec4(clamp(z1, -1.7320508076, 1.7320508076), clamp(z2, -1.1180339887, 2.2360679775), vv * sv * sv,
                    qq * sq * sq);
    vec4 high = vec4(vq * (sv * sq), mm * sm * sm, toSectoral * (vmv + 0.5 * mz * vv) * (sm * sv * sv),
                     toSectoral * (qmv + 0.5 * mz * vq) * (sm * sv * sq));
    LmbCorrection k = lmbNetworkOpened(low, high, 0.0);
    float axial = (band1 + band2) / (band1 + band2 + LMB_MULTIPLY_EVEN_SQUARE);
    float tangential = axial;
    if (c > 0.0) {
        LmbCorrection closing = lmbNetworkClosing(low, high, c);
        k.output_ += c * closing.output_;
        k.qv += c * closing.qv;
        axial *= 1.0 - c;
        tangential = axial * sqrt((1.0 - c) * (1.0 + c));
    }
    float kScalar = axial * k.output_.x;
    float kZonal = axial * k.output_.y;
    float kV = tangential * sv * k.output_.z;
    float kQ = tangential * sq * k.output_.w;
    float kQv = tangential * (sv * sm) * k.qv;
    // Gram's moments, and the correction.
    float closingCone = 1.0 - c;
    float sineSquared = closingCone * (1.0 + c);
    float g0010 = 0.43301270189 * sineSquared;
    float scalar = 0.5 * closingCone + g0010 * z1 + 0.55901699437 * c * sineSquared * z2;
    float zonal = g0010 + 0.5 * closingCone * (1.0 + c + c * c) * z1 +
                  0.24206145914 * sineSquared * (1.0 + 3.0 * c * c) * z2;
    float gxx = 0.25 * closingCone * closingCone * (2.0 + c);
    float gxxz = 0.41926274578 * sineSquared * sineSquared;
    float toVector = 0.65147001587; // 2 / sqrt(3 pi)
    float ofBoth = toSectoral * kQv;
    float ofFirst = toVector * gxx + (kV + 0.5 * mz * ofBoth);
    float ofMn = toQ * (toVector * gxxz + kQ);
    float tangentialAlong = (z1 * ofFirst + mz * ofMn) + 0.5462742153 * vq * ofBoth;
    float along = (toVector * zonal + kZonal) - tangentialAlong;
    LmbMoments1 moments;
    moments.bc = l0 * (1.1283791671 * scalar + kScalar);
    moments.b = l0 * (n * along + first * ofFirst + mn * (ofMn - z1 * ofBoth) + both * ofBoth);
    return moments;
}

// lmb_irradz_from_probe
LmbIrradz lmbIrradzFromProbe(LmbSh3 sh, vec3 nv, float coneCos)
{
    LmbMoments1 r = lmbMomentsFromProbe(sh, nv, coneCos, 0);
    LmbMoments1 g = lmbMomentsFromProbe(sh, nv, coneCos, 1);
    LmbMoments1 b = lmbMomentsFromProbe(sh, nv, coneCos, 2);
    LmbMoments moments;
    moments.bc = vec3(r.bc, g.bc, b.bc);
    moments.b.x = vec3(r.b.x, g.b.x, b.b.x);
    moments.b.y = vec3(r.b.y, g.b.y, b.b.y);
    moments.b.z = vec3(r.b.z, g.b.z, b.b.z);
    return lmbIrradzOfMoments(moments, nv);
}

// HLSH of one channel's solved light (lmb_hlsh_from_probe).
void lmbHlshChannel(LmbMoments1 moments, vec3 nv, inout LmbHlsh hlsh, int channel)
{
    LmbHhd1 hhd = lmbHhdSolve(moments.bc, moments.b, nv);
    float cosine = max(dot(hhd.direction, nv), 0.0);
    vec3 tangential = hhd.direction - nv * cosine;
    float sine = length(tangential);
    float rest = 3.14159265359 - acos(min(cosine, 1.0));
    float weight = 3.14159265359 * hhd.directional;
    float iz = hhd.ambient + hhd.directional * cosine;
    float ambient = 0.5 * hhd.ambient + weight * ((3.0 + cosine) / 12.56637061436 -
                                                  (sine + rest * cosine) / 9.86960440109);
    vec3 c = tangential * (weight * rest / 9.86960440109);
    hlsh.irradianceZ[channel] = iz;
    hlsh.ambient[channel] = ambient;
    hlsh.tangentialX[channel] = c.x;
    hlsh.tangentialY[channel] = c.y;
    hlsh.tangentialZ[channel] = c.z;
}

// lmb_hlsh_rgb_from_probe
LmbHlsh lmbHlshFromProbe(LmbSh3 sh, vec3 nv, float coneCos)
{
    LmbHlsh hlsh = lmbHlshFromSh3(sh, nv, coneCos);
    lmbHlshChannel(lmbMomentsFromProbe(sh, nv, coneCos, 0), nv, hlsh, 0);
    lmbHlshChannel(lmbMomentsFromProbe(sh, nv, coneCos, 1), nv, hlsh, 1);
    lmbHlshChannel(lmbMomentsFromProbe(sh, nv, coneCos, 2), nv, hlsh, 2);
    return hlsh;
}

#endif
