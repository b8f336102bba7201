#define _POSIX_C_SOURCE 200809L
#include "bake_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/vdb.h>

#include "command.h"

enum { PATH_SIZE = 4096 };

static lmb_result path_make(const char *directory, const char *name, char path[PATH_SIZE], lmb_error *error)
{
    const int length = snprintf(path, PATH_SIZE, "%s/%s", directory, name);
    if (length < 0 || length >= PATH_SIZE) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%.100s...: path is too long", directory);
    }
    return LMB_OK;
}

static lmb_result write_lmb(lmb_bake *bake, const char *stage, lmb_error *error)
{
    char path[PATH_SIZE];
    unsigned char *data = NULL;
    size_t size;
    lmb_pack_stats stats;
    lmb_result result = path_make(stage, "probes.lmb", path, error);
    if (result == LMB_OK) {
        result = lmb_pack(bake->grid, &data, &size, &stats);
        if (result != LMB_OK) {
            lmb_error_set(error, result, "%s: %s", path, lmb_result_text(result));
        }
    }
    if (result == LMB_OK) {
        bake->record.bytes_lmb = stats.bytes;
        bake->record.fp16_overflow_count = stats.overflow_count;
        result = lmb_file_write(path, data, size, error);
    }
    free(data);
    return result;
}

static lmb_result write_vdb(lmb_bake *bake, const char *stage, const cJSON *settings, lmb_error *error)
{
    char path[PATH_SIZE];
    char hash[17];
    hash_text(bake->level->scene->content_hash, hash);
    char *text = cJSON_PrintUnformatted(settings);
    lmb_result result = text ? path_make(stage, "probes.vdb", path, error) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        const lmb_vdb_metadata metadata = {text, hash};
        result = lmb_vdb_write(path, bake->grid, &metadata, error);
    }
    struct stat status;
    if (result == LMB_OK && stat(path, &status) == 0) {
        bake->record.bytes_vdb = (uint64_t)status.st_size;
    }
    cJSON_free(text);
    return result;
}

static lmb_result write_lightmaps(lmb_bake *bake, const char *stage, lmb_error *error)
{
    if (!bake->lightmap) {
        return LMB_OK;
    }
    char path[PATH_SIZE];
    lmb_result result = path_make(stage, "lightmap", path, error);
    if (result == LMB_OK) {
        result = lmb_lightmap_write(bake->lightmap, path, &bake->settings->level.options.gltf,
                                    &bake->record.bytes_lightmaps, error);
    }
    return result;
}

static uint64_t bake_rays(const lmb_bake *bake)
{
    uint64_t rays = 0;
    for (lmb_bake_phase phase = 0; phase < PHASE_COUNT; ++phase) {
        rays += bake_phase_rays(bake, phase);
    }
    return rays;
}

static double bake_seconds_tracing(const lmb_bake *bake)
{
    double seconds = 0.0;
    for (lmb_bake_phase phase = 0; phase < PHASE_COUNT; ++phase) {
        seconds += bake_phase_seconds(bake, phase);
    }
    return seconds;
}

static double bake_mrays_per_s(const lmb_bake *bake)
{
    const double seconds = bake_seconds_tracing(bake);
    return seconds > 0.0 ? 1e-6 * (double)bake_rays(bake) / seconds : 0.0;
}

/* Over probes and texels together, relative to their light: dark ones do not count for more than they hold. */
static double record_relative_error(const lmb_bake_record *record)
{
    return lmb_relative_error(record->probes.squared_error + record->lightmap.squared_error,
                              record->probes.squared_length + record->lightmap.squared_length);
}

static void json_add_seconds(cJSON *json, const lmb_bake *bake)
{
    const lmb_bake_record *record = &bake->record;
    cJSON *seconds = cJSON_AddObjectToObject(json, "seconds");
    cJSON_AddNumberToObject(seconds, "load", bake->level->seconds_load);
    cJSON_AddNumberToObject(seconds, "bvh", bake->level->seconds_bvh);
    cJSON_AddNumberToObject(seconds, "layout", record->seconds_layout);
    for (lmb_bake_phase phase = 0; phase < PHASE_COUNT; ++phase) {
        cJSON_AddNumberToObject(seconds, bake_phase_name(phase), bake_phase_seconds(bake, phase));
    }
    cJSON_AddNumberToObject(seconds, "write", record->seconds_write);
    cJSON_AddNumberToObject(seconds, "total",
                            bake->level->seconds_load + bake->level->seconds_bvh + record->seconds_layout +
                                bake_seconds_tracing(bake) + record->seconds_write);
    cJSON_AddNumberToObject(json, "mrays_per_s", bake_mrays_per_s(bake));
}

static void json_add_surface(cJSON *json, const lmb_level *level)
{
    cJSON_AddStringToObject(json, "estimator", estimator_name(level->surface ? ESTIMATOR_CACHED : ESTIMATOR_REFERENCE));
    if (level->surface) {
        cJSON_AddNumberToObject(json, "surface_bytes", (double)lmb_surface_light_bytes(level->surface));
        cJSON_AddNumberToObject(json, "surface_cells", level->surface_stats.cells);
        cJSON_AddNumberToObject(json, "surface_cell_m", (double)lmb_surface_light_cell_size(level->surface));
        cJSON_AddNumberToObject(json, "surface_passes", level->surface_stats.passes);
    }
}

static double peak_rss_mb(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_maxrss / 1024.0;
}

/* What bake.json says of the bake, but for its files and settings. */
static cJSON *record_json(const lmb_bake *bake)
{
    const lmb_bake_record *record = &bake->record;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddNumberToObject(json, "probes", bake->grid->probe_count);
    cJSON *level = cJSON_CreateObject();
    cJSON_AddNumberToObject(level, "spacing", (double)bake->grid->spacing);
    cJSON_AddNumberToObject(level, "probes", bake->grid->probe_count);
    cJSON_AddItemToArray(cJSON_AddArrayToObject(json, "levels"), level);
    cJSON_AddNumberToObject(json, "probes_valid", record->placement.probes_valid);
    cJSON_AddNumberToObject(json, "cells", (double)record->placement.cells);
    cJSON_AddNumberToObject(json, "cells_crossed", (double)record->placement.cells_crossed);
    cJSON_AddNumberToObject(json, "texels", (double)record->lightmap.texels);
    cJSON_AddNumberToObject(json, "texels_pushed_out", (double)record->lightmap.pushed_out);
    cJSON_AddNumberToObject(json, "triangles_dropped", bake->level->scene->dropped_triangle_count);
    cJSON_AddNumberToObject(json, "samples", (double)(record->probes.samples + record->lightmap.samples));
    cJSON_AddNumberToObject(json, "rays", (double)bake_rays(bake));
    cJSON *phase_rays = cJSON_AddObjectToObject(json, "phase_rays");
    for (lmb_bake_phase phase = 0; phase < PHASE_COUNT; ++phase) {
        cJSON_AddNumberToObject(phase_rays, bake_phase_name(phase), (double)bake_phase_rays(bake, phase));
    }
    json_add_seconds(json, bake);
    cJSON_AddNumberToObject(json, "peak_rss_mb", peak_rss_mb());
    cJSON_AddNumberToObject(json, "threads", lmb_pool_threads(bake->level->pool));
    json_add_surface(json, bake->level);
    cJSON_AddNumberToObject(json, "seed", (double)bake->settings->level.options.seed);
    cJSON *bytes = cJSON_AddObjectToObject(json, "bytes");
    cJSON_AddNumberToObject(bytes, "vdb", (double)record->bytes_vdb);
    cJSON_AddNumberToObject(bytes, "lmb", (double)record->bytes_lmb);
    cJSON_AddNumberToObject(bytes, "lightmaps", (double)record->bytes_lightmaps);
    cJSON_AddNumberToObject(json, "fp16_overflows", (double)record->fp16_overflow_count);
    cJSON_AddNumberToObject(json, "estimated_rel_error", record_relative_error(record));
    return json;
}

static lmb_result write_record(lmb_bake *bake, const char *stage, cJSON *files, cJSON *settings, lmb_error *error)
{
    char path[PATH_SIZE];
    cJSON *json = record_json(bake);
    cJSON_AddItemToObject(json, "files", files);
    cJSON_AddItemToObject(json, "settings", settings);
    char *text = cJSON_Print(json);
    lmb_result result = text && files ? path_make(stage, "bake.json", path, error)
                                      : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    if (result == LMB_OK) {
        result = lmb_file_write(path, text, strlen(text), error);
    }
    cJSON_free(text);
    cJSON_Delete(json);
    return result;
}

static lmb_result write_all(lmb_bake *bake, const lmb_output_folder *folder, const char *stage, lmb_error *error)
{
    const double start = seconds_now();
    cJSON *settings = bake_settings_json(bake->settings, bake->level, bake->grid->spacing,
                                         bake->lightmap ? &bake->lightmap->settings : NULL);
    lmb_result result = write_vdb(bake, stage, settings, error);
    if (result == LMB_OK) {
        result = write_lmb(bake, stage, error);
    }
    if (result == LMB_OK) {
        result = write_lightmaps(bake, stage, error);
    }
    if (result != LMB_OK) {
        cJSON_Delete(settings);
        return result;
    }
    bake->record.seconds_write = seconds_now() - start;
    return write_record(bake, stage, output_folder_files(folder), settings, error);
}

/* All is written beside what is there, and takes its place when it is whole. */
static lmb_result step_write(lmb_bake *bake, lmb_output_folder *folder, lmb_error *error)
{
    const char *stage;
    lmb_result result = output_folder_stage(folder, &stage, error);
    if (result == LMB_OK) {
        result = write_all(bake, folder, stage, error);
    }
    if (result == LMB_OK) {
        result = output_folder_commit(folder, error);
    }
    if (result != LMB_OK) {
        output_folder_explain(folder, error);
    }
    return result;
}

static void dry_run_text(const lmb_bake *bake, const lmb_forecast *forecast)
{
    printf("probes  %d at %g m (%d traced, %d dilated)\n", bake->grid->probe_count, (double)bake->grid->spacing,
           bake->record.placement.probes_valid, bake->record.placement.probes_dilated);
    if (bake->lightmap) {
        printf("texels  %lld at %g a metre, in %d images\n", (long long)bake->lightmap->covered_texel_count,
               (double)bake->lightmap->settings.texels_per_m, bake->lightmap->image_count);
    }
    if (bake->level->surface) {
        printf("cells   %u on surfaces, of %.3g m, solved in %.3g s\n", bake->level->surface_stats.cells,
               (double)lmb_surface_light_cell_size(bake->level->surface), bake->level->seconds_surface);
    }
    printf("expect  about %.3g s on %d threads\n", forecast_left(forecast, "probes", 0.0, 0.0),
           lmb_pool_threads(bake->level->pool));
}

static cJSON *dry_run_json(const lmb_bake *bake, const lmb_forecast *forecast)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddBoolToObject(json, "dry_run", true);
    cJSON_AddNumberToObject(json, "probes", bake->grid->probe_count);
    cJSON_AddNumberToObject(json, "probes_valid", bake->record.placement.probes_valid);
    cJSON_AddNumberToObject(json, "spacing", (double)bake->grid->spacing);
    cJSON_AddNumberToObject(json, "texels", bake->lightmap ? (double)bake->lightmap->covered_texel_count : 0.0);
    cJSON_AddNumberToObject(json, "images", bake->lightmap ? bake->lightmap->image_count : 0.0);
    cJSON_AddNumberToObject(json, "surface_cells", bake->level->surface ? bake->level->surface_stats.cells : 0.0);
    cJSON_AddNumberToObject(json, "expected_seconds", forecast_left(forecast, "probes", 0.0, 0.0));
    cJSON_AddNumberToObject(json, "threads", lmb_pool_threads(bake->level->pool));
    return json;
}

/* Says what the bake would make, and how long what is left of it would take. */
static void dry_run_report(const lmb_bake *bake, const lmb_forecast *forecast)
{
    if (bake->settings->json_progress) {
        console_result(dry_run_json(bake, forecast));
    } else {
        dry_run_text(bake, forecast);
    }
}

static void summary_text(const lmb_bake *bake)
{
    const lmb_bake_record *record = &bake->record;
    if (bake->level->surface) {
        printf("surfaces  %u cells of %.3g m, %.1f s\n", bake->level->surface_stats.cells,
               (double)lmb_surface_light_cell_size(bake->level->surface), bake->level->seconds_surface);
    }
    printf("probes    %d at %g m, %.1f s\n", bake->grid->probe_count, (double)bake->grid->spacing,
           record->seconds_probes);
    if (bake->lightmap) {
        printf("lightmap  %llu texels in %d images, %.1f s\n", (unsigned long long)record->lightmap.texels,
               bake->lightmap->image_count, record->seconds_lightmaps);
    }
    const double elements = (double)record->placement.probes_valid + (double)record->lightmap.texels;
    printf("samples   %.0f for a probe or texel on average\n",
           (double)(record->probes.samples + record->lightmap.samples) / (elements > 0.0 ? elements : 1.0));
    printf("rays      %.3g million, %.2f million a second\n", 1e-6 * (double)bake_rays(bake), bake_mrays_per_s(bake));
    printf("error     %.2f %% estimated (standard error, relative, of probes and texels)\n",
           100.0 * record_relative_error(record));
    printf("memory    %.0f MB at most\n", peak_rss_mb());
    printf("written   %s (probes.vdb %.1f kB, probes.lmb %.1f kB, lightmaps %.1f kB)\n", bake->settings->directory,
           1e-3 * (double)record->bytes_vdb, 1e-3 * (double)record->bytes_lmb, 1e-3 * (double)record->bytes_lightmaps);
}

static void summary_report(const lmb_bake *bake)
{
    if (bake->settings->json_progress) {
        cJSON *json = record_json(bake);
        cJSON_AddStringToObject(json, "directory", bake->settings->directory);
        console_result(json);
    } else if (!bake->settings->level.options.quiet) {
        summary_text(bake);
    }
}

static lmb_result step_forecast(const lmb_bake *bake, lmb_forecast *forecast, lmb_error *error)
{
    const lmb_result result = forecast_make(bake, forecast);
    return result == LMB_OK ? LMB_OK : lmb_error_set(error, result, "trial: %s", lmb_result_text(result));
}

lmb_result bake_run(const lmb_bake_settings *settings, lmb_level *level, lmb_output_folder *folder,
                    const lmb_progress *progress, lmb_forecast *forecast, lmb_error *error)
{
    lmb_bake bake = {.settings = settings, .level = level, .progress = progress};
    lmb_result result = bake_place(&bake, error);
    if (result == LMB_OK) {
        result = bake_layout(&bake, error);
    }
    if (result == LMB_OK) {
        result = step_forecast(&bake, forecast, error);
    }
    if (result == LMB_OK) {
        result = bake_surface(&bake, error);
    }
    if (result == LMB_OK) {
        result = step_forecast(&bake, forecast, error);
    }
    if (result == LMB_OK && settings->dry_run) {
        dry_run_report(&bake, forecast);
    } else {
        if (result == LMB_OK) {
            result = bake_probes(&bake, error);
        }
        if (result == LMB_OK) {
            result = bake_lightmaps(&bake, error);
        }
        if (result == LMB_OK) {
            result = step_write(&bake, folder, error);
        }
        if (result == LMB_OK) {
            summary_report(&bake);
        }
    }
    bake_close(&bake);
    return result;
}
