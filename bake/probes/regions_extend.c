/* What ends within a cell: light goes around it, and its sides are one region. There the cell is divided further, along
 * the plane halfway between the two walls that meet at the end: between both sides of a plate, or of an edge that a
 * wall turns around. */
#include "probes/regions_internal.h"

#include <math.h>
#include <string.h>

/* Two walls are looked at that so many lines of a part meet, and that each hide the other from so many nodes, and this
 * share of the part. */
enum { LEAST_MET = 3, LEAST_NODES = 12, LEAST_SHARE = 12 };

/* What has more walls needs smaller cells. */
enum { MOST_WALLS = 16 };

/* Walls that turn by less are smooth. */
#define SMOOTH_COSINE 0.7f

/* The sum of two walls' normals is less: they face away from each other, and meet nowhere near. A plate is thin, in
 * spacings. */
#define PLATE 0.2f
#define THIN 0.3f

/* Where a plane crosses free space is beyond the rim, or that near. */
#define ASTRAY 0.02f

/* Spacings from an end in which its plane divides, and how near to it nodes are that stand for it. */
#define REACH 0.5f
#define BESIDE 0.3f

/* Both sides of an end. */
typedef struct end_pair {
    int one, other; /* walls */
    int part;       /* that has them */
    bool is_edge;   /* they meet; or are the sides of a plate */
    lmb_region_plane plane;
    lmb_region_plane rim; /* normal 0: not found yet */
} end_pair;

static bool is_none(const lmb_region_plane *plane)
{
    return plane->normal.x == 0.0f && plane->normal.y == 0.0f && plane->normal.z == 0.0f;
}

/* Moves a plane off nodes, which rounding would put on either side of it. */
static void plane_nudge(lmb_region_plane *plane)
{
    const float near = 0.0005f;
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        float t[3];
        lmb_region_node_at(node, t);
        if (fabsf(lmb_region_above(plane, t)) < near) {
            plane->offset += 3.0f * near;
            return;
        }
    }
}

/* The plane halfway between two walls, and their edge. */
static void pair_planes(const lmb_region_walls *walls, end_pair *pair)
{
    const lmb_region_plane *const a = &walls->wall[pair->one], *const b = &walls->wall[pair->other];
    const lmb_vec3 across = lmb_vec3_sub(a->normal, b->normal), out = lmb_vec3_add(a->normal, b->normal);
    const float across_length = sqrtf(lmb_vec3_dot(across, across)), out_length = sqrtf(lmb_vec3_dot(out, out));
    pair->plane =
        (lmb_region_plane){lmb_vec3_scale(across, 1.0f / across_length), (a->offset - b->offset) / across_length};
    plane_nudge(&pair->plane);
    pair->rim = (lmb_region_plane){{0.0f, 0.0f, 0.0f}, 0.0f};
    pair->is_edge = out_length > PLATE;
    if (pair->is_edge) {
        pair->rim = (lmb_region_plane){lmb_vec3_scale(out, 1.0f / out_length), (a->offset + b->offset) / out_length};
    }
}

/* Finds the part in which two walls hide most nodes of each other, if these are many. @return the lesser number */
static int pair_count(const lmb_region_walls *walls, const int met[LMB_REGION_NODES][LMB_REGION_WALLS_MOST],
                      const lmb_region_parts *parts, const bool *divided, end_pair *pair)
{
    const lmb_region_plane *const a = &walls->wall[pair->one], *const b = &walls->wall[pair->other];
    int nodes[LMB_REGION_NODES][2] = {{0}}, most = 0;
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        float t[3];
        lmb_region_node_at(node, t);
        const bool before = lmb_region_above(a, t) > 0.0f, beside = lmb_region_above(b, t) > 0.0f;
        nodes[parts->part[node]][0] += before && !beside;
        nodes[parts->part[node]][1] += beside && !before;
    }
    for (int i = 0; i < parts->count; ++i) {
        const int less = nodes[i][0] < nodes[i][1] ? nodes[i][0] : nodes[i][1];
        if (!divided[i] && met[i][pair->one] >= LEAST_MET && met[i][pair->other] >= LEAST_MET && less >= LEAST_NODES &&
            LEAST_SHARE * less >= parts->size[i] && less > most) {
            pair->part = i;
            most = less;
        }
    }
    return most;
}

/* Takes the links of a part away that a plane crosses, and tells where they crossed it. @return how many */
static int links_cut(const lmb_region_parts *parts, int part, const lmb_region_plane *plane,
                     uint8_t link[LMB_REGION_NODES], float (*crossed)[3])
{
    int count = 0;
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        for (int axis = 0; axis < 3; ++axis) {
            if (parts->part[node] != part || (link[node] >> axis & 1) == 0) {
                continue;
            }
            float low[3], high[3];
            lmb_region_node_at(node, low);
            lmb_region_node_at(node + lmb_region_stride(axis), high);
            const float from = lmb_region_above(plane, low), to = lmb_region_above(plane, high);
            if ((from > 0.0f) == (to > 0.0f)) {
                continue;
            }
            link[node] &= (uint8_t) ~(1 << axis);
            memcpy(crossed[count], low, sizeof low);
            crossed[count++][axis] += (high[axis] - low[axis]) * from / (from - to);
        }
    }
    return count;
}
enum { MOST_CROSSED = 3 * LMB_REGION_NODES };

/* Cuts a part, if it then is two. @return where links crossed the plane; 0: it would be none, or more */
static int part_cut(const lmb_region_parts *parts, int part, const lmb_region_plane *plane,
                    uint8_t link[LMB_REGION_NODES], float crossed[MOST_CROSSED][3])
{
    lmb_region_parts cut;
    memcpy(cut.link, link, sizeof cut.link);
    const int count = links_cut(parts, part, plane, cut.link, crossed);
    lmb_region_parts_find(&cut);
    bool is_piece[LMB_REGION_NODES] = {false};
    int pieces = 0;
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        if (parts->part[node] == part && !is_piece[cut.part[node]]) {
            is_piece[cut.part[node]] = true;
            ++pieces;
        }
    }
    if (pieces != 2) {
        return 0;
    }
    memcpy(link, cut.link, sizeof cut.link);
    return count;
}

/* Finds where a pair ends, if its plane divides free space beyond alone. @return where that crosses links; 0: not so */
static int pair_end(const lmb_region_walls *walls, const lmb_tracer *tracer, const lmb_region_frame *frame,
                    const lmb_region_parts *parts, end_pair *pair, uint8_t link[LMB_REGION_NODES],
                    float crossed[MOST_CROSSED][3])
{
    if (pair->is_edge && !lmb_region_walls_meet(walls, pair->one, pair->other, tracer, frame) &&
        !lmb_region_walls_meet(walls, pair->other, pair->one, tracer, frame)) {
        return 0;
    }
    const int count = part_cut(parts, pair->part, &pair->plane, link, crossed);
    for (int i = 0; i < 2 && count > 0 && is_none(&pair->rim); ++i) {
        pair->rim = lmb_region_rim_find(walls, i == 0 ? pair->one : pair->other, tracer, frame,
                                        (const float(*)[3])crossed, count);
    }
    bool is_end = !is_none(&pair->rim);
    for (int i = 0; i < count && is_end; ++i) {
        is_end = lmb_region_above(&pair->rim, crossed[i]) > -ASTRAY;
    }
    return is_end ? count : 0;
}

/* Thin plates come first, then edges: what has both is divided at its edges. */
static int pair_score(const lmb_region_walls *walls, const end_pair *pair, int count)
{
    if (pair->is_edge) {
        return 4 * count;
    }
    return fabsf(walls->wall[pair->one].offset + walls->wall[pair->other].offset) < THIN ? 16 * count : count;
}

/* Finds the two walls that hide most of each other. @return false: there are none */
static bool pair_find(const lmb_region_walls *walls, const lmb_tracer *tracer, const lmb_region_frame *frame,
                      const lmb_region_parts *parts, const bool *divided, end_pair *best)
{
    int met[LMB_REGION_NODES][LMB_REGION_WALLS_MOST], most = 0;
    memset(met, 0, sizeof met);
    for (int i = 0; i < walls->met_count; ++i) {
        ++met[parts->part[walls->met[i].node]][walls->met[i].wall];
    }
    for (int i = 0; i < walls->count; ++i) {
        for (int k = 0; k < i; ++k) {
            end_pair pair = {.one = i, .other = k};
            if (lmb_vec3_dot(walls->wall[i].normal, walls->wall[k].normal) > SMOOTH_COSINE) {
                continue;
            }
            pair_planes(walls, &pair);
            const int count = pair_count(walls, (const int(*)[LMB_REGION_WALLS_MOST])met, parts, divided, &pair);
            const int score = pair_score(walls, &pair, count);
            uint8_t link[LMB_REGION_NODES];
            float crossed[MOST_CROSSED][3];
            memcpy(link, parts->link, sizeof link);
            if (score > most && pair_end(walls, tracer, frame, parts, &pair, link, crossed) > 0) {
                most = score;
                *best = pair;
            }
        }
    }
    return most > 0;
}

/* Finds faces that an end is near to, and through which its plane goes on. */
static void faces_find(const lmb_region_parts *parts, int part, const uint64_t open[6], lmb_region_extension *extension)
{
    for (int face = 0; face < 6; ++face) {
        bool has[2] = {false, false};
        float nearest = BESIDE;
        for (int line = 0; line < LMB_REGION_LINES; ++line) {
            const int node = lmb_region_line_node(face / 2, line, face % 2 * (LMB_REGION_SIDE - 1));
            if ((open[face] >> line & 1u) == 0 || parts->part[node] != part) {
                continue;
            }
            float t[3];
            lmb_region_node_at(node, t);
            const float height = lmb_region_above(&extension->plane, t);
            const float beyond = lmb_region_above(&extension->rim, t);
            has[height > 0.0f] = true;
            if (fabsf(height) < nearest && beyond > 0.0f && beyond < fminf(REACH, extension->reach)) {
                nearest = fabsf(height);
                extension->anchor[face] = (uint8_t)node;
            }
        }
        extension->faces |= (uint8_t)((nearest < BESIDE && has[0] && has[1]) << face);
    }
}

/* How far beyond a rim a line of nodes crosses a plane with something in between, and nodes of a part on either side;
 * INFINITY: it does not. */
static float blocked_beyond(const lmb_region_extension *extension, const lmb_region_parts *parts, int part, int axis,
                            int line)
{
    bool has[2] = {false, false};
    float blocked = INFINITY, last[3], before = 0.0f;
    for (int i = 0; i < LMB_REGION_SIDE; ++i) {
        const int node = lmb_region_line_node(axis, line, i);
        float t[3];
        lmb_region_node_at(node, t);
        const float height = lmb_region_above(&extension->plane, t);
        has[height > 0.0f] = has[height > 0.0f] || parts->part[node] == part;
        if (i > 0 && (height > 0.0f) != (before > 0.0f) &&
            ((parts->link[lmb_region_line_node(axis, line, i - 1)] >> axis & 1) == 0 || parts->part[node] != part)) {
            float crossing[3] = {last[0], last[1], last[2]};
            crossing[axis] += (t[axis] - last[axis]) * before / (before - height);
            blocked = lmb_region_above(&extension->rim, crossing);
        }
        memcpy(last, t, sizeof last);
        before = height;
    }
    return has[0] && has[1] && blocked > ASTRAY ? blocked : INFINITY;
}

/* How far beyond its rim a plane is free: as far as lines cross it before the first of those that something is in. */
static float reach_find(const lmb_region_extension *extension, const lmb_region_parts *parts, int part,
                        const float (*crossed)[3], int count)
{
    float blocked = INFINITY, reach = 0.0f;
    for (int i = 0; i < 3 * LMB_REGION_LINES; ++i) {
        blocked = fminf(blocked, blocked_beyond(extension, parts, part, i / LMB_REGION_LINES, i % LMB_REGION_LINES));
    }
    for (int i = 0; i < count; ++i) {
        const float beyond = lmb_region_above(&extension->rim, crossed[i]);
        reach = beyond < blocked && beyond > reach ? beyond : reach;
    }
    return blocked < INFINITY ? reach : INFINITY;
}

bool lmb_region_divide(const lmb_region_parts *parts, int part, lmb_region_extension *extension,
                       uint8_t link[LMB_REGION_NODES])
{
    float crossed[MOST_CROSSED][3];
    const int count = part_cut(parts, part, &extension->plane, link, crossed);
    const float reach = reach_find(extension, parts, part, (const float(*)[3])crossed, count);
    extension->reach = fminf(extension->reach, reach);
    return count > 0;
}

int lmb_region_extend(const lmb_region_walls *walls, const lmb_tracer *tracer, const lmb_region_frame *frame,
                      const uint64_t open[6], const lmb_region_parts *parts, const bool divided[LMB_REGION_NODES],
                      uint8_t link[LMB_REGION_NODES], lmb_region_extension *extension)
{
    end_pair pair;
    if (walls->count > MOST_WALLS || !pair_find(walls, tracer, frame, parts, divided, &pair)) {
        return -1;
    }
    float crossed[MOST_CROSSED][3];
    const int count = pair_end(walls, tracer, frame, parts, &pair, link, crossed);
    *extension = (lmb_region_extension){.plane = pair.plane, .rim = pair.rim};
    extension->reach = reach_find(extension, parts, pair.part, (const float(*)[3])crossed, count);
    faces_find(parts, pair.part, open, extension);
    return pair.part;
}
