/* glTF as exporters write it: what they add, leave out, and print in their own way. */
#define FOLDER LMB_TEST_OUTPUT_DIR "/gltf_exporters"
#include "gltf_fixture.h"

#include <lambent/emitters.h>
#include <lambent/gather_sh3.h>
#include <lambent/trace.h>

#define BLENDER "{'asset':{'version':'2.0','generator':'Khronos glTF Blender I/O v4.2.60'},"

/* Nine places for warnings, and how many there were. */
static char said[9][512];
static unsigned said_count;

static void warning_keep(void *context, const char *line)
{
    (void)context;
    if (said_count < sizeof said / sizeof *said) {
        snprintf(said[said_count], sizeof said[said_count], "%s", line);
    }
    ++said_count;
}

static bool was_said(const char *text)
{
    for (unsigned i = 0; i < said_count && i < sizeof said / sizeof *said; ++i) {
        if (strstr(said[i], text)) {
            return true;
        }
    }
    return false;
}

static lmb_scene *load_listening(const char *text, const lmb_gltf_options *options)
{
    lmb_gltf_options all = options ? *options : (lmb_gltf_options){0};
    lmb_scene *scene;
    all.warnings.warn = warning_keep;
    said_count = 0;
    write_quad_buffer();
    const lmb_result result = load_text_with("exported", text, &all, &scene);
    CHECK(result == LMB_OK, "%s: %s", text, error.message);
    return scene;
}

typedef struct warning_case {
    const char *text;
    const char *warning; /* in the only one that there is; NULL: there is none */
} warning_case;

static void check_warnings(const warning_case *cases, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        lmb_scene_destroy(load_listening(cases[i].text, NULL));
        const bool right = cases[i].warning ? said_count == 1 && was_said(cases[i].warning) : said_count == 0;
        CHECK(right, "%s: %u warnings: %s", cases[i].text, said_count, said_count > 0 ? said[0] : "");
        CHECK(said_count == 0 || was_said("exported.gltf"), "names the file: %s", said[0]);
    }
}

/* KHR_node_visibility hides meshes and lamps with all below them; a marker marks whether it is seen or not. */
static void test_hidden_nodes(void)
{
#define HIDE "'extensions':{'KHR_node_visibility':{'visible':false}}"
    lmb_scene *const s = load_listening(
        QUAD
        "'extensionsUsed':['KHR_node_visibility','KHR_lights_punctual'],'extensionsRequired':['KHR_node_visibility'],"
        "'extensions':{'KHR_lights_punctual':{'lights':[{'type':'point'}]}},'nodes':["
        "{'mesh':0,'name':'seen'},{'mesh':0,'children':[2,3]," HIDE "},"
        "{'mesh':0,'extensions':{'KHR_node_visibility':{'visible':true},'KHR_lights_punctual':{'light':0}}},"
        "{'extras':{'lambent':{'seed':true}}},{'mesh':0,'extensions':{'KHR_node_visibility':{}}},"
        "{'extensions':{'KHR_node_visibility':{'visible':false},'KHR_lights_punctual':{'light':0}}}]}",
        NULL);
#undef HIDE
    if (s) {
        CHECK(s->instance_count == 2 && s->instances[0].node == 0 && s->instances[1].node == 4, "%u",
              s->instance_count);
        CHECK(s->light_count == 0 && s->seed_point_count == 1 && said_count == 0, "%u %u", s->light_count,
              s->seed_point_count);
        lmb_scene_destroy(s);
    }
}

static void test_extensions(void)
{
    static const warning_case cases[] = {
        {HEAD "'extensionsUsed':['KHR_lights_punctual','KHR_materials_clearcoat','KHR_xmp_json_ld',"
              "'KHR_physics_rigid_bodies','OMI_physics_body','KHR_texture_basisu','GODOT_single_root']}",
         NULL},
        {HEAD "'extensionsUsed':['EXT_lights_image_based']}", "EXT_lights_image_based"},
        {HEAD "'extensionsUsed':['KHR_materials_ior','EXT_lights_area','KHR_xmp','MSFT_lod','VENDOR_new']}",
         "geometry: EXT_lights_area, MSFT_lod, VENDOR_new"},
        {HEAD "'extensionsUsed':['KHR_draco_mesh_compression','EXT_meshopt_compression']}",
         "KHR_draco_mesh_compression, EXT_meshopt_compression"},
        {HEAD "'extensionsUsed':['KHR_materials_volume'],'extensionsRequired':['KHR_materials_volume']}",
         "KHR_materials_volume"},
    };
    check_warnings(cases, sizeof cases / sizeof *cases);
    char text[4096] = HEAD "'extensionsUsed':['A_0'";
    for (int i = 1; i < 100; ++i) {
        sprintf(text + strlen(text), ",'VENDOR_number_%d'", i);
    }
    strcat(text, "]}");
    lmb_scene_destroy(load_listening(text, NULL));
    CHECK(said_count == 1 && was_said("A_0, VENDOR_number_1, ") && was_said(" more"), "%u: %s", said_count, said[0]);
}

/* FLT_MAX, as it is printed with 4 to 17 digits. */
static void test_largest_numbers(void)
{
    static const char *const texts[] = {"3.403e+38",
                                        "3.4028e38",
                                        "3.40282e+38",
                                        "3.402823e+38",
                                        "3.4028235e+38",
                                        "3.40282347e+38",
                                        "3.402823466e38",
                                        "3.4028234663852886e+38",
                                        "1.7976931348623157e308"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; ++i) {
        const bool is_double = i + 1 == sizeof texts / sizeof *texts; /* only of a range */
        const char *const other = is_double ? "1" : texts[i];
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD QUAD_DATA
                 "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'material':0}]}],"
                 "'materials':[{'alphaCutoff':%s,'emissiveFactor':[%s,0,0],'normalTexture':{'index':0,"
                 "'scale':%s},'extensions':{'KHR_materials_emissive_strength':{'emissiveStrength':%s}}}],"
                 "'textures':[{}],'extensions':{'KHR_lights_punctual':{'lights':[{'type':'point','intensity'"
                 ":%s,'range':%s}]}},'nodes':[{'mesh':0,'extensions':{'KHR_lights_punctual':{'light':0}}}]}",
                 other, other, other, other, other, texts[i]);
        lmb_scene *const s = load_listening(text, NULL);
        if (s) {
            CHECK(s->light_count == 1 && s->lights[0].range == 0.0f, "%s: range %g", texts[i],
                  (double)s->lights[0].range);
            lmb_scene_destroy(s);
        }
    }
    lmb_scene *s;
    CHECK(load_text_with("large", HEAD "'nodes':[{'weights':[3.5e38]}]}", NULL, &s) == LMB_ERROR_FORMAT, "3.5e38");
}

#define QUADS(material) "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1," material "}]}],"
#define LIGHTS(list) "'extensions':{'KHR_lights_punctual':{'lights':[" list "]}},"
#define LIGHT(index) "'extensions':{'KHR_lights_punctual':{'light':" #index "}}"

/* What no texture that is worn needs may be missing, dangling or of a kind that nobody reads. */
static void test_unread_textures(void)
{
    static const warning_case cases[] = {
        {HEAD QUAD_DATA QUADS("'material':0") "'nodes':[{'mesh':0}],'textures':[{'source':0}],"
                                              "'images':[{'uri':'nowhere.png'}],"
                                              "'materials':[{'name':'rough','normalTexture':{'index':0}},{'"
                                              "normalTexture':{'index':0}}]}",
         "nowhere.png\": cannot open: No such file or directory; material 'rough' goes without its normal map"},
        {HEAD QUAD_DATA QUADS("'material':0") "'nodes':[{'mesh':0}],'materials':[{'normalTexture':{'index':5}}]}",
         "texture 5, but there are 0 textures; materials[0] goes without"},
        {HEAD QUAD_DATA QUADS(
             "'material':0") "'nodes':[{'mesh':0}],'textures':[{'extensions':{'KHR_texture_basisu':{'source':0}}}],"
                             "'materials':[{'normalTexture':{'index':0}}]}",
         "KHR_texture_basisu"},
        {HEAD QUAD_DATA QUADS(
             "'material':0") "'nodes':[{'mesh':0}],'textures':[{'source':0},{'sampler':9}],'images':[{},{'uri':'"
                             "nowhere.png'}],"
                             "'materials':[{'occlusionTexture':{'index':0},'pbrMetallicRoughness':{'"
                             "metallicRoughnessTexture':{'index':0}},"
                             "'emissiveTexture':{'index':0}},{'pbrMetallicRoughness':{'baseColorTexture':{'index':1}}},"
                             "{'pbrMetallicRoughness':{'baseColorTexture':{'index':77}}}]}",
         NULL},
    };
    check_warnings(cases, sizeof cases / sizeof *cases);
    /* One missing file of two materials is one warning, and the level with new UVs is still written. */
    lmb_scene *const s = load_listening(
        HEAD QUAD_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1,'material':0},"
                       "{'attributes':{'POSITION':0},'material':1}]}],'nodes':[{'mesh':0}],'textures':[{'source':0}],"
                       "'images':[{'uri':'nowhere.png'}],'materials':[{'normalTexture':{'index':0}},"
                       "{'normalTexture':{'index':0}}]}",
        NULL);
    if (s) {
        CHECK(said_count == 1, "%u warnings", said_count);
        const lmb_gltf_options options = {.warnings.warn = warning_keep};
        said_count = 0;
        CHECK(lmb_gltf_write_with_uvs(s->path, &options, NULL, 0, FOLDER "/rewritten.glb", &error) == LMB_OK, "%s",
              error.message);
        CHECK(said_count == 1 && was_said("nowhere.png\": cannot open"), "%u: %s", said_count, said[0]);
        lmb_scene_destroy(s);
    }
}

/* A level that lies far out is placed twice, and says everything once. */
static void test_far_level(void)
{
    lmb_scene *const s = load_listening(
        HEAD "'extensionsUsed':['NEW_thing']," QUAD_DATA QUADS("'material':0")
            LIGHTS("{'type':'point'}") "'materials':[{'name':'rough','normalTexture':{'index':5}}],"
                                       "'nodes':[{'mesh':0,'translation':[1e6,0,1e6]},{'scale':[0,0,0]," LIGHT(0) "}]}",
        NULL);
    if (s) {
        CHECK(s->origin.x != 0.0 && s->origin.z != 0.0, "it is moved");
        CHECK(said_count == 3, "%u warnings", said_count);
        CHECK(was_said("NEW_thing") && was_said("'rough' goes without") && was_said("is left out"), "%s", said[0]);
        lmb_scene_destroy(s);
    }
}

static void test_lamps_without_direction(void)
{
    static const struct {
        const char *node;
        const char *warning; /* NULL: the lamp is there */
    } cases[] = {
        {"{'scale':[0,0,0]," LIGHT(0) "}", "lamp 'bulb' is left out: its node is scaled to nothing"},
        {"{'name':'off','scale':[0,0,0]," LIGHT(2) "}", "node 'off': lamp 'sun' is left out"},
        {"{'scale':[0,0,0],'children':[1]},{'name':'below'," LIGHT(1) "}", "node 'below': lamp 'node 1'|'below'"},
        {"{'scale':[2,0,2],'rotation':[-0.70710678,0,0,0.70710678]," LIGHT(0) "}", NULL},
        {"{'matrix':[1,0,0,0,0,1,0,0,0,0,0,0,0,0,0,1]," LIGHT(2) "}", "gives it no direction"},
        {"{'scale':[1,1,0]," LIGHT(1) "}", "gives it no direction"},
        {"{'scale':[-1,1,2]," LIGHT(2) "}", NULL},
        {"{" LIGHT(3) "}", "intensity is negative"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char text[1024];
        snprintf(text, sizeof text,
                 HEAD LIGHTS("{'type':'point','name':'bulb'},{'type':'spot','spot':{}},{'type':'directional','name':"
                             "'sun'},{'type':'point','intensity':-5}") "'nodes':[%s]}",
                 cases[i].node);
        lmb_scene *const s = load_listening(text, NULL);
        if (!s) {
            continue;
        }
        const char *const warning =
            cases[i].warning && strchr(cases[i].warning, '|') ? "node 'below'" : cases[i].warning;
        CHECK(s->light_count == (warning ? 0u : 1u), "%s: %u", text, s->light_count);
        CHECK(warning ? said_count == 1 && was_said(warning) : said_count == 0, "%s: %u: %s", text, said_count,
              said[0]);
        lmb_scene_destroy(s);
    }
}

static void test_extras_forms(void)
{
    static const struct {
        const char *extras;
        bool moves;
        const char *warning;
    } cases[] = {
        {"{'lambent':{'static':false}}", true, NULL},
        {"{'lambent':{'static':0}}", true, NULL},
        {"{'lambent':{'static':0.0}}", true, NULL},
        {"{'lambent':{'static':1}}", false, NULL},
        {"{'lambent':'{\\'static\\': false}'}", true, NULL},
        {"{'lambent':'{\\'static\\': 0, \\'path\\': 1.0}'}", true, NULL},
        {"{'lambent':null,'other':{'lambent':3}}", false, NULL},
        {"null", false, NULL},
        {"{'lambent':{'static':2}}", false, "node 'door': extras.lambent.static is neither true nor false"},
        {"{'lambent':{'static':'false'}}", false, "extras.lambent.static is neither"},
        {"{'lambent':{'seed':[]}}", false, "extras.lambent.seed"},
        {"{'lambent':{'path':'a'}}", false, "extras.lambent.path is not a number"},
        {"{'lambent':{'light':1}}", false, "extras.lambent.light is not a word"},
        {"{'lambent':{'dynamic':true}}", false, "node 'door': extras.lambent.dynamic is unknown"},
        {"{'lambent':'static'}", false, "extras.lambent is neither an object nor the text of one"},
        {"{'lambent':false}", false, "extras.lambent is neither"},
        {"{'Lambent':{'static':false}}", false, "extras.Lambent is ignored"},
        {"{'lambent.static':0}", false, "extras.lambent.static is ignored"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char text[1024];
        snprintf(text, sizeof text, QUAD "'nodes':[{'name':'door','mesh':0,'extras':%s}]}", cases[i].extras);
        lmb_scene *const s = load_listening(text, NULL);
        if (!s) {
            continue;
        }
        CHECK(s->instances[0].dynamic == cases[i].moves, "%s", cases[i].extras);
        CHECK(cases[i].warning ? said_count == 1 && was_said(cases[i].warning) : said_count == 0, "%s: %u: %s",
              cases[i].extras, said_count, said[0]);
        lmb_scene_destroy(s);
    }
    static const warning_case places[] = {
        {HEAD QUAD_DATA "'meshes':[{'primitives':[],'extras':{'lambent':{'static':false}}}]}",
         "meshes[0]: extras.lambent"},
        {HEAD "'scenes':[{'extras':{'lambent':{}}}]}",
         "scenes[0]: extras.lambent is ignored: only a node's and a material's are read"},
        {HEAD "'materials':[{'extras':{'lambent':{'light_set':'a','seed':true}}}]}",
         "materials[0]: extras.lambent.seed is ignored: only light_set is read of a material"},
        {HEAD "'materials':[{'extras':{'lambent':{'light_set':7}}}]}",
         "materials[0]: extras.lambent.light_set is not a name"},
        {HEAD "'materials':[{'extras':{'lambent':{'light_set':'a b'}}}]}", "extras.lambent.light_set 'a b' is no name"},
        {HEAD LIGHTS("{'type':'point','extras':{'lambent':{'light':'off'}}}") "'nodes':[]}",
         "lights[0]: extras.lambent"},
    };
    check_warnings(places, sizeof places / sizeof *places);
    char text[4096] = QUAD "'nodes':[{}";
    for (int i = 0; i < 30; ++i) {
        strcat(text, ",{'extras':{'lambent':{'statik':false}}}");
    }
    strcat(text, "]}");
    lmb_scene_destroy(load_listening(text, NULL));
    CHECK(said_count == 9 && was_said("nodes[8]: extras.lambent.statik") && was_said("22 more doubtful extras"), "%u",
          said_count);
}

static void test_blender_light(void)
{
#define ROOM(lights, strength)                                                                                         \
    QUAD_DATA QUADS("'material':0") "'materials':[{'emissiveFactor':[1,1,1],'extensions':{'KHR_materials_emissive_"    \
                                    "strength':{'emissiveStrength':" strength                                          \
                                    "}}}]," LIGHTS(lights) "'nodes':[{'mesh':0," LIGHT(0) "}]}"
#define SUN(lux) "{'type':'directional','intensity':" lux "}"
    static const warning_case cases[] = {
        {BLENDER ROOM(SUN("3415"), "20"), "--light-scale 0.001464"},
        {BLENDER ROOM("{'type':'point','intensity':5435}", "20"), "\"Unitless\""},
        {BLENDER ROOM(SUN("5"), "20"), NULL},
        {BLENDER ROOM("{'type':'spot','spot':{},'intensity':80}", "1"), NULL},
        {BLENDER ROOM(SUN("3415"), "0"), NULL},
        {HEAD ROOM(SUN("3415"), "20"), NULL},
        {BLENDER
         "'nodes':[{'name':'Area'},{'name':'Area.001'},{'name':'Area','mesh':0},{'name':'Area51','children':[0]},"
         "{'name':'Areal'},{'name':'Light'}],'meshes':[{'primitives':[]}]}",
         "node 'Area' and 1 more is empty"},
        {HEAD "'nodes':[{'name':'Area'}]}", NULL},
    };
    check_warnings(cases, sizeof cases / sizeof *cases);
    const lmb_gltf_options scaled = {.light_scale = 1.0 / 683.0, .emission_scale = 3.0};
    lmb_scene *s = load_listening(BLENDER ROOM(SUN("3415"), "20"), &scaled);
    if (s) {
        CHECK(said_count == 0, "%s", said[0]);
        CHECK_NEAR(s->lights[0].intensity.c[1], 5.0, 1e-5, "light scale");
        CHECK_NEAR(s->materials[0].emissive.c[1], 60.0, 1e-5, "emission scale");
        const uint64_t hash = s->content_hash;
        lmb_scene_destroy(s);
        s = load_listening(BLENDER ROOM(SUN("3415"), "20"), NULL);
        CHECK(s && s->content_hash != hash, "the hash knows");
        lmb_scene_destroy(s);
    }
}

/* Textures may use any TEXCOORD; of those beyond 1 only what they use is kept. */
static void test_uv_sets(void)
{
#define SET(index) "'TEXCOORD_" #index "':2"
    lmb_scene *s =
        load_listening(HEAD QUAD_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0," SET(1) "," SET(2) "," SET(
                           3) "," SET(19) "},'indices':1,'material':0},{'attributes':{'POSITION':"
                                          "0," SET(2) "},'material':1}]}],'nodes':[{'mesh':0}],"
                                                      "'textures':[{}],'materials':[{'"
                                                      "pbrMetallicRoughness':{'baseColorTexture':{'"
                                                      "index':0,'texCoord':3}},"
                                                      "'emissiveFactor':[1,1,1],'emissiveTexture':{'"
                                                      "index':0,'extensions':{'KHR_texture_transform':{"
                                                      "'texCoord':"
                                                      "19}}},'normalTexture':{'index':0,'texCoord':1}},"
                                                      "{'emissiveTexture':{'index':0,'texCoord':2}}]}",
                       NULL);
    if (s) {
        const lmb_mesh *const m = &s->meshes[0];
        const lmb_material *const a = &s->materials[0];
        CHECK(a->base_color_texture.uv_set == 2 && a->emissive_texture.uv_set == 3 && a->normal_texture.uv_set == 1,
              "%d %d", a->base_color_texture.uv_set, a->emissive_texture.uv_set);
        CHECK(!m->uv[0] && m->uv[1] && m->uv[2] && m->uv[3] && !m->uv[4], "sets");
        CHECK(m->uv[2] && m->uv[2][1].x == 1.0f && m->uv[3][4].y == 1.0f, "values");
        lmb_scene_destroy(s);
    }
    char text[2048] = HEAD QUAD_DATA QUADS("'material':0") "'nodes':[{'mesh':0},{'mesh':1}],'textures':[{}],";
    strcpy(strstr(text, "'meshes'"), "'textures':[{}],'nodes':[{'mesh':0}],'meshes':[{'primitives':[");
    for (int i = 0; i < 7; ++i) {
        sprintf(text + strlen(text), "%s{'attributes':{'POSITION':0},'material':%d}", i > 0 ? "," : "", i);
    }
    strcat(text, "]}],'materials':[");
    for (int i = 0; i < 7; ++i) {
        sprintf(text + strlen(text), "%s{'name':'m%d','normalTexture':{'index':0,'texCoord':%d}}", i > 0 ? "," : "", i,
                i + 2);
    }
    strcat(text, "]}");
    CHECK(load_text_with("sets", text, NULL, &s) == LMB_ERROR_UNSUPPORTED, "nine sets");
    CHECK(strstr(error.message, "material 'm6': textures[0] uses TEXCOORD_8"), "%s", error.message);
    lmb_scene_destroy(s);
}

/* A plane scaled to nothing across itself is still the plane; along two axes it is gone. */
static void test_flat_scales(void)
{
    static const struct {
        const char *node;
        uint32_t instances;
        float corner[3], normal[3]; /* of vertex 2, (1, 1, 0) with the normal (0, 0, 1) */
    } cases[] = {
        {"'scale':[2,3,0]", 1, {2, 3, 0}, {0, 0, 1}},
        {"'scale':[2,3,0],'rotation':[0,0.70710678,0,0.70710678]", 1, {0, 3, -2}, {1, 0, 0}},
        {"'scale':[-2,-3,0],'translation':[0,0,5]", 1, {-2, -3, 5}, {0, 0, 1}},
        {"'matrix':[0,0,1,0,0,1,0,0,0,0,0,0,7,0,0,1]", 1, {7, 1, 1}, {-1, 0, 0}},
        {"'scale':[2,0,0]", 0, {0, 0, 0}, {0, 0, 0}},
        {"'scale':[0,0,0]", 0, {0, 0, 0}, {0, 0, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char text[1024];
        snprintf(text, sizeof text, QUAD "'nodes':[{'mesh':0,%s}]}", cases[i].node);
        lmb_scene *const s = load_listening(text, NULL);
        if (!s) {
            continue;
        }
        CHECK(s->instance_count == cases[i].instances, "%s: %u", cases[i].node, s->instance_count);
        if (s->instance_count == 1) {
            const float *const corner = cases[i].corner, *const normal = cases[i].normal;
            const double(*const n)[4] = s->instances[0].normal_to_world.m;
            check_vec3(to_world(s, 0, 2), corner[0], corner[1], corner[2], cases[i].node);
            const double length = sqrt(n[0][2] * n[0][2] + n[1][2] * n[1][2] + n[2][2] * n[2][2]);
            for (int k = 0; k < 3; ++k) {
                CHECK_NEAR(n[k][2] / length, normal[k], 1e-5, "%s: normal %d", cases[i].node, k);
            }
        }
        lmb_scene_destroy(s);
    }
}

/* Normalised irradiance on +Y at the origin. */
static double irradiance_of(const char *text)
{
    lmb_scene *const scene = load_listening(text, NULL);
    lmb_tracer *tracer = NULL;
    lmb_emitters *emitters = NULL;
    double irradiance = -1.0;
    if (scene && lmb_tracer_create(scene, NULL, 1, &tracer, &error) == LMB_OK &&
        lmb_emitters_create(tracer, &emitters) == LMB_OK) {
        const lmb_transport transport = {.tracer = tracer, .emitters = emitters, .bounces = -1};
        const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
        const lmb_gather_point point = {.hemisphere = true, .normal = up};
        lmb_rgb light;
        uint64_t rays = 0;
        const lmb_gather_samples samples = {.points = &point, .point_count = 1, .count = 4096};
        lmb_gather_irradiance(&transport, &samples, &up, 1, &light, &rays);
        irradiance = (double)light.c[1];
    }
    lmb_emitters_destroy(emitters);
    lmb_tracer_destroy(tracer);
    lmb_scene_destroy(scene);
    return irradiance;
}

static void test_light_by_analysis(void)
{
    /* The form factor of a panel of 2 x 2 m, 2 m above: 4 times that of a quarter, with sides of half the height. */
    const double side = 0.5, slant = sqrt(1.0 + side * side);
    const double panel = 4.0 * side / slant * atan(side / slant) / acos(-1.0);
#define PANEL(y) "'mesh':0,'matrix':[2,0,0,0,0,0,2,0,0,1,0,0,-1," y ",-1,1]"
#define HIDDEN "'extensions':{'KHR_node_visibility':{'visible':false}}"
    CHECK_NEAR(irradiance_of(HEAD QUAD_DATA QUADS("'material':0") "'materials':[{'emissiveFactor':[1,1,1]}]," LIGHTS(
                   "{'type':'point','intensity':100}") "'nodes':[{" PANEL("2") "},{" PANEL("1") "," HIDDEN "},{" HIDDEN
                                                                                                ",'children':[3]},"
                                                                                                "{'translation':[0,0.5,"
                                                                                                "0]," LIGHT(0) "}]}"),
               panel, 1e-3, "the hidden panel and lamp give no light");
    CHECK_NEAR(panel, 0.2395, 1e-4, "the form factor");
    CHECK_NEAR(irradiance_of(HEAD LIGHTS("{'type':'point','intensity':10,'range':3.40282347e+38}") QUAD_DATA QUADS(
                   "'mode':4") "'nodes':[{'mesh':0,'translation':[5,-5,5]},{'translation':[0,2,0]," LIGHT(0) "}]}"),
               10.0 / 4.0 / acos(-1.0), 1e-4, "10 cd at 2 m");
}

/* A stride of 0 is none, and a share rounded above 1 is 1. */
static void test_rounded_and_zero(void)
{
    lmb_scene *const s = load_listening(
        HEAD
        "'buffers':[{'uri':'quad.bin','byteLength':92}],'bufferViews':[{'buffer':0,'byteLength':48,'byteStride':0}],"
        "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'}],"
        "'materials':[{'extensions':{'KHR_materials_transmission':{'transmissionFactor':1.0000001}}}],"
        "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'mode':6,'material':0}]}],'nodes':[{'mesh':0}]}",
        NULL);
    if (s) {
        CHECK(s->meshes[0].triangle_count == 2 && s->materials[0].transmission == 1.0f, "%g",
              (double)s->materials[0].transmission);
        lmb_scene_destroy(s);
    }
}

static const test_case cases[] = {
    {"hidden nodes", test_hidden_nodes},
    {"extensions that are not read", test_extensions},
    {"largest numbers", test_largest_numbers},
    {"unread textures", test_unread_textures},
    {"a far level", test_far_level},
    {"lamps without direction", test_lamps_without_direction},
    {"forms of extras", test_extras_forms},
    {"light from Blender", test_blender_light},
    {"UV sets", test_uv_sets},
    {"flat scales", test_flat_scales},
    {"rounded and zero", test_rounded_and_zero},
    {"light by analysis", test_light_by_analysis},
};

TEST_MAIN(cases)
