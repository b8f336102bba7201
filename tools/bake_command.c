#include "bake_command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include <lambent/file.h>
#include <lambent/scene.h>

#include "command.h"
#include "interrupt.h"
#include "level_arguments.h"

/* How many probes, and how far apart. */
static void probes_print(const lmb_bake_record *record)
{
    printf("%d at ", record->probes);
    if (record->level_count > 1) {
        printf("%g to ", (double)record->level[0].spacing);
    }
    printf("%g m", (double)record->level[record->level_count > 0 ? record->level_count - 1 : 0].spacing);
}

static void levels_print(const lmb_bake_record *record)
{
    printf("levels  ");
    for (uint32_t i = 0; i < record->level_count; ++i) {
        printf("%s%d at %g m", i > 0 ? ", " : "", record->level[i].probes, (double)record->level[i].spacing);
    }
    printf("\n");
}

static void plan_print(const lmb_bake_record *record)
{
    const lmb_bake_settings *settings = &record->settings;
    if (!settings->no_probes) {
        printf("probes  ");
        probes_print(record);
        printf(" (%d traced, %d dilated", record->placement.probes_valid, record->placement.probes_dilated);
        if (record->placement.probes_hanging > 0) {
            printf(", %d on coarser cells", record->placement.probes_hanging);
        }
        printf(")\n");
        if (record->level_count > 1) {
            levels_print(record);
        }
    }
    if (settings->lightmaps) {
        printf("texels  %llu at %g a metre, in %d images, of which they are %.1f %%\n",
               (unsigned long long)record->texels_covered, (double)settings->texels_per_m, record->images,
               100.0 * record->texels_used);
    }
    if (record->surface_solved) {
        printf("cells   %u on surfaces, of %.3g m, solved in %.3g s\n", record->surface.cells,
               (double)record->surface_cell_size, record->seconds[LMB_PHASE_SURFACE]);
    }
    printf("expect  about %.3g s on %d threads\n", record->expected_seconds, record->threads);
}

static cJSON *plan_json(const lmb_bake_record *record)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddBoolToObject(json, "dry_run", true);
    cJSON_AddNumberToObject(json, "probes", record->probes);
    cJSON_AddNumberToObject(json, "probes_valid", record->placement.probes_valid);
    cJSON_AddNumberToObject(json, "spacing", (double)record->settings.spacing);
    cJSON_AddItemToObject(json, "levels", lmb_bake_record_json_levels(record));
    cJSON_AddNumberToObject(json, "texels", (double)record->texels_covered);
    cJSON_AddNumberToObject(json, "images", record->images);
    cJSON_AddNumberToObject(json, "texels_used", record->texels_used);
    cJSON_AddNumberToObject(json, "charts", (double)record->charts);
    cJSON_AddNumberToObject(json, "surface_cells", record->surface.cells);
    cJSON_AddNumberToObject(json, "expected_seconds", record->expected_seconds);
    cJSON_AddNumberToObject(json, "threads", record->threads);
    return json;
}

static void summary_print(const lmb_bake_record *record, const char *directory)
{
    const lmb_bake_settings *settings = &record->settings;
    if (record->surface_solved) {
        printf("surfaces  %u cells of %.3g m, %.1f s\n", record->surface.cells, (double)record->surface_cell_size,
               record->seconds[LMB_PHASE_SURFACE]);
    }
    if (!settings->no_probes) {
        printf("probes    ");
        probes_print(record);
        printf(", %.1f s\n", record->seconds[LMB_PHASE_LEVELS] + record->seconds[LMB_PHASE_PROBES]);
    }
    for (uint32_t i = 0; i < record->key_light_count; ++i) {
        const lmb_key_light *light = &record->key_light[i];
        printf("sun       from (%.3f, %.3f, %.3f), irradiance %.4g %.4g %.4g, apart from the harmonics\n",
               (double)light->direction.x, (double)light->direction.y, (double)light->direction.z,
               (double)light->irradiance.c[0], (double)light->irradiance.c[1], (double)light->irradiance.c[2]);
    }
    if (settings->lightmaps) {
        printf("lightmap  %llu texels in %d images, %.1f %% of them, %llu charts made, %.1f s\n",
               (unsigned long long)record->lightmap.elements, record->images, 100.0 * record->texels_used,
               (unsigned long long)record->charts, record->seconds[LMB_PHASE_LIGHTMAPS]);
    }
    if (settings->lightmaps && settings->denoise) {
        printf("denoise   %.1f s\n", record->seconds[LMB_PHASE_DENOISE]);
    }
    if (record->seams_closed.edges > 0) {
        printf("seams     %zu edges, steps of %.2f %% (95 of 100 below %.1f %%), %.2f (%.1f) before closing\n",
               record->seams_closed.edges, 100.0 * record->seams_closed.median, 100.0 * record->seams_closed.p95,
               100.0 * record->seams_open.median, 100.0 * record->seams_open.p95);
    }
    const double elements = (double)record->placement.probes_valid + (double)record->lightmap.elements;
    printf("samples   %.0f for a probe or texel on average\n",
           (double)(record->gathered.samples + record->lightmap.samples) / (elements > 0.0 ? elements : 1.0));
    printf("rays      %.3g million, %.2f million a second\n", 1e-6 * (double)lmb_bake_record_rays(record),
           lmb_bake_record_mrays_per_s(record));
    printf("error     %.2f %% estimated (standard error, relative, of probes and texels)\n",
           100.0 * lmb_bake_record_error(record));
    if (record->is_part) {
        printf("taken     %llu probes and texels as the earlier bake had gathered them\n",
               (unsigned long long)record->taken);
    }
    printf("memory    %.0f MB at most\n", record->peak_rss_mb);
    if (record->tiles > 0) {
        printf("tiles     %u, %.1f kB\n", record->tiles, 1e-3 * (double)record->bytes_tiles);
    }
    printf("written   %s (probes.vdb %.1f kB, probes.lmb %.1f kB, lightmaps %.1f kB)\n", directory,
           1e-3 * (double)record->bytes_vdb, 1e-3 * (double)record->bytes_lmb, 1e-3 * (double)record->bytes_lightmaps);
}

/* The record without its settings, which are those of the command line. */
static cJSON *summary_json(const lmb_bake_record *record, const char *directory)
{
    char *text = lmb_bake_record_text(record);
    cJSON *json = cJSON_Parse(text ? text : "{}");
    free(text);
    cJSON_DeleteItemFromObject(json, "settings");
    cJSON_AddStringToObject(json, "directory", directory);
    return json;
}

/* Says what a bake made, or with --dry-run would make. */
static void record_report(const bake_options *options, const char *directory, const lmb_bake_record *record)
{
    if (options->json_progress) {
        console_result(options->dry_run ? plan_json(record) : summary_json(record, directory));
    } else if (options->dry_run) {
        plan_print(record);
    } else if (record->is_current) {
        printf(options->work.prepare ? "current   %s is prepared for this bake; --force does it again\n"
                                     : "current   %s holds this bake; --force bakes it again\n",
               directory);
    } else if (options->work.prepare) {
        printf("prepared  in %s, for --prepared\n", directory);
    } else if (options->work.shard_count > 1) {
        printf("gathered  share %u of %u, in %s\n", options->work.shard + 1, options->work.shard_count, directory);
    } else if (!options->quiet) {
        summary_print(record, directory);
    }
}

static void folder_abandon(void *folder)
{
    lmb_bake_folder_abandon(folder);
}

/* The folder comes first: one that cannot be written is found at once. From then on an interruption takes back what was
 * made there. */
static lmb_result folder_open(const bake_options *options, const char *directory, lmb_bake_folder **folder,
                              lmb_error *error)
{
    interrupt_hold();
    const lmb_result result = lmb_bake_folder_open(directory, options->settings.lightmaps, folder, error);
    if (result == LMB_OK) {
        interrupt_set_cleanup(folder_abandon, *folder);
    }
    interrupt_release();
    return result;
}

static void folder_close(lmb_bake_folder *folder)
{
    interrupt_hold();
    interrupt_set_cleanup(NULL, NULL);
    lmb_bake_folder_close(folder);
    interrupt_release();
}

static bool on_progress(void *context, const lmb_bake_progress *progress)
{
    const bool goes_on = console_bake_progress(context, progress);
    if (goes_on && progress->phase == LMB_PHASE_WRITE && progress->done >= 1.0) {
        interrupt_shut(); /* files are about to replace their old versions */
    }
    return goes_on;
}

static lmb_result bake_run(const bake_options *options, const lmb_bake_listener *listener, lmb_bake_record *record,
                           lmb_error *error)
{
    if (options->dry_run) {
        return lmb_bake_plan(&options->settings, listener, record, error);
    }
    lmb_bake_folder *folder;
    lmb_result result = folder_open(options, options->directory, &folder, error);
    if (result == LMB_OK) {
        result = lmb_bake_run_as(&options->settings, &options->work, folder, listener, record, error);
        folder_close(folder);
    }
    return result;
}

/* A bake of several sets, for the functions that it calls. */
typedef struct sets_context {
    const bake_options *options;
    lmb_console *console;
} sets_context;

/* DIR/SET; the caller frees it. NULL: out of memory. */
static char *set_directory(const bake_options *options, const char *set)
{
    return lmb_file_in(options->directory, set);
}

static lmb_result set_open(void *context, const char *set, lmb_bake_folder **folder, lmb_error *error)
{
    const sets_context *sets = context;
    char *const directory = set_directory(sets->options, set);
    console_progress(sets->console, sets->options->quiet, sets->options->json_progress);
    const lmb_result result = directory ? folder_open(sets->options, directory, folder, error)
                                        : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    free(directory);
    return result;
}

static void set_close(void *context, const char *set, lmb_bake_folder *folder, const lmb_bake_record *record)
{
    const sets_context *sets = context;
    char *const directory = set_directory(sets->options, set);
    folder_close(folder);
    interrupt_reopen(); /* the files are in their places */
    console_finish(sets->console);
    if (record && directory) {
        record_report(sets->options, directory, record);
    }
    free(directory);
}

/* A,B,... in pieces, in `text` itself; a last one beyond what there can be stays whole. @return how many; 0: all */
static uint32_t names_split(char *text, const char *name[LMB_LIGHT_SETS_MOST + 1])
{
    uint32_t count = 0;
    for (char *at = strcmp(text, "all") == 0 ? NULL : text; at;) {
        char *const comma = count < LMB_LIGHT_SETS_MOST ? strchr(at, ',') : NULL;
        name[count++] = at;
        at = comma ? comma + 1 : NULL;
        if (comma) {
            *comma = '\0';
        }
    }
    return count;
}

static lmb_result sets_run(const bake_options *options, lmb_console *console, const lmb_bake_listener *listener,
                           lmb_error *error)
{
    const char *name[LMB_LIGHT_SETS_MOST + 1];
    sets_context sets = {options, console};
    const lmb_bake_set_folders folders = {set_open, set_close, &sets};
    const size_t size = strlen(options->light_sets) + 1;
    char *const text = malloc(size);
    if (!text) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    memcpy(text, options->light_sets, size);
    const uint32_t count = names_split(text, name);
    const lmb_result result =
        lmb_bake_run_sets(&options->settings, &options->work, name, count, &folders, listener, error);
    free(text);
    return result;
}

int bake_command_run(const bake_options *options)
{
    lmb_console console;
    console_progress(&console, options->quiet, options->json_progress);
    if (options->settings.max_samples == options->settings.samples) {
        samples_say_rounded(options->settings.samples, LMB_GATHER_REPLICATES, options->quiet);
    }
    const lmb_bake_listener listener = {
        .progress = on_progress, .context = &console, .warnings = console_warnings(options->quiet)};
    lmb_error error = {{0}};
    lmb_bake_record record;
    const lmb_result result = options->light_sets ? sets_run(options, &console, &listener, &error)
                                                  : bake_run(options, &listener, &record, &error);
    console_finish(&console);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    if (!options->light_sets) {
        record_report(options, options->directory, &record);
    }
    return EXIT_DONE;
}
