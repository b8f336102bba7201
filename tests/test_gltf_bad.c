/* glTF levels that must be refused, each with its reason, and never crash or hang. */
#define _POSIX_C_SOURCE 200809L

#define FOLDER LMB_TEST_OUTPUT_DIR "/gltf_bad"
#include "gltf_fixture.h"

typedef struct bad_case {
    const char *text;
    lmb_result result;
    const char *message; /* what the message must contain */
} bad_case;

#define VIEW4 "'buffers':[{'uri':'data:,abcd','byteLength':4}],"

/* A quad in sight, and what its material asks for. */
#define WORN                                                                                                           \
    HEAD QUAD_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1,'material':0}]}],'nodes':["      \
                   "{'mesh':0}],"
#define EMISSIVE "'materials':[{'emissiveFactor':[1,1,1],'emissiveTexture':{'index':0}}]}"

static const bad_case bad_cases[] = {
    {"", LMB_ERROR_FORMAT, "line 1: not JSON"},
    {"[]", LMB_ERROR_FORMAT, "not a JSON object"},
    {"{\n\n'asset':}", LMB_ERROR_FORMAT, "line 3: not JSON"},
    {HEAD "'nodes':[]} x", LMB_ERROR_FORMAT, "not JSON"},
    {"{}", LMB_ERROR_FORMAT, "asset: missing"},
    {"{'asset':{'version':'1.0'}}", LMB_ERROR_UNSUPPORTED, "asset.version: glTF 1.0"},
    {"{'asset':{'version':'3.0'}}", LMB_ERROR_UNSUPPORTED, "glTF 3.0"},
    {"{'asset':{'version':'two'}}", LMB_ERROR_FORMAT, "asset.version: \"two\""},
    {"{'asset':{'version':2.0}}", LMB_ERROR_FORMAT, "asset.version: not a string"},
    {"{'asset':{'version':'2.1','minVersion':'2.1'}}", LMB_ERROR_UNSUPPORTED, "asset.minVersion"},
    {HEAD "'extensionsRequired':['KHR_draco_mesh_compression']}", LMB_ERROR_UNSUPPORTED, "KHR_draco_mesh_compression"},
    {HEAD "'extensionsRequired':['EXT_meshopt_compression']}", LMB_ERROR_UNSUPPORTED, "EXT_meshopt_compression"},
    {HEAD "'extensionsRequired':[3]}", LMB_ERROR_FORMAT, "extensionsRequired[0]: not a string"},
    {HEAD "'nodes':[],'nodes':[]}", LMB_ERROR_FORMAT, "\"nodes\" twice"},
    {HEAD "'nodes':{}}", LMB_ERROR_FORMAT, "nodes: not an array"},
    {HEAD "'nodes':[3]}", LMB_ERROR_FORMAT, "nodes[0]: not an object"},
    {HEAD "'nodes':[{},{'mesh':0}]}", LMB_ERROR_FORMAT, "nodes[1].mesh: 0, but there are 0 meshes"},
    {HEAD "'nodes':[{'mesh':-1}]}", LMB_ERROR_FORMAT, "nodes[0].mesh: not an index"},
    {HEAD "'nodes':[{'mesh':'a'}]}", LMB_ERROR_FORMAT, "nodes[0].mesh: not an index"},
    {HEAD "'nodes':[{'children':[0]}]}", LMB_ERROR_FORMAT, "nodes[0]: is its own ancestor"},
    {HEAD "'nodes':[{'children':[1]},{'children':[2]},{'children':[1]}]}", LMB_ERROR_FORMAT, "two parents"},
    {HEAD "'nodes':[{'children':[1]},{}],'scenes':[{'nodes':[1]}]}", LMB_ERROR_FORMAT, "node 1 is not a root"},
    {HEAD "'nodes':[{}],'scenes':[{'nodes':[0,0]}]}", LMB_ERROR_FORMAT, "node 0 is listed twice"},
    {HEAD "'nodes':[{'matrix':[1,2]}]}", LMB_ERROR_FORMAT, "nodes[0].matrix: 2 numbers, not 16"},
    {HEAD "'nodes':[{'translation':[1e999,0,0]}]}", LMB_ERROR_FORMAT, "translation[0]: not a finite number"},
    {HEAD "'nodes':[{'scale':[1e30,1,1]}]}", LMB_ERROR_FORMAT, "nodes[0]: its transform"},
    {HEAD "'nodes':[{'skin':0}],'skins':[{'joints':[0]}]}", LMB_ERROR_FORMAT, "nodes[0]: a skin without a mesh"},
    {HEAD "'scene':0}", LMB_ERROR_FORMAT, "scene: 0, but there are 0 scenes"},
    {HEAD "'buffers':[{'byteLength':-5}]}", LMB_ERROR_FORMAT, "buffers[0].byteLength: not an integer"},
    {HEAD "'buffers':[{'byteLength':1e12}]}", LMB_ERROR_FORMAT, "buffers[0].byteLength: not an integer"},
    {HEAD "'buffers':[{'uri':'data:,abcd','byteLength':5}]}", LMB_ERROR_FORMAT, "buffers[0]: byteLength 5, but 4"},
    {HEAD "'buffers':[{'uri':'data:;base64,AA!A','byteLength':1}]}", LMB_ERROR_FORMAT, "buffers[0]: broken base64"},
    {HEAD "'buffers':[{'uri':'data:abc','byteLength':1}]}", LMB_ERROR_FORMAT, "without a comma"},
    {HEAD "'buffers':[{'uri':'nowhere.bin','byteLength':1}]}", LMB_ERROR_IO, "buffers[0]: \"nowhere.bin\""},
    {HEAD "'buffers':[{'uri':'../gltf/quad.bin','byteLength':1}]}", LMB_ERROR_UNSUPPORTED, "leaves the level's folder"},
    {HEAD "'buffers':[{'uri':'%2e%2e/gltf/quad.bin','byteLength':1}]}", LMB_ERROR_UNSUPPORTED, "leaves the"},
    {HEAD "'buffers':[{'uri':'a/../../x','byteLength':1}]}", LMB_ERROR_UNSUPPORTED, "leaves the level's folder"},
    {HEAD "'buffers':[{'uri':'/etc/passwd','byteLength':1}]}", LMB_ERROR_UNSUPPORTED, "leaves the level's folder"},
    {HEAD "'buffers':[{'uri':'file:///etc/passwd','byteLength':1}]}", LMB_ERROR_UNSUPPORTED, "not a file's name"},
    {HEAD "'buffers':[{'uri':'C:/x.bin','byteLength':1}]}", LMB_ERROR_UNSUPPORTED, "not a file's name"},
    {HEAD "'buffers':[{'uri':'a%00b','byteLength':1}]}", LMB_ERROR_FORMAT, "buffers[0]: not a file's name"},
    {HEAD "'buffers':[{'uri':'.','byteLength':1}]}", LMB_ERROR_IO, "not a plain file"},
    {HEAD VIEW4 "'bufferViews':[{'buffer':0,'byteOffset':2,'byteLength':3}]}", LMB_ERROR_FORMAT,
     "bufferViews[0]: bytes 2"},
    {HEAD VIEW4 "'bufferViews':[{'buffer':0,'byteOffset':2147483647,'byteLength':2147483647}]}", LMB_ERROR_FORMAT,
     "bufferViews[0]"},
    {HEAD VIEW4 "'bufferViews':[{'buffer':0,'byteLength':4}],'accessors':[{'bufferView':0,'componentType':5126,"
                "'count':2,'type':'SCALAR'}]}",
     LMB_ERROR_FORMAT, "accessors[0]: 2 elements of 4 bytes"},
    {HEAD VIEW4 "'bufferViews':[{'buffer':0,'byteLength':4}],'accessors':[{'bufferView':0,'componentType':5126,"
                "'count':2147483647,'type':'MAT4'}]}",
     LMB_ERROR_FORMAT, "accessors[0]: 2147483647 elements"},
    {HEAD VIEW4 "'bufferViews':[{'buffer':0,'byteLength':4,'byteStride':4}],'accessors':[{'bufferView':0,"
                "'componentType':5126,'count':1,'type':'VEC2'}]}",
     LMB_ERROR_FORMAT, "accessors[0]: byteStride 4 is below"},
    {HEAD VIEW4 "'bufferViews':[{'buffer':0,'byteLength':4,'byteStride':300}]}", LMB_ERROR_FORMAT, "byteStride: not"},
    {HEAD "'accessors':[{'componentType':5124,'count':1,'type':'VEC2'}]}", LMB_ERROR_FORMAT,
     "accessors[0]: a component"},
    {HEAD "'accessors':[{'componentType':5126,'count':1,'type':'VEC5'}]}", LMB_ERROR_FORMAT, "accessors[0].type"},
    {HEAD "'accessors':[{'componentType':5126,'count':2000000000,'type':'VEC3'}]}", LMB_ERROR_UNSUPPORTED,
     "without a buffer view"},
    {HEAD VIEW4 "'bufferViews':[{'buffer':0,'byteLength':4}],'accessors':[{'componentType':5121,'count':3,"
                "'type':'SCALAR','sparse':{'count':4,'indices':{'bufferView':0,'componentType':5121},"
                "'values':{'bufferView':0}}}]}",
     LMB_ERROR_FORMAT, "accessors[0].sparse: count 4"},
    {HEAD VIEW4 "'bufferViews':[{'buffer':0,'byteLength':4}],'accessors':[{'componentType':5121,'count':3,"
                "'type':'SCALAR','sparse':{'count':1,'indices':{'bufferView':0,'componentType':5121},"
                "'values':{'bufferView':0}}}]}",
     LMB_ERROR_FORMAT, "accessors[0].sparse.indices: element 0 is 97, of 3"},
    {HEAD VIEW4 "'bufferViews':[{'buffer':0,'byteLength':4}],'accessors':[{'componentType':5126,'count':99,"
                "'type':'VEC4','sparse':{'count':1,'indices':{'bufferView':0,'componentType':5121},"
                "'values':{'bufferView':0}}}]}",
     LMB_ERROR_FORMAT, "accessors[0].sparse.values: leaves"},
    {HEAD QUAD_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':2}}]}]}", LMB_ERROR_FORMAT,
     "meshes[0].primitives[0].attributes.POSITION: accessors[2] is of a wrong type"},
    {HEAD QUAD_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'TEXCOORD_0':1}}]}]}", LMB_ERROR_FORMAT,
     "attributes.TEXCOORD_0: 6 elements for 4 vertices"},
    {HEAD QUAD_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':0}]}]}", LMB_ERROR_FORMAT,
     "indices: accessors[0] is not of unsigned integers"},
    {HEAD QUAD_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':9}}]}]}", LMB_ERROR_FORMAT,
     "attributes.POSITION: 9, but there are 3 accessors"},
    {HEAD QUAD_DATA "'meshes':[{'primitives':[{'mode':7,'attributes':{}}]}]}", LMB_ERROR_FORMAT, "primitives[0].mode"},
    {HEAD QUAD_DATA "'meshes':[{}]}", LMB_ERROR_FORMAT, "meshes[0].primitives: missing"},
    {HEAD "'buffers':[{'uri':'quad.bin','byteLength':92}],'bufferViews':[{'buffer':0,'byteLength':36},"
          "{'buffer':0,'byteOffset':48,'byteLength':12}],'accessors':[{'bufferView':0,'componentType':5126,'count':3,"
          "'type':'VEC3'},{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'}],'meshes':[{'primitives':["
          "{'attributes':{'POSITION':0},'indices':1}]}],'nodes':[{'mesh':0}]}",
     LMB_ERROR_FORMAT, "meshes[0].primitives[0].indices: element 5 is vertex 3 of 3"},
    {WORN "'images':[{'uri':'nowhere.png'}],'textures':[{'source':0}]," EMISSIVE, LMB_ERROR_IO,
     "images[0]: \"nowhere.png\""},
    {WORN "'images':[{'uri':'quad.bin'}],'textures':[{'source':0}]," EMISSIVE, LMB_ERROR_FORMAT,
     "images[0]: quad.bin: neither PNG nor JPEG"},
    {WORN "'images':[{}],'textures':[{'source':0}]," EMISSIVE, LMB_ERROR_FORMAT, "images[0]: needs either"},
    {WORN "'images':[{'bufferView':7}],'textures':[{'source':0}]," EMISSIVE, LMB_ERROR_FORMAT,
     "images[0].bufferView: 7"},
    {WORN "'textures':[{'extensions':{'KHR_texture_basisu':{'source':0}}}]," EMISSIVE, LMB_ERROR_UNSUPPORTED,
     "textures[0]: KHR_texture_basisu"},
    {WORN "'textures':[{'source':3}]," EMISSIVE, LMB_ERROR_FORMAT, "textures[0].source: 3, but there are 0 images"},
    {WORN "'textures':[{'sampler':3}]," EMISSIVE, LMB_ERROR_FORMAT, "textures[0].sampler: 3, but there are 0 sampl"},
    {WORN EMISSIVE, LMB_ERROR_FORMAT, "texture 0, but there are 0 textures"},
    {HEAD QUAD_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'TEXCOORD_2':0},'material':0}]}],'nodes':["
                    "{'mesh':0}],'textures':[{}],'materials':[{'normalTexture':{'index':0,'texCoord':2}}]}",
     LMB_ERROR_FORMAT, "attributes.TEXCOORD_2: accessors[0] is of a wrong type"},
    {HEAD "'materials':[{'alphaMode':'SOMETIMES'}]}", LMB_ERROR_FORMAT, "materials[0].alphaMode: \"SOMETIMES\""},
    {HEAD "'materials':[{'emissiveFactor':[1,2]}]}", LMB_ERROR_FORMAT, "materials[0].emissiveFactor: 2 numbers"},
    {HEAD "'extensions':{'KHR_lights_punctual':{'lights':[{'type':'area'}]}}}", LMB_ERROR_FORMAT, "lights[0].type"},
    {HEAD "'nodes':[{'extensions':{'KHR_lights_punctual':{'light':0}}}]}", LMB_ERROR_FORMAT, "there are 0 lights"},
    {HEAD "'nodes':[{'extras':{'lambent':{'light':'dim'}}}]}", LMB_ERROR_FORMAT, "nodes[0].extras.lambent.light"},
};

static void test_bad_levels(void)
{
    write_quad_buffer();
    for (size_t i = 0; i < sizeof bad_cases / sizeof *bad_cases; ++i) {
        lmb_scene *scene;
        const lmb_result result = load_text_with("bad", bad_cases[i].text, NULL, &scene);
        CHECK(result == bad_cases[i].result, "%s: %d %s", bad_cases[i].text, result, error.message);
        CHECK(strstr(error.message, bad_cases[i].message) != NULL, "%s: %s", bad_cases[i].text, error.message);
        CHECK(strncmp(error.message, FOLDER "/bad.gltf: ", sizeof FOLDER + 10) == 0, "names the file: %s",
              error.message);
        lmb_scene_destroy(scene);
    }
    lmb_scene *scene = NULL;
    CHECK(lmb_gltf_load(FOLDER "/no such.gltf", NULL, &scene, &error) == LMB_ERROR_IO, "%s", error.message);
    CHECK(lmb_gltf_load(FOLDER, NULL, &scene, &error) == LMB_ERROR_IO, "%s", error.message);
    CHECK(lmb_gltf_load(FOLDER "/no such.gltf", NULL, &scene, NULL) == LMB_ERROR_IO, "no error wanted");
}

static void test_deep_json(void)
{
    enum { DEPTH = 200000 };
    char *const text = malloc(2 * DEPTH + 64);
    if (!text) {
        return;
    }
    const int head = sprintf(text, "{'asset':{'version':'2.0'},'extras':");
    memset(text + head, '[', DEPTH);
    memset(text + head + DEPTH, ']', DEPTH);
    strcpy(text + head + 2 * DEPTH, "}");
    lmb_scene *scene;
    CHECK(load_text_with("deep", text, NULL, &scene) == LMB_ERROR_FORMAT, "%s", error.message);
    lmb_scene_destroy(scene);
    free(text);
}

/* A chain of nodes as long as no stack is deep. */
static void test_long_chain(void)
{
    enum { LENGTH = 100000 };
    char *const text = malloc((size_t)LENGTH * 64 + 256);
    if (!text) {
        return;
    }
    size_t used = (size_t)sprintf(text, HEAD "'nodes':[");
    for (int i = 0; i + 1 < LENGTH; ++i) {
        used += (size_t)sprintf(text + used, "{'children':[%d],'translation':[0,0,1]},", i + 1);
    }
    strcpy(text + used, "{'extras':{'lambent':{'seed':true}}}]}");
    lmb_scene *const s = load_text("chain", text);
    if (s) {
        CHECK(s->seed_point_count == 1, "%u", s->seed_point_count);
        check_vec3(s->seed_points[0], 0, 0, LENGTH - 1, "the chain's end");
        lmb_scene_destroy(s);
    }
    free(text);
}

static void test_uris(void)
{
    lmb_scene *s;
    write_quad_buffer();
    CHECK(write_bytes("sp ace \xc3\xa9+.bin", quad, sizeof quad), "bin");
    static const char *const uris[] = {"sp ace \xc3\xa9+.bin", "sp%20ace%20%C3%A9+.bin", "./sp%20ace \xc3\xa9%2b.bin",
                                       "x/../sp ace \xc3\xa9+.bin"};
    mkdir(FOLDER "/x", 0777);
    for (size_t i = 0; i < sizeof uris / sizeof *uris; ++i) {
        char text[256];
        snprintf(text, sizeof text, HEAD "'buffers':[{'uri':'%s','byteLength':48}]}", uris[i]);
        lmb_scene_destroy(load_text("spaces \xc3\xa9", text));
    }
    const lmb_gltf_options anywhere = {.allow_outside_uris = true};
    static const char outside[] = HEAD "'buffers':[{'uri':'../gltf_bad/quad.bin','byteLength':92}]}";
    CHECK(load_text_with("outside", outside, &anywhere, &s) == LMB_OK, "%s", error.message);
    lmb_scene_destroy(s);
    char text[1200];
    snprintf(text, sizeof text, HEAD "'buffers':[{'uri':'%s/quad.bin','byteLength':92}]}", FOLDER);
    if (FOLDER[0] == '/') {
        CHECK(load_text_with("outside", text, &anywhere, &s) == LMB_OK, "%s", error.message);
        lmb_scene_destroy(s);
    }
}

/* --- GLB --- */

static void little_endian(unsigned char *to, size_t value)
{
    for (int i = 0; i < 4; ++i) {
        to[i] = (unsigned char)(value >> 8 * i);
    }
}

static size_t make_glb(unsigned char *to, const char *text, const void *bin, size_t bin_size)
{
    char *const json = json_of(text);
    const size_t padded = (strlen(text) + 3) / 4 * 4;
    memcpy(to, "glTF", 4);
    little_endian(to + 4, 2);
    little_endian(to + 12, padded);
    memcpy(to + 16, "JSON", 4);
    memset(to + 20, ' ', padded);
    if (json) {
        memcpy(to + 20, json, strlen(text));
    }
    free(json);
    size_t size = 20 + padded;
    if (bin_size > 0) {
        little_endian(to + size, bin_size);
        memcpy(to + size + 4, "BIN\0", 4);
        memcpy(to + size + 8, bin, bin_size);
        size += 8 + bin_size;
    }
    little_endian(to + 8, size);
    return size;
}

static const char glb_text[] = HEAD
    "'buffers':[{'byteLength':92}],'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,"
    "'byteLength':12},{'buffer':0,'byteOffset':60,'byteLength':32}],'accessors':[{'bufferView':0,"
    "'componentType':5126,'count':4,'type':'VEC3'},{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'},"
    "{'bufferView':2,'componentType':5126,'count':4,'type':'VEC2'}],'materials':[{'emissiveFactor':[1,1,1]}],"
    "'skins':[{'joints':[0]}],'meshes':[{'weights':[1],'primitives':[{'attributes':{'POSITION':0,'TEXCOORD_0':2},"
    "'indices':1,'material':0,'targets':[{'POSITION':0}]}]}],'nodes':[{'mesh':0,'children':[1]},"
    "{'mesh':0,'scale':[1,-1,1]}],'scenes':[{'nodes':[0]}],'scene':0}";

static size_t make_quad_glb(unsigned char *glb)
{
    unsigned char bin[92];
    memcpy(bin, quad, 48);
    memcpy(bin + 48, quad_indices, 12);
    memcpy(bin + 60, quad_uvs, 32);
    return make_glb(glb, glb_text, bin, sizeof bin);
}

static lmb_result load_bytes(const unsigned char *bytes, size_t size, lmb_scene **scene)
{
    CHECK(write_bytes("bytes.glb", bytes, size), "bytes.glb");
    *scene = NULL;
    const lmb_result result = lmb_gltf_load(FOLDER "/bytes.glb", NULL, scene, &error);
    lmb_error fault = {""};
    CHECK(!*scene || lmb_scene_validate(*scene, &fault) == LMB_OK, "%s", fault.message);
    return result;
}

static void test_glb_truncations(void)
{
    unsigned char glb[4096];
    const size_t size = make_quad_glb(glb);
    lmb_scene *s;
    CHECK(load_bytes(glb, size, &s) == LMB_OK, "%s", error.message);
    if (s) {
        CHECK(s->instance_count == 2 && s->instances[1].mirrored && lmb_scene_has_light(s), "whole");
    }
    lmb_scene_destroy(s);
    for (size_t cut = 0; cut < size; ++cut) {
        CHECK(load_bytes(glb, cut, &s) == LMB_ERROR_FORMAT, "%zu of %zu bytes: %s", cut, size, error.message);
        lmb_scene_destroy(s);
    }
    /* The same with a header that admits to the cut. */
    for (size_t cut = 12; cut < size; ++cut) {
        little_endian(glb + 8, cut);
        CHECK(load_bytes(glb, cut, &s) == LMB_ERROR_FORMAT, "%zu of %zu bytes: %s", cut, size, error.message);
        lmb_scene_destroy(s);
    }
}

/* Whatever the bytes are, loading returns, and what it returns is sound. */
static void test_glb_mutations(void)
{
    unsigned char glb[4096], mutated[4096];
    const size_t size = make_quad_glb(glb);
    uint32_t random = 12345;
    unsigned loaded = 0;
    for (int round = 0; round < 1500; ++round) {
        memcpy(mutated, glb, size);
        for (int change = 0; change < 1 + round % 3; ++change) {
            random = random * 1664525u + 1013904223u;
            const size_t at = (random >> 8) % size;
            random = random * 1664525u + 1013904223u;
            static const unsigned char likely[] = "0123456789-.,:[]{}\"e";
            mutated[at] = round % 2 ? likely[(random >> 8) % (sizeof likely - 1)] : (unsigned char)(random >> 16);
        }
        lmb_scene *s;
        loaded += load_bytes(mutated, size, &s) == LMB_OK;
        lmb_scene_destroy(s);
    }
    CHECK(loaded > 50 && loaded < 1450, "%u of 1500 loaded", loaded);
}

/* --- writing UVs --- */

static const test_case cases[] = {
    {"bad levels", test_bad_levels},           {"deep JSON", test_deep_json},
    {"long chain", test_long_chain},           {"URIs", test_uris},
    {"GLB truncations", test_glb_truncations}, {"GLB mutations", test_glb_mutations},
};

TEST_MAIN(cases)
