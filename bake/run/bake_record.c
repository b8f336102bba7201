#include "run/bake_record_internal.h"

#include <string.h>

#include "run/bake_settings_internal.h"

static const char *const phase_names[LMB_PHASE_COUNT] = {
    [LMB_PHASE_LOAD] = "load",           [LMB_PHASE_BVH] = "bvh",
    [LMB_PHASE_PLACE] = "place",         [LMB_PHASE_LAYOUT] = "layout",
    [LMB_PHASE_PILOT] = "surface pilot", [LMB_PHASE_SURFACE] = "surface",
    [LMB_PHASE_BOUNCES] = "bounces",     [LMB_PHASE_LEVELS] = "levels",
    [LMB_PHASE_PROBES] = "probes",       [LMB_PHASE_LIGHTMAPS] = "lightmaps",
    [LMB_PHASE_DENOISE] = "denoise",     [LMB_PHASE_WRITE] = "write"};

/* The phases that trace, as records count them. */
static const lmb_bake_phase tracing[] = {LMB_PHASE_PLACE, LMB_PHASE_SURFACE, LMB_PHASE_LEVELS, LMB_PHASE_PROBES,
                                         LMB_PHASE_LIGHTMAPS};
enum { TRACING = sizeof tracing / sizeof tracing[0] };

const char *lmb_bake_phase_name(lmb_bake_phase phase)
{
    return phase_names[phase];
}

lmb_bake_phase lmb_bake_phase_find(const char *name)
{
    int phase = 0;
    while (phase < LMB_PHASE_COUNT && strcmp(phase_names[phase], name) != 0) {
        ++phase;
    }
    return (lmb_bake_phase)phase;
}

uint64_t lmb_bake_record_rays(const lmb_bake_record *record)
{
    uint64_t rays = 0;
    for (int i = 0; i < TRACING; ++i) {
        rays += record->rays[tracing[i]];
    }
    return rays;
}

double lmb_bake_record_mrays_per_s(const lmb_bake_record *record)
{
    double seconds = 0.0;
    for (int i = 0; i < TRACING; ++i) {
        seconds += record->seconds[tracing[i]];
    }
    return seconds > 0.0 ? 1e-6 * (double)lmb_bake_record_rays(record) / seconds : 0.0;
}

/* Dark elements do not count for more than they hold. */
double lmb_bake_record_error(const lmb_bake_record *record)
{
    return lmb_relative_error(record->gathered.squared_error + record->lightmap.squared_error,
                              record->gathered.squared_light + record->lightmap.squared_light);
}

cJSON *lmb_bake_record_json_levels(const lmb_bake_record *record)
{
    cJSON *levels = cJSON_CreateArray();
    for (uint32_t i = 0; i < record->level_count; ++i) {
        cJSON *level = cJSON_CreateObject();
        cJSON_AddNumberToObject(level, "spacing", (double)record->level[i].spacing);
        cJSON_AddNumberToObject(level, "probes", record->level[i].probes);
        cJSON_AddItemToArray(levels, level);
    }
    return levels;
}

static void json_add_elements(cJSON *json, const lmb_bake_record *record)
{
    cJSON_AddNumberToObject(json, "probes", record->probes);
    cJSON_AddItemToObject(json, "levels", lmb_bake_record_json_levels(record));
    if (record->placement.tolerance_scale > 0.0) {
        cJSON_AddNumberToObject(json, "tolerance_scale", record->placement.tolerance_scale);
        cJSON_AddNumberToObject(json, "levels_lost", record->placement.levels_lost);
    }
    cJSON_AddNumberToObject(json, "probes_valid", record->placement.probes_valid);
    cJSON_AddNumberToObject(json, "probes_hanging", record->placement.probes_hanging);
    cJSON_AddNumberToObject(json, "cells", (double)record->placement.cells);
    cJSON_AddNumberToObject(json, "cells_crossed", (double)record->placement.cells_crossed);
    cJSON_AddNumberToObject(json, "cells_cut", (double)record->regions.cells_cut);
    cJSON_AddNumberToObject(json, "ghosts", (double)record->regions.ghosts);
    cJSON_AddNumberToObject(json, "region_points", (double)record->regions.points);
    cJSON_AddNumberToObject(json, "local_sets", record->local_sets);
    cJSON_AddNumberToObject(json, "local_probes", (double)record->local_probes);
    cJSON_AddNumberToObject(json, "texels", (double)record->lightmap.elements);
    cJSON_AddNumberToObject(json, "texels_pushed_out", (double)record->lightmap.moved);
    cJSON_AddNumberToObject(json, "texels_used", record->texels_used);
    cJSON_AddNumberToObject(json, "charts", (double)record->charts);
    cJSON_AddNumberToObject(json, "triangles_dropped", record->triangles_dropped);
    cJSON_AddNumberToObject(json, "samples", (double)(record->gathered.samples + record->lightmap.samples));
}

static void json_add_rays(cJSON *json, const lmb_bake_record *record)
{
    cJSON_AddNumberToObject(json, "rays", (double)lmb_bake_record_rays(record));
    cJSON *rays = cJSON_AddObjectToObject(json, "phase_rays");
    for (int i = 0; i < TRACING; ++i) {
        cJSON_AddNumberToObject(rays, phase_names[tracing[i]], (double)record->rays[tracing[i]]);
    }
}

static void json_add_seconds(cJSON *json, const lmb_bake_record *record)
{
    cJSON *seconds = cJSON_AddObjectToObject(json, "seconds");
    double total = 0.0;
    for (int phase = 0; phase < LMB_PHASE_COUNT; ++phase) {
        if (phase != LMB_PHASE_PILOT && phase != LMB_PHASE_BOUNCES) {
            cJSON_AddNumberToObject(seconds, phase_names[phase], record->seconds[phase]);
        }
        total += record->seconds[phase];
    }
    cJSON_AddNumberToObject(seconds, "total", total);
    cJSON_AddNumberToObject(json, "mrays_per_s", lmb_bake_record_mrays_per_s(record));
}

static void json_add_surface(cJSON *json, const lmb_bake_record *record)
{
    cJSON_AddStringToObject(
        json, "estimator", lmb_estimator_name(record->surface_solved ? LMB_ESTIMATOR_CACHED : LMB_ESTIMATOR_REFERENCE));
    if (record->surface_solved) {
        cJSON_AddNumberToObject(json, "surface_bytes", (double)record->surface_bytes);
        cJSON_AddNumberToObject(json, "surface_cells", record->surface.cells);
        cJSON_AddNumberToObject(json, "surface_cell_m", (double)record->surface_cell_size);
        cJSON_AddNumberToObject(json, "surface_passes", record->surface.passes);
    }
}

static void json_add_key_lights(cJSON *json, const lmb_bake_record *record)
{
    cJSON *list = cJSON_AddArrayToObject(json, "key_lights");
    for (uint32_t i = 0; i < record->key_light_count; ++i) {
        const lmb_key_light *light = &record->key_light[i];
        const float direction[3] = {light->direction.x, light->direction.y, light->direction.z};
        cJSON *object = cJSON_CreateObject();
        cJSON_AddItemToObject(object, "direction", cJSON_CreateFloatArray(direction, 3));
        cJSON_AddItemToObject(object, "irradiance", cJSON_CreateFloatArray(light->irradiance.c, 3));
        cJSON_AddItemToArray(list, object);
    }
}

static void json_add_steps(cJSON *json, const char *name, const lmb_seam_steps *steps)
{
    cJSON *object = cJSON_AddObjectToObject(json, name);
    cJSON_AddNumberToObject(object, "median", steps->median);
    cJSON_AddNumberToObject(object, "p95", steps->p95);
}

static void json_add_content(cJSON *json, const lmb_bake_record *record)
{
    cJSON *object = cJSON_AddObjectToObject(json, "content");
    for (int part = 0; part < LMB_SCENE_PARTS; ++part) {
        char text[17];
        lmb_bake_settings_hash_text(record->content[part], text);
        cJSON_AddStringToObject(object, lmb_scene_part_name((lmb_scene_part)part), text);
    }
}

/* Of a bake of a part of the level. */
static void json_add_part(cJSON *json, const lmb_bake_record *record)
{
    const lmb_vec3d *const low = &record->only[0], *const high = &record->only[1];
    const double box[6] = {low->x, low->y, low->z, high->x, high->y, high->z};
    cJSON_AddItemToObject(json, "only", cJSON_CreateDoubleArray(box, 6));
    cJSON_AddNumberToObject(json, "taken", (double)record->taken);
}

static void json_add_seams(cJSON *json, const lmb_bake_record *record)
{
    cJSON *seams = cJSON_AddObjectToObject(json, "seams");
    cJSON_AddNumberToObject(seams, "edges", (double)record->seams_open.edges);
    json_add_steps(seams, "open", &record->seams_open);
    json_add_steps(seams, "closed", &record->seams_closed);
}

cJSON *lmb_bake_record_json(const lmb_bake_record *record, cJSON *files, cJSON *hashes)
{
    cJSON *json = cJSON_CreateObject();
    json_add_elements(json, record);
    json_add_rays(json, record);
    json_add_seconds(json, record);
    cJSON_AddNumberToObject(json, "peak_rss_mb", record->peak_rss_mb);
    cJSON_AddNumberToObject(json, "threads", record->threads);
    json_add_surface(json, record);
    json_add_key_lights(json, record);
    if (record->settings.lightmaps) {
        json_add_seams(json, record);
    }
    if (record->is_part) {
        json_add_part(json, record);
    }
    cJSON_AddNumberToObject(json, "seed", (double)record->settings.level.seed);
    cJSON *bytes = cJSON_AddObjectToObject(json, "bytes");
    cJSON_AddNumberToObject(bytes, "vdb", (double)record->bytes_vdb);
    cJSON_AddNumberToObject(bytes, "lmb", (double)record->bytes_lmb);
    if (record->tiles > 0) {
        cJSON_AddNumberToObject(bytes, "tiles", (double)record->bytes_tiles);
    }
    cJSON_AddNumberToObject(bytes, "lightmaps", (double)record->bytes_lightmaps);
    cJSON_AddNumberToObject(json, "fp16_overflows", (double)record->fp16_overflows);
    cJSON_AddNumberToObject(json, "estimated_rel_error", lmb_bake_record_error(record));
    if (files) {
        cJSON_AddItemToObject(json, "files", files);
    }
    char key[17];
    lmb_bake_settings_hash_text(record->key, key);
    cJSON_AddStringToObject(json, "key", key);
    json_add_content(json, record);
    if (hashes) {
        cJSON_AddItemToObject(json, "hashes", hashes);
    }
    cJSON_AddItemToObject(json, "settings", lmb_bake_settings_json(&record->settings, record->content_hash));
    return json;
}

char *lmb_bake_record_text(const lmb_bake_record *record)
{
    cJSON *json = lmb_bake_record_json(record, NULL, NULL);
    char *text = cJSON_Print(json);
    cJSON_Delete(json);
    return text;
}
