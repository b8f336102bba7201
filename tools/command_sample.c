#include <stdio.h>
#include <string.h>

#include <lambent/local_set.h>
#include <lambent/model.h>
#include <lambent/occlusion.h>
#include <lambent/tile_files.h>
#include <lambent/volume.h>

#include "command.h"
#include "query.h"

static const char usage_start[] =
    "usage: lambent sample FILE.lmb --at X,Y,Z [options]\n"
    "       lambent sample FILE.lmt --at X,Y,Z [options]\n"
    "\n"
    "Looks up the light at a point of a baked volume, as a game does. Of an index of tiles, FILE.lmt, it opens those\n"
    "tiles beside it that are asked for.\n"
    "\n" QUERY_USAGE
    "  --local-set NAME      by an object's local set (lambent info lists them): beyond it, as at its border\n"
    "  --visibility V        ambient occlusion, cosine-weighted, in [0, 1]\n"
    "  --cone-cos C          the same as the cosine of a visibility cone's half angle (0: the hemisphere)\n"
    "  --model NAME          lighting model of the irradiance:\n";

/* The usage, with the models of the table. */
static const char *usage(void)
{
    static char text[4096];
    const lmb_model *taken = lmb_model_default(LMB_MODEL_FOR_SURFACE);
    size_t length = (size_t)snprintf(text, sizeof text, "%s", usage_start);
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        const lmb_model *model = lmb_model_at(i);
        if (!(model->uses & (LMB_MODEL_FOR_SURFACE | LMB_MODEL_FOR_OBJECT))) {
            continue;
        }
        length += (size_t)snprintf(text + length, sizeof text - length, "                        %-4s  %s%s\n",
                                   model->short_name, model->title, model == taken ? " (default)" : "");
    }
    snprintf(text + length, sizeof text - length, "  --json                one JSON object a line\n");
    return text;
}

/* What is asked: a volume, undivided or in tiles, or one of its local sets. */
typedef struct sampled {
    lmb_volume *volume;    /* NULL: it is in tiles */
    lmb_tile_files *tiles; /* NULL: it is not */
    const char *local_set; /* NULL: the volume itself */
    lmb_local_frame frame;
    lmb_sh3_rgb radiance[LMB_LOCAL_SET_MOST];
    float visibility[LMB_LOCAL_SET_MOST][LMB_KEY_LIGHTS_MOST];
} sampled;

/* Of the volumes of all tiles, the one with the set that comes first in the undivided volume.
 * @return what opening a tile can; `*found` stays NULL where no tile has it */
static lmb_result local_set_tile(const sampled *from, const lmb_volume **found, lmb_error *error)
{
    const uint32_t count = lmb_volume_tiles_get_info(lmb_tile_files_tiles(from->tiles)).tile_count;
    lmb_local_set first = {.name = NULL};
    for (uint32_t i = 0; i < count; ++i) {
        const lmb_volume *volume;
        const lmb_result result = lmb_tile_files_need(from->tiles, i, &volume, error);
        if (result != LMB_OK) {
            return result;
        }
        const uint32_t index = lmb_volume_local_set_find(volume, from->local_set);
        if (index == lmb_volume_local_set_count(volume)) {
            continue;
        }
        const lmb_local_set set = lmb_volume_local_set_get(volume, index);
        if (!first.name || set.node < first.node || (set.node == first.node && set.place < first.place)) {
            first = set;
            *found = volume;
        }
    }
    return LMB_OK;
}

/* @return LMB_ERROR_UNSUPPORTED: there is no such set */
static lmb_result local_set_find(sampled *from, const char *path, lmb_error *error)
{
    const lmb_volume *volume = from->volume;
    const lmb_result result = volume ? LMB_OK : local_set_tile(from, &volume, error);
    if (result != LMB_OK) {
        return result;
    }
    const uint32_t index = volume ? lmb_volume_local_set_find(volume, from->local_set) : 0;
    if (!volume || index == lmb_volume_local_set_count(volume)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: has no local set '%s'", path, from->local_set);
    }
    from->frame = lmb_volume_local_set_get(volume, index).frame;
    lmb_volume_local_set_light(volume, index, from->radiance, from->visibility);
    return LMB_OK;
}

static lmb_result sampled_open(sampled *from, const char *path, lmb_error *error)
{
    lmb_result result;
    if (lmb_tile_files_is_index(path)) {
        result = lmb_tile_files_open(path, &from->tiles, error);
    } else {
        result = lmb_volume_open_file(path, &from->volume);
        if (result != LMB_OK) {
            lmb_error_set(error, result, "%s: %s", path, lmb_result_text(result));
        }
    }
    return result == LMB_OK && from->local_set ? local_set_find(from, path, error) : result;
}

static void sampled_close(const sampled *from)
{
    lmb_volume_close(from->volume);
    lmb_tile_files_close(from->tiles);
}

/* @return what opening the position's tile can */
static lmb_result light_find(const sampled *from, lmb_vec3d position, lmb_query_light *light, bool *inside,
                             lmb_error *error)
{
    const lmb_volume_tiles *const tiles = from->tiles ? lmb_tile_files_tiles(from->tiles) : NULL;
    key_lights_seen *const keys = &light->keys;
    lmb_result result = LMB_OK;
    keys->count =
        tiles ? lmb_volume_tiles_key_lights(tiles, keys->light) : lmb_volume_key_lights(from->volume, keys->light);
    *inside = true;
    if (from->local_set) {
        lmb_local_set_sample_with_keys(&from->frame, from->radiance,
                                       (const float(*)[LMB_KEY_LIGHTS_MOST])from->visibility, position, &light->rest,
                                       keys->visibility);
    } else if (tiles) {
        result = lmb_tile_files_need(from->tiles, lmb_volume_tiles_find(tiles, position), NULL, error);
        *inside = lmb_volume_tiles_sample_with_keys(tiles, position, &light->rest, keys->visibility);
    } else {
        *inside = lmb_volume_sample_with_keys(from->volume, position, &light->rest, keys->visibility);
    }
    return result;
}

static int answer_print(const lmb_query *query, const lmb_model *model, const sampled *from, bool json)
{
    lmb_query_light light;
    lmb_error error = {{0}};
    bool inside;
    const lmb_result result = light_find(from, query->position, &light, &inside, &error);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    const lmb_rgb irradiance = query->has_normal ? query_irradiance(query, model, &light) : (lmb_rgb){{0}};
    if (json) {
        cJSON *object = cJSON_CreateObject();
        cJSON_AddItemToObject(object, "position", json_position(query->position));
        if (query->has_normal) {
            cJSON_AddItemToObject(object, "normal", json_vector(query->normal));
            cJSON_AddItemToObject(object, "irradiance", json_rgb(irradiance));
        }
        json_add_light(object, &light);
        cJSON_AddBoolToObject(object, "outside", !inside);
        return json_print_line(object);
    }
    printf("%.9g %.9g %.9g%s", query->position.x, query->position.y, query->position.z, inside ? "" : " (outside)");
    if (query->has_normal) {
        printf("  irradiance %.6g %.6g %.6g", (double)irradiance.c[0], (double)irradiance.c[1],
               (double)irradiance.c[2]);
    }
    const lmb_sh3_rgb radiance = key_lights_add_sh3(&light.keys, &light.rest);
    const float mean_scale = 0.28209479f; /* 1/(2 sqrt(pi)): l0 to mean radiance */
    printf("  mean radiance %.6g %.6g %.6g", (double)(radiance.channel[0].c[0] * mean_scale),
           (double)(radiance.channel[1].c[0] * mean_scale), (double)(radiance.channel[2].c[0] * mean_scale));
    for (uint32_t i = 0; i < light.keys.count; ++i) {
        printf("  key light %u seen %.3g", i, (double)light.keys.visibility[i]);
    }
    putchar('\n');
    return EXIT_DONE;
}

static const lmb_model *model_of_name(lmb_arguments *arguments, const char *name)
{
    const lmb_model *model = lmb_model_find(name, LMB_MODEL_FOR_SURFACE | LMB_MODEL_FOR_OBJECT);
    if (!model || model->uses == 0) {
        arguments_error(arguments, "--model: there is no lighting model", name);
    }
    return model;
}

int command_sample(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "sample", usage());
    lmb_query_arguments query_arguments = {0};
    lmb_shared_arguments shared = {.path_name = {"FILE.lmb or .lmt"}};
    static sampled from; /* too large for the stack */
    from = (sampled){.volume = NULL};
    const lmb_model *model = lmb_model_default(LMB_MODEL_FOR_SURFACE);
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
        } else if (strcmp(argument, "--local-set") == 0) {
            from.local_set = arguments_text(&arguments, argument);
        } else if (strcmp(argument, "--json") == 0) {
            json = true;
        } else {
            arguments_shared(&arguments, argument, &shared);
        }
    }
    if (!arguments_complete(&arguments, &shared)) {
        return arguments_status(&arguments);
    }
    const char *const path = shared.path[0];
    if (!query_finish(&query_arguments, &arguments)) {
        return EXIT_USAGE;
    }

    lmb_error error = {{0}};
    const lmb_result result = sampled_open(&from, path, &error);
    if (result != LMB_OK) {
        sampled_close(&from);
        return command_fail(result, &error);
    }
    lmb_query query = query_arguments.one;
    int line = 0;
    int more = query_arguments.has_position ? 1 : query_read_line(&query, &line);
    int status = EXIT_DONE;
    while (more == 1) {
        status = answer_print(&query, model, &from, json);
        if (status != EXIT_DONE || ferror(stdout)) {
            break;
        }
        more = query_arguments.has_position ? 0 : query_read_line(&query, &line);
    }
    sampled_close(&from);
    return more < 0 ? EXIT_BAD_INPUT : status;
}
