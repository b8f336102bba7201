/* Small levels that say how much light an interpolation of probes lets through walls: rooms with red lamps beside rooms
 * with green ones. Each knows its rooms, so that whoever measures it can tell whose light is foreign where. All are
 * grey, in metres, +Y up, and near the world's origin. */
#ifndef LAMBENT_LEAK_SCENES_H
#define LAMBENT_LEAK_SCENES_H

#include <stdbool.h>
#include <stddef.h>

#include <lambent/error.h>
#include <lambent/types.h>

typedef enum lmb_leak_shape {
    LMB_LEAK_WALL,   /* two rooms of 4 x 3 x 4 m on either side of a wall */
    LMB_LEAK_CORNER, /* four rooms of 3.5 x 3 x 3.5 m around the crossing of two walls */
    LMB_LEAK_FLOORS, /* one room of 4 x 2.6 x 4 m on top of another */
    LMB_LEAK_NESTED, /* a house of 2.5 x 2.2 x 2.5 m that stands in a room of 7 x 3 x 7 m */
    LMB_LEAK_CURVED, /* a round room of 1.5 m radius in a room of 7 x 3 x 7 m */
    LMB_LEAK_DOOR,   /* as LMB_LEAK_WALL with a door, 10 cm ajar */
    LMB_LEAK_COLUMN, /* a hall of 8 x 3 x 4 m, a column of 0.5 m in its middle */
    LMB_LEAK_TABLE,  /* a room of 4 x 3 x 4 m, a table top over a lamp on the floor */
    LMB_LEAK_FENCE   /* the hall, 20 bars of 4 cm across it */
} lmb_leak_shape;

typedef struct lmb_leak_scene {
    const char *name;
    lmb_leak_shape shape;
    float wall_m;     /* thickness of what divides */
    float turn_deg;   /* about +Y */
    float tilt_deg;   /* then about +Z */
    float red, green; /* radiance of the lamps */
    bool open;        /* light gets from room to room, by ways that the truth knows too */
    bool on_lattice;  /* the middle of what divides lies on x = 0 or y = 0, so on a plane of probes of any spacing */
    bool small;       /* worth probes every quarter of a metre */
} lmb_leak_scene;

/* All scenes; `*count` of them. */
const lmb_leak_scene *lmb_leak_scenes(size_t *count);

/* NULL: there is none of that name. */
const lmb_leak_scene *lmb_leak_scene_find(const char *name);

/* @return LMB_ERROR_MEMORY, _WRITE */
lmb_result lmb_leak_scene_write(const lmb_leak_scene *scene, const char *path, lmb_error *error);

/* Space that belongs to a lamp's colour. What stands in it (lamps, columns, houses) is not cut out. */
typedef struct lmb_leak_room {
    lmb_vec3 min, max; /* in the scene's own axes */
    float radius;      /* > 0: not the box, but the upright cylinder in the middle of it */
    int home;          /* channel of its lamp: 0 red, 1 green */
} lmb_leak_room;

enum { LMB_LEAK_MOST_ROOMS = 4 };

/* Where rooms lie in one another, the inner one comes first. @return how many there are */
int lmb_leak_scene_rooms(const lmb_leak_scene *scene, lmb_leak_room room[LMB_LEAK_MOST_ROOMS]);

/* The room at a point of the world, or -1: in no room, or within a lamp or what else stands in it, but for round walls.
 */
int lmb_leak_scene_room_at(const lmb_leak_scene *scene, lmb_vec3 world);

/* A point in the scene's own axes, in the world. */
lmb_vec3 lmb_leak_scene_to_world(const lmb_leak_scene *scene, lmb_vec3 own);

#endif
