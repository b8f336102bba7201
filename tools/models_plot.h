/* Scatter plots of errors against what they cost, as SVG. */
#ifndef LMB_TOOLS_MODELS_PLOT_H
#define LMB_TOOLS_MODELS_PLOT_H

#include <stdio.h>

#include "models.h"

/* What an error is plotted against. */
typedef enum models_cost { MODELS_COST_EVAL, MODELS_COST_ENCODE, MODELS_COST_BYTES } models_cost;

/* Appends an <svg> of the rows of one input, both axes logarithmic, a point and a name for each. */
void models_plot_write(FILE *page, const models_report *report, models_input input, models_cost cost);

#endif
