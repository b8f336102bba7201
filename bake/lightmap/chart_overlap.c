/* Whether triangles of charts cover each other. */
#include "lightmap/chart_internal.h"

#include <math.h>

/* Whether an edge of `a` has all of `b` on its outer side, but for `slack`. */
static bool edge_separates(const chart_vec2 *a, const chart_vec2 *b, double slack)
{
    for (int e = 0; e < 3; ++e) {
        const chart_vec2 from = a[e];
        const chart_vec2 to = a[(e + 1) % 3];
        const double dx = to.x - from.x;
        const double dy = to.y - from.y;
        double deepest = -HUGE_VAL;
        for (int k = 0; k < 3; ++k) {
            deepest = fmax(deepest, dx * (b[k].y - from.y) - dy * (b[k].x - from.x));
        }
        if (deepest <= slack * sqrt(dx * dx + dy * dy)) {
            return true;
        }
    }
    return false;
}

/* Separating axes: in the plane, one of the six edges separates two triangles that do not overlap. */
bool lmb_chart_triangles_overlap(const chart_vec2 *a, const chart_vec2 *b, double slack)
{
    return !edge_separates(a, b, slack) && !edge_separates(b, a, slack);
}
