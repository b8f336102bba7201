#include <lambent/probes.h>

#include "volume_internal.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/probe_local.h>
#include <lambent/vector.h>
#include <lambent/volume_format.h>

static bool box_is_valid(const lmb_lattice *lattice)
{
    for (int axis = 0; axis < 3; ++axis) {
        if (lattice->size[axis] < 1 || (int64_t)lattice->min[axis] + lattice->size[axis] - 1 > INT32_MAX) {
            return false;
        }
    }
    return isfinite(lattice->spacing) && lattice->spacing > 0.0f;
}

/* All zero, or a rotation. */
static bool axes_are_valid(const lmb_lattice *lattice)
{
    const lmb_vec3d *const x = &lattice->axis[0], *const y = &lattice->axis[1], *const z = &lattice->axis[2];
    bool none = true, orthonormal = true;
    for (int i = 0; i < 3; ++i) {
        const lmb_vec3d *const a = &lattice->axis[i];
        none = none && a->x == 0.0 && a->y == 0.0 && a->z == 0.0;
        for (int k = 0; k <= i; ++k) {
            const lmb_vec3d *const b = &lattice->axis[k];
            const double error = a->x * b->x + a->y * b->y + a->z * b->z - (i == k ? 1.0 : 0.0);
            orthonormal = orthonormal && fabs(error) <= LMB_LATTICE_AXES_ERROR;
        }
    }
    const double determinant =
        x->x * (y->y * z->z - y->z * z->y) + x->y * (y->z * z->x - y->x * z->z) + x->z * (y->x * z->y - y->y * z->x);
    return none || (orthonormal && determinant > 0.0);
}

/* ---------------------------------------------------------------------------------------- finding probes */

/* The block of a point, and its index within it. */
static unsigned block_of(const int32_t point[3], int32_t at[3])
{
    unsigned within = 0;
    for (int axis = 2; axis >= 0; --axis) {
        const int32_t rest = (int32_t)((uint32_t)point[axis] % LMB_PROBE_BLOCK); /* 2^32 is a multiple of 4 */
        at[axis] = (int32_t)(((int64_t)point[axis] - rest) / LMB_PROBE_BLOCK);
        within = within * LMB_PROBE_BLOCK + (unsigned)rest;
    }
    return within;
}

static uint32_t block_hash(const int32_t at[3])
{
    uint64_t hash = (uint32_t)at[0];
    hash = (hash ^ (uint32_t)at[1]) * UINT64_C(0x9e3779b97f4a7c15);
    hash = (hash ^ (hash >> 29) ^ (uint32_t)at[2]) * UINT64_C(0xbf58476d1ce4e5b9);
    return (uint32_t)(hash >> 32);
}

/* The slot that a block has, or is to have. */
static uint32_t slot_find(const lmb_probe_index *index, const int32_t at[3])
{
    uint32_t slot = block_hash(at) & (index->slot_count - 1);
    while (index->slot[slot] != 0 && memcmp(index->block[index->slot[slot] - 1].at, at, 3 * sizeof *at) != 0) {
        slot = (slot + 1) & (index->slot_count - 1);
    }
    return slot;
}

/* Makes twice the slots. */
static bool slots_grow(lmb_probe_index *index)
{
    lmb_probe_index grown = *index;
    grown.slot_count = index->slot_count > 0 ? 2 * index->slot_count : 16;
    grown.slot = calloc(grown.slot_count, sizeof *grown.slot);
    if (!grown.slot) {
        return false;
    }
    for (uint32_t i = 0; i < index->block_count; ++i) {
        grown.slot[slot_find(&grown, index->block[i].at)] = i + 1;
    }
    free(index->slot);
    *index = grown;
    return true;
}

/* The block at `at`, made if there is none; NULL: no memory. Room for blocks doubles with every power of two. */
static lmb_probe_block *block_make(lmb_probe_index *index, const int32_t at[3])
{
    if (2 * index->block_count >= index->slot_count && !slots_grow(index)) {
        return NULL;
    }
    const uint32_t slot = slot_find(index, at);
    if (index->slot[slot] != 0) {
        return &index->block[index->slot[slot] - 1];
    }
    if ((index->block_count & (index->block_count - 1)) == 0) {
        const size_t room = index->block_count > 0 ? 2 * (size_t)index->block_count : 1;
        lmb_probe_block *const more = realloc(index->block, room * sizeof *more);
        if (!more) {
            return NULL;
        }
        index->block = more;
    }
    lmb_probe_block *const made = &index->block[index->block_count];
    memcpy(made->at, at, sizeof made->at);
    memset(made->probe, 0xff, sizeof made->probe); /* -1 everywhere */
    index->slot[slot] = ++index->block_count;
    return made;
}

void lmb_probe_index_free(lmb_probe_index *index)
{
    free(index->block);
    free(index->slot);
    *index = (lmb_probe_index){0};
}

lmb_result lmb_probe_index_add(lmb_probe_index *index, const int32_t point[3], int32_t probe)
{
    assert(index && probe >= 0);
    int32_t at[3];
    const unsigned within = block_of(point, at);
    lmb_probe_block *const block = block_make(index, at);
    if (!block) {
        return LMB_ERROR_MEMORY;
    }
    if (block->probe[within] >= 0) {
        return LMB_ERROR_ARGUMENT;
    }
    block->probe[within] = probe;
    return LMB_OK;
}

const lmb_probe_block *lmb_probe_index_block(const lmb_probe_index *index, const int32_t at[3])
{
    const uint32_t block = index->slot_count > 0 ? index->slot[slot_find(index, at)] : 0;
    return block > 0 ? &index->block[block - 1] : NULL;
}

int32_t lmb_probe_index_find(const lmb_probe_index *index, const int32_t point[3])
{
    int32_t at[3];
    const unsigned within = block_of(point, at);
    const lmb_probe_block *const block = lmb_probe_index_block(index, at);
    return block ? block->probe[within] : -1;
}

/* @return LMB_ERROR_ARGUMENT: a point twice, or outside of the lattice */
static lmb_result index_make(const lmb_lattice *lattice, const int32_t (*point)[3], int32_t first, int32_t count,
                             lmb_probe_index *index)
{
    lmb_result result = LMB_OK;
    for (int32_t i = 0; i < count && result == LMB_OK; ++i) {
        result =
            lmb_lattice_has(lattice, point[i]) ? lmb_probe_index_add(index, point[i], first + i) : LMB_ERROR_ARGUMENT;
    }
    return result;
}

/* ------------------------------------------------------------------------------------------- the arrays */

lmb_result lmb_probes_create(lmb_probes **probes)
{
    lmb_probes *const created = calloc(1, sizeof *created);
    if (created) {
        created->set_count = 1;
        created->radiance = calloc(created->set_count, sizeof *created->radiance);
    }
    if (!created || !created->radiance) {
        free(created);
        return LMB_ERROR_MEMORY;
    }
    *probes = created;
    return LMB_OK;
}

/* Makes an array longer, with zeros at its end; NULL and the array as it was when out of memory. */
static void *array_grow(void *array, size_t size, size_t count, size_t added)
{
    unsigned char *const grown = realloc(array, (count + added + 1) * size);
    if (grown) {
        memset(grown + count * size, 0, added * size);
    }
    return grown;
}

/* Room for more probes in all arrays. */
static bool arrays_grow(lmb_probes *probes, int32_t added)
{
    const size_t count = (size_t)probes->count, more = (size_t)added;
    int32_t(*const point)[3] = array_grow(probes->point, sizeof *point, count, more);
    probes->point = point ? point : probes->point;
    float *const validity = array_grow(probes->validity, sizeof *validity, count, more);
    probes->validity = validity ? validity : probes->validity;
    float(*const seen)[LMB_KEY_LIGHTS_MOST] = array_grow(probes->key_visibility, sizeof *seen, count, more);
    probes->key_visibility = seen ? seen : probes->key_visibility;
    uint8_t *const hanging = array_grow(probes->hanging, sizeof *hanging, count, more);
    probes->hanging = hanging ? hanging : probes->hanging;
    bool good = point && validity && seen && hanging;
    for (uint32_t set = 0; set < probes->set_count; ++set) {
        lmb_sh3_rgb *const radiance = array_grow(probes->radiance[set], sizeof *radiance, count, more);
        probes->radiance[set] = radiance ? radiance : probes->radiance[set];
        good = good && radiance;
    }
    return good;
}

static bool levels_grow(lmb_probes *probes)
{
    lmb_probe_level *const level = array_grow(probes->level, sizeof *level, probes->level_count, 1);
    probes->level = level ? level : probes->level;
    return level != NULL;
}

lmb_result lmb_probes_add_level(lmb_probes *probes, const lmb_lattice *lattice, const int32_t (*point)[3],
                                int32_t count)
{
    assert(probes && lattice && (point || count == 0));
    if (!box_is_valid(lattice) || !axes_are_valid(lattice) || count < 0 || count > INT32_MAX - probes->count ||
        probes->ghost_count > 0) {
        return LMB_ERROR_ARGUMENT;
    }
    lmb_probe_level added = {.lattice = *lattice, .first = probes->count, .count = count};
    lmb_result result = index_make(lattice, point, probes->count, count, &added.index);
    if (result == LMB_OK && !(levels_grow(probes) && arrays_grow(probes, count))) {
        result = LMB_ERROR_MEMORY;
    }
    if (result != LMB_OK) {
        lmb_probe_index_free(&added.index);
        return result;
    }
    if (count > 0) {
        memcpy(probes->point + probes->count, point, (size_t)count * sizeof *point);
    }
    probes->count += count;
    probes->level[probes->level_count++] = added;
    return LMB_OK;
}

lmb_result lmb_probes_add_ghosts(lmb_probes *probes, uint32_t level, const int32_t (*point)[3], int32_t count,
                                 int32_t *first)
{
    assert(probes && level < probes->level_count && (point || count == 0) && first);
    lmb_probe_level *const own = &probes->level[level];
    if (own->ghost_count > 0 || count < 0 || count > INT32_MAX - probes->count) {
        return LMB_ERROR_ARGUMENT;
    }
    for (int32_t i = 0; i < count; ++i) {
        if (!lmb_lattice_has(&own->lattice, point[i])) {
            return LMB_ERROR_ARGUMENT;
        }
    }
    if (!arrays_grow(probes, count)) {
        return LMB_ERROR_MEMORY;
    }
    if (count > 0) {
        memcpy(probes->point + probes->count, point, (size_t)count * sizeof *point);
    }
    own->ghost_first = *first = probes->count;
    own->ghost_count = count;
    probes->ghost_count += count;
    probes->count += count;
    return LMB_OK;
}

lmb_result lmb_probes_add_set(lmb_probes *probes, uint32_t *set)
{
    assert(probes && set);
    if (probes->set_count == UINT32_MAX) {
        return LMB_ERROR_ARGUMENT;
    }
    lmb_sh3_rgb *const dark = array_grow(NULL, sizeof *dark, 0, (size_t)probes->count);
    lmb_sh3_rgb **const radiance =
        dark ? realloc(probes->radiance, ((size_t)probes->set_count + 1) * sizeof *radiance) : NULL;
    if (!radiance) {
        free(dark);
        return LMB_ERROR_MEMORY;
    }
    radiance[probes->set_count] = dark;
    probes->radiance = radiance;
    *set = probes->set_count++;
    return LMB_OK;
}

void lmb_probes_clear_light(lmb_probes *probes)
{
    assert(probes);
    for (uint32_t set = 0; set < probes->set_count; ++set) {
        for (int32_t i = 0; i < probes->count; ++i) {
            probes->radiance[set][i] = (lmb_sh3_rgb){0};
        }
    }
    for (int32_t i = 0; i < probes->count; ++i) {
        memset(probes->key_visibility[i], 0, sizeof probes->key_visibility[i]);
    }
    probes->key_light_count = 0;
    lmb_probes_free_locals(probes);
    probes->local = NULL;
    probes->local_count = 0;
}

void lmb_probes_destroy(lmb_probes *probes)
{
    if (!probes) {
        return;
    }
    for (uint32_t i = 0; i < probes->level_count; ++i) {
        lmb_probe_index_free(&probes->level[i].index);
        lmb_probe_index_free(&probes->level[i].cut);
    }
    free(probes->cut.cell);
    free(probes->cut.plane);
    free(probes->cut.corner);
    for (uint32_t set = 0; set < probes->set_count; ++set) {
        free(probes->radiance[set]);
    }
    lmb_probes_free_locals(probes);
    free(probes->point);
    free(probes->validity);
    free(probes->hanging);
    free(probes->key_visibility);
    free(probes->radiance);
    free(probes->level);
    free(probes);
}

int32_t lmb_probes_find(const lmb_probes *probes, uint32_t level, int32_t x, int32_t y, int32_t z)
{
    assert(probes && level < probes->level_count);
    return lmb_probe_index_find(&probes->level[level].index, (const int32_t[3]){x, y, z});
}

const lmb_probe_level *lmb_probes_level_of(const lmb_probes *probes, int32_t probe)
{
    assert(probes && probe >= 0 && probe < probes->count);
    const lmb_probe_level *level = probes->level;
    const bool is_ghost = probe >= probes->count - probes->ghost_count;
    while (is_ghost ? probe < level->ghost_first || probe >= level->ghost_first + level->ghost_count
                    : probe >= level->first + level->count) {
        ++level;
    }
    return level;
}

lmb_vec3 lmb_probes_position(const lmb_probes *probes, int32_t probe)
{
    const lmb_vec3d world = lmb_lattice_position(&lmb_probes_level_of(probes, probe)->lattice, probes->point[probe]);
    return (lmb_vec3){(float)(world.x - probes->origin.x), (float)(world.y - probes->origin.y),
                      (float)(world.z - probes->origin.z)};
}

float lmb_probes_footprint(const lmb_probes *probes, int32_t probe)
{
    return lmb_probes_level_of(probes, probe)->lattice.spacing;
}

float lmb_probes_scale(const lmb_probes *probes)
{
    float largest = lmb_probes_locals_largest(probes);
    for (uint32_t set = 0; set < probes->set_count; ++set) {
        for (int32_t probe = 0; probe < probes->count; ++probe) {
            for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
                const lmb_sh3 *channel = probes->radiance[set][probe].channel;
                largest = fmaxf(largest, fabsf(channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT]));
            }
        }
    }
    return fminf(lmb_half_scale(largest), ldexpf(1.0f, LMB_VOLUME_MAX_SCALE_LOG2));
}

/* -------------------------------------------------------------------------------------------- the walker */

static lmb_result validate_block(const lmb_probes *probes, const lmb_probe_level *level, const lmb_probe_block *block,
                                 int64_t *found, lmb_error *error)
{
    for (int within = 0; within < LMB_PROBE_BLOCK_POINTS; ++within) {
        const int32_t probe = block->probe[within];
        const int64_t at[3] = {(int64_t)block->at[0] * LMB_PROBE_BLOCK + within % LMB_PROBE_BLOCK,
                               (int64_t)block->at[1] * LMB_PROBE_BLOCK + within / LMB_PROBE_BLOCK % LMB_PROBE_BLOCK,
                               (int64_t)block->at[2] * LMB_PROBE_BLOCK + within / LMB_PROBE_BLOCK / LMB_PROBE_BLOCK};
        if (probe == -1) {
            continue;
        }
        if (probe < level->first || probe >= level->first + level->count) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: point (%lld, %lld, %lld) names probe %d of %d",
                                 (long long)at[0], (long long)at[1], (long long)at[2], probe, probes->count);
        }
        const int32_t *const point = probes->point[probe];
        if (point[0] != at[0] || point[1] != at[1] || point[2] != at[2] || !lmb_lattice_has(&level->lattice, point)) {
            return lmb_error_set(
                error, LMB_ERROR_FORMAT, "probes: point (%lld, %lld, %lld) names probe %d, which is at (%d, %d, %d)",
                (long long)at[0], (long long)at[1], (long long)at[2], probe, point[0], point[1], point[2]);
        }
        ++*found;
    }
    return LMB_OK;
}

static lmb_result validate_level(const lmb_probes *probes, const lmb_probe_level *level, lmb_error *error)
{
    const lmb_lattice *lattice = &level->lattice;
    if (!box_is_valid(lattice)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT,
                             "probes: spacing %g, or box of %d x %d x %d at (%d, %d, %d), is out of range",
                             (double)lattice->spacing, lattice->size[0], lattice->size[1], lattice->size[2],
                             lattice->min[0], lattice->min[1], lattice->min[2]);
    }
    if (!axes_are_valid(lattice)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: axes of a level are not orthonormal and right-handed");
    }
    int64_t found = 0;
    for (uint32_t i = 0; i < level->index.block_count; ++i) {
        const lmb_result result = validate_block(probes, level, &level->index.block[i], &found, error);
        if (result != LMB_OK) {
            return result;
        }
    }
    /* A probe has one point, so none is found twice: an equal count means that none is lost. */
    if (found != level->count) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: %d of a level, but %lld points with one", level->count,
                             (long long)found);
    }
    return LMB_OK;
}

static lmb_result validate_probe(const lmb_probes *probes, int32_t probe, lmb_error *error)
{
    for (uint32_t set = 0; set < probes->set_count; ++set) {
        for (int k = 0; k < 3 * LMB_SH3_COUNT; ++k) {
            const int channel = k / LMB_SH3_COUNT, i = k % LMB_SH3_COUNT;
            const float value = probes->radiance[set][probe].channel[channel].c[i];
            if (!isfinite(value)) {
                return lmb_error_set(error, LMB_ERROR_FORMAT,
                                     "probes: set %u, probe %d: coefficient %d of channel %d is %g", set, probe, i,
                                     channel, (double)value);
            }
        }
    }
    for (uint32_t key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
        const float seen = probes->key_visibility[probe][key];
        if (!(seen >= 0.0f && seen <= (key < probes->key_light_count ? 1.0f : 0.0f))) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: probe %d: %g of key light %u is seen", probe,
                                 (double)seen, key);
        }
    }
    const float validity = probes->validity[probe];
    if (!(validity >= 0.0f && validity <= 1.0f)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: probe %d: validity is %g, outside 0 to 1", probe,
                             (double)validity);
    }
    if (!lmb_probes_hanging_is_sane(probes, probe)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: probe %d hangs on a level that is not there", probe);
    }
    return LMB_OK;
}

bool lmb_probes_key_lights_are_sane(const lmb_probes *probes)
{
    bool sane = probes->key_light_count <= LMB_KEY_LIGHTS_MOST;
    for (uint32_t key = 0; sane && key < probes->key_light_count; ++key) {
        const lmb_key_light *light = &probes->key_light[key];
        sane = fabsf(lmb_vec3_length(light->direction) - 1.0f) <= 1e-5f;
        for (int c = 0; c < 3; ++c) {
            sane = sane && light->irradiance.c[c] >= 0.0f && isfinite(light->irradiance.c[c]);
        }
    }
    return sane;
}

static bool arrays_are_whole(const lmb_probes *probes)
{
    bool whole = probes->count >= 0 && probes->set_count > 0 && probes->radiance;
    if (probes->count > 0) {
        whole = whole && probes->point && probes->validity && probes->hanging && probes->key_visibility;
        for (uint32_t set = 0; whole && set < probes->set_count; ++set) {
            whole = probes->radiance[set] != NULL;
        }
    }
    return whole;
}

lmb_result lmb_probes_validate(const lmb_probes *probes, lmb_error *error)
{
    assert(probes);
    if (!arrays_are_whole(probes)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: %d without all of their arrays", probes->count);
    }
    int64_t next = 0;
    for (uint32_t i = 0; i < probes->level_count; ++i) {
        const lmb_probe_level *level = &probes->level[i];
        if (level->first != next || level->count < 0 || next + level->count > probes->count - probes->ghost_count) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: level %u has probes %d to %lld of %d", i,
                                 level->first, (long long)level->first + level->count - 1, probes->count);
        }
        const lmb_result result = validate_level(probes, level, error);
        if (result != LMB_OK) {
            return result;
        }
        next += level->count;
    }
    next += probes->ghost_count;
    if (next != probes->count) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: %d, but %lld of levels", probes->count, (long long)next);
    }
    if (!lmb_probes_cuts_are_sane(probes)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "probes: a cut cell names probes or planes that are not its own");
    }
    if (!lmb_probes_key_lights_are_sane(probes)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT,
                             "probes: a key light has no direction or no irradiance, or there "
                             "are more than four");
    }
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        if (validate_probe(probes, probe, error) != LMB_OK) {
            return LMB_ERROR_FORMAT;
        }
    }
    return lmb_probes_validate_locals(probes, error);
}
