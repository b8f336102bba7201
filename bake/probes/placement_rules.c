#include "probes/placement_rules.h"

/* A box in which rules differ is halved along each axis so many times; what is left then goes by any of them. */
enum { HALVINGS = 3 };

typedef enum rule_question { RULE_FORCES, RULE_ALLOWS } rule_question;

typedef struct rules_work {
    const lmb_level_rules *rules;
    uint32_t level;
    rule_question question;
} rules_work;

/* Of a box of the scene, or of what is in none: -1. */
static bool rule_says(const rules_work *work, int32_t box)
{
    const lmb_scene *scene = work->rules->scene;
    if (box >= 0 && scene->probe_boxes[box].exclude) {
        return false;
    }
    const lmb_level_rule *rule = &work->rules->rule[box >= 0 ? (uint32_t)box : scene->probe_box_count];
    return (work->question == RULE_FORCES ? rule->coarsest : rule->finest) < work->level;
}

/* What all boxes say that are not beneath another one, and whether they are of one mind. */
static bool rules_agree(const rules_work *work, const double low[3], const double high[3], bool *answer)
{
    const lmb_scene *scene = work->rules->scene;
    int32_t top = -1;
    bool says[2] = {false, false};
    for (uint32_t i = 0; i < scene->probe_box_count; ++i) {
        const lmb_probe_box *const box = &scene->probe_boxes[i];
        if (lmb_probe_box_touches(box, low, high)) {
            says[rule_says(work, (int32_t)i)] = true;
            top = top < 0 || box->priority >= scene->probe_boxes[top].priority ? (int32_t)i : top;
        }
    }
    if (top < 0 || lmb_probe_box_holds(&scene->probe_boxes[top], low, high)) {
        *answer = rule_says(work, top);
        return true;
    }
    says[rule_says(work, -1)] = true;
    *answer = says[true];
    return !(says[false] && says[true]);
}

static bool rules_say(const rules_work *work, const double low[3], const double high[3], int halvings)
{
    bool answer;
    if (rules_agree(work, low, high, &answer) || halvings == 0) {
        return answer;
    }
    bool any = false;
    for (int part = 0; part < 8 && !any; ++part) {
        double from[3], to[3];
        for (int axis = 0; axis < 3; ++axis) {
            const double middle = 0.5 * (low[axis] + high[axis]);
            from[axis] = part >> axis & 1 ? middle : low[axis];
            to[axis] = part >> axis & 1 ? high[axis] : middle;
        }
        any = rules_say(work, from, to, halvings - 1);
    }
    return any;
}

bool lmb_rules_force(const lmb_level_rules *rules, const double low[3], const double high[3], uint32_t level)
{
    const rules_work work = {rules, level, RULE_FORCES};
    return rules->rule && rules_say(&work, low, high, HALVINGS);
}

bool lmb_rules_allow(const lmb_level_rules *rules, const double low[3], const double high[3], uint32_t level)
{
    const rules_work work = {rules, level, RULE_ALLOWS};
    return !rules->rule || rules_say(&work, low, high, HALVINGS);
}

double lmb_rules_tolerance(const lmb_level_rules *rules, lmb_vec3 position)
{
    if (!rules->rule) {
        return rules->tolerance;
    }
    const int32_t box = lmb_scene_probe_box(rules->scene, position);
    return rules->rule[box >= 0 ? (uint32_t)box : rules->scene->probe_box_count].tolerance;
}
