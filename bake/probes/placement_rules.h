/* Rules of levels: which ones the scene's boxes of probes ask for, and allow, where. */
#ifndef LMB_PLACEMENT_RULES_H
#define LMB_PLACEMENT_RULES_H

#include <lambent/placement.h>
#include <lambent/probe_boxes.h>

typedef struct lmb_level_rules {
    const lmb_scene *scene;
    const lmb_level_rule *rule; /* as lmb_levels_settings has it; NULL: no rule */
    double tolerance;           /* where there is no rule */
} lmb_level_rules;

/* Whether rules want a level finer than this one somewhere in a box along the axes of the scene. */
bool lmb_rules_force(const lmb_level_rules *rules, const double low[3], const double high[3], uint32_t level);

/* Whether rules allow a level finer than this one somewhere in it. */
bool lmb_rules_allow(const lmb_level_rules *rules, const double low[3], const double high[3], uint32_t level);

/* The tolerance at a position of the scene. */
double lmb_rules_tolerance(const lmb_level_rules *rules, lmb_vec3 position);

#endif
