/* glTF levels written by hand, for the tests of reading them. The program defines FOLDER, its own folder for files. */
#ifndef LMB_TESTS_GLTF_FIXTURE_H
#define LMB_TESTS_GLTF_FIXTURE_H

#include <stdint.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <lambent/file.h>
#include <lambent/gltf.h>

#include "harness.h"

#define HEAD "{'asset':{'version':'2.0'},"

static lmb_error error;

static inline bool write_bytes(const char *name, const void *bytes, size_t size)
{
    char path[1024];
    mkdir(LMB_TEST_OUTPUT_DIR, 0777);
    mkdir(FOLDER, 0777);
    snprintf(path, sizeof path, FOLDER "/%s", name);
    FILE *const file = fopen(path, "wb");
    const bool written = file && fwrite(bytes, 1, size, file) == size;
    return file && fclose(file) == 0 && written;
}

/* JSON with ' for ", so that it can be read in C. */
static inline char *json_of(const char *text)
{
    const size_t size = strlen(text) + 1;
    char *const json = malloc(size);
    for (size_t i = 0; json && i < size; ++i) {
        json[i] = text[i] == '\'' ? '"' : text[i];
    }
    return json;
}

static inline lmb_result load_text_with(const char *name, const char *text, const lmb_gltf_options *options,
                                        lmb_scene **scene)
{
    char file[64], path[1024];
    char *const json = json_of(text);
    snprintf(file, sizeof file, "%s.gltf", name);
    CHECK(json && write_bytes(file, json, strlen(json)), "%s", name);
    free(json);
    snprintf(path, sizeof path, FOLDER "/%s.gltf", name);
    *scene = NULL;
    error.message[0] = '\0';
    const lmb_result result = lmb_gltf_load(path, options, scene, &error);
    CHECK((result == LMB_OK) == (*scene != NULL), "%s", name);
    if (*scene) {
        lmb_error fault = {""};
        CHECK(lmb_scene_validate(*scene, &fault) == LMB_OK, "%s", fault.message);
    }
    return result;
}

/* Loads what must load; NULL (and a failed check) when it does not. */
static inline lmb_scene *load_text(const char *name, const char *text)
{
    lmb_scene *scene;
    const lmb_result result = load_text_with(name, text, NULL, &scene);
    CHECK(result == LMB_OK, "%s: %s", name, error.message);
    return scene;
}

static inline void check_vec3(lmb_vec3 v, float x, float y, float z, const char *what)
{
    CHECK_NEAR(v.x, x, 1e-5, "%s: (%g %g %g)", what, (double)v.x, (double)v.y, (double)v.z);
    CHECK_NEAR(v.y, y, 1e-5, "%s: (%g %g %g)", what, (double)v.x, (double)v.y, (double)v.z);
    CHECK_NEAR(v.z, z, 1e-5, "%s: (%g %g %g)", what, (double)v.x, (double)v.y, (double)v.z);
}

static inline lmb_vec3 to_world(const lmb_scene *scene, uint32_t instance, uint32_t vertex)
{
    const lmb_instance *const i = &scene->instances[instance];
    const lmb_vec3 p = scene->meshes[i->mesh].position[vertex];
    lmb_vec3 w;
    float *const out[3] = {&w.x, &w.y, &w.z};
    for (int r = 0; r < 3; ++r) {
        const double *const m = i->to_world.m[r];
        *out[r] = (float)(m[0] * (double)p.x + m[1] * (double)p.y + m[2] * (double)p.z + m[3]);
    }
    return w;
}

/* The shared buffer: 0 a quad in XY (4 x VEC3 float), 48 its indices (6 u16, padded to 12), 60 UVs (4 x VEC2 float). */
static const float quad[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
static const uint16_t quad_indices[6] = {0, 1, 2, 0, 2, 3};
static const float quad_uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};

static inline void write_quad_buffer(void)
{
    unsigned char bytes[92];
    memcpy(bytes, quad, 48);
    memcpy(bytes + 48, quad_indices, 12);
    memcpy(bytes + 60, quad_uvs, 32);
    CHECK(write_bytes("quad.bin", bytes, sizeof bytes), "quad.bin");
}

#define QUAD_DATA                                                                                                      \
    "'buffers':[{'uri':'quad.bin','byteLength':92}],"                                                                  \
    "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':12},"                        \
    "{'buffer':0,'byteOffset':60,'byteLength':32}],"                                                                   \
    "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"                                      \
    "{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'},"                                                 \
    "{'bufferView':2,'componentType':5126,'count':4,'type':'VEC2'}],"
#define QUAD_MESH "'meshes':[{'name':'quad','primitives':[{'attributes':{'POSITION':0,'TEXCOORD_0':2},'indices':1}]}],"
#define QUAD HEAD QUAD_DATA QUAD_MESH

#endif
