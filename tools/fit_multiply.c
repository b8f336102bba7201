/* Fits the hemisphere multiply (lmb_moments_from_probe) to procedural skies and writes its weights:
 *
 *     lambent_fit_multiply sampler/multiply_weights.h
 *
 * Everything is said here: what is fitted to (fit_skies.h), the seeds, the sizes. The same machine writes the same file
 * again. Takes a few minutes of one core. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fit_network.h"

enum { SEED_OPEN = 1, SEED_CONES = 2, SEED_VALIDATION = 777, EXAMPLES = 400000, VALIDATION_EXAMPLES = 40000 };

static const fit_settings settings = {.seed = 5, .steps = 14000, .batch = 4096};

static void row_write(FILE *file, const fit_network *network, int layer, int from, int to_count)
{
    fprintf(file, "{");
    for (int to = 0; to < to_count; ++to) {
        fprintf(file, "%s%.8ef", to > 0 ? ", " : "", (double)network->weight[layer][to][from]);
    }
    fprintf(file, "}");
}

/* Rows of the units that follow from one input, as the sampler adds them up. */
static void matrix_write(FILE *file, const char *name, const fit_network *network, int layer, int from_count,
                         int to_count)
{
    fprintf(file, "    .%s =\n        {\n", name);
    for (int from = 0; from < from_count; ++from) {
        fprintf(file, "            ");
        row_write(file, network, layer, from, to_count);
        fprintf(file, ",\n");
    }
    fprintf(file, "        },\n");
}

static void start_write(FILE *file, const char *name, const fit_network *network, int layer, int from, int to_count)
{
    fprintf(file, "    .%s = ", name);
    row_write(file, network, layer, from, to_count);
    fprintf(file, ",\n");
}

static void network_write(FILE *file, const char *name, const fit_network *network)
{
    fprintf(file, "\nstatic const lmb_multiply_network %s = {\n", name);
    matrix_write(file, "invariant", network, 0, FIT_INVARIANTS, FIT_FIRST);
    start_write(file, "cone", network, 0, FIT_INVARIANTS, FIT_FIRST);
    start_write(file, "first", network, 0, FIT_INPUTS, FIT_FIRST);
    matrix_write(file, "first_weight", network, 1, FIT_FIRST, FIT_SECOND);
    start_write(file, "second", network, 1, FIT_FIRST, FIT_SECOND);
    matrix_write(file, "second_weight", network, 2, FIT_SECOND, FIT_QV);
    start_write(file, "output", network, 2, FIT_SECOND, FIT_QV);
    fprintf(file, "    .qv_weight = {");
    for (int from = 0; from < FIT_SECOND; ++from) {
        fprintf(file, "%s%.8ef", from > 0 ? ", " : "", (double)network->weight[2][FIT_QV][from]);
    }
    fprintf(file, "},\n    .qv = %.8ef,\n};\n", (double)network->weight[2][FIT_QV][FIT_SECOND]);
}

/* Makes examples count by how much better than Gram they can be: errors of skies of which Gram is nearly right are
 * small, and would give way to those of suns, for which it is far off. Walls leave least to guess, and should be left
 * least. */
static void weigh_by_gram(fit_example *examples, size_t count)
{
    static const float context_weight[FIT_CONTEXTS] = {1.0f, 1.5f, 3.0f};
    const fit_rule gram = {NULL, NULL};
    for (size_t i = 0; i < count; i += FIT_TURNS) {
        float error = 0.08f * 0.08f; /* somewhat more than a closed form has from true moments */
        for (size_t t = 0; t < FIT_TURNS; ++t) {
            error += fit_error(&gram, &examples[i + t]) / FIT_TURNS;
        }
        for (size_t t = 0; t < FIT_TURNS; ++t) {
            examples[i + t].weight *= context_weight[examples[i + t].context] / error;
        }
    }
}

static bool header_write(const char *path, const fit_network *opened, const fit_network *closing)
{
    FILE *file = fopen(path, "w");
    if (!file) {
        return false;
    }
    fprintf(
        file,
        "/* The numbers of lmb_moments_from_probe (docs/maths.md), written by tools/fit_multiply.c. */\n"
        "#ifndef LMB_MULTIPLY_WEIGHTS_H\n"
        "#define LMB_MULTIPLY_WEIGHTS_H\n"
        "\n"
        "/* Squares of bands 1 and 2 over l0 at which the network counts half. */\n"
        "#define LMB_MULTIPLY_EVEN_SQUARE %.8ef\n"
        "\n"
        "enum {\n    LMB_MULTIPLY_INVARIANTS = %d,\n    LMB_MULTIPLY_FIRST = %d,\n    LMB_MULTIPLY_SECOND = %d,\n  "
        "  LMB_MULTIPLY_OUTPUTS = %d\n};\n"
        "\n"
        "/* Two layers of rectified units, then plain sums: a row of weights for each number that a layer takes, and\n"
        " * what its sums start from. Outputs are the corrections of b_c and b.n and the factors of v and q; apart, as "
        "a\n"
        " * column, that of Q v. */\n"
        "typedef struct lmb_multiply_network {\n"
        "    float invariant[LMB_MULTIPLY_INVARIANTS][LMB_MULTIPLY_FIRST];\n"
        "    float cone[LMB_MULTIPLY_FIRST]; /* of the cone's cosine */\n"
        "    float first[LMB_MULTIPLY_FIRST];\n"
        "    float first_weight[LMB_MULTIPLY_FIRST][LMB_MULTIPLY_SECOND];\n"
        "    float second[LMB_MULTIPLY_SECOND];\n"
        "    float second_weight[LMB_MULTIPLY_SECOND][LMB_MULTIPLY_OUTPUTS];\n"
        "    float output[LMB_MULTIPLY_OUTPUTS];\n"
        "    float qv_weight[LMB_MULTIPLY_SECOND];\n"
        "    float qv;\n"
        "} lmb_multiply_network;\n"
        "\n"
        "/* clang-format off */\n",
        (double)FIT_EVEN_SQUARE, FIT_INVARIANTS, FIT_FIRST, FIT_SECOND, FIT_QV);
    network_write(file, "lmb_multiply_opened", opened);
    network_write(file, "lmb_multiply_closing", closing);
    fprintf(file, "\n/* clang-format on */\n\n#endif\n");
    const bool good = ferror(file) == 0;
    return fclose(file) == 0 && good;
}

/* Errors of Gram and of the rule, by context, over examples that nothing was fitted to. */
static void validate(const fit_rule *rule, bool cones, fit_example *examples)
{
    static const char *const context_name[FIT_CONTEXTS] = {"open", "wall", "two-toned wall"};
    const fit_rule gram = {NULL, NULL};
    double before[FIT_CONTEXTS] = {0.0}, after[FIT_CONTEXTS] = {0.0};
    fit_examples_make(SEED_VALIDATION, cones, VALIDATION_EXAMPLES, examples);
    weigh_by_gram(examples, VALIDATION_EXAMPLES);
    for (int i = 0; i < VALIDATION_EXAMPLES; ++i) {
        before[examples[i].context] += (double)fit_error(&gram, &examples[i]);
        after[examples[i].context] += (double)fit_error(rule, &examples[i]);
    }
    for (int c = 0; c < FIT_CONTEXTS; ++c) {
        printf("%s, %s: %.3f of Gram's error\n", cones ? "cones" : "hemisphere", context_name[c],
               sqrt(after[c] / before[c]));
    }
}

int main(int argc, char **argv)
{
    fit_example *examples = malloc(EXAMPLES * sizeof *examples);
    if (argc != 2 || !examples) {
        fprintf(stderr, argc != 2 ? "usage: lambent_fit_multiply FILE\n" : "lambent_fit_multiply: out of memory\n");
        free(examples);
        return argc != 2 ? 2 : 1;
    }
    static fit_network opened, closing;
    fit_examples_make(SEED_OPEN, false, EXAMPLES, examples);
    weigh_by_gram(examples, EXAMPLES);
    fit_network_fit(&settings, examples, EXAMPLES, NULL, &opened);
    fit_examples_make(SEED_CONES, true, EXAMPLES, examples);
    weigh_by_gram(examples, EXAMPLES);
    fit_network_fit(&settings, examples, EXAMPLES, &opened, &closing);
    const fit_rule rule = {&opened, &closing};
    validate(&rule, false, examples);
    validate(&rule, true, examples);
    free(examples);
    if (!header_write(argv[1], &opened, &closing)) {
        fprintf(stderr, "lambent_fit_multiply: %s: cannot be written\n", argv[1]);
        return 1;
    }
    return 0;
}
