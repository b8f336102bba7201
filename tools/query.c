#include "query.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool query_argument(lmb_query_arguments *query, lmb_arguments *arguments, const char *option)
{
    if (strcmp(option, "--at") == 0) {
        query->one.position = arguments_position(arguments, option);
        query->has_position = true;
    } else if (strcmp(option, "--normal") == 0) {
        query->one.normal = arguments_vector(arguments, option);
        query->one.has_normal = true;
    } else if (strcmp(option, "--vertex-normal") == 0) {
        query->one.vertex_normal = arguments_vector(arguments, option);
        query->has_vertex_normal = true;
    } else {
        return false;
    }
    return true;
}

static bool unit_make(lmb_vec3 *v)
{
    const double x = (double)v->x, y = (double)v->y, z = (double)v->z;
    const double length = sqrt(x * x + y * y + z * z);
    if (!(length > 0.0) || !isfinite(length)) {
        return false;
    }
    *v = (lmb_vec3){(float)(x / length), (float)(y / length), (float)(z / length)};
    return true;
}

bool query_finish(lmb_query_arguments *query, lmb_arguments *arguments)
{
    if (query->has_vertex_normal && !query->one.has_normal) {
        arguments_error(arguments, "--normal must go with", "--vertex-normal");
        return false;
    }
    if (!query->has_vertex_normal) {
        query->one.vertex_normal = query->one.normal;
    }
    if (query->one.has_normal && (!unit_make(&query->one.normal) || !unit_make(&query->one.vertex_normal))) {
        arguments_error(arguments, "a normal has no direction:", "0,0,0");
        return false;
    }
    return true;
}

static lmb_vec3 vector_of(const double value[3])
{
    return (lmb_vec3){(float)value[0], (float)value[1], (float)value[2]};
}

int query_read_line(lmb_query *query, int *line_number)
{
    char line[512];
    const float cone_cos = query->cone_cos;
    do {
        if (!fgets(line, sizeof line, stdin)) {
            return 0;
        }
        ++*line_number;
    } while (line[strspn(line, " \t\r\n")] == '\0' || line[0] == '#');
    double value[10];
    int count = 0;
    const char *at = line;
    for (char *end; count < 10; at = end, ++count) {
        value[count] = strtod(at, &end);
        if (end == at) {
            break;
        }
    }
    const bool whole = at[strspn(at, " \t\r\n")] == '\0';
    *query = (lmb_query){.position = {value[0], value[1], value[2]}, .cone_cos = cone_cos};
    query->has_normal = count >= 6;
    bool good = whole && (count == 3 || count == 6 || count == 7 || count == 10);
    if (good && query->has_normal) {
        query->normal = vector_of(&value[3]);
        query->vertex_normal = count == 10 ? vector_of(&value[7]) : query->normal;
        query->cone_cos = count >= 7 ? (float)value[6] : cone_cos;
        good = unit_make(&query->normal) && unit_make(&query->vertex_normal);
    }
    if (!good) {
        fprintf(stderr, "lambent: standard input:%d: not 'x y z [nx ny nz [cone_cos [vx vy vz]]]'\n", *line_number);
        return -1;
    }
    return 1;
}

lmb_rgb query_irradiance(const lmb_query *query, const lmb_model *model, const lmb_query_light *light)
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    lmb_rgb irradiance;
    model->encode(&light->rest, query->vertex_normal, query->cone_cos, channel);
    model->evaluate(channel, query->vertex_normal, &query->normal, 1, &irradiance);
    return key_lights_add(&light->keys, query->vertex_normal, query->normal, irradiance);
}

cJSON *json_vector(lmb_vec3 vector)
{
    return cJSON_CreateFloatArray((const float[3]){vector.x, vector.y, vector.z}, 3);
}

cJSON *json_position(lmb_vec3d position)
{
    return cJSON_CreateDoubleArray((const double[3]){position.x, position.y, position.z}, 3);
}

cJSON *json_rgb(lmb_rgb colour)
{
    return cJSON_CreateFloatArray(colour.c, 3);
}

/* 9 lists of RGB. */
static cJSON *json_sh3(const lmb_sh3_rgb *radiance)
{
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        const lmb_rgb colour = {{radiance->channel[0].c[i], radiance->channel[1].c[i], radiance->channel[2].c[i]}};
        cJSON_AddItemToArray(list, json_rgb(colour));
    }
    return list;
}

cJSON *json_key_light(const lmb_key_light *light)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddItemToObject(object, "direction", json_vector(light->direction));
    cJSON_AddItemToObject(object, "irradiance", json_rgb(light->irradiance));
    return object;
}

void json_add_light(cJSON *object, const lmb_query_light *light)
{
    const lmb_sh3_rgb whole = key_lights_add_sh3(&light->keys, &light->rest);
    cJSON_AddItemToObject(object, "sh3", json_sh3(&whole));
    cJSON_AddItemToObject(object, "sh3_rest", json_sh3(&light->rest));
    cJSON *list = cJSON_AddArrayToObject(object, "key_lights");
    for (uint32_t i = 0; i < light->keys.count; ++i) {
        cJSON *key = json_key_light(&light->keys.light[i]);
        cJSON_AddNumberToObject(key, "visibility", (double)light->keys.visibility[i]);
        cJSON_AddItemToArray(list, key);
    }
}

int json_print_line(cJSON *object)
{
    char *text = cJSON_PrintUnformatted(object);
    cJSON_Delete(object);
    lmb_error error = {{0}};
    if (!text) {
        return command_fail(LMB_ERROR_MEMORY, &error);
    }
    puts(text);
    cJSON_free(text);
    return EXIT_DONE;
}
