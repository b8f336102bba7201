#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/image.h>
#include <lambent/ssbump.h>

#include "command.h"
#include "output_file.h"

static const char usage[] =
    "usage: lambent ssbump HEIGHT.png -o OUT.png [options]\n"
    "\n"
    "Makes a self-shadowed bump map of a height map (PNG, 8 or 16 bits, white is high), for lightmaps of the model\n"
    "rnm: red, green and blue are the shares of the light on the three slopes that a texel takes. Flat is 85 85 85.\n"
    "\n"
    "  --scale T     white is T texels above black (default 16)\n"
    "  --wrap        the map repeats: no seams where it does\n"
    "  --threads N   default: all processors\n"
    "  --quiet       no progress\n";

typedef struct ssbump_options {
    lmb_shared_arguments shared; /* of one path, the height map's */
    lmb_ssbump_settings settings;
} ssbump_options;

static bool options_read(lmb_arguments *arguments, ssbump_options *options)
{
    for (const char *next; (next = arguments_next(arguments));) {
        if (strcmp(next, "--scale") == 0) {
            options->settings.scale_texels = (float)arguments_number(arguments, next, 0.0, 65536.0);
        } else if (strcmp(next, "--wrap") == 0) {
            options->settings.wrap = true;
        } else {
            arguments_shared(arguments, next, &options->shared);
        }
    }
    if (arguments_complete(arguments, &options->shared) && !output_file_ends_in(options->shared.output, ".png")) {
        arguments_error(arguments, "-o takes a .png, not", options->shared.output);
    }
    return !arguments->failed && !arguments->help;
}

static lmb_result bump_make(const ssbump_options *options, const lmb_height_map *map, lmb_error *error)
{
    uint8_t *rgb = malloc(3 * (size_t)map->width * (size_t)map->height);
    lmb_pool *pool = NULL;
    lmb_result result = rgb ? lmb_pool_create(options->shared.threads, &pool) : LMB_ERROR_MEMORY;
    lmb_console console;
    const lmb_progress progress = console_progress(&console, options->shared.quiet, false);
    if (result == LMB_OK) {
        result = lmb_ssbump_make(map, &options->settings, pool, &progress, rgb);
    }
    console_finish(&console);
    result = result == LMB_OK ? lmb_png_write(options->shared.output, map->width, map->height, rgb, error)
                              : lmb_error_set(error, result, "%s: %s", options->shared.output, lmb_result_text(result));
    lmb_pool_destroy(pool);
    free(rgb);
    return result;
}

int command_ssbump(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "ssbump", usage);
    ssbump_options options = {.settings = lmb_ssbump_settings_default(),
                              .shared = {.path_name = {"HEIGHT.png"},
                                         .output_name = "OUT.png",
                                         .takes = ARGUMENTS_THREADS | ARGUMENTS_QUIET}};
    if (!options_read(&arguments, &options)) {
        return arguments_status(&arguments);
    }
    lmb_error error = {""};
    lmb_height_map map = {0, 0, NULL};
    lmb_result result = output_file_check(options.shared.output, &error);
    if (result == LMB_OK) {
        result = lmb_height_map_read(options.shared.path[0], &map, &error);
    }
    if (result == LMB_OK) {
        result = bump_make(&options, &map, &error);
    }
    lmb_height_map_free(&map);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
