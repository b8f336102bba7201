/* Trees of planes that tell a cell's regions apart: decision trees, each split chosen on what reaches it by Gini's
 * impurity (Breiman, Friedman, Olshen and Stone 1984, "Classification and Regression Trees"). */
#include "probes/regions_internal.h"

#include <math.h>
#include <string.h>

#include <lambent/surface.h>

/* Planes nearer to each other than that, in spacings, and of almost one normal, are one. */
#define SAME_PLANE 0.002f
#define SAME_COSINE 0.9995f

/* A sample beside a surface is that many spacings before it, or half of its way to the next node: more than rounding of
 * planes can move it across. */
#define BEFORE_SPACINGS 0.0005f
#define BEFORE_SHARE 0.5f

enum {
    MOST_PLANES = 64,
    MOST_MET = 256,
    /* Each line has nodes, one more beyond either face, and two ends for each part of it that something stands in;
     * triangles have three corners and three sides. */
    MOST_SAMPLES = LMB_REGION_NODES + 3 * LMB_REGION_LINES * 2 * (LMB_REGION_SIDE - 1) + 6 * MOST_MET
};

/* Of the way from where a ray met a triangle to its corners. */
#define TO_CORNER 0.95f

typedef struct tree_plane {
    int16_t normal[3], offset;
    int votes;  /* surfaces met that lie in it, */
    int facing; /* and how many more of them are seen from above alone than from below alone */
} tree_plane;

/* A side of a triangle, by the region that it is seen from. */
typedef struct tree_met {
    uint32_t instance, triangle;
    uint8_t name;
} tree_met;

typedef struct tree_work {
    const lmb_tracer *tracer;
    const lmb_region_look *look;
    lmb_region_frame frame;
    uint64_t *rays;
    tree_met met[MOST_MET];
    int met_count;
    float t[MOST_SAMPLES][3];
    uint8_t name[MOST_SAMPLES];
    int count;
    tree_plane plane[MOST_PLANES];
    int plane_count;
    uint32_t regions;
    const lmb_region_extension *divided[LMB_CELL_REGIONS_MOST]; /* [name] by what; NULL: it is one region */
    uint8_t region[LMB_CELL_REGIONS_MOST][2];                   /* [name] below what divides it, and above */
    int order[MOST_SAMPLES];                                    /* samples, those of a branch together */
    int spare[MOST_SAMPLES];
} tree_work;

static float along(const int16_t normal[3], const float t[3])
{
    return (float)normal[0] * t[0] + (float)normal[1] * t[1] + (float)normal[2] * t[2];
}

static bool is_above(const tree_plane *plane, const float t[3])
{
    return along(plane->normal, t) > (float)plane->offset;
}

int16_t lmb_region_quantised(float value)
{
    const float scaled = value * (float)LMB_CELL_UNIT;
    return (int16_t)(scaled < 0.0f ? fmaxf(scaled - 0.5f, -32767.0f) : fminf(scaled + 0.5f, 32767.0f));
}

/* --- what is to be told apart ------------------------------------------------------------------------------------- */

static void sample_add(tree_work *work, const float t[3], uint8_t name)
{
    if (name != LMB_REGION_NONE && work->count < MOST_SAMPLES) {
        memcpy(work->t[work->count], t, sizeof work->t[0]);
        work->name[work->count++] = name;
    }
}

/* In the cell's coordinates. `facing` is 1 for a surface that is seen from above alone, or 0. */
static void plane_add(tree_work *work, lmb_vec3 normal, float offset, int facing)
{
    const tree_plane added = {
        {lmb_region_quantised(normal.x), lmb_region_quantised(normal.y), lmb_region_quantised(normal.z)},
        lmb_region_quantised(offset),
        1,
        facing};
    for (int i = 0; i < work->plane_count; ++i) {
        const float one = 1.0f / (float)LMB_CELL_UNIT;
        const int16_t *const n = work->plane[i].normal;
        const float cosine = (normal.x * (float)n[0] + normal.y * (float)n[1] + normal.z * (float)n[2]) * one;
        const float side = cosine < 0.0f ? -1.0f : 1.0f;
        if (fabsf(cosine) > SAME_COSINE && fabsf((float)work->plane[i].offset * one - side * offset) < SAME_PLANE) {
            ++work->plane[i].votes;
            work->plane[i].facing += side < 0.0f ? -facing : facing;
            return;
        }
    }
    if (work->plane_count < MOST_PLANES) {
        work->plane[work->plane_count++] = added;
    }
}

static void surface_add(tree_work *work, const lmb_hit *hit)
{
    const lmb_region_frame *const frame = &work->frame;
    const lmb_place place = lmb_trace_place(work->tracer, hit);
    const float inverse = 1.0f / frame->spacing;
    const lmb_vec3 from = lmb_vec3_scale(lmb_vec3_sub(place.position, frame->first), inverse);
    const lmb_vec3 n = place.geometric_normal;
    const lmb_vec3 normal =
        lmb_vec3_of(inverse * lmb_vec3_dot(n, frame->step[0]), inverse * lmb_vec3_dot(n, frame->step[1]),
                    inverse * lmb_vec3_dot(n, frame->step[2]));
    const lmb_scene *const scene = lmb_tracer_scene(work->tracer);
    const lmb_mesh *const mesh = &scene->meshes[scene->instances[hit->instance].mesh];
    plane_add(work, normal, lmb_vec3_dot(n, from), !scene->materials[mesh->material[hit->triangle]].double_sided);
}

static bool met_before(tree_work *work, const lmb_hit *hit, uint8_t name)
{
    for (int i = 0; i < work->met_count; ++i) {
        const tree_met *const met = &work->met[i];
        if (met->instance == hit->instance && met->triangle == hit->triangle && met->name == name) {
            return true;
        }
    }
    const bool full = work->met_count == MOST_MET;
    if (!full) {
        work->met[work->met_count++] = (tree_met){hit->instance, hit->triangle, name};
    }
    return full;
}

/* How much of a way in the cell stays within it. */
static float share_within(const float from[3], const float way[3])
{
    float share = 1.0f;
    for (int axis = 0; axis < 3; ++axis) {
        const float room = way[axis] > 0.0f ? 1.0f - from[axis] : from[axis];
        share = fminf(share, fmaxf(room, 0.0f) / fmaxf(fabsf(way[axis]), 1e-6f));
    }
    return share;
}

/* From a sample beside a triangle along it, to its corners, or to where it leaves the cell: as far as that is seen, it
 * is the same region. Facets meet there, and lines of nodes are too far apart to find which side of each is which. */
static void corners_add(tree_work *work, const lmb_hit *hit, const float from[3], uint8_t name)
{
    if (name == LMB_REGION_NONE || met_before(work, hit, name)) {
        return;
    }
    lmb_vec3 corner[3];
    lmb_trace_corners(work->tracer, hit->instance, hit->triangle, corner);
    const lmb_vec3 at = lmb_trace_position(work->tracer, hit);
    const float inverse = TO_CORNER / (work->frame.spacing * work->frame.spacing);
    for (int i = 0; i < 6; ++i) {
        const lmb_vec3 side = lmb_vec3_scale(lmb_vec3_add(corner[i % 3], corner[(i + 1) % 3]), 0.5f);
        const lmb_vec3 along_it = lmb_vec3_scale(lmb_vec3_sub(i < 3 ? corner[i] : side, at), inverse);
        const float way[3] = {lmb_vec3_dot(along_it, work->frame.step[0]), lmb_vec3_dot(along_it, work->frame.step[1]),
                              lmb_vec3_dot(along_it, work->frame.step[2])};
        const float share = share_within(from, way);
        const float to[3] = {from[0] + share * way[0], from[1] + share * way[1], from[2] + share * way[2]};
        const lmb_rgb through = lmb_trace_transmittance(work->tracer, lmb_region_position(&work->frame, from),
                                                        lmb_region_position(&work->frame, to), work->rays);
        if (lmb_rgb_max(through) > 0.0f) {
            sample_add(work, to, name);
        }
    }
}

/* How far along the axis a sample stays away from a surface whose next node is `way` from it. */
static float before_surface(const tree_work *work, const lmb_hit *hit, int axis, float way)
{
    const lmb_vec3 normal = lmb_trace_place(work->tracer, hit).geometric_normal;
    const float cosine = fabsf(lmb_vec3_dot(normal, work->frame.step[axis])) / work->frame.spacing;
    return lmb_smaller(BEFORE_SHARE * way, BEFORE_SPACINGS / lmb_larger(cosine, 0.01f));
}

/* Both ends of what stands between two nodes of a line: the first and the last surface. */
static void ends_add(tree_work *work, const uint8_t *name, int axis, int line, const lmb_region_line *found)
{
    float t[3];
    for (int i = 0; i < found->count; ++i) {
        const int node = lmb_region_node_before(found->at[i]);
        if (node < 0 || node + 1 >= LMB_REGION_SIDE) {
            continue;
        }
        const int low = lmb_region_line_node(axis, line, node), high = lmb_region_line_node(axis, line, node + 1);
        if (i == 0 || lmb_region_node_before(found->at[i - 1]) != node) {
            lmb_region_node_at(low, t);
            t[axis] = found->at[i] - before_surface(work, &found->hit[i], axis, found->at[i] - t[axis]);
            sample_add(work, t, name[low]);
            corners_add(work, &found->hit[i], t, name[low]);
        }
        if (i + 1 == found->count || lmb_region_node_before(found->at[i + 1]) != node) {
            lmb_region_node_at(high, t);
            t[axis] = found->at[i] + before_surface(work, &found->hit[i], axis, t[axis] - found->at[i]);
            sample_add(work, t, name[high]);
            corners_add(work, &found->hit[i], t, name[high]);
        }
    }
}

static void samples_find(tree_work *work, const lmb_region_work *all, const lmb_region_cell *cell,
                         const uint8_t name[LMB_CELL_REGIONS_MOST])
{
    const lmb_region_look *const look = &all->look[cell->look];
    uint8_t node_name[LMB_REGION_NODES];
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        float t[3];
        lmb_region_node_at(node, t);
        node_name[node] = look->label[node] == LMB_REGION_NONE ? LMB_REGION_NONE : name[look->label[node]];
        sample_add(work, t, node_name[node]);
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (int line = 0; line < LMB_REGION_LINES; ++line) {
            lmb_region_line found;
            lmb_region_line_trace(work->tracer, &work->frame, axis, line, &found, work->rays);
            for (int i = 0; i < found.count; ++i) {
                surface_add(work, &found.hit[i]);
            }
            ends_add(work, node_name, axis, line, &found);
        }
    }
}

/* --- splits ------------------------------------------------------------------------------------------------------- */

typedef struct branch {
    int first, count; /* of `order` */
    int parent, side; /* the plane that leads here; parent -1: the root */
} branch;

static double impurity(const int count[LMB_CELL_REGIONS_MOST], uint32_t regions)
{
    double sum = 0.0, squares = 0.0;
    for (uint32_t i = 0; i < regions; ++i) {
        sum += count[i];
        squares += (double)count[i] * count[i];
    }
    return sum > 0.0 ? sum - squares / sum : 0.0;
}

/* How mixed both sides of a plane are; infinite where all is on one side. */
static double plane_impurity(const tree_work *work, const branch *at, const tree_plane *plane)
{
    int count[2][LMB_CELL_REGIONS_MOST] = {{0}}, above = 0;
    for (int i = at->first; i < at->first + at->count; ++i) {
        const int sample = work->order[i];
        const bool side = is_above(plane, work->t[sample]);
        above += side;
        ++count[side][work->name[sample]];
    }
    return above == 0 || above == at->count ? (double)INFINITY
                                            : impurity(count[0], work->regions) + impurity(count[1], work->regions);
}

/* The plane halfway between the two samples of different regions that are nearest to each other: where no surface's
 * plane parts anything. */
static tree_plane plane_between(const tree_work *work, const branch *at)
{
    float nearest = INFINITY;
    int pair[2] = {work->order[at->first], work->order[at->first]};
    for (int i = at->first; i < at->first + at->count; ++i) {
        for (int k = at->first; k < i; ++k) {
            const int a = work->order[i], b = work->order[k];
            const float *const p = work->t[a], *const q = work->t[b];
            const float squared =
                (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]);
            if (work->name[a] != work->name[b] && squared < nearest) {
                nearest = squared;
                pair[0] = a;
                pair[1] = b;
            }
        }
    }
    const float *const p = work->t[pair[0]], *const q = work->t[pair[1]];
    const float length = sqrtf(nearest);
    const lmb_vec3 normal = lmb_vec3_of((q[0] - p[0]) / length, (q[1] - p[1]) / length, (q[2] - p[2]) / length);
    const float offset = 0.5f * (normal.x * (p[0] + q[0]) + normal.y * (p[1] + q[1]) + normal.z * (p[2] + q[2]));
    return (tree_plane){
        {lmb_region_quantised(normal.x), lmb_region_quantised(normal.y), lmb_region_quantised(normal.z)},
        lmb_region_quantised(offset),
        0,
        0};
}

/* Moves a plane into the middle between what it parts: off the surface that it was found at, where points that are lit
 * lie. Where all surfaces in it are seen from one side alone it moves towards their backs: what lies on them is before
 * them. */
static void plane_centre(const tree_work *work, const branch *at, tree_plane *plane)
{
    float below = -INFINITY, above = INFINITY;
    for (int i = at->first; i < at->first + at->count; ++i) {
        const float *const t = work->t[work->order[i]];
        const float found = along(plane->normal, t);
        if (found > (float)plane->offset) {
            above = fminf(above, found);
        } else {
            below = fmaxf(below, found);
        }
    }
    const float own = (float)plane->offset;
    if (plane->facing > 0 && plane->facing == plane->votes) {
        above = own;
    } else if (plane->facing < 0 && plane->facing == -plane->votes) {
        below = own;
    }
    const float middle = floorf(0.5f * (below + above));
    if (middle >= below && middle < above) {
        plane->offset = (int16_t)fmaxf(fminf(middle, 32767.0f), -32767.0f);
    }
}

/* The best plane for a branch that is mixed. @return false where none parts anything */
static bool plane_choose(const tree_work *work, const branch *at, tree_plane *plane)
{
    const double least = 1e-6; /* of rounding */
    int count[LMB_CELL_REGIONS_MOST] = {0};
    for (int i = at->first; i < at->first + at->count; ++i) {
        ++count[work->name[work->order[i]]];
    }
    const double now = impurity(count, work->regions);
    if (!(now > least)) {
        return false;
    }
    int best = -1;
    double best_left = now - least;
    for (int i = 0; i < work->plane_count; ++i) {
        const double left = plane_impurity(work, at, &work->plane[i]);
        if (left < best_left || (best >= 0 && left <= best_left && work->plane[i].votes > work->plane[best].votes)) {
            best = i;
            best_left = left;
        }
    }
    *plane = best >= 0 ? work->plane[best] : plane_between(work, at);
    if (best < 0 && !isfinite(plane_impurity(work, at, plane))) {
        return false;
    }
    plane_centre(work, at, plane);
    return true;
}

/* Puts what is below a plane first. @return how many */
static int branch_part(tree_work *work, const branch *at, const tree_plane *plane)
{
    int below = 0, above = 0;
    for (int i = at->first; i < at->first + at->count; ++i) {
        const int sample = work->order[i];
        if (is_above(plane, work->t[sample])) {
            work->spare[above++] = sample;
        } else {
            work->order[at->first + below++] = sample;
        }
    }
    memcpy(&work->order[at->first + below], work->spare, (size_t)above * sizeof work->spare[0]);
    return below;
}

/* The name that most samples of a branch have; adds the others to `*strays`. */
static uint8_t branch_name(const tree_work *work, const branch *at, uint32_t *strays)
{
    int count[LMB_CELL_REGIONS_MOST] = {0};
    uint8_t best = 0;
    for (int i = at->first; i < at->first + at->count; ++i) {
        ++count[work->name[work->order[i]]];
    }
    for (uint32_t i = 1; i < work->regions; ++i) {
        best = count[i] > count[best] ? (uint8_t)i : best;
    }
    *strays += (uint32_t)(at->count - count[best]);
    return best;
}

/* Whether a plane goes through the box around a branch's samples. */
static bool box_is_crossed(const tree_work *work, const branch *at, const lmb_region_plane *plane)
{
    float box[2][3] = {{1.0f, 1.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};
    bool side[2] = {false, false};
    for (int i = at->first; i < at->first + at->count; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            box[0][axis] = fminf(box[0][axis], work->t[work->order[i]][axis]);
            box[1][axis] = fmaxf(box[1][axis], work->t[work->order[i]][axis]);
        }
    }
    for (int i = 0; i < 8; ++i) {
        const float t[3] = {box[i & 1][0], box[i >> 1 & 1][1], box[i >> 2][2]};
        side[lmb_region_above(plane, t) > 0.0f] = true;
    }
    return side[0] && side[1];
}

/* What is at a branch that is not split: a region, or two and what parts them. */
static uint8_t branch_end(const tree_work *work, const branch *at, lmb_region_tree *tree)
{
    const uint8_t name = branch_name(work, at, &tree->strays);
    const lmb_region_extension *const extension = work->divided[name];
    if (!extension) {
        return (uint8_t)(LMB_CELL_REGION + work->region[name][0]);
    }
    if (box_is_crossed(work, at, &extension->plane) &&
        tree->plane_count + LMB_REGION_WEDGE_PLANES <= LMB_CELL_PLANES_MOST) {
        return lmb_region_wedge_add(extension, work->region[name], tree);
    }
    int above = 0;
    for (int i = at->first; i < at->first + at->count; ++i) {
        above += lmb_region_above(&extension->plane, work->t[work->order[i]]) > 0.0f;
    }
    return (uint8_t)(LMB_CELL_REGION + work->region[name][2 * above > at->count]);
}

static void branches_grow(tree_work *work, lmb_region_tree *tree)
{
    branch open[LMB_CELL_PLANES_MOST + 1] = {{.first = 0, .count = work->count, .parent = -1}};
    int depth = 1;
    while (depth > 0) {
        const branch at = open[--depth];
        tree_plane plane;
        uint8_t child;
        if (tree->plane_count < LMB_CELL_PLANES_MOST && plane_choose(work, &at, &plane)) {
            const int own = (int)tree->plane_count++, below = branch_part(work, &at, &plane);
            tree->plane[own] =
                (lmb_cell_plane){.normal = {plane.normal[0], plane.normal[1], plane.normal[2]}, .offset = plane.offset};
            child = (uint8_t)own;
            open[depth++] = (branch){at.first + below, at.count - below, own, 1};
            open[depth++] = (branch){at.first, below, own, 0};
        } else {
            child = branch_end(work, &at, tree);
        }
        if (at.parent >= 0) {
            tree->plane[at.parent].child[at.side] = child;
        }
    }
}

/* Names for what the tree is to tell apart: regions, but one for both of an extension. `to`: [label]. */
static void names_join(tree_work *work, const lmb_region_cell *cell, const uint8_t name[LMB_CELL_REGIONS_MOST],
                       uint8_t to[LMB_CELL_REGIONS_MOST])
{
    const lmb_region_look *const look = work->look;
    memset(to, LMB_REGION_NONE, LMB_CELL_REGIONS_MOST);
    work->regions = 0;
    for (uint32_t i = 0; i < look->extension_count; ++i) {
        const uint8_t *const label = look->extension[i].label;
        if (label[0] != LMB_REGION_NONE && label[1] != LMB_REGION_NONE && name[label[0]] != LMB_REGION_NONE &&
            name[label[1]] != LMB_REGION_NONE && name[label[0]] != name[label[1]]) {
            to[label[0]] = to[label[1]] = (uint8_t)work->regions;
            work->divided[work->regions] = &look->extension[i];
            work->region[work->regions][0] = name[label[0]];
            work->region[work->regions++][1] = name[label[1]];
        }
    }
    for (uint32_t i = 0; i < cell->count; ++i) {
        if (to[i] != LMB_REGION_NONE || name[i] == LMB_REGION_NONE) {
            continue;
        }
        uint32_t found = 0;
        while (found < work->regions && (work->divided[found] || work->region[found][0] != name[i])) {
            ++found;
        }
        if (found == work->regions) {
            work->divided[found] = NULL;
            work->region[work->regions++][0] = name[i];
        }
        to[i] = (uint8_t)found;
    }
}

void lmb_region_tree_grow(const lmb_region_work *all, const lmb_region_cell *cell,
                          const uint8_t name[LMB_CELL_REGIONS_MOST], lmb_region_tree *tree, uint64_t *rays)
{
    tree_work work;
    uint8_t joined[LMB_CELL_REGIONS_MOST];
    work.tracer = all->tracer;
    work.look = &all->look[cell->look];
    work.frame = lmb_region_frame_of(all->probes, cell);
    work.rays = rays;
    work.count = work.plane_count = work.met_count = 0;
    names_join(&work, cell, name, joined);
    samples_find(&work, all, cell, joined);
    for (int i = 0; i < work.count; ++i) {
        work.order[i] = i;
    }
    tree->plane_count = tree->strays = 0;
    branches_grow(&work, tree);
}
