/* A benchmark: how time and memory of a bake grow with what a level holds and what is asked of it.
 *
 *     lambent_growth LAMBENT [TABLE...]
 *
 * Bakes a room of 32 x 8 x 32 m with the command LAMBENT, each row in a process of its own, with 8 samples everywhere;
 * all but what the table is about stays as it is. Prints Markdown tables: peak of resident memory, CPU seconds of all
 * threads, `order`, the logarithm of their ratio to the row before over that of the numbers (1 is linear, 2 squared),
 * and the seconds of each phase, by the clock. */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include <lambent/file.h>

#include "level_builder.h"

#define SIDE_M 32.0
#define HEIGHT_M 8.0

/* The room consists of TILES x TILES meshes: no lightmap region gets larger than an image. */
enum { TILES = 4 };
#define TILE_M (SIDE_M / TILES)

/* A level, and what is asked of its bake. */
typedef struct growth_case {
    double triangles; /* of the ground */
    double points;    /* point lights */
    double emissive;  /* emissive triangles */
    double glowing;   /* texels of their texture; 0: none */
    double instances; /* of a cube of 12 triangles, beside the room */
    double probes;    /* about */
    double texels;    /* of the room, about */
} growth_case;

enum { MOST_ROWS = 6 };

/* One field of growth_case takes the values. */
typedef struct growth_table {
    const char *name;
    growth_case fixed;
    size_t offset; /* of that field */
    double values[MOST_ROWS];
} growth_table;

/* clang-format off */
static const growth_table tables[] = {
    {"triangles",          {.points = 1, .probes = 4e3, .texels = 65536},
     offsetof(growth_case, triangles), {1e4, 1e5, 1e6, 5e6}},
    {"point lights",       {.triangles = 2e3, .probes = 4e3, .texels = 65536},
     offsetof(growth_case, points),    {1, 10, 100, 1e3, 1e4}},
    {"emissive triangles", {.triangles = 2e3, .probes = 4e3, .texels = 65536},
     offsetof(growth_case, emissive),  {2, 10, 100, 1e3, 1e4}},
    {"emissive texels",    {.triangles = 2e3, .emissive = 2, .probes = 4e3, .texels = 65536},
     offsetof(growth_case, glowing),   {1 << 12, 1 << 16, 1 << 20, 1 << 22, 1 << 24}},
    {"instances",          {.triangles = 2e3, .points = 1, .probes = 4e3, .texels = 65536},
     offsetof(growth_case, instances), {1e2, 1e3, 1e4, 1e5}},
    {"probes",             {.triangles = 2e3, .points = 1, .texels = 65536},
     offsetof(growth_case, probes),    {1e3, 1e4, 1e5, 1e6}},
    {"texels",             {.triangles = 2e3, .points = 1, .probes = 4e3},
     offsetof(growth_case, texels),    {1 << 16, 1 << 18, 1 << 20, 1 << 22, 1 << 24}},
};
/* clang-format on */

static const char *const phases[] = {"load", "bvh", "layout", "place", "surface", "probes", "lightmaps", "write"};
enum { PHASES = sizeof phases / sizeof phases[0] };

/* The ground of a tile, whose corner is at (x, z) metres: hills and hollows, 4 m apart. */
typedef struct tile {
    double x, z;
} tile;

static lmb_level_point hills(const void *context, double u, double v)
{
    const tile *at = context;
    const double height = 0.2, turn = 2.0 * 3.141592653589793 / 4.0;
    const double x = at->x + u * TILE_M, z = at->z + (1.0 - v) * TILE_M;
    const double slope_x = height * turn * cos(turn * x) * sin(turn * z);
    const double slope_z = height * turn * sin(turn * x) * cos(turn * z);
    const double length = sqrt(slope_x * slope_x + slope_z * slope_z + 1.0);
    const double across = sqrt(slope_x * slope_x + 1.0);
    return (lmb_level_point){.position = {(float)x, (float)(height * sin(turn * x) * sin(turn * z)), (float)z},
                             .normal = {(float)(-slope_x / length), (float)(1.0 / length), (float)(-slope_z / length)},
                             .tangent = {(float)(1.0 / across), (float)(slope_x / across), 0.0f}};
}

static void tile_add(lmb_level_builder *builder, int material, int column, int row, double triangles)
{
    const tile at = {column * TILE_M - SIDE_M / 2, row * TILE_M - SIDE_M / 2};
    const int mesh = lmb_level_builder_add_mesh(builder, "tile");
    const int cells = (int)ceil(sqrt(triangles / 2.0) / TILES);
    const lmb_level_patch ground = {cells, cells, (float)TILE_M, (float)TILE_M, hills, &at};
    lmb_level_builder_add_patch(builder, mesh, material, &ground);
    /* Ceiling and walls; the walls reach down into the hollows. */
    lmb_level_box room =
        lmb_level_box_of((lmb_vec3){(float)at.x, -0.5f, (float)at.z},
                         (lmb_vec3){(float)(at.x + TILE_M), (float)HEIGHT_M, (float)(at.z + TILE_M)}, LMB_LEVEL_NONE);
    room.inward = true;
    room.material[3] = material;
    room.material[0] = column == 0 ? material : LMB_LEVEL_NONE;
    room.material[1] = column == TILES - 1 ? material : LMB_LEVEL_NONE;
    room.material[4] = row == 0 ? material : LMB_LEVEL_NONE;
    room.material[5] = row == TILES - 1 ? material : LMB_LEVEL_NONE;
    lmb_level_builder_add_box(builder, mesh, &room);
    lmb_level_builder_place(builder, "tile", mesh, (lmb_vec3){0.0f, 0.0f, 0.0f});
}

static void point_lights_add(lmb_level_builder *builder, double count)
{
    if (count < 1.0) {
        return;
    }
    const lmb_level_light light = {.name = "point",
                                   .type = LMB_LEVEL_LIGHT_POINT,
                                   .color = {{1.0f, 1.0f, 1.0f}},
                                   .intensity = (float)(100.0 / count)};
    const int index = lmb_level_builder_add_light(builder, &light);
    const int across = (int)ceil(sqrt(count));
    for (int i = 0; i < (int)count; ++i) {
        lmb_level_node node = lmb_level_node_default("light");
        node.light = index;
        node.translation =
            (lmb_vec3){(float)(((i % across + 0.5) / across - 0.5) * SIDE_M), 6.0f + 0.01f * (float)(i % 7),
                       (float)(((double)(i / across) + 0.5) / across * SIDE_M - SIDE_M / 2)};
        lmb_level_builder_add_node(builder, &node);
    }
}

/* A square texture, black but for one texel in 61. */
static int dots_add(lmb_level_builder *builder, double texels)
{
    const size_t side = (size_t)(sqrt(texels) + 0.5);
    uint8_t *rgba = malloc(4 * side * side);
    if (side == 0 || !rgba) {
        free(rgba);
        return LMB_LEVEL_NONE;
    }
    for (size_t i = 0; i < side * side; ++i) {
        memset(rgba + 4 * i, i * 2654435761u % 61 == 0 ? 255 : 0, 3);
        rgba[4 * i + 3] = 255;
    }
    const int image = lmb_level_builder_add_image(builder, "dots", (int)side, (int)side, rgba);
    free(rgba);
    return image;
}

/* Squares of two triangles each under the ceiling, 16 square metres in all. */
static void lamps_add(lmb_level_builder *builder, double triangles, double texels)
{
    const int count = (int)(triangles / 2.0);
    if (count == 0) {
        return;
    }
    lmb_level_material material = lmb_level_material_default();
    material.name = "lamp";
    material.base_color = (lmb_rgb){{0.0f, 0.0f, 0.0f}};
    material.emission = (lmb_rgb){{20.0f, 20.0f, 20.0f}};
    material.emissive_texture = texels > 0.0 ? dots_add(builder, texels) : LMB_LEVEL_NONE;
    material.texture_size_m = (float)(4.0 / sqrt(count));
    const int lamp = lmb_level_builder_add_material(builder, &material);
    const int mesh = lmb_level_builder_add_mesh(builder, "lamps");
    const int across = (int)ceil(sqrt(count));
    const float size = (float)(4.0 / sqrt(count));
    for (int i = 0; i < count; ++i) {
        const double x = ((i % across + 0.5) / across - 0.5) * SIDE_M * 0.9;
        const double z = ((i / across + 0.5) / across - 0.5) * SIDE_M * 0.9;
        lmb_level_builder_add_quad(builder, mesh, lamp, (lmb_vec3){(float)x, (float)HEIGHT_M - 0.5f, (float)z},
                                   (lmb_vec3){size, 0.0f, 0.0f}, (lmb_vec3){0.0f, 0.0f, size});
    }
    lmb_level_builder_place(builder, "lamps", mesh, (lmb_vec3){0.0f, 0.0f, 0.0f});
}

/* Cubes in mid-air, all of one mesh, that fill a thousandth of the room. */
static void cubes_add(lmb_level_builder *builder, int material, double count)
{
    if (count < 1.0) {
        return;
    }
    const int mesh = lmb_level_builder_add_mesh(builder, "cube");
    const float half = (float)(0.05 * SIDE_M / cbrt(count) * cbrt(HEIGHT_M / SIDE_M));
    const lmb_level_box cube =
        lmb_level_box_of((lmb_vec3){-half, -half, -half}, (lmb_vec3){half, half, half}, material);
    lmb_level_builder_add_box(builder, mesh, &cube);
    const int across = (int)ceil(cbrt(count) - 1e-9);
    for (int i = 0; i < (int)count; ++i) {
        lmb_level_node node = lmb_level_node_default("cube");
        node.mesh = mesh;
        node.translation = (lmb_vec3){(float)(((i % across + 0.5) / across - 0.5) * SIDE_M),
                                      (float)((i / across % across + 0.5) / across * (HEIGHT_M - 3.0) + 1.0),
                                      (float)(((i / across / across + 0.5) / across - 0.5) * SIDE_M)};
        lmb_level_turn(0.1f * (float)i, node.rotation);
        lmb_level_builder_add_node(builder, &node);
    }
}

static lmb_result level_write(const growth_case *grown, const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.25f);
    const lmb_level_material material = lmb_level_material_default();
    const int grey = lmb_level_builder_add_material(builder, &material);
    for (int i = 0; i < TILES * TILES; ++i) {
        tile_add(builder, grey, i % TILES, i / TILES, grown->triangles);
    }
    lamps_add(builder, grown->emissive, grown->glowing);
    point_lights_add(builder, grown->points);
    cubes_add(builder, grey, grown->instances);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* Waits for a child; false unless it ended well. */
static bool child_wait(pid_t child, struct rusage *usage)
{
    int status;
    return child > 0 && wait4(child, &status, 0, usage) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/* In a process of its own: a child's peak of memory counts what its parent held when it began. */
static bool level_make(const growth_case *grown, const char *folder)
{
    char path[512];
    snprintf(path, sizeof path, "%s/level.glb", folder);
    const pid_t child = fork();
    if (child == 0) {
        lmb_error error = {{0}};
        const lmb_result result = level_write(grown, path, &error);
        if (result != LMB_OK) {
            fprintf(stderr, "lambent_growth: %s\n", error.message);
        }
        _exit(result == LMB_OK ? 0 : 1);
    }
    struct rusage unused;
    return child_wait(child, &unused);
}

static bool level_bake(const char *lambent, const growth_case *grown, const char *folder, struct rusage *usage)
{
    char level[512], spacing[32], density[32];
    const double area = 2.0 * SIDE_M * SIDE_M + 4.0 * SIDE_M * HEIGHT_M;
    snprintf(level, sizeof level, "%s/level.glb", folder);
    snprintf(spacing, sizeof spacing, "%.6g", cbrt(SIDE_M * SIDE_M * HEIGHT_M / grown->probes));
    snprintf(density, sizeof density, "%.6g", sqrt(grown->texels / area));
    const pid_t child = fork();
    if (child == 0) {
        execl(lambent, lambent, "bake", level, "-o", folder, "--lightmaps", "--samples", "8", "--spacing", spacing,
              "--max-probes", "100000000", "--texels-per-m", density, "--quiet", (char *)NULL);
        perror(lambent);
        _exit(1);
    }
    return child_wait(child, usage);
}

static double seconds_of(struct timeval time)
{
    return (double)time.tv_sec + 1e-6 * (double)time.tv_usec;
}

/* Prints the seconds of each phase from bake.json; false when it cannot be read. */
static bool phases_print(const char *folder)
{
    char path[512];
    unsigned char *text;
    size_t size;
    snprintf(path, sizeof path, "%s/bake.json", folder);
    if (lmb_file_read(path, &text, &size, NULL) != LMB_OK) {
        return false;
    }
    cJSON *json = cJSON_ParseWithLength((const char *)text, size);
    free(text);
    const cJSON *seconds = cJSON_GetObjectItem(json, "seconds");
    for (int i = 0; i < PHASES; ++i) {
        printf(" %.2f |", cJSON_GetNumberValue(cJSON_GetObjectItem(seconds, phases[i])));
    }
    printf("\n");
    cJSON_Delete(json);
    fflush(stdout);
    return true;
}

static bool table_print(const growth_table *table, const char *lambent, const char *folder)
{
    printf("\n| %s | peak MB | CPU s | order |", table->name);
    for (int i = 0; i < PHASES; ++i) {
        printf(" %s |", phases[i]);
    }
    printf("\n|");
    for (int i = 0; i < 4 + PHASES; ++i) {
        printf("---:|");
    }
    printf("\n");
    double last_cpu = 0.0;
    for (int i = 0; i < MOST_ROWS && table->values[i] > 0.0; ++i) {
        growth_case grown = table->fixed;
        *(double *)(void *)((char *)&grown + table->offset) = table->values[i];
        struct rusage usage;
        if (!level_make(&grown, folder) || !level_bake(lambent, &grown, folder, &usage)) {
            return false;
        }
        const double cpu = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
        printf("| %.0f | %.0f | %.2f |", table->values[i], (double)usage.ru_maxrss / 1024.0, cpu);
        if (i > 0) {
            printf(" %.2f |", log(cpu / last_cpu) / log(table->values[i] / table->values[i - 1]));
        } else {
            printf(" |");
        }
        if (!phases_print(folder)) {
            return false;
        }
        last_cpu = cpu;
    }
    return true;
}

static bool table_is_asked_for(const growth_table *table, int count, char **names)
{
    bool asked = count == 0;
    for (int i = 0; i < count; ++i) {
        asked = asked || strcmp(names[i], table->name) == 0;
    }
    return asked;
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fputs("usage: lambent_growth LAMBENT [TABLE...]\n", stderr);
        return 2;
    }
    char folder[] = "/tmp/lambent_growth_XXXXXX";
    if (!mkdtemp(folder)) {
        perror(folder);
        return 1;
    }
    bool good = true;
    for (size_t i = 0; i < sizeof tables / sizeof tables[0] && good; ++i) {
        if (table_is_asked_for(&tables[i], argc - 2, argv + 2)) {
            good = table_print(&tables[i], argv[1], folder);
        }
    }
    char command[64];
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command) == 0 && good ? 0 : 1;
}
