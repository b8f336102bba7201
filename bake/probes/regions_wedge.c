/* Wedges: beyond what ends in a cell the light of both sides passes over into each other, in the space between two
 * planes that lean from the one that parts them and meet it at the end. */
#include "probes/regions_internal.h"

#include <math.h>

/* Of a wedge, at either side: how far it opens over a way from the rim. */
#define WIDEST 1.0f
#define NARROWEST 0.05f

/* Whether a region reaches a face. */
static bool is_at_face(const lmb_region_look *look, int face, uint8_t label)
{
    bool is_at = false;
    for (int line = 0; line < LMB_REGION_LINES && !is_at; ++line) {
        is_at = look->label[lmb_region_line_node(face / 2, line, face % 2 * (LMB_REGION_SIDE - 1))] == label;
    }
    return is_at;
}

/* How far beyond its rim an extension goes from a place: passed on, by a cell more. */
static float beyond_most(const lmb_region_extension *extension, const float t[3])
{
    const float rim[3] = {extension->rim.normal.x, extension->rim.normal.y, extension->rim.normal.z};
    float more = 0.0f;
    for (int face = 0; face < 6; ++face) {
        if ((extension->faces >> face & 1) != 0) {
            more = fmaxf(more, face % 2 != 0 ? rim[face / 2] : -rim[face / 2]);
        }
    }
    return lmb_region_above(&extension->rim, t) + more;
}

/* How wide a wedge can open towards a region, the one above (side 1) or below (side 0), so that it does not reach faces
 * where that region alone is: beyond these, nothing passes over. */
static float wedge_slope(const lmb_region_look *look, const lmb_region_extension *extension, int side)
{
    float slope = WIDEST;
    for (int face = 0; face < 6; ++face) {
        if (!is_at_face(look, face, extension->label[side]) || is_at_face(look, face, extension->label[1 - side])) {
            continue;
        }
        for (int i = 0; i < 4; ++i) {
            float t[3];
            t[face / 2] = (float)(face % 2);
            t[(face / 2 + 1) % 3] = (float)(i & 1);
            t[(face / 2 + 2) % 3] = (float)(i >> 1);
            const float above = lmb_region_above(&extension->plane, t), height = side != 0 ? above : -above;
            const float beyond = beyond_most(extension, t);
            if (height > 0.0f && beyond > 0.0f) {
                slope = fminf(slope, height / beyond);
            }
        }
    }
    return fmaxf(slope, NARROWEST);
}

void lmb_region_wedge_open(const lmb_region_look *look, lmb_region_extension *extension)
{
    for (int side = 0; side < 2; ++side) {
        extension->slope[side] = wedge_slope(look, extension, side);
    }
}

static lmb_cell_plane plane_of(lmb_vec3 normal, float offset, uint32_t below, uint32_t above)
{
    return (lmb_cell_plane){
        .normal = {lmb_region_quantised(normal.x), lmb_region_quantised(normal.y), lmb_region_quantised(normal.z)},
        .offset = lmb_region_quantised(offset),
        .child = {(uint8_t)below, (uint8_t)above}};
}

/* The plane through the rim that leans by `slope` from the extension's. */
static lmb_cell_plane leaning_plane(const lmb_region_extension *extension, float slope, uint32_t below, uint32_t above)
{
    const float inverse = 1.0f / sqrtf(1.0f + slope * slope);
    const lmb_vec3 normal =
        lmb_vec3_scale(lmb_vec3_mad(extension->plane.normal, extension->rim.normal, -slope), inverse);
    return plane_of(normal, inverse * (extension->plane.offset - slope * extension->rim.offset), below, above);
}

/* Where something that ends reaches to, of the way beyond its rim that a cell has; false: it is not in the cell. */
static bool wedge_reach(const lmb_region_extension *extension, float *reach)
{
    float least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 8; ++i) {
        const float t[3] = {(float)(i & 1), (float)(i >> 1 & 1), (float)(i >> 2)};
        const float beyond = lmb_region_above(&extension->rim, t);
        least = fminf(least, beyond);
        most = fmaxf(most, beyond);
    }
    *reach = extension->reach < most ? extension->reach : INFINITY;
    return most > 0.0f && least < extension->reach;
}

uint8_t lmb_region_wedge_add(const lmb_region_extension *extension, const uint8_t region[2], lmb_region_tree *tree)
{
    const uint32_t at = tree->plane_count, low = LMB_CELL_REGION + region[0], high = LMB_CELL_REGION + region[1];
    const lmb_region_plane *const rim = &extension->rim;
    uint32_t below = low, above = high;
    float reach = 0.0f;
    tree->plane_count += 1;
    if (wedge_reach(extension, &reach)) {
        const uint32_t ends = tree->plane_count, first = ends + (reach < INFINITY ? 2 : 0), second = first + 1;
        above = ends;
        below = reach < INFINITY ? ends + 1 : second;
        if (reach < INFINITY) {
            /* Beyond, both regions are apart again. */
            tree->plane[ends] = plane_of(rim->normal, rim->offset + reach, first, high);
            tree->plane[ends + 1] = plane_of(rim->normal, rim->offset + reach, second, low);
        }
        tree->plane[first] = leaning_plane(extension, extension->slope[1], LMB_CELL_BLEND + second, high);
        tree->plane[second] = leaning_plane(extension, -extension->slope[0], low, LMB_CELL_BLEND + first);
        tree->plane_count = second + 1;
    }
    tree->plane[at] = plane_of(extension->plane.normal, extension->plane.offset, below, above);
    return (uint8_t)at;
}
