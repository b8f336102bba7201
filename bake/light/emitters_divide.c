/* Dividing triangles on whose textures something is lit here and there: each part is a light of its own, and the light
 * tree tells those that are near a point, or before it, from others. */
#include "light/emitters_internal.h"

#include <stdlib.h>

#include <lambent/vector.h>

/* Parts that all triangles together are divided into, beyond one each. Points within a part are in proportion to its
 * light anyway: more of them cost memory for less and less noise. */
enum { MOST_PARTS = 4096 };

/* Cuts that only part dark texels from lit ones, for each part. */
enum { CUTS_PER_PART = 16, MOST_CUTS = MOST_PARTS * CUTS_PER_PART };

/* An emitter on its way to be divided. */
typedef struct wide_emitter {
    double width; /* power times the square of its size: how wrong its bound may be */
    double unit;  /* power of a light of 1 in emission_part.h */
    uint32_t emitter;
    uint32_t cut; /* whose half it is; LMB_NONE: a whole triangle */
    int half;
} wide_emitter;

typedef struct dividing {
    lmb_emitters *emitters;
    wide_emitter *heap; /* the widest first */
    uint32_t count;
} dividing;

static bool is_wider(const wide_emitter *a, const wide_emitter *b)
{
    return a->width > b->width || (!(a->width < b->width) && a->emitter < b->emitter);
}

static void heap_add(dividing *work, wide_emitter added)
{
    uint32_t at = work->count++;
    while (at > 0 && is_wider(&added, &work->heap[(at - 1) / 2])) {
        work->heap[at] = work->heap[(at - 1) / 2];
        at = (at - 1) / 2;
    }
    work->heap[at] = added;
}

static wide_emitter heap_take(dividing *work)
{
    const wide_emitter taken = work->heap[0], moved = work->heap[--work->count];
    uint32_t at = 0;
    for (;;) {
        uint32_t child = 2 * at + 1;
        if (child >= work->count) {
            break;
        }
        child += child + 1 < work->count && is_wider(&work->heap[child + 1], &work->heap[child]);
        if (!is_wider(&work->heap[child], &moved)) {
            break;
        }
        work->heap[at] = work->heap[child];
        at = child;
    }
    work->heap[at] = moved;
    return taken;
}

static double bound_width(const lmb_light_bound *bound)
{
    const lmb_vec3 size = lmb_vec3_sub(bound->high, bound->low);
    return (double)bound->power * (double)lmb_vec3_dot(size, size);
}

/* The emission map of an emitter's material. */
static const lmb_emission_map *emitter_map(const lmb_emitters *emitters, const lmb_emitter *emitter)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    const lmb_mesh *mesh = &scene->meshes[scene->instances[emitter->instance].mesh];
    return emitters->materials[mesh->material[emitter->triangle]].map;
}

/* Makes an emitter that part of its triangle. */
static void emitter_narrow(lmb_emitters *emitters, uint32_t index, const lmb_emission_part *part, double power)
{
    lmb_emitter *emitter = &emitters->emitters[index];
    const lmb_emitter_shape *shape = &emitters->shapes[index];
    if (emitter->part == LMB_NONE) {
        emitter->part = emitters->part_count++;
    }
    emitters->parts[emitter->part] = *part;
    emitter->even_points = lmb_emission_part_is_even(emitter_map(emitters, emitter), part);
    emitter->bound.power = (float)power;
    for (int k = 0; k < part->count; ++k) {
        const float u = (float)part->corner[k].weight[0], v = (float)part->corner[k].weight[1];
        const lmb_vec3 at = lmb_vec3_of(shape->corner[0] + shape->edge_u[0] * u + shape->edge_v[0] * v,
                                        shape->corner[1] + shape->edge_u[1] * u + shape->edge_v[1] * v,
                                        shape->corner[2] + shape->edge_u[2] * u + shape->edge_v[2] * v);
        emitter->bound.low = k > 0 ? lmb_vec3_smaller(emitter->bound.low, at) : at;
        emitter->bound.high = k > 0 ? lmb_vec3_larger(emitter->bound.high, at) : at;
    }
}

/* The part of its triangle that an emitter is; false where it cannot be divided. */
static bool emitter_part(const lmb_emitters *emitters, const lmb_emitter *emitter, lmb_emission_part *part)
{
    lmb_emission_lattice lattice;
    if (emitter->even_points) {
        return false;
    }
    if (emitter->part != LMB_NONE) {
        *part = emitters->parts[emitter->part];
        return true;
    }
    if (!lmb_emitter_lattice(emitters, emitter, &lattice)) {
        return false;
    }
    *part = lmb_emission_part_whole(&lattice);
    return true;
}

static void half_set(lmb_emitters *emitters, const wide_emitter *divided, lmb_emitter_half half)
{
    if (divided->cut == LMB_NONE) {
        emitters->emitters[divided->emitter].cut = half.index;
    } else {
        emitters->cuts[divided->cut].half[divided->half] = half;
    }
}

static double bounded_power(double power)
{
    return power <= 3.0e38 ? power : 3.0e38;
}

/* Divides an emitter in two; the first keeps its index. */
static bool emitter_divide(dividing *work, const wide_emitter *divided)
{
    lmb_emitters *emitters = work->emitters;
    const lmb_emitter *emitter = &emitters->emitters[divided->emitter];
    const lmb_emission_map *map = emitter_map(emitters, emitter);
    lmb_emission_part part, half[2];
    lmb_emitter_cut cut;
    if (!emitter_part(emitters, emitter, &part) || !lmb_emission_part_cut(map, &part, &cut.line)) {
        return true;
    }
    lmb_emission_part_halve(&part, &cut.line, half);
    double power[2];
    bool lit[2];
    for (int i = 0; i < 2; ++i) {
        power[i] = bounded_power(divided->unit * lmb_emission_part_light(map, &half[i]));
        lit[i] = (float)power[i] > 0.0f;
    }
    if (!lit[0] && !lit[1]) {
        return true;
    }
    const uint32_t halves[2] = {divided->emitter, lit[0] ? emitters->count : divided->emitter};
    if (lit[0] && lit[1]) {
        lmb_emitter second = *emitter;
        const lmb_emitter_shape shape = emitters->shapes[divided->emitter];
        second.part = LMB_NONE;
        second.cut = LMB_NONE;
        if (!lmb_emitters_add(emitters, &second, &shape)) {
            return false;
        }
    }
    const uint32_t cut_index = emitters->cut_count++;
    half_set(emitters, divided, (lmb_emitter_half){LMB_HALF_CUT, cut_index});
    for (int i = 0; i < 2; ++i) {
        cut.half[i] = (lmb_emitter_half){lit[i] ? LMB_HALF_EMITTER : LMB_HALF_DARK, halves[i]};
    }
    emitters->cuts[cut_index] = cut;
    for (int i = 0; i < 2; ++i) {
        if (lit[i]) {
            emitter_narrow(emitters, halves[i], &half[i], power[i]);
            const double width = bound_width(&emitters->emitters[halves[i]].bound);
            heap_add(work, (wide_emitter){width, divided->unit, halves[i], cut_index, i});
        }
    }
    return true;
}

/* Triangles that may be divided. */
static void triangles_add(dividing *work)
{
    const lmb_emitters *emitters = work->emitters;
    for (uint32_t i = 0; i < emitters->count; ++i) {
        const lmb_emitter *emitter = &emitters->emitters[i];
        lmb_emission_part part;
        if (emitter_part(emitters, emitter, &part)) {
            const double light = lmb_emission_part_light(emitter_map(emitters, emitter), &part);
            heap_add(work, (wide_emitter){bound_width(&emitter->bound), (double)emitter->bound.power / light, i,
                                          LMB_NONE, 0});
        }
    }
}

static uint32_t uneven_count(const lmb_emitters *emitters)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < emitters->count; ++i) {
        count += !emitters->emitters[i].even_points;
    }
    return count;
}

/* Gives back the room that was not needed; what cannot be moved stays where it is. */
static void room_trim(lmb_emitters *emitters)
{
    lmb_emission_part *parts = realloc(emitters->parts, (emitters->part_count + 1u) * sizeof *parts);
    emitters->parts = parts ? parts : emitters->parts;
    lmb_emitter_cut *cuts = realloc(emitters->cuts, (emitters->cut_count + 1u) * sizeof *cuts);
    emitters->cuts = cuts ? cuts : emitters->cuts;
}

lmb_result lmb_emitters_divide(lmb_emitters *emitters)
{
    const uint32_t uneven = uneven_count(emitters);
    if (uneven == 0) {
        return LMB_OK;
    }
    dividing work = {emitters, malloc(((size_t)uneven + 2 * MOST_PARTS) * sizeof *work.heap), 0};
    emitters->parts = malloc((size_t)(2 * MOST_PARTS) * sizeof *emitters->parts);
    emitters->cuts = malloc((size_t)MOST_CUTS * sizeof *emitters->cuts);
    if (!work.heap || !emitters->parts || !emitters->cuts) {
        free(work.heap);
        return LMB_ERROR_MEMORY;
    }
    triangles_add(&work);
    lmb_result result = LMB_OK;
    while (result == LMB_OK && work.count > 0 && emitters->part_count + 2 <= 2 * MOST_PARTS &&
           emitters->count < emitters->triangle_count + MOST_PARTS && emitters->cut_count < MOST_CUTS) {
        const wide_emitter widest = heap_take(&work);
        result = emitter_divide(&work, &widest) ? LMB_OK : LMB_ERROR_MEMORY;
    }
    free(work.heap);
    room_trim(emitters);
    return result;
}
