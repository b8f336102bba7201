/* Asking for the light at points, as `sample` and `probe` do: one point by options, or many on standard input. */
#ifndef LMB_TOOLS_QUERY_H
#define LMB_TOOLS_QUERY_H

#include <cjson/cJSON.h>

#include <lambent/model.h>

#include "command.h"
#include "key_lights_seen.h"

typedef struct lmb_query {
    lmb_vec3d position; /* in the world */
    bool has_normal;
    lmb_vec3 normal;        /* n */
    lmb_vec3 vertex_normal; /* n_v */
    float cone_cos;         /* 0: the hemisphere */
} lmb_query;

typedef struct lmb_query_arguments {
    bool has_position; /* else standard input */
    bool has_vertex_normal;
    lmb_query one;
} lmb_query_arguments;

#define QUERY_USAGE                                                                                                    \
    "  --at X,Y,Z            the point; without it, points are read from standard input, a line each:\n"               \
    "                        x y z [nx ny nz [cone_cos [vx vy vz]]]\n"                                                 \
    "  --normal X,Y,Z        shading normal: adds the normalised irradiance there\n"                                   \
    "  --vertex-normal X,Y,Z the normal that owns the hemisphere (default: the shading normal)\n"

/* Takes --at, --normal, --vertex-normal. */
bool query_argument(lmb_query_arguments *query, lmb_arguments *arguments, const char *option);

/* Reads the next line of standard input. @return 1 read, 0 at the end, -1 for a malformed line (message printed) */
int query_read_line(lmb_query *query, int *line_number);

/* Completes the one point of the command line: units, defaults. False: usage error printed. */
bool query_finish(lmb_query_arguments *query, lmb_arguments *arguments);

/* Light at a point: harmonics, and the key lights that they leave out. */
typedef struct lmb_query_light {
    lmb_sh3_rgb rest;
    key_lights_seen keys;
} lmb_query_light;

/* Normalised irradiance of it by a lighting model. */
lmb_rgb query_irradiance(const lmb_query *query, const lmb_model *model, const lmb_query_light *light);

/* Adds `sh3`, of all of the light, `sh3_rest`, without the key lights, and `key_lights`. */
void json_add_light(cJSON *object, const lmb_query_light *light);

/* Arrays for --json output. */
cJSON *json_vector(lmb_vec3 vector);
cJSON *json_position(lmb_vec3d position);
cJSON *json_rgb(lmb_rgb colour);
/* Direction and irradiance; the caller may add to it. */
cJSON *json_key_light(const lmb_key_light *light);
/* Prints one line and frees the object. @return exit status */
int json_print_line(cJSON *object);

#endif
