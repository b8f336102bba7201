#include "light/emission_part.h"

#include <math.h>
#include <string.h>

#include <lambent/sequence.h>

/* Texel indices beyond this are no positions any more: float texture coordinates are coarser. */
#define MOST_TEXELS 1e9

/* Parts of less than this share of the triangle count by the cells about them when light is added up. */
#define LEAST_AREA (1.0 / 1024.0)

/* Cells that are compared to tell whether a part is even. */
enum { MOST_COMPARED = 256 };

/* Step between the variates that samples come from. */
#define VARIATE_STEP 0x1p-24

bool lmb_emission_lattice_of(const lmb_mesh *mesh, uint32_t triangle, const lmb_texture *texture,
                             const lmb_emission_map *map, lmb_emission_lattice *lattice)
{
    const lmb_vec2 *uv = mesh->uv[texture->uv_set];
    const float(*m)[3] = texture->transform;
    double texel[3][2];
    for (int k = 0; k < 3; ++k) {
        const lmb_vec2 at = uv ? uv[mesh->triangle[triangle][k]] : (lmb_vec2){0.0f, 0.0f};
        for (int axis = 0; axis < 2; ++axis) {
            texel[k][axis] =
                ((double)m[axis][0] * (double)at.x + (double)m[axis][1] * (double)at.y + (double)m[axis][2]) *
                lmb_emission_map_size(map, axis);
            if (!(fabs(texel[k][axis]) < MOST_TEXELS)) {
                return false;
            }
        }
    }
    for (int axis = 0; axis < 2; ++axis) {
        lattice->origin[axis] = texel[0][axis];
        lattice->along[0][axis] = texel[1][axis] - texel[0][axis];
        lattice->along[1][axis] = texel[2][axis] - texel[0][axis];
    }
    return true;
}

lmb_emission_part lmb_emission_part_whole(const lmb_emission_lattice *lattice)
{
    lmb_emission_part part = {.count = 3,
                              .corner = {{{0.0, 0.0}, {0.0, 0.0}}, {{1.0, 0.0}, {0.0, 0.0}}, {{0.0, 1.0}, {0.0, 0.0}}}};
    for (int axis = 0; axis < 2; ++axis) {
        part.corner[0].texel[axis] = lattice->origin[axis];
        part.corner[1].texel[axis] = lattice->origin[axis] + lattice->along[0][axis];
        part.corner[2].texel[axis] = lattice->origin[axis] + lattice->along[1][axis];
    }
    return part;
}

/* The cells that a part lies in. One that lies on a line is in those after it. */
static lmb_texel_range part_range(const lmb_emission_part *part)
{
    lmb_texel_range range;
    for (int axis = 0; axis < 2; ++axis) {
        double low = part->corner[0].texel[axis], high = low;
        for (int k = 1; k < part->count; ++k) {
            const double at = part->corner[k].texel[axis];
            low = at < low ? at : low;
            high = at > high ? at : high;
        }
        range.first[axis] = (int32_t)floor(low);
        range.end[axis] = (int32_t)ceil(high);
        range.end[axis] += range.end[axis] == range.first[axis];
    }
    return range;
}

static double corners_area(const lmb_part_corner *from, const lmb_part_corner *a, const lmb_part_corner *b)
{
    return (a->weight[0] - from->weight[0]) * (b->weight[1] - from->weight[1]) -
           (b->weight[0] - from->weight[0]) * (a->weight[1] - from->weight[1]);
}

double lmb_emission_part_area(const lmb_emission_part *part)
{
    double sum = 0.0;
    for (int k = 1; k + 1 < part->count; ++k) {
        sum += corners_area(&part->corner[0], &part->corner[k], &part->corner[k + 1]);
    }
    return sum > 0.0 ? sum : 0.0;
}

/* Cuts the longer way. Between repetitions of the texture where there are many: whole ones are looked up quickly. */
static bool range_cut(const lmb_emission_map *map, const lmb_texel_range *range, lmb_emission_cut *cut)
{
    const int32_t across = range->end[0] - range->first[0], down = range->end[1] - range->first[1];
    const int32_t length = down > across ? down : across;
    cut->axis = down > across;
    const int32_t size = lmb_emission_map_size(map, cut->axis), middle = range->first[cut->axis] + length / 2;
    cut->line = middle;
    if (length / 2 > size) {
        cut->line -= middle >= 0 ? middle % size : size - 1 - (-1 - middle) % size;
    }
    return across > 1 || down > 1;
}

bool lmb_emission_part_cut(const lmb_emission_map *map, const lmb_emission_part *part, lmb_emission_cut *cut)
{
    /* Cutting adds two corners at the most. */
    const lmb_texel_range range = part_range(part);
    return part->count + 2 <= LMB_PART_CORNERS && range_cut(map, &range, cut);
}

static double between(double from, double to, double share)
{
    const double at = from + (to - from) * share;
    const double low = from < to ? from : to, high = from < to ? to : from;
    return at < low ? low : at > high ? high : at;
}

/* Rounding may bend a sliver so that a line cuts it more than twice: what has no room then is nothing. */
static void corner_add(lmb_emission_part *part, const lmb_part_corner *corner)
{
    if (part->count < LMB_PART_CORNERS) {
        part->corner[part->count++] = *corner;
    }
}

void lmb_emission_part_halve(const lmb_emission_part *part, const lmb_emission_cut *cut, lmb_emission_part half[2])
{
    const int axis = cut->axis;
    const double line = (double)cut->line;
    half[0].count = 0;
    half[1].count = 0;
    for (int k = 0; k < part->count; ++k) {
        const lmb_part_corner *a = &part->corner[k], *b = &part->corner[k + 1 < part->count ? k + 1 : 0];
        const double from = a->texel[axis] - line, to = b->texel[axis] - line;
        if (from <= 0.0) {
            corner_add(&half[0], a);
        }
        if (from >= 0.0) {
            corner_add(&half[1], a);
        }
        if ((from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0)) {
            const double share = from / (from - to);
            lmb_part_corner on;
            for (int i = 0; i < 2; ++i) {
                on.weight[i] = between(a->weight[i], b->weight[i], share);
                on.texel[i] = between(a->texel[i], b->texel[i], share);
            }
            on.texel[axis] = line;
            corner_add(&half[0], &on);
            corner_add(&half[1], &on);
        }
    }
    for (int i = 0; i < 2; ++i) {
        half[i].count = half[i].count >= 3 ? half[i].count : 0;
    }
}

static double part_bound(const lmb_emission_map *map, const lmb_emission_part *part)
{
    if (part->count == 0) {
        return 0.0;
    }
    const lmb_texel_range range = part_range(part);
    return lmb_emission_map_mean(map, &range) * lmb_emission_part_area(part);
}

/* Whether a part fills the cells about it: each corner of these is one of its own. */
static bool part_is_full(const lmb_emission_part *part, const lmb_texel_range *range)
{
    unsigned found = 0;
    for (int k = 0; k < part->count; ++k) {
        const double *at = part->corner[k].texel;
        const bool right = at[0] >= range->end[0], lower = at[1] >= range->end[1];
        if ((!right && at[0] > range->first[0]) || (!lower && at[1] > range->first[1])) {
            return false;
        }
        found |= 1u << (2 * lower + right);
    }
    return found == 15u;
}

double lmb_emission_part_light(const lmb_emission_map *map, const lmb_emission_part *part)
{
    const double area = part->count > 0 ? lmb_emission_part_area(part) : 0.0;
    if (!(area > 0.0)) {
        return 0.0;
    }
    const lmb_texel_range range = part_range(part);
    const double mean = lmb_emission_map_mean(map, &range);
    lmb_emission_cut cut;
    if (!(mean > 0.0) || area < LEAST_AREA || part_is_full(part, &range) || !lmb_emission_part_cut(map, part, &cut)) {
        return mean * area;
    }
    lmb_emission_part half[2];
    lmb_emission_part_halve(part, &cut, half);
    return lmb_emission_part_light(map, &half[0]) + lmb_emission_part_light(map, &half[1]);
}

bool lmb_emission_part_is_even(const lmb_emission_map *map, const lmb_emission_part *part)
{
    const lmb_texel_range range = part_range(part);
    const int64_t cells = ((int64_t)range.end[0] - range.first[0]) * ((int64_t)range.end[1] - range.first[1]);
    if (cells > MOST_COMPARED) {
        return false;
    }
    const double mean = lmb_emission_map_mean(map, &range);
    for (int32_t y = range.first[1]; y < range.end[1]; ++y) {
        for (int32_t x = range.first[0]; x < range.end[0]; ++x) {
            const lmb_texel_range cell = {{x, y}, {x + 1, y + 1}};
            if (fabs(lmb_emission_map_mean(map, &cell) - mean) > 1e-6 * mean) {
                return false;
            }
        }
    }
    return mean > 0.0;
}

/* Probability of the half below the line; negative where neither promises light. */
static double first_probability(const lmb_emission_map *map, const lmb_emission_part half[2])
{
    const double first = part_bound(map, &half[0]), second = part_bound(map, &half[1]);
    return first + second > 0.0 ? first / (first + second) : -1.0;
}

/* A point even over a convex polygon. */
static void polygon_point(const lmb_emission_part *part, const double u[2], float weight[2])
{
    const lmb_part_corner *from = &part->corner[0];
    double left = u[0] * lmb_emission_part_area(part), area = 0.0;
    int k = 1;
    for (;; ++k) {
        area = corners_area(from, &part->corner[k], &part->corner[k + 1]);
        if (left < area || k + 2 >= part->count) {
            break;
        }
        left -= area;
    }
    const double share = area > 0.0 && left < area ? left / area : 0.0;
    const double root = sqrt(share);
    const double a = root * (1.0 - u[1]), b = root * u[1];
    for (int i = 0; i < 2; ++i) {
        weight[i] = (float)(from->weight[i] + (part->corner[k].weight[i] - from->weight[i]) * a +
                            (part->corner[k + 1].weight[i] - from->weight[i]) * b);
    }
}

/* The point of a full part at shares of its width and height. */
static void full_point(const lmb_emission_part *part, const lmb_texel_range *range, const double share[2],
                       float weight[2])
{
    const double *corner[2][2] = {{NULL}};
    for (int k = 0; k < part->count; ++k) {
        const double *at = part->corner[k].texel;
        corner[at[1] >= range->end[1]][at[0] >= range->end[0]] = part->corner[k].weight;
    }
    for (int i = 0; i < 2; ++i) {
        const double from = corner[0][0][i];
        weight[i] = (float)(from + (corner[0][1][i] - from) * share[0] + (corner[1][0][i] - from) * share[1]);
    }
}

/* Numbers in [0, 1)^2, of which choices use up the first bits. */
typedef struct choice_variates {
    double left[2];
    double used[2]; /* probability of the choices */
} choice_variates;

static bool second_choose(choice_variates *u, int axis, double first)
{
    const bool second = u->left[axis] >= first;
    const double share = second ? 1.0 - first : first;
    const double left = (second ? u->left[axis] - first : u->left[axis]) / share;
    u->left[axis] = left < 1.0 - VARIATE_STEP ? left : 1.0 - VARIATE_STEP;
    u->used[axis] *= share;
    return second;
}

/* Makes up last bits in place of those that have been used. */
static void variates_refill(choice_variates *u, const float original[2])
{
    uint32_t bits[2];
    memcpy(bits, original, sizeof bits);
    const uint64_t mixed = lmb_mix(bits[0], bits[1]);
    const double made_up[2] = {(double)(mixed >> 40) * 0x1p-24, (double)(mixed & 0xffffff) * 0x1p-24};
    for (int i = 0; i < 2; ++i) {
        const double step = fmin(VARIATE_STEP / u->used[i], 1.0);
        u->left[i] = fmin(u->left[i] + made_up[i] * step, 1.0 - VARIATE_STEP);
    }
}

/* Narrows a range down to one cell, by weight. */
static lmb_texel_range cell_choose(const lmb_emission_map *map, const lmb_texel_range *range, choice_variates *u)
{
    lmb_texel_range at = *range;
    lmb_emission_cut cut;
    double sum = lmb_emission_map_sum(map, range);
    while (range_cut(map, &at, &cut)) {
        lmb_texel_range half[2] = {at, at};
        half[0].end[cut.axis] = cut.line;
        half[1].first[cut.axis] = cut.line;
        const double first = lmb_emission_map_sum(map, &half[0]);
        const bool second = second_choose(u, cut.axis, first / sum);
        sum = second ? sum - first : first;
        at = half[second];
    }
    return at;
}

/* Density within a full part, beside points even over that. */
static double cell_density(const lmb_emission_map *map, const lmb_texel_range *range, const int32_t cell[2])
{
    const lmb_texel_range one = {{cell[0], cell[1]}, {cell[0] + 1, cell[1] + 1}};
    return lmb_emission_map_mean(map, &one) / lmb_emission_map_mean(map, range);
}

/* Whether all that is left is to choose a cell, or a point of a single one. */
static bool choice_ends(const lmb_emission_map *map, const lmb_emission_part *part, lmb_texel_range *range,
                        lmb_emission_cut *cut)
{
    if (!map || part->count + 2 > LMB_PART_CORNERS) {
        return true;
    }
    *range = part_range(part);
    return !range_cut(map, range, cut) || part_is_full(part, range);
}

bool lmb_emission_part_sample(const lmb_emission_map *map, const lmb_emission_part *part, const float u[2],
                              float weight[2], float *density)
{
    lmb_emission_part room[2][2]; /* halves of a part that is one of the other two */
    const lmb_emission_part *at = part;
    choice_variates choice = {{(double)u[0], (double)u[1]}, {1.0, 1.0}};
    lmb_texel_range range;
    lmb_emission_cut cut;
    for (int turn = 0; !choice_ends(map, at, &range, &cut); turn ^= 1) {
        lmb_emission_part_halve(at, &cut, room[turn]);
        const double first = first_probability(map, room[turn]);
        if (first < 0.0) {
            return false;
        }
        at = &room[turn][second_choose(&choice, cut.axis, first)];
    }
    double found = choice.used[0] * choice.used[1] / lmb_emission_part_area(at);
    if (map && part_is_full(at, &range)) {
        const lmb_texel_range cell = cell_choose(map, &range, &choice);
        double share[2];
        variates_refill(&choice, u);
        for (int axis = 0; axis < 2; ++axis) {
            share[axis] = (cell.first[axis] - range.first[axis] + choice.left[axis]) /
                          (double)(range.end[axis] - range.first[axis]);
        }
        found *= cell_density(map, &range, cell.first);
        full_point(at, &range, share, weight);
    } else {
        variates_refill(&choice, u);
        polygon_point(at, choice.left, weight);
    }
    *density = (float)found;
    return *density > 0.0f && isfinite(*density);
}

double lmb_emission_part_density(const lmb_emission_map *map, const lmb_emission_part *part, const double texel[2])
{
    lmb_emission_part room[2][2];
    const lmb_emission_part *at = part;
    lmb_texel_range range;
    lmb_emission_cut cut;
    double found = 1.0;
    for (int turn = 0; !choice_ends(map, at, &range, &cut); turn ^= 1) {
        lmb_emission_part_halve(at, &cut, room[turn]);
        const double first = first_probability(map, room[turn]);
        const bool second = texel[cut.axis] >= cut.line;
        const double share = second ? 1.0 - first : first;
        if (first < 0.0 || !(share > 0.0)) {
            return 0.0;
        }
        found *= share;
        at = &room[turn][second];
    }
    if (map && part_is_full(at, &range)) {
        int32_t cell[2];
        for (int axis = 0; axis < 2; ++axis) {
            const int32_t last = range.end[axis] - 1;
            const double at_texel = floor(texel[axis]);
            cell[axis] = at_texel < range.first[axis] ? range.first[axis] : at_texel > last ? last : (int32_t)at_texel;
        }
        found *= cell_density(map, &range, cell);
    }
    const double density = found / lmb_emission_part_area(at);
    return isfinite(density) ? density : 0.0;
}
