// Sampling a volume in 3D textures: what lmb_volume_texture_fill (lambent/volume_texture.h) writes, a filtered read for
// each part, levels and cut cells too. GLSL 4.3 or ESSL 3.1, put behind lambent.glsl; HLSL behind lambent.hlsl. Define
// before
//
//     uint lmbVolumeTextureWord(uint index);    // of the buffer of words
//     vec4 lmbVolumeTexel(uint part, vec3 at);  // of a part, at a place in texels, filtered: a texel's middle is at
//                                               // its number + 0.5. Of parts above each other along z, add
//                                               // part * volume.texels.z to at.z
//
// or, with LMB_VOLUME_TEXTURE_FETCH defined, instead of the second one
//
//     vec4 lmbVolumeTexelFetch(uint part, uvec3 texel);   // one texel, as it is
//
// which reads eight texels for each part and blends them in floats: filters weigh in 256ths.
#ifndef LAMBENT_VOLUME_TEXTURE_GLSL
#define LAMBENT_VOLUME_TEXTURE_GLSL

#ifdef LAMBENT_HLSL
#define vec3 float3
#define vec4 float4
#define uvec3 uint3
#endif

// As lmb_volume_texture_constants has it; in std140 and std430 without gaps.
struct LmbVolumeTexture {
    vec3 origin;
    float inverseSpacing;
    vec3 first;
    float scale;
    vec3 last;
    float slack;
    uvec3 lastCell;
    uint keyLights;
    uvec3 entries;
    uint bands;
    uvec3 texels;
    uint parts;
    uint tileY;
    uint tileZ;
    uint cells;
    uint regionZ;
};

// The first of eight texels, and where between them a position is.
struct LmbVolumeTexturePlace {
    uvec3 texel;
    float there; // 1, or 0: there are none
    vec3 t;      // 0 to 1
};

struct LmbVolumeTextureSample {
    LmbSh3 radiance;
    float visibility[4];
};

float lmbLowShort(uint word)
{
    return float(int(word << 16u) >> 16);
}

float lmbHighShort(uint word)
{
    return float(int(word) >> 16);
}

// The word of the region of a cut cell that t is in, of the cell's record (lmb_cell_region).
uint lmbVolumeTextureRegion(uint record, vec3 t)
{
    uint planes = lmbVolumeTextureWord(record);
    uint at = planes > 0u ? 0u : 128u;
    for (uint i = 0u; i < 31u && at < 128u; ++i) {
        uint plane = record + 1u + 3u * at;
        uint xy = lmbVolumeTextureWord(plane), zOffset = lmbVolumeTextureWord(plane + 1u);
        float along = lmbLowShort(xy) * t.x + lmbHighShort(xy) * t.y + lmbLowShort(zOffset) * t.z;
        uint children = lmbVolumeTextureWord(plane + 2u);
        at = along > lmbHighShort(zOffset) ? children >> 8u : children & 255u;
    }
    return lmbVolumeTextureWord(record + 1u + 3u * planes + (at >= 128u ? at - 128u : 0u));
}

// Where a position is. False: outside; the place is then that of the nearest position in the bounds, and not there
// where no cell is.
bool lmbVolumeTextureFind(LmbVolumeTexture volume, vec3 position, out LmbVolumeTexturePlace place)
{
    vec3 wanted = position * volume.inverseSpacing - volume.origin;
    vec3 at = min(max(wanted, volume.first), volume.last);
    uvec3 finest = min(uvec3(at), volume.lastCell);
    uint entry = (finest.x >> 2u) + volume.entries.x * (finest.y >> 2u) + volume.entries.y * (finest.z >> 2u);
    uint word = lmbVolumeTextureWord(entry - volume.entries.z);
    uint level = word >> 27u & 15u;
    place.there = level < 15u ? 1.0 : 0.0;
    uvec3 cell = uvec3(finest.x >> level, finest.y >> level, finest.z >> level);
    uvec3 inBrick = uvec3(cell.x & 3u, cell.y & 3u, cell.z & 3u);
    uvec3 tile = uvec3(word & 511u, word >> 9u & 511u, word >> 18u & 511u);
    place.t = at / float(1u << level) - vec3(cell);
    place.texel = 5u * tile + inBrick;
    if (word >= 0x80000000u && level < 15u) {
        uint brick = tile.x + volume.tileY * tile.y + volume.tileZ * tile.z;
        uint own = lmbVolumeTextureWord(volume.cells + 64u * brick + inBrick.x + 4u * inBrick.y + 16u * inBrick.z);
        uint region = own > 1u ? lmbVolumeTextureRegion(own, place.t) : 0xffffffffu;
        place.there = own > 0u ? 1.0 : 0.0;
        if (region != 0xffffffffu) {
            uvec3 block = uvec3(region & 1023u, region >> 10u & 1023u, region >> 20u);
            place.texel = 2u * block + uvec3(0u, 0u, volume.regionZ);
        }
    }
    if (place.there == 0.0) {
        place.texel = uvec3(0u, 0u, 0u);
    }
    vec3 off = abs(wanted - at);
    return place.there > 0.0 && max(off.x, max(off.y, off.z)) <= volume.slack;
}

// The four numbers of a part there.
vec4 lmbVolumeTextureNumbers(uint part, LmbVolumeTexturePlace place)
{
#ifdef LMB_VOLUME_TEXTURE_FETCH
    vec4 sum = vec4(0.0, 0.0, 0.0, 0.0);
    for (uint i = 0u; i < 8u; ++i) {
        uvec3 side = uvec3(i & 1u, i >> 1u & 1u, i >> 2u);
        float weight = (side.x > 0u ? place.t.x : 1.0 - place.t.x) * (side.y > 0u ? place.t.y : 1.0 - place.t.y) *
                       (side.z > 0u ? place.t.z : 1.0 - place.t.z);
        sum += weight * lmbVolumeTexelFetch(part, place.texel + side);
    }
    return place.there * sum;
#else
    // At a block's border rounding would read a little of the texel behind it, which is of another place: a share of
    // 2^-12 of the way to it is more than floats round texels of up to 2048, and less than filters see.
    vec3 t = min(max(place.t, vec3(2.44140625e-4, 2.44140625e-4, 2.44140625e-4)),
                 vec3(0.999755859375, 0.999755859375, 0.999755859375));
    return place.there * lmbVolumeTexel(part, vec3(place.texel) + t + vec3(0.5, 0.5, 0.5));
#endif
}

// Coefficients first to first + 3 of red, green and blue.
void lmbVolumeTextureFour(vec4 red, vec4 green, vec4 blue, uint first, inout LmbSh3 sh)
{
    sh.c[first] = vec3(red.x, green.x, blue.x);
    sh.c[first + 1u] = vec3(red.y, green.y, blue.y);
    sh.c[first + 2u] = vec3(red.z, green.z, blue.z);
    sh.c[first + 3u] = vec3(red.w, green.w, blue.w);
}

// Radiance at a place, of two bands with 0 in the third, and visibility of key lights.
LmbVolumeTextureSample lmbVolumeTextureBlend(LmbVolumeTexture volume, LmbVolumeTexturePlace place)
{
    LmbVolumeTextureSample blended;
    lmbVolumeTextureFour(volume.scale * lmbVolumeTextureNumbers(0u, place),
                         volume.scale * lmbVolumeTextureNumbers(1u, place),
                         volume.scale * lmbVolumeTextureNumbers(2u, place), 0u, blended.radiance);
    vec4 zero = vec4(0.0, 0.0, 0.0, 0.0);
    vec4 seen = zero, last = zero;
    if (volume.bands == 3u) {
        lmbVolumeTextureFour(volume.scale * lmbVolumeTextureNumbers(3u, place),
                             volume.scale * lmbVolumeTextureNumbers(4u, place),
                             volume.scale * lmbVolumeTextureNumbers(5u, place), 4u, blended.radiance);
        last = lmbVolumeTextureNumbers(6u, place);
        if (volume.parts > 7u) {
            seen = lmbVolumeTextureNumbers(7u, place);
        }
        seen = vec4(last.w, seen.x, seen.y, seen.z);
    } else {
        lmbVolumeTextureFour(zero, zero, zero, 4u, blended.radiance);
        if (volume.parts > 3u) {
            seen = lmbVolumeTextureNumbers(3u, place);
        }
    }
    blended.radiance.c[8] = volume.scale * vec3(last.x, last.y, last.z);
    blended.visibility[0] = seen.x / 255.0;
    blended.visibility[1] = seen.y / 255.0;
    blended.visibility[2] = seen.z / 255.0;
    blended.visibility[3] = seen.w / 255.0;
    return blended;
}

#ifdef LAMBENT_HLSL
#undef vec3
#undef vec4
#undef uvec3
#endif

#endif
