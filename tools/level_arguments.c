#include "level_arguments.h"

#include <string.h>

#include <lambent/environment.h>

/* Of lamps and emission. */
#define MIN_SCALE 1e-9
#define MAX_SCALE 1e9

static void exclude_add(lmb_level_settings *settings, lmb_arguments *arguments, const char *option)
{
    if (settings->exclude_count == LMB_LEVEL_MAX_EXCLUDE) {
        arguments_error(arguments, "too many", option);
        return;
    }
    settings->exclude[settings->exclude_count++] = arguments_text(arguments, option);
}

static const char *environment_argument(lmb_arguments *arguments, const char *option)
{
    const char *const text = arguments_text(arguments, option);
    lmb_error error = {""};
    if (!arguments->failed && lmb_environment_check(text, &error) == LMB_ERROR_FORMAT) {
        arguments_error(arguments, option, error.message);
    }
    return text;
}

bool level_argument(lmb_level_settings *settings, lmb_arguments *arguments, const char *option)
{
    if (strcmp(option, "--env") == 0) {
        settings->environment = environment_argument(arguments, option);
    } else if (strcmp(option, "--exclude") == 0) {
        exclude_add(settings, arguments, option);
    } else if (strcmp(option, "--light-scale") == 0) {
        settings->light_scale = arguments_number(arguments, option, MIN_SCALE, MAX_SCALE);
    } else if (strcmp(option, "--emission-scale") == 0) {
        settings->emission_scale = arguments_number(arguments, option, MIN_SCALE, MAX_SCALE);
    } else if (strcmp(option, "--allow-outside-uris") == 0) {
        settings->allow_outside_uris = true;
    } else if (strcmp(option, "--threads") == 0) {
        settings->threads = (int)arguments_integer(arguments, option, 1, 1024);
    } else if (strcmp(option, "--isa") == 0) {
        settings->isa = arguments_text(arguments, option);
    } else if (strcmp(option, "--bounces") == 0) {
        settings->bounces = (int)arguments_integer(arguments, option, 0, 1000000);
    } else if (strcmp(option, "--seed") == 0) {
        settings->seed = (uint64_t)arguments_integer(arguments, option, 0, INT64_MAX);
    } else if (strcmp(option, "--light-set") == 0) {
        settings->light_set = arguments_text(arguments, option);
    } else if (strcmp(option, "--key-lights") == 0) {
        settings->key_lights = (uint32_t)arguments_integer(arguments, option, 0, LMB_KEY_LIGHTS_MOST);
    } else if (strcmp(option, "--quiet") == 0) {
        arguments->quiet = true;
    } else {
        return false;
    }
    return true;
}

bool estimator_argument(lmb_estimator *estimator, lmb_arguments *arguments, const char *option)
{
    if (strcmp(option, "--estimator") != 0) {
        return false;
    }
    const char *name = arguments_text(arguments, option);
    if (!lmb_estimator_find(name, estimator)) {
        arguments_error(arguments, "--estimator takes cached or reference, not", name);
    }
    return true;
}
