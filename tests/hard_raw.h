/* glTF written straight to a file, for levels that no sensible tool writes: any corners, any UVs, any material. */
#ifndef LMB_TESTS_HARD_RAW_H
#define LMB_TESTS_HARD_RAW_H

#include <stdint.h>
#include <stdio.h>

#include "hard_level.h"

/* One primitive with a material of its own. */
typedef struct raw_part {
    const float (*corner)[3]; /* [3 * triangle + corner] */
    const float (*uv)[2];     /* TEXCOORD_1, or NULL */
    uint32_t triangle_count;
    const char *material; /* glTF JSON, ' for " */
} raw_part;

static inline void raw_text(FILE *file, const char *text)
{
    for (; *text; ++text) {
        fputc(*text == '\'' ? '"' : *text, file);
    }
}

/* Offsets of a part's data in the buffer: positions, then UVs. */
static inline size_t raw_part_bytes(const raw_part *part)
{
    return (size_t)part->triangle_count * 3u * (part->uv ? 20u : 12u);
}

static inline void raw_views(FILE *file, const raw_part *parts, int count)
{
    size_t offset = 0;
    raw_text(file, "'bufferViews':[");
    for (int i = 0; i < count; ++i) {
        const size_t corners = (size_t)parts[i].triangle_count * 3u;
        fprintf(file, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", i ? "," : "", offset, 12u * corners);
        if (parts[i].uv) {
            fprintf(file, ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", offset + 12u * corners,
                    8u * corners);
        }
        offset += raw_part_bytes(&parts[i]);
    }
    raw_text(file, "],'accessors':[");
    for (int i = 0, view = 0; i < count; ++i) {
        const uint32_t corners = parts[i].triangle_count * 3u;
        fprintf(file, "%s{\"bufferView\":%d,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\"}", i ? "," : "",
                view++, corners);
        if (parts[i].uv) {
            fprintf(file, ",{\"bufferView\":%d,\"componentType\":5126,\"count\":%u,\"type\":\"VEC2\"}", view++,
                    corners);
        }
    }
    raw_text(file, "],");
}

static inline void raw_meshes(FILE *file, const raw_part *parts, int count)
{
    raw_text(file, "'materials':[");
    for (int i = 0; i < count; ++i) {
        raw_text(file, i ? "," : "");
        raw_text(file, parts[i].material);
    }
    raw_text(file, "],'meshes':[{'primitives':[");
    for (int i = 0, accessor = 0; i < count; ++i) {
        fprintf(file, "%s{\"attributes\":{\"POSITION\":%d", i ? "," : "", accessor++);
        if (parts[i].uv) {
            fprintf(file, ",\"TEXCOORD_1\":%d", accessor++);
        }
        fprintf(file, "},\"material\":%d}", i);
    }
    raw_text(file, "]}],");
}

/* Writes the parts as one mesh of a node `raw`, under a sun of `sun_lux` at noon. */
static inline bool raw_write(const char *name, const raw_part *parts, int count, float sun_lux)
{
    size_t bytes = 0;
    FILE *const data = fopen(hard_path(name, "bin"), "wb");
    for (int i = 0; data && i < count; ++i) {
        bytes += raw_part_bytes(&parts[i]);
        fwrite(parts[i].corner, 36, parts[i].triangle_count, data);
        if (parts[i].uv) {
            fwrite(parts[i].uv, 24, parts[i].triangle_count, data);
        }
    }
    FILE *const file = fopen(hard_path(name, "gltf"), "wb");
    bool good = data && file;
    if (file) {
        raw_text(file, "{'asset':{'version':'2.0'},'extensionsUsed':['KHR_lights_punctual',"
                       "'KHR_materials_transmission'],");
        fprintf(file, "\"buffers\":[{\"uri\":\"hard_%s.bin\",\"byteLength\":%zu}],", name, bytes);
        raw_views(file, parts, count);
        raw_meshes(file, parts, count);
        fprintf(file,
                "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"directional\",\"intensity\":%g}]}},",
                (double)sun_lux);
        raw_text(file, "'nodes':[{'name':'raw','mesh':0},{'rotation':[-0.70710678,0,0,0.70710678],"
                       "'extensions':{'KHR_lights_punctual':{'light':0}}}]}");
        good = fclose(file) == 0 && good;
    }
    if (data) {
        good = fclose(data) == 0 && good;
    }
    CHECK(good, "%s", hard_path(name, "gltf"));
    return good;
}

/* Two triangles of the parallelogram origin, +u, +u+v, +v; front along u x v. */
static inline void raw_quad(float (*corner)[3], lmb_vec3 origin, lmb_vec3 u, lmb_vec3 v)
{
    static const float share[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    for (int k = 0; k < 6; ++k) {
        corner[k][0] = origin.x + share[k][0] * u.x + share[k][1] * v.x;
        corner[k][1] = origin.y + share[k][0] * u.y + share[k][1] * v.y;
        corner[k][2] = origin.z + share[k][0] * u.z + share[k][1] * v.z;
    }
}

/* A level square that looks up. */
static inline void raw_floor(float (*corner)[3], float height, float size)
{
    raw_quad(corner, (lmb_vec3){-size / 2, height, size / 2}, (lmb_vec3){size, 0, 0}, (lmb_vec3){0, 0, -size});
}

#endif
