#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/tile_files.h>
#include <lambent/vdb.h>

#include "command.h"
#include "output_file.h"

static const char usage[] =
    "usage: lambent pack FILE.vdb -o FILE.lmb [options]\n"
    "       lambent pack FILE.vdb -o FILE.lmt --tile-size M [options]\n"
    "\n"
    "Packs a baked volume that was edited as OpenVDB (in Houdini, Blender, or by a program) into the file that a game\n"
    "opens. A .vdb as bake wrote it gives the same bytes as the .lmb beside it. Grids sh_0 to sh_8 and validity must\n"
    "keep their names, transform and common active voxels.\n"
    "\n"
    "  -o FILE.lmb           where to write\n"
    "  --tile-size M         tiles of M metres, for a world that is streamed, and the index FILE.lmt of them: beside "
    "it\n"
    "                        FILE_X_Y_Z.lmb for the tile that begins at X, Y and Z times M; M is rounded to whole\n"
    "                        bricks of the coarsest level\n"
    "  --compact             bytes instead of halfs above each probe's mean: little more than half the size\n"
    "  --quiet               no closing line and no warnings\n";

typedef struct pack_options {
    lmb_shared_arguments shared; /* the .vdb, and the .lmb that is written */
    lmb_volume_form form;
    double tile_size; /* metres; 0: one volume */
} pack_options;

/* Writes the tiles of a volume, and their index. */
static lmb_result tiles_write(const pack_options *options, const unsigned char *volume, size_t size, lmb_error *error)
{
    lmb_tile_files_stats tiles = {0};
    const lmb_result result =
        lmb_tile_files_write(volume, size, options->tile_size, options->shared.output, &tiles, error);
    if (result == LMB_OK && !options->shared.quiet) {
        printf("tiles     %u of %g m (%.1f kB, %.1f %% more than undivided)\n", tiles.count, tiles.tile_size,
               1e-3 * (double)tiles.bytes, 100.0 * ((double)tiles.bytes / (double)size - 1.0));
    }
    return result;
}

static lmb_result pack_write(const pack_options *options, const lmb_probes *probes, lmb_pack_stats *stats,
                             lmb_error *error)
{
    unsigned char *data = NULL;
    size_t size;
    lmb_result result = lmb_pack_as(options->form, probes, &data, &size, stats);
    if (result == LMB_ERROR_ARGUMENT) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: no probe has light: validity is below %g everywhere",
                             options->shared.path[0], (double)LMB_PROBES_MIN_VALIDITY);
    }
    if (result != LMB_OK) {
        return lmb_error_set(error, result, "%s: %s", options->shared.path[0], lmb_result_text(result));
    }
    result = options->tile_size > 0.0 ? tiles_write(options, data, size, error)
                                      : lmb_file_write(options->shared.output, data, size, error);
    free(data);
    return result;
}

static lmb_result pack_run(const pack_options *options, lmb_error *error)
{
    lmb_probes *probes = NULL;
    lmb_pack_stats stats;
    lmb_result result = output_file_check(options->shared.output, error);
    if (result == LMB_OK) {
        result = lmb_vdb_read(options->shared.path[0], &probes, NULL, NULL, error);
    }
    if (result == LMB_OK) {
        result = pack_write(options, probes, &stats, error);
    }
    if (result == LMB_OK && stats.overflow_count > 0) {
        char line[LMB_ERROR_MESSAGE_SIZE];
        snprintf(line, sizeof line, "%s: %llu coefficients are beyond half float; their probes were made darker",
                 options->shared.output, (unsigned long long)stats.overflow_count);
        console_warning(line, options->shared.quiet);
    }
    if (result == LMB_OK && !options->shared.quiet) {
        printf("written   %s (%d probes at %g m, %.1f kB)\n", options->shared.output, probes->count,
               (double)probes->level[0].lattice.spacing, 1e-3 * (double)stats.bytes);
    }
    lmb_probes_destroy(probes);
    return result;
}

int command_pack(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "pack", usage);
    pack_options options = {.shared = {.path_name = {"FILE.vdb"}, .output_name = "FILE.lmb", .takes = ARGUMENTS_QUIET}};
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (strcmp(argument, "--compact") == 0) {
            options.form = LMB_VOLUME_COMPACT;
        } else if (strcmp(argument, "--tile-size") == 0) {
            options.tile_size = arguments_number(&arguments, argument, 1e-6, 1e9);
        } else {
            arguments_shared(&arguments, argument, &options.shared);
        }
    }
    const char *const ending = options.tile_size > 0.0 ? ".lmt" : ".lmb"; /* not over the .vdb by mistake */
    if (arguments_complete(&arguments, &options.shared) && !output_file_ends_in(options.shared.output, ending)) {
        arguments_error(&arguments,
                        options.tile_size > 0.0 ? "-o takes a .lmt with --tile-size, not" : "-o takes a .lmb, not",
                        options.shared.output);
    }
    if (arguments.failed || arguments.help) {
        return arguments_status(&arguments);
    }
    lmb_error error = {{0}};
    const lmb_result result = pack_run(&options, &error);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
