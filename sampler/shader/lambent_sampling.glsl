// Sampling a volume in a shader: a .lmb file lies in a buffer of 32-bit words as it is, and these functions read it as
// lmb_volume_sample_with_keys does, levels, cut cells and compact probes too. lmb_volume_get_gpu gives the words and
// LmbVolume, member by member. GLSL 4.3 or ESSL 3.1, put behind lambent.glsl; HLSL behind lambent.hlsl. Define before
//
//     uint lmbVolumeWord(uint index);   // of the buffer
//
#ifndef LAMBENT_SAMPLING_GLSL
#define LAMBENT_SAMPLING_GLSL

#ifdef LAMBENT_HLSL
#define vec3 float3
#define uvec3 uint3
#define lmbHalf(bits) f16tof32(bits)
#define lmbBits(word) countbits(word)
#else
#define lmbHalf(bits) unpackHalf2x16(bits).x
#define lmbBits(word) uint(bitCount(word))
#endif

// As lmb_volume_gpu has it; in std140 and std430 without gaps.
struct LmbVolume {
    vec3 origin;
    float inverseSpacing;
    vec3 first;
    float scale;
    vec3 last;
    uint keyLights;
    uvec3 lastCell;
    uint probeUnits;
    uvec3 entries;
    uint isCompact;
    uint directory;
    uint bricks;
    uint probes;
    uint cutOffsets;
    uint cuts;
    float slack;
    uint padding0;
    uint padding1;
};

// The eight probes around a position, and their weights; in a wedge of a cut cell those of the other region, too, and its
// share of the light: else 0.
struct LmbVolumePlace {
    uint probe[8];
    float weight[8];
    float share;
    uint other[8];
};

struct LmbVolumeSample {
    LmbSh3 radiance;
    float visibility[4];
};

// Two bytes of what begins at a word.
uint lmbVolumeShort(uint word, uint index)
{
    return lmbVolumeWord(word + (index >> 1u)) >> (16u * (index & 1u)) & 0xffffu;
}

float lmbVolumeSigned(uint bits)
{
    return float(bits) - (bits >= 0x8000u ? 65536.0 : 0.0);
}

// The regions of a cut cell that a position is in: twice the same, but in a wedge.
struct LmbVolumeRegions {
    uint first;
    uint second;
    float share; // of the second one
};

bool lmbVolumeIsRegion(uint child)
{
    return child >= 128u && child < 160u;
}

// How far t is above a plane, which begins at some short behind a word.
float lmbVolumeAbove(uint word, uint plane, vec3 t)
{
    return lmbVolumeSigned(lmbVolumeShort(word, plane)) * t.x + lmbVolumeSigned(lmbVolumeShort(word, plane + 1u)) * t.y +
           lmbVolumeSigned(lmbVolumeShort(word, plane + 2u)) * t.z - lmbVolumeSigned(lmbVolumeShort(word, plane + 3u));
}

// The regions of a cut cell, whose planes begin at some short behind a word (lmb_cell_regions_at).
LmbVolumeRegions lmbVolumeRegionsAt(uint word, uint planes, uint planeCount, vec3 t)
{
    uint at = planeCount > 0u ? 0u : 128u, beside = 0u;
    float above = 0.0;
    for (uint i = 0u; i < 31u && at < 128u; ++i) {
        uint plane = planes + 5u * at;
        uint children = lmbVolumeShort(word, plane + 4u);
        above = lmbVolumeAbove(word, plane, t);
        at = above > 0.0 ? children >> 8u : children & 255u;
        beside = above > 0.0 ? children & 255u : children >> 8u;
    }
    LmbVolumeRegions regions;
    regions.first = at >= 128u ? at - 128u : 0u;
    regions.second = regions.first;
    regions.share = 0.0;
    if (at >= 160u) {
        uint other = planes + 5u * (at - 160u);
        uint children = lmbVolumeShort(word, other + 4u);
        float own = abs(above), sum = own + abs(lmbVolumeAbove(word, other, t));
        regions.first = beside - 128u;
        regions.second = (lmbVolumeIsRegion(children & 255u) ? children & 255u : children >> 8u) - 128u;
        regions.share = sum > 0.0 ? own / sum : 0.0;
    }
    return regions;
}

// Where a plain cell has its corner k, by its place in its brick.
uint lmbVolumeOwn(LmbVolume volume, uint brick, uvec3 cell, uint k)
{
    uint row = brick + 4u + cell.y + (k >> 1u & 1u) + 5u * (cell.z + (k >> 2u));
    return lmbVolumeWord(row) + (cell.x + (k & 1u)) * volume.probeUnits;
}

// The probes of a region, whose ghosts begin at some short behind a word.
void lmbVolumeProbesRegion(LmbVolume volume, uint brick, uint word, uint ghosts, uint number, uvec3 cell,
                           inout uint probe[8])
{
    uint region = lmbVolumeShort(word, 1u + number);
    uint ghost = ghosts + (region >> 8u), first = lmbVolumeWord(brick + 30u);
    for (uint k = 0u; k < 8u; ++k) {
        bool isGhost = (region >> k & 1u) != 0u;
        uint offset = lmbVolumeShort(word, ghost);
        offset = first + offset - (offset >= 0x8000u ? 65536u : 0u);
        probe[k] = isGhost ? offset * volume.probeUnits : lmbVolumeOwn(volume, brick, cell, k);
        ghost += isGhost ? 1u : 0u;
    }
}

// The probes of a brick's cut cell, by its number among them.
void lmbVolumeProbesCut(LmbVolume volume, uint brick, uint rank, uvec3 cell, vec3 t, inout uint probe[8],
                        inout uint other[8], inout float share)
{
    uint record = volume.cuts + 4u * (lmbVolumeWord(brick + 29u) + (rank << lmbVolumeWord(brick + 31u)));
    uint counts = lmbVolumeShort(record, 0u);
    if (counts == 0u) {
        record = volume.cuts + 4u * lmbVolumeWord(record + 1u);
        counts = lmbVolumeShort(record, 0u);
    }
    uint planes = 1u + (counts & 255u), ghosts = planes + 5u * (counts >> 8u);
    LmbVolumeRegions regions = lmbVolumeRegionsAt(record, planes, counts >> 8u, t);
    lmbVolumeProbesRegion(volume, brick, record, ghosts, regions.first, cell, probe);
    share = regions.share;
    if (regions.share > 0.0) {
        lmbVolumeProbesRegion(volume, brick, record, ghosts, regions.second, cell, other);
    }
}

// The same of a file of version 3, by the cell's number among all.
void lmbVolumeProbes3(LmbVolume volume, uint number, vec3 t, inout uint probe[8])
{
    uint record = volume.cuts + lmbVolumeWord(volume.cutOffsets + number);
    uint head = lmbVolumeWord(record), regions = head & 255u;
    uint region = lmbVolumeRegionsAt(record + 1u + 8u * regions, 0u, head >> 8u & 255u, t).first;
    for (uint k = 0u; k < 8u; ++k) {
        probe[k] = lmbVolumeWord(record + 1u + 8u * region + k);
    }
}

// The probes of a cell, by its place in its brick, and what LmbVolumePlace has of wedges. False: it is not there.
bool lmbVolumeProbes(LmbVolume volume, uint brick, uvec3 cell, vec3 t, out uint probe[8], out uint other[8],
                     out float share)
{
    uint bit = cell.x + 4u * cell.y + 16u * cell.z;
    uint half_ = bit >> 5u, below = (1u << (bit & 31u)) - 1u, mask = 1u << (bit & 31u);
    uint cut = lmbVolumeWord(brick + 2u + half_);
    share = 0.0;
    for (uint k = 0u; k < 8u; ++k) {
        probe[k] = 0u;
        other[k] = 0u;
    }
    if ((lmbVolumeWord(brick + half_) & mask) != 0u) {
        for (uint i = 0u; i < 8u; ++i) {
            probe[i] = lmbVolumeOwn(volume, brick, cell, i);
        }
        return true;
    }
    if ((cut & mask) == 0u) {
        return false;
    }
    uint rank = lmbBits(cut & below) + (half_ == 1u ? lmbBits(lmbVolumeWord(brick + 2u)) : 0u);
    if (volume.cutOffsets != 0u) {
        lmbVolumeProbes3(volume, lmbVolumeWord(brick + 29u) + rank, t, probe);
    } else {
        lmbVolumeProbesCut(volume, brick, rank, cell, t, probe, other, share);
    }
    return true;
}

// Where a position is. False: outside; the place is then that of the nearest position in the bounds, with weights of 0
// where the cell there is none.
bool lmbVolumeFind(LmbVolume volume, vec3 position, out LmbVolumePlace place)
{
    vec3 wanted = position * volume.inverseSpacing - volume.origin;
    vec3 at = min(max(wanted, volume.first), volume.last);
    uvec3 finest = min(uvec3(at), volume.lastCell);
    uint entry = (finest.x >> 2u) + volume.entries.x * (finest.y >> 2u) + volume.entries.y * (finest.z >> 2u);
    uint word = lmbVolumeWord(volume.directory + entry - volume.entries.z);
    uint level = word >> 28u;
    uvec3 cell = uvec3(finest.x >> level, finest.y >> level, finest.z >> level);
    vec3 t = at / float(1u << level) - vec3(cell);
    uvec3 inBrick = uvec3(cell.x & 3u, cell.y & 3u, cell.z & 3u);
    bool there = lmbVolumeProbes(volume, volume.bricks + 32u * (word & 0xfffffffu), inBrick, t, place.probe, place.other,
                                 place.share);
    for (uint i = 0u; i < 8u; ++i) {
        float weight = ((i & 1u) != 0u ? t.x : 1.0 - t.x) * ((i & 2u) != 0u ? t.y : 1.0 - t.y) *
                       ((i & 4u) != 0u ? t.z : 1.0 - t.z);
        place.weight[i] = there ? weight : 0.0;
    }
    vec3 off = abs(wanted - at);
    return there && max(off.x, max(off.y, off.z)) <= volume.slack;
}

// A coefficient of a probe, without the volume's scale.
float lmbVolumeCoefficient(LmbVolume volume, uint probe, uint channel, uint k)
{
    if (volume.isCompact == 0u) {
        return lmbHalf(lmbVolumeShort(volume.probes, probe + 9u * channel + k));
    }
    float first = lmbHalf(lmbVolumeShort(volume.probes, probe + channel));
    if (k == 0u) {
        return first;
    }
    uint index = 8u * channel + k - 1u;
    uint bits = lmbVolumeShort(volume.probes, probe + 3u + (index >> 1u)) >> (8u * (index & 1u)) & 255u;
    float share = float(bits) - (bits >= 128u ? 256.0 : 0.0);
    return first * share * abs(share) * (k < 4u ? 1.0738726e-4 : 1.3863636e-4);
}

// What of a key light is seen at a probe, 0 to 1.
float lmbVolumeSeen(LmbVolume volume, uint probe, uint key)
{
    uint units = probe + (volume.isCompact == 0u ? 27u : 15u) + (key >> 1u);
    return float(lmbVolumeShort(volume.probes, units) >> (8u * (key & 1u)) & 255u) / 255.0;
}

// Radiance and visibility of key lights, of probes with weights.
LmbVolumeSample lmbVolumeBlendProbes(LmbVolume volume, uint probe[8], float weight[8])
{
    LmbVolumeSample blended;
    for (uint k = 0u; k < 9u; ++k) {
        vec3 sum = vec3(0.0, 0.0, 0.0);
        for (uint i = 0u; i < 8u; ++i) {
            sum += weight[i] * vec3(lmbVolumeCoefficient(volume, probe[i], 0u, k),
                                    lmbVolumeCoefficient(volume, probe[i], 1u, k),
                                    lmbVolumeCoefficient(volume, probe[i], 2u, k));
        }
        blended.radiance.c[k] = sum * volume.scale;
    }
    for (uint key = 0u; key < 4u; ++key) {
        blended.visibility[key] = 0.0;
        for (uint c = 0u; c < 8u && key < volume.keyLights; ++c) {
            blended.visibility[key] += weight[c] * lmbVolumeSeen(volume, probe[c], key);
        }
    }
    return blended;
}

// The same at a place; in a wedge, one region's passes over into the other's.
LmbVolumeSample lmbVolumeBlend(LmbVolume volume, LmbVolumePlace place)
{
    LmbVolumeSample blended = lmbVolumeBlendProbes(volume, place.probe, place.weight);
    if (place.share > 0.0) {
        LmbVolumeSample other = lmbVolumeBlendProbes(volume, place.other, place.weight);
        for (uint k = 0u; k < 9u; ++k) {
            blended.radiance.c[k] += place.share * (other.radiance.c[k] - blended.radiance.c[k]);
        }
        for (uint key = 0u; key < 4u; ++key) {
            blended.visibility[key] += place.share * (other.visibility[key] - blended.visibility[key]);
        }
    }
    return blended;
}

#ifdef LAMBENT_HLSL
#undef vec3
#undef uvec3
#endif

#endif
