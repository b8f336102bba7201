/* Several sets of lights of one level, each a bake of its own, by one placement and one layout. */
#include <lambent/bake.h>

#include <stdlib.h>

#include <lambent/light_sets.h>
#include <lambent/scene_content.h>

#include "run/bake_folder_internal.h"
#include "run/bake_internal.h"
#include "run/bake_key.h"
#include "run/bake_work.h"

/* Bakes of one level: what they share is made when the first of them needs it. */
typedef struct sets_work {
    lmb_bake_settings asked; /* of one */
    const lmb_bake_work *work;
    lmb_bake bake;
    lmb_bake_record shared; /* of the phases that all share */
    bool is_prepared;
    lmb_bake_report report;
} sets_work;

static lmb_result set_bake(sets_work *sets, uint32_t set, lmb_bake_folder *folder, lmb_error *error)
{
    lmb_result result = LMB_OK;
    if (!sets->is_prepared) {
        result = lmb_bake_geometry(&sets->bake, &sets->report, error);
        sets->shared = sets->bake.record;
        sets->is_prepared = result == LMB_OK;
    }
    if (result == LMB_OK) {
        result = lmb_bake_show_light_set(&sets->bake, set, &sets->shared, error);
    }
    lmb_bake_record *const record = &sets->bake.record;
    record->settings.level.light_set = sets->asked.level.light_set;
    record->key = lmb_bake_key(&sets->asked, sets->bake.level->scene->content_hash);
    if (result == LMB_OK) {
        lmb_scene_part_hashes(sets->bake.level->scene, record->content);
        result = lmb_bake_light(&sets->bake, &sets->report, error);
    }
    return result == LMB_OK ? lmb_bake_finish(&sets->bake, &sets->asked, sets->work, folder, error) : result;
}

static lmb_result set_run(sets_work *sets, const char *name, const lmb_bake_set_folders *folders, lmb_error *error)
{
    uint32_t set;
    lmb_bake_folder *folder = NULL;
    lmb_result result = lmb_level_find_light_set(sets->bake.level, name, &set, error);
    if (result == LMB_OK) {
        result = folders->open(folders->context, name, &folder, error);
    }
    if (result != LMB_OK) {
        return result;
    }
    sets->asked.level.light_set = name;
    const uint64_t key = lmb_bake_key(&sets->asked, sets->bake.level->scene->content_hash);
    lmb_bake_record done = sets->bake.record;
    done.key = key;
    done.is_current = lmb_bake_work_is_done(sets->work, folder, key);
    if (done.is_current) {
        lmb_bake_folder_drop_parts(folder);
    } else {
        result = set_bake(sets, set, folder, error);
        done = sets->bake.record;
    }
    folders->close(folders->context, name, folder, result == LMB_OK ? &done : NULL);
    return result;
}

/* Those that give light, the one without a name first. */
static uint32_t used_find(const lmb_scene *scene, const char *name[LMB_LIGHT_SETS_MOST + 1])
{
    uint32_t count = 0;
    for (uint32_t set = 0; set <= scene->light_set_count; ++set) {
        if (lmb_scene_light_set_is_used(scene, set)) {
            name[count++] = set == 0 ? LMB_LIGHT_SET_BASE : lmb_scene_light_set_name(scene, set);
        }
    }
    return count;
}

lmb_result lmb_bake_run_sets(const lmb_bake_settings *settings, const lmb_bake_work *work, const char *const *name,
                             uint32_t count, const lmb_bake_set_folders *folders, const lmb_bake_listener *listener,
                             lmb_error *error)
{
    if (!settings->level.path || settings->level.light_set) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, settings->level.path ? "a set of lights alone" : "no level");
    }
    if (work->only || work->keep || work->prepare || work->prepared) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "sets of lights are neither prepared nor baked in part");
    }
    sets_work *const sets = malloc(sizeof *sets);
    if (!sets) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    *sets = (sets_work){.asked = *settings, .work = work};
    sets->asked.placed_by_all = true;
    const lmb_progress progress = lmb_bake_report_begin(&sets->report, listener);
    lmb_level level;
    lmb_result result = lmb_level_open(&settings->level, &sets->report.listener.warnings, &progress, &level, error);
    if (result != LMB_OK) {
        free(sets);
        return result;
    }
    const char *used[LMB_LIGHT_SETS_MOST + 1];
    if (count == 0) {
        count = used_find(level.scene, used);
        name = used;
    }
    for (uint32_t i = 0; i < count && result == LMB_OK; ++i) {
        uint32_t set;
        result = lmb_level_find_light_set(&level, name[i], &set, error);
    }
    sets->bake = lmb_bake_begin(&sets->asked, &level, &progress);
    for (uint32_t i = 0; i < count && result == LMB_OK; ++i) {
        result = set_run(sets, name[i], folders, error);
    }
    lmb_bake_end(&sets->bake);
    lmb_level_close(&level);
    free(sets);
    return result;
}
