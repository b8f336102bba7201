/* Limits on what a check measures, for builds that shall fail when a bake gets worse: `--fail-above`. */
#ifndef LMB_TOOLS_CHECK_LIMITS_H
#define LMB_TOOLS_CHECK_LIMITS_H

#include "check.h"
#include "command.h"

enum { CHECK_MAX_LIMITS = 64, FIGURE_NAME_SIZE = 64 };

typedef struct check_limit {
    char name[FIGURE_NAME_SIZE]; /* of a figure in the JSON: "leak", "probe_vs_reference.p95"; a pair alone is its
                                    rel_rmse */
    double value;
} check_limit;

typedef struct check_limits {
    check_limit limit[CHECK_MAX_LIMITS];
    int count;
} check_limits;

/* Reads the option's value, NAME=VALUE[,NAME=VALUE...], and what follows it of that kind. An unknown name is a usage
 * error. */
void check_limits_read(check_limits *limits, lmb_arguments *arguments, const char *option);

/* Whether all figures can be had of a bake. @return LMB_ERROR_UNSUPPORTED: one needs lightmaps */
lmb_result check_limits_apply(const check_limits *limits, bool has_lightmap, lmb_error *error);

/* Whether all figures are within their limits; says which are not on standard error. A figure without a value is not.
 */
bool check_limits_hold(const check_limits *limits, const check_report *report);

#endif
