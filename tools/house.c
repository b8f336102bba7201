#include "house.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

/* A wider house has all the points of a narrower one. */
static house house_find(double wanted)
{
    int32_t enough = 3, few = 2;
    for (house built = house_of_width(enough); points_list(&built, NULL) < wanted; built = house_of_width(enough)) {
        few = enough;
        enough *= 2;
    }
    while (enough - few > 1) {
        const int32_t middle = few + (enough - few) / 2;
        const house built = house_of_width(middle);
        if (points_list(&built, NULL) < wanted) {
            few = middle;
        } else {
            enough = middle;
        }
    }
    return house_of_width(enough);
}

lmb_probes *house_probes(double wanted)
{
    const house built = house_find(wanted);
    const int32_t count = points_list(&built, NULL);
    int32_t(*const point)[3] = malloc(((size_t)count + 1) * sizeof *point);
    lmb_probes *probes = NULL;
    const lmb_lattice lattice = {.spacing = SPACING_M, .size = {built.size[0], built.size[1], built.size[2]}};
    if (!point || lmb_probes_create(&probes) != LMB_OK) {
        free(point);
        return NULL;
    }
    points_list(&built, point);
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
