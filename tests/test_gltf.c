/* Reading glTF levels feature by feature, and writing them again with lightmap UVs. */
#define _POSIX_C_SOURCE 200809L

#define FOLDER LMB_TEST_OUTPUT_DIR "/gltf"
#include "gltf_fixture.h"
#include "warning_log.h"

static void test_quad(void)
{
    write_quad_buffer();
    lmb_scene *const s = load_text("one quad", QUAD "'nodes':[{'mesh':0}]}");
    if (!s) {
        return;
    }
    CHECK(s->mesh_count == 1 && s->instance_count == 1, "%u %u", s->mesh_count, s->instance_count);
    const lmb_mesh *const m = &s->meshes[0];
    CHECK(strcmp(m->name, "quad") == 0 && strcmp(s->instances[0].name, "node 0") == 0, "%s", m->name);
    CHECK(m->triangle_count == 2 && m->vertex_count == 6, "flat: %u %u", m->triangle_count, m->vertex_count);
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        const uint16_t source = quad_indices[v];
        check_vec3(m->normal[v], 0, 0, 1, "flat normal");
        check_vec3(m->position[v], quad[3 * source], quad[3 * source + 1], 0, "position");
        CHECK(m->uv[0][v].x == quad_uvs[2 * source] && m->uv[0][v].y == quad_uvs[2 * source + 1], "uv of %u", v);
    }
    CHECK(!m->uv[1] && !m->color && !m->tangent, "absent attributes");
    CHECK(s->material_count == 1 && m->material[0] == 0, "default material");
    CHECK(s->materials[0].base_color[0] == 1.0f && s->materials[0].base_color_texture.image == -1, "white");
    CHECK(m->source_triangle[1] == 1 && m->source_primitive[1] == 0 && m->source_mesh == 0 && m->source_node == -1,
          "source");
    check_vec3(s->bounds_min, 0, 0, 0, "bounds");
    check_vec3(s->bounds_max, 1, 1, 0, "bounds");
    CHECK(!lmb_scene_has_light(s), "dark");
    lmb_scene_destroy(s);
}

static void test_transforms(void)
{
    lmb_scene *const s =
        load_text("transforms", QUAD
                  "'nodes':[{'children':[1,2],'translation':[10,0,0],'rotation':[0,0,0.70710678118,0.70710678118]},"
                  "{'mesh':0,'scale':[2,3,1]},{'mesh':0,'matrix':[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]},"
                  "{'mesh':0,'rotation':[0,2,0,2]}]}");
    if (!s) {
        return;
    }
    CHECK(s->instance_count == 3 && s->mesh_count == 1, "shared: %u %u", s->instance_count, s->mesh_count);
    /* A quarter turn about Z takes (x, y) to (-y, x). */
    check_vec3(to_world(s, 0, 2), 10 - 3, 2, 0, "TRS");
    check_vec3(to_world(s, 1, 2), 10 - 1, -1, 5, "matrix");
    check_vec3(to_world(s, 2, 1), 0, 0, -1, "a rotation that is not unit");
    CHECK(!s->instances[0].mirrored && s->instances[1].mirrored && !s->instances[2].mirrored, "mirrored");
    CHECK_NEAR(s->instances[0].normal_to_world.m[1][0], 0.5, 1e-7, "inverse transpose");
    check_vec3(s->bounds_min, 0, -1, -1, "bounds");
    check_vec3(s->bounds_max, 10, 2, 5, "bounds");
    lmb_scene_destroy(s);
}

static void test_modes(void)
{
    const float p[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};
    CHECK(write_bytes("five.bin", p, sizeof p), "five.bin");
    lmb_scene *const s = load_text(
        "modes", HEAD "'buffers':[{'uri':'five.bin','byteLength':60}],'bufferViews':[{'buffer':0,'byteLength':60}],"
                      "'accessors':[{'bufferView':0,'componentType':5126,'count':5,'type':'VEC3'}],"
                      "'meshes':[{'primitives':["
                      "{'mode':0,'attributes':{'POSITION':0}},{'mode':1,'attributes':{'POSITION':0}},"
                      "{'mode':5,'attributes':{'POSITION':0}},{'mode':3,'attributes':{'POSITION':0}},"
                      "{'mode':6,'attributes':{'POSITION':0}},{'attributes':{'POSITION':0}},"
                      "{'mode':2,'attributes':{'POSITION':0}},{'attributes':{}}]}],'nodes':[{'mesh':0}]}");
    if (!s) {
        return;
    }
    /* Which of the five points the corners are, as glTF 2.0, 3.7.2.1 lists them. The fan's second triangle
     * (0, 2, 3) and third (0, 3, 4) are real, its first too. */
    static const int expected[7][3] = {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 1, 2}};
    static const uint32_t primitive[7] = {2, 2, 2, 4, 4, 4, 5};
    const lmb_mesh *const m = &s->meshes[0];
    CHECK(m->triangle_count == 7, "%u triangles", m->triangle_count);
    for (uint32_t t = 0; t < 7 && t < m->triangle_count; ++t) {
        for (int c = 0; c < 3; ++c) {
            const float *const q = p + 3 * expected[t][c];
            check_vec3(m->position[m->triangle[t][c]], q[0], q[1], q[2], "corner");
        }
        CHECK(m->source_primitive[t] == primitive[t], "triangle %u: %u", t, m->source_primitive[t]);
    }
    lmb_scene_destroy(s);
}

/* Interleaved, 20 bytes a vertex: position i16 normalised x 3 (+2), normal i8 normalised x 3 (+1), UV u16 plain x 2,
 * colour u8 normalised x 4. */
static void test_quantized(void)
{
    unsigned char bytes[60] = {0};
    const int16_t positions[3][3] = {{-32768, -32767, 0}, {32767, 0, 0}, {0, 16384, 0}};
    const uint16_t uvs[3][2] = {{0, 1}, {2, 65535}, {4, 5}};
    for (size_t v = 0; v < 3; ++v) {
        const int8_t normal[3] = {0, 0, 127};
        const unsigned char color[4] = {255, 51, 0, 102};
        memcpy(bytes + 20 * v, positions[v], 6);
        memcpy(bytes + 20 * v + 8, normal, 3);
        memcpy(bytes + 20 * v + 12, uvs[v], 4);
        memcpy(bytes + 20 * v + 16, color, 4);
    }
    CHECK(write_bytes("quantized.bin", bytes, sizeof bytes), "quantized.bin");
    lmb_scene *const s =
        load_text("quantized", HEAD
                  "'extensionsRequired':['KHR_mesh_quantization'],'extensionsUsed':['KHR_mesh_quantization'],"
                  "'buffers':[{'uri':'quantized.bin','byteLength':60}],"
                  "'bufferViews':[{'buffer':0,'byteLength':60,'byteStride':20}],'accessors':["
                  "{'bufferView':0,'componentType':5122,'normalized':true,'count':3,'type':'VEC3'},"
                  "{'bufferView':0,'byteOffset':8,'componentType':5120,'normalized':true,'count':3,'type':'VEC3'},"
                  "{'bufferView':0,'byteOffset':12,'componentType':5123,'count':3,'type':'VEC2'},"
                  "{'bufferView':0,'byteOffset':16,'componentType':5121,'normalized':true,'count':3,'type':'VEC4'}],"
                  "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'NORMAL':1,'TEXCOORD_1':2,'COLOR_0':3}}]}],"
                  "'nodes':[{'mesh':0}]}");
    if (!s) {
        return;
    }
    const lmb_mesh *const m = &s->meshes[0];
    check_vec3(m->position[0], -1, -1, 0, "both lowest codes are -1");
    check_vec3(m->position[1], 1, 0, 0, "32767");
    check_vec3(m->position[2], 0, 16384.0f / 32767.0f, 0, "16384");
    check_vec3(m->normal[0], 0, 0, 1, "normal");
    CHECK(m->uv[1] && !m->uv[0] && m->uv[1][1].x == 2.0f && m->uv[1][1].y == 65535.0f, "plain integers");
    CHECK_NEAR(m->color[2][1], 0.2, 1e-6, "colour");
    CHECK_NEAR(m->color[2][3], 0.4, 1e-6, "colour's alpha");
    lmb_scene_destroy(s);
}

static void test_sparse(void)
{
    /* 0: plain quad, 48: two u8 indices, 52: two replacements; and again on zeros. */
    unsigned char bytes[76] = {0};
    const unsigned char indices[2] = {1, 2};
    const float values[6] = {5, 0, 0, 5, 6, 0};
    memcpy(bytes, quad, 48);
    memcpy(bytes + 48, indices, 2);
    memcpy(bytes + 52, values, 24);
    CHECK(write_bytes("sparse.bin", bytes, sizeof bytes), "sparse.bin");
#define SPARSE "'sparse':{'count':2,'indices':{'bufferView':1,'componentType':5121},'values':{'bufferView':2}}"
    lmb_scene *const s = load_text(
        "sparse", HEAD
        "'buffers':[{'uri':'sparse.bin','byteLength':76}],'bufferViews':[{'buffer':0,'byteLength':48},"
        "{'buffer':0,'byteOffset':48,'byteLength':2},{'buffer':0,'byteOffset':52,'byteLength':24}],'accessors':["
        "{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'," SPARSE "},"
        "{'componentType':5126,'count':3,'type':'VEC3'," SPARSE "},{'componentType':5123,'count':3,'type':'SCALAR'}],"
        "'meshes':[{'primitives':[{'mode':6,'attributes':{'POSITION':0}},{'attributes':{'POSITION':1}},"
        "{'attributes':{'POSITION':1},'indices':2}]}],'nodes':[{'mesh':0}]}");
    if (!s) {
        return;
    }
    const lmb_mesh *const m = &s->meshes[0];
    CHECK(m->triangle_count == 3, "%u", m->triangle_count);
    check_vec3(m->position[m->triangle[0][1]], 5, 0, 0, "replaced");
    check_vec3(m->position[m->triangle[1][2]], 0, 1, 0, "kept");
    check_vec3(m->position[m->triangle[2][0]], 0, 0, 0, "zero by default");
    check_vec3(m->position[m->triangle[2][2]], 5, 6, 0, "replaced zero");
    CHECK(s->dropped_triangle_count == 1, "indices that are all zero: %u", s->dropped_triangle_count);
    lmb_scene_destroy(s);
}

static void test_morph(void)
{
    float data[24];
    memcpy(data, quad, 48);
    for (int i = 0; i < 12; ++i) {
        data[12 + i] = i % 3 == 2 ? 1.0f : 0.0f; /* each target step lifts by 1 */
    }
    CHECK(write_bytes("morph.bin", data, sizeof data), "morph.bin");
    lmb_scene *const s = load_text(
        "morph", HEAD "'buffers':[{'uri':'morph.bin','byteLength':96}],'bufferViews':[{'buffer':0,'byteLength':48},"
                      "{'buffer':0,'byteOffset':48,'byteLength':48}],'accessors':["
                      "{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
                      "{'bufferView':1,'componentType':5126,'count':4,'type':'VEC3'}],"
                      "'meshes':[{'weights':[0.25,0.5],'primitives':[{'mode':6,'attributes':{'POSITION':0},"
                      "'targets':[{'POSITION':1},{'POSITION':1}]}]}],"
                      "'nodes':[{'mesh':0},{'mesh':0,'weights':[2,0]},{'mesh':0}]}");
    if (!s) {
        return;
    }
    CHECK(s->mesh_count == 2 && s->instance_count == 3, "%u %u", s->mesh_count, s->instance_count);
    CHECK(s->instances[0].mesh == s->instances[2].mesh, "posed by the mesh: shared");
    check_vec3(to_world(s, 0, 0), 0, 0, 0.75f, "the mesh's weights");
    check_vec3(to_world(s, 1, 0), 0, 0, 2, "the node's weights");
    CHECK(s->meshes[s->instances[1].mesh].source_node == 1, "posed by its node");
    lmb_scene_destroy(s);
}

static void test_skin(void)
{
    unsigned char bytes[48 + 16 + 64 + 128] = {0};
    const unsigned char joints[16] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0};
    const float weights[16] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0};
    float inverse[32] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                         1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
    memcpy(bytes, quad, 48);
    memcpy(bytes + 48, joints, 16);
    memcpy(bytes + 64, weights, 64);
    memcpy(bytes + 128, inverse, 128);
    CHECK(write_bytes("skin.bin", bytes, sizeof bytes), "skin.bin");
    lmb_scene *const s = load_text(
        "skin", HEAD "'buffers':[{'uri':'skin.bin','byteLength':256}],'bufferViews':[{'buffer':0,'byteLength':48},"
                     "{'buffer':0,'byteOffset':48,'byteLength':16},{'buffer':0,'byteOffset':64,'byteLength':64},"
                     "{'buffer':0,'byteOffset':128,'byteLength':128}],'accessors':["
                     "{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
                     "{'bufferView':1,'componentType':5121,'count':4,'type':'VEC4'},"
                     "{'bufferView':2,'componentType':5126,'count':4,'type':'VEC4'},"
                     "{'bufferView':3,'componentType':5126,'count':2,'type':'MAT4'}],"
                     "'meshes':[{'primitives':[{'mode':6,'attributes':{'POSITION':0,'JOINTS_0':1,'WEIGHTS_0':2}}]}],"
                     "'skins':[{'joints':[1,2],'inverseBindMatrices':3}],"
                     "'nodes':[{'mesh':0,'skin':0,'translation':[100,0,0]},{'children':[2],'translation':[0,0,7]},"
                     "{'translation':[4,1,0]}]}");
    if (!s) {
        return;
    }
    /* Joint 0 lifts by 7; joint 1 stands at (4, 1, 7) and its bind pose at (0, 1, 0), so it adds (4, 0, 7). */
    const lmb_mesh *const m = &s->meshes[0];
    check_vec3(to_world(s, 0, m->triangle[0][1]), 1, 0, 7, "joint 0, and not the node");
    check_vec3(to_world(s, 0, m->triangle[0][2]), 5, 1, 7, "joint 1");
    check_vec3(to_world(s, 0, m->triangle[1][2]), 2, 1, 7, "half of each");
    CHECK(m->source_node == 0, "%d", m->source_node);
    lmb_scene_destroy(s);
}

static void test_instancing(void)
{
    float data[12 + 6 + 8] = {0};
    memcpy(data, quad, 48);
    const float rest[14] = {1, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 1, 0};
    memcpy(data + 12, rest, 56);
    CHECK(write_bytes("instances.bin", data, sizeof data), "instances.bin");
    lmb_scene *const s = load_text(
        "instances",
        HEAD "'extensionsRequired':['EXT_mesh_gpu_instancing'],'buffers':[{'uri':'instances.bin','byteLength':104}],"
             "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':24},"
             "{'buffer':0,'byteOffset':72,'byteLength':32}],'accessors':["
             "{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
             "{'bufferView':1,'componentType':5126,'count':2,'type':'VEC3'},"
             "{'bufferView':2,'componentType':5126,'count':2,'type':'VEC4'}],"
             "'meshes':[{'primitives':[{'mode':6,'attributes':{'POSITION':0}}]}],'nodes':[{'mesh':0,'scale':[2,2,2],"
             "'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'TRANSLATION':1,'ROTATION':2}}}}]}");
    if (!s) {
        return;
    }
    CHECK(s->instance_count == 2 && s->instances[1].place == 1 && s->instances[1].node == 0, "%u", s->instance_count);
    check_vec3(to_world(s, 0, 1), 4, 0, 0, "moved");
    check_vec3(to_world(s, 1, 1), -2, 4, 0, "moved and half a turn about Z");
    lmb_scene_destroy(s);
}

/* --- PNG, stored without compression --- */

static uint32_t crc32_of(const unsigned char *bytes, size_t size)
{
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < size; ++i) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit) {
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
        }
    }
    return ~crc;
}

static void big_endian(unsigned char *to, uint32_t value)
{
    for (int i = 0; i < 4; ++i) {
        to[i] = (unsigned char)(value >> (24 - 8 * i));
    }
}

static size_t put_chunk(unsigned char *to, const char *type, const unsigned char *bytes, size_t size)
{
    big_endian(to, (uint32_t)size);
    memcpy(to + 4, type, 4);
    if (size > 0) {
        memcpy(to + 8, bytes, size);
    }
    big_endian(to + 8 + size, crc32_of(to + 4, size + 4));
    return size + 12;
}

/* `rows`: height x (1 filter byte + pixels); RGBA of `depth` bits. */
static size_t make_png(unsigned char *to, uint32_t width, uint32_t height, unsigned char depth,
                       const unsigned char *rows, size_t size)
{
    static const unsigned char magic[8] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10};
    unsigned char header[13] = {0}, packed[256] = {0x78, 1, 1};
    memcpy(to, magic, 8);
    big_endian(header, width);
    big_endian(header + 4, height);
    header[8] = depth;
    header[9] = 6;
    size_t used = 8 + put_chunk(to + 8, "IHDR", header, 13);
    packed[3] = (unsigned char)size;
    packed[5] = (unsigned char)~size;
    packed[6] = 0xff;
    memcpy(packed + 7, rows, size);
    uint32_t a = 1, b = 0;
    for (size_t i = 0; i < size; ++i) {
        a = (a + rows[i]) % 65521;
        b = (b + a) % 65521;
    }
    big_endian(packed + 7 + size, b << 16 | a);
    used += put_chunk(to + used, "IDAT", packed, size + 11);
    return used + put_chunk(to + used, "IEND", packed, 0);
}

static void test_materials(void)
{
    const unsigned char rows8[18] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 0, 9, 10, 11, 12, 13, 14, 15, 255};
    const unsigned char rows16[9] = {0, 0xff, 0xff, 0x80, 0x00, 0x00, 0xc0, 0x00, 0x7f};
    unsigned char png[512];
    size_t size = make_png(png, 2, 2, 8, rows8, sizeof rows8);
    CHECK(write_bytes("two by two.png", png, size), "png");
    size = make_png(png, 1, 1, 16, rows16, sizeof rows16);
    CHECK(write_bytes("wide.png", png, size), "png");
    /* Textures are read of what is worn; on what moves, so that nothing emits. */
    write_quad_buffer();
    lmb_scene *const s = load_text(
        "materials", HEAD QUAD_DATA
        "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'material':0},{'attributes':{'POSITION':0},"
        "'material':1},{'attributes':{'POSITION':0},'material':2}]}],"
        "'nodes':[{'mesh':0,'extras':{'lambent':{'static':false}}}],"
        "'extensionsUsed':['KHR_texture_transform'],"
        "'images':[{'uri':'nowhere.png'},{'uri':'two%20by%20two.png'},{'uri':'wide.png'}],"
        "'samplers':[{'magFilter':9728,'wrapS':33071,'wrapT':33648}],"
        "'textures':[{'source':0},{'source':1,'sampler':0},{'source':2}],'materials':["
        "{'name':'a','pbrMetallicRoughness':{'baseColorFactor':[0.1,0.2,0.3,0.4],'baseColorTexture':{'index':1,"
        "'texCoord':0,'extensions':{'KHR_texture_transform':{'offset':[0.5,0.25],'scale':[2,4],"
        "'rotation':1.5707963267948966,'texCoord':1}}},'metallicRoughnessTexture':{'index':0}},"
        "'emissiveFactor':[1,0.5,0],'emissiveTexture':{'index':2},'normalTexture':{'index':2,'scale':0.7},"
        "'alphaMode':'MASK','alphaCutoff':0.3,'doubleSided':true,"
        "'extensions':{'KHR_materials_emissive_strength':{'emissiveStrength':8}}},"
        "{'alphaMode':'BLEND','extensions':{'KHR_materials_unlit':{},"
        "'KHR_materials_transmission':{'transmissionFactor':0.75}}},"
        "{'extensions':{'KHR_materials_pbrSpecularGlossiness':{'diffuseFactor':[0.5,0.6,0.7,0.8],"
        "'diffuseTexture':{'index':1}}}}]}");
    if (!s) {
        return;
    }
    CHECK(s->material_count == 4 && s->image_count == 2, "%u materials, %u images", s->material_count, s->image_count);
    const lmb_material *const a = &s->materials[0], *const b = &s->materials[1], *const c = &s->materials[2];
    CHECK(strcmp(a->name, "a") == 0 && a->base_color[1] == 0.2f && a->base_color[3] == 0.4f, "base colour");
    CHECK(a->emissive.c[0] == 8.0f && a->emissive.c[1] == 4.0f && a->emissive.c[2] == 0.0f, "emissive strength");
    CHECK(a->alpha_mode == LMB_ALPHA_MASK && a->alpha_cutoff == 0.3f && a->double_sided && !a->unlit, "flags");
    CHECK(a->normal_scale == 0.7f && a->normal_texture.image == a->emissive_texture.image, "normal map");
    const lmb_texture *const t = &a->base_color_texture;
    CHECK(t->uv_set == 1 && t->nearest && t->wrap_u == LMB_WRAP_CLAMP && t->wrap_v == LMB_WRAP_MIRROR, "sampler");
    CHECK(!a->emissive_texture.nearest && a->emissive_texture.wrap_u == LMB_WRAP_REPEAT, "default sampler");
    /* The extension's matrices, transposed from its GLSL columns: translation x rotation x scale with
     * R = [[cos, sin], [-sin, cos]]. (1, 0) -> (0.5, 0.25 - 2), (0, 1) -> (0.5 + 4, 0.25). */
    static const double expected[6] = {0, 4, 0.5, -2, 0, 0.25};
    for (int k = 0; k < 6; ++k) {
        CHECK_NEAR(t->transform[k / 3][k % 3], expected[k], 1e-6, "transform %d", k);
    }
    const lmb_texture_image *const two = &s->images[t->image];
    CHECK(two->width == 2 && two->height == 2 && two->rgba[4] == 5 && two->rgba[15] == 255, "8 bits");
    CHECK(strcmp(two->name, "two%20by%20two.png") == 0, "%s", two->name);
    const uint8_t *const wide = s->images[a->emissive_texture.image].rgba;
    CHECK(wide[0] == 255 && wide[1] == 128 && wide[2] == 1 && wide[3] == 0, "16 bits are rounded: %d %d %d %d", wide[0],
          wide[1], wide[2], wide[3]);
    CHECK(b->alpha_mode == LMB_ALPHA_BLEND && b->unlit && b->transmission == 0.75f && b->alpha_cutoff == 0.5f, "b");
    CHECK(c->base_color[2] == 0.7f && c->base_color_texture.image == t->image, "specular-glossiness");
    CHECK(a->metallic == 1.0f && a->roughness == 1.0f && a->metallic_roughness_texture.image == -1,
          "metal unless told otherwise, whose map nobody asked for");
    CHECK(c->metallic == 0.0f && c->roughness == 0.0f, "all gloss is no roughness");
    CHECK(!lmb_scene_has_light(s), "emissive materials that nothing static wears give no light");
    lmb_scene_destroy(s);
}

static void test_lights(void)
{
    lmb_scene *const s = load_text(
        "lights", HEAD
        "'extensions':{'KHR_lights_punctual':{'lights':[{'type':'point','color':[1,0.5,0],'intensity':10,'range':3,"
        "'name':'lamp'},{'type':'spot','spot':{'innerConeAngle':0.5,'outerConeAngle':1}},{'type':'directional'},"
        "{'type':'spot','spot':{}}]}},'nodes':["
        "{'translation':[1,2,3],'scale':[2,2,2],'extensions':{'KHR_lights_punctual':{'light':0}}},"
        "{'rotation':[0,0.70710678118,0,0.70710678118],'extensions':{'KHR_lights_punctual':{'light':1}}},"
        "{'rotation':[-0.70710678118,0,0,0.70710678118],'extensions':{'KHR_lights_punctual':{'light':2}}},"
        "{'extras':{'lambent':{'light':'indirect'}},'extensions':{'KHR_lights_punctual':{'light':3}}},"
        "{'extras':{'lambent':{'light':'off'}},'extensions':{'KHR_lights_punctual':{'light':3}}}]}");
    if (!s) {
        return;
    }
    CHECK(s->light_count == 4, "%u", s->light_count);
    const lmb_light *const l = s->lights;
    CHECK(l[0].type == LMB_LIGHT_POINT && strcmp(l[0].name, "lamp") == 0 && l[0].range == 3.0f, "point");
    CHECK(l[0].intensity.c[0] == 10.0f && l[0].intensity.c[1] == 5.0f && l[0].intensity.c[2] == 0.0f, "colour");
    check_vec3(l[0].position, 1, 2, 3, "position");
    CHECK(l[1].type == LMB_LIGHT_SPOT && l[1].intensity.c[2] == 1.0f && l[1].range == 0.0f, "defaults");
    check_vec3(l[1].direction, -1, 0, 0, "-Z turned a quarter about Y");
    CHECK_NEAR(l[1].cos_inner, cos(0.5), 1e-7, "inner");
    CHECK_NEAR(l[1].cos_outer, cos(1.0), 1e-7, "outer");
    CHECK(l[2].type == LMB_LIGHT_DIRECTIONAL && strcmp(l[2].name, "node 2") == 0, "sun");
    check_vec3(l[2].direction, 0, -1, 0, "-Z turned down");
    CHECK_NEAR(l[3].cos_inner, 1.0, 1e-7, "default inner cone");
    CHECK_NEAR(l[3].cos_outer, sqrt(0.5), 1e-7, "default outer cone");
    CHECK(!l[2].indirect_only && l[3].indirect_only, "what of a light is baked");
    CHECK(lmb_scene_has_light(s), "light");
    lmb_scene_destroy(s);
}

static void line_count(void *context, const char *line)
{
    CHECK(strstr(line, "excludes nothing"), "%s", line);
    ++*(int *)context;
}

/* A light's extent is in its node's extras; what is no such number is ignored, with a warning. */
static void test_light_extents(void)
{
    static const struct {
        const char *extras, *warned;
        float angle, radius;
        int light;
    } nodes[] = {
        {"'angle_deg':0.5", NULL, 0.5f * 3.14159265f / 180.0f, 0.0f, 1},
        {"'angle_deg':180", NULL, 3.14159265f, 0.0f, 1},
        {"'angle_deg':0", NULL, 0.0f, 0.0f, 1},
        {"'radius_m':2", NULL, 0.0f, 0.0f, 1}, /* a sun has none */
        {"'radius_m':0.25", NULL, 0.0f, 0.25f, 0},
        {"'radius_m':1e3,'light':'indirect'", NULL, 0.0f, 1000.0f, 0},
        {"'angle_deg':5", NULL, 0.0f, 0.0f, 0},
        {"'angle_deg':-1", "angle_deg", 0.0f, 0.0f, 1},
        {"'angle_deg':181", "angle_deg", 0.0f, 0.0f, 1},
        {"'angle_deg':'wide'", "angle_deg", 0.0f, 0.0f, 1},
        {"'radius_m':-0.1", "radius_m", 0.0f, 0.0f, 0},
        {"'radius_m':1e300", "radius_m", 0.0f, 0.0f, 0},
        {"'radius_m':[1]", "radius_m", 0.0f, 0.0f, 0},
    };
    for (size_t i = 0; i < sizeof nodes / sizeof nodes[0]; ++i) {
        char text[512];
        snprintf(text, sizeof text,
                 HEAD "'extensions':{'KHR_lights_punctual':{'lights':[{'type':'point'},{'type':'directional'}]}},"
                      "'nodes':[{'extras':{'lambent':{%s}},'extensions':{'KHR_lights_punctual':{'light':%d}}}]}",
                 nodes[i].extras, nodes[i].light);
        warning_log log = {0};
        const lmb_gltf_options options = {.warnings = {warning_keep, &log}};
        lmb_scene *scene = NULL;
        if (load_text_with("extents", text, &options, &scene) == LMB_OK) {
            CHECK_NEAR(scene->lights[0].angle_rad, nodes[i].angle, 1e-6, "%s", nodes[i].extras);
            CHECK_NEAR(scene->lights[0].radius, nodes[i].radius, 0.0, "%s", nodes[i].extras);
            CHECK(log.count == (nodes[i].warned ? 1 : 0) && (!nodes[i].warned || strstr(log.last, nodes[i].warned)),
                  "%s: %d warnings, '%s'", nodes[i].extras, log.count, log.last);
        }
        lmb_scene_destroy(scene);
    }
}

/* Densities and whether there is a lightmap at all: from the nearest node up that tells. */
static void test_lightmap_marks(void)
{
    static const struct {
        const char *above, *own, *warned;
        bool off;
        float density, scale;
    } nodes[] = {
        {"", "", NULL, false, 0, 0},
        {"", "'texels_per_m':12.5", NULL, false, 12.5f, 0},
        {"'texels_per_m':3,'texel_scale':2", "", NULL, false, 3, 2},
        {"'texels_per_m':3,'texel_scale':2", "'texel_scale':0.5", NULL, false, 3, 0.5f},
        {"'texel_scale':2", "'texels_per_m':7", NULL, false, 7, 2},
        {"'lightmap':false", "", NULL, true, 0, 0},
        {"'lightmap':0", "'lightmap':1", NULL, false, 0, 0},
        {"'lightmap':true", "'lightmap':false,'texel_scale':4", NULL, true, 0, 4},
        {"", "'lightmap':'no'", "lightmap is neither", false, 0, 0},
        {"'texels_per_m':3", "'texels_per_m':0", "texels_per_m is not", false, 3, 0},
        {"", "'texels_per_m':-1", "texels_per_m is not", false, 0, 0},
        {"", "'texels_per_m':'8'", "texels_per_m is not", false, 0, 0},
        {"", "'texel_scale':1e300", "texel_scale is not", false, 0, 0},
        {"", "'texel_scale':null", "texel_scale is not", false, 0, 0},
        {"", "'texels':3", "texels is unknown", false, 0, 0},
    };
    for (size_t i = 0; i < sizeof nodes / sizeof nodes[0]; ++i) {
        char text[2048];
        snprintf(text, sizeof text,
                 QUAD "'nodes':[{'children':[1],'extras':{'lambent':{%s}}},{'mesh':0,'extras':{'lambent':{%s}}}]}",
                 nodes[i].above, nodes[i].own);
        warning_log log = {0};
        const lmb_gltf_options options = {.warnings = {warning_keep, &log}};
        lmb_scene *scene = NULL;
        CHECK(load_text_with("lightmap_marks", text, &options, &scene) == LMB_OK && scene->instance_count == 1,
              "%s: %s", nodes[i].own, error.message);
        if (scene) {
            const lmb_instance *const made = &scene->instances[0];
            CHECK(made->no_lightmap == nodes[i].off && made->texels_per_m == nodes[i].density &&
                      made->texel_scale == nodes[i].scale,
                  "%zu: %d, %g, %g", i, made->no_lightmap, (double)made->texels_per_m, (double)made->texel_scale);
            CHECK(log.count == (nodes[i].warned ? 1 : 0) && (!nodes[i].warned || strstr(log.last, nodes[i].warned)),
                  "%zu: %d warnings, '%s'", i, log.count, log.last);
        }
        lmb_scene_destroy(scene);
    }
}

static void test_marks_and_exclusion(void)
{
    static const char text[] =
        QUAD "'scene':1,'scenes':[{'nodes':[0]},{'nodes':[1,5]}],'nodes':[{'mesh':0,'name':'other scene'},"
             "{'name':'lift','mesh':0,'children':[2,3],'extras':{'lambent':{'static':false}},'translation':[0,0,50]},"
             "{'name':'liftDoor','mesh':0},{'name':'frame','mesh':0,'extras':{'lambent':{'static':true}}},"
             "{'name':'unused','mesh':0},"
             "{'name':'marks','children':[6,7,8,9]},{'extras':{'lambent':{'seed':true}},'translation':[1,2,3]},"
             "{'extras':{'lambent':{'path':2}},'translation':[0,0,2]},{'extras':{'lambent':{'path':1}},'translation':["
             "0,0,1]},"
             "{'extras':{'lambent':{'seed':false,'path':1.5}},'translation':[4,4,4]}]}";
    lmb_scene *s = load_text("marks", text);
    if (!s) {
        return;
    }
    CHECK(s->instance_count == 3, "the default scene only: %u", s->instance_count);
    CHECK(s->instances[0].dynamic && s->instances[1].dynamic && !s->instances[2].dynamic, "static and its heirs");
    check_vec3(s->bounds_max, 1, 1, 50, "bounds");
    CHECK(s->seed_point_count == 1 && s->path_point_count == 3, "%u %u", s->seed_point_count, s->path_point_count);
    check_vec3(s->seed_points[0], 1, 2, 3, "seed");
    check_vec3(s->path_points[0], 0, 0, 1, "path 1");
    check_vec3(s->path_points[1], 4, 4, 4, "path 1.5");
    check_vec3(s->path_points[2], 0, 0, 2, "path 2");
    const uint64_t whole = s->content_hash;
    lmb_scene_destroy(s);
    static const struct {
        const char *pattern;
        uint32_t instances;
    } cases[] = {{"lift", 0},   {"liftD*", 2}, {"*oor", 2},  {"f?ame", 2}, {"frame?", 3}, {"*", 0},
                 {"node 6", 3}, {"", 3},       {"l*D*r", 2}, {"Lift", 3},  {"**", 0},     {"other*", 3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        int said = 0;
        const lmb_gltf_options options = {
            .exclude = &cases[i].pattern, .exclude_count = 1, .warnings = {line_count, &said}};
        if (load_text_with("marks", text, &options, &s) == LMB_OK) {
            CHECK(s->instance_count == cases[i].instances, "%s: %u", cases[i].pattern, s->instance_count);
            CHECK(s->content_hash != whole, "%s: the hash knows", cases[i].pattern);
            /* Node 6 is there, but has no triangles; `other` is there, in another scene. */
            const bool idle = cases[i].instances == 3 && cases[i].pattern[0] != 'n' && cases[i].pattern[0] != 'o';
            CHECK(said == idle, "%s: %d warnings", cases[i].pattern, said);
            lmb_scene_destroy(s);
        } else {
            CHECK(false, "%s", error.message);
        }
    }
}

static void test_repairs(void)
{
    /* 0 good, 1 two corners alike, 2 on a line, 3 NaN, 4 infinite, 5 thin but real. */
    const float z = 0, nan_value = NAN, inf = INFINITY;
    float data[18 * 6];
    const float p[18][3] = {{0, 0, z}, {1, 0, z},   {0, 1, z}, {0, 0, z}, {0, 0, z},         {0, 1, z},
                            {0, 0, z}, {1, 1, 1},   {2, 2, 2}, {0, 0, z}, {nan_value, 0, z}, {0, 1, z},
                            {0, 0, z}, {inf, 0, z}, {0, 1, z}, {0, 0, z}, {1, 0, z},         {0, 1e-6f, z}};
    for (int v = 0; v < 18; ++v) {
        memcpy(data + 3 * v, p[v], 12);
        const float normal[3] = {0, v == 0 ? 3.0f : 0.0f, v == 1 ? nan_value : 0.0f};
        memcpy(data + 54 + 3 * v, normal, 12);
    }
    CHECK(write_bytes("broken.bin", data, sizeof data), "broken.bin");
    lmb_scene *const s =
        load_text("repairs",
                  HEAD "'buffers':[{'uri':'broken.bin','byteLength':432}],'bufferViews':[{'buffer':0,'byteLength':216},"
                       "{'buffer':0,'byteOffset':216,'byteLength':216}],'accessors':["
                       "{'bufferView':0,'componentType':5126,'count':18,'type':'VEC3'},"
                       "{'bufferView':1,'componentType':5126,'count':18,'type':'VEC3'}],"
                       "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'NORMAL':1}}]}],"
                       "'nodes':[{'mesh':0},{'mesh':0,'scale':[0,0,0]},{'mesh':0,'scale':[1e-5,1e-5,1e-5]}]}");
    if (!s) {
        return;
    }
    const lmb_mesh *const m = &s->meshes[0];
    CHECK(m->triangle_count == 2 && m->source_triangle[0] == 0 && m->source_triangle[1] == 5, "kept: %u",
          m->triangle_count);
    CHECK(s->dropped_triangle_count == 4 + 2, "%u", s->dropped_triangle_count);
    CHECK(s->instance_count == 2, "nothing is scaled to nothing: %u", s->instance_count);
    check_vec3(m->normal[0], 0, 1, 0, "made unit");
    check_vec3(m->normal[1], 0, 0, 1, "NaN becomes the face's");
    check_vec3(m->normal[2], 0, 0, 1, "zero becomes the face's");
    lmb_scene_destroy(s);
}

static void test_empty_levels(void)
{
    static const char *const texts[] = {HEAD "'nodes':[]}", "{'asset':{'version':'2.0'}}",
                                        HEAD "'scenes':[{}],'nodes':[{}]}",
                                        HEAD "'scenes':[],'meshes':[{'primitives':[]}],'nodes':[{'mesh':0}]}"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; ++i) {
        lmb_scene *const s = load_text("empty", texts[i]);
        if (s) {
            CHECK(s->bounds_min.x > s->bounds_max.x, "empty bounds");
            CHECK(!lmb_scene_has_light(s), "dark");
            lmb_scene_destroy(s);
        }
    }
    lmb_scene_destroy(NULL);
}

static void test_hash_covers_buffers(void)
{
    static const char text[] = QUAD "'nodes':[{'mesh':0}]}";
    lmb_scene *const before = load_text("hash", text);
    unsigned char bytes[92] = {0};
    CHECK(write_bytes("quad.bin", bytes, sizeof bytes), "quad.bin");
    lmb_scene *const after = load_text("hash", text);
    write_quad_buffer();
    lmb_scene *const again = load_text("hash", text);
    if (before && after && again) {
        CHECK(before->content_hash != after->content_hash, "another buffer");
        CHECK(before->content_hash == again->content_hash, "the same level");
        CHECK(after->instance_count == 1 && after->dropped_triangle_count == 2, "all degenerate");
    }
    lmb_scene_destroy(before);
    lmb_scene_destroy(after);
    lmb_scene_destroy(again);
}

/* Corner UVs that differ between the corners of one vertex. */
static lmb_vec2 *make_corner_uvs(const lmb_mesh *mesh)
{
    lmb_vec2 *const uvs = calloc((size_t)mesh->triangle_count * 3 + 1, sizeof *uvs);
    for (uint32_t c = 0; uvs && c < 3 * mesh->triangle_count; ++c) {
        uvs[c].x = (float)(c % 7) / 8.0f;
        uvs[c].y = (float)(c / 2) / (float)(2 * mesh->triangle_count);
    }
    return uvs;
}

static void check_same_mesh(const lmb_mesh *a, const lmb_mesh *b, const lmb_vec2 *uvs, const char *name)
{
    CHECK(a->triangle_count == b->triangle_count, "%s: %u and %u", name, a->triangle_count, b->triangle_count);
    CHECK(b->uv[1] != NULL || b->triangle_count == 0, "%s", name);
    unsigned differences = 0;
    for (uint32_t t = 0; t < a->triangle_count && t < b->triangle_count && b->uv[1]; ++t) {
        differences += a->material[t] != b->material[t] || a->source_primitive[t] != b->source_primitive[t];
        for (int c = 0; c < 3; ++c) {
            const uint32_t v = a->triangle[t][c], w = b->triangle[t][c];
            const lmb_vec2 uv = b->uv[1][w];
            differences += memcmp(&a->position[v], &b->position[w], sizeof a->position[v]) != 0;
            differences += memcmp(&a->normal[v], &b->normal[w], sizeof a->normal[v]) != 0;
            differences += a->uv[0] && memcmp(&a->uv[0][v], &b->uv[0][w], sizeof(lmb_vec2)) != 0;
            differences += a->color && memcmp(a->color[v], b->color[w], sizeof a->color[v]) != 0;
            differences += uv.x != uvs[3 * t + (uint32_t)c].x || uv.y != uvs[3 * t + (uint32_t)c].y;
        }
    }
    CHECK(differences == 0, "%s: %u differences", name, differences);
}

static void check_rewrite(const char *name)
{
    char source[1024];
    snprintf(source, sizeof source, FOLDER "/%s.gltf", name);
    lmb_scene *before = NULL, *after = NULL;
    CHECK(lmb_gltf_load(source, NULL, &before, &error) == LMB_OK, "%s: %s", name, error.message);
    if (!before) {
        return;
    }
    lmb_gltf_uv *const uvs = calloc((size_t)before->mesh_count + 1, sizeof *uvs);
    for (uint32_t m = 0; uvs && m < before->mesh_count; ++m) {
        uvs[m] = (lmb_gltf_uv){&before->meshes[m], make_corner_uvs(&before->meshes[m])};
    }
    const lmb_result result =
        lmb_gltf_write_with_uvs(source, NULL, uvs, before->mesh_count, FOLDER "/rewritten.glb", &error);
    CHECK(result == LMB_OK, "%s: %s", name, error.message);
    CHECK(lmb_gltf_load(FOLDER "/rewritten.glb", NULL, &after, &error) == LMB_OK, "%s: %s", name, error.message);
    if (after) {
        CHECK(lmb_scene_validate(after, &error) == LMB_OK, "%s: %s", name, error.message);
        CHECK(before->mesh_count == after->mesh_count && before->instance_count == after->instance_count &&
                  before->image_count == after->image_count && before->light_count == after->light_count &&
                  before->dropped_triangle_count == after->dropped_triangle_count,
              "%s: counts", name);
        for (uint32_t m = 0; uvs && m < before->mesh_count && m < after->mesh_count; ++m) {
            check_same_mesh(&before->meshes[m], &after->meshes[m], uvs[m].corner_uv, name);
        }
        for (uint32_t i = 0; i < before->image_count && i < after->image_count; ++i) {
            const lmb_texture_image *const a = &before->images[i], *const b = &after->images[i];
            CHECK(a->width == b->width && a->height == b->height &&
                      memcmp(a->rgba, b->rgba, (size_t)a->width * (size_t)a->height * 4) == 0,
                  "%s: image %u", name, i);
        }
    }
    for (uint32_t m = 0; uvs && m < before->mesh_count; ++m) {
        free((void *)uvs[m].corner_uv);
    }
    free(uvs);
    lmb_scene_destroy(before);
    lmb_scene_destroy(after);
}

static void test_rewrite(void)
{
    /* The levels of the cases above; "materials" names an image that is not there, which its copy names too. */
    static const char *const names[] = {"one quad", "transforms", "modes",  "quantized", "sparse",  "morph",
                                        "skin",     "instances",  "lights", "marks",     "repairs", "materials"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        check_rewrite(names[i]);
    }
}

/* What nobody here understands comes through untouched. */
static void test_rewrite_keeps_the_rest(void)
{
    static const char text[] =
        QUAD "'extensionsUsed':['X_one'],'nodes':[{'mesh':0,'extras':{'a':{},'b':[],'c':null,'d':12345678901,'e':1.5},"
             "'extensions':{'X_one':{'deep':[{'er':true}]}}}],'extras':'text','unknown':{'u':[]},"
             "'animations':[{'name':'turn'}]}";
    lmb_scene *const s = load_text("rest", text);
    if (!s) {
        return;
    }
    lmb_vec2 *const corners = make_corner_uvs(&s->meshes[0]);
    const lmb_gltf_uv uv = {&s->meshes[0], corners};
    CHECK(lmb_gltf_write_with_uvs(FOLDER "/rest.gltf", NULL, &uv, 1, FOLDER "/rest.glb", &error) == LMB_OK, "%s",
          error.message);
    unsigned char *bytes = NULL;
    size_t size = 0;
    CHECK(lmb_file_read(FOLDER "/rest.glb", &bytes, &size, &error) == LMB_OK, "%s", error.message);
    static const char *const kept[] = {
        "\"extras\":{\"a\":{},\"b\":[],\"c\":null,\"d\":12345678901,\"e\":1.5}",
        "\"extensions\":{\"X_one\":{\"deep\":[{\"er\":true}]}}",
        "\"extras\":\"text\"",
        "\"unknown\":{\"u\":[]}",
        "\"animations\":[{\"name\":\"turn\"}]",
    };
    if (bytes && size > 20) {
        bytes[size - 1] = 0;
        for (size_t i = 0; i < sizeof kept / sizeof *kept; ++i) {
            CHECK(strstr((const char *)bytes + 20, kept[i]) != NULL, "%s", kept[i]);
        }
    }
    const lmb_gltf_uv twice[2] = {uv, uv};
    CHECK(lmb_gltf_write_with_uvs(FOLDER "/rest.gltf", NULL, twice, 2, FOLDER "/twice.glb", &error) ==
              LMB_ERROR_ARGUMENT,
          "%s", error.message);
    free(bytes);
    free(corners);
    lmb_scene_destroy(s);
}

static void test_validate_finds(void)
{
    lmb_scene *const s = load_text("one quad", QUAD "'nodes':[{'mesh':0}]}");
    if (!s) {
        return;
    }
    lmb_mesh *const m = &s->meshes[0];
#define BREAK(type, field, value, text)                                                                                \
    do {                                                                                                               \
        const type saved = field;                                                                                      \
        field = value;                                                                                                 \
        CHECK(lmb_scene_validate(s, &error) == LMB_ERROR_FORMAT, "%s", text);                                          \
        CHECK(strstr(error.message, text) != NULL, "%s: %s", text, error.message);                                     \
        field = saved;                                                                                                 \
    } while (0)
    BREAK(float, m->position[1].y, NAN, "mesh 0: vertex 1: position");
    BREAK(float, m->normal[2].z, 0.5f, "vertex 2: normal");
    BREAK(float, m->uv[0][3].x, INFINITY, "vertex 3: UV");
    BREAK(uint32_t, m->triangle[1][2], 6, "triangle 1: corner");
    BREAK(uint32_t, m->material[0], 1, "triangle 0: material");
    BREAK(uint32_t, s->instances[0].mesh, 1, "instance 0: mesh");
    BREAK(bool, s->instances[0].mirrored, true, "instance 0: mirrored");
    BREAK(double, s->instances[0].to_world.m[0][0], (double)NAN, "instance 0: transform");
    BREAK(double, s->instances[0].normal_to_world.m[0][0], 2.0, "instance 0: normal transform");
    BREAK(int32_t, s->materials[0].base_color_texture.image, 0, "material 0: image");
    BREAK(float, s->materials[0].base_color[1], 1.5f, "material 0: base colour");
    BREAK(float, s->materials[0].emissive.c[1], -1.0f, "material 0: emissive");
    CHECK(lmb_scene_validate(s, &error) == LMB_OK, "%s", error.message);
    lmb_scene_destroy(s);
}

static const test_case cases[] = {
    {"one quad", test_quad},
    {"transforms", test_transforms},
    {"modes", test_modes},
    {"quantised accessors", test_quantized},
    {"sparse accessors", test_sparse},
    {"morph targets", test_morph},
    {"skin", test_skin},
    {"instancing", test_instancing},
    {"materials", test_materials},
    {"lights", test_lights},
    {"light_extents", test_light_extents},
    {"lightmap marks", test_lightmap_marks},
    {"marks and exclusion", test_marks_and_exclusion},
    {"repairs", test_repairs},
    {"empty levels", test_empty_levels},
    {"hash", test_hash_covers_buffers},
    {"rewrite", test_rewrite},
    {"rewrite keeps the rest", test_rewrite_keeps_the_rest},
    {"validate finds", test_validate_finds},
};

TEST_MAIN(cases)
