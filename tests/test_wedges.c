/* Wedges of cut cells, where the light of two regions passes over into each other: the light there is what the formula
 * of lambent/cell.h gives, without a step, and no file has one that cannot be. */
#include "harness.h"
#include "probes_fixture.h"

#include <lambent/pack.h>
#include <lambent/volume.h>

#include <math.h>
#include <stddef.h>

/* One cell of 1 m, from (2, 3, 4) on, with a wall at z = 1/2 that ends at x = 1/2: region 0 below it, of the lattice's
 * probes, region 1 above, of ghosts. */
static const lmb_lattice lattice = {.spacing = 1.0f, .min = {2, 3, 4}, .size = {2, 2, 2}};
static const lmb_cell_plane planes[3] = {
    {{0, 0, 16383}, 8192, {1, 2}},
    {{14189, 0, 8192}, 11190, {LMB_CELL_REGION, LMB_CELL_BLEND + 2}},
    {{14189, 0, -8192}, 2999, {LMB_CELL_REGION + 1, LMB_CELL_BLEND + 1}},
};

typedef struct made {
    lmb_probes *probes;
    unsigned char *data;
    size_t size;
    lmb_volume *volume;
} made;

/* Light that halfs hold as it is. */
static made cell_make(lmb_volume_form form)
{
    made cell = {NULL, NULL, 0, NULL};
    int32_t point[8][3], corner[2][8], first = 0;
    uint64_t state = 3;
    cell.probes = fixture_probes(&lattice, NULL);
    for (int32_t i = 0; i < 8; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            point[i][axis] = lattice.min[axis] + (i >> axis & 1);
        }
        corner[0][i] = i;
        corner[1][i] = 8 + i;
    }
    CHECK(lmb_probes_add_ghosts(cell.probes, 0, (const int32_t(*)[3])point, 8, &first) == LMB_OK && first == 8 &&
              lmb_probes_cut(cell.probes, 0, lattice.min, planes, 3, (const int32_t(*)[8])corner, 2) == LMB_OK,
          "a cell");
    cell.probes->key_light_count = 2;
    for (int key = 0; key < 2; ++key) {
        cell.probes->key_light[key] = (lmb_key_light){{0.0f, 1.0f, 0.0f}, {{1.0f, 1.0f, 1.0f}}};
    }
    for (int32_t probe = 0; probe < 16; ++probe) {
        cell.probes->validity[probe] = 1.0f;
        for (int k = 0; k < 27; ++k) {
            const double shade = floor(64.0 * fixture_random(&state)) / 64.0;
            cell.probes->radiance[0][probe].channel[k / 9].c[k % 9] = (float)(k % 9 ? shade - 0.5 : 1.0 + shade);
        }
        for (int key = 0; key < 2; ++key) {
            cell.probes->key_visibility[probe][key] = (float)floor(255.0 * fixture_random(&state)) / 255.0f;
        }
    }
    if (lmb_pack_as(form, cell.probes, &cell.data, &cell.size, NULL) != LMB_OK ||
        lmb_volume_open_memory(cell.data, cell.size, &cell.volume) != LMB_OK) {
        abort();
    }
    return cell;
}

static void cell_free(made *cell)
{
    lmb_volume_close(cell->volume);
    free(cell->data);
    lmb_probes_destroy(cell->probes);
}

static lmb_vec3d place_of(const double t[3])
{
    return (lmb_vec3d){2.0 + t[0], 3.0 + t[1], 4.0 + t[2]};
}

static double above(int plane, const double t[3])
{
    const lmb_cell_plane *const p = &planes[plane];
    return p->normal[0] * t[0] + p->normal[1] * t[1] + p->normal[2] * t[2] - p->offset;
}

/* The share of region 1 that light has, by the planes' distances. */
static double share_of(const double t[3])
{
    const double below = above(1, t), over = above(2, t);
    const bool is_over = above(0, t) > 0.0;
    if ((is_over ? over : below) <= 0.0) {
        return is_over ? 1.0 : 0.0;
    }
    return fabs(below) / (fabs(below) + fabs(over));
}

static double weight_of(int corner, const double t[3])
{
    return (corner & 1 ? t[0] : 1.0 - t[0]) * (corner & 2 ? t[1] : 1.0 - t[1]) * (corner & 4 ? t[2] : 1.0 - t[2]);
}

/* Not where rounding chooses the side of a plane, or much of the share. */
static bool is_sure(const double t[3])
{
    bool sure = fabs(above(1, t)) + fabs(above(2, t)) > 200.0;
    for (int plane = 0; plane < 3; ++plane) {
        sure = sure && fabs(above(plane, t)) > 1.0;
    }
    return sure;
}

static void light_is_that_of_the_formula(void)
{
    made cell = cell_make(LMB_VOLUME_HALFS);
    uint64_t state = 11;
    int blended = 0;
    for (int i = 0; i < 20000; ++i) {
        const double t[3] = {fixture_random(&state), fixture_random(&state), fixture_random(&state)};
        const double share = share_of(t);
        lmb_sh3_rgb sampled;
        float seen[LMB_KEY_LIGHTS_MOST];
        if (!is_sure(t)) {
            continue;
        }
        const lmb_sh3_rgb light = lmb_probes_light(cell.probes, 0, place_of(t));
        CHECK(lmb_volume_sample_with_keys(cell.volume, place_of(t), &sampled, seen), "inside");
        blended += share > 0.0 && share < 1.0;
        for (int k = 0; k < 27 + LMB_KEY_LIGHTS_MOST; ++k) {
            double region[2] = {0.0, 0.0};
            for (int c = 0; c < 16; ++c) {
                region[c / 8] +=
                    weight_of(c % 8, t) * (double)(k < 27 ? cell.probes->radiance[0][c].channel[k / 9].c[k % 9]
                                                          : cell.probes->key_visibility[c][k - 27]);
            }
            const double expected = (1.0 - share) * region[0] + share * region[1];
            CHECK_NEAR(k < 27 ? sampled.channel[k / 9].c[k % 9] : seen[k - 27], expected, 3e-5,
                       "number %d at (%.9g, %.9g, %.9g), share %g", k, t[0], t[1], t[2], share);
            if (k < 27) {
                CHECK_NEAR(light.channel[k / 9].c[k % 9], expected, 3e-5,
                           "coefficient %d of the probes at (%.9g, %.9g, %.9g), share %g", k, t[0], t[1], t[2], share);
            }
        }
    }
    CHECK(blended > 4000, "%d places in the wedge", blended);
    cell_free(&cell);
}

/* Bytes stand for harmonics to within a step: as near in a wedge as elsewhere. */
static void compact_light_is_near(void)
{
    made halfs = cell_make(LMB_VOLUME_HALFS), compact = cell_make(LMB_VOLUME_COMPACT);
    uint64_t state = 12;
    for (int i = 0; i < 5000; ++i) {
        const double t[3] = {fixture_random(&state), fixture_random(&state), fixture_random(&state)};
        lmb_sh3_rgb expected, light;
        float expected_seen[LMB_KEY_LIGHTS_MOST], seen[LMB_KEY_LIGHTS_MOST];
        lmb_volume_sample_with_keys(halfs.volume, place_of(t), &expected, expected_seen);
        lmb_volume_sample_with_keys(compact.volume, place_of(t), &light, seen);
        CHECK(memcmp(seen, expected_seen, sizeof seen) == 0, "what is seen of key lights");
        for (int k = 0; k < 27; ++k) {
            CHECK_NEAR(light.channel[k / 9].c[k % 9], expected.channel[k / 9].c[k % 9], 0.05,
                       "coefficient %d at (%.9g, %.9g, %.9g)", k, t[0], t[1], t[2]);
        }
    }
    cell_free(&halfs);
    cell_free(&compact);
}

/* The most that light changes from one side of a plane to the other, near a place on it. */
static double step_over(const made *cell, int plane, const double on[3])
{
    lmb_sh3_rgb light[2];
    double most = 0.0;
    for (int side = 0; side < 2; ++side) {
        double t[3];
        for (int axis = 0; axis < 3; ++axis) {
            t[axis] = on[axis] + (side ? 2e-6 : -2e-6) * planes[plane].normal[axis] / LMB_CELL_UNIT;
        }
        lmb_volume_sample_at(cell->volume, place_of(t), &light[side]);
    }
    for (int k = 0; k < 27; ++k) {
        most = fmax(most, fabs((double)light[0].channel[k / 9].c[k % 9] - (double)light[1].channel[k / 9].c[k % 9]));
    }
    return most;
}

/* Over the wall there is a step, beyond its end none, nor at the wedge's sides. */
static void light_has_no_step(void)
{
    made cell = cell_make(LMB_VOLUME_HALFS);
    uint64_t state = 13;
    int places[4] = {0};
    for (int i = 0; i < 3000; ++i) {
        const int plane = i % 3;
        double t[3] = {fixture_random(&state), fixture_random(&state), fixture_random(&state)};
        const double off = above(plane, t) / ((double)LMB_CELL_UNIT * LMB_CELL_UNIT);
        bool inside = true;
        for (int axis = 0; axis < 3; ++axis) {
            t[axis] -= off * planes[plane].normal[axis];
            inside = inside && t[axis] > 0.001 && t[axis] < 0.999;
        }
        const double other = above(plane == 1 ? 2 : 1, t);
        const bool is_side = plane == 0 || (plane == 1) == (above(0, t) <= 0.0); /* a plane of this half */
        if (!inside || !is_side || fabs(other) < 100.0) {
            continue;
        }
        const double step = step_over(&cell, plane, t);
        const bool is_wall = plane == 0 && other < 0.0;
        CHECK(is_wall ? step > 0.05 : step < 1e-3, "plane %d at (%.9g, %.9g, %.9g): a step of %g", plane, t[0], t[1],
              t[2], step);
        ++places[is_wall ? 3 : plane];
    }
    for (int k = 0; k < 4; ++k) {
        CHECK(places[k] > 50, "%d places of kind %d", places[k], k);
    }
    cell_free(&cell);
}

/* ---------------------------------------------------------------------------------------------- files */

static void repair_checksum(unsigned char *data, size_t size)
{
    const uint64_t checksum = lmb_volume_hash(data + LMB_VOLUME_CHECKSUM_START, size - LMB_VOLUME_CHECKSUM_START);
    memcpy(data + offsetof(lmb_volume_header, checksum), &checksum, sizeof checksum);
}

/* The planes in the file. */
static unsigned char *planes_find(const made *cell)
{
    unsigned char *found = NULL;
    for (size_t i = 0; i + sizeof planes <= cell->size; ++i) {
        found = memcmp(cell->data + i, planes, sizeof planes) == 0 ? cell->data + i : found;
    }
    if (!found) {
        abort();
    }
    return found;
}

static lmb_result opened(const made *cell)
{
    lmb_volume *volume = NULL;
    repair_checksum(cell->data, cell->size);
    const lmb_result result = lmb_volume_open_memory(cell->data, cell->size, &volume);
    CHECK((result == LMB_OK) == (volume != NULL), "%d", result);
    lmb_volume_close(volume);
    return result;
}

static void wedges_that_cannot_be_are_refused(void)
{
    static const struct {
        const char *name;
        int plane, side;
        uint8_t child;
        lmb_result expected;
    } cases[] = {
        {"as it is", 1, 1, LMB_CELL_BLEND + 2, LMB_OK},
        {"a region instead", 1, 1, LMB_CELL_REGION + 1, LMB_ERROR_FORMAT}, /* the other wedge's plane has two */
        {"the last region there may be", 1, 0, LMB_CELL_BLEND - 1, LMB_ERROR_FORMAT},
        {"beside itself", 1, 1, LMB_CELL_BLEND + 1, LMB_ERROR_FORMAT},
        {"of a plane that is not there", 1, 1, LMB_CELL_BLEND + 3, LMB_ERROR_FORMAT},
        {"of the last plane there may be", 1, 1, LMB_CELL_BLEND + LMB_CELL_PLANES_MOST, LMB_ERROR_FORMAT},
        {"of the last number", 2, 1, 255, LMB_ERROR_FORMAT},
        {"without a region beside it", 1, 0, LMB_CELL_BLEND + 2, LMB_ERROR_FORMAT},
        {"of a plane without regions", 1, 1, LMB_CELL_BLEND + 0, LMB_ERROR_FORMAT},
        {"between planes further on", 0, 0, LMB_CELL_BLEND + 1, LMB_ERROR_FORMAT},
        {"as it is again", 2, 1, LMB_CELL_BLEND + 1, LMB_OK},
    };
    made cell = cell_make(LMB_VOLUME_HALFS);
    unsigned char *const in_file = planes_find(&cell);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        unsigned char *const child = in_file + sizeof planes[0] * (size_t)cases[i].plane +
                                     offsetof(lmb_cell_plane, child) + (size_t)cases[i].side;
        const unsigned char kept = *child;
        *child = cases[i].child;
        CHECK(opened(&cell) == cases[i].expected, "a wedge %s", cases[i].name);
        *child = kept;
    }
    cell_free(&cell);
}

static void earlier_versions_have_none(void)
{
    made cell = cell_make(LMB_VOLUME_HALFS);
    unsigned char *const in_file = planes_find(&cell);
    const uint32_t version = 4;
    memcpy(cell.data + offsetof(lmb_volume_header, version), &version, sizeof version);
    CHECK(opened(&cell) == LMB_ERROR_FORMAT, "a wedge in version 4");
    for (size_t plane = 1; plane < 3; ++plane) {
        in_file[sizeof planes[0] * plane + offsetof(lmb_cell_plane, child) + 1] = LMB_CELL_REGION;
        CHECK(opened(&cell) == (plane < 2 ? LMB_ERROR_FORMAT : LMB_OK), "version 4, %zu wedges fewer", plane);
    }
    cell_free(&cell);
}

/* ------------------------------------------------------------------------------------------- finer levels */

/* Probes of a finer level on the side of a cell with a wedge have its light, of both regions. */
static void hanging_probes_have_both(void)
{
    const lmb_lattice fine = {.spacing = 1.0f, .size = {5, 5, 5}}, coarse = {.spacing = 2.0f, .size = {4, 2, 2}};
    static const lmb_cell_plane in_y[3] = {
        {{0, 0, 16383}, 8192, {1, 2}},
        {{0, 11585, 11585}, 11585, {LMB_CELL_REGION, LMB_CELL_BLEND + 2}},
        {{0, 11585, -11585}, 0, {LMB_CELL_REGION + 1, LMB_CELL_BLEND + 1}},
    };
    static const int32_t cell[3] = {2, 0, 0};
    int32_t point[8][3], corner[2][8], first = 0;
    lmb_probes *const probes = fixture_probes(&fine, NULL);
    for (int32_t i = 0; i < 8; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            point[i][axis] = cell[axis] + (i >> axis & 1);
        }
        corner[0][i] = 125 + i;
        corner[1][i] = 133 + i;
    }
    CHECK(lmb_probes_add_level(probes, &coarse, (const int32_t(*)[3])point, 8) == LMB_OK &&
              lmb_probes_add_ghosts(probes, 1, (const int32_t(*)[3])point, 8, &first) == LMB_OK && first == 133 &&
              lmb_probes_cut(probes, 1, cell, in_y, 3, (const int32_t(*)[8])corner, 2) == LMB_OK,
          "two levels");
    for (int32_t probe = 125; probe < 141; ++probe) {
        probes->validity[probe] = 1.0f;
        probes->radiance[0][probe].channel[0].c[0] = probe < 133 ? 1.0f : 3.0f;
    }
    lmb_probes_find_hanging(probes, 0, 125, NULL, NULL);
    lmb_probes_hang(probes);
    static const struct {
        int32_t y, z;
        double light;
    } cases[] = {{0, 0, 1.0}, {0, 2, 3.0}, {2, 1, 2.0}, {1, 0, 1.0}, {1, 2, 3.0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const int32_t probe = lmb_probes_find(probes, 0, 4, cases[i].y, cases[i].z);
        lmb_probe_parents parents;
        CHECK(lmb_probes_hangs(probes, probe, &parents), "(4, %d, %d) hangs", cases[i].y, cases[i].z);
        double sum = 0.0;
        for (uint32_t k = 0; k < parents.count; ++k) {
            sum += parents.weight[k];
        }
        CHECK_NEAR(sum, 1.0, 1e-12, "(4, %d, %d): weights", cases[i].y, cases[i].z);
        CHECK(parents.count == (cases[i].light == 2.0 ? 16u : 8u), "%u parents", parents.count);
        CHECK_NEAR(probes->radiance[0][probe].channel[0].c[0], cases[i].light, 1e-3, "(4, %d, %d)", cases[i].y,
                   cases[i].z);
    }
    lmb_probes_destroy(probes);
}

static const test_case cases[] = {
    {"light is that of the formula", light_is_that_of_the_formula},
    {"compact light is near", compact_light_is_near},
    {"light has no step", light_has_no_step},
    {"wedges that cannot be are refused", wedges_that_cannot_be_are_refused},
    {"earlier versions have none", earlier_versions_have_none},
    {"hanging probes have both", hanging_probes_have_both},
};
TEST_MAIN(cases)
