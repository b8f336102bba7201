#include "check_limits.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A figure of a report. */
typedef struct figure {
    bool known;
    bool needs_lightmap;
    double value;
} figure;

/* `member`: with its dot; empty: rel_rmse. */
static double error_member(const error_summary *error, const char *member, bool *known)
{
    const struct {
        const char *name;
        double value;
    } members[] = {
        {"", error->rel_rmse},      {".rel_rmse", error->rel_rmse}, {".std_error", error->std_error},
        {".median", error->median}, {".p95", error->p95},           {".share_over_10pct", error->share_over_10pct},
        {".max", error->max},
    };
    for (size_t i = 0; i < sizeof members / sizeof members[0]; ++i) {
        if (strcmp(member, members[i].name) == 0) {
            *known = true;
            return members[i].value;
        }
    }
    *known = false;
    return 0.0;
}

static figure pair_figure(const char *name, const check_report *report)
{
    static const error_summary none;
    const size_t length = strcspn(name, ".");
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        const char *pair_name = check_pair_name((check_pair)pair);
        if (strlen(pair_name) == length && strncmp(name, pair_name, length) == 0) {
            figure found = {.needs_lightmap = check_pair_needs_lightmap((check_pair)pair)};
            found.value = error_member(report ? &report->error[pair] : &none, name + length, &found.known);
            return found;
        }
    }
    const struct {
        const char *name;
        const error_summary *error;
    } locals[] = {{"local_set_vs_reference", report ? &report->local : &none},
                  {"local_set_by_volume_vs_reference", report ? &report->local_field : &none}};
    for (size_t i = 0; i < sizeof locals / sizeof locals[0]; ++i) {
        if (strlen(locals[i].name) == length && strncmp(name, locals[i].name, length) == 0) {
            figure found = {.known = false};
            found.value = error_member(locals[i].error, name + length, &found.known);
            return found;
        }
    }
    return (figure){.known = false};
}

/* `report` NULL: only whether there is one of that name, and what it needs. */
static figure figure_find(const char *name, const check_report *report)
{
    static const check_report none;
    const check_report *from = report ? report : &none;
    const struct {
        const char *name;
        figure figure;
    } single[] = {
        {"points", {true, false, (double)from->points}},
        {"free_points", {true, false, (double)from->free_points}},
        {"reference_mean", {true, false, from->leak.reference_mean}},
        {"reference_std_error", {true, false, from->leak.reference_std_error}},
        {"coincident_std_error", {true, false, from->coincident_std_error}},
        {"leak", {true, false, from->leak.leak}},
        {"leak_points", {true, false, (double)from->leak.dark_points}},
        {"lightmap_leak", {true, true, from->lightmap_leak}},
        {"seam_step_median", {true, true, from->seam_step_median}},
        {"seam_step_p95", {true, true, from->seam_step_p95}},
    };
    for (size_t i = 0; i < sizeof single / sizeof single[0]; ++i) {
        if (strcmp(name, single[i].name) == 0) {
            return single[i].figure;
        }
    }
    return pair_figure(name, report);
}

/* One NAME=VALUE of `length` bytes. */
static void limit_read(check_limits *limits, lmb_arguments *arguments, const char *text, size_t length)
{
    char copy[128];
    snprintf(copy, sizeof copy, "%.*s", (int)length, text);
    char *const equals = strchr(copy, '=');
    if (limits->count == CHECK_MAX_LIMITS || length >= sizeof copy || !equals) {
        arguments_error(arguments, "--fail-above takes NAME=VALUE[,...], not", text);
        return;
    }
    *equals = '\0';
    check_limit *const limit = &limits->limit[limits->count];
    char *end;
    limit->value = strtod(equals + 1, &end);
    if (end == equals + 1 || *end != '\0' || !isfinite(limit->value)) {
        arguments_error(arguments, "--fail-above: not a number:", equals + 1);
    } else if (strlen(copy) >= sizeof limit->name || !figure_find(copy, NULL).known) {
        arguments_error(arguments, "--fail-above: check --json has no figure", copy);
    } else {
        memcpy(limit->name, copy, strlen(copy) + 1);
        ++limits->count;
    }
}

/* NAME=VALUE[,NAME=VALUE...] */
static void limits_read(check_limits *limits, lmb_arguments *arguments, const char *text)
{
    while (!arguments->failed) {
        const size_t length = strcspn(text, ",");
        limit_read(limits, arguments, text, length);
        if (text[length] == '\0') {
            return;
        }
        text += length + 1;
    }
}

/* Whether the next argument begins with a figure's name and "=". */
static bool next_is_limit(const lmb_arguments *arguments)
{
    char name[FIGURE_NAME_SIZE];
    const char *next = arguments->at < arguments->count ? arguments->values[arguments->at] : "";
    const size_t length = strcspn(next, "=");
    snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : 0), next);
    return next[length] == '=' && figure_find(name, NULL).known;
}

void check_limits_read(check_limits *limits, lmb_arguments *arguments, const char *option)
{
    limits_read(limits, arguments, arguments_text(arguments, option));
    while (!arguments->failed && next_is_limit(arguments)) {
        limits_read(limits, arguments, arguments->values[arguments->at++]);
    }
}

lmb_result check_limits_apply(const check_limits *limits, bool has_lightmap, lmb_error *error)
{
    for (int i = 0; i < limits->count && !has_lightmap; ++i) {
        const char *name = limits->limit[i].name;
        if (figure_find(name, NULL).needs_lightmap) {
            return lmb_error_set(error, LMB_ERROR_UNSUPPORTED,
                                 "--fail-above %s: the bake has no lightmaps; bake with --lightmaps", name);
        }
    }
    return LMB_OK;
}

bool check_limits_hold(const check_limits *limits, const check_report *report)
{
    bool hold = true;
    for (int i = 0; i < limits->count; ++i) {
        const check_limit *limit = &limits->limit[i];
        const double value = figure_find(limit->name, report).value;
        if (!(value <= limit->value)) {
            if (isnan(value)) {
                fprintf(stderr, "lambent: check: %s has no value here: no points, or no light\n", limit->name);
            } else {
                fprintf(stderr, "lambent: check: %s is %.6g, above %g\n", limit->name, value, limit->value);
            }
            hold = false;
        }
    }
    return hold;
}
