/* What the level wants baked, from its nodes' `extras`, in every form that exporters give them. */
#include "gltf/gltf_extras.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/local_set.h>

#include "gltf/gltf_json.h"

/* More of them say nothing new. */
enum { MAX_WARNINGS = 8 };

/* Densities outside of this are mistakes, and no floats. */
#define LMB_GLTF_LEAST_DENSITY 1e-9
#define LMB_GLTF_MOST_DENSITY 1e9

typedef struct extras_reader {
    const lmb_gltf_file *file;
    const lmb_warnings *warnings;
    unsigned doubts; /* warnings, those that were not said too */
    lmb_error *error;
} extras_reader;

/* `where` is what has the extras: a node's name, or where it stands in the file. */
static void doubt(extras_reader *reader, const char *where, const char *key, const char *what)
{
    if (reader->doubts++ < MAX_WARNINGS) {
        lmb_warn(reader->warnings, "%s: %s: extras.%s %s", reader->file->path, where, key, what);
    }
}

/* true and false, and the 1 and 0 that exporters make of them. */
static bool read_bool(const cJSON *item, bool *value)
{
    const bool number = cJSON_IsNumber(item) && (item->valuedouble == 0.0 || item->valuedouble == 1.0);
    if (number || cJSON_IsBool(item)) {
        *value = number ? item->valuedouble == 1.0 : cJSON_IsTrue(item);
        return true;
    }
    return false;
}

static lmb_result read_light(const extras_reader *reader, const cJSON *item, uint32_t index, lmb_gltf_marks *marks)
{
    static const char *const words[] = {"baked", "indirect", "off"};
    for (unsigned i = 0; i < 3; ++i) {
        if (strcmp(cJSON_GetStringValue(item), words[i]) == 0) {
            marks->light = (lmb_gltf_light_part)i;
            return LMB_OK;
        }
    }
    return lmb_error_set(reader->error, LMB_ERROR_FORMAT,
                         "%s: nodes[%u].extras.lambent.light: neither baked, indirect nor off", reader->file->path,
                         index);
}

/* How large the node's light is. */
static void read_extent(extras_reader *reader, const cJSON *item, const char *name, const char *key, double most,
                        double *extent)
{
    if (cJSON_IsNumber(item) && item->valuedouble >= 0.0 && item->valuedouble <= most) {
        *extent = item->valuedouble;
    } else {
        doubt(reader, name, key, most > 180.0 ? "is not a length: ignored" : "is not an angle from 0 to 180: ignored");
    }
}

/* The name of a set of lights: whether it is one the scene says. */
static void read_light_set(extras_reader *reader, const cJSON *item, const char *where, const char *key,
                           char set[LMB_LIGHT_SET_NAME])
{
    const char *const name = cJSON_GetStringValue(item);
    if (name && strlen(name) < LMB_LIGHT_SET_NAME) {
        strcpy(set, name);
    } else {
        doubt(reader, where, key, "is not a name of less than 64 letters: ignored");
    }
}

/* How dense texels are, or probes. */
static void read_density(extras_reader *reader, const cJSON *item, const char *name, const char *key, double *density)
{
    if (cJSON_IsNumber(item) && item->valuedouble >= LMB_GLTF_LEAST_DENSITY &&
        item->valuedouble <= LMB_GLTF_MOST_DENSITY) {
        *density = item->valuedouble;
    } else {
        doubt(reader, name, key, "is not a number above 0: ignored");
    }
}

/* Marks that are true or false. Returns whether this is one. */
static bool read_switch(extras_reader *reader, const cJSON *item, const char *name, const char *key,
                        lmb_gltf_marks *marks)
{
    const bool is_static = strcmp(item->string, "static") == 0, is_seed = strcmp(item->string, "seed") == 0;
    const bool is_cube = strcmp(item->string, "cube_map") == 0;
    bool value;
    if (!is_static && !is_seed && !is_cube && strcmp(item->string, "lightmap") != 0) {
        return false;
    }
    if (item->string[0] == 'l' && cJSON_IsString(item) && strcmp(item->valuestring, "local") == 0) {
        marks->lightmap = LMB_GLTF_MAP_LOCAL;
    } else if (!read_bool(item, &value)) {
        doubt(reader, name, key,
              item->string[0] == 'l' ? "is neither true, false nor local: ignored"
                                     : "is neither true nor false: ignored");
    } else if (is_static) {
        marks->moves = value ? LMB_GLTF_STANDS : LMB_GLTF_MOVES;
    } else if (is_seed) {
        marks->seed = value;
    } else if (is_cube) {
        marks->cube_map = value;
    } else {
        marks->lightmap = value ? LMB_GLTF_MAP_ON : LMB_GLTF_MAP_OFF;
    }
    return true;
}

/* Whether the node wants probes of its own, and how many along each axis. */
static void read_local_set(extras_reader *reader, const cJSON *item, const char *name, const char *key,
                           lmb_gltf_marks *marks)
{
    bool value = cJSON_GetArraySize(item) == 3;
    uint32_t size[3] = {0};
    for (int axis = 0; axis < 3 && cJSON_IsArray(item); ++axis) {
        const cJSON *const number = cJSON_GetArrayItem(item, axis);
        const double wanted = cJSON_IsNumber(number) ? number->valuedouble : 0.0;
        value = value && wanted >= 1.0 && wanted <= (double)LMB_LOCAL_SET_SIDE && wanted == (double)(uint32_t)wanted;
        size[axis] = value ? (uint32_t)wanted : 0;
    }
    if (cJSON_IsArray(item) ? !value : !read_bool(item, &value)) {
        doubt(reader, name, key, "is neither true, false nor three whole numbers from 1 to 8: ignored");
        return;
    }
    marks->local_set = value ? LMB_GLTF_LOCAL_ON : LMB_GLTF_LOCAL_OFF;
    memcpy(marks->local_size, size, sizeof size);
}

/* How probes are to stand in the node's box. */
static void read_volume(extras_reader *reader, const cJSON *object, const char *name, lmb_gltf_volume *volume)
{
    if (!cJSON_IsObject(object)) {
        doubt(reader, name, "lambent.volume", "is not an object: ignored");
        return;
    }
    volume->is_told = true;
    const cJSON *item;
    cJSON_ArrayForEach(item, object)
    {
        char key[LMB_GLTF_WHERE_SIZE];
        lmb_gltf_where(key, "lambent.volume.%s", item->string);
        if (strcmp(item->string, "spacing") == 0) {
            read_density(reader, item, name, key, &volume->spacing);
        } else if (strcmp(item->string, "min_spacing") == 0) {
            read_density(reader, item, name, key, &volume->min_spacing);
        } else if (strcmp(item->string, "tolerance") == 0) {
            read_density(reader, item, name, key, &volume->tolerance);
        } else if (strcmp(item->string, "exclude") == 0) {
            if (!read_bool(item, &volume->exclude)) {
                doubt(reader, name, key, "is neither true nor false: ignored");
            }
        } else if (strcmp(item->string, "priority") == 0 && cJSON_IsNumber(item)) {
            volume->priority = item->valuedouble;
        } else {
            doubt(reader, name, key,
                  strcmp(item->string, "priority") == 0 ? "is not a number: ignored" : "is unknown: ignored");
        }
    }
}

static lmb_result read_mark(extras_reader *reader, const cJSON *item, const char *name, uint32_t index,
                            lmb_gltf_marks *marks)
{
    char key[LMB_GLTF_WHERE_SIZE];
    lmb_gltf_where(key, "lambent.%s", item->string);
    if (read_switch(reader, item, name, key, marks)) {
        return LMB_OK;
    }
    if (strcmp(item->string, "path") == 0) {
        marks->has_path = cJSON_IsNumber(item);
        marks->path = marks->has_path ? item->valuedouble : 0.0;
        if (!marks->has_path) {
            doubt(reader, name, key, "is not a number: ignored");
        }
    } else if (strcmp(item->string, "angle_deg") == 0) {
        read_extent(reader, item, name, key, 180.0, &marks->angle_deg);
    } else if (strcmp(item->string, "radius_m") == 0) {
        read_extent(reader, item, name, key, 1e18, &marks->radius_m);
    } else if (strcmp(item->string, "light_set") == 0) {
        read_light_set(reader, item, name, key, marks->light_set);
    } else if (strcmp(item->string, "texels_per_m") == 0) {
        read_density(reader, item, name, key, &marks->texels_per_m);
    } else if (strcmp(item->string, "texel_scale") == 0) {
        read_density(reader, item, name, key, &marks->texel_scale);
    } else if (strcmp(item->string, "local_set") == 0) {
        read_local_set(reader, item, name, key, marks);
    } else if (strcmp(item->string, "volume") == 0) {
        read_volume(reader, item, name, &marks->volume);
    } else if (strcmp(item->string, "light") == 0) {
        if (cJSON_IsString(item)) {
            return read_light(reader, item, index, marks);
        }
        doubt(reader, name, key, "is not a word: ignored");
    } else {
        doubt(reader, name, key, "is unknown: ignored");
    }
    return LMB_OK;
}

/* Keys that look as if they meant us. */
static bool is_almost_ours(const char *key)
{
    static const char ours[] = "lambent";
    for (size_t i = 0; i + 1 < sizeof ours; ++i) {
        if (tolower((unsigned char)key[i]) != ours[i]) {
            return false;
        }
    }
    return strcmp(key, ours) != 0;
}

static void doubt_names(extras_reader *reader, const cJSON *extras, const char *name)
{
    const cJSON *item, *const object = cJSON_IsObject(extras) ? extras : NULL;
    cJSON_ArrayForEach(item, object)
    {
        if (is_almost_ours(item->string)) {
            doubt(reader, name, item->string, "is ignored: marks are in an object, or its text, called lambent");
        }
    }
}

/* `extras` of one node. Custom properties that hold an object come as its JSON text from some exporters. */
static lmb_result read_extras(extras_reader *reader, const cJSON *extras, const char *name, uint32_t index,
                              lmb_gltf_marks *marks)
{
    const cJSON *const ours = cJSON_GetObjectItemCaseSensitive(extras, "lambent");
    doubt_names(reader, extras, name);
    if (!ours || cJSON_IsNull(ours)) {
        return LMB_OK;
    }
    cJSON *const parsed = cJSON_IsString(ours) ? cJSON_Parse(ours->valuestring) : NULL;
    const cJSON *const object = parsed ? parsed : ours;
    lmb_result result = LMB_OK;
    if (cJSON_IsObject(object)) {
        const cJSON *item;
        cJSON_ArrayForEach(item, object)
        {
            result = result == LMB_OK ? read_mark(reader, item, name, index, marks) : result;
        }
    } else {
        doubt(reader, name, "lambent", "is neither an object nor the text of one: ignored");
    }
    cJSON_Delete(parsed);
    return result;
}

void lmb_gltf_material_light_set(const lmb_gltf_file *file, const lmb_warnings *warnings, uint32_t material,
                                 char name[LMB_LIGHT_SET_NAME])
{
    extras_reader reader = {.file = file, .warnings = warnings};
    char where[LMB_GLTF_WHERE_SIZE];
    lmb_gltf_where(where, "materials[%u]", material);
    const cJSON *const list = cJSON_GetObjectItemCaseSensitive(file->root, "materials");
    const cJSON *const extras = cJSON_GetObjectItemCaseSensitive(cJSON_GetArrayItem(list, (int)material), "extras");
    const cJSON *const ours = cJSON_GetObjectItemCaseSensitive(extras, "lambent");
    cJSON *const parsed = cJSON_IsString(ours) ? cJSON_Parse(ours->valuestring) : NULL;
    const cJSON *item, *object = parsed ? parsed : ours;
    object = cJSON_IsObject(object) ? object : NULL;
    name[0] = '\0';
    cJSON_ArrayForEach(item, object)
    {
        if (strcmp(item->string, "light_set") == 0) {
            read_light_set(&reader, item, where, "lambent.light_set", name);
        } else {
            char key[LMB_GLTF_WHERE_SIZE];
            lmb_gltf_where(key, "lambent.%s", item->string);
            doubt(&reader, where, key, "is ignored: only light_set is read of a material");
        }
    }
    cJSON_Delete(parsed);
}

/* Marks on anything else do nothing: exporters put an object's properties on its node, but its mesh's and lamp's own
 * there. */
static void doubt_others(extras_reader *reader)
{
    static const char *const lists[] = {"scenes", "meshes", "materials", "cameras", "skins", "lights"};
    const cJSON *const lights = lmb_gltf_extension(reader->file->root, "KHR_lights_punctual");
    for (size_t i = 0; i < sizeof lists / sizeof *lists; ++i) {
        const cJSON *const owner = strcmp(lists[i], "lights") == 0 ? lights : reader->file->root;
        unsigned index = 0;
        const cJSON *item;
        cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(owner, lists[i]))
        {
            char where[LMB_GLTF_WHERE_SIZE];
            lmb_gltf_where(where, "%s[%u]", lists[i], index++);
            const cJSON *const extras = cJSON_GetObjectItemCaseSensitive(item, "extras");
            if (strcmp(lists[i], "materials") != 0 && cJSON_GetObjectItemCaseSensitive(extras, "lambent")) {
                doubt(reader, where, "lambent", "is ignored: only a node's and a material's are read");
            }
            doubt_names(reader, extras, where);
        }
    }
}

static bool is_hidden(const cJSON *node)
{
    const cJSON *const visibility = lmb_gltf_extension(node, "KHR_node_visibility");
    return cJSON_IsFalse(cJSON_GetObjectItemCaseSensitive(visibility, "visible"));
}

static lmb_result read_nodes(extras_reader *reader, lmb_gltf_marks *marks)
{
    uint32_t index = 0;
    const cJSON *node;
    cJSON_ArrayForEach(node, cJSON_GetObjectItemCaseSensitive(reader->file->root, "nodes"))
    {
        char name[LMB_GLTF_WHERE_SIZE];
        const char *const own = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(node, "name"));
        if (own && *own) {
            lmb_gltf_where(name, "node '%s'", own);
        } else {
            lmb_gltf_where(name, "nodes[%u]", index);
        }
        marks[index].hidden = is_hidden(node);
        const lmb_result result =
            read_extras(reader, cJSON_GetObjectItemCaseSensitive(node, "extras"), name, index, &marks[index]);
        if (result != LMB_OK) {
            return result;
        }
        ++index;
    }
    return LMB_OK;
}

lmb_result lmb_gltf_marks_read(const lmb_gltf_file *file, const lmb_warnings *warnings, lmb_gltf_marks **marks,
                               lmb_error *error)
{
    extras_reader reader = {.file = file, .warnings = warnings, .error = error};
    const size_t count = (size_t)cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(file->root, "nodes"));
    lmb_gltf_marks *const read = calloc(count + 1, sizeof *read);
    if (!read) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", file->path);
    }
    const lmb_result result = read_nodes(&reader, read);
    if (result != LMB_OK) {
        free(read);
        return result;
    }
    doubt_others(&reader);
    if (reader.doubts > MAX_WARNINGS) {
        lmb_warn(warnings, "%s: %u more doubtful extras", file->path, reader.doubts - MAX_WARNINGS);
    }
    *marks = read;
    return LMB_OK;
}
