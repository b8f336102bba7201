/* A black floor of 8 m under a lamp of 10 cd two metres above its middle, written as glTF in every way that brings it
 * somewhere else. Its middle receives 10 / (2 m)^2 lux: 10 / 4 / pi as lightmaps and probes have it. The program
 * defines FOLDER, as gltf_fixture.h wants it. */
#ifndef LMB_TESTS_FAR_FLOOR_H
#define LMB_TESTS_FAR_FLOOR_H

#include "gltf_fixture.h"

#define FLOOR_LIGHT 0.795774715

enum { FLOOR_TEXT_SIZE = 8192 };

/* Accessors: 0 the floor, 1 its indices, 2 a translation by (far, 0, far), 3 joints, 4 weights, 5 the floor around
 * (far, 0, far). All in floats. */
static inline bool floor_data(const char *name, float far)
{
    static const uint16_t indices[6] = {0, 1, 2, 0, 2, 3};
    static const float near[4][3] = {{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}};
    unsigned char bytes[48 + 12 + 12 + 16 + 64 + 48] = {0};
    float positions[4][3], weights[4][4] = {{1}, {1}, {1}, {1}};
    const float translation[3] = {far, 0, far};
    for (int v = 0; v < 4; ++v) {
        positions[v][0] = near[v][0] + far;
        positions[v][1] = near[v][1];
        positions[v][2] = near[v][2] + far;
    }
    memcpy(bytes, near, 48);
    memcpy(bytes + 48, indices, 12);
    memcpy(bytes + 60, translation, 12);
    memcpy(bytes + 88, weights, 64);
    memcpy(bytes + 152, positions, 48);
    return write_bytes(name, bytes, sizeof bytes);
}

#define FLOOR_VIEW(offset, length) "{'buffer':0,'byteOffset':" #offset ",'byteLength':" #length "}"
#define FLOOR_MESH(name, attributes)                                                                                   \
    "{'name':'" name "','primitives':[{'attributes':{" attributes "},'indices':1,'material':0}]}"
#define FLOOR_HEAD                                                                                                             \
    HEAD                                                                                                                       \
        "'extensionsUsed':['KHR_lights_punctual','EXT_mesh_gpu_instancing'],"                                                  \
        "'buffers':[{'uri':'floor.bin','byteLength':200}],"                                                                    \
        "'bufferViews':[" FLOOR_VIEW(0, 48) "," FLOOR_VIEW(48, 12) "," FLOOR_VIEW(60, 12) "," FLOOR_VIEW(                      \
            72, 16) "," FLOOR_VIEW(88, 64) "," FLOOR_VIEW(152,                                                                 \
                                                          48) "],"                                                             \
                                                              "'accessors':[{'bufferView':0,'componentType':5126,'"            \
                                                              "count':4,'type':'VEC3'},"                                       \
                                                              "{'bufferView':1,'componentType':5123,'count':6,'type':"         \
                                                              "'SCALAR'},"                                                     \
                                                              "{'bufferView':2,'componentType':5126,'count':1,'type':"         \
                                                              "'VEC3'},"                                                       \
                                                              "{'bufferView':3,'componentType':5121,'count':4,'type':"         \
                                                              "'VEC4'},"                                                       \
                                                              "{'bufferView':4,'componentType':5126,'count':4,'type':"         \
                                                              "'VEC4'},"                                                       \
                                                              "{'bufferView':5,'componentType':5126,'count':4,'type':"         \
                                                              "'VEC3'}],"                                                      \
                                                              "'materials':[{'pbrMetallicRoughness':{'"                        \
                                                              "baseColorFactor':[0,0,0,1]}}],"                                 \
                                                              "'meshes':[" FLOOR_MESH("floor", "'POSITION':0") "," FLOOR_MESH( \
                                                                  "skinned", "'POSITION':0,'JOINTS_0':3,'WEIGHTS_0':"          \
                                                                             "4") "," FLOOR_MESH("far", "'POSITION':"          \
                                                                                                        "5") "],"              \
                                                                                                             "'extens"         \
                                                                                                             "ions':{"         \
                                                                                                             "'KHR_"           \
                                                                                                             "lights_"         \
                                                                                                             "punctua"         \
                                                                                                             "l':{'"           \
                                                                                                             "lights'"         \
                                                                                                             ":[{'"            \
                                                                                                             "type':'"         \
                                                                                                             "point',"         \
                                                                                                             "'intens"         \
                                                                                                             "ity':"           \
                                                                                                             "10}]}},"

#define FLOOR_LAMP "'extensions':{'KHR_lights_punctual':{'light':0}}"

/* The level of these nodes (glTF JSON with ' for "), `nodes` without brackets. False, with a failed check, when it
 * cannot be written. */
static inline bool floor_write(const char *name, const char *nodes, char path[512])
{
    char text[FLOOR_TEXT_SIZE], file[64];
    const int length = snprintf(text, sizeof text, FLOOR_HEAD "'nodes':[%s]}", nodes);
    char *const json = length > 0 && length < FLOOR_TEXT_SIZE ? json_of(text) : NULL;
    snprintf(file, sizeof file, "%s.gltf", name);
    snprintf(path, 512, FOLDER "/%s", file);
    const bool written = json && write_bytes(file, json, strlen(json));
    free(json);
    CHECK(written, "%s", path);
    return written;
}

/* The floor and its lamp, by their nodes' translations alone. */
static inline bool floor_write_at(const char *name, double x, double y, double z, char path[512])
{
    char nodes[FLOOR_TEXT_SIZE];
    snprintf(nodes, sizeof nodes,
             "{'name':'floor','mesh':0,'translation':[%.17g,%.17g,%.17g]},"
             "{'translation':[%.17g,%.17g,%.17g]," FLOOR_LAMP "}",
             x, y, z, x, y + 2.0, z);
    return floor_data("floor.bin", 1e6f) && floor_write(name, nodes, path);
}

#endif
