/* Writes the network of the fitted multiply as a shader: lambent_multiply_shader sampler/shader/lambent_networks.glsl
 *
 * The same numbers as in sampler/multiply_weights.h, units four by four. */
#include <stdio.h>

#include "multiply_weights.h"

enum { FOUR = 4 };

static void four_write(FILE *file, const float *value)
{
    fprintf(file, "vec4(%.8e, %.8e, %.8e, %.8e)", (double)value[0], (double)value[1], (double)value[2],
            (double)value[3]);
}

/* name0, name1, name2 += x * row, of twelve units. */
static void row_add(FILE *file, const char *name, const char *x, const float row[LMB_MULTIPLY_FIRST])
{
    for (int i = 0; i < LMB_MULTIPLY_FIRST / FOUR; ++i) {
        fprintf(file, "    %s%d += %s * ", name, i, x);
        four_write(file, &row[FOUR * i]);
        fprintf(file, ";\n");
    }
}

static void rows_start(FILE *file, const char *name, const float row[LMB_MULTIPLY_FIRST])
{
    for (int i = 0; i < LMB_MULTIPLY_FIRST / FOUR; ++i) {
        fprintf(file, "    vec4 %s%d = ", name, i);
        four_write(file, &row[FOUR * i]);
        fprintf(file, ";\n");
    }
}

static void rows_rectify(FILE *file, const char *name)
{
    for (int i = 0; i < LMB_MULTIPLY_FIRST / FOUR; ++i) {
        fprintf(file, "    %s%d = max(%s%d, vec4(0.0, 0.0, 0.0, 0.0));\n", name, i, name, i);
    }
}

static void unit_name(char text[16], const char *name, int unit)
{
    snprintf(text, 16, "%s%d.%c", name, unit / FOUR, "xyzw"[unit % FOUR]);
}

static void network_write(FILE *file, const char *name, const lmb_multiply_network *network)
{
    fprintf(file,
            "\nLmbCorrection %s(vec4 low, vec4 high, float c)\n"
            "{\n",
            name);
    char text[16];
    rows_start(file, "a", network->first);
    row_add(file, "a", "c", network->cone);
    for (int i = 0; i < LMB_MULTIPLY_INVARIANTS; ++i) {
        snprintf(text, sizeof text, "%s.%c", i < FOUR ? "low" : "high", "xyzw"[i % FOUR]);
        row_add(file, "a", text, network->invariant[i]);
    }
    rows_rectify(file, "a");
    rows_start(file, "b", network->second);
    for (int i = 0; i < LMB_MULTIPLY_FIRST; ++i) {
        unit_name(text, "a", i);
        row_add(file, "b", text, network->first_weight[i]);
    }
    rows_rectify(file, "b");
    fprintf(file, "    LmbCorrection k;\n    k.output_ = ");
    four_write(file, network->output);
    fprintf(file, ";\n");
    for (int i = 0; i < LMB_MULTIPLY_SECOND; ++i) {
        unit_name(text, "b", i);
        fprintf(file, "    k.output_ += %s * ", text);
        four_write(file, network->second_weight[i]);
        fprintf(file, ";\n");
    }
    fprintf(file, "    k.qv = %.8e", (double)network->qv);
    for (int i = 0; i < LMB_MULTIPLY_SECOND / FOUR; ++i) {
        fprintf(file, " + dot(b%d, ", i);
        four_write(file, &network->qv_weight[FOUR * i]);
        fprintf(file, ")");
    }
    fprintf(file, ";\n    return k;\n}\n");
}

int main(int argc, char **argv)
{
    FILE *file = argc == 2 ? fopen(argv[1], "w") : NULL;
    if (!file) {
        fprintf(stderr,
                argc == 2 ? "lambent_multiply_shader: %s: cannot be written\n"
                          : "usage: lambent_multiply_shader FILE\n",
                argc == 2 ? argv[1] : "");
        return argc == 2 ? 1 : 2;
    }
    fprintf(file,
            "// The networks of the fitted multiply, for lambent_probe.glsl; written by tools/multiply_shader.c.\n"
            "#ifndef LAMBENT_NETWORKS_GLSL\n"
            "#define LAMBENT_NETWORKS_GLSL\n"
            "\n"
            "// Squares of bands 1 and 2 over l0 at which the network counts half.\n"
            "#define LMB_MULTIPLY_EVEN_SQUARE %.8e\n"
            "\n"
            "// Corrections of b_c and b.n, factors of v and q; and of Q v.\n"
            "struct LmbCorrection {\n"
            "    vec4 output_;\n"
            "    float qv;\n"
            "};\n",
            (double)LMB_MULTIPLY_EVEN_SQUARE);
    network_write(file, "lmbNetworkOpened", &lmb_multiply_opened);
    network_write(file, "lmbNetworkClosing", &lmb_multiply_closing);
    fprintf(file, "\n#endif\n");
    const int failed = ferror(file);
    return fclose(file) != 0 || failed ? 1 : 0;
}
