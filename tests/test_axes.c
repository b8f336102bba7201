/* Light in other systems of axes: lmb_sh3_in_axes, and the tables of docs/sampling.md, which are read from there. */
#include "harness.h"

#include <stdlib.h>

#include <lambent/sh.h>
#include <lambent/vector.h>

static const lmb_sh3 light = {{1.0f, 0.25f, -0.5f, 0.75f, -0.3f, 0.6f, 0.45f, -0.85f, 0.2f}};

static const lmb_vec3 directions[] = {
    {1.0f, 0.0f, 0.0f},  {0.0f, 1.0f, 0.0f},    {0.0f, 0.0f, 1.0f},     {-1.0f, 0.0f, 0.0f},
    {0.6f, 0.8f, 0.0f},  {0.0f, -0.6f, 0.8f},   {0.48f, 0.6f, 0.64f},   {-0.48f, 0.64f, -0.6f},
    {0.8f, 0.0f, -0.6f}, {0.36f, -0.48f, 0.8f}, {-0.8f, -0.36f, 0.48f},
};
enum { DIRECTIONS = sizeof directions / sizeof directions[0] };

static lmb_vec3 in_axes(lmb_vec3 d, const lmb_vec3 axes[3])
{
    return (lmb_vec3){lmb_vec3_dot(axes[0], d), lmb_vec3_dot(axes[1], d), lmb_vec3_dot(axes[2], d)};
}

static void check_same_light(const lmb_sh3 *turned, const lmb_vec3 axes[3], const char *name)
{
    for (int i = 0; i < DIRECTIONS; ++i) {
        const lmb_vec3 d = directions[i];
        CHECK_NEAR(lmb_sh3_evaluate(turned, in_axes(d, axes)), lmb_sh3_evaluate(&light, d), 2e-6, "%s (%g, %g, %g)",
                   name, (double)d.x, (double)d.y, (double)d.z);
    }
}

/* All 48 signed permutations of the axes, and a rotation that mixes all of them. */
static void test_every_turn(void)
{
    static const int permutations[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (int turn = 0; turn < 48; ++turn) {
        lmb_vec3 axes[3];
        for (int i = 0; i < 3; ++i) {
            float axis[3] = {0.0f, 0.0f, 0.0f};
            axis[permutations[turn / 8][i]] = turn >> i & 1 ? -1.0f : 1.0f;
            axes[i] = (lmb_vec3){axis[0], axis[1], axis[2]};
        }
        const lmb_sh3 turned = lmb_sh3_in_axes(&light, axes);
        char name[32];
        snprintf(name, sizeof name, "turn %d", turn);
        check_same_light(&turned, axes, name);
    }
    const lmb_vec3 oblique[3] = {{0.36f, 0.48f, -0.8f}, {-0.8f, 0.6f, 0.0f}, {0.48f, 0.64f, 0.6f}};
    const lmb_sh3_rgb coloured = lmb_sh3_rgb_in_axes(&(lmb_sh3_rgb){{light, {{0.0f}}, light}}, oblique);
    check_same_light(&coloured.channel[0], oblique, "oblique, red");
    check_same_light(&coloured.channel[2], oblique, "oblique, blue");
}

/* "(x, -z, y)" -> the axes of the system it leads to; what stands before the bracket is a scale. */
static bool read_axes(const char *text, lmb_vec3 axes[3])
{
    text = strchr(text, '(');
    for (int i = 0; text && i < 3; ++i) {
        ++text;
        text += strspn(text, " ");
        const float sign = *text == '-' ? -1.0f : 1.0f;
        text += *text == '-';
        axes[i] = (lmb_vec3){*text == 'x' ? sign : 0.0f, *text == 'y' ? sign : 0.0f, *text == 'z' ? sign : 0.0f};
        text = strpbrk(text, ",)");
    }
    return text && *text == ')';
}

/* "-0.5 c6 - 0.8660254 c8" of `sh` */
static float read_sum(const char *text, const lmb_sh3 *sh)
{
    float sum = 0.0f;
    float sign = 1.0f;
    float factor = 1.0f;
    while (*text && *text != '|') {
        char *end = NULL;
        if (*text == '+' || *text == '-') {
            sign = *text == '-' ? -1.0f : 1.0f;
        } else if (*text == 'c') {
            sum += sign * factor * sh->c[(text[1] - '0') % LMB_SH3_COUNT];
            factor = 1.0f;
            ++text;
        } else if (*text != ' ') {
            factor = strtof(text, &end);
        }
        text = end && end > text ? end : text + 1;
    }
    return sum;
}

/* The table's row for an engine: the next one, with `columns` columns, that begins with its name. */
static bool find_row(FILE *file, const char *engine, int columns, char row[512])
{
    while (fgets(row, 512, file)) {
        int bars = 0;
        for (const char *c = row; *c; ++c) {
            bars += *c == '|';
        }
        if (bars == columns + 1 && row[0] == '|' && strncmp(row + 2, engine, strlen(engine)) == 0) {
            return true;
        }
    }
    return false;
}

static void test_tables(void)
{
    static const char *const engines[] = {"glTF", "Unity", "Unreal", "Blender"};
    for (int i = 0; i < 4; ++i) {
        FILE *const file = fopen(LMB_SOURCE_DIR "/docs/sampling.md", "r");
        CHECK(file, "docs/sampling.md");
        char row[512];
        lmb_vec3 axes[3];
        if (!file) {
            return;
        }
        const bool has_axes = find_row(file, engines[i], 2, row) && read_axes(row, axes);
        CHECK(has_axes, "no position for %s", engines[i]);
        const bool has_row = find_row(file, engines[i], 1 + LMB_SH3_COUNT, row);
        CHECK(has_row, "no coefficients for %s", engines[i]);
        lmb_sh3 turned;
        const char *cell = strchr(row + 1, '|');
        for (int k = 0; has_row && k < LMB_SH3_COUNT; ++k) {
            turned.c[k] = read_sum(cell + 1, &light);
            cell = strchr(cell + 1, '|');
        }
        if (has_axes && has_row) {
            check_same_light(&turned, axes, engines[i]);
        }
        fclose(file);
    }
}

static const test_case cases[] = {{"every turn", test_every_turn}, {"tables of docs/sampling.md", test_tables}};
TEST_MAIN(cases)
