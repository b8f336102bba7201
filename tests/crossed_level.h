/* Tiny glTF levels in which everything that is read meets everything else, at random: the text, and what a reader must
 * make of it. All are legal. */
#ifndef LMB_TESTS_CROSSED_LEVEL_H
#define LMB_TESTS_CROSSED_LEVEL_H

#include <stdarg.h>
#include <stdint.h>

#include "probes_fixture.h"
#include "harness.h"

enum { CROSSED_MAX_NODES = 8, CROSSED_TEXT_SIZE = 1 << 16, CROSSED_BUFFER_SIZE = 4096 };

typedef struct crossed_level {
    char text[CROSSED_TEXT_SIZE];
    size_t length;
    uint64_t random;
    uint32_t instances; /* those that must be placed, and of these those that are baked */
    uint32_t static_instances;
    uint32_t lights; /* those that must be left */
    uint32_t seeds;
    int meshes, materials;
} crossed_level;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static inline void
crossed_print(crossed_level *level, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(level->text + level->length, CROSSED_TEXT_SIZE - level->length, format, arguments);
    va_end(arguments);
    level->length += (size_t)length;
    if (level->length >= CROSSED_TEXT_SIZE) {
        fprintf(stderr, "crossed level: text too long\n");
        abort();
    }
}

static inline bool crossed_chance(crossed_level *level, double probability)
{
    return fixture_random(&level->random) < probability;
}

static inline int crossed_choice(crossed_level *level, int count)
{
    return (int)(fixture_random(&level->random) * count);
}

static inline double crossed_between(crossed_level *level, double low, double high)
{
    return low + (high - low) * fixture_random(&level->random);
}

#define CROSSED_PICK(level, words) (words)[crossed_choice(level, (int)(sizeof(words) / sizeof(words)[0]))]

/* One of those texts, as part of an object. */
#define CROSSED_MAYBE(level, probability, ...)                                                                         \
    do {                                                                                                               \
        if (crossed_chance(level, probability)) {                                                                      \
            crossed_print(level, __VA_ARGS__);                                                                         \
        }                                                                                                              \
    } while (0)

/* --- geometry: one buffer that all levels share --- */

/* Of each attribute a form for each count of vertices: a box, a quad, a triangle. */
enum { CROSSED_BOX, CROSSED_QUAD, CROSSED_TRIANGLE, CROSSED_COUNTS };
enum {
    CROSSED_POSITION,
    CROSSED_NORMAL,
    CROSSED_TANGENT,
    CROSSED_UV,       /* a good lightmap layout */
    CROSSED_UV_WIDE,  /* beyond [0, 1] */
    CROSSED_UV_POINT, /* all at one point, and without bytes */
    CROSSED_COLOR,
    CROSSED_COLOR_BYTES,
    CROSSED_JOINTS,
    CROSSED_WEIGHTS,
    CROSSED_DELTA,
    CROSSED_NOWHERE, /* positions that are all one */
    CROSSED_ATTRIBUTES
};
enum {
    CROSSED_BOX_INDICES = CROSSED_ATTRIBUTES * CROSSED_COUNTS,
    CROSSED_QUAD_INDICES,
    CROSSED_TRANSLATIONS, /* three transforms: one as it is, one mirrored, one scaled to nothing */
    CROSSED_ROTATIONS,
    CROSSED_SCALES
};

static inline int crossed_accessor(int attribute, int count)
{
    return attribute * CROSSED_COUNTS + count;
}

/* Writes CROSSED_BUFFER_SIZE bytes: arrays of 24 vertices, each beginning with the quad, then indices and transforms.
 * The accessors in crossed_data say where everything is. */
static inline void crossed_buffer(unsigned char *bytes)
{
    float position[24][3], normal[24][3], tangent[24][4], uv[24][2], wide[24][2], color[24][4], weights[24][4];
    unsigned char color_bytes[24][4];
    uint16_t indices[36];
    memset(bytes, 0, CROSSED_BUFFER_SIZE);
    for (int face = 0; face < 6; ++face) {
        const int axis = (face / 2 + 1) % 3, right = (axis + 1) % 3, up = (axis + 2) % 3;
        const float side = face % 2 ? -1.0f : 1.0f;
        for (int k = 0; k < 4; ++k) {
            const int v = 4 * face + k;
            const float x = k == 1 || k == 2 ? 1.0f : -1.0f, y = k >= 2 ? 1.0f : -1.0f;
            position[v][axis] = side;
            position[v][right] = x * side;
            position[v][up] = y;
            memset(normal[v], 0, sizeof normal[v]);
            normal[v][axis] = side;
            memset(tangent[v], 0, sizeof tangent[v]);
            tangent[v][right] = 1.0f;
            tangent[v][3] = side;
            uv[v][0] = ((float)(face % 3) + 0.1f + 0.4f * (x + 1.0f)) / 3.0f;
            uv[v][1] = ((float)(face / 3) + 0.1f + 0.4f * (y + 1.0f)) / 2.0f;
            for (int c = 0; c < 4; ++c) {
                wide[v][c % 2] = 4.0f * uv[v][c % 2] - 1.5f;
                color[v][c] = (float)((v + 3 * c) % 7) / 6.0f;
                color_bytes[v][c] = (unsigned char)(40 * c + 7 * v);
                weights[v][c] = c == 0 ? 1.0f : 0.0f;
            }
        }
        static const uint16_t corner[6] = {0, 1, 2, 0, 2, 3};
        for (int k = 0; k < 6; ++k) {
            indices[6 * face + k] = (uint16_t)(4 * face + corner[k]);
        }
    }
    static const float transform[3][10] = {
        {0, 0, 0, 0, 0, 0, 1, 1, 1, 1}, {2, 1, 0, 0, 0.6f, 0, 0.8f, -1, 1, 2}, {0, 3, 0, 0, 0, 0, 1, 0, 0, 0}};
    memcpy(bytes, position, 288);
    memcpy(bytes + 288, normal, 288);
    memcpy(bytes + 576, tangent, 384);
    memcpy(bytes + 960, uv, 192);
    memcpy(bytes + 1152, wide, 192);
    memcpy(bytes + 1344, color, 384);
    memcpy(bytes + 1728, color_bytes, 96);
    memcpy(bytes + 1824, weights, 384);
    memcpy(bytes + 2208, indices, 72);
    for (int i = 0; i < 3; ++i) {
        memcpy(bytes + 2280 + 40 * i, transform[i], 40);
    }
}

/* The same for all levels: buffer, views, accessors, images, textures. */
static inline void crossed_data(crossed_level *level)
{
    static const struct {
        int view, component_type;
        const char *form;
    } attributes[CROSSED_ATTRIBUTES] = {
        {0, 5126, "'type':'VEC3'"},  {1, 5126, "'type':'VEC3'"},
        {2, 5126, "'type':'VEC4'"},  {3, 5126, "'type':'VEC2'"},
        {4, 5126, "'type':'VEC2'"},  {-1, 5126, "'type':'VEC2'"},
        {5, 5126, "'type':'VEC4'"},  {6, 5121, "'type':'VEC4','normalized':true"},
        {-1, 5121, "'type':'VEC4'"}, {7, 5126, "'type':'VEC4'"},
        {1, 5126, "'type':'VEC3'"},  {-1, 5126, "'type':'VEC3'"},
    };
    static const int sizes[CROSSED_COUNTS] = {24, 4, 3};
    crossed_print(level, "'buffers':[{'uri':'crossed.bin','byteLength':%d}],'bufferViews':[", CROSSED_BUFFER_SIZE);
    static const int views[][2] = {{0, 288},    {288, 288}, {576, 384},  {960, 192}, {1152, 192},
                                   {1344, 384}, {1728, 96}, {1824, 384}, {2208, 72}};
    for (size_t i = 0; i < sizeof views / sizeof *views; ++i) {
        crossed_print(level, "{'buffer':0,'byteOffset':%d,'byteLength':%d},", views[i][0], views[i][1]);
    }
    crossed_print(level, "{'buffer':0,'byteOffset':2280,'byteLength':120,'byteStride':40}],'accessors':[");
    for (int i = 0; i < CROSSED_ATTRIBUTES; ++i) {
        for (int count = 0; count < CROSSED_COUNTS; ++count) {
            crossed_print(level, "{");
            if (attributes[i].view >= 0) {
                crossed_print(level, "'bufferView':%d,", attributes[i].view);
            }
            crossed_print(level, "'componentType':%d,'count':%d,%s},", attributes[i].component_type, sizes[count],
                          attributes[i].form);
        }
    }
    crossed_print(level, "{'bufferView':8,'componentType':5123,'count':36,'type':'SCALAR'},"
                         "{'bufferView':8,'componentType':5123,'count':6,'type':'SCALAR'},"
                         "{'bufferView':9,'componentType':5126,'count':3,'type':'VEC3'},"
                         "{'bufferView':9,'byteOffset':12,'componentType':5126,'count':3,'type':'VEC4'},"
                         "{'bufferView':9,'byteOffset':28,'componentType':5126,'count':3,'type':'VEC3'}],");
    crossed_print(level,
                  "'images':[{'uri':'data:image/png;base64,"
                  "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAFklEQVR42mP4DwQnbOQaGEBAI+rOfwBVewf8bXgmlAAAAABJ"
                  "RU5ErkJggg=='},{'uri':'not there.png'}],"
                  "'samplers':[{'magFilter':9728,'wrapS':33071,'wrapT':33648},{}],"
                  "'textures':[{'source':0},{'source':0,'sampler':0},{'source':0,'sampler':1},{'source':1},{}],");
}

/* --- materials --- */

/* 'name':{...} of a texture that is there. */
static inline void crossed_texture(crossed_level *level, const char *name)
{
    crossed_print(level, "'%s':{'index':%d", name, crossed_choice(level, 3));
    CROSSED_MAYBE(level, 0.5, ",'texCoord':%d", crossed_choice(level, 4));
    if (crossed_chance(level, 0.3)) {
        crossed_print(level, ",'extensions':{'KHR_texture_transform':{'rotation':%.3g,'scale':[%.3g,-2]",
                      crossed_between(level, -3, 3), crossed_between(level, -2, 2));
        CROSSED_MAYBE(level, 0.3, ",'texCoord':%d", crossed_choice(level, 2) * 9);
        crossed_print(level, "}}");
    }
    crossed_print(level, "},");
}

static inline void crossed_material_extensions(crossed_level *level)
{
    crossed_print(level, "'extensions':{");
    CROSSED_MAYBE(level, 0.15, "'KHR_materials_unlit':{},");
    CROSSED_MAYBE(level, 0.2, "'KHR_materials_transmission':{'transmissionFactor':%.3g},",
                  crossed_between(level, 0, 1));
    CROSSED_MAYBE(level, 0.3, "'KHR_materials_emissive_strength':{'emissiveStrength':%.3g},",
                  crossed_between(level, 0, 50));
    if (crossed_chance(level, 0.1)) {
        crossed_print(level, "'KHR_materials_pbrSpecularGlossiness':{");
        if (crossed_chance(level, 0.5)) {
            crossed_texture(level, "diffuseTexture");
        }
        crossed_print(level, "'diffuseFactor':[%.3g,0.5,0.2,%.3g]},", crossed_between(level, 0, 1),
                      crossed_between(level, 0, 1));
    }
    CROSSED_MAYBE(level, 0.2, "'KHR_materials_volume':{'thicknessFactor':1},");
    crossed_print(level, "'X_vendor':{'a':[1,{}]}},");
}

static inline void crossed_material(crossed_level *level)
{
    static const char *const alpha[] = {"OPAQUE", "MASK", "BLEND"};
    crossed_print(level, "{");
    CROSSED_MAYBE(level, 0.7, "'name':'paint',");
    CROSSED_MAYBE(level, 0.6, "'alphaMode':'%s',", CROSSED_PICK(level, alpha));
    CROSSED_MAYBE(level, 0.3, "'alphaCutoff':%.3g,", crossed_between(level, 0, 1.2));
    CROSSED_MAYBE(level, 0.3, "'doubleSided':true,");
    CROSSED_MAYBE(level, 0.3, "'emissiveFactor':[%.3g,1,0],", crossed_between(level, 0, 1));
    if (crossed_chance(level, 0.2)) {
        crossed_texture(level, "emissiveTexture");
    }
    if (crossed_chance(level, 0.2)) {
        crossed_texture(level, "normalTexture");
    } else {
        CROSSED_MAYBE(level, 0.2, "'normalTexture':{'index':%d,'scale':0.5},", 3 + crossed_choice(level, 2));
    }
    CROSSED_MAYBE(level, 0.2, "'occlusionTexture':{'index':3,'strength':0.5},");
    crossed_print(level, "'pbrMetallicRoughness':{");
    if (crossed_chance(level, 0.4)) {
        crossed_texture(level, "baseColorTexture");
    }
    CROSSED_MAYBE(level, 0.2, "'metallicRoughnessTexture':{'index':3},");
    CROSSED_MAYBE(level, 0.2, "'metallicFactor':0.3,");
    crossed_print(level, "'baseColorFactor':[%.3g,%.3g,0.5,%.3g]},", crossed_between(level, 0, 1),
                  crossed_between(level, 0, 1), crossed_between(level, 0, 1));
    crossed_material_extensions(level);
    CROSSED_MAYBE(level, 0.2, "'extras':{'lambent':1,'other':[]},");
    crossed_print(level, "'x':0},");
}

/* --- meshes --- */

static inline void crossed_primitive(crossed_level *level, bool morphs)
{
    static const char *const modes[CROSSED_COUNTS][4] = {
        {"4", "4", "4", "4"}, {"4", "5", "6", "0"}, {"4", "5", "6", "1"}};
    static const int uvs[] = {CROSSED_UV, CROSSED_UV, CROSSED_UV_WIDE, CROSSED_UV_POINT};
    const int count = crossed_choice(level, CROSSED_COUNTS);
    crossed_print(level, "{'attributes':{");
    if (crossed_chance(level, 0.05)) {
        crossed_print(level, "'COLOR_0':%d}},", crossed_accessor(CROSSED_COLOR, count)); /* nothing to see */
        return;
    }
    CROSSED_MAYBE(level, 0.5, "'NORMAL':%d,", crossed_accessor(CROSSED_NORMAL, count));
    CROSSED_MAYBE(level, 0.3, "'TANGENT':%d,", crossed_accessor(CROSSED_TANGENT, count));
    for (int set = 0; set < 10; ++set) {
        CROSSED_MAYBE(level, set < 2 ? 0.5 : 0.2, "'TEXCOORD_%d':%d,", set,
                      crossed_accessor(CROSSED_PICK(level, uvs), count));
    }
    CROSSED_MAYBE(level, 0.3, "'COLOR_0':%d,", crossed_accessor(CROSSED_COLOR + crossed_choice(level, 2), count));
    if (crossed_chance(level, 0.5)) {
        crossed_print(level, "'JOINTS_0':%d,'WEIGHTS_0':%d,", crossed_accessor(CROSSED_JOINTS, count),
                      crossed_accessor(CROSSED_WEIGHTS, count));
    }
    const bool nowhere = crossed_chance(level, 0.05);
    crossed_print(level, "'POSITION':%d},", crossed_accessor(nowhere ? CROSSED_NOWHERE : CROSSED_POSITION, count));
    const int indices = count == CROSSED_BOX ? CROSSED_BOX_INDICES : count == CROSSED_QUAD ? CROSSED_QUAD_INDICES : -1;
    if (indices >= 0 && crossed_chance(level, 0.6)) {
        crossed_print(level, "'indices':%d,", indices);
    } else {
        crossed_print(level, "'mode':%s,", CROSSED_PICK(level, modes[count]));
    }
    if (morphs) {
        crossed_print(level, "'targets':[{'POSITION':%d}],", crossed_accessor(CROSSED_DELTA, count));
    }
    if (level->materials > 0 && crossed_chance(level, 0.9)) {
        crossed_print(level, "'material':%d,", crossed_choice(level, level->materials));
    }
    crossed_print(level, "'x':0},");
}

static inline void crossed_mesh(crossed_level *level)
{
    const bool morphs = crossed_chance(level, 0.2);
    crossed_print(level, "{");
    CROSSED_MAYBE(level, 0.7, "'name':'shape',");
    if (morphs) {
        crossed_print(level, "'weights':[0.25],");
    }
    CROSSED_MAYBE(level, 0.1, "'extras':{'lambent':{'static':false}},");
    crossed_print(level, "'primitives':[");
    const int count = crossed_chance(level, 0.05) ? 0 : 1 + crossed_choice(level, 3);
    for (int i = 0; i < count; ++i) {
        crossed_primitive(level, morphs);
    }
    crossed_print(level, "]},");
}

/* --- nodes --- */

/* How a node stands, its heirs too. */
typedef struct crossed_state {
    int parent; /* -1: a root */
    bool moves, hidden;
    bool gone; /* scaled to nothing */
    bool flat; /* scaled to nothing along one axis */
} crossed_state;

static inline void crossed_transform(crossed_level *level, crossed_state *state)
{
    static const char *const turns[] = {"0,0,0,1", "0.6,0,0,0.8", "0,-0.70710678,0,0.70710678", "0.5,0.5,0.5,0.5"};
    if (crossed_chance(level, 0.15)) {
        crossed_print(level, "'matrix':[1,0,0,0,0,%d,0,0,0,0,2,0,%.3g,0,1,1],", crossed_chance(level, 0.5) ? 1 : -1,
                      crossed_between(level, -2, 2));
        return;
    }
    CROSSED_MAYBE(level, 0.8, "'translation':[%.3g,%.3g,%.3g],", crossed_between(level, -3, 3),
                  crossed_between(level, -3, 3), crossed_between(level, -3, 3));
    CROSSED_MAYBE(level, 0.5, "'rotation':[%s],", CROSSED_PICK(level, turns));
    const double kind = fixture_random(&level->random);
    if (kind < 0.07) {
        crossed_print(level, "'scale':[0,0,0],");
        state->gone = true;
    } else if (kind < 0.14 && !state->flat) {
        crossed_print(level, "'scale':[2,0,1],");
        state->flat = true;
    } else if (kind < 0.5) {
        crossed_print(level, "'scale':[%.3g,%.3g,1],", crossed_between(level, -2, 2) > 0 ? 1.5 : -1.5,
                      crossed_between(level, 0.4, 2));
    }
}

/* Marks, in each form that exporters give them. */
static inline void crossed_extras(crossed_level *level, crossed_state *state, bool *light_off)
{
    static const char *const yes[] = {"true", "1", "1.0"}, *const no[] = {"false", "0", "0.0"};
    static const char *const lights[] = {"baked", "indirect", "off"};
    static const char *const odd[] = {"[]",
                                      "3",
                                      "'text'",
                                      "{}",
                                      "null",
                                      "{'lambent':null}",
                                      "{'lambent':[true]}",
                                      "{'lambent':'not JSON'}",
                                      "{'lambent':''}",
                                      "{'Lambent':{'static':false}}",
                                      "{'lambent':{'static':'no','seed':2,'path':'x','colour':[]}}"};
    if (crossed_chance(level, 0.2)) {
        crossed_print(level, "'extras':%s,", CROSSED_PICK(level, odd));
        return;
    }
    const bool text = crossed_chance(level, 0.3);
    const char *const quote = text ? "\\'" : "'";
    crossed_print(level, "'extras':{'a':[{'lambent':1}],'lambent':%s{", text ? "'" : "");
    if (crossed_chance(level, 0.6)) {
        state->moves = crossed_chance(level, 0.6);
        crossed_print(level, "%sstatic%s:%s,", quote, quote,
                      state->moves ? CROSSED_PICK(level, no) : CROSSED_PICK(level, yes));
    }
    if (crossed_chance(level, 0.2)) {
        const bool seed = crossed_chance(level, 0.6);
        level->seeds += seed;
        crossed_print(level, "%sseed%s:%s,", quote, quote, seed ? CROSSED_PICK(level, yes) : CROSSED_PICK(level, no));
    }
    CROSSED_MAYBE(level, 0.1, "%sunknown%s:1,", quote, quote);
    if (crossed_chance(level, 0.3)) {
        const char *const light = CROSSED_PICK(level, lights);
        *light_off = strcmp(light, "off") == 0;
        crossed_print(level, "%slight%s:%s%s%s,", quote, quote, quote, light, quote);
    }
    crossed_print(level, "%spath%s:%.3g}%s},", quote, quote, crossed_between(level, 0, 9), text ? "'" : "");
}

static inline void crossed_light_node(crossed_level *level, const crossed_state *state, bool off)
{
    const int light = crossed_choice(level, 3); /* point, spot, directional */
    crossed_print(level, "'KHR_lights_punctual':{'light':%d},", light);
    level->lights += !off && !state->hidden && !state->gone && (light == 0 || !state->flat);
}

static inline void crossed_mesh_node(crossed_level *level, const crossed_state *state)
{
    const bool skinned = crossed_chance(level, 0.1);
    crossed_print(level, "'mesh':%d,", crossed_choice(level, level->meshes));
    CROSSED_MAYBE(level, 0.1, "'weights':[0.5],");
    if (skinned) {
        crossed_print(level, "'skin':0,");
    }
    uint32_t placed = skinned || !state->gone;
    if (crossed_chance(level, 0.2)) {
        static const char *const names[] = {"TRANSLATION", "ROTATION", "SCALE"};
        bool scaled = false;
        crossed_print(level, "'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{");
        for (int i = 0; i < 3; ++i) {
            const bool there = i == 0 || crossed_chance(level, 0.6);
            scaled |= i == 2 && there;
            if (there) {
                crossed_print(level, "%s'%s':%d", i > 0 ? "," : "", names[i], CROSSED_TRANSLATIONS + i);
            }
        }
        crossed_print(level, "}}},");
        placed = skinned ? 1 : placed * (scaled ? 2 : 3);
    }
    placed = state->hidden ? 0 : placed;
    level->instances += placed;
    level->static_instances += state->moves ? 0 : placed;
}

static inline void crossed_node(crossed_level *level, int index, int count, crossed_state *states)
{
    crossed_state *const state = &states[index];
    const int parent = state->parent;
    bool light_off = false;
    if (parent >= 0) {
        *state = states[parent];
        state->parent = parent;
    }
    crossed_print(level, "{");
    CROSSED_MAYBE(level, 0.7, "'name':'n%d',", index);
    bool first = true;
    for (int i = index + 1; i < count; ++i) {
        if (states[i].parent == index) {
            crossed_print(level, "%s%d", first ? "'children':[" : ",", i);
            first = false;
        }
    }
    crossed_print(level, "%s", first ? "" : "],");
    crossed_transform(level, state);
    if (crossed_chance(level, 0.5)) {
        crossed_extras(level, state, &light_off);
    }
    if (level->meshes > 0 && crossed_chance(level, 0.7)) {
        crossed_mesh_node(level, state);
    } else {
        crossed_print(level, "'extensions':{");
        if (crossed_chance(level, 0.2)) {
            const bool hides = crossed_chance(level, 0.6);
            state->hidden |= hides;
            crossed_print(level, "'KHR_node_visibility':{'visible':%s},", hides ? "false" : "true");
        }
        if (crossed_chance(level, 0.5)) {
            crossed_light_node(level, state, light_off);
        }
        crossed_print(level, "'X_vendor':{}},");
    }
    crossed_print(level, "'x':0},");
}

/* ' for ", and commas before a closing bracket, are easier to write than to avoid. */
static inline void crossed_make_json(crossed_level *level)
{
    size_t used = 0;
    for (size_t i = 0; i < level->length; ++i) {
        const char next = level->text[i + 1], here = level->text[i];
        if (here != ',' || (next != '}' && next != ']')) {
            level->text[used++] = here == '\'' ? '"' : here;
        }
    }
    level->text[used] = '\0';
    level->length = used;
}

static inline void crossed_make(crossed_level *level, uint64_t seed)
{
    crossed_state states[CROSSED_MAX_NODES];
    memset(level, 0, sizeof *level);
    level->random = seed * UINT64_C(0x9e3779b97f4a7c15) + 1;
    const int nodes = 1 + crossed_choice(level, CROSSED_MAX_NODES);
    level->meshes = crossed_choice(level, 4);
    level->materials = crossed_choice(level, 4);
    crossed_print(level, "{'asset':{'version':'2.0','generator':'%s'},",
                  crossed_chance(level, 0.3) ? "Khronos glTF Blender I/O v4.2.60" : "crossed");
    CROSSED_MAYBE(level, 0.5, "'extensionsUsed':['KHR_lights_punctual','X_vendor','EXT_lights_image_based'],");
    crossed_data(level);
    crossed_print(level, "'materials':[");
    for (int i = 0; i < level->materials; ++i) {
        crossed_material(level);
    }
    crossed_print(level, "],'meshes':[");
    for (int i = 0; i < level->meshes; ++i) {
        crossed_mesh(level);
    }
    crossed_print(level,
                  "],'extensions':{'KHR_lights_punctual':{'lights':[{'type':'point','intensity':%.3g,"
                  "'range':%s},{'type':'spot','spot':{'innerConeAngle':0.2},'color':[1,0.5,0]},"
                  "{'type':'directional','intensity':3,'name':'sun'}]}},'skins':[{'joints':[0]}],'nodes':[",
                  crossed_between(level, 0, 100), crossed_chance(level, 0.5) ? "3.40282347e+38" : "8");
    for (int i = 0; i < nodes; ++i) {
        states[i] = (crossed_state){.parent = crossed_chance(level, 0.5) ? crossed_choice(level, i + 1) - 1 : -1};
    }
    for (int i = 0; i < nodes; ++i) {
        crossed_node(level, i, nodes, states);
    }
    crossed_print(level, "]}");
    crossed_make_json(level);
}

#endif
