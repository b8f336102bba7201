/* Looking into a cell: rays along lines of nodes, and the regions that they leave. */
#include "probes/regions_internal.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/placement.h>
#include <lambent/surface.h>

#include "trace/trace_internal.h"

/* Walls stand at round figures, and nodes do not. */
static const float node_at[LMB_REGION_SIDE] = {LMB_REGION_INSET, 0.2113f, 0.4057f,
                                               0.6019f,          0.7931f, 1.0f - LMB_REGION_INSET};

/* Of what a region meets, the share that is unseen backs: beyond the first it is the inside of something; beyond the
 * second it may be. */
#define HOLLOW_SHARE 0.6f
#define DOUBTFUL_SHARE 0.25f

float lmb_region_node(int i)
{
    return node_at[i];
}

void lmb_region_node_at(int node, float t[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        t[axis] = node_at[node / lmb_region_stride(axis) % LMB_REGION_SIDE];
    }
}

int lmb_region_node_before(float at)
{
    int node = -1;
    while (node + 1 < LMB_REGION_SIDE && node_at[node + 1] <= at) {
        ++node;
    }
    return node;
}

lmb_region_frame lmb_region_frame_of(const lmb_probes *probes, const lmb_region_cell *cell)
{
    const lmb_lattice *const lattice = &probes->level[cell->level].lattice;
    const lmb_vec3d first = lmb_lattice_position(lattice, cell->point);
    const double spacing = (double)lattice->spacing;
    lmb_region_frame frame = {.first = {(float)(first.x - probes->origin.x), (float)(first.y - probes->origin.y),
                                        (float)(first.z - probes->origin.z)},
                              .spacing = lattice->spacing};
    for (int axis = 0; axis < 3; ++axis) {
        const lmb_vec3d along = lmb_lattice_vector_to_world(
            lattice, (lmb_vec3d){axis == 0 ? spacing : 0.0, axis == 1 ? spacing : 0.0, axis == 2 ? spacing : 0.0});
        frame.step[axis] = lmb_vec3_of((float)along.x, (float)along.y, (float)along.z);
    }
    return frame;
}

lmb_vec3 lmb_region_position(const lmb_region_frame *frame, const float t[3])
{
    return lmb_vec3_mad(lmb_vec3_mad(lmb_vec3_mad(frame->first, frame->step[0], t[0]), frame->step[1], t[1]),
                        frame->step[2], t[2]);
}

lmb_vec3 lmb_region_coordinates(const lmb_region_frame *frame, lmb_vec3 position)
{
    const lmb_vec3 from =
        lmb_vec3_scale(lmb_vec3_sub(position, frame->first), 1.0f / (frame->spacing * frame->spacing));
    return lmb_vec3_of(lmb_vec3_dot(from, frame->step[0]), lmb_vec3_dot(from, frame->step[1]),
                       lmb_vec3_dot(from, frame->step[2]));
}

int lmb_region_node_next(const lmb_region_frame *frame, lmb_vec3 position, bool left[LMB_REGION_NODES], lmb_vec3 *place)
{
    int best = -1;
    float nearest = 0.0f;
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        if (!left[node]) {
            continue;
        }
        float t[3];
        lmb_region_node_at(node, t);
        const lmb_vec3 point = lmb_region_position(frame, t), way = lmb_vec3_sub(point, position);
        const float distance = lmb_vec3_dot(way, way);
        if (best < 0 || distance < nearest) {
            best = node;
            nearest = distance;
            *place = point;
        }
    }
    if (best >= 0) {
        left[best] = false;
    }
    return best;
}

void lmb_region_line_trace(const lmb_tracer *tracer, const lmb_region_frame *frame, int axis, int line,
                           lmb_region_line *found, uint64_t *rays)
{
    float t[3];
    lmb_region_node_at(lmb_region_line_node(axis, line, 0), t);
    t[axis] = -LMB_REGION_INSET;
    const lmb_vec3 origin = lmb_region_position(frame, t);
    const float length = 1.0f + 2.0f * LMB_REGION_INSET;
    float near = 0.0f;
    found->count = 0;
    while (found->count < LMB_REGION_HITS_MOST && near < length) {
        lmb_hit *const hit = &found->hit[found->count];
        ++*rays;
        if (!lmb_trace_nearest(tracer, origin, frame->step[axis], near, length, hit)) {
            return;
        }
        near = lmb_trace_beyond(hit->distance);
        if (!lmb_tracer_is_see_through(tracer, hit->instance, hit->triangle)) {
            found->at[found->count++] = hit->distance - LMB_REGION_INSET;
        }
    }
}

/* In a cell: two for each part of a line that something stands in. */
enum { MOST_ENDS = 3 * LMB_REGION_LINES * 2 * (LMB_REGION_SIDE - 1) };

bool lmb_region_is_unseen(const lmb_tracer *tracer, const lmb_hit *hit, bool against)
{
    const lmb_scene *const scene = lmb_tracer_scene(tracer);
    const lmb_mesh *const mesh = &scene->meshes[scene->instances[hit->instance].mesh];
    return hit->front == against && !scene->materials[mesh->material[hit->triangle]].double_sided;
}

static void ends_find(const lmb_tracer *tracer, int axis, int line, const lmb_region_line *found, lmb_region_end *end,
                      uint32_t *count)
{
    for (int i = 0; i < found->count; ++i) {
        const int node = lmb_region_node_before(found->at[i]);
        lmb_region_end one = {.axis = (uint8_t)axis, .at = (uint16_t)(lmb_saturate(found->at[i]) * 65535.0f + 0.5f)};
        if (node < 0 || node + 1 >= LMB_REGION_SIDE) {
            continue;
        }
        if (i == 0 || lmb_region_node_before(found->at[i - 1]) != node) {
            one.node = (uint8_t)lmb_region_line_node(axis, line, node);
            one.unseen = lmb_region_is_unseen(tracer, &found->hit[i], false);
            end[(*count)++] = one;
        }
        if (i + 1 == found->count || lmb_region_node_before(found->at[i + 1]) != node) {
            one.node = (uint8_t)lmb_region_line_node(axis, line, node + 1);
            one.unseen = lmb_region_is_unseen(tracer, &found->hit[i], true);
            end[(*count)++] = one;
        }
    }
}

/* Which nodes see the next one, bit of an axis, and where they do not. */
static void nodes_link(const lmb_region_work *work, const lmb_region_frame *frame, uint8_t link[LMB_REGION_NODES],
                       lmb_region_look *look, lmb_region_end end[MOST_ENDS], lmb_region_walls *walls, uint64_t *rays)
{
    lmb_region_line found;
    walls->count = walls->met_count = 0;
    look->end_count = 0;
    memset(link, 0, LMB_REGION_NODES);
    memset(look->open, 0, sizeof look->open);
    for (int axis = 0; axis < 3; ++axis) {
        for (int line = 0; line < LMB_REGION_LINES; ++line) {
            lmb_region_line_trace(work->tracer, frame, axis, line, &found, rays);
            ends_find(work->tracer, axis, line, &found, end, &look->end_count);
            lmb_region_walls_add(walls, work->tracer, frame, axis, line, &found);
            unsigned blocked = 0; /* bit i: before node i */
            for (int i = 0; i < found.count; ++i) {
                blocked |= 1u << (lmb_region_node_before(found.at[i]) + 1);
            }
            look->open[2 * axis] |= (uint64_t)(~blocked & 1u) << line;
            look->open[2 * axis + 1] |= (uint64_t)(~blocked >> LMB_REGION_SIDE & 1u) << line;
            for (int i = 0; i + 1 < LMB_REGION_SIDE; ++i) {
                link[lmb_region_line_node(axis, line, i)] |= (uint8_t)((~blocked >> (i + 1) & 1u) << axis);
            }
        }
    }
}

/* Labels the nodes that are linked to the first one. @return how many */
static int flood(const uint8_t link[LMB_REGION_NODES], int first, uint8_t name, uint8_t label[LMB_REGION_NODES])
{
    int stack[LMB_REGION_NODES], depth = 0, nodes = 0;
    label[first] = name;
    stack[depth++] = first;
    while (depth > 0) {
        const int node = stack[--depth];
        ++nodes;
        for (int axis = 0; axis < 3; ++axis) {
            const int stride = lmb_region_stride(axis), along = node / stride % LMB_REGION_SIDE;
            const int above = node + stride, below = node - stride;
            if (along + 1 < LMB_REGION_SIDE && (link[node] >> axis & 1) != 0 && label[above] == LMB_REGION_NONE) {
                label[above] = name;
                stack[depth++] = above;
            }
            if (along > 0 && (link[below] >> axis & 1) != 0 && label[below] == LMB_REGION_NONE) {
                label[below] = name;
                stack[depth++] = below;
            }
        }
    }
    return nodes;
}

void lmb_region_parts_find(lmb_region_parts *parts)
{
    parts->count = 0;
    memset(parts->part, LMB_REGION_NONE, sizeof parts->part);
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        if (parts->part[node] == LMB_REGION_NONE) {
            parts->size[parts->count] = flood(parts->link, node, (uint8_t)parts->count, parts->part);
            ++parts->count;
        }
    }
}

/* Names the regions, the largest first where there are more than cells can have. */
static void regions_label(const lmb_region_parts *parts, lmb_region_look *look)
{
    uint8_t name[LMB_REGION_NODES];
    look->count = 0;
    for (int i = 0; i < parts->count; ++i) {
        int larger = 0;
        for (int k = 0; k < parts->count; ++k) {
            larger += parts->size[k] > parts->size[i] || (k < i && parts->size[k] == parts->size[i]);
        }
        name[i] = larger < LMB_CELL_REGIONS_MOST ? look->count++ : LMB_REGION_NONE;
    }
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        look->label[node] = name[parts->part[node]];
    }
}

static bool sees(const lmb_tracer *tracer, lmb_vec3 from, lmb_vec3 to, uint64_t *rays)
{
    return lmb_rgb_max(lmb_trace_transmittance(tracer, from, to, rays)) > 0.0f;
}

/* The part that a place beside the cell sees, by the nodes that are nearest to it; -1: none. */
static int part_seen(const lmb_region_work *work, const lmb_region_frame *frame, const lmb_region_parts *parts,
                     lmb_vec3 from, uint64_t *rays)
{
    enum { TRIED = 4 };
    bool left[LMB_REGION_NODES];
    lmb_vec3 place = from;
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        left[node] = true;
    }
    for (int i = 0; i < TRIED; ++i) {
        const int node = lmb_region_node_next(frame, from, left, &place);
        if (sees(work->tracer, from, place, rays)) {
            return parts->part[node];
        }
    }
    return -1;
}

/* The regions on the sides of an extension, of the part that it divides. */
static void extension_label(const lmb_region_look *look, const lmb_region_parts *parts, int part,
                            lmb_region_extension *extension)
{
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        if (parts->part[node] == part) {
            float t[3];
            lmb_region_node_at(node, t);
            extension->label[lmb_region_above(&extension->plane, t) > 0.0f] = look->label[node];
        }
    }
}

/* Divides what things end in, in the cell and beside it, each part once, and names the regions.
 * @return false: out of memory */
static bool parts_divide(const lmb_region_work *work, const lmb_region_frame *frame, const lmb_region_walls *walls,
                         const lmb_region_parts *parts, lmb_region_look *look, uint64_t *rays)
{
    lmb_region_extension made[LMB_REGION_EXTENSIONS_MOST];
    int part[LMB_REGION_EXTENSIONS_MOST], next = 0;
    uint32_t count = 0;
    bool divided[LMB_REGION_NODES] = {false};
    lmb_region_parts cut;
    memcpy(cut.link, parts->link, sizeof cut.link);
    while (count < LMB_REGION_EXTENSIONS_MOST && next >= 0) {
        next = lmb_region_extend(walls, work->tracer, frame, look->open, parts, divided, cut.link, &made[count]);
        if (next >= 0) {
            divided[next] = true;
            part[count++] = next;
        }
    }
    for (uint32_t i = 0; i < look->extension_count && count < LMB_REGION_EXTENSIONS_MOST; ++i) {
        next = part_seen(work, frame, parts, look->extension[i].from, rays);
        if (next >= 0 && !divided[next] && lmb_region_divide(parts, next, &look->extension[i], cut.link)) {
            divided[next] = true;
            part[count] = next;
            made[count++] = look->extension[i];
        }
    }
    lmb_region_parts_find(&cut);
    regions_label(&cut, look);
    for (uint32_t i = 0; i < count; ++i) {
        extension_label(look, parts, part[i], &made[i]);
        if (!made[i].passed) {
            lmb_region_wedge_open(look, &made[i]);
        }
    }
    lmb_region_extension *const all = realloc(look->extension, (count + 1) * sizeof *made);
    if (!all) {
        return false;
    }
    memcpy(all, made, count * sizeof *made);
    look->extension = all;
    look->extension_count = count;
    return true;
}

/* Whether a corner's probe is seen from one of the region's nodes that are nearest to it. */
static bool region_sees(const lmb_region_work *work, const lmb_region_frame *frame, const lmb_region_look *look,
                        uint8_t region, lmb_vec3 place, uint64_t *rays)
{
    enum { TRIED = 3 };
    bool left[LMB_REGION_NODES];
    lmb_vec3 point = place;
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        left[node] = look->label[node] == region;
    }
    for (int i = 0; i < TRIED && lmb_region_node_next(frame, place, left, &point) >= 0; ++i) {
        if (sees(work->tracer, point, place, rays)) {
            return true;
        }
    }
    return false;
}

/* The baked probe at a cell's corner, or -1. */
static int32_t corner_probe(const lmb_probes *probes, const lmb_region_cell *cell, int corner)
{
    const int32_t probe = lmb_probes_find(probes, cell->level, cell->point[0] + (corner & 1),
                                          cell->point[1] + (corner >> 1 & 1), cell->point[2] + (corner >> 2));
    return probe >= 0 && probes->validity[probe] >= LMB_PROBES_MIN_VALIDITY ? probe : -1;
}

/* A probe may have been moved off a surface, out of its corner's own region. */
static void corners_look(const lmb_region_work *work, const lmb_region_cell *cell, const lmb_region_frame *frame,
                         lmb_region_look *look, uint64_t *rays)
{
    memset(look->real, 0, sizeof look->real);
    for (int corner = 0; corner < 8; ++corner) {
        const int32_t probe = corner_probe(work->probes, cell, corner);
        if (probe < 0) {
            continue;
        }
        const int node = (LMB_REGION_SIDE - 1) *
                         ((corner & 1) + (corner >> 1 & 1) * LMB_REGION_SIDE + (corner >> 2) * LMB_REGION_LINES);
        float t[3];
        lmb_region_node_at(node, t);
        const uint8_t own = look->label[node];
        if (own != LMB_REGION_NONE && sees(work->tracer, lmb_region_position(frame, t), work->place[probe], rays)) {
            look->real[own] |= (uint8_t)(1u << corner);
            continue;
        }
        for (uint8_t region = 0; region < look->count; ++region) {
            if (region_sees(work, frame, look, region, work->place[probe], rays)) {
                look->real[region] |= (uint8_t)(1u << corner);
            }
        }
    }
}

/* How much of what a region meets turns a back to it that its material does not show. */
static float unseen_share(const lmb_region_look *look, uint8_t region)
{
    uint32_t ends = 0, unseen = 0;
    for (uint32_t i = 0; i < look->end_count; ++i) {
        if (look->label[look->end[i].node] == region) {
            ++ends;
            unseen += look->end[i].unseen;
        }
    }
    return ends > 0 ? (float)unseen / (float)ends : 0.0f;
}

/* Whether somebody can be in a region. Shells are often open where the level hides it: then their inside is connected
 * with the space around the level, probes in it see few backs and are baked, and what the region itself meets tells. */
static bool is_habitable(const lmb_region_work *work, const lmb_region_frame *frame, const lmb_region_look *look,
                         uint8_t region, uint64_t *rays)
{
    const float unseen = unseen_share(look, region);
    if (unseen > HOLLOW_SHARE) {
        return false;
    }
    if (look->real[region] != 0 && unseen < DOUBTFUL_SHARE) {
        return true;
    }
    int nodes[LMB_REGION_NODES], count = 0;
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        nodes[count] = node;
        count += look->label[node] == region;
    }
    float t[3];
    lmb_region_node_at(nodes[count / 2], t);
    return lmb_placement_is_free(work->tracer, lmb_region_position(frame, t), rays);
}

/* Takes the names of regions away that nobody can be in. */
static void solids_leave(const lmb_region_work *work, const lmb_region_frame *frame, lmb_region_look *look,
                         uint64_t *rays)
{
    for (uint8_t region = 0; region < look->count; ++region) {
        if (is_habitable(work, frame, look, region, rays)) {
            continue;
        }
        look->real[region] = 0;
        for (int node = 0; node < LMB_REGION_NODES; ++node) {
            look->label[node] = look->label[node] == region ? LMB_REGION_NONE : look->label[node];
        }
    }
}

static void cell_look(void *context, size_t task, int worker)
{
    const lmb_region_work *const work = context;
    const uint32_t number = work->looking[task];
    const lmb_region_cell *const cell = &work->cell[work->looked[number]];
    lmb_region_look *const look = &work->look[number];
    const lmb_region_frame frame = lmb_region_frame_of(work->probes, cell);
    lmb_region_parts parts;
    lmb_region_end end[MOST_ENDS];
    lmb_region_walls walls;
    uint64_t rays = 0;
    nodes_link(work, &frame, parts.link, look, end, &walls, &rays);
    lmb_region_parts_find(&parts);
    free(look->end);
    look->end = malloc((look->end_count + 1) * sizeof *look->end);
    look->failed = !look->end || !parts_divide(work, &frame, &walls, &parts, look, &rays);
    if (look->end) {
        memcpy(look->end, end, look->end_count * sizeof *end);
    }
    corners_look(work, cell, &frame, look, &rays);
    solids_leave(work, &frame, look, &rays);
    work->rays[worker] += rays;
}

/* Where the probes at corners of looked-at cells are gathered at. */
static void probe_place(void *context, size_t task, int worker)
{
    const lmb_region_work *const work = context;
    const int32_t probe = work->placed[task];
    work->place[probe] = lmb_placement_relocate(work->tracer, lmb_probes_position(work->probes, probe),
                                                lmb_probes_footprint(work->probes, probe), &work->rays[worker]);
}

/* @return how many there are to find */
static size_t places_list(const lmb_region_work *work, size_t looks, uint8_t *listed)
{
    size_t count = 0;
    for (size_t i = 0; i < looks; ++i) {
        for (int corner = 0; corner < 8; ++corner) {
            const int32_t probe = corner_probe(work->probes, &work->cell[work->looked[work->looking[i]]], corner);
            if (probe >= 0 && !listed[probe]) {
                listed[probe] = 1;
                work->placed[count++] = probe;
            }
        }
    }
    return count;
}

/* Looks into the first `looks` cells that are listed. */
static lmb_result cells_look(lmb_region_work *work, size_t looks, uint8_t *listed)
{
    lmb_result result = lmb_pool_run(work->pool, places_list(work, looks, listed), probe_place, work, "place", NULL);
    if (result == LMB_OK) {
        result = lmb_pool_run(work->pool, looks, cell_look, work, "regions", work->progress);
    }
    for (size_t i = 0; i < looks && result == LMB_OK; ++i) {
        result = work->look[work->looking[i]].failed ? LMB_ERROR_MEMORY : LMB_OK;
    }
    return result;
}

lmb_result lmb_region_cells_look(lmb_region_work *work)
{
    const size_t probes = (size_t)work->probes->count + 1, cells = (size_t)work->cell_count + 1;
    work->place = malloc(probes * sizeof *work->place);
    work->placed = malloc(probes * sizeof *work->placed);
    work->looking = malloc(cells * sizeof *work->looking);
    uint8_t *const listed = calloc(probes, 1);
    lmb_result result = LMB_ERROR_MEMORY;
    if (work->place && work->placed && work->looking && listed) {
        for (uint32_t i = 0; i < work->look_count; ++i) {
            work->looking[i] = i;
        }
        result = cells_look(work, work->look_count, listed);
    }
    size_t again = 0;
    if (result == LMB_OK) {
        result = lmb_region_extensions_pass(work, &again);
    }
    if (result == LMB_OK) {
        result = cells_look(work, again, listed);
    }
    if (result == LMB_OK) {
        lmb_region_extensions_settle(work);
    }
    free(listed);
    return result;
}
