#include "leaks_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/pack.h>
#include <lambent/vector.h>

lmb_result leaks_level_open(const lmb_leak_scene *scene, const char *path, int threads, leaks_level *level,
                            lmb_error *error)
{
    lmb_result result = lmb_leak_scene_write(scene, path, error);
    if (result != LMB_OK) {
        return result;
    }
    lmb_level_settings settings = lmb_level_settings_default();
    settings.path = path;
    settings.threads = threads;
    level->scene = scene;
    result = lmb_level_open(&settings, NULL, NULL, &level->level, error);
    if (result == LMB_OK) {
        result = lmb_level_solve(&level->level, LMB_ESTIMATOR_CACHED, NULL, error);
        if (result != LMB_OK) {
            lmb_level_close(&level->level);
        }
    }
    return result;
}

void leaks_level_close(leaks_level *level)
{
    lmb_level_close(&level->level);
}

/* Probes without what was cut and fitted. */
static lmb_result probes_plain(const lmb_probes *from, lmb_probes **plain)
{
    lmb_result result = lmb_probes_create(plain);
    if (result == LMB_OK) {
        const lmb_probe_level *const level = &from->level[0];
        result = lmb_probes_add_level(*plain, &level->lattice, (const int32_t(*)[3])from->point, level->count);
    }
    if (result == LMB_OK) {
        memcpy((*plain)->validity, from->validity, (size_t)(*plain)->count * sizeof *from->validity);
        memcpy((*plain)->radiance[0], from->radiance[0], (size_t)(*plain)->count * sizeof *from->radiance[0]);
        result = lmb_probes_dilate(*plain);
    }
    return result;
}

/* What follows from baked probes. */
static lmb_result field_finish(leaks_field *field, lmb_error *error)
{
    const lmb_result made = probes_plain(field->bake.probes, &field->probes);
    if (made != LMB_OK) {
        return lmb_error_set(error, made, "out of memory for probes");
    }
    const lmb_probes *probes = field->probes;
    field->effort = lmb_bake_effort(&field->bake.record.settings, field->level);
    field->place = malloc(((size_t)probes->count + 1) * sizeof *field->place);
    if (!field->place) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for probes");
    }
    uint64_t rays = 0;
    for (int32_t i = 0; i < probes->count; ++i) {
        field->place[i] = lmb_placement_relocate(field->level->tracer, lmb_probes_position(probes, i),
                                                 lmb_probes_footprint(probes, i), &rays);
    }
    lmb_result result = lmb_pack(probes, &field->packed, &field->packed_bytes, NULL);
    if (result == LMB_OK) {
        result = lmb_volume_open_memory(field->packed, field->packed_bytes, &field->volume);
    }
    return result == LMB_OK ? result : lmb_error_set(error, result, "packing: %s", lmb_result_text(result));
}

lmb_result leaks_field_bake(leaks_level *level, float spacing, uint32_t samples, leaks_field *field, lmb_error *error)
{
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.level = level->level.settings;
    settings.spacing = spacing;
    settings.samples = settings.max_samples = samples;
    *field = (leaks_field){.level = &level->level, .bake = lmb_bake_begin(&settings, &level->level, NULL)};
    lmb_result result = lmb_bake_place(&field->bake, error);
    if (result == LMB_OK) {
        result = lmb_bake_probes(&field->bake, error);
    }
    if (result == LMB_OK) {
        result = field_finish(field, error);
    }
    if (result != LMB_OK) {
        leaks_field_free(field);
    }
    return result;
}

void leaks_field_free(leaks_field *field)
{
    lmb_volume_close(field->volume);
    free(field->packed);
    free(field->place);
    lmb_probes_destroy(field->probes);
    lmb_bake_end(&field->bake);
    *field = (leaks_field){.level = NULL};
}

void leaks_cells_along(const leaks_field *field, int32_t along[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        along[axis] = field->probes->level[0].lattice.size[axis] - 1;
    }
}

leaks_cell leaks_cell_at(const leaks_field *field, const int32_t at[3])
{
    const int32_t *const min = field->probes->level[0].lattice.min;
    leaks_cell cell = {.at = {at[0], at[1], at[2]}};
    for (int i = 0; i < 8; ++i) {
        cell.probe[i] = lmb_probes_find(field->probes, 0, min[0] + at[0] + (i & 1), min[1] + at[1] + (i >> 1 & 1),
                                        min[2] + at[2] + (i >> 2));
    }
    return cell;
}

leaks_cell leaks_cell_of(const leaks_field *field, lmb_vec3 position)
{
    const lmb_lattice *const lattice = &field->probes->level[0].lattice;
    const double inverse = 1.0 / (double)lattice->spacing;
    const double from[3] = {(double)position.x * inverse, (double)position.y * inverse, (double)position.z * inverse};
    int32_t at[3];
    float t[3];
    for (int axis = 0; axis < 3; ++axis) {
        const int32_t last = lattice->size[axis] - 1;
        const double within = fmin(fmax(from[axis] - lattice->min[axis], 0.0), last);
        at[axis] = (int32_t)within < last ? (int32_t)within : last - 1;
        t[axis] = (float)(within - at[axis]);
    }
    leaks_cell cell = leaks_cell_at(field, at);
    memcpy(cell.t, t, sizeof t);
    return cell;
}

lmb_vec3 leaks_cell_point(const leaks_field *field, const int32_t at[3], float x, float y, float z)
{
    const lmb_lattice *const lattice = &field->probes->level[0].lattice;
    const double spacing = (double)lattice->spacing;
    return lmb_vec3_of((float)((lattice->min[0] + at[0] + (double)x) * spacing),
                       (float)((lattice->min[1] + at[1] + (double)y) * spacing),
                       (float)((lattice->min[2] + at[2] + (double)z) * spacing));
}

void leaks_weights(const float t[3], float weight[8])
{
    for (int i = 0; i < 8; ++i) {
        weight[i] = (i & 1 ? t[0] : 1.0f - t[0]) * (i & 2 ? t[1] : 1.0f - t[1]) * (i & 4 ? t[2] : 1.0f - t[2]);
    }
}

bool leaks_probe_is_valid(const leaks_field *field, int32_t probe)
{
    return probe >= 0 && field->probes->validity[probe] >= LMB_PROBES_MIN_VALIDITY;
}

bool leaks_blend(const leaks_field *field, const int32_t probe[8], const float weight[8], lmb_sh3_rgb *radiance)
{
    float total = 0.0f;
    for (int i = 0; i < 8; ++i) {
        total += weight[i];
    }
    if (!(total > 0.0f)) {
        return false;
    }
    *radiance = (lmb_sh3_rgb){.channel = {{.c = {0.0f}}}};
    for (int i = 0; i < 8; ++i) {
        const float share = weight[i] / total;
        for (int c = 0; share > 0.0f && c < 3; ++c) {
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                radiance->channel[c].c[k] += share * field->probes->radiance[0][probe[i]].channel[c].c[k];
            }
        }
    }
    return true;
}

bool leaks_sees(const lmb_tracer *tracer, lmb_vec3 from, lmb_vec3 to)
{
    lmb_hit hit;
    return !lmb_trace_nearest(tracer, from, lmb_vec3_sub(to, from), 0.0f, 1.0f, &hit);
}
