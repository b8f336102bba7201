/* The line through a cloud of weighted points in three dimensions along which they spread most. */
#ifndef LMB_COLOUR_LINE_H
#define LMB_COLOUR_LINE_H

/* Sums over points: those of a part of them are the difference of two. */
typedef struct colour_sums {
    float weight;
    float first[3];  /* of weight * point */
    float second[6]; /* of its products xx, xy, xz, yy, yz, zz */
} colour_sums;

static inline void colour_sums_add(colour_sums *sums, const float point[3], float weight)
{
    const float x = weight * point[0], y = weight * point[1], z = weight * point[2];
    sums->weight += weight;
    sums->first[0] += x;
    sums->first[1] += y;
    sums->first[2] += z;
    sums->second[0] += x * point[0];
    sums->second[1] += x * point[1];
    sums->second[2] += x * point[2];
    sums->second[3] += y * point[1];
    sums->second[4] += y * point[2];
    sums->second[5] += z * point[2];
}

/* a - b */
colour_sums lmb_colour_line_rest(const colour_sums *a, const colour_sums *b);

typedef struct colour_line {
    float mean[3];
    float axis[3]; /* of length 1; any where the points are one */
    float off;     /* weighted sum of the squared distances from the line, >= 0 */
} colour_line;

colour_line lmb_colour_line_fit(const colour_sums *sums);

#endif
