/* The walls in a cell: planes of what lines of nodes meet, and where these end. */
#include "probes/regions_internal.h"

#include <math.h>

#include <lambent/surface.h>

/* Planes nearer to each other than that, in spacings, and of almost one normal, are one. */
#define SAME_PLANE 0.01f
#define SAME_COSINE 0.999f

/* A wall may be met that far beyond its rim, in spacings, and its plane be open as far before it. */
#define BESIDE_RIM 0.02f

/* Walls meet at an edge of a triangle that is that near to both. */
#define BESIDE_EDGE 0.01f

/* @return its number, or -1: there are too many */
static int wall_find(lmb_region_walls *walls, lmb_region_plane plane)
{
    for (int i = 0; i < walls->count; ++i) {
        if (lmb_vec3_dot(walls->wall[i].normal, plane.normal) > SAME_COSINE &&
            fabsf(walls->wall[i].offset - plane.offset) < SAME_PLANE) {
            return i;
        }
    }
    if (walls->count == LMB_REGION_WALLS_MOST) {
        return -1;
    }
    walls->wall[walls->count] = plane;
    return walls->count++;
}

/* What is met from a node, along the axis or (-1) against it. */
static void met_add(lmb_region_walls *walls, const lmb_tracer *tracer, const lmb_region_frame *frame, int node,
                    int axis, float way, float at, const lmb_hit *hit)
{
    if (lmb_region_is_unseen(tracer, hit, way < 0.0f)) {
        return;
    }
    const lmb_place place = lmb_trace_place(tracer, hit);
    const float side = lmb_vec3_dot(place.geometric_normal, frame->step[axis]) * way > 0.0f ? -1.0f : 1.0f;
    const lmb_vec3 n = lmb_vec3_scale(place.geometric_normal, side / frame->spacing);
    const lmb_vec3 normal =
        lmb_vec3_of(lmb_vec3_dot(n, frame->step[0]), lmb_vec3_dot(n, frame->step[1]), lmb_vec3_dot(n, frame->step[2]));
    const int wall = wall_find(
        walls, (lmb_region_plane){normal, lmb_vec3_dot(normal, lmb_region_coordinates(frame, place.position))});
    if (wall >= 0 && walls->met_count < LMB_REGION_MET_MOST) {
        walls->met[walls->met_count++] = (lmb_region_met){.node = (uint8_t)node,
                                                          .axis = (uint8_t)axis,
                                                          .wall = (uint8_t)wall,
                                                          .at = at,
                                                          .instance = hit->instance,
                                                          .triangle = hit->triangle};
    }
}

void lmb_region_walls_add(lmb_region_walls *walls, const lmb_tracer *tracer, const lmb_region_frame *frame, int axis,
                          int line, const lmb_region_line *found)
{
    for (int i = 0; i < found->count; ++i) {
        const int before = lmb_region_node_before(found->at[i]);
        if (before >= 0 && (i == 0 || lmb_region_node_before(found->at[i - 1]) != before)) {
            met_add(walls, tracer, frame, lmb_region_line_node(axis, line, before), axis, 1.0f, found->at[i],
                    &found->hit[i]);
        }
        if (before + 1 < LMB_REGION_SIDE &&
            (i + 1 == found->count || lmb_region_node_before(found->at[i + 1]) != before)) {
            met_add(walls, tracer, frame, lmb_region_line_node(axis, line, before + 1), axis, -1.0f, found->at[i],
                    &found->hit[i]);
        }
    }
}

/* --- rims --------------------------------------------------------------------------------------------------------- */

static void met_place(const lmb_region_met *met, float t[3])
{
    lmb_region_node_at(met->node, t);
    t[met->axis] = met->at;
}

/* Whether a rim has all that is met of a wall before it, and all that is open beyond. */
static bool is_rim(const lmb_region_walls *walls, int wall, const lmb_region_plane *rim, const float (*open)[3],
                   int open_count)
{
    bool parts = true;
    for (int i = 0; i < walls->met_count && parts; ++i) {
        float t[3];
        met_place(&walls->met[i], t);
        parts = walls->met[i].wall != wall || lmb_region_above(rim, t) < BESIDE_RIM;
    }
    for (int i = 0; i < open_count && parts; ++i) {
        parts = lmb_region_above(rim, open[i]) > -BESIDE_RIM;
    }
    return parts;
}

/* The line of a triangle's edge, the triangle below it. @return false: it has none */
static bool edge_line(const lmb_region_plane *wall, const lmb_vec3 corner[3], int edge, lmb_region_plane *line)
{
    const lmb_vec3 from = corner[edge], to = corner[(edge + 1) % 3], third = corner[(edge + 2) % 3];
    const lmb_vec3 across = lmb_vec3_cross(lmb_vec3_sub(to, from), wall->normal);
    const float length = sqrtf(lmb_vec3_dot(across, across));
    if (!(length > 1e-4f)) {
        return false;
    }
    const float side = lmb_vec3_dot(across, lmb_vec3_sub(third, from)) > 0.0f ? -1.0f : 1.0f;
    line->normal = lmb_vec3_scale(across, side / length);
    line->offset = lmb_vec3_dot(line->normal, from);
    return true;
}

/* The triangles of a wall that lines meet, by their corners in the cell. @return how many */
enum { MOST_TRIANGLES = 24 };
static int triangles_list(const lmb_region_walls *walls, int wall, const lmb_tracer *tracer,
                          const lmb_region_frame *frame, lmb_vec3 corner[MOST_TRIANGLES][3])
{
    uint32_t known[MOST_TRIANGLES][2];
    int count = 0;
    for (int i = 0; i < walls->met_count; ++i) {
        const lmb_region_met *const met = &walls->met[i];
        bool is_new = met->wall == wall && count < MOST_TRIANGLES;
        for (int k = 0; k < count && is_new; ++k) {
            is_new = known[k][0] != met->instance || known[k][1] != met->triangle;
        }
        if (is_new) {
            known[count][0] = met->instance;
            known[count][1] = met->triangle;
            lmb_trace_corners(tracer, met->instance, met->triangle, corner[count]);
            for (int k = 0; k < 3; ++k) {
                corner[count][k] = lmb_region_coordinates(frame, corner[count][k]);
            }
            ++count;
        }
    }
    return count;
}

bool lmb_region_walls_meet(const lmb_region_walls *walls, int one, int other, const lmb_tracer *tracer,
                           const lmb_region_frame *frame)
{
    lmb_vec3 corner[MOST_TRIANGLES][3];
    const int count = triangles_list(walls, one, tracer, frame, corner);
    const lmb_region_plane *const plane = &walls->wall[other];
    bool meet = false;
    for (int i = 0; i < 3 * count && !meet; ++i) {
        const lmb_vec3 from = corner[i / 3][i % 3], to = corner[i / 3][(i + 1) % 3];
        meet = fabsf(lmb_vec3_dot(plane->normal, from) - plane->offset) < BESIDE_EDGE &&
               fabsf(lmb_vec3_dot(plane->normal, to) - plane->offset) < BESIDE_EDGE;
    }
    return meet;
}

lmb_region_plane lmb_region_rim_find(const lmb_region_walls *walls, int wall, const lmb_tracer *tracer,
                                     const lmb_region_frame *frame, const float (*open)[3], int open_count)
{
    lmb_vec3 corner[MOST_TRIANGLES][3];
    const int count = triangles_list(walls, wall, tracer, frame, corner);
    for (int i = 0; i < 3 * count; ++i) {
        lmb_region_plane rim;
        if (edge_line(&walls->wall[wall], corner[i / 3], i % 3, &rim) && is_rim(walls, wall, &rim, open, open_count)) {
            return rim;
        }
    }
    return (lmb_region_plane){{0.0f, 0.0f, 0.0f}, 0.0f};
}
