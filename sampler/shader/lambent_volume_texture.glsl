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

// The first of eight texels, and where between them a position is; in a wedge of a cut cell the first one of the other
// region's, too, and its share of the light: else 0.
struct LmbVolumeTexturePlace {
    uvec3 texel;
    float there; // 1, or 0: there are none
    vec3 t;      // 0 to 1
    float share;
    uvec3 other;
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

// Words of the regions of a cut cell that a position is in: twice the same, but in a wedge.
struct LmbVolumeTextureRegions {
    uint first;
    uint second;
    float share; // of the second one
};

// How far t is above a plane.
float lmbVolumeTextureAbove(uint plane, vec3 t)
{
    uint xy = lmbVolumeTextureWord(plane), zOffset = lmbVolumeTextureWord(plane + 1u);
    return lmbLowShort(xy) * t.x + lmbHighShort(xy) * t.y + lmbLowShort(zOffset) * t.z - lmbHighShort(zOffset);
}

// The regions that t is in, of a cut cell's record (lmb_cell_regions_at).
LmbVolumeTextureRegions lmbVolumeTextureRegionsAt(uint record, vec3 t)
{
    uint planes = lmbVolumeTextureWord(record), words = record + 1u + 3u * planes;
    uint at = planes > 0u ? 0u : 128u, beside = 0u;
    float above = 0.0;
    for (uint i = 0u; i < 31u && at < 128u; ++i) {
        uint plane = record + 1u + 3u * at;
        uint children = lmbVolumeTextureWord(plane + 2u);
        above = lmbVolumeTextureAbove(plane, t);
        at = above > 0.0 ? children >> 8u : children & 255u;
        beside = above > 0.0 ? children & 255u : children >> 8u;
    }
    LmbVolumeTextureRegions regions;
    regions.share = 0.0;
    if (at >= 160u) {
        uint other = record + 1u + 3u * (at - 160u);
        uint children = lmbVolumeTextureWord(other + 2u), low = children & 255u;
        float own = abs(above), sum = own + abs(lmbVolumeTextureAbove(other, t));
        regions.first = lmbVolumeTextureWord(words + beside - 128u);
        regions.second = lmbVolumeTextureWord(words + (low >= 128u && low < 160u ? low : children >> 8u) - 128u);
        regions.share = sum > 0.0 ? own / sum : 0.0;
    } else {
        regions.first = lmbVolumeTextureWord(words + (at >= 128u ? at - 128u : 0u));
        regions.second = regions.first;
    }
    return regions;
}

// The first texel of a region, by its word, where the brick's own texel is given.
uvec3 lmbVolumeTextureTexel(LmbVolumeTexture volume, uint region, uvec3 own)
{
    uvec3 block = uvec3(region & 1023u, region >> 10u & 1023u, region >> 20u);
    return region == 0xffffffffu ? own : 2u * block + uvec3(0u, 0u, volume.regionZ);
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
    place.share = 0.0;
    place.other = place.texel;
    if (word >= 0x80000000u && level < 15u) {
        uint brick = tile.x + volume.tileY * tile.y + volume.tileZ * tile.z;
        uint own = lmbVolumeTextureWord(volume.cells + 64u * brick + inBrick.x + 4u * inBrick.y + 16u * inBrick.z);
        place.there = own > 0u ? 1.0 : 0.0;
        if (own > 1u) {
            LmbVolumeTextureRegions regions = lmbVolumeTextureRegionsAt(own, place.t);
            place.share = regions.share;
            place.other = lmbVolumeTextureTexel(volume, regions.second, place.texel);
            place.texel = lmbVolumeTextureTexel(volume, regions.first, place.texel);
        }
    }
    if (place.there == 0.0) {
        place.texel = uvec3(0u, 0u, 0u);
    }
    vec3 off = abs(wanted - at);
    return place.there > 0.0 && max(off.x, max(off.y, off.z)) <= volume.slack;
}

// The four numbers of a part, of the eight texels from one on.
vec4 lmbVolumeTextureBetween(uint part, uvec3 texel, vec3 at)
{
#ifdef LMB_VOLUME_TEXTURE_FETCH
    vec4 sum = vec4(0.0, 0.0, 0.0, 0.0);
    for (uint i = 0u; i < 8u; ++i) {
        uvec3 side = uvec3(i & 1u, i >> 1u & 1u, i >> 2u);
        float weight = (side.x > 0u ? at.x : 1.0 - at.x) * (side.y > 0u ? at.y : 1.0 - at.y) *
                       (side.z > 0u ? at.z : 1.0 - at.z);
        sum += weight * lmbVolumeTexelFetch(part, texel + side);
    }
    return sum;
#else
    // At a block's border rounding would read a little of the texel behind it, which is of another place: a share of
    // 2^-12 of the way to it is more than floats round texels of up to 2048, and less than filters see.
    vec3 t = min(max(at, vec3(2.44140625e-4, 2.44140625e-4, 2.44140625e-4)),
                 vec3(0.999755859375, 0.999755859375, 0.999755859375));
    return lmbVolumeTexel(part, vec3(texel) + t + vec3(0.5, 0.5, 0.5));
#endif
}

// Those at a place; in a wedge, one region's pass over into the other's.
vec4 lmbVolumeTextureNumbers(uint part, LmbVolumeTexturePlace place)
{
    vec4 numbers = lmbVolumeTextureBetween(part, place.texel, place.t);
    if (place.share > 0.0) {
        numbers += place.share * (lmbVolumeTextureBetween(part, place.other, place.t) - numbers);
    }
    return place.there * numbers;
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
