#include "run/prepared.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include "probes/placement_stored.h"
#include "run/bake_level_internal.h"
#include "run/bake_phases_record.h"

/* What the file begins with. As parts are, it is of machines of one kind. */
typedef struct prepared_head {
    char magic[8];
    uint64_t version;
    uint64_t key;
    uint64_t size;     /* of what follows */
    uint64_t checksum; /* likewise */
} prepared_head;

static const char magic[8] = "LMBPREP";
enum { PREPARED_VERSION = 3 };

static void placement_stats_move(lmb_stored *stored, lmb_placement_stats *stats)
{
    uint8_t flags = (uint8_t)(stats->seeds_in_solid | stats->everything_solid << 1);
    LMB_STORED(stored, stats->probes_valid);
    LMB_STORED(stored, stats->probes_dilated);
    LMB_STORED(stored, stats->probes_hanging);
    LMB_STORED(stored, stats->cells);
    LMB_STORED(stored, stats->cells_crossed);
    LMB_STORED(stored, stats->rays);
    LMB_STORED(stored, flags);
    LMB_STORED(stored, stats->tolerance_scale);
    LMB_STORED(stored, stats->levels_lost);
    stats->seeds_in_solid = (flags & 1) != 0;
    stats->everything_solid = (flags & 2) != 0;
}

/* What the record says of these phases, settings as they were used among it. */
static void record_move(lmb_stored *stored, lmb_bake_record *record)
{
    LMB_STORED(stored, record->settings.spacing);
    LMB_STORED(stored, record->settings.min_spacing);
    lmb_stored_value(stored, record->settings.seeds, record->settings.seed_count * sizeof *record->settings.seeds);
    placement_stats_move(stored, &record->placement);
    LMB_STORED(stored, record->regions); /* numbers of eight bytes */
    LMB_STORED(stored, record->rays[LMB_PHASE_PLACE]);
    LMB_STORED(stored, record->rays[LMB_PHASE_LEVELS]);
}

static void probes_write(const lmb_bake *bake, lmb_stored *stored)
{
    lmb_bake_record record = bake->record;
    uint8_t has_probes = bake->probes != NULL;
    LMB_STORED(stored, has_probes);
    record_move(stored, &record);
    if (has_probes) {
        lmb_placement_write(bake->probes, bake->regions, stored);
    }
}

static lmb_result probes_read(lmb_bake *bake, lmb_stored *stored)
{
    uint8_t has_probes;
    LMB_STORED(stored, has_probes);
    record_move(stored, &bake->record);
    if (!lmb_stored_expect(stored, has_probes == !bake->record.settings.no_probes)) {
        return stored->result;
    }
    if (has_probes) {
        const lmb_result result = lmb_placement_read(stored, bake->level->scene->origin, &bake->probes, &bake->regions);
        if (result != LMB_OK) {
            return result;
        }
        lmb_bake_record_levels(bake);
    }
    return LMB_OK;
}

lmb_result lmb_bake_prepared_write(const lmb_bake *bake, const char *directory, lmb_error *error)
{
    lmb_stored stored = {.reads = false};
    prepared_head head = {.version = PREPARED_VERSION, .key = bake->record.key};
    memcpy(head.magic, magic, sizeof magic);
    LMB_STORED(&stored, head);
    probes_write(bake, &stored);
    lmb_level_write_surface(bake->level, &stored);
    char *const path = lmb_file_in(directory, LMB_PREPARED_NAME);
    lmb_result result = path && stored.result == LMB_OK ? LMB_OK : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        head.size = stored.size - sizeof head;
        head.checksum = lmb_hash(LMB_HASH_SEED, stored.data + sizeof head, (size_t)head.size);
        memcpy(stored.data, &head, sizeof head);
        result = lmb_file_write(path, stored.data, stored.size, error);
    } else {
        lmb_error_set(error, result, "out of memory");
    }
    free(path);
    lmb_stored_free(&stored);
    return result;
}

/* Why the file is none that may be read on. */
static lmb_result head_check(const unsigned char *data, size_t size, uint64_t key)
{
    prepared_head head;
    if (size < sizeof head) {
        return LMB_ERROR_TRUNCATED;
    }
    memcpy(&head, data, sizeof head);
    if (memcmp(head.magic, magic, sizeof magic) != 0) {
        return LMB_ERROR_FORMAT;
    }
    if (head.version != PREPARED_VERSION || head.key != key) {
        return LMB_ERROR_UNSUPPORTED;
    }
    if (head.size != size - sizeof head) {
        return LMB_ERROR_TRUNCATED;
    }
    return head.checksum == lmb_hash(LMB_HASH_SEED, data + sizeof head, size - sizeof head) ? LMB_OK
                                                                                            : LMB_ERROR_CHECKSUM;
}

/* Of the folder's file: all of it, with the head. */
static lmb_result file_read(const char *path, uint64_t key, unsigned char **data, size_t *size, lmb_error *error)
{
    lmb_result result = lmb_file_read(path, data, size, error);
    if (result == LMB_OK) {
        result = head_check(*data, *size, key);
        if (result == LMB_ERROR_UNSUPPORTED) {
            lmb_error_set(error, result,
                          "%s: prepared for another level or other settings, or by another version of Lambent", path);
        } else if (result != LMB_OK) {
            lmb_error_set(error, result, "%s: %s", path, lmb_result_text(result));
        }
    }
    return result;
}

bool lmb_bake_prepared_is_current(const char *directory, uint64_t key)
{
    char *const path = lmb_file_in(directory, LMB_PREPARED_NAME);
    unsigned char *data = NULL;
    size_t size = 0;
    const bool current = path && file_read(path, key, &data, &size, NULL) == LMB_OK;
    free(data);
    free(path);
    return current;
}

/* Of a file that is whole. */
static lmb_result contents_read(lmb_bake *bake, unsigned char *data, size_t size)
{
    lmb_stored stored = lmb_stored_of(data, size);
    lmb_result result = probes_read(bake, &stored);
    if (result == LMB_OK) {
        result = lmb_level_read_surface(bake->level, &stored, NULL);
    }
    if (result == LMB_OK && !lmb_stored_expect(&stored, stored.at == size)) {
        result = stored.result;
    }
    if (result == LMB_OK) {
        lmb_bake_record_surface(bake);
    }
    return result;
}

lmb_result lmb_bake_prepared_read(lmb_bake *bake, const char *directory, lmb_error *error)
{
    char *const path = lmb_file_in(directory, LMB_PREPARED_NAME);
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_result result = path ? file_read(path, bake->record.key, &data, &size, error)
                             : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    if (result == LMB_OK) {
        result = contents_read(bake, data + sizeof(prepared_head), size - sizeof(prepared_head));
        if (result != LMB_OK) {
            lmb_error_set(error, result, "%s: %s", path, lmb_result_text(result));
        }
    }
    free(data);
    free(path);
    return result;
}
