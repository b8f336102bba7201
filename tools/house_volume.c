/* Makes a volume to measure the sampler on, without a bake: lambent_house_volume DIR [PROBES]
 *
 * Writes DIR/probes.vdb and DIR/probes.lmb with about that many probes (default 262144) at the points that a house with
 * a missing wing leaves free: storeys of rooms between slabs and walls one point thick, with doors in the walls. The
 * light is made up: smooth within a room, of another colour in each. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/vdb.h>

/* Points from one slab or wall to the next, with it. */
enum { STOREY = 10, ROOM = 14 };

/* Points between probes, metres. */
#define SPACING_M 0.25f

/* The house is as wide as deep and half as high. */
typedef struct house {
    int32_t size[3]; /* points */
} house;

static house house_of_width(int32_t width)
{
    return (house){{width, width / 2 > 1 ? width / 2 : 1, width}};
}

static bool point_is_free(const house *built, const int32_t point[3])
{
    const bool wing = point[0] > built->size[0] / 2 && point[2] > built->size[2] / 2;
    const bool slab = point[1] % STOREY == 0;
    const bool wall_x = point[0] % ROOM == 0, wall_z = point[2] % ROOM == 0;
    /* A door: three points wide and eight high, in the middle of each wall. */
    const bool low = point[1] % STOREY <= STOREY - 2;
    const bool door_x = low && abs(point[2] % ROOM - ROOM / 2) <= 1,
               door_z = low && abs(point[0] % ROOM - ROOM / 2) <= 1;
    const bool wall = (wall_x && !door_x) || (wall_z && !door_z);
    return !wing && !slab && !wall;
}

/* @return how many points are free; writes them where `point` is not NULL */
static int32_t points_list(const house *built, int32_t (*point)[3])
{
    int32_t count = 0;
    int32_t at[3];
    for (at[2] = 0; at[2] < built->size[2]; ++at[2]) {
        for (at[1] = 0; at[1] < built->size[1]; ++at[1]) {
            for (at[0] = 0; at[0] < built->size[0]; ++at[0]) {
                if (point_is_free(built, at)) {
                    if (point) {
                        memcpy(point[count], at, sizeof at);
                    }
                    ++count;
                }
            }
        }
    }
    return count;
}

/* Radiance of a room's own colour, with a lamp under its ceiling. */
static lmb_sh3_rgb light_at(const int32_t point[3])
{
    const int32_t room = point[0] / ROOM * 7 + point[1] / STOREY * 3 + point[2] / ROOM * 5;
    const float x = (float)(point[0] % ROOM - ROOM / 2), y = (float)(STOREY - point[1] % STOREY);
    const float z = (float)(point[2] % ROOM - ROOM / 2);
    const float square = x * x + y * y + z * z + 4.0f, length = sqrtf(square);
    const lmb_vec3 to_lamp = {-x / length, y / length, -z / length};
    const float norm = sqrtf(to_lamp.x * to_lamp.x + to_lamp.y * to_lamp.y + to_lamp.z * to_lamp.z);
    const lmb_vec3 direction = {to_lamp.x / norm, to_lamp.y / norm, to_lamp.z / norm};
    lmb_sh3_rgb light = {{{{0.0f}}}};
    lmb_rgb lamp;
    for (int c = 0; c < 3; ++c) {
        const float hue = 0.5f + 0.5f * sinf((float)room + 2.1f * (float)c);
        light.channel[c].c[0] = 0.3f + 0.2f * hue;
        lamp.c[c] = 30.0f * hue / square;
    }
    lmb_sh3_rgb_add_light(&light, direction, lamp);
    return light;
}

static lmb_probes *probes_make(const house *built)
{
    const int32_t count = points_list(built, NULL);
    int32_t(*const point)[3] = malloc(((size_t)count + 1) * sizeof *point);
    lmb_probes *probes = NULL;
    const lmb_lattice lattice = {.spacing = SPACING_M, .size = {built->size[0], built->size[1], built->size[2]}};
    if (!point || lmb_probes_create(&probes) != LMB_OK) {
        free(point);
        return NULL;
    }
    points_list(built, point);
    const lmb_result result = lmb_probes_add_level(probes, &lattice, (const int32_t(*)[3])point, count);
    free(point);
    if (result != LMB_OK) {
        lmb_probes_destroy(probes);
        return NULL;
    }
    for (int32_t probe = 0; probe < count; ++probe) {
        probes->validity[probe] = 1.0f;
        probes->radiance[0][probe] = light_at(probes->point[probe]);
    }
    return probes;
}

static lmb_result files_write(const lmb_probes *probes, const char *folder, lmb_error *error)
{
    char *const vdb = lmb_file_in(folder, "probes.vdb");
    char *const lmb = lmb_file_in(folder, "probes.lmb");
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_result result = LMB_ERROR_MEMORY;
    if (vdb && lmb) {
        result = lmb_vdb_write(vdb, probes, &(lmb_vdb_metadata){"{}", ""}, error);
    }
    if (result == LMB_OK) {
        result = lmb_pack(probes, &data, &size, NULL);
    }
    if (result == LMB_OK) {
        result = lmb_file_write(lmb, data, size, error);
    }
    free(data);
    free(vdb);
    free(lmb);
    return result;
}

int main(int argc, char **argv)
{
    const double wanted = argc > 2 ? atof(argv[2]) : 262144.0;
    if (argc < 2 || argc > 3 || !(wanted >= 1.0 && wanted <= 1e8)) {
        fputs("usage: lambent_house_volume DIR [PROBES]\n", stderr);
        return 2;
    }
    int32_t width = 3;
    house built = house_of_width(width);
    while (points_list(&built, NULL) < wanted) {
        built = house_of_width(++width);
    }
    lmb_probes *const probes = probes_make(&built);
    lmb_error error = {"out of memory"};
    const lmb_result result = probes ? files_write(probes, argv[1], &error) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        printf("%s: %d probes of %d x %d x %d points\n", argv[1], probes->count, built.size[0], built.size[1],
               built.size[2]);
    } else {
        fprintf(stderr, "lambent_house_volume: %s\n", error.message);
    }
    lmb_probes_destroy(probes);
    return result == LMB_OK ? 0 : 1;
}
