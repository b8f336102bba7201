/* The rule that is fitted, and its fitting: Gram's moments, and what a small network of invariants adds to them
 * (docs/maths.md). */
#ifndef LMB_TOOLS_FIT_NETWORK_H
#define LMB_TOOLS_FIT_NETWORK_H

#include "fit_solve.h"

enum {
    FIT_INVARIANTS = 8,
    FIT_INPUTS = FIT_INVARIANTS + 1,
    FIT_FIRST = 12,
    FIT_SECOND = 12,
    FIT_LAYERS = 3,
    FIT_WIDEST = FIT_FIRST
};

/* weight[layer][to][from], of which the last `from` is the bias. Inputs are the invariants, then the cone's cosine. */
typedef struct fit_network {
    float weight[FIT_LAYERS][FIT_WIDEST][FIT_WIDEST + 1];
} fit_network;

/* Units that a layer takes from and gives to. */
int fit_layer_from(int layer);
int fit_layer_to(int layer);

/* What the networks are asked. `opened` alone answers for the hemisphere; behind a cone of cosine c, `closing` adds c
 * times what it says, so that nothing jumps as a cone opens. NULL: nothing. */
typedef struct fit_rule {
    const fit_network *opened;
    const fit_network *closing;
} fit_rule;

typedef struct fit_settings {
    uint64_t seed; /* of the start and of the order */
    int steps;     /* of Adam (Kingma and Ba 2015) */
    int batch;     /* examples in each, a multiple of 16 */
} fit_settings;

/* Fits `network`, which answers alone with `opened` NULL and otherwise is `closing` beside that. */
void fit_network_fit(const fit_settings *settings, const fit_example *examples, size_t count, const fit_network *opened,
                     fit_network *network);

/* Weighted mean square error over the hemisphere of one example's irradiance. */
float fit_error(const fit_rule *rule, const fit_example *example);

#endif
