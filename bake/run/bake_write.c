#define _POSIX_C_SOURCE 200809L
#include "run/bake_write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/tile_files.h>
#include <lambent/vdb.h>

#include "base/clock.h"
#include "run/bake_current.h"
#include "run/bake_level_internal.h"
#include "run/bake_record_internal.h"
#include "run/bake_settings_internal.h"
#include "run/step.h"

enum { PATH_SIZE = 4096 };

/* Measured: shares of the time of writing after which the volume and all but the record are written. */
#define VOLUME_SHARE 0.5
#define FILES_SHARE 0.9

static lmb_result path_make(const char *directory, const char *name, char path[PATH_SIZE], lmb_error *error)
{
    const int length = snprintf(path, PATH_SIZE, "%s/%s", directory, name);
    if (length < 0 || length >= PATH_SIZE) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%.100s...: path is too long", directory);
    }
    return LMB_OK;
}

static lmb_result write_tiles(lmb_bake *bake, const char *stage, const unsigned char *data, size_t size,
                              lmb_error *error)
{
    char path[PATH_SIZE];
    lmb_tile_files_stats stats = {0};
    lmb_result result = path_make(stage, "probes.lmt", path, error);
    if (result == LMB_OK) {
        result = lmb_tile_files_write(data, size, bake->record.settings.tile_size, path, &stats, error);
    }
    if (result == LMB_OK) {
        bake->record.tiles = stats.count;
        bake->record.bytes_tiles = stats.bytes;
    }
    return result;
}

static lmb_result write_lmb(lmb_bake *bake, const char *stage, lmb_error *error)
{
    char path[PATH_SIZE];
    unsigned char *data = NULL;
    size_t size;
    lmb_pack_stats stats;
    lmb_result result = path_make(stage, "probes.lmb", path, error);
    if (result == LMB_OK) {
        const lmb_volume_form form = bake->record.settings.compact ? LMB_VOLUME_COMPACT : LMB_VOLUME_HALFS;
        result = lmb_pack_as(form, bake->probes, &data, &size, &stats);
        if (result != LMB_OK) {
            lmb_error_set(error, result, "%s: %s", path, lmb_result_text(result));
        }
    }
    if (result == LMB_OK) {
        bake->record.bytes_lmb = stats.bytes;
        bake->record.fp16_overflows = stats.overflow_count;
        result = lmb_file_write(path, data, size, error);
    }
    if (result == LMB_OK && bake->record.settings.tile_size > 0.0) {
        result = write_tiles(bake, stage, data, size, error);
    }
    free(data);
    return result;
}

static char *settings_text(const lmb_bake_record *record)
{
    cJSON *json = lmb_bake_settings_json(&record->settings, record->content_hash);
    char *text = cJSON_PrintUnformatted(json);
    cJSON_Delete(json);
    return text;
}

static lmb_result write_vdb(lmb_bake *bake, const char *stage, lmb_error *error)
{
    char path[PATH_SIZE];
    char hash[17];
    lmb_bake_settings_hash_text(bake->record.content_hash, hash);
    char *text = settings_text(&bake->record);
    lmb_result result =
        text ? path_make(stage, "probes.vdb", path, error) : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    if (result == LMB_OK) {
        const lmb_vdb_metadata metadata = {text, hash};
        result = lmb_vdb_write(path, bake->probes, &metadata, error);
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
    const lmb_gltf_options options = lmb_level_gltf_options(&bake->level->settings, NULL);
    lmb_result result = path_make(stage, "lightmap", path, error);
    if (result == LMB_OK) {
        result = lmb_lightmap_write(bake->lightmap, path, &options, &bake->record.bytes_lightmaps, error);
    }
    return result;
}

static double peak_rss_mb(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_maxrss / 1024.0;
}

static lmb_result write_record(lmb_bake *bake, const lmb_bake_folder *folder, const char *stage, lmb_error *error)
{
    char path[PATH_SIZE];
    cJSON *files = lmb_bake_folder_files(folder);
    cJSON *hashes = lmb_bake_hashes(stage, files);
    cJSON *json = lmb_bake_record_json(&bake->record, files, hashes);
    char *text = cJSON_Print(json);
    lmb_result result = text && files && hashes ? path_make(stage, "bake.json", path, error)
                                                : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    if (result == LMB_OK) {
        result = lmb_file_write(path, text, strlen(text), error);
    }
    cJSON_free(text);
    cJSON_Delete(json);
    return result;
}

static lmb_result write_all(lmb_bake *bake, const lmb_bake_folder *folder, const char *stage, lmb_error *error)
{
    const double start = lmb_clock_seconds();
    const char *name = lmb_bake_phase_name(LMB_PHASE_WRITE);
    lmb_result result = step_report(bake->progress, name, 0.0, error);
    if (result == LMB_OK && bake->probes) {
        result = write_vdb(bake, stage, error);
    }
    if (result == LMB_OK && bake->probes) {
        result = write_lmb(bake, stage, error);
    }
    if (result == LMB_OK) {
        result = step_report(bake->progress, name, VOLUME_SHARE, error);
    }
    if (result == LMB_OK) {
        result = write_lightmaps(bake, stage, error);
    }
    if (result == LMB_OK) {
        result = step_report(bake->progress, name, FILES_SHARE, error);
    }
    bake->record.seconds[LMB_PHASE_WRITE] = lmb_clock_seconds() - start;
    bake->record.peak_rss_mb = peak_rss_mb();
    if (result == LMB_OK) {
        result = write_record(bake, folder, stage, error);
    }
    return result == LMB_OK ? step_report(bake->progress, name, 1.0, error) : result;
}

lmb_result lmb_bake_write(lmb_bake *bake, lmb_bake_folder *folder, lmb_error *error)
{
    const char *stage;
    lmb_result result = lmb_bake_folder_stage(folder, &stage, error);
    if (result == LMB_OK) {
        result = write_all(bake, folder, stage, error);
    }
    if (result == LMB_OK) {
        result = lmb_bake_folder_commit(folder, error);
    }
    if (result != LMB_OK && result != LMB_ERROR_INTERRUPTED) {
        lmb_bake_folder_explain(folder, error);
    }
    return result;
}
