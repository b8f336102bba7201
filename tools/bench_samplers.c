#include "bench_samplers.h"

#include <pthread.h>

#include "bench_cut.h"
#include "bench_dense.h"
#include "bench_forms.h"
#include "bench_grids.h"
#include "bench_tiles.h"

/* Samplers that are made together, of probes that nobody changes meanwhile. */
typedef struct part {
    const lmb_probes *probes;
    const lmb_volume *volume; /* as bench_samplers_create has it */
    lmb_result result;
    int count;
    lmb_bench_sampler sampler[4];
} part;

static void *own_make(void *context)
{
    static const char *const names[2] = {"lambent", "lambent.batch"};
    part *const own = context;
    if (own->volume) {
        const double bytes = (double)lmb_volume_get_info(own->volume).file_bytes;
        void *const data = (void *)own->volume; /* which is not written */
        own->sampler[0] = (lmb_bench_sampler){names[0], data, bytes, bench_sample_single, NULL};
        own->sampler[1] = (lmb_bench_sampler){names[1], data, bytes, bench_sample_batch, NULL};
    } else {
        own->result = bench_form_create(own->probes, LMB_VOLUME_HALFS, names, own->sampler);
    }
    own->count = own->result == LMB_OK ? 2 : 0;
    return NULL;
}

static void *dense_make(void *context)
{
    part *const dense = context;
    dense->result = bench_dense_create(dense->probes, dense->sampler);
    dense->count = dense->result == LMB_OK ? BENCH_DENSE_SAMPLERS : 0;
    dense->result = dense->result == LMB_ERROR_ARGUMENT ? LMB_OK : dense->result; /* too large: it goes without */
    return NULL;
}

static void *grids_make(void *context)
{
    part *const grids = context;
    grids->count = bench_grids_create(grids->probes, grids->sampler);
    grids->result = grids->count > 0 ? LMB_OK : LMB_ERROR_MEMORY;
    return NULL;
}

static void *compact_make(void *context)
{
    static const char *const names[2] = {"lambent.compact", "lambent.compact.batch"};
    part *const compact = context;
    compact->result = bench_form_create(compact->probes, LMB_VOLUME_COMPACT, names, compact->sampler);
    compact->count = compact->result == LMB_OK ? 2 : 0;
    return NULL;
}

static void *cut_make(void *context)
{
    static const char *const names[2] = {"lambent.cut", "lambent.cut.batch"};
    part *const cut = context;
    lmb_probes *const probes = bench_cut_probes(cut->probes);
    cut->result = probes ? bench_form_create(probes, LMB_VOLUME_HALFS, names, cut->sampler) : LMB_ERROR_MEMORY;
    cut->count = cut->result == LMB_OK ? 2 : 0;
    lmb_probes_destroy(probes);
    return NULL;
}

static void *tiles_make(void *context)
{
    static const char *const names[2] = {"lambent.tiles", "lambent.tiles.batch"};
    part *const tiles = context;
    tiles->result = bench_tiles_create(tiles->probes, names, tiles->sampler);
    tiles->count = tiles->result == LMB_OK ? 2 : 0;
    return NULL;
}

enum { OWN, DENSE, GRIDS, COMPACT, CUT, TILES, PARTS };

/* Hands a part's samplers on. @return its result */
static lmb_result part_take(const part *made, lmb_bench_samplers *samplers)
{
    for (int i = 0; i < made->count; ++i) {
        samplers->sampler[samplers->count++] = made->sampler[i];
    }
    return made->result;
}

/* @return false where a thread cannot be started */
static bool parts_make(part made[PARTS])
{
    static void *(*const make[PARTS])(void *) = {own_make, dense_make, grids_make, compact_make, cut_make, tiles_make};
    pthread_t thread[PARTS];
    int started = 0;
    while (started < PARTS && pthread_create(&thread[started], NULL, make[started], &made[started]) == 0) {
        ++started;
    }
    for (int i = 0; i < started; ++i) {
        pthread_join(thread[i], NULL);
    }
    return started == PARTS;
}

lmb_result bench_samplers_create(const lmb_probes *probes, const lmb_volume *volume, lmb_bench_samplers *samplers,
                                 lmb_error *error)
{
    static const char *const names[PARTS] = {
        "the volume",         "dense arrays", "OpenVDB's grids", "the compact volume", "the volume with cut cells",
        "the volume in tiles"};
    part made[PARTS];
    *samplers = (lmb_bench_samplers){0};
    for (int i = 0; i < PARTS; ++i) {
        made[i] = (part){.probes = probes, .volume = volume};
    }
    lmb_result result = LMB_OK;
    if (!parts_make(made)) {
        result = lmb_error_set(error, LMB_ERROR_ARGUMENT, "%d threads cannot be started", PARTS);
    }
    for (int i = 0; i < PARTS; ++i) {
        const lmb_result of_part = part_take(&made[i], samplers);
        if (result == LMB_OK && of_part != LMB_OK) {
            result = lmb_error_set(error, of_part, "%s: %s", names[i], lmb_result_text(of_part));
        }
    }
    samplers->dense_kernel = made[DENSE].count > 0 ? bench_dense_kernel_name() : NULL;
    samplers->has_nanovdb = made[GRIDS].count == BENCH_GRID_SAMPLERS;
    if (result != LMB_OK) {
        bench_samplers_destroy(samplers);
    }
    return result;
}

void bench_samplers_destroy(lmb_bench_samplers *samplers)
{
    for (int i = 0; i < samplers->count; ++i) {
        bench_sampler_destroy(&samplers->sampler[i]);
    }
    samplers->count = 0;
}
