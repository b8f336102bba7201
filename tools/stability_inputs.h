/* Inputs that lighting models are tried with: what levels have, what breaks arithmetic, and the hard cases by name. */
#ifndef LMB_TOOLS_STABILITY_INPUTS_H
#define LMB_TOOLS_STABILITY_INPUTS_H

#include <stdint.h>

#include "stability_run.h"

/* Number `index`: the hard cases first, over and over with other directions, in turn with random light. The name of its
 * kind. */
const char *stability_input_make(uint64_t index, stability_input *input);

/* The largest coefficient's size: what light is measured by. */
double stability_input_size(const stability_input *input);

#endif
