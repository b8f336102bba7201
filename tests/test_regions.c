/* Cells cut into regions: rooms whose light is known, so that whatever is mixed or missed shows. */
#include <lambent/placement.h>
#include <lambent/probes_bake.h>
#include <lambent/regions.h>

#include <stdlib.h>

#include <lambent/vector.h>

#include "leak_scenes.h"
#include "level_fixture.h"

static const char *output_path(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/regions_%s.glb", LMB_TEST_OUTPUT_DIR, name);
    return path;
}

/* A scene of two or more rooms, its cells cut. */
typedef struct rooms_fixture {
    const lmb_leak_scene *scene;
    level_fixture level;
    lmb_probes *probes;
    lmb_regions *regions;
    lmb_regions_stats stats;
} rooms_fixture;

static void rooms_close(rooms_fixture *rooms)
{
    lmb_regions_destroy(rooms->regions);
    lmb_probes_destroy(rooms->probes);
    level_fixture_close(&rooms->level);
}

/* A point of the lattice in each room. @return how many */
static uint32_t seeds_find(const rooms_fixture *rooms, float spacing, lmb_vec3d seed[LMB_LEAK_MOST_ROOMS])
{
    enum { SIDE = 7 };
    lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
    const int count = lmb_leak_scene_rooms(rooms->scene, room);
    uint32_t seeds = 0;
    for (int r = 0; r < count; ++r) {
        for (int i = 0; i < SIDE * SIDE * SIDE; ++i) {
            const float at[3] = {((float)(i % SIDE) + 0.43f) / SIDE, ((float)(i / SIDE % SIDE) + 0.43f) / SIDE,
                                 ((float)(i / SIDE / SIDE) + 0.43f) / SIDE};
            const lmb_vec3 own = lmb_vec3_of(room[r].min.x + at[0] * (room[r].max.x - room[r].min.x),
                                             room[r].min.y + at[1] * (room[r].max.y - room[r].min.y),
                                             room[r].min.z + at[2] * (room[r].max.z - room[r].min.z));
            const lmb_vec3 found = lmb_leak_scene_to_world(rooms->scene, own);
            const lmb_vec3 point = lmb_vec3_of(spacing * roundf(found.x / spacing), spacing * roundf(found.y / spacing),
                                               spacing * roundf(found.z / spacing));
            uint64_t rays = 0;
            if (lmb_leak_scene_room_at(rooms->scene, point) == r &&
                lmb_placement_is_free(rooms->level.tracer, point, &rays)) {
                seed[seeds++] = (lmb_vec3d){(double)point.x, (double)point.y, (double)point.z};
                break;
            }
        }
    }
    return seeds;
}

/* Whether a cell of the coarser of two levels is split: in every other cube of 2 x 2 x 2. */
static bool is_split(const int32_t cell[3])
{
    return ((cell[0] >> 1) + (cell[1] >> 1) + (cell[2] >> 1)) % 2 == 0;
}

/* The probes that a level of two keeps: corners of its cells. */
static int32_t points_keep(const lmb_probes *from, bool finer, int32_t (*point)[3])
{
    int32_t count = 0;
    for (int32_t i = 0; i < from->count; ++i) {
        bool kept = false;
        for (int side = 0; side < 8; ++side) {
            const int32_t *const at = from->point[i];
            const int32_t cell[3] = {at[0] - (side & 1), at[1] - (side >> 1 & 1), at[2] - (side >> 2)};
            bool whole = true;
            for (int k = 0; k < 8; ++k) {
                whole = whole &&
                        lmb_probes_find(from, 0, cell[0] + (k & 1), cell[1] + (k >> 1 & 1), cell[2] + (k >> 2)) >= 0;
            }
            const int32_t coarse[3] = {finer ? cell[0] >> 1 : cell[0], finer ? cell[1] >> 1 : cell[1],
                                       finer ? cell[2] >> 1 : cell[2]};
            kept = kept || (whole && is_split(coarse) == finer);
        }
        if (kept) {
            memcpy(point[count++], from->point[i], sizeof *point);
        }
    }
    return count;
}

/* Two levels in place of one: half the spacing in every other cube. */
static lmb_result levels_mix(lmb_probes **probes, lmb_probes *fine)
{
    lmb_probes *const coarse = *probes, *mixed = NULL;
    lmb_result result = lmb_probes_create(&mixed);
    for (int level = 0; level < 2 && result == LMB_OK; ++level) {
        const lmb_probes *const from = level == 0 ? fine : coarse;
        int32_t(*const point)[3] = malloc((size_t)from->count * sizeof *point);
        const int32_t count = points_keep(from, level == 0, point), first = mixed->count;
        result = lmb_probes_add_level(mixed, &from->level[0].lattice, (const int32_t(*)[3])point, count);
        for (int32_t i = 0; i < count && result == LMB_OK; ++i) {
            mixed->validity[first + i] =
                from->validity[lmb_probes_find(from, 0, point[i][0], point[i][1], point[i][2])];
        }
        free(point);
    }
    mixed->origin = coarse->origin;
    lmb_probes_destroy(coarse);
    lmb_probes_destroy(fine);
    *probes = mixed;
    return result;
}

static bool rooms_open(rooms_fixture *rooms, const char *name, float spacing, int levels, int threads)
{
    lmb_error error = {{0}};
    const char *const path = output_path(name);
    *rooms = (rooms_fixture){.scene = lmb_leak_scene_find(name)};
    if (!level_fixture_open(&rooms->level, path, lmb_leak_scene_write(rooms->scene, path, &error), &error, threads)) {
        return false;
    }
    lmb_placement_settings settings = lmb_placement_settings_default();
    settings.spacing = spacing;
    lmb_vec3d seed[LMB_LEAK_MOST_ROOMS];
    settings.seed_count = seeds_find(rooms, spacing, seed);
    settings.seeds = seed;
    CHECK(settings.seed_count >= 2, "%s: %u seeds", name, settings.seed_count);
    lmb_placement_stats placed;
    lmb_result result =
        lmb_placement_make(rooms->level.tracer, &settings, rooms->level.pool, &rooms->probes, &placed, &error);
    if (result == LMB_OK && levels == 2) {
        lmb_probes *fine = NULL;
        settings.spacing = 0.5f * spacing;
        result = lmb_placement_make(rooms->level.tracer, &settings, rooms->level.pool, &fine, &placed, &error);
        result = result == LMB_OK ? levels_mix(&rooms->probes, fine) : result;
    }
    if (result == LMB_OK) {
        result = lmb_regions_make(rooms->level.tracer, rooms->level.pool, NULL, rooms->probes, &rooms->regions,
                                  &rooms->stats);
    }
    CHECK(result == LMB_OK, "%s: %s %s", name, lmb_result_text(result), error.message);
    if (result != LMB_OK) {
        rooms_close(rooms);
        return false;
    }
    return true;
}

/* What light there is at a point of the world: of a room's own. */
typedef lmb_sh3_rgb light_function(const rooms_fixture *rooms, lmb_vec3 at);

static int home_of(const lmb_leak_scene *scene, lmb_vec3 at)
{
    lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
    lmb_leak_scene_rooms(scene, room);
    const int found = lmb_leak_scene_room_at(scene, at);
    return found >= 0 ? room[found].home : -1;
}

/* Red 3 in red rooms, green 5 in green ones; nothing in walls. */
static lmb_sh3_rgb steady_light(const rooms_fixture *rooms, lmb_vec3 at)
{
    lmb_sh3_rgb light = {{{{0.0f}}}};
    const int home = home_of(rooms->scene, at);
    for (int k = 0; home >= 0 && k < LMB_SH3_COUNT; ++k) {
        light.channel[home].c[k] = (home == 0 ? 3.0f : 5.0f) / (float)(k + 1);
    }
    return light;
}

/* The same, with a slope that keeps it above zero. */
static lmb_sh3_rgb sloping_light(const rooms_fixture *rooms, lmb_vec3 at)
{
    lmb_sh3_rgb light = steady_light(rooms, at);
    for (int channel = 0; channel < 3; ++channel) {
        light.channel[channel].c[0] *= 1.0f + 0.1f * at.x - 0.05f * at.y + 0.08f * at.z;
    }
    return light;
}

/* Six times as much before lamps, up to 10 cm below ceilings. */
static bool is_before_lamp(const lmb_leak_room *room, lmb_vec3 own)
{
    const float half = 0.3f * (room->max.x - room->min.x);
    return fabsf(own.x) < half && fabsf(own.z) < half && room->max.y - own.y < 0.1f;
}

/* In rooms that nothing turns. */
static lmb_sh3_rgb lamp_light(const rooms_fixture *rooms, lmb_vec3 at)
{
    lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
    lmb_leak_scene_rooms(rooms->scene, room);
    lmb_sh3_rgb light = steady_light(rooms, at);
    const int found = lmb_leak_scene_room_at(rooms->scene, at);
    const lmb_vec3 own = lmb_vec3_sub(at, lmb_leak_scene_to_world(rooms->scene, lmb_vec3_of(0, 0, 0)));
    for (int i = 0; found >= 0 && is_before_lamp(&room[found], own) && i < 3 * LMB_SH3_COUNT; ++i) {
        light.channel[i % 3].c[i / 3] *= 6.0f;
    }
    return light;
}

/* The same with something of its own at every point. */
static lmb_sh3_rgb noisy_light(const rooms_fixture *rooms, lmb_vec3 at)
{
    lmb_sh3_rgb light = steady_light(rooms, at);
    const float noise = sinf(97.0f * at.x) + sinf(71.0f * at.y) + sinf(83.0f * at.z);
    for (int channel = 0; channel < 3; ++channel) {
        light.channel[channel].c[0] *= 1.0f + 0.1f * noise;
    }
    return light;
}

/* Finishes the probes as if that had been gathered. */
static bool rooms_light(rooms_fixture *rooms, light_function *light)
{
    lmb_probe_list list;
    lmb_result result = lmb_probe_list_create(rooms->probes, rooms->regions, rooms->level.tracer, &list);
    const lmb_gather_list elements = lmb_probe_list_elements(&list);
    lmb_gathered *const gathered = calloc(elements.count + 1, sizeof *gathered);
    for (size_t i = 0; i < elements.count; ++i) {
        lmb_gather_point point;
        lmb_gather_site site = {.point = &point};
        elements.find_site(elements.context, i, &site);
        gathered[i].moments = light(rooms, point.position);
        CHECK(home_of(rooms->scene, point.position) >= 0, "element %zu at %g, %g, %g is in no room", i,
              (double)point.position.x, (double)point.position.y, (double)point.position.z);
    }
    result = lmb_probe_list_finish(&list, gathered, rooms->level.pool, rooms->probes);
    free(gathered);
    lmb_probe_list_free(&list);
    lmb_error error = {{0}};
    CHECK(result == LMB_OK && lmb_probes_validate(rooms->probes, &error) == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static lmb_sh3_rgb light_at(const rooms_fixture *rooms, lmb_vec3 at)
{
    return lmb_probes_light(rooms->probes, 0, (lmb_vec3d){(double)at.x, (double)at.y, (double)at.z});
}

/* Points of a room, `margin` metres from its faces and farther. Rooms that lie in one another are the innermost's. */
static int room_points(const rooms_fixture *rooms, const lmb_leak_room *room, float margin, lmb_vec3 *point)
{
    enum { SIDE = 9 };
    int count = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; ++i) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        const float low[3] = {room->min.x + margin, room->min.y + margin, room->min.z + margin};
        const float high[3] = {room->max.x - margin, room->max.y - margin, room->max.z - margin};
        float own[3];
        for (int axis = 0; axis < 3; ++axis) {
            own[axis] = low[axis] + (high[axis] - low[axis]) * (float)at[axis] / (float)(SIDE - 1);
        }
        point[count] = lmb_leak_scene_to_world(rooms->scene, lmb_vec3_of(own[0], own[1], own[2]));
        lmb_leak_room all[LMB_LEAK_MOST_ROOMS];
        lmb_leak_scene_rooms(rooms->scene, all);
        const int found = lmb_leak_scene_room_at(rooms->scene, point[count]);
        uint64_t rays = 0;
        count += found >= 0 && memcmp(&all[found], room, sizeof *room) == 0 &&
                 lmb_placement_is_free(rooms->level.tracer, point[count], &rays);
    }
    return count;
}
enum { MOST_ROOM_POINTS = 729 };

/* Every point of a room has its room's light, and no other's, up to a millimetre from the walls. */
static void sealed_rooms_keep_their_light(void)
{
    static const struct {
        const char *scene;
        float spacing;
        int levels;
    } table[] = {
        {"wall.1mm", 1.0f, 1},      {"wall.1mm", 0.5f, 1},      {"wall.20mm", 1.0f, 1},     {"wall.200mm", 0.5f, 1},
        {"wall.lattice", 1.0f, 1},  {"wall.lattice", 0.25f, 1}, {"turned.1mm", 1.0f, 1},    {"turned.200mm", 0.5f, 1},
        {"tilted.50mm", 1.0f, 1},   {"corner", 1.0f, 1},        {"corner.turned", 1.0f, 1}, {"floors", 1.0f, 1},
        {"corner.turned", 0.5f, 1}, {"nested", 1.0f, 1},        {"nested", 2.0f, 1},        {"curved", 2.0f, 1},
        {"wall.1mm", 1.0f, 2},      {"wall.lattice", 1.0f, 2},  {"turned.200mm", 1.0f, 2},  {"tilted.50mm", 1.0f, 2},
        {"corner.turned", 1.0f, 2}, {"floors", 0.5f, 2},        {"nested", 1.0f, 2},        {"curved", 1.0f, 2},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        rooms_fixture rooms;
        lmb_vec3 point[MOST_ROOM_POINTS];
        if (!rooms_open(&rooms, table[i].scene, table[i].spacing, table[i].levels, 2)) {
            continue;
        }
        CHECK(rooms.stats.cells_cut > 0 && rooms.stats.ghosts > 0, "%s: nothing is cut", table[i].scene);
        lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
        const int count = rooms_light(&rooms, steady_light) ? lmb_leak_scene_rooms(rooms.scene, room) : 0;
        double worst_own = 0.0, worst_foreign = 0.0;
        for (int r = 0; r < count; ++r) {
            const int points = room_points(&rooms, &room[r], 0.001f, point);
            CHECK(points > 100, "%s: %d points", table[i].scene, points);
            for (int k = 0; k < points; ++k) {
                const lmb_sh3_rgb found = light_at(&rooms, point[k]), own = steady_light(&rooms, point[k]);
                for (int channel = 0; channel < 2; ++channel) {
                    const double off = fabs((double)found.channel[channel].c[0] - (double)own.channel[channel].c[0]);
                    double *const worst = channel == room[r].home ? &worst_own : &worst_foreign;
                    *worst = fmax(*worst, off);
                }
            }
        }
        CHECK(worst_foreign == 0.0, "%s at %g m, %d levels: %g of another room's", table[i].scene,
              (double)table[i].spacing, table[i].levels, worst_foreign);
        CHECK(worst_own < 1e-3, "%s at %g m, %d levels: its own light is %g off", table[i].scene,
              (double)table[i].spacing, table[i].levels, worst_own);
        rooms_close(&rooms);
    }
}

/* Light that changes as trilinear weights can is found again; what no point says much of is held a little. */
static void slopes_are_kept(void)
{
    static const char *const names[] = {"wall.20mm", "turned.200mm", "nested"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        rooms_fixture rooms;
        lmb_vec3 point[MOST_ROOM_POINTS];
        if (!rooms_open(&rooms, names[i], 0.5f, 1, 2)) {
            continue;
        }
        lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
        const int count = rooms_light(&rooms, sloping_light) ? lmb_leak_scene_rooms(rooms.scene, room) : 0;
        for (int r = 0; r < count; ++r) {
            const int points = room_points(&rooms, &room[r], 0.01f, point);
            double squared = 0.0, light = 0.0;
            for (int k = 0; k < points; ++k) {
                const lmb_sh3_rgb found = light_at(&rooms, point[k]), own = sloping_light(&rooms, point[k]);
                const int home = room[r].home;
                const double off = (double)found.channel[home].c[0] - (double)own.channel[home].c[0];
                squared += off * off;
                light += (double)own.channel[home].c[0] * (double)own.channel[home].c[0];
            }
            CHECK(sqrt(squared / light) < 0.001, "%s, room %d: %g off", names[i], r, sqrt(squared / light));
        }
        rooms_close(&rooms);
    }
}

/* Light that ends at a lamp's edge, within cells, has its mean before the ceiling. */
static void means_are_kept_where_light_ends(void)
{
    static const float spacing[] = {1.0f, 0.5f};
    enum { SIDE = 64 };
    for (size_t i = 0; i < sizeof spacing / sizeof spacing[0]; ++i) {
        rooms_fixture rooms;
        if (!rooms_open(&rooms, "floors", spacing[i], 1, 2)) {
            continue;
        }
        lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
        lmb_leak_scene_rooms(rooms.scene, room);
        const bool lit = rooms_light(&rooms, lamp_light);
        double found = 0.0, truth = 0.0;
        for (int k = 0; k < SIDE * SIDE && lit; ++k) {
            const float across[2] = {((float)(k % SIDE) + 0.5f) / SIDE, ((float)(k / SIDE) + 0.5f) / SIDE};
            lmb_vec3 own = {room[0].min.x + across[0] * (room[0].max.x - room[0].min.x), room[0].max.y - 0.01f,
                            room[0].min.z + across[1] * (room[0].max.z - room[0].min.z)};
            own.y -= is_before_lamp(&room[0], own) ? 0.015f : 0.0f; /* it is so thick */
            const lmb_vec3 at = lmb_leak_scene_to_world(rooms.scene, own);
            found += (double)light_at(&rooms, at).channel[0].c[0];
            truth += (double)lamp_light(&rooms, at).channel[0].c[0];
        }
        CHECK(fabs(found / truth - 1.0) < 0.04, "%g m: %g of the mean", (double)spacing[i], found / truth);
        rooms_close(&rooms);
    }
}

/* The largest change that does not get smaller where a stretch of a line is halved again and again. */
static double line_break(const rooms_fixture *rooms, lmb_vec3 from, lmb_vec3 to, int channel)
{
    enum { STRETCHES = 200, HALVINGS = 12 };
    const lmb_vec3 way = lmb_vec3_sub(to, from);
    double largest = 0.0;
    for (int i = 0; i < STRETCHES; ++i) {
        float low = (float)i / STRETCHES, high = (float)(i + 1) / STRETCHES;
        double at_low = (double)light_at(rooms, lmb_vec3_mad(from, way, low)).channel[channel].c[0];
        double at_high = (double)light_at(rooms, lmb_vec3_mad(from, way, high)).channel[channel].c[0];
        for (int k = 0; k < HALVINGS; ++k) {
            const float middle = 0.5f * (low + high);
            const double at_middle = (double)light_at(rooms, lmb_vec3_mad(from, way, middle)).channel[channel].c[0];
            if (fabs(at_low - at_middle) > fabs(at_middle - at_high)) {
                high = middle;
                at_high = at_middle;
            } else {
                low = middle;
                at_low = at_middle;
            }
        }
        largest = fmax(largest, fabs(at_high - at_low));
    }
    return largest;
}

static void light_is_continuous_within_rooms(void)
{
    static const struct {
        const char *scene;
        int levels;
    } names[] = {{"wall.1mm", 1}, {"tilted.50mm", 1}, {"corner.turned", 1}, {"curved", 1},
                 {"wall.1mm", 2}, {"tilted.50mm", 2}, {"corner.turned", 2}, {"nested", 2}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        rooms_fixture rooms;
        lmb_vec3 point[MOST_ROOM_POINTS];
        if (!rooms_open(&rooms, names[i].scene, 1.0f, names[i].levels, 2)) {
            continue;
        }
        lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
        const int count = rooms_light(&rooms, noisy_light) ? lmb_leak_scene_rooms(rooms.scene, room) : 0;
        for (int r = 0; r < count; ++r) {
            const int points = room_points(&rooms, &room[r], 0.01f, point);
            int lines = 0;
            for (int k = 0; k < points && lines < 40; ++k) {
                const lmb_vec3 from = point[k], to = point[(k * 131 + 57) % points];
                lmb_hit hit;
                if (!lmb_trace_nearest(rooms.level.tracer, from, lmb_vec3_sub(to, from), 0.0f, 1.0f, &hit)) {
                    const double found = line_break(&rooms, from, to, room[r].home);
                    CHECK(found < 1e-3, "%s, room %d, line %d breaks by %g", names[i].scene, r, k, found);
                    ++lines;
                }
            }
            CHECK(lines > 5, "%s: %d lines", names[i].scene, lines);
        }
        rooms_close(&rooms);
    }
}

static bool probes_are_equal(const lmb_probes *a, const lmb_probes *b)
{
    const size_t count = (size_t)a->count;
    bool equal = a->count == b->count && a->ghost_count == b->ghost_count && a->cut.count == b->cut.count &&
                 a->cut.plane_count == b->cut.plane_count && a->cut.region_count == b->cut.region_count &&
                 memcmp(a->point, b->point, count * sizeof *a->point) == 0 &&
                 memcmp(a->radiance[0], b->radiance[0], count * sizeof *a->radiance[0]) == 0 &&
                 memcmp(a->cut.corner, b->cut.corner, a->cut.region_count * sizeof *a->cut.corner) == 0;
    for (uint32_t i = 0; equal && i < a->cut.count; ++i) {
        equal = memcmp(&a->cut.cell[i], &b->cut.cell[i], sizeof a->cut.cell[i]) == 0;
    }
    for (uint32_t i = 0; equal && i < a->cut.plane_count; ++i) {
        equal = memcmp(&a->cut.plane[i], &b->cut.plane[i], sizeof a->cut.plane[i]) == 0;
    }
    return equal;
}

static void any_number_of_threads_finds_the_same(void)
{
    static const int threads[] = {1, 2, 5};
    rooms_fixture rooms[3];
    bool opened[3];
    for (int i = 0; i < 3; ++i) {
        opened[i] = rooms_open(&rooms[i], "nested", 0.5f, 1, threads[i]) && rooms_light(&rooms[i], noisy_light);
    }
    CHECK(opened[0] && opened[1] && opened[2] && probes_are_equal(rooms[0].probes, rooms[1].probes) &&
              probes_are_equal(rooms[0].probes, rooms[2].probes),
          "other bytes");
    for (int i = 0; i < 3; ++i) {
        if (opened[i]) {
            rooms_close(&rooms[i]);
        }
    }
}

/* A wall between two rooms: every cell that it goes through has one plane and two regions, and no others are parted. */
static void a_wall_parts_cells_by_one_plane(void)
{
    rooms_fixture rooms;
    if (!rooms_open(&rooms, "wall.1mm", 1.0f, 1, 2)) {
        return;
    }
    const lmb_cut_cells *const cut = &rooms.probes->cut;
    const int32_t wall = (int32_t)floorf(lmb_leak_scene_to_world(rooms.scene, lmb_vec3_of(0, 1, 0)).x);
    int parted = 0;
    for (uint32_t i = 0; i < cut->count; ++i) {
        const lmb_cut_cell *const cell = &cut->cell[i];
        const bool in_wall = cell->point[0] == wall;
        parted += in_wall;
        CHECK(cell->region_count == (in_wall ? 2u : 1u) && cell->plane_count == (in_wall ? 1u : 0u),
              "cell %d, %d, %d: %u regions, %u planes", cell->point[0], cell->point[1], cell->point[2],
              cell->region_count, cell->plane_count);
    }
    CHECK(parted > 0 && parted == rooms.stats.cells_parted && rooms.stats.strays == 0, "%d parted, %lld strays", parted,
          (long long)rooms.stats.strays);
    lmb_regions *again = NULL;
    lmb_regions_stats stats;
    CHECK(lmb_regions_make(rooms.level.tracer, rooms.level.pool, NULL, rooms.probes, &again, &stats) ==
              LMB_ERROR_ARGUMENT,
          "cut twice");
    rooms_close(&rooms);
}

static const test_case cases[] = {
    {"sealed rooms keep their light", sealed_rooms_keep_their_light},
    {"slopes are kept", slopes_are_kept},
    {"means are kept where light ends", means_are_kept_where_light_ends},
    {"light is continuous within rooms", light_is_continuous_within_rooms},
    {"any number of threads finds the same", any_number_of_threads_finds_the_same},
    {"a wall parts cells by one plane", a_wall_parts_cells_by_one_plane},
};

TEST_MAIN(cases)
