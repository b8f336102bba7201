/* Levels far from the world's origin: the same light as at the origin, where they are. */
#define _POSIX_C_SOURCE 200809L
#define FOLDER LMB_TEST_OUTPUT_DIR "/far"
#include <sys/wait.h>

#include <lambent/surface.h>
#include <lambent/vdb.h>

#include "hard_level.h"

#include "far_floor.h"

static const hard_settings fine = {1.0f, 8.0f, 64};

/* Lightmap at the floor's middle, which is in the middle of its two triangles' common edge. */
static double floor_middle(const hard_level *level, const char *name)
{
    const uint32_t floor = hard_instance(level->traced.scene, name);
    return (double)sample_irradz(level->lightmap, floor, 0, 0.0f, 0.5f).irradiance_z.c[0];
}

static double volume_at(const hard_level *level, lmb_vec3d world, bool *inside)
{
    lmb_sh3_rgb radiance;
    *inside = lmb_volume_sample_at(level->volume, world, &radiance);
    return (double)lmb_sh3_rgb_irradiance(&radiance, hard_up).c[0];
}

/* Moved by multiples of the level's own unit of 8 m the floor is the same to the last bit, and so is its light. */
static void same_bytes_wherever_it_is(void)
{
    static const double positions[][3] = {{0, 0, 0},          {1e5, 0, 1e5},      {1e6, 0, 1e6},
                                          {1e7, 0, 1e7},      {-1e7, 8e5, 1e6},   {0, -1e6, 0},
                                          {1e8, -3.2e7, 1e8}, {8000, 0, -8000.0}, {10000, 0, 0}};
    hard_level first = {0};
    for (size_t i = 0; i < sizeof positions / sizeof positions[0]; ++i) {
        const double *const at = positions[i];
        char path[512];
        hard_level level;
        if (!floor_write_at("moved", at[0], at[1], at[2], path) || !hard_bake(&level, path, NULL, &fine)) {
            continue;
        }
        const lmb_vec3d origin = level.traced.scene->origin;
        CHECK(origin.x == at[0] && origin.y == at[1] && origin.z == at[2], "%g %g %g: origin %g %g %g", at[0], at[1],
              at[2], origin.x, origin.y, origin.z);
        CHECK_NEAR(floor_middle(&level, "floor"), FLOOR_LIGHT, 0.01 * FLOOR_LIGHT, "at %g", at[0]);
        bool inside;
        const double above = volume_at(&level, (lmb_vec3d){at[0] + 1.3, at[1] + 0.25, at[2] - 2.2}, &inside);
        CHECK(inside && above > 0.01, "at %g: %g", at[0], above);
        if (i == 0) {
            first = level;
            continue;
        }
        const lmb_lightmap_image *a = first.lightmap->image, *b = level.lightmap->image;
        CHECK(images_equal(level.lightmap->model, a, b), "lightmap at %g", at[0]);
        CHECK(first.probes->count == level.probes->count &&
                  memcmp(first.probes->radiance[0], level.probes->radiance[0],
                         (size_t)level.probes->count * sizeof *level.probes->radiance[0]) == 0,
              "probes at %g", at[0]);
        for (int axis = 0; axis < 3; ++axis) {
            CHECK(level.probes->level[0].lattice.min[axis] ==
                      first.probes->level[0].lattice.min[axis] + (int32_t)at[axis],
                  "at %g: axis %d from %d", at[0], axis, level.probes->level[0].lattice.min[axis]);
        }
        CHECK_NEAR(above, volume_at(&first, (lmb_vec3d){1.3, 0.25, -2.2}, &inside), 1e-6, "at %g", at[0]);
        hard_close(&level);
    }
    hard_close(&first);
}

/* Every way to bring the floor to where it is. Files hold floats: what these cannot say, nothing can. */
static void every_way_there(void)
{
    static const struct {
        const char *name, *nodes;
        double x, z; /* of the floor's middle */
    } ways[] = {
        {"opposite",
         "{'translation':[1e7,0,1e7],'children':[1,2]},{'name':'floor','mesh':0,'translation':[-9999999.7,0,-1e7]},"
         "{'translation':[-9999999.7,2,-1e7]," FLOOR_LAMP "}",
         0.3, 0.0},
        {"opposite_and_far",
         "{'translation':[1e7,0,-1e7],'children':[1,2]},{'name':'floor','mesh':0,'translation':[-2e7,0,2e7]},"
         "{'translation':[-2e7,2,2e7]," FLOOR_LAMP "}",
         -1e7, 1e7},
        {"turned",
         "{'rotation':[0,0.70710678118654752,0,0.70710678118654752],'children':[1]},"
         "{'translation':[1000000.125,0,0],'children':[2,3]},{'name':'floor','mesh':0},"
         "{'translation':[0,2,0]," FLOOR_LAMP "}",
         0.0, -1000000.125},
        {"scaled",
         "{'scale':[1000,1000,1000],'children':[1,2]},"
         "{'name':'floor','mesh':0,'translation':[1000,0,1000],'scale':[0.001,0.001,0.001]},"
         "{'translation':[1000,0.002,1000]," FLOOR_LAMP "}",
         1e6, 1e6},
        {"matrix",
         "{'name':'floor','mesh':0,'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,123456.7,0,-765432.1,1]},"
         "{'translation':[123456.7,2,-765432.1]," FLOOR_LAMP "}",
         123456.7, -765432.1},
        {"skinned",
         "{'translation':[1e6,0,1e6]},{'name':'floor','mesh':1,'skin':0},{'translation':[1e6,2,1e6]," FLOOR_LAMP "}",
         1e6, 1e6},
        {"instanced",
         "{'name':'floor','mesh':0,'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'TRANSLATION':2}}}},"
         "{'translation':[1e6,2,1e6]," FLOOR_LAMP "}",
         1e6, 1e6},
        {"far_positions", "{'name':'floor','mesh':2},{'translation':[1e6,2,1e6]," FLOOR_LAMP "}", 1e6, 1e6},
        {"far_positions_here",
         "{'name':'floor','mesh':2,'translation':[-1e6,0,-1e6]},{'translation':[0,2,0]," FLOOR_LAMP "}", 0.0, 0.0},
        {"far_positions_turned_here",
         "{'translation':[1e6,0,-1e6],'rotation':[0,-0.70710678118654752,0,0.70710678118654752],'children':[1]},"
         "{'name':'floor','mesh':2},{'translation':[0,2,0]," FLOOR_LAMP "}",
         0.0, 0.0},
    };
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; ++i) {
        char path[512], nodes[FLOOR_TEXT_SIZE];
        hard_level level;
        snprintf(nodes, sizeof nodes, "%s]%s", ways[i].nodes, ",'skins':[{'joints':[0]}");
        if (!floor_data("floor.bin", 1e6f) || !floor_write(ways[i].name, nodes, path) ||
            !hard_bake(&level, path, NULL, &fine)) {
            continue;
        }
        const lmb_scene *const scene = level.traced.scene;
        CHECK_NEAR(floor_middle(&level, "floor"), FLOOR_LIGHT, 0.01 * FLOOR_LIGHT, "%s", ways[i].name);
        lmb_vec3 corner[3];
        lmb_trace_corners(level.traced.tracer, hard_instance(scene, "floor"), 0, corner);
        const lmb_vec3d a = lmb_scene_to_world(scene, corner[0]), b = lmb_scene_to_world(scene, corner[2]);
        CHECK_NEAR(0.5 * (a.x + b.x), ways[i].x, 1e-4, "%s", ways[i].name);
        CHECK_NEAR(0.5 * (a.z + b.z), ways[i].z, 1e-4, "%s", ways[i].name);
        const lmb_vec3 lamp = scene->lights[0].position;
        CHECK_NEAR(lmb_scene_to_world(scene, lamp).z, ways[i].z, 1e-4, "%s: lamp", ways[i].name);
        hard_close(&level);
    }
}

/* Which levels are moved. `count` quads of `size` m around (x, 0, 0), and others. */
static void only_far_levels_move(void)
{
    typedef struct group {
        int count;
        double size, x;
        bool dynamic;
    } group;
    static const struct {
        const char *what;
        group groups[2];
        double x; /* of the origin, within a tenth; 0: exactly */
    } table[] = {
        {"8 m at 500 m", {{1, 8, 500, false}}, 0},
        {"8 m at 1 km", {{1, 8, 1e3, false}}, 1e3},
        {"10 km at 10 km", {{20, 1e4, 1e4, false}}, 0},
        {"10 mm at 0.5 m", {{20, 0.01, 0.5, false}}, 0},
        {"10 mm at 100 m", {{20, 0.01, 100, false}}, 100},
        {"a level, something lost far away", {{20, 8, 0, false}, {1, 1, 1e6, false}}, 0},
        {"a far level, something left at zero", {{20, 8, 1e6, false}, {1, 1, 0, false}}, 1e6},
        {"a far level under a sky around zero", {{20, 8, 1e6, false}, {4, 4e6, 0, false}}, 1e6},
        {"a level under a sky", {{20, 8, 0, false}, {4, 4e6, 0, false}}, 0},
        {"a level, a fine thing far away", {{3, 20, 0, false}, {60, 0.01, 1e6, false}}, 0},
        {"a level, things that move far away", {{3, 20, 0, false}, {60, 8, 1e6, true}}, 0},
        {"only things that move", {{3, 8, 1e6, true}}, 1e6},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        char nodes[FLOOR_TEXT_SIZE] = "{'translation':[0,5e6,0]," FLOOR_LAMP "}", path[512];
        for (int g = 0; g < 2; ++g) {
            const group *const of = &table[i].groups[g];
            for (int k = 0; k < of->count; ++k) {
                const size_t used = strlen(nodes);
                snprintf(nodes + used, sizeof nodes - used, ",{'mesh':0,'translation':[%g,%g,0],'scale':[%g,1,%g]%s}",
                         of->x, 0.02 * k * of->size, of->size / 8, of->size / 8,
                         of->dynamic ? ",'extras':{'lambent':{'static':false}}" : "");
            }
        }
        lmb_scene *scene = NULL;
        if (!floor_data("floor.bin", 1e6f) || !floor_write("moves", nodes, path)) {
            return;
        }
        const lmb_result result = lmb_gltf_load(path, NULL, &scene, &error);
        CHECK(result == LMB_OK, "%s: %s", table[i].what, error.message);
        if (scene) {
            CHECK_NEAR(scene->origin.x, table[i].x, 0.1 * table[i].x, "%s", table[i].what);
            CHECK(scene->origin.y == 0.0 && scene->origin.z == 0.0, "%s", table[i].what);
            CHECK_NEAR(lmb_scene_to_world(scene, scene->lights[0].position).y, 5e6, 1.0, "%s", table[i].what);
        }
        lmb_scene_destroy(scene);
    }
}

/* Seeds, paths and lights lie where they were put. */
static void marks_move_along(void)
{
    char path[512];
    lmb_scene *scene = NULL;
    if (!floor_data("floor.bin", 1e6f) ||
        !floor_write("marks",
                     "{'mesh':0,'translation':[1e7,0,0]},"
                     "{'translation':[10000000.25,1,0.5],'extras':{'lambent':{'seed':true,'path':2}}},"
                     "{'translation':[10000001.25,1,0.5],'extras':{'lambent':{'path':1}}},"
                     "{'translation':[9999999.75,2,3]," FLOOR_LAMP "}",
                     path)) {
        return;
    }
    CHECK(lmb_gltf_load(path, NULL, &scene, &error) == LMB_OK, "%s", error.message);
    if (!scene) {
        return;
    }
    lmb_error fault = {""};
    CHECK(lmb_scene_validate(scene, &fault) == LMB_OK, "%s", fault.message);
    CHECK(scene->origin.x == 1e7, "%g", scene->origin.x);
    CHECK(scene->seed_point_count == 1 && scene->path_point_count == 2 && scene->light_count == 1 &&
              scene->instance_count == 1 && scene->mesh_count == 1 && scene->dropped_triangle_count == 0,
          "each once");
    check_vec3(scene->seed_points[0], 0.25f, 1, 0.5f, "seed");
    check_vec3(scene->path_points[0], 1.25f, 1, 0.5f, "path 1");
    check_vec3(scene->path_points[1], 0.25f, 1, 0.5f, "path 2");
    check_vec3(scene->lights[0].position, -0.25f, 2, 3, "lamp");
    const lmb_vec3 there = lmb_scene_from_world(scene, (lmb_vec3d){10000000.1, 1.0, 2.0});
    CHECK_NEAR(there.x, 0.1, 1e-6, "from the world");
    lmb_scene_destroy(scene);
}

/* A mesh whose positions are far from its own origin is moved to near it, exactly, and its instances the other way. */
static void meshes_move_to_their_own_origin(void)
{
    static const struct {
        float away;
        bool moved;
    } table[] = {{0.0f, false}, {1000.0f, false}, {1e5f, true}, {-1e6f, true}, {1e7f, true}};
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        const float away = table[i].away;
        char path[512];
        lmb_scene *scene = NULL;
        if (!floor_data("floor.bin", away) ||
            !floor_write("recentred", "{'mesh':2,'rotation':[0,0.6,0,0.8],'scale':[2,2,2]}", path)) {
            return;
        }
        CHECK(lmb_gltf_load(path, NULL, &scene, &error) == LMB_OK, "%s", error.message);
        const lmb_mesh *const mesh = scene ? &scene->meshes[0] : NULL;
        for (uint32_t v = 0; mesh && v < 3; ++v) {
            const float x = v == 0 ? -4.0f : 4.0f, z = v < 2 ? 4.0f : -4.0f;
            const lmb_vec3 p = mesh->position[v];
            CHECK(p.x + mesh->shift.x == x + away && p.y == 0.0f && p.z + mesh->shift.z == z + away,
                  "%g: vertex %u at %g %g", (double)away, v, (double)p.x, (double)p.z);
            CHECK(!table[i].moved || (fabsf(p.x) <= 8.0f && fabsf(p.z) <= 8.0f), "%g: vertex %u", (double)away, v);
            /* Turned by 2 atan(0.6 / 0.8) about +Y, and twice as large. */
            const lmb_vec3d world = lmb_scene_to_world(scene, to_world(scene, 0, v));
            const double from_x = (double)(x + away), from_z = (double)(z + away);
            CHECK_NEAR(world.x, 2.0 * (0.28 * from_x + 0.96 * from_z),
                       1e-5 + 1e-7 * fabs((double)away) * !table[i].moved, "%g: vertex %u", (double)away, v);
            CHECK_NEAR(world.z, 2.0 * (0.28 * from_z - 0.96 * from_x),
                       1e-5 + 1e-7 * fabs((double)away) * !table[i].moved, "%g: vertex %u", (double)away, v);
        }
        CHECK(!mesh || (mesh->shift.x != 0.0f) == table[i].moved, "%g: moved", (double)away);
        lmb_scene_destroy(scene);
    }
}

/* Lattices of one spacing line up, whatever the levels' own origins, and files say where they are. */
static void lattices_line_up(void)
{
    static const double positions[] = {1000003.0, 1000010.6, 1000014.9};
    const float spacing = 0.3f;
    for (size_t i = 0; i < sizeof positions / sizeof positions[0]; ++i) {
        char path[512];
        level_fixture level;
        if (!floor_write_at("lattice", positions[i], 1.0, -positions[i], path) ||
            !level_fixture_load(&level, path, NULL, 2)) {
            return;
        }
        lmb_placement_settings settings = lmb_placement_settings_default();
        settings.spacing = spacing;
        lmb_placement_stats stats;
        lmb_probes *probes = NULL, *read = NULL;
        CHECK(lmb_placement_make(level.tracer, &settings, level.pool, &probes, &stats, &error) == LMB_OK, "%s",
              error.message);
        const char *const file = FOLDER "/lattice.vdb";
        if (probes) {
            CHECK(lmb_vdb_write(file, probes, &(lmb_vdb_metadata){"{}", "0"}, &error) == LMB_OK &&
                      lmb_vdb_read(file, &read, NULL, NULL, &error) == LMB_OK,
                  "%s", error.message);
            CHECK_NEAR(probes->level[0].lattice.min[0] * (double)spacing, positions[i] - 4.0, (double)spacing + 1e-6,
                       "the first probe");
        }
        double farthest_off = 0.0;
        int32_t lost = 0;
        for (int32_t p = 0; read && p < probes->count; ++p) {
            const int32_t *const at = probes->point[p];
            const lmb_vec3d world = lmb_scene_to_world(level.scene, lmb_probes_position(probes, p));
            farthest_off = fmax(farthest_off, fabs(world.x - at[0] * (double)spacing));
            farthest_off = fmax(farthest_off, fabs(world.z - at[2] * (double)spacing));
            lost += lmb_probes_find(read, 0, at[0], at[1], at[2]) < 0;
        }
        CHECK_NEAR(farthest_off, 0.0, 1e-5, "at %g", positions[i]);
        CHECK(read && lost == 0 && read->level[0].lattice.spacing == spacing,
              "%d probes are not where they were written to", (int)lost);
        CHECK(!read || read->origin.x == 0.0, "files count from the world's origin");
        lmb_probes_destroy(read);
        lmb_probes_destroy(probes);
        level_fixture_close(&level);
    }
}

/* A seed of the caller's is a position in the world, in double. */
static void seeds_are_places_in_the_world(void)
{
    static const struct {
        double x;
        bool reached;
    } seeds[] = {{1e7 + 0.5, true}, {1e7 + 40.0, false}, {0.5, false}};
    char path[512];
    level_fixture level;
    if (!floor_write_at("seeds", 1e7, 0.0, 0.0, path) || !level_fixture_load(&level, path, NULL, 2)) {
        return;
    }
    for (size_t i = 0; i < sizeof seeds / sizeof seeds[0]; ++i) {
        const lmb_vec3d seed = {seeds[i].x, 0.5, 0.0};
        lmb_placement_settings settings = lmb_placement_settings_default();
        settings.spacing = 1.0f;
        settings.seeds = &seed;
        settings.seed_count = 1;
        lmb_placement_stats stats;
        lmb_probes *probes = NULL;
        const lmb_result result = lmb_placement_make(level.tracer, &settings, level.pool, &probes, &stats, &error);
        CHECK((result == LMB_OK) == seeds[i].reached, "seed at %g: %s", seeds[i].x, error.message);
        lmb_probes_destroy(probes);
    }
    level_fixture_close(&level);
}

static void warning_keep(void *context, const char *line)
{
    char *const kept = context;
    snprintf(kept, 512, "%s", line);
}

/* It says so where the file's floats, or the scene's, no longer resolve a texel. */
static void coarse_floats_are_named(void)
{
    static const struct {
        const char *what, *floor;
        float texels_per_m;
        bool warned;
    } table[] = {
        {"near", "'mesh':0", 8.0f, false},
        {"far by its node", "'mesh':0,'translation':[1e6,0,1e6]", 8.0f, false},
        {"farther by its node", "'mesh':0,'translation':[1e9,0,1e9]", 8.0f, false},
        {"out of double's reach", "'mesh':0,'translation':[1e15,0,1e15]", 8.0f, true},
        {"by its positions", "'mesh':2", 8.0f, true},
        {"by its positions, large texels", "'mesh':2", 1.0f, false},
        {"by its positions, moved back", "'mesh':2,'translation':[-1e6,0,-1e6]", 8.0f, true},
        {"by its positions, shrunk", "'mesh':2,'scale':[0.001,0.001,0.001]", 8.0f, false},
        {"by its instancing", "'mesh':0,'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'TRANSLATION':2}}}",
         8.0f, true},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        char nodes[FLOOR_TEXT_SIZE], path[512], said[512] = "";
        lmb_scene *scene = NULL;
        lmb_lightmap *lightmap = NULL;
        snprintf(nodes, sizeof nodes, "{'name':'the floor',%s}", table[i].floor);
        if (!floor_data("floor.bin", 1e6f) || !floor_write("coarse", nodes, path)) {
            return;
        }
        const lmb_lightmap_settings settings = {.texels_per_m = table[i].texels_per_m,
                                                .max_image_size = 256,
                                                .padding = 1,
                                                .warnings = {warning_keep, said}};
        const bool made = lmb_gltf_load(path, NULL, &scene, &error) == LMB_OK &&
                          lmb_lightmap_create(scene, &settings, &lightmap, &error) == LMB_OK;
        CHECK(made, "%s: %s", table[i].what, error.message);
        const bool named = strstr(said, "coarse.gltf") && strstr(said, "'the floor'") && strstr(said, "apart");
        CHECK(named == table[i].warned, "%s: %s", table[i].what, said);
        lmb_lightmap_destroy(lightmap);
        lmb_scene_destroy(scene);
    }
}

/* What the command prints, both streams. @return its exit status, -1 when it cannot run */
static int run(const char *command, char *printed, size_t size)
{
    char line[2048];
    snprintf(line, sizeof line, "%s 2>&1", command);
    FILE *const pipe = popen(line, "r");
    if (!pipe) {
        return -1;
    }
    const size_t got = fread(printed, 1, size - 1, pipe);
    printed[got] = '\0';
    const int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* Runs a command with `folder` for every @ and `x` for every #, and keeps what it prints. */
static void run_at(const char *pattern, const char *folder, const char *x, char printed[4096])
{
    char command[1536] = "";
    size_t used = 0;
    for (const char *c = pattern; *c; ++c) {
        const char one[2] = {*c, '\0'};
        used += (size_t)snprintf(command + used, sizeof command - used, "%s", *c == '@' ? folder : *c == '#' ? x : one);
    }
    const int status = run(command, printed, 4096);
    CHECK(status == 0, "%s: exits with %d: %s", command, status, printed);
}

/* The commands take and print positions in the world, and find there what they find at the origin. */
static void commands_take_positions_in_the_world(void)
{
    static const struct {
        const char *what, *command, *says; /* `says`: printed for # of 1 000 000 */
        bool same;                         /* all that is printed is the same at the origin */
    } table[] = {
        {"bake",
         LMB_COMMAND " bake @.gltf -o @ --lightmaps --samples 16 --texels-per-m 4 --spacing 1 "
                     "--seed-point #.5,0.5,0.25 --quiet --force",
         "", true},
        {"sample", LMB_COMMAND " sample @/probes.lmb --at #.3,0.75,-1.3 --normal 0,1,0 --json",
         "\"position\":[1000000.3,0.75,-1.3]", false},
        {"sample from standard input", "echo #.3 0.75 -1.3 0 1 0 | " LMB_COMMAND " sample @/probes.lmb",
         "1000000.3 0.75 -1.3 ", false},
        {"probe", LMB_COMMAND " probe @.gltf --at #.3,0.1,0 --normal 0,1,0 --samples 256 --quiet",
         "probe at 1000000.3, 0.1, 0\n", false},
        {"probe from standard input",
         "echo #.3 0.1 0 0 1 0 | " LMB_COMMAND " probe @.gltf --samples 256 --quiet --json",
         "\"position\":[1000000.3,0.1,0]", false},
        {"render",
         LMB_COMMAND " render @.gltf @ -o @.exr --camera #.125,3,5 --look #.125,0,0 --size 48x32 "
                     "--object-at #.5,0.5,0.5 --exposure 0",
         "--camera 1000000.125,3,5 --look 1000000.125,", false},
        {"info", LMB_COMMAND " info @/probes.lmb", "[999996,0,-4]", false},
        {"check", LMB_COMMAND " check @.gltf @ --points 16 --samples 16 --quiet", "lightmap_vs_reference", true},
    };
    static const char *const folders[2] = {FOLDER "/here", FOLDER "/there"};
    static const char *const x[2] = {"0", "1000000"};
    char path[512];
    if (!floor_write_at("here", 0.0, 0.0, 0.0, path) || !floor_write_at("there", 1e6, 0.0, 0.0, path)) {
        return;
    }
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        char printed[2][4096];
        for (int k = 0; k < 2; ++k) {
            run_at(table[i].command, folders[k], x[k], printed[k]);
        }
        CHECK(strstr(printed[1], table[i].says), "%s: does not say '%s': %s", table[i].what, table[i].says, printed[1]);
        CHECK(!table[i].same || strcmp(printed[0], printed[1]) == 0, "%s: %s%s", table[i].what, printed[0], printed[1]);
        /* What is printed of light comes after the position. */
        const char *const light[2] = {strstr(printed[0], "irradiance"), strstr(printed[1], "irradiance")};
        const size_t length = light[0] ? strcspn(light[0], "\n") : 0;
        CHECK(!light[0] == !light[1], "%s", table[i].what);
        CHECK(!light[0] || !light[1] || strstr(table[i].command, "--json") || strncmp(light[0], light[1], length) == 0,
              "%s: %s%s", table[i].what, light[0], light[1]);
    }
    static const char *const files[] = {"/lightmap/lightmap_0.exr", "/lightmap/lightmap.json", ".exr"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; ++i) {
        unsigned char *data[2] = {NULL, NULL};
        size_t size[2] = {0, 0};
        for (int k = 0; k < 2; ++k) {
            snprintf(path, sizeof path, "%s%s", folders[k], files[i]);
            CHECK(lmb_file_read(path, &data[k], &size[k], &error) == LMB_OK, "%s", error.message);
        }
        CHECK(data[0] && data[1] && size[0] == size[1] && memcmp(data[0], data[1], size[0]) == 0, "%s", files[i]);
        free(data[0]);
        free(data[1]);
    }
}

static const test_case cases[] = {
    {"same_bytes_wherever_it_is", same_bytes_wherever_it_is},
    {"every_way_there", every_way_there},
    {"only_far_levels_move", only_far_levels_move},
    {"marks_move_along", marks_move_along},
    {"meshes_move_to_their_own_origin", meshes_move_to_their_own_origin},
    {"lattices_line_up", lattices_line_up},
    {"seeds_are_places_in_the_world", seeds_are_places_in_the_world},
    {"coarse_floats_are_named", coarse_floats_are_named},
    {"commands_take_positions_in_the_world", commands_take_positions_in_the_world},
};

TEST_MAIN(cases)
