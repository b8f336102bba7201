#include "scene/environment_description.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/environment.h>
#include <lambent/vector.h>

#include "base/hex_digit.h"
#include "scene/daylight.h"
#include "scene/environment_sky_basis.h"

#define DAYLIGHT "preetham:"

enum { ROTATION, STRENGTH, SET, TURBIDITY, SUN, GROUND, TIME, LATITUDE, DAY, OPTIONS };

/* From DAYLIGHT_FIRST on they are daylight's. */
enum { DAYLIGHT_FIRST = TURBIDITY };

static const struct {
    const char *name; /* lower-case letters and = */
    double least, most;
    const char *what;
} OPTION[OPTIONS] = {
    [ROTATION] = {"rotation=", -1e30, 1e30, "angle in degrees"},
    [STRENGTH] = {"strength=", 0.0, 1e30, "number from 0 up"},
    [SET] = {"set=", 0.0, 0.0, "name of a set of lights"},
    [TURBIDITY] = {"turbidity=", LMB_TURBIDITY_LEAST, LMB_TURBIDITY_MOST, "turbidity from 2 to 10"},
    [SUN] = {"sun=", -1e6, 1e6, "azimuth/elevation in degrees, the second from -90 to 90"},
    [GROUND] = {"ground=", 0.0, 1.0, "albedo from 0 to 1"},
    [TIME] = {"time=", 0.0, 24.0, "solar time from 0 to 24 hours"},
    [LATITUDE] = {"latitude=", -90.0, 90.0, "latitude from -90 to 90 degrees"},
    [DAY] = {"day=", 1.0, 366.0, "day of the year from 1 to 366"},
};

typedef struct option_values {
    double value[OPTIONS];
    double elevation_deg;         /* second number of sun= */
    char set[LMB_LIGHT_SET_NAME]; /* of set= */
    unsigned seen;                /* a bit for each option met so far */
    bool daylight;
} option_values;

static bool seen(const option_values *values, int option)
{
    return (values->seen >> option & 1U) != 0;
}

/* The number that text begins with, up to `end`, which must be there. */
static bool number_parse(const char *text, char end, double *value)
{
    char *stop = NULL;
    const char *const until = strchr(text, end);
    if (!until || until == text || strspn(text, "+-.0123456789eE") != (size_t)(until - text)) {
        return false; /* strtod would take hexadecimal, infinity and leading blanks */
    }
    *value = strtod(text, &stop);
    return stop == until && isfinite(*value);
}

static bool value_parse(const char *text, int option, option_values *values)
{
    double *value = &values->value[option];
    if (option == SET) {
        const bool fits = strlen(text) > 0 && strlen(text) < sizeof values->set;
        strcpy(values->set, fits ? text : "");
        return fits;
    }
    bool good = number_parse(text, option == SUN ? '/' : '\0', value);
    if (good && option == SUN) {
        good = number_parse(strchr(text, '/') + 1, '\0', &values->elevation_deg) && fabs(values->elevation_deg) <= 90.0;
    }
    return good && *value >= OPTION[option].least && *value <= OPTION[option].most;
}

/* Takes "name=value", which is NUL-terminated. */
static lmb_result option_parse(const char *text, option_values *values, lmb_error *error)
{
    const int count = values->daylight ? OPTIONS : DAYLIGHT_FIRST;
    int option = 0;
    while (option < count && strncmp(text, OPTION[option].name, strlen(OPTION[option].name)) != 0) {
        ++option;
    }
    if (option == count) {
        return lmb_error_set(error, LMB_ERROR_FORMAT,
                             "environment: unknown option '%s' (%srotation=, strength= or set=)", text,
                             values->daylight ? "turbidity=, sun=, time=, latitude=, day=, ground=, " : "");
    }
    if (seen(values, option)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: option '%s' comes twice", text);
    }
    values->seen |= 1U << option;
    return value_parse(text + strlen(OPTION[option].name), option, values)
               ? LMB_OK
               : lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' is no %s", text, OPTION[option].what);
}

/* The last ",name=value" of the text, or NULL. Only lower-case names count, so that most paths may have commas. */
static char *option_find_last(char *text)
{
    char *const comma = strrchr(text, ',');
    if (!comma) {
        return NULL;
    }
    const size_t name_length = strspn(comma + 1, "abcdefghijklmnopqrstuvwxyz");
    return name_length > 0 && comma[1 + name_length] == '=' ? comma : NULL;
}

static lmb_result options_parse(char *text, option_values *values, lmb_error *error)
{
    lmb_result result = LMB_OK;
    for (char *option = option_find_last(text); option && result == LMB_OK; option = option_find_last(text)) {
        *option = '\0';
        result = option_parse(option + 1, values, error);
    }
    return result;
}

/* `text` is what was left before the first option that has a name. */
static lmb_result daylight_finish(const char *text, const option_values *values, lmb_environment_description *described,
                                  lmb_error *error)
{
    const bool by_time = seen(values, TIME) && seen(values, LATITUDE);
    const bool part_of_time = seen(values, TIME) || seen(values, LATITUDE) || seen(values, DAY);
    if (strlen(text) >= sizeof DAYLIGHT) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' is no option of daylight (name=value)",
                             text + strlen(DAYLIGHT));
    }
    if (seen(values, SUN) ? part_of_time : !by_time) {
        return lmb_error_set(error, LMB_ERROR_FORMAT,
                             "environment: daylight takes either sun=azimuth/elevation or time= and latitude=");
    }
    described->turbidity = seen(values, TURBIDITY) ? values->value[TURBIDITY] : 3.0;
    described->ground = seen(values, GROUND) ? values->value[GROUND] : 0.2;
    if (by_time) {
        const double midsummer = 172.0;
        lmb_sun_direction_at(values->value[TIME], values->value[LATITUDE],
                             seen(values, DAY) ? values->value[DAY] : midsummer, described->to_sun);
    } else {
        lmb_sun_direction(fmod(values->value[SUN], 360.0), values->elevation_deg, described->to_sun);
    }
    free(described->source);
    described->source = NULL;
    return LMB_OK;
}

static bool colour_is_good(const char *text)
{
    bool good = strlen(text) == 7;
    for (int i = 1; i < 7 && good; ++i) {
        good = lmb_hex_digit(text[i]) >= 0;
    }
    return good;
}

static lmb_result picture_finish(const char *text, const lmb_environment_description *described, lmb_error *error)
{
    if (described->source[0] == '\0') {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' names no picture or colour", text);
    }
    if (described->source[0] == '#' && !colour_is_good(described->source)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' is not #rrggbb", described->source);
    }
    if (strncmp(described->source, LMB_SKY_BASIS, strlen(LMB_SKY_BASIS)) == 0 &&
        lmb_sky_basis_find(described->source) < 0) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "environment: '%s' is not sky-basis:0 to sky-basis:8",
                             described->source);
    }
    return LMB_OK;
}

lmb_result lmb_environment_describe(const char *text, lmb_environment_description *described, lmb_error *error)
{
    option_values values = {.value = {[STRENGTH] = 1.0}, .daylight = strncmp(text, DAYLIGHT, strlen(DAYLIGHT)) == 0};
    *described = (lmb_environment_description){.source = malloc(strlen(text) + 1)};
    if (!described->source) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "environment: no memory");
    }
    strcpy(described->source, text);
    if (values.daylight) {
        described->source[strlen(DAYLIGHT) - 1] = ','; /* before the first option, as before the others */
    }
    lmb_result result = options_parse(described->source, &values, error);
    described->rotation_rad = (float)(fmod(values.value[ROTATION], 360.0) * (LMB_PI / 180.0) + 0.0);
    described->strength = (float)values.value[STRENGTH];
    memcpy(described->set, values.set, sizeof values.set);
    if (result == LMB_OK) {
        result = values.daylight ? daylight_finish(described->source, &values, described, error)
                                 : picture_finish(text, described, error);
    }
    if (result != LMB_OK) {
        lmb_environment_description_free(described);
    }
    return result;
}

void lmb_environment_description_free(lmb_environment_description *described)
{
    free(described->source);
    described->source = NULL;
}

lmb_result lmb_environment_check(const char *text, lmb_error *error)
{
    lmb_environment_description described;
    const lmb_result result = lmb_environment_describe(text, &described, error);
    if (result == LMB_OK) {
        lmb_environment_description_free(&described);
    }
    return result;
}
