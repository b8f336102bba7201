/* glTF and GLB: loaded from memory, and a level that loads is sound. */
#include "fuzz.h"

#include <string.h>

#include <lambent/gltf.h>

#include "scenes/levels.h"

/* Nothing is there for URIs to find. */
#define LEVEL_PATH "/nowhere/level.gltf"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lmb_scene *scene = NULL;
    lmb_error error = {{0}};
    const lmb_result result = lmb_gltf_load_memory(LEVEL_PATH, data, size, NULL, &scene, &error);
    FUZZ_CHECK((result == LMB_OK) == (scene != NULL), "%d", result);
    FUZZ_CHECK(result == LMB_OK || strncmp(error.message, LEVEL_PATH ": ", sizeof LEVEL_PATH + 1) == 0,
               "does not name the file: %s", error.message);
    if (scene) {
        lmb_error fault = {{0}};
        FUZZ_CHECK(lmb_scene_validate(scene, &fault) == LMB_OK, "%s", fault.message);
    }
    lmb_scene_destroy(scene);
    return 0;
}

/* JSON with ' for ", so that it can be read in C. */
static void text_seed(const char *text)
{
    char json[8192];
    const size_t size = strlen(text);
    FUZZ_CHECK(size < sizeof json, "%zu bytes", size);
    for (size_t i = 0; i < size; ++i) {
        json[i] = text[i] == '\'' ? '"' : text[i];
    }
    lmb_scene *scene = NULL;
    lmb_error error = {{0}};
    FUZZ_CHECK(lmb_gltf_load_memory(LEVEL_PATH, json, size, NULL, &scene, &error) == LMB_OK, "a seed does not load: %s",
               error.message);
    lmb_scene_destroy(scene);
    fuzz_seed(json, size);
}

#define HEAD "{'asset':{'version':'2.0'},"

/* Four vec3, six shorts, four vec2 of a quad, all zero but enough to be told apart. */
#define QUAD                                                                                                           \
    "'buffers':[{'byteLength':92,'uri':'data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAA" \
    "gD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMAAAAAAAAAAAAAAIA/AAAAAAAAgD8AAIA/AAAAAAAAgD8='}],"                         \
    "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':12},"                        \
    "{'buffer':0,'byteOffset':60,'byteLength':32}],"                                                                   \
    "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3','min':[0,0,0],'max':[1,1,0]},"          \
    "{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'},"                                                 \
    "{'bufferView':2,'componentType':5126,'count':4,'type':'VEC2'},"                                                   \
    "{'componentType':5121,'count':4,'type':'VEC4','normalized':true,'sparse':{'count':2,'indices':{'bufferView':1,"   \
    "'componentType':5123},'values':{'bufferView':2}}},"                                                               \
    "{'bufferView':0,'componentType':5121,'count':4,'type':'VEC4'},"                                                   \
    "{'bufferView':0,'componentType':5126,'count':1,'type':'SCALAR'}],"
#define PRIMITIVE "'attributes':{'POSITION':0,'TEXCOORD_0':2,'TEXCOORD_1':2},'indices':1"

/* The smallest PNG: one grey pixel. */
#define PIXEL                                                                                                          \
    "'data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNoAAAAggCBd81ytgAAAABJRU5ErkJgg" \
    "g=='"

static const char *const texts[] = {
    HEAD QUAD "'meshes':[{'primitives':[{" PRIMITIVE "}]}],'nodes':[{'mesh':0,'children':[1]},"
              "{'mesh':0,'scale':[1,-1,1],'rotation':[0,0.7071068,0,0.7071068],'translation':[1,2,3]}],"
              "'scenes':[{'nodes':[0]}],'scene':0}",
    HEAD QUAD "'materials':[{'pbrMetallicRoughness':{'baseColorFactor':[0.5,0.5,0.5,0.5],'baseColorTexture':{'index':0,"
              "'texCoord':1,'extensions':{'KHR_texture_transform':{'offset':[0.1,0.2],'scale':[2,2],'rotation':1}}}},"
              "'emissiveFactor':[1,1,1],'emissiveTexture':{'index':0},'normalTexture':{'index':0},'alphaMode':'MASK',"
              "'alphaCutoff':0.4,'doubleSided':true,'extensions':{'KHR_materials_emissive_strength':"
              "{'emissiveStrength':9},'KHR_materials_transmission':{'transmissionFactor':0.5}}},"
              "{'alphaMode':'BLEND','extensions':{'KHR_materials_unlit':{}}}],'images':[{'uri':" PIXEL "}],"
              "'samplers':[{'wrapS':33071,'wrapT':33648,'magFilter':9728}],'textures':[{'source':0,'sampler':0}],"
              "'meshes':[{'primitives':[{" PRIMITIVE ",'material':0},{" PRIMITIVE ",'material':1,'mode':5},"
              "{'attributes':{'POSITION':0,'COLOR_0':3},'mode':6}]}],'nodes':[{'mesh':0}]}",
    HEAD QUAD
    "'extensionsUsed':['KHR_lights_punctual','EXT_mesh_gpu_instancing'],'extensions':{'KHR_lights_punctual':"
    "{'lights':[{'type':'spot','intensity':10,'color':[1,0.5,0.2],'range':9,'spot':{'innerConeAngle':0.1,"
    "'outerConeAngle':0.5}},{'type':'directional'},{'type':'point','extras':{'lambent':{'radius':0.1}}}]}},"
    "'cameras':[{'type':'perspective','perspective':{'yfov':1,'znear':0.1}}],'meshes':[{'primitives':[{" PRIMITIVE
    "}]}],'nodes':[{'camera':0},{'extensions':{'KHR_lights_punctual':{'light':0}}},"
    "{'extensions':{'KHR_lights_punctual':{'light':1}},'extras':{'lambent':{'light':'indirect'}}},"
    "{'extensions':{'KHR_lights_punctual':{'light':2}}},{'mesh':0,'extensions':{'EXT_mesh_gpu_instancing':"
    "{'attributes':{'TRANSLATION':0}}},'extras':{'lambent':{'seed':true,'static':false}}}]}",
    HEAD QUAD "'skins':[{'joints':[1,2]}],'meshes':[{'weights':[0.5],'primitives':[{'attributes':{'POSITION':0,"
              "'JOINTS_0':4,'WEIGHTS_0':3},'indices':1,'targets':[{'POSITION':0}]}]}],'nodes':[{'mesh':0,'skin':0},"
              "{'children':[2]},{'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}],'animations':[{'samplers':[{'input':5,"
              "'output':0}],'channels':[{'sampler':0,'target':{'node':1,'path':'translation'}}]}]}",
};

void fuzz_seeds(void)
{
    static const char path[] = LMB_TEST_OUTPUT_DIR "/fuzz_seed.glb";
    lmb_error error = {{0}};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        text_seed(texts[i]);
    }
    FUZZ_CHECK(lmb_level_quad_light(path, 2.0f, 5.0f, &error) == LMB_OK, "%s", error.message);
    fuzz_seed_file(path);
    remove(path);
}
