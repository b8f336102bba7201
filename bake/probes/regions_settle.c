/* What divides cells on both sides of a face must pass light over alike there, or there would be a step in free space:
 * what does not is given up. */
#include "probes/regions_internal.h"

#include <math.h>

/* Shares of light that are alike. */
#define ALIKE 0.02f

/* Whether a region reaches a face where that is open. */
static bool is_at_face(const lmb_region_look *look, int face, uint8_t label)
{
    bool is_at = false;
    for (int line = 0; line < LMB_REGION_LINES && !is_at; ++line) {
        const int node = lmb_region_line_node(face / 2, line, face % 2 * (LMB_REGION_SIDE - 1));
        is_at = (look->open[face] >> line & 1u) != 0 && look->label[node] == label;
    }
    return is_at;
}

static bool divides_face(const lmb_region_look *look, const lmb_region_extension *extension, int face)
{
    return extension->label[0] != LMB_REGION_NONE && extension->label[1] != LMB_REGION_NONE &&
           is_at_face(look, face, extension->label[0]) && is_at_face(look, face, extension->label[1]);
}

/* How much of the light at t is that of the region above. */
static float share_above(const lmb_region_extension *extension, const float t[3])
{
    static const uint8_t sides[2] = {0, 1};
    lmb_region_tree tree = {.plane_count = 0};
    lmb_region_wedge_add(extension, sides, &tree);
    const lmb_cell_regions at = lmb_cell_regions_at(tree.plane, tree.plane_count, t);
    return (at.region[0] == 1 ? 1.0f - at.share : 0.0f) + (at.region[1] == 1 ? at.share : 0.0f);
}

/* A place of a cell, in the coordinates of another one. */
static void place_moved(const lmb_region_cell *from, const lmb_region_cell *to, const float t[3], float moved[3])
{
    const double ratio = ldexp(1.0, (int)from->level - (int)to->level);
    for (int axis = 0; axis < 3; ++axis) {
        moved[axis] = (float)(ratio * ((double)from->point[axis] + (double)t[axis]) - (double)to->point[axis]);
    }
}

/* Whether two extensions share out light alike on the face of a cell beyond which the other one, not finer, lies. */
static bool are_alike(const lmb_region_work *work, const lmb_region_look *one, const lmb_region_extension *own,
                      int face, const lmb_region_look *other, const lmb_region_extension *beyond)
{
    const lmb_region_cell *const from = &work->cell[work->looked[one - work->look]];
    const lmb_region_cell *const to = &work->cell[work->looked[other - work->look]];
    const bool turned = lmb_vec3_dot(own->plane.normal, beyond->plane.normal) < 0.0f;
    bool alike = true;
    for (int line = 0; line < LMB_REGION_LINES && alike; ++line) {
        const int node = lmb_region_line_node(face / 2, line, face % 2 * (LMB_REGION_SIDE - 1));
        const uint8_t label = one->label[node];
        if ((one->open[face] >> line & 1u) == 0 || (label != own->label[0] && label != own->label[1])) {
            continue;
        }
        float t[3], there[3];
        lmb_region_node_at(node, t);
        t[face / 2] = (float)(face % 2);
        place_moved(from, to, t, there);
        const float share = share_above(beyond, there);
        alike = fabsf(share_above(own, t) - (turned ? 1.0f - share : share)) < ALIKE;
    }
    return alike;
}

/* Makes one region of the two again. */
static void extension_drop(lmb_region_look *look, uint32_t index)
{
    const lmb_region_extension dropped = look->extension[index];
    for (int node = 0; node < LMB_REGION_NODES; ++node) {
        look->label[node] = look->label[node] == dropped.label[1] ? dropped.label[0] : look->label[node];
    }
    look->real[dropped.label[0]] |= look->real[dropped.label[1]];
    look->real[dropped.label[1]] = 0;
    look->extension[index] = look->extension[--look->extension_count];
}

/* Whether an extension goes with what a cell beyond a face has. */
static bool goes_with(const lmb_region_work *work, const lmb_region_look *look, const lmb_region_extension *extension,
                      int face, const lmb_region_cell *beyond)
{
    const lmb_region_cell *const cell = &work->cell[work->looked[look - work->look]];
    const lmb_region_look *const other = beyond->look == UINT32_MAX ? NULL : &work->look[beyond->look];
    const bool is_finer = beyond->level < cell->level;
    bool any = false, alike = false;
    for (uint32_t i = 0; other && i < other->extension_count; ++i) {
        const lmb_region_extension *const found = &other->extension[i];
        if (divides_face(other, found, face ^ 1)) {
            any = true;
            alike = alike || (is_finer ? are_alike(work, other, found, face ^ 1, look, extension)
                                       : are_alike(work, look, extension, face, other, found));
        }
    }
    if (any) {
        return alike;
    }
    /* An undivided cell makes both sides one on the face, but not where finer ones hang on it. */
    return !is_finer || !lmb_region_plane_crosses(&extension->plane, cell, beyond);
}

/* How far a place on a face is from the edges of the cell: there both regions mostly have the same probes. */
static float off_edges(const float t[3], int axis)
{
    const float a = t[(axis + 1) % 3], b = t[(axis + 2) % 3];
    return fminf(fminf(a, 1.0f - a), fminf(b, 1.0f - b));
}

/* Whether all light at a face that one region alone reaches is its. */
static bool is_pure(const lmb_region_look *look, const lmb_region_extension *extension, int face)
{
    bool pure = true;
    for (int line = 0; line < LMB_REGION_LINES && pure; ++line) {
        const int node = lmb_region_line_node(face / 2, line, face % 2 * (LMB_REGION_SIDE - 1));
        const bool is_above = look->label[node] == extension->label[1];
        if ((look->open[face] >> line & 1u) != 0 && (is_above || look->label[node] == extension->label[0])) {
            float t[3];
            lmb_region_node_at(node, t);
            t[face / 2] = (float)(face % 2);
            pure = off_edges(t, face / 2) * fabsf(share_above(extension, t) - (is_above ? 1.0f : 0.0f)) < ALIKE;
        }
    }
    return pure;
}

static bool extension_holds(const lmb_region_work *work, const lmb_region_look *look,
                            const lmb_region_extension *extension)
{
    const lmb_region_cell *const cell = &work->cell[work->looked[look - work->look]];
    bool holds = true;
    for (int face = 0; face < 6 && holds; ++face) {
        uint32_t beside[4];
        const bool divides = divides_face(look, extension, face);
        const int count = divides ? lmb_region_cells_beside(work, cell, face, beside) : 0;
        holds = divides || is_pure(look, extension, face);
        for (int i = 0; i < count && holds; ++i) {
            holds = goes_with(work, look, extension, face, &work->cell[beside[i]]);
        }
    }
    return holds;
}

/* Gives up those of a cell that do not hold. @return whether there were any */
static bool cell_settle(const lmb_region_work *work, lmb_region_look *look, bool passed_alone)
{
    bool dropped = false;
    for (uint32_t k = 0; k < look->extension_count;) {
        const lmb_region_extension *const extension = &look->extension[k];
        const bool is_one = extension->label[0] == LMB_REGION_NONE || extension->label[1] == LMB_REGION_NONE;
        if (is_one || (passed_alone && !extension->passed) || extension_holds(work, look, extension)) {
            ++k;
        } else {
            extension_drop(look, k);
            dropped = true;
        }
    }
    return dropped;
}

void lmb_region_extensions_settle(lmb_region_work *work)
{
    for (int all = 0; all < 2; ++all) {
        for (bool dropped = true; dropped;) {
            dropped = false;
            for (uint32_t i = 0; i < work->look_count; ++i) {
                dropped = cell_settle(work, &work->look[i], all == 0) || dropped;
            }
        }
    }
}
