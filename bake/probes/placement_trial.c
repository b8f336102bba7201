#include "probes/placement_trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/key_lights.h>
#include <lambent/probe_boxes.h>
#include <lambent/probes_bake.h>
#include <lambent/vector.h>

/* Where a cell is tried, in halves of it. */
enum { TRIAL_POINTS = 7 };
static const int trial_point[TRIAL_POINTS][3] = {{1, 1, 1}, {0, 1, 1}, {2, 1, 1}, {1, 0, 1},
                                                 {1, 2, 1}, {1, 1, 0}, {1, 1, 2}};

/* How far within its cell a face is looked at. */
#define WITHIN_SPACINGS 0.02

void lmb_level_cubes_free(lmb_level_cubes *cubes)
{
    lmb_point_set_free(&cubes->cubes);
    free(cubes->open);
    free(cubes->forced);
    free(cubes->tried);
    free(cubes->error);
    free(cubes->split);
    *cubes = (lmb_level_cubes){0};
}

static void cell_corner(const int32_t cell[3], int corner, int32_t point[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] = cell[axis] + (corner >> axis & 1);
    }
}

/* Whether probes are wanted at a point of the even lattice. */
static bool even_point_is_wanted(const lmb_sites *sites, int32_t x, int32_t y, int32_t z)
{
    const lmb_probes *even = sites->even;
    const int32_t probe = lmb_probes_find(even, 0, x, y, z);
    return probe >= 0 && even->validity[probe] >= LMB_PROBES_MIN_VALIDITY &&
           !lmb_scene_probes_excluded(lmb_tracer_scene(sites->transport->tracer), lmb_probes_position(even, probe));
}

/* Whether probes are wanted at a point of the even lattice in a cell that is not finer. */
static bool cell_has_wanted_point(const lmb_sites *sites, uint32_t level, const int32_t cell[3])
{
    const int32_t step = (int32_t)(UINT32_C(1) << (level - sites->even_level));
    for (int32_t z = 0; z <= step; ++z) {
        for (int32_t y = 0; y <= step; ++y) {
            for (int32_t x = 0; x <= step; ++x) {
                if (even_point_is_wanted(sites, cell[0] * step + x, cell[1] * step + y, cell[2] * step + z)) {
                    return true;
                }
            }
        }
    }
    return false;
}

static bool cell_has_wanted_corner(const lmb_sites *sites, uint32_t level, const int32_t cell[3])
{
    bool has = false;
    for (int corner = 0; corner < 8 && !has; ++corner) {
        int32_t point[3];
        cell_corner(cell, corner, point);
        const lmb_site *const site = lmb_sites_find(sites, level, point);
        has = site && site->wanted;
    }
    return has;
}

static lmb_result cell_add_sites(lmb_sites *sites, uint32_t level, const int32_t cell[3])
{
    lmb_result result = LMB_OK;
    for (int corner = 0; corner < 8 && result == LMB_OK; ++corner) {
        int32_t point[3];
        cell_corner(cell, corner, point);
        result = lmb_sites_add(sites, level, point);
    }
    return result;
}

/* Marks the open cells of a cube of no finer level than the even one, whose corners become sites; else all cells. */
static lmb_result cube_begin(lmb_sites *sites, lmb_level_cubes *cubes, int32_t cube)
{
    lmb_result result = LMB_OK;
    for (int i = 0; i < 8 && result == LMB_OK; ++i) {
        int32_t cell[3];
        lmb_cube_cell(cubes->cubes.point[cube], i, cell);
        const bool counts = lmb_sites_cell_counts(sites, cubes->level, cell);
        if (counts && (cubes->level < sites->even_level || cell_has_wanted_point(sites, cubes->level, cell))) {
            cubes->open[cube] |= (uint8_t)(1 << i);
            result = cell_add_sites(sites, cubes->level, cell);
        }
    }
    return result;
}

static void cube_close_cells(const lmb_sites *sites, lmb_level_cubes *cubes, int32_t cube)
{
    for (int i = 0; i < 8; ++i) {
        int32_t cell[3];
        lmb_cube_cell(cubes->cubes.point[cube], i, cell);
        if (!cell_has_wanted_corner(sites, cubes->level, cell)) {
            cubes->open[cube] &= (uint8_t) ~(1 << i);
        }
    }
}

static bool cell_is_tried(const lmb_level_cubes *cubes, int32_t cube, int i)
{
    return cubes->tried[cube] && (cubes->open[cube] >> i & 1) != 0;
}

lmb_result lmb_cubes_corners(const lmb_level_cubes *cubes, lmb_cubes_which which, lmb_point_set *corners)
{
    lmb_result result = LMB_OK;
    for (int32_t cube = 0; cube < cubes->cubes.count; ++cube) {
        const bool is_one = which == LMB_CUBES_ALL || (which == LMB_CUBES_WHOLE && !cubes->split[cube]) ||
                            (which == LMB_CUBES_TRIED && cubes->tried[cube]);
        for (int i = 0; i < 64 && result == LMB_OK && is_one; ++i) {
            int32_t cell[3], point[3];
            lmb_cube_cell(cubes->cubes.point[cube], i / 8, cell);
            cell_corner(cell, i % 8, point);
            if ((cubes->open[cube] >> (i / 8) & 1) != 0) {
                result = lmb_point_set_add(corners, point);
            }
        }
    }
    return result;
}

lmb_result lmb_cubes_open(lmb_sites *sites, lmb_level_cubes *cubes)
{
    const size_t count = (size_t)cubes->cubes.count + 1;
    cubes->open = calloc(count, sizeof *cubes->open);
    cubes->forced = calloc(count, sizeof *cubes->forced);
    cubes->tried = calloc(count, sizeof *cubes->tried);
    cubes->error = calloc(count, sizeof *cubes->error);
    cubes->split = calloc(count, sizeof *cubes->split);
    const bool has = cubes->open && cubes->forced && cubes->tried && cubes->error && cubes->split;
    lmb_result result = has ? LMB_OK : LMB_ERROR_MEMORY;
    for (int32_t cube = 0; cube < cubes->cubes.count && result == LMB_OK; ++cube) {
        result = cube_begin(sites, cubes, cube);
    }
    result = result == LMB_OK ? lmb_sites_look(sites) : result;
    for (int32_t cube = 0; cube < cubes->cubes.count && result == LMB_OK && cubes->level < sites->even_level; ++cube) {
        cube_close_cells(sites, cubes, cube);
    }
    return result;
}

/* What cells first .. first + count - 1 of a level take up in the scene, and in the level's bounds where they reach
 * into them. */
static void cells_box(const lmb_sites *sites, uint32_t level, const int32_t first[3], int count, double low[3],
                      double high[3])
{
    const lmb_scene *scene = lmb_tracer_scene(sites->transport->tracer);
    const double from[3] = {scene->origin.x, scene->origin.y, scene->origin.z};
    const float least[3] = {scene->bounds_min.x, scene->bounds_min.y, scene->bounds_min.z};
    const float most[3] = {scene->bounds_max.x, scene->bounds_max.y, scene->bounds_max.z};
    const double spacing = (double)lmb_sites_spacing(sites, level);
    for (int axis = 0; axis < 3; ++axis) {
        const double begin = spacing * first[axis] - from[axis], end = begin + spacing * count;
        low[axis] = fmax(begin, fmin((double)least[axis], end));
        high[axis] = fmin(end, fmax((double)most[axis], begin));
    }
}

bool lmb_cubes_rule(const lmb_sites *sites, const lmb_level_rules *rules, lmb_level_cubes *cubes)
{
    bool any = false;
    for (int32_t cube = 0; cube < cubes->cubes.count; ++cube) {
        int32_t first[3];
        double low[3], high[3];
        lmb_cube_cell(cubes->cubes.point[cube], 0, first);
        cells_box(sites, cubes->level, first, 2, low, high);
        cubes->forced[cube] = cubes->open[cube] && lmb_rules_force(rules, low, high, cubes->level);
        cubes->tried[cube] =
            cubes->open[cube] && !cubes->forced[cube] && lmb_rules_allow(rules, low, high, cubes->level);
        any = any || cubes->tried[cube];
    }
    return any;
}

/* ------------------------------------------------------------------------------------------------- errors */

/* What the squared norm of an object's light counts a coefficient of radiance by: the mean square of its normalised
 * irradiance over all normals (Ramamoorthi and Hanrahan 2001: bands count 1, 2/3, 1/4). */
static double band_weight(int coefficient)
{
    const double band = coefficient == 0 ? 1.0 : coefficient < 4 ? 2.0 / 3.0 : 0.25;
    return band * band / (4.0 * 3.14159265358979323846);
}

/* Likewise of a key light that is seen: the mean over normals of the squared cosine, above the horizon, is 1/6. */
static double key_weight(const lmb_key_light *light)
{
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double normalised = (double)light->irradiance.c[c] / 3.14159265358979323846;
        sum += normalised * normalised / 6.0;
    }
    return sum;
}

/* A level's corners with their light in set 0 and its noise in set 1, as they would be baked. */
typedef struct trial_level {
    lmb_probes *corners; /* with regions cut */
    uint32_t key_count;
    double key_weight[LMB_KEY_LIGHTS_MOST];
    double floor_squared;
} trial_level;

/* The squared error at a place where the light is known, of what is interpolated there: the product of what the two
 * halves of all samples make of it, so that noise adds nothing on average. */
static double site_error(const trial_level *trial, const lmb_site *site, const int32_t corner[8],
                         const double weight[8])
{
    double squared_error = 0.0, squared_light = 0.0;
    for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
        const int channel = i / LMB_SH3_COUNT, k = i % LMB_SH3_COUNT;
        const double there = (double)site->light.channel[channel].c[k];
        double off = there, noise = (double)site->difference.channel[channel].c[k];
        for (int n = 0; n < 8; ++n) {
            off -= weight[n] * (double)trial->corners->radiance[0][corner[n]].channel[channel].c[k];
            noise -= weight[n] * (double)trial->corners->radiance[1][corner[n]].channel[channel].c[k];
        }
        squared_error += band_weight(k) * (off * off - noise * noise);
        squared_light += band_weight(k) * there * there;
    }
    for (uint32_t key = 0; key < trial->key_count; ++key) {
        const double there = (double)site->key_visibility[key];
        double off = there;
        for (int n = 0; n < 8; ++n) {
            off -= weight[n] * (double)trial->corners->key_visibility[corner[n]][key];
        }
        squared_error += trial->key_weight[key] * off * off;
        squared_light += trial->key_weight[key] * there * there;
    }
    const double scale = fmax(squared_light, trial->floor_squared);
    return scale > 0.0 ? squared_error / scale : 0.0;
}

/* The probes around a trial point, for a cell that it lies in, or on a face of: a little within it, as the other side
 * of the face may be another region. @return false where the cell has none, or a wall is between */
static bool trial_corners(const lmb_sites *sites, const lmb_probes *corners, const int32_t cell[3],
                          const lmb_site *site, int32_t corner[8], double weight[8])
{
    const double spacing = (double)corners->level[0].lattice.spacing;
    const double scene[3] = {(double)site->position.x, (double)site->position.y, (double)site->position.z};
    const double origin[3] = {corners->origin.x, corners->origin.y, corners->origin.z};
    double at[3], t[3];
    bool moved = false;
    for (int axis = 0; axis < 3; ++axis) {
        const double local = (scene[axis] + origin[axis]) / spacing - cell[axis];
        const double within = fmin(fmax(local, WITHIN_SPACINGS), 1.0 - WITHIN_SPACINGS);
        moved = moved || within != local;
        at[axis] = spacing * (cell[axis] + within);
    }
    const lmb_vec3 seen =
        lmb_vec3_of((float)(at[0] - origin[0]), (float)(at[1] - origin[1]), (float)(at[2] - origin[2]));
    uint64_t rays = 0;
    if ((moved &&
         !(lmb_rgb_max(lmb_trace_transmittance(sites->transport->tracer, site->position, seen, &rays)) > 0.0f)) ||
        !lmb_probes_around(corners, (lmb_vec3d){at[0], at[1], at[2]}, corner, t)) {
        return false;
    }
    for (int i = 0; i < 8; ++i) {
        weight[i] = (i & 1 ? t[0] : 1.0 - t[0]) * (i & 2 ? t[1] : 1.0 - t[1]) * (i & 4 ? t[2] : 1.0 - t[2]);
    }
    return true;
}

static void trial_site_point(const int32_t cell[3], int i, int32_t point[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] = 2 * cell[axis] + trial_point[i][axis];
    }
}

/* The mean squared error over the places of a cell that are free. */
static double cell_error(const lmb_sites *sites, const trial_level *trial, uint32_t level, const int32_t cell[3])
{
    double sum = 0.0;
    int places = 0;
    for (int i = 0; i < TRIAL_POINTS; ++i) {
        int32_t point[3], corner[8];
        double weight[8];
        trial_site_point(cell, i, point);
        const lmb_site *const site = lmb_sites_find(sites, level - 1, point);
        const bool counts = lmb_sites_point_counts(sites, level - 1, point);
        if (counts && site && site->wanted && trial_corners(sites, trial->corners, cell, site, corner, weight)) {
            sum += site_error(trial, site, corner, weight);
            ++places;
        }
    }
    return places > 0 ? sum / places : 0.0;
}

/* --------------------------------------------------------------------------------------------------- light */

/* Calls for each trial point of each open cell. */
static lmb_result trial_points_add(lmb_sites *sites, const lmb_level_cubes *cubes)
{
    lmb_result result = LMB_OK;
    for (int32_t cube = 0; cube < cubes->cubes.count; ++cube) {
        for (int i = 0; i < 8 * TRIAL_POINTS && result == LMB_OK; ++i) {
            int32_t cell[3], point[3];
            lmb_cube_cell(cubes->cubes.point[cube], i / TRIAL_POINTS, cell);
            trial_site_point(cell, i % TRIAL_POINTS, point);
            if (cell_is_tried(cubes, cube, i / TRIAL_POINTS) &&
                lmb_sites_point_counts(sites, cubes->level - 1, point)) {
                result = lmb_sites_add(sites, cubes->level - 1, point);
            }
        }
    }
    return result == LMB_OK ? lmb_sites_look(sites) : result;
}

/* Numbers of a level's corners and trial points, cube by cube, so that neighbours follow each other. NULL: no memory.
 */
static int32_t *numbers_list(const lmb_sites *sites, const lmb_level_cubes *cubes, size_t *count)
{
    const size_t each = 8 * (8 + TRIAL_POINTS);
    int32_t *const number = malloc(((size_t)cubes->cubes.count * each + 1) * sizeof *number);
    *count = 0;
    for (int32_t cube = 0; cube < cubes->cubes.count && number; ++cube) {
        for (int i = 0; i < 8 * (8 + TRIAL_POINTS); ++i) {
            const int place = i / 8;
            int32_t cell[3], point[3];
            lmb_cube_cell(cubes->cubes.point[cube], i % 8, cell);
            if (place < 8) {
                cell_corner(cell, place, point);
            } else {
                trial_site_point(cell, place - 8, point);
            }
            const lmb_site *const site = cell_is_tried(cubes, cube, i % 8)
                                             ? lmb_sites_find(sites, cubes->level - (place < 8 ? 0 : 1), point)
                                             : NULL;
            if (site) {
                number[(*count)++] = (int32_t)(site - sites->site);
            }
        }
    }
    return number;
}

static lmb_result light_gather(lmb_sites *sites, const lmb_level_cubes *cubes)
{
    lmb_result result = trial_points_add(sites, cubes);
    if (result != LMB_OK) {
        return result;
    }
    size_t count;
    int32_t *const number = numbers_list(sites, cubes, &count);
    result = number ? lmb_sites_light(sites, number, count) : LMB_ERROR_MEMORY;
    free(number);
    return result;
}

static void corners_fill(const lmb_sites *sites, uint32_t level, lmb_probes *corners)
{
    for (int32_t i = 0; i < corners->count; ++i) {
        const lmb_site *const site = lmb_sites_find(sites, level, corners->point[i]);
        corners->validity[i] = site->validity;
        corners->radiance[0][i] = site->light;
        corners->radiance[1][i] = site->difference;
        memcpy(corners->key_visibility[i], site->key_visibility, sizeof site->key_visibility);
    }
}

/* Cuts the cells that geometry cuts, gathers light for their regions, and fits both sets. */
static lmb_result corners_cut(lmb_sites *sites, lmb_probes *corners)
{
    const lmb_tracer *tracer = sites->transport->tracer;
    lmb_regions *regions = NULL;
    lmb_regions_stats stats;
    lmb_probe_list list = {.probe = NULL};
    lmb_gathered *gathered = NULL;
    lmb_result result = lmb_regions_make(tracer, sites->pool, NULL, corners, &regions, &stats);
    if (result == LMB_OK) {
        sites->rays += stats.rays;
        result = lmb_probe_list_create(corners, regions, tracer, &list);
    }
    if (result == LMB_OK) {
        /* Corners have theirs. */
        list.count -= list.probe_count;
        list.probe_count = 0;
        gathered = malloc((list.count + 1) * sizeof *gathered);
        sites->done += sites->share;
        const lmb_gather_list elements = lmb_probe_list_elements(&list);
        result = gathered ? lmb_sites_gather(sites, &elements, gathered) : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        result = lmb_regions_fit(regions, gathered, 0, sites->pool, corners);
    }
    if (result == LMB_OK) {
        for (size_t i = 0; i < list.count; ++i) {
            gathered[i].moments = gathered[i].difference;
        }
        result = lmb_regions_fit(regions, gathered, 1, sites->pool, corners);
    }
    free(gathered);
    lmb_probe_list_free(&list);
    lmb_regions_destroy(regions);
    return result;
}

static lmb_result corners_make(lmb_sites *sites, const lmb_level_cubes *cubes, lmb_probes **made)
{
    lmb_point_set points = {0};
    lmb_probes *corners = NULL;
    uint32_t noise;
    lmb_result result = lmb_cubes_corners(cubes, LMB_CUBES_TRIED, &points);
    if (result == LMB_OK) {
        result = lmb_probes_create(&corners);
    }
    if (result == LMB_OK) {
        const lmb_lattice lattice = lmb_point_set_box(&points, lmb_sites_spacing(sites, cubes->level));
        result = lmb_probes_add_level(corners, &lattice, (const int32_t(*)[3])points.point, points.count);
    }
    if (result == LMB_OK) {
        result = lmb_probes_add_set(corners, &noise);
    }
    if (result == LMB_OK) {
        corners->origin = sites->even->origin;
        corners->key_light_count = lmb_scene_key_lights(lmb_tracer_scene(sites->transport->tracer), corners->key_light);
        corners_fill(sites, cubes->level, corners);
        result = lmb_probes_dilate(corners);
    }
    if (result == LMB_OK) {
        result = corners_cut(sites, corners);
    }
    lmb_point_set_free(&points);
    if (result != LMB_OK) {
        lmb_probes_destroy(corners);
        return result;
    }
    *made = corners;
    return LMB_OK;
}

/* In tolerances at its centre. */
static double cell_error_in_tolerances(const lmb_sites *sites, const lmb_level_rules *rules, const trial_level *trial,
                                       uint32_t level, const int32_t cell[3])
{
    double low[3], high[3];
    cells_box(sites, level, cell, 1, low, high);
    const lmb_vec3 centre = lmb_vec3_of((float)(0.5 * (low[0] + high[0])), (float)(0.5 * (low[1] + high[1])),
                                        (float)(0.5 * (low[2] + high[2])));
    const double tolerance = lmb_rules_tolerance(rules, centre);
    return fmin(cell_error(sites, trial, level, cell), 1.0) / (tolerance * tolerance);
}

lmb_result lmb_cubes_try(lmb_sites *sites, const lmb_level_rules *rules, double dark, lmb_level_cubes *cubes)
{
    trial_level trial = {.floor_squared = 3.0 * dark * dark};
    lmb_result result = light_gather(sites, cubes);
    if (result == LMB_OK) {
        result = corners_make(sites, cubes, &trial.corners);
    }
    if (result != LMB_OK) {
        return result;
    }
    trial.key_count = trial.corners->key_light_count;
    for (uint32_t key = 0; key < trial.key_count; ++key) {
        trial.key_weight[key] = key_weight(&trial.corners->key_light[key]);
    }
    for (int32_t cube = 0; cube < cubes->cubes.count; ++cube) {
        double sum = 0.0;
        for (int i = 0; i < 8; ++i) {
            int32_t cell[3];
            lmb_cube_cell(cubes->cubes.point[cube], i, cell);
            if (cell_is_tried(cubes, cube, i)) {
                sum += cell_error_in_tolerances(sites, rules, &trial, cubes->level, cell);
            }
        }
        cubes->error[cube] = (float)(sum / 8.0);
    }
    lmb_probes_destroy(trial.corners);
    return LMB_OK;
}
