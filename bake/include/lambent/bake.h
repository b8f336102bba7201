/* A whole bake: from a level's file to probes, lightmaps and the record of them in a folder. docs/baking.md shows it
 * in use ("From C"). */
#ifndef LAMBENT_BAKE_H
#define LAMBENT_BAKE_H

#include <lambent/bake_folder.h>
#include <lambent/bake_record.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How far a bake is. */
typedef struct lmb_bake_progress {
    lmb_bake_phase phase;
    double done;         /* share of the phase, in [0, 1] */
    double seconds_left; /* until all is written, as forecast; negative: not known yet */
} lmb_bake_progress;

/* Who listens to a bake; all zero is silence. Both are called on the thread that called the bake. */
typedef struct lmb_bake_listener {
    /* At the beginning and the end of phases and about ten times a second, but in trials of less than some seconds.
     * Phases come in their order; those that there is nothing to do for are left out. Returning false stops the bake.
     * The last chance for that is LMB_PHASE_WRITE, done: after it the new files take the places of the old ones. */
    bool (*progress)(void *context, const lmb_bake_progress *progress);
    void *context;
    lmb_warnings warnings;
} lmb_bake_listener;

/* How a bake is done, which changes none of its bytes. All zero: all of it, from the beginning. Strings are the
 * caller's. */
typedef struct lmb_bake_work {
    bool resume;                 /* goes on from what an interrupted bake of the same settings has left in the folder */
    bool again;                  /* bakes even where the folder holds this very bake, whole */
    uint32_t shard, shard_count; /* gathers a share alone, and leaves it in the folder; 0 <= shard < shard_count, from 2
                                    on. 0: all */
    const char *const *from;     /* folders of shards, from which what they have gathered is taken */
    uint32_t from_count;
    bool merge;   /* what none of them has is an error, rather than gathered */
    bool prepare; /* leaves in the folder what comes before gathering (placement, light on surfaces), no more */
    bool keep;    /* leaves what was gathered in the folder, for `only` */
    const lmb_vec3d *only; /* [2] a box in the world, least and greatest coordinates: gathers anew what lies in it, and
                              takes the rest from what the earlier bake in the folder has kept; keeps. NULL: all */
    const char *prepared;  /* a folder in which `prepare` left that for the same bake, to be taken; NULL: none */
} lmb_bake_work;

/* Bakes into `folder`, opened for lightmaps if the settings have them: probes.lmb, probes.vdb, lightmap/ and bake.json.
 * On failure the folder is as it was. `listener` and `error` may be NULL; `*record` is set on success, and may be NULL.
 * The same settings give the same bytes for any number of threads (bake.json apart from times, threads and memory).
 * @return what lmb_level_open and the phases of lambent/bake_phases.h return; LMB_ERROR_WRITE; LMB_ERROR_INTERRUPTED
 * (the listener stopped it); LMB_ERROR_ARGUMENT (the folder is not for these settings) */
lmb_result lmb_bake_run(const lmb_bake_settings *settings, lmb_bake_folder *folder, const lmb_bake_listener *listener,
                        lmb_bake_record *record, lmb_error *error);

/* The same, done in pieces. A bake that took more than a second leaves what it gathered in the folder when it fails, is
 * stopped or killed. Where the folder holds this very bake, of this program's version, nothing is done, unless `again`,
 * and `record->is_current` says so; so it is where it is prepared already. A shard writes nothing but what it gathered.
 * @return as above, and LMB_ERROR_UNSUPPORTED (`merge`: a part is missing; `prepared` is of another bake), _IO,
 * _FORMAT, _TRUNCATED, _CHECKSUM (`prepared`, or what is kept); _UNSUPPORTED (`only`: nothing is kept, or of other
 * settings), _ARGUMENT (`only` with a shard or a merge) */
lmb_result lmb_bake_run_as(const lmb_bake_settings *settings, const lmb_bake_work *work, lmb_bake_folder *folder,
                           const lmb_bake_listener *listener, lmb_bake_record *record, lmb_error *error);

/* Where bakes of several sets go. Both are called on the thread that called them. */
typedef struct lmb_bake_set_folders {
    /* Opens the folder of a set, as lmb_bake_run_as takes it. */
    lmb_result (*open)(void *context, const char *set, lmb_bake_folder **folder, lmb_error *error);
    /* Closes it; `record` NULL: the bake failed. */
    void (*close)(void *context, const char *set, lmb_bake_folder *folder, const lmb_bake_record *record);
    void *context;
} lmb_bake_set_folders;

/* Bakes of a level's sets of lights (lambent/light_sets.h), one after another into a folder each, by one loading, one
 * placement of probes and one layout of lightmaps: as lmb_bake_run_as makes each with `level.light_set` and
 * `placed_by_all`, to the byte. `name`: `count` of them, LMB_LIGHT_SET_BASE among them, or, where the count is 0, all
 * that give light. Those that are done when one fails stay. @return as lmb_bake_run_as; what `open` returns;
 * LMB_ERROR_ARGUMENT (the settings are of one set already) */
lmb_result lmb_bake_run_sets(const lmb_bake_settings *settings, const lmb_bake_work *work, const char *const *name,
                             uint32_t count, const lmb_bake_set_folders *folders, const lmb_bake_listener *listener,
                             lmb_error *error);

/* What a shard in that folder was asked for: settings for lmb_bake_run_as. Their strings lie in `*json`, which the
 * caller frees by cJSON_Delete. @return LMB_ERROR_IO, _FORMAT, _MEMORY; then `*json` is NULL */
struct cJSON;
lmb_result lmb_bake_shard_settings(const char *directory, struct cJSON **json, lmb_bake_settings *settings,
                                   lmb_error *error);

/* What the bake would make and how long it would take, without gathering or writing anything: the phases up to the
 * light on surfaces, and a trial. `record->expected_seconds` is of the rest. */
lmb_result lmb_bake_plan(const lmb_bake_settings *settings, const lmb_bake_listener *listener, lmb_bake_record *record,
                         lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
