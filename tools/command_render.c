#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/baked.h>
#include <lambent/exr.h>
#include <lambent/file.h>
#include <lambent/vdb.h>
#include <lambent/vector.h>

#include "bake_arguments.h"
#include "output_file.h"
#include "render.h"
#include "tonemap.h"

static const char usage[] =
    "usage: lambent render LEVEL DIR -o FILE.png|FILE.exr [options]\n"
    "\n"
    "Draws LEVEL with the light baked in DIR: surfaces by lightmaps, or by their local sets where the level wants it,\n"
    "objects by probes. A .png is exposed and tone mapped, an .exr holds linear radiance.\n"
    "\n"
    "  --camera X,Y,Z        where from (default: a corner that shows much of the level)\n"
    "  --look X,Y,Z          where to (default: the middle of the level)\n"
    "  --camera-node NAME    from a camera of the level, or any node: along its -Z, +Y upwards\n"
    "  --fov DEG             vertical angle of view (default: the camera node's, else 60)\n"
    "  --size WxH            pixels (default 960x540)\n"
    "  --mode MODE           final       surfaces by lightmaps, objects by probes (default)\n"
    "                        lightmap    the stored irradiance alone, as on white paper\n"
    "                        probes      surfaces by probes too\n"
    "                        reference   all by the path tracer: the truth\n"
    "                        difference  final - reference: red is too bright, blue too dark\n"
    "                        mismatch    irradiance by probes - by lightmaps, as a share of the latter: likewise\n"
    "                        density     a checker of lightmap texels; red where there is no lightmap\n"
    "  --model NAME          light surfaces by the lightmaps of that model, which the bake wrote beside its own\n"
    "                        (bake --models); with --mode probes all by that model of `lambent models`, made of "
    "probes\n"
    "  --probes              show the probes as little spheres too, lit by what they hold: ghosts smaller, with a "
    "blue\n"
    "                        belt, those of local sets with a green one; a red belt where a probe could not be baked\n"
    "  --object FILE         add a glTF object, lit by the level's probes (repeatable)\n"
    "  --object-at X,Y,Z     where its origin goes (default: in front of the camera); without --object, a white\n"
    "                        sphere is put there\n"
    "  --specular M[,F0]     objects also reflect: facets' slopes M from 0 to 1, F0 along the normal (default 0.04)\n"
    "  --specular materials  everything reflects, by the metalness and roughness of its material\n"
    "  --maps FOLDER         what `lambent cube` wrote: reflections by the map that is nearest, of smooth surfaces\n"
    "  --samples N           light samples a pixel of reference and difference (default 32)\n"
    "  --exposure EV         brighten by 2^EV (default: by the picture's log-average)\n"
    "  --threads N           default: all processors\n"
    "  --quiet               no progress and no notes\n";

enum { MAX_OBJECTS = 64, MAX_PIXELS_ACROSS = 16384 };

/* The view shows luminance differences up to this share of the mean reference. */
#define DIFFERENCE_FULL_SHARE 0.5f
/* Radius of the built-in sphere, as a share of the diagonal of the level's bounds. */
#define SPHERE_SHARE 0.04f

typedef struct object_option {
    const char *path; /* NULL: the sphere */
    bool has_position;
    lmb_vec3d position;
} object_option;

typedef struct render_options {
    lmb_shared_arguments shared; /* LEVEL, DIR, and the picture that is written */
    bool has_camera, has_look, has_exposure;
    lmb_vec3d camera, look;
    const char *camera_node;
    float fov_deg; /* 0: not given */
    float exposure_ev;
    int32_t width, height;
    lmb_render_mode mode;
    const char *model_name; /* NULL: the bake's own, and each use's default */
    const lmb_model *model; /* of that name: of probes with RENDER_PROBES, else of lightmaps */
    uint32_t samples;
    object_option objects[MAX_OBJECTS];
    int object_count;
    bool has_specular, by_materials;
    lmb_specular specular;
    const char *maps;
    bool probes;
} render_options;

static const char *const mode_names[] = {
    [RENDER_FINAL] = "final",         [RENDER_LIGHTMAP] = "lightmap",     [RENDER_PROBES] = "probes",
    [RENDER_REFERENCE] = "reference", [RENDER_DIFFERENCE] = "difference", [RENDER_MISMATCH] = "mismatch",
    [RENDER_DENSITY] = "density",
};

static void mode_read(lmb_arguments *arguments, const char *option, render_options *options)
{
    const char *name = arguments_text(arguments, option);
    for (size_t i = 0; i < sizeof mode_names / sizeof mode_names[0]; ++i) {
        if (strcmp(name, mode_names[i]) == 0) {
            options->mode = (lmb_render_mode)i;
            return;
        }
    }
    if (!arguments->failed) {
        arguments_error(arguments,
                        "--mode takes final, lightmap, probes, reference, difference, mismatch or density, not", name);
    }
}

static void size_read(lmb_arguments *arguments, const char *option, render_options *options)
{
    const char *text = arguments_text(arguments, option);
    if (arguments->failed) {
        return;
    }
    char *end;
    const long width = strtol(text, &end, 10);
    const long height = *end == 'x' ? strtol(end + 1, &end, 10) : 0;
    if (*end != '\0' || width < 1 || height < 1 || width > MAX_PIXELS_ACROSS || height > MAX_PIXELS_ACROSS) {
        arguments_error(arguments, "--size takes WIDTHxHEIGHT in pixels, up to 16384 each, not", text);
        return;
    }
    options->width = (int32_t)width;
    options->height = (int32_t)height;
}

static void specular_read(lmb_arguments *arguments, const char *option, render_options *options)
{
    const char *text = arguments_text(arguments, option);
    options->by_materials = strcmp(text, "materials") == 0;
    if (arguments->failed || options->by_materials) {
        return;
    }
    char *end;
    const float roughness = strtof(text, &end);
    const float f0 = end != text && *end == ',' ? strtof(end + 1, &end) : 0.04f;
    if (end == text || *end != '\0' || !(roughness >= 0.0f && roughness <= 1.0f && f0 >= 0.0f && f0 <= 1.0f)) {
        arguments_error(arguments, "--specular takes materials, or ROUGHNESS[,F0], both from 0 to 1, not", text);
        return;
    }
    options->has_specular = true;
    options->specular = (lmb_specular){roughness, {{f0, f0, f0}}};
}

/* "--object FILE" adds an object; "--object-at" places the one just added, or a sphere. */
static void object_read(lmb_arguments *arguments, const char *option, render_options *options)
{
    const bool is_position = strcmp(option, "--object-at") == 0;
    object_option *last = options->object_count > 0 ? &options->objects[options->object_count - 1] : NULL;
    if (is_position && last && !last->has_position) {
        last->position = arguments_position(arguments, option);
        last->has_position = true;
        return;
    }
    if (options->object_count == MAX_OBJECTS) {
        arguments_error(arguments, "too many", option);
        return;
    }
    object_option *added = &options->objects[options->object_count++];
    *added = (object_option){.has_position = is_position};
    if (is_position) {
        added->position = arguments_position(arguments, option);
    } else {
        added->path = arguments_text(arguments, option);
    }
}

/* Takes an option about the view. */
static bool view_option(lmb_arguments *arguments, const char *option, render_options *options)
{
    if (strcmp(option, "--camera") == 0) {
        options->camera = arguments_position(arguments, option);
        options->has_camera = true;
    } else if (strcmp(option, "--look") == 0) {
        options->look = arguments_position(arguments, option);
        options->has_look = true;
    } else if (strcmp(option, "--camera-node") == 0) {
        options->camera_node = arguments_text(arguments, option);
    } else if (strcmp(option, "--fov") == 0) {
        options->fov_deg = (float)arguments_number(arguments, option, 1.0, 170.0);
    } else if (strcmp(option, "--size") == 0) {
        size_read(arguments, option, options);
    } else if (strcmp(option, "--mode") == 0) {
        mode_read(arguments, option, options);
    } else if (strcmp(option, "--exposure") == 0) {
        options->exposure_ev = (float)arguments_number(arguments, option, -100.0, 100.0);
        options->has_exposure = true;
    } else if (strcmp(option, "--specular") == 0) {
        specular_read(arguments, option, options);
    } else if (strcmp(option, "--maps") == 0) {
        options->maps = arguments_text(arguments, option);
    } else if (strcmp(option, "--object") == 0 || strcmp(option, "--object-at") == 0) {
        object_read(arguments, option, options);
    } else if (strcmp(option, "--probes") == 0) {
        options->probes = true;
    } else {
        return false;
    }
    return true;
}

/* The row of `--model`, once the mode is known. */
static void model_find(lmb_arguments *arguments, render_options *options)
{
    const char *const name = options->model_name;
    if (!name) {
        return;
    }
    if (options->mode != RENDER_PROBES) {
        options->model = lightmap_model_named(arguments, name);
        return;
    }
    options->model = lmb_model_find(name, LMB_MODEL_FOR_SURFACE | LMB_MODEL_FOR_OBJECT);
    if (!options->model || !options->model->encode) {
        arguments_error(arguments, "--model: probes make no model", name);
    }
}

static bool options_read(lmb_arguments *arguments, render_options *options)
{
    for (const char *next; (next = arguments_next(arguments));) {
        if (view_option(arguments, next, options)) {
            continue;
        }
        if (strcmp(next, "--model") == 0) {
            options->model_name = arguments_text(arguments, next);
        } else if (strcmp(next, "--samples") == 0) {
            options->samples = (uint32_t)arguments_integer(arguments, next, 1, 100000000);
        } else {
            arguments_shared(arguments, next, &options->shared);
        }
    }
    if (!arguments_complete(arguments, &options->shared)) {
        return false;
    }
    model_find(arguments, options);
    const char *const output = options->shared.output;
    if (options->camera_node && (options->has_camera || options->has_look)) {
        arguments_error(arguments, "--camera-node does not go with", options->has_camera ? "--camera" : "--look");
    } else if (options->probes && (options->mode == RENDER_DIFFERENCE || options->mode == RENDER_MISMATCH)) {
        arguments_error(arguments, "--probes does not go with --mode", mode_names[options->mode]);
    } else if (!output_file_ends_in(output, ".png") && !output_file_ends_in(output, ".exr")) {
        arguments_error(arguments, "-o takes a .png or .exr, not", output);
    }
    return !arguments->failed;
}

/* The first that is a camera, else the first of that name. */
static const lmb_scene_camera *scene_camera_find(const lmb_scene *scene, const char *name)
{
    const lmb_scene_camera *found = NULL;
    for (uint32_t i = 0; i < scene->camera_count; ++i) {
        const lmb_scene_camera *camera = &scene->cameras[i];
        if (strcmp(camera->name, name) == 0 &&
            (!found || (!(found->vertical_fov_rad > 0.0f) && camera->vertical_fov_rad > 0.0f))) {
            found = camera;
        }
    }
    return found;
}

static lmb_result camera_of_node(const char *name, const lmb_scene *scene, float fov_deg, lmb_camera *camera,
                                 lmb_error *error)
{
    const lmb_scene_camera *found = scene_camera_find(scene, name);
    if (!found) {
        char names[256] = "";
        for (uint32_t i = 0; i < scene->camera_count; ++i) {
            const size_t used = strlen(names);
            snprintf(names + used, sizeof names - used, "%s%s",
                     i > 0 ? ", " : "; its cameras: ", scene->cameras[i].name);
        }
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: no node is called '%s'%s", scene->path, name, names);
    }
    if (!(fov_deg > 0.0f)) {
        fov_deg = found->vertical_fov_rad > 0.0f ? found->vertical_fov_rad * 180.0f / LMB_PI_F : CAMERA_DEFAULT_FOV_DEG;
    }
    return camera_of_scene(found, fov_deg, camera)
               ? LMB_OK
               : lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: node '%s' is scaled to nothing: it looks nowhere",
                               scene->path, name);
}

static lmb_result camera_of_options(const render_options *options, const lmb_tracer *tracer, lmb_camera *camera,
                                    lmb_error *error)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    if (options->camera_node) {
        return camera_of_node(options->camera_node, scene, options->fov_deg, camera, error);
    }
    const float fov_deg = options->fov_deg > 0.0f ? options->fov_deg : CAMERA_DEFAULT_FOV_DEG;
    *camera = camera_default(tracer, fov_deg);
    if (options->has_camera || options->has_look) {
        const lmb_vec3 low = scene->bounds_min, high = scene->bounds_max;
        const lmb_vec3 middle = {0.5f * (low.x + high.x), 0.5f * (low.y + high.y), 0.5f * (low.z + high.z)};
        *camera = camera_look_at(options->has_camera ? lmb_scene_from_world(scene, options->camera) : camera->position,
                                 options->has_look ? lmb_scene_from_world(scene, options->look) : middle, fov_deg);
    }
    return LMB_OK;
}

/* Half way to what the camera looks at. */
static lmb_vec3 position_before_camera(const lmb_camera *camera, const lmb_tracer *tracer, float diagonal)
{
    lmb_hit hit;
    const bool found = lmb_trace_nearest(tracer, camera->position, camera->forward, 0.0f, FLT_MAX, &hit);
    const float distance = 0.5f * (found ? hit.distance : diagonal);
    return (lmb_vec3){camera->position.x + distance * camera->forward.x,
                      camera->position.y + distance * camera->forward.y,
                      camera->position.z + distance * camera->forward.z};
}

static float level_diagonal(const lmb_scene *scene)
{
    const float x = scene->bounds_max.x - scene->bounds_min.x;
    const float y = scene->bounds_max.y - scene->bounds_min.y;
    const float z = scene->bounds_max.z - scene->bounds_min.z;
    return x >= 0.0f ? fmaxf(sqrtf(x * x + y * y + z * z), FLT_MIN) : 1.0f;
}

/* Opens the objects; `*opened_count` says how many are open, whatever the result. */
static lmb_result objects_open(const render_options *options, const lmb_camera *camera, const lmb_tracer *tracer,
                               lmb_render_object *objects, int *opened_count, lmb_error *error)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    const float diagonal = level_diagonal(scene);
    for (*opened_count = 0; *opened_count < options->object_count; ++*opened_count) {
        const object_option *option = &options->objects[*opened_count];
        const lmb_vec3 before = position_before_camera(camera, tracer, diagonal);
        const lmb_vec3d at = option->position, from = scene->origin;
        const lmb_vec3d position = option->has_position
                                       ? (lmb_vec3d){at.x - from.x, at.y - from.y, at.z - from.z}
                                       : (lmb_vec3d){(double)before.x, (double)before.y, (double)before.z};
        const lmb_result result =
            render_object_open(option->path, SPHERE_SHARE * diagonal, position, &objects[*opened_count], error);
        if (result != LMB_OK) {
            return result;
        }
    }
    return LMB_OK;
}

static lmb_result exr_write(const render_options *options, const float *rgb, size_t pixel_count, lmb_error *error)
{
    float *plane = malloc(3 * pixel_count * sizeof *plane);
    if (!plane) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    for (size_t i = 0; i < pixel_count; ++i) {
        for (size_t c = 0; c < 3; ++c) {
            plane[c * pixel_count + i] = rgb[3 * i + c];
        }
    }
    const lmb_exr_channel channels[3] = {{"R", plane}, {"G", plane + pixel_count}, {"B", plane + 2 * pixel_count}};
    const lmb_exr_picture picture = {options->width, options->height, channels, 3, NULL, 0};
    size_t overflow_count = 0;
    const lmb_result result = lmb_exr_write(options->shared.output, &picture, &overflow_count, error);
    if (result == LMB_OK && overflow_count > 0) {
        char line[LMB_ERROR_MESSAGE_SIZE];
        snprintf(line, sizeof line, "%s: %zu values beyond half float were clamped", options->shared.output,
                 overflow_count);
        console_warning(line, options->shared.quiet);
    }
    free(plane);
    return result;
}

static lmb_result png_write(const render_options *options, const float *rgb, size_t pixel_count, double reference_mean,
                            lmb_error *error)
{
    uint8_t *srgb = malloc(3 * pixel_count);
    if (!srgb) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    if (options->mode == RENDER_DIFFERENCE) {
        const float full = DIFFERENCE_FULL_SHARE * (float)reference_mean;
        picture_difference_colour(rgb, pixel_count, full, srgb);
        if (!options->shared.quiet) {
            printf("final - reference: red +%g or more, white 0, blue -%g or less (%g %% of the reference's mean "
                   "luminance, %g)\n",
                   (double)full, (double)full, 100.0 * (double)DIFFERENCE_FULL_SHARE, reference_mean);
        }
    } else if (options->mode == RENDER_MISMATCH) {
        picture_difference_colour(rgb, pixel_count, DIFFERENCE_FULL_SHARE, srgb);
        if (!options->shared.quiet) {
            printf("probes - lightmaps: red +%g %% of the lightmap's light or more, white 0, blue as much less\n",
                   100.0 * (double)DIFFERENCE_FULL_SHARE);
        }
    } else {
        const float exposure_ev = options->has_exposure ? options->exposure_ev : exposure_of_picture(rgb, pixel_count);
        picture_tonemap(rgb, pixel_count, exposure_ev, srgb);
        if (!options->shared.quiet) {
            printf("--exposure %.3f\n", (double)exposure_ev);
        }
    }
    const lmb_result result = lmb_png_write(options->shared.output, options->width, options->height, srgb, error);
    free(srgb);
    return result;
}

static void camera_print(const lmb_camera *camera, const char *node, const lmb_scene *scene)
{
    if (node) {
        printf("--camera-node '%s'\n", node);
        return;
    }
    const lmb_vec3 at = camera->position, forward = camera->forward;
    const lmb_vec3d from = lmb_scene_to_world(scene, at);
    const lmb_vec3d to = lmb_scene_to_world(scene, (lmb_vec3){at.x + forward.x, at.y + forward.y, at.z + forward.z});
    /* Far from the world's origin it takes more digits to say where. */
    const int digits = scene->origin.x != 0.0 || scene->origin.y != 0.0 || scene->origin.z != 0.0 ? 15 : 6;
    printf("--camera %.*g,%.*g,%.*g --look %.*g,%.*g,%.*g\n", digits, from.x, digits, from.y, digits, from.z, digits,
           to.x, digits, to.y, digits, to.z);
}

/* Renders and writes. */
static lmb_result picture_make(const render_options *options, const lmb_shader *shader, const lmb_camera *camera,
                               lmb_pool *pool, lmb_error *error)
{
    const size_t pixel_count = (size_t)options->width * (size_t)options->height;
    float *rgb = malloc(3 * pixel_count * sizeof *rgb);
    if (!rgb) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for %zu pixels", pixel_count);
    }
    const lmb_render_settings settings = {.camera = *camera,
                                          .mode = options->mode,
                                          .width = options->width,
                                          .height = options->height,
                                          .samples = options->samples};
    lmb_console console;
    const lmb_progress progress = console_progress(&console, options->shared.quiet, false);
    double reference_mean = 0.0;
    lmb_result result = render_picture(shader, &settings, pool, &progress, rgb, &reference_mean);
    console_finish(&console);
    if (result != LMB_OK) {
        lmb_error_set(error, result, "render: %s", lmb_result_text(result));
    } else if (output_file_ends_in(options->shared.output, ".exr")) {
        result = exr_write(options, rgb, pixel_count, error);
    } else {
        result = png_write(options, rgb, pixel_count, reference_mean, error);
    }
    free(rgb);
    return result;
}

/* The probes that are shown, and their spheres; nothing where none are asked for. */
typedef struct shown_probes {
    lmb_probes *probes;
    probe_spheres spheres;
} shown_probes;

static lmb_result shown_open(const render_options *options, shown_probes *shown, lmb_error *error)
{
    *shown = (shown_probes){0};
    if (!options->probes) {
        return LMB_OK;
    }
    char *const path = lmb_file_in(options->shared.path[1], "probes.vdb");
    lmb_result result = path ? lmb_vdb_read(path, &shown->probes, NULL, NULL, error)
                             : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    free(path);
    if (result == LMB_OK) {
        result = probe_spheres_make(shown->probes, &shown->spheres);
        if (result != LMB_OK) {
            lmb_error_set(error, result, "out of memory for %d probes", shown->probes->count);
        }
    }
    return result;
}

static void shown_close(shown_probes *shown)
{
    probe_spheres_free(&shown->spheres);
    lmb_probes_destroy(shown->probes);
}

static lmb_result render_run(const render_options *options, const lmb_baked *baked, lmb_error *error)
{
    const lmb_tracer *tracer = baked->level.tracer;
    lmb_camera camera;
    lmb_result result = camera_of_options(options, tracer, &camera, error);
    if (result == LMB_OK && (options->probes || options->object_count > 0 || options->mode == RENDER_PROBES ||
                             options->mode == RENDER_MISMATCH)) {
        result = lmb_baked_need_probes(baked, options->shared.path[1], error);
    }
    if (result != LMB_OK) {
        return result;
    }
    if (!options->shared.quiet) {
        camera_print(&camera, options->camera_node, baked->level.scene);
        if (!baked->lightmap && options->mode != RENDER_PROBES && options->mode != RENDER_REFERENCE) {
            printf("this bake has no lightmaps: surfaces are lit by probes\n");
        } else if (options->by_materials && baked->lightmap && !baked->lightmap->model->radiance) {
            printf("lightmaps of '%s' hold no radiance: surfaces reflect by probes (--model sh3, of bake --models)\n",
                   baked->lightmap->model->name);
        }
    }
    lmb_render_object objects[MAX_OBJECTS];
    int object_count = 0;
    shown_probes shown;
    environment_maps maps = {NULL, 0};
    local_light local;
    if (local_light_open(baked->volume, baked->level.scene, &local) != LMB_OK) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for local sets");
    }
    result = shown_open(options, &shown, error);
    if (result == LMB_OK && options->maps) {
        result = environment_maps_read(options->maps, &maps, error);
    }
    if (result == LMB_OK) {
        result = objects_open(options, &camera, tracer, objects, &object_count, error);
    }
    if (result == LMB_OK) {
        const lmb_shader shader = {
            .transport = &baked->level.transport,
            .volume = baked->volume,
            .probe_model = options->mode == RENDER_PROBES ? options->model : NULL,
            .lightmap = baked->lightmap,
            .local = &local,
            .objects = objects,
            .object_count = object_count,
            .specular = options->has_specular ? &options->specular : NULL,
            .by_materials = options->by_materials,
            .maps = options->maps ? &maps : NULL,
            .spheres = options->probes ? &shown.spheres : NULL,
            .default_texel = 1.0f / lmb_lightmap_settings_default(baked->level.scene).texels_per_m,
        };
        result = picture_make(options, &shader, &camera, baked->level.pool, error);
    }
    for (int i = 0; i < object_count; ++i) {
        render_object_close(&objects[i]);
    }
    environment_maps_free(&maps);
    shown_close(&shown);
    local_light_close(&local);
    return result;
}

int command_render(int count, char **values)
{
    render_options options = {.width = 960,
                              .height = 540,
                              .samples = 32,
                              .mode = RENDER_FINAL,
                              .shared = {.path_name = {"LEVEL", "DIR"},
                                         .output_name = "FILE.png|FILE.exr",
                                         .takes = ARGUMENTS_THREADS | ARGUMENTS_QUIET}};
    lmb_arguments arguments = arguments_begin(count, values, "render", usage);
    if (!options_read(&arguments, &options)) {
        return arguments_status(&arguments);
    }
    if (options.mode == RENDER_REFERENCE || options.mode == RENDER_DIFFERENCE) {
        samples_say_rounded(options.samples, RENDER_RAYS_PER_PIXEL, options.shared.quiet);
    }
    const lmb_baked_view view = {options.camera_node, options.by_materials};
    lmb_error error = {""};
    lmb_baked baked;
    lmb_result result = output_file_check(options.shared.output, &error);
    if (result == LMB_OK) {
        result = lmb_baked_open(options.shared.path[0], options.shared.path[1], options.shared.threads, &view, &baked,
                                &error);
    }
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    if (options.model && options.mode != RENDER_PROBES) {
        result = lmb_baked_read_model(&baked, options.shared.path[1], options.model, &error);
    }
    if (result == LMB_OK) {
        result = render_run(&options, &baked, &error);
    }
    lmb_baked_close(&baked);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
