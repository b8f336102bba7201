#include <stdio.h>
#include <string.h>

#include <lambent/occlusion.h>
#include <lambent/volume.h>

#include "command.h"
#include "query.h"

static const char usage[] =
    "usage: lambent sample FILE.lmb --at X,Y,Z [options]\n"
    "\n"
    "Looks up the light at a point of a baked volume, as a game does.\n"
    "\n" QUERY_USAGE "  --visibility V        ambient occlusion, cosine-weighted, in [0, 1]\n"
    "  --cone-cos C          the same as the cosine of a visibility cone's half angle (0: the hemisphere)\n"
    "  --model hhd|hlsh|sh3  lighting model of the irradiance (default hhd; sh3 takes no occlusion)\n"
    "  --json                one JSON object a line\n";

static int answer_print(const lmb_query *query, lmb_light_model model, const lmb_volume *volume, bool json)
{
    lmb_sh3_rgb radiance;
    const bool inside = lmb_volume_sample_at(volume, query->place, &radiance);
    const lmb_rgb irradiance = query->has_normal ? query_irradiance(query, model, &radiance) : (lmb_rgb){{0}};
    if (json) {
        cJSON *object = cJSON_CreateObject();
        cJSON_AddItemToObject(object, "position", json_place(query->place));
        if (query->has_normal) {
            cJSON_AddItemToObject(object, "normal", json_vector(query->normal));
            cJSON_AddItemToObject(object, "irradiance", json_rgb(irradiance));
        }
        cJSON_AddItemToObject(object, "sh3", json_sh3(&radiance));
        cJSON_AddBoolToObject(object, "outside", !inside);
        return json_print_line(object);
    }
    printf("%.9g %.9g %.9g%s", query->place.x, query->place.y, query->place.z, inside ? "" : " (outside)");
    if (query->has_normal) {
        printf("  irradiance %.6g %.6g %.6g", (double)irradiance.c[0], (double)irradiance.c[1],
               (double)irradiance.c[2]);
    }
    const float mean_scale = 0.28209479f; /* 1/(2 sqrt(pi)): l0 to mean radiance */
    printf("  mean radiance %.6g %.6g %.6g\n", (double)(radiance.channel[0].c[0] * mean_scale),
           (double)(radiance.channel[1].c[0] * mean_scale), (double)(radiance.channel[2].c[0] * mean_scale));
    return EXIT_DONE;
}

static lmb_light_model model_of_name(lmb_arguments *arguments, const char *name)
{
    if (strcmp(name, "hlsh") == 0) {
        return MODEL_HLSH;
    }
    if (strcmp(name, "sh3") == 0) {
        return MODEL_SH3;
    }
    if (strcmp(name, "hhd") != 0) {
        arguments_error(arguments, "--model takes hhd, hlsh or sh3, not", name);
    }
    return MODEL_HHD;
}

int command_sample(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "sample", usage);
    lmb_query_arguments query_arguments = {0};
    const char *path = NULL;
    lmb_light_model model = MODEL_HHD;
    bool json = false;
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (query_argument(&query_arguments, &arguments, argument)) {
            continue;
        }
        if (strcmp(argument, "--visibility") == 0) {
            const float visibility = (float)arguments_number(&arguments, argument, 0.0, 1.0);
            query_arguments.one.cone_cos = lmb_cone_cos_from_visibility(visibility);
        } else if (strcmp(argument, "--cone-cos") == 0) {
            query_arguments.one.cone_cos = (float)arguments_number(&arguments, argument, 0.0, 1.0);
        } else if (strcmp(argument, "--model") == 0) {
            model = model_of_name(&arguments, arguments_text(&arguments, argument));
        } else if (strcmp(argument, "--json") == 0) {
            json = true;
        } else if (argument[0] != '-' && !path) {
            path = argument;
        } else {
            arguments_error(&arguments, "unexpected argument", argument);
        }
    }
    if (arguments.failed || arguments.help) {
        return arguments_status(&arguments);
    }
    if (!path) {
        arguments_error(&arguments, "missing argument", "FILE.lmb");
    }
    if (arguments.failed || !query_finish(&query_arguments, &arguments)) {
        return EXIT_USAGE;
    }

    lmb_volume *volume;
    const lmb_result result = lmb_volume_open_file(path, &volume);
    if (result != LMB_OK) {
        lmb_error error;
        lmb_error_set(&error, result, "%s: %s", path, lmb_result_text(result));
        return command_fail(result, &error);
    }
    lmb_query query = query_arguments.one;
    int line = 0;
    int more = query_arguments.has_position ? 1 : query_read_line(&query, &line);
    int status = EXIT_DONE;
    while (more == 1) {
        status = answer_print(&query, model, volume, json);
        if (status != EXIT_DONE || ferror(stdout)) {
            break;
        }
        more = query_arguments.has_position ? 0 : query_read_line(&query, &line);
    }
    lmb_volume_close(volume);
    return more < 0 ? EXIT_BAD_INPUT : status;
}
