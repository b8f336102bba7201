/* The search for a good block: lines are fitted in the scale of half codes, where equal steps are about equal shares of
 * the light, and what is found is judged by the light that a decoder gives. */
#include "texture/bc6h.h"

#include <math.h>
#include <string.h>

#include "texture/colour_line.h"
#include "texture/half_codes.h"

/* Partitions that are tried, of those whose lines fit best; modes of each, the finest whose differences fit; rounds of
 * choosing indices and then ends for them. */
enum { PARTITIONS_TRIED = 8, MODES_TRIED = 2, ROUNDS = 3, NUDGES = 2 };

/* Two lines are tried where one leaves more than this of the light as error, root mean square. */
#define GOOD_ENOUGH 0.002f

/* A channel's errors count as if it were at least this share of the brightest one: a small error of the light, however
 * large a share of a channel that hardly shines. */
#define DIM_SHARE 0.0625f

/* Widened ends, 0 to 65535, for each half code. */
#define WIDE_STEP (64.0f / 31.0f)

/* Finest first. */
static const int one_line[] = {13, 12, 11, 10};
static const int two_lines[] = {2, 3, 4, 0, 5, 6, 7, 8, 1, 9};

typedef struct search {
    const bc6h_texels *texels;
    float wide[BC6H_TEXELS][3];  /* where texels lie in the scale of widened ends */
    float steep[BC6H_TEXELS][3]; /* the weight of a squared error there */
    float share[BC6H_TEXELS];    /* and that of a squared error of the light */
    float stretch[3];            /* makes of the scale's channels a space in which errors count alike */
    float total;                 /* of weights */
    bc6h_block best;
    float best_error;
} search;

typedef struct line_ends {
    float end[BC6H_ENDS][3]; /* widened */
} line_ends;

static float clamped(float value, float low, float high)
{
    return value > low ? value < high ? value : high : low;
}

static void search_begin(search *s, const bc6h_texels *texels)
{
    memset(s, 0, sizeof *s);
    s->texels = texels;
    s->best_error = INFINITY;
    float sum[3] = {0.0f, 0.0f, 0.0f};
    for (int i = 0; i < BC6H_TEXELS; ++i) {
        const float *colour = texels->colour[i];
        const float brightest = fmaxf(fmaxf(colour[0], colour[1]), colour[2]);
        const float relative = 1.0f / (brightest + texels->floor);
        s->share[i] = texels->weight[i] * relative * relative;
        s->total += texels->weight[i];
        for (int c = 0; c < 3; ++c) {
            const float code = half_code_of(colour[c]);
            const int32_t least = (int32_t)half_code_of(fmaxf(colour[c], DIM_SHARE * brightest));
            const float step = half_code_value(least + 1) - half_code_value(least);
            s->wide[i][c] = (code + 0.5f) * WIDE_STEP; /* decoders round down */
            s->steep[i][c] = s->share[i] * step * step;
            sum[c] += s->steep[i][c];
        }
    }
    for (int c = 0; c < 3; ++c) {
        s->stretch[c] = s->total > 0.0f ? sqrtf(sum[c] / s->total) : 1.0f;
    }
}

static int32_t end_quantise(float wide, int bits)
{
    const float steps = (float)(1 << bits) * (1.0f / 65536.0f);
    const float exact = bits >= 15 ? wide + 0.5f : wide * steps;
    return (int32_t)clamped(exact, 0.0f, (float)((1 << bits) - 1));
}

/* Quantises ends, moving those whose difference the mode cannot hold. Returns whether none was moved. */
static bool ends_quantise(const line_ends *ends, bc6h_block *block)
{
    const bc6h_mode *mode = &lmb_bc6h_modes[block->mode];
    bool kept = true;
    for (int end = 0; end < 2 * mode->subsets; ++end) {
        for (int c = 0; c < 3; ++c) {
            int32_t value = end_quantise(ends->end[end][c], mode->bits);
            if (mode->differences && end > 0) {
                const int32_t reach = 1 << (mode->other_bits[c] - 1), base = block->end[0][c];
                const int32_t low = base - reach, high = base + reach - 1;
                const int32_t held = value < low ? low : value > high ? high : value;
                kept = kept && held == value;
                value = held;
            }
            block->end[end][c] = value;
        }
    }
    return kept;
}

enum { MOST_STEPS = 16 };

/* The colours along a line of a block. */
static void line_colours(const bc6h_block *block, int subset, float colours[MOST_STEPS][3])
{
    const bc6h_mode *mode = &lmb_bc6h_modes[block->mode];
    const int steps = mode->subsets == 1 ? MOST_STEPS : MOST_STEPS / 2;
    for (int c = 0; c < 3; ++c) {
        const int32_t first = bc6h_widen(block->end[2 * subset][c], mode->bits);
        const int32_t second = bc6h_widen(block->end[2 * subset + 1][c], mode->bits);
        for (int k = 0; k < steps; ++k) {
            colours[k][c] = half_code_value(bc6h_half(first, second, bc6h_weight(mode->subsets, k)));
        }
    }
}

/* The nearest of `steps` colours, and its squared distance. */
static int nearest_find(const float colour[3], float colours[MOST_STEPS][3], int steps, float *distance)
{
    int nearest = 0;
    *distance = INFINITY;
    for (int k = 0; k < steps; ++k) {
        const float r = colours[k][0] - colour[0], g = colours[k][1] - colour[1], b = colours[k][2] - colour[2];
        const float squared = r * r + g * g + b * b;
        if (squared < *distance) {
            *distance = squared;
            nearest = k;
        }
    }
    return nearest;
}

/* Chooses every index, and keeps the block if it is the best so far. Returns its error. */
static float block_judge(search *s, bc6h_block *block)
{
    const int subsets = lmb_bc6h_modes[block->mode].subsets;
    const int steps = subsets == 1 ? MOST_STEPS : MOST_STEPS / 2;
    float colours[2][MOST_STEPS][3];
    for (int subset = 0; subset < subsets; ++subset) {
        line_colours(block, subset, colours[subset]);
    }
    float error = 0.0f;
    for (int i = 0; i < BC6H_TEXELS; ++i) {
        const bool anchor = i == 0 || (subsets == 2 && i == lmb_bc6h_anchors[block->partition]);
        if (s->share[i] == 0.0f) {
            block->index[i] = 0;
            continue;
        }
        float distance;
        block->index[i] = (uint8_t)nearest_find(s->texels->colour[i], colours[bc6h_subset(block, i)],
                                                anchor ? steps / 2 : steps, &distance);
        error += s->share[i] * distance;
    }
    if (error < s->best_error) {
        s->best_error = error;
        s->best = *block;
    }
    return error;
}

/* Turns lines round so that their anchors lie in the first half. */
static void ends_turn(const search *s, const bc6h_block *block, line_ends *ends)
{
    for (int subset = 0; subset < lmb_bc6h_modes[block->mode].subsets; ++subset) {
        const int anchor = subset == 0 ? 0 : lmb_bc6h_anchors[block->partition];
        float *const first = ends->end[2 * subset], *const second = ends->end[2 * subset + 1];
        float nearer_second = 0.0f;
        for (int c = 0; c < 3; ++c) {
            const float a = s->wide[anchor][c] - first[c], b = s->wide[anchor][c] - second[c];
            nearer_second += s->steep[anchor][c] * (a * a - b * b);
        }
        for (int c = 0; c < 3 && nearer_second > 0.0f; ++c) {
            const float kept = first[c];
            first[c] = second[c];
            second[c] = kept;
        }
    }
}

/* The ends of a line, channel by channel, that suit the indices best: weighted least squares. Where all indices are
 * alike they stay as they are. */
static void ends_refit(const search *s, const bc6h_block *block, int subset, line_ends *ends)
{
    const int subsets = lmb_bc6h_modes[block->mode].subsets;
    for (int c = 0; c < 3; ++c) {
        float aa = 0.0f, ab = 0.0f, bb = 0.0f, ax = 0.0f, bx = 0.0f;
        for (int i = 0; i < BC6H_TEXELS; ++i) {
            if (bc6h_subset(block, i) == subset) {
                const float b = (float)bc6h_weight(subsets, block->index[i]) * (1.0f / 64.0f), a = 1.0f - b;
                const float weight = s->steep[i][c], x = s->wide[i][c];
                aa += weight * a * a;
                ab += weight * a * b;
                bb += weight * b * b;
                ax += weight * a * x;
                bx += weight * b * x;
            }
        }
        const float determinant = aa * bb - ab * ab;
        if (determinant > 1e-4f * aa * bb) {
            ends->end[2 * subset][c] = clamped((ax * bb - bx * ab) / determinant, 0.0f, 65535.0f);
            ends->end[2 * subset + 1][c] = clamped((bx * aa - ax * ab) / determinant, 0.0f, 65535.0f);
        }
    }
}

/* Tries a mode from these ends on. Returns whether it can hold them. */
static bool mode_try(search *s, bc6h_block block, line_ends ends)
{
    bc6h_block fitted = block;
    ends_turn(s, &fitted, &ends);
    if (!ends_quantise(&ends, &fitted) && lmb_bc6h_modes[block.mode].differences) {
        block_judge(s, &fitted);
        return false;
    }
    float error = block_judge(s, &fitted);
    for (int round = 1; round < ROUNDS; ++round) {
        for (int subset = 0; subset < lmb_bc6h_modes[block.mode].subsets; ++subset) {
            ends_refit(s, &fitted, subset, &ends);
        }
        ends_turn(s, &fitted, &ends);
        ends_quantise(&ends, &fitted);
        const float next = block_judge(s, &fitted);
        if (!(next < error)) {
            break;
        }
        error = next;
    }
    return true;
}

/* A texel in the space in which errors count alike. */
static void point_of(const search *s, int texel, float point[3])
{
    for (int c = 0; c < 3; ++c) {
        point[c] = s->wide[texel][c] * s->stretch[c];
    }
}

/* The part of a line that holds its texels. */
static void ends_span(const search *s, const colour_line *line, unsigned texels, float ends[2][3])
{
    float low = 0.0f, high = 0.0f;
    bool any = false;
    for (int i = 0; i < BC6H_TEXELS; ++i) {
        if ((texels >> i & 1u) && s->share[i] > 0.0f) {
            float point[3], at = 0.0f;
            point_of(s, i, point);
            for (int c = 0; c < 3; ++c) {
                at += (point[c] - line->mean[c]) * line->axis[c];
            }
            low = any ? fminf(low, at) : at;
            high = any ? fmaxf(high, at) : at;
            any = true;
        }
    }
    for (int c = 0; c < 3; ++c) {
        const float stretch = fmaxf(s->stretch[c], 1e-30f);
        ends[0][c] = clamped((line->mean[c] + low * line->axis[c]) / stretch, 0.0f, 65535.0f);
        ends[1][c] = clamped((line->mean[c] + high * line->axis[c]) / stretch, 0.0f, 65535.0f);
    }
}

static colour_sums sums_of(const search *s, unsigned texels)
{
    colour_sums sums = {0};
    for (int i = 0; i < BC6H_TEXELS; ++i) {
        if (texels >> i & 1u) {
            float point[3];
            point_of(s, i, point);
            colour_sums_add(&sums, point, s->texels->weight[i]);
        }
    }
    return sums;
}

static void modes_try(search *s, const int *modes, int count, int partition, const line_ends *ends)
{
    int held = 0;
    for (int i = 0; i < count && held < MODES_TRIED; ++i) {
        const bc6h_block block = {.mode = modes[i], .partition = partition};
        held += mode_try(s, block, *ends);
    }
}

static void one_line_try(search *s, const colour_sums *all)
{
    const colour_line line = lmb_colour_line_fit(all);
    line_ends ends = {{{0}}};
    ends_span(s, &line, 0xFFFFu, ends.end);
    modes_try(s, one_line, (int)(sizeof one_line / sizeof one_line[0]), 0, &ends);
}

static void partition_try(search *s, const colour_sums *all, int partition)
{
    const unsigned second = lmb_bc6h_partitions[partition];
    const colour_sums sums_second = sums_of(s, second), sums_first = lmb_colour_line_rest(all, &sums_second);
    const colour_line lines[2] = {lmb_colour_line_fit(&sums_first), lmb_colour_line_fit(&sums_second)};
    line_ends ends;
    ends_span(s, &lines[0], ~second & 0xFFFFu, ends.end);
    ends_span(s, &lines[1], second, ends.end + 2);
    modes_try(s, two_lines, (int)(sizeof two_lines / sizeof two_lines[0]), partition, &ends);
}

static void two_lines_try(search *s, const colour_sums *all)
{
    float off[BC6H_PARTITIONS];
    for (int p = 0; p < BC6H_PARTITIONS; ++p) {
        const colour_sums second = sums_of(s, lmb_bc6h_partitions[p]), first = lmb_colour_line_rest(all, &second);
        off[p] = lmb_colour_line_fit(&first).off + lmb_colour_line_fit(&second).off;
    }
    for (int k = 0; k < PARTITIONS_TRIED; ++k) {
        int best = 0;
        for (int p = 1; p < BC6H_PARTITIONS; ++p) {
            best = off[p] < off[best] ? p : best;
        }
        partition_try(s, all, best);
        off[best] = INFINITY;
    }
}

/* Whether the mode can hold the ends as they are. */
static bool ends_hold(const bc6h_block *block)
{
    const bc6h_mode *mode = &lmb_bc6h_modes[block->mode];
    bool hold = true;
    for (int end = 0; end < 2 * mode->subsets; ++end) {
        for (int c = 0; c < 3; ++c) {
            const int32_t value = block->end[end][c], difference = value - block->end[0][c];
            const int32_t reach = 1 << (mode->other_bits[c] - 1);
            hold = hold && value >= 0 && value < 1 << mode->bits &&
                   (!mode->differences || end == 0 || (difference >= -reach && difference < reach));
        }
    }
    return hold;
}

/* Moves one value of the best block at a time by one step, for as long as that makes it better. */
static void best_nudge(search *s)
{
    const int values = 6 * lmb_bc6h_modes[s->best.mode].subsets;
    for (int round = 0; round < NUDGES; ++round) {
        const float before = s->best_error;
        for (int i = 0; i < 2 * values; ++i) {
            bc6h_block block = s->best;
            block.end[i / 2 / 3][i / 2 % 3] += i % 2 ? 1 : -1;
            if (ends_hold(&block)) {
                block_judge(s, &block);
            }
        }
        if (!(s->best_error < before)) {
            break;
        }
    }
}

float lmb_bc6h_encode(const bc6h_texels *texels, uint8_t bytes[BC6H_BYTES])
{
    search s;
    search_begin(&s, texels);
    if (!(s.total > 0.0f)) {
        lmb_bc6h_modes_pack(&(bc6h_block){.mode = one_line[0]}, bytes);
        return 0.0f;
    }
    const colour_sums all = sums_of(&s, 0xFFFFu);
    one_line_try(&s, &all);
    if (s.best_error > GOOD_ENOUGH * GOOD_ENOUGH * s.total) {
        two_lines_try(&s, &all);
        best_nudge(&s);
    }
    lmb_bc6h_modes_pack(&s.best, bytes);
    return s.best_error;
}
