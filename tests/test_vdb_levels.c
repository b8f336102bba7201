/* probes.vdb with levels, ghosts and cut cells: what is written comes back, also after other tools had it. */
#include "cut_fixture.h"
#include "folder_fixture.h"
#include "harness.h"
#include "probes_fixture.h"
#include "vdb_editor.h"

#include <lambent/base64.h>
#include <lambent/file.h>
#include <lambent/vdb.h>

#include <unistd.h>

#define FOLDER LMB_TEST_OUTPUT_DIR "/vdb_levels"
#define PATH FOLDER "/probes.vdb"

static void write_probes(const lmb_probes *probes)
{
    static const lmb_vdb_metadata metadata = {"{}", "0123abcd"};
    lmb_error error = {""};
    CHECK(lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_OK, "write: %s", error.message);
}

static lmb_probes *read_probes(void)
{
    lmb_probes *probes = NULL;
    lmb_error error = {""};
    CHECK(lmb_vdb_read(PATH, &probes, NULL, NULL, &error) == LMB_OK, "read: %s", error.message);
    CHECK(!probes || lmb_probes_validate(probes, &error) == LMB_OK, "validate: %s", error.message);
    return probes;
}

static void check_refused(lmb_result expected, const char *reason)
{
    lmb_probes *probes = NULL;
    lmb_error error = {""};
    const lmb_result result = lmb_vdb_read(PATH, &probes, NULL, NULL, &error);
    CHECK(result == expected && strstr(error.message, reason), "%d, '%s', not %d, '%s'", result, error.message,
          expected, reason);
    lmb_probes_destroy(probes);
}

/* Equal but for what halfs round. */
static void check_equal(const lmb_probes *read, const lmb_probes *written, double magnitude)
{
    CHECK(read->count == written->count && read->ghost_count == written->ghost_count &&
              read->level_count == written->level_count && read->cut.count == written->cut.count &&
              read->cut.plane_count == written->cut.plane_count && read->cut.region_count == written->cut.region_count,
          "%d and %d probes, %u and %u cells", read->count, written->count, read->cut.count, written->cut.count);
    if (test_failures > 0) {
        return;
    }
    for (uint32_t i = 0; i < written->level_count; ++i) {
        const lmb_probe_level *const a = &read->level[i], *const b = &written->level[i];
        CHECK(a->lattice.spacing == b->lattice.spacing &&
                  memcmp(a->lattice.min, b->lattice.min, sizeof a->lattice.min) == 0 &&
                  memcmp(a->lattice.size, b->lattice.size, sizeof a->lattice.size) == 0 && a->first == b->first &&
                  a->count == b->count,
              "level %u", i);
        CHECK(a->ghost_count == b->ghost_count && (a->ghost_count == 0 || a->ghost_first == b->ghost_first),
              "level %u has %d ghosts from %d", i, a->ghost_count, a->ghost_first);
    }
    const size_t count = (size_t)written->count;
    CHECK(memcmp(read->point, written->point, count * sizeof *read->point) == 0, "points");
    CHECK(memcmp(read->validity, written->validity, count * sizeof *read->validity) == 0, "validity");
    CHECK(memcmp(read->key_visibility, written->key_visibility, count * sizeof *read->key_visibility) == 0,
          "visibility of key lights");
    const lmb_cut_cells *const a = &read->cut, *const b = &written->cut;
    CHECK(memcmp(a->cell, b->cell, b->count * sizeof *b->cell) == 0, "cells");
    CHECK(memcmp(a->plane, b->plane, b->plane_count * sizeof *b->plane) == 0, "planes");
    CHECK(memcmp(a->corner, b->corner, b->region_count * sizeof *b->corner) == 0, "corners");
    for (size_t k = 0; k < 27 * count; ++k) {
        const size_t probe = k / 27, i = k % 27;
        const double expected = (double)written->radiance[0][probe].channel[i / 9].c[i % 9];
        CHECK_NEAR(read->radiance[0][probe].channel[i / 9].c[i % 9], expected,
                   fabs(expected) * 0x1p-11 + magnitude * 1e-6, "probe %zu, coefficient %zu", probe, i);
    }
}

static void test_round_trip(void)
{
    folder_start(FOLDER);
    lmb_probes *const probes = cut_fixture_probes();
    probes->key_light[0] = (lmb_key_light){{0.0f, 0.6f, 0.8f}, {{3.0f, 2.0f, 1.0f}}};
    probes->key_light_count = 1;
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        probes->validity[probe] = 0.5f + 0.5f * (float)probe / (float)probes->count;
        probes->key_visibility[probe][0] = (float)probe / (float)probes->count;
    }
    write_probes(probes);
    lmb_probes *read = read_probes();
    if (read) {
        check_equal(read, probes, 1000.0);
        CHECK(memcmp(read->key_light, probes->key_light, sizeof *read->key_light) == 0, "key light");
    }
    lmb_probes_destroy(read);
    /* Saved by another tool, it is the same. */
    static const vdb_editor_compression saved[] = {VDB_EDITOR_BLOSC, VDB_EDITOR_ZIP, VDB_EDITOR_MASKS, VDB_EDITOR_NONE};
    for (size_t i = 0; i < sizeof saved / sizeof saved[0]; ++i) {
        CHECK(vdb_editor_save(PATH, saved[i]), "save");
        read = read_probes();
        if (read) {
            check_equal(read, probes, 1000.0);
        }
        lmb_probes_destroy(read);
    }
    lmb_probes_destroy(probes);
}

/* A level of random probes with cells that are cut at random; a corner is the probe's or one of several ghosts'. */
static void cut_at_random(lmb_probes *probes, uint32_t level, int32_t (*corner)[8], const int32_t (*cell)[3],
                          int32_t cells)
{
    for (int32_t i = 0; i < cells; ++i) {
        const lmb_cell_plane plane = {
            {(int16_t)(i * 31 % 16383), (int16_t)(-i), -16383}, (int16_t)(77 - i), {CUT_REGION(1), CUT_REGION(0)}};
        CHECK(lmb_probes_cut(probes, level, cell[i], &plane, 1, (const int32_t(*)[8])corner + 2 * i, 2) == LMB_OK,
              "cell %d", i);
    }
}

static void add_random_cuts(lmb_probes *probes, uint32_t level, uint64_t *state)
{
    enum { MOST = 200 };
    static int32_t cell[MOST][3], corner[2 * MOST][8], ghost[16 * MOST][3];
    const lmb_lattice *const lattice = &probes->level[level].lattice;
    int32_t cells = 0, ghosts = 0;
    for (int32_t i = 0; i < lattice->size[0] * lattice->size[1] * lattice->size[2] && cells < MOST; ++i) {
        const int32_t local[3] = {i % lattice->size[0], i / lattice->size[0] % lattice->size[1],
                                  i / lattice->size[0] / lattice->size[1]};
        bool inside = fixture_random(state) < 0.4;
        for (int axis = 0; axis < 3; ++axis) {
            cell[cells][axis] = lattice->min[axis] + local[axis];
            inside = inside && local[axis] + 1 < lattice->size[axis];
        }
        for (int k = 0; inside && k < 16; ++k) {
            int32_t at[3];
            for (int axis = 0; axis < 3; ++axis) {
                at[axis] = cell[cells][axis] + (k >> axis & 1);
            }
            const int32_t probe = lmb_probes_find(probes, level, at[0], at[1], at[2]);
            const bool is_ghost = probe < 0 || fixture_random(state) < 0.5;
            corner[2 * cells + k / 8][k % 8] = is_ghost ? probes->count + ghosts : probe;
            if (is_ghost) {
                memcpy(ghost[ghosts++], at, sizeof at);
            }
        }
        cells += inside;
    }
    int32_t first;
    CHECK(lmb_probes_add_ghosts(probes, level, (const int32_t(*)[3])ghost, ghosts, &first) == LMB_OK, "ghosts");
    for (int32_t i = first; i < probes->count; ++i) {
        probes->validity[i] = (float)fixture_random(state);
        for (int k = 0; k < 27; ++k) {
            probes->radiance[0][i].channel[k / 9].c[k % 9] = (float)(8.0 * fixture_random(state) - 4.0);
        }
    }
    cut_at_random(probes, level, corner, (const int32_t(*)[3])cell, cells);
}

static void test_random_levels(void)
{
    folder_start(FOLDER);
    const lmb_lattice fine = {.spacing = 0.3f, .min = {-9, 3, 5}, .size = {7, 6, 5}};
    lmb_probes *const probes = fixture_random_probes(&fine, 0.7, 0.7, 4.0, 7);
    uint64_t state = 99;
    for (int i = 1; i < 4; ++i) {
        const lmb_lattice coarse = {.spacing = 0.3f * (float)(1 << i), .min = {-5, -2, 1}, .size = {5, 4, 3}};
        lmb_probes *const level = fixture_random_probes(&coarse, i == 2 ? 0.0 : 0.8, 0.7, 4.0, (uint64_t)i);
        CHECK(lmb_probes_add_level(probes, &coarse, (const int32_t(*)[3])level->point, level->count) == LMB_OK,
              "level %d", i);
        lmb_probes_destroy(level);
    }
    add_random_cuts(probes, 0, &state);
    add_random_cuts(probes, 1, &state);
    add_random_cuts(probes, 2, &state); /* has no probes, only ghosts */
    CHECK(probes->cut.count > 40 && probes->ghost_count > 200, "%u cells, %d ghosts", probes->cut.count,
          probes->ghost_count);
    write_probes(probes);
    lmb_probes *const read = read_probes();
    if (read) {
        check_equal(read, probes, 4.0);
    }
    /* Written again, the file's bytes are the same: halfs stay halfs. */
    unsigned char *first = NULL, *second = NULL;
    size_t first_size = 0, second_size = 0;
    CHECK(lmb_file_read(PATH, &first, &first_size, NULL) == LMB_OK, "read");
    if (read) {
        write_probes(read);
    }
    CHECK(lmb_file_read(PATH, &second, &second_size, NULL) == LMB_OK, "read");
    CHECK(first_size == second_size && memcmp(first, second, first_size) == 0, "%zu and %zu bytes differ", first_size,
          second_size);
    free(first);
    free(second);
    lmb_probes_destroy(read);
    lmb_probes_destroy(probes);
}

/* ------------------------------------------------------------------------------------------ edited files */

static void check_light(const lmb_probes *probes, lmb_vec3d at, double expected)
{
    CHECK_NEAR(lmb_probes_light(probes, 0, at).channel[0].c[0], expected, fabs(expected) * 0x1p-9, "at (%g, %g, %g)",
               at.x, at.y, at.z);
}

static lmb_probes *read_edited(bool edited)
{
    CHECK(edited, "the file was not edited");
    return read_probes();
}

static void test_edited_values(void)
{
    folder_start(FOLDER);
    lmb_probes *const probes = cut_fixture_probes();
    write_probes(probes);
    const lmb_vec3d in_cell = {-1.95, 0.1, 0.1}; /* a tenth and a fifth into cell (-4, 0, 0), below its plane */
    const double own = cut_fixture_light(0, in_cell), jump = cut_fixture_jump(0, 0) * 0.1;
    lmb_probes *read = read_edited(vdb_editor_multiply(PATH, "sh_0", 0.0f));
    if (read) {
        /* Of the ghosts at x = 1, what was theirs; of the probes at x = 0 nothing. */
        const lmb_vec3d right = {-1.5, 0.1, 0.1};
        check_light(read, in_cell, 0.1 * cut_fixture_light(0, right) + jump);
        CHECK_NEAR(lmb_probes_light(read, 0, in_cell).channel[0].c[1], own + 1.0 + jump, 0.02, "sh_1 was left alone");
    }
    lmb_probes_destroy(read);
    write_probes(probes);
    read = read_edited(vdb_editor_multiply(PATH, "sh_0_ghosts", 0.0f));
    if (read) {
        const lmb_vec3d left = {-2.0, 0.1, 0.1};
        check_light(read, in_cell, 0.9 * cut_fixture_light(0, left));
    }
    lmb_probes_destroy(read);
    write_probes(probes);
    read = read_edited(vdb_editor_multiply(PATH, "sh_0_level_1", 2.0f));
    if (read) {
        const lmb_vec3d coarse = {0.5, 1.5, 0.5};
        check_light(read, coarse, 2.0 * (CUT_FIXTURE_COARSE_MORE + cut_fixture_light(0, coarse)));
    }
    lmb_probes_destroy(read);
    lmb_probes_destroy(probes);
}

/* Voxels that are gone take their cut cells along: then a cell is plain where it has eight probes, or not there. */
static void test_removed_voxels(void)
{
    static const struct {
        const char *suffix;
        int32_t voxel[3];
        uint32_t cells; /* that are left */
        lmb_vec3d at;   /* in what was the cell */
        bool is_there;  /* as a plain one */
    } cases[] = {
        /* The first and the second ghost of point (-3, 0, 0), and the only one of (-4, 4, 4) */
        {"_ghosts", {-12, 0, 0}, 5, {-1.9, 0.1, 0.2}, true},
        {"_ghosts", {-11, 0, 0}, 5, {-1.45, 0.1, 0.2}, true},
        {"_ghosts", {-16, 16, 16}, 5, {-1.9, 1.8, 1.8}, false},
        {"", {-4, 0, 0}, 5, {-1.9, 0.2, 0.2}, false},
        {"", {0, 4, 0}, 6, {-0.1, 1.9, 0.2}, false},
        {"_level_1_ghosts", {4, 4, 0}, 5, {0.2, 0.3, 0.4}, true},
    };
    folder_start(FOLDER);
    lmb_probes *const probes = cut_fixture_probes();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        write_probes(probes);
        lmb_probes *const read = read_edited(vdb_editor_remove(PATH, cases[i].suffix, cases[i].voxel));
        if (read) {
            CHECK(read->cut.count == cases[i].cells, "case %zu: %u cells are cut", i, read->cut.count);
            CHECK(read->count == probes->count - 1, "case %zu: %d probes", i, read->count);
            const double more = cases[i].at.x > 0.0 ? CUT_FIXTURE_COARSE_MORE : 0.0;
            check_light(read, cases[i].at, cases[i].is_there ? cut_fixture_light(0, cases[i].at) + more : 0.0);
        }
        lmb_probes_destroy(read);
    }
    lmb_probes_destroy(probes);
}

static void test_broken_structure(void)
{
    folder_start(FOLDER);
    lmb_probes *const probes = cut_fixture_probes();
    write_probes(probes);
    CHECK(vdb_editor_drop_metadata(PATH, "validity", "lambent_cut_cells"), "drop");
    check_refused(LMB_ERROR_FORMAT, "grid validity has no usable lambent_cut_cells");
    CHECK(vdb_editor_drop_set(PATH, "_ghosts"), "drop");
    lmb_probes *const plain = read_probes(); /* who drops both wants a plain level */
    CHECK(plain && plain->cut.count == 2 && plain->ghost_count == 12, "%u cells", plain ? plain->cut.count : 0);
    lmb_probes_destroy(plain);
    write_probes(probes);
    CHECK(vdb_editor_drop_set(PATH, "_level_1_ghosts"), "drop");
    lmb_probes *const without = read_probes();
    CHECK(without && without->cut.count == 4 && without->ghost_count == 26, "%u cells",
          without ? without->cut.count : 0);
    lmb_probes_destroy(without);
    write_probes(probes);
    CHECK(vdb_editor_drop_metadata(PATH, "validity", "lambent_levels"), "drop");
    check_refused(LMB_ERROR_FORMAT, "lambent_levels");
    write_probes(probes);
    CHECK(vdb_editor_drop_grid(PATH, "sh_3_ghosts"), "drop");
    check_refused(LMB_ERROR_FORMAT, "no grid sh_3_ghosts");
    write_probes(probes);
    CHECK(vdb_editor_drop_grid(PATH, "validity_level_1"), "drop");
    check_refused(LMB_ERROR_FORMAT, "no grid validity_level_1");
    write_probes(probes);
    CHECK(vdb_editor_set_spacing(PATH, "validity_level_1", 1.5), "set");
    check_refused(LMB_ERROR_FORMAT, "spacing");
    write_probes(probes);
    CHECK(vdb_editor_set_spacing(PATH, "sh_4_ghosts", 0.25), "set");
    check_refused(LMB_ERROR_FORMAT, "grids sh_4_ghosts and validity_ghosts differ in spacing");
    write_probes(probes);
    CHECK(vdb_editor_set_spacing(PATH, "validity_ghosts", 0.25), "set");
    check_refused(LMB_ERROR_FORMAT, "validity_ghosts has not a quarter of the spacing");
    for (int32_t version = 1; version < 5; ++version) {
        write_probes(probes);
        CHECK(vdb_editor_set_version(PATH, "sh_0", version), "set");
        if (version != 3) {
            check_refused(LMB_ERROR_VERSION, "is not 3");
        }
    }
    lmb_probes_destroy(probes);
}

/* Bytes of cut cells that are changed one by one, and lists that are cut short: refused, or probes that are whole. */
static void test_broken_cells(void)
{
    folder_start(FOLDER);
    lmb_probes *const probes = cut_fixture_probes();
    write_probes(probes);
    char *const text = vdb_editor_text(PATH, "validity", "lambent_cut_cells");
    CHECK(text && strlen(text) == 192, "the text is not there");
    const size_t length = text ? strlen(text) : 0;
    int refused = 0, taken = 0;
    for (size_t i = 0; i < length; i += 7) {
        const char kept = text[i];
        text[i] = i % 4 == 1 ? '\0' : i % 2 == 0 ? 'Q' : '9';
        CHECK(vdb_editor_set_text(PATH, "validity", "lambent_cut_cells", text), "set");
        text[i] = kept;
        lmb_probes *read = NULL;
        lmb_error error = {""};
        const lmb_result result = lmb_vdb_read(PATH, &read, NULL, NULL, &error);
        CHECK(result == LMB_OK || (result == LMB_ERROR_FORMAT && strstr(error.message, "cut")), "character %zu: %d, %s",
              i, result, error.message);
        CHECK(!read || lmb_probes_validate(read, &error) == LMB_OK, "character %zu: %s", i, error.message);
        refused += result != LMB_OK;
        taken += result == LMB_OK;
        lmb_probes_destroy(read);
    }
    CHECK(refused > 5 && taken > 5, "%d refused, %d taken", refused, taken);
    static const char *const broken[] = {"!", "AAAA", "AAA", "="};
    for (size_t i = 0; i < 4; ++i) {
        CHECK(vdb_editor_set_text(PATH, "validity", "lambent_cut_cells", broken[i]), "set");
        if (strcmp(broken[i], "=") != 0) {
            check_refused(LMB_ERROR_FORMAT, "lambent_cut_cells is broken");
        }
    }
    free(text);
    lmb_probes_destroy(probes);
}

/* Wedges that no cell has: edited into a file, each child of the three planes of the cell with one. */
static void test_broken_wedges(void)
{
    static const struct {
        const char *name;
        int plane, side;
        uint8_t child;
    } cases[] = {
        {"beside itself", 1, 1, CUT_BLEND(1)},
        {"of a plane that is not there", 1, 1, CUT_BLEND(3)},
        {"of the last number", 2, 1, 255},
        {"without a region beside it", 1, 0, CUT_BLEND(2)},
        {"of a plane without regions", 1, 1, CUT_BLEND(0)},
        {"between planes further on", 0, 0, CUT_BLEND(1)},
    };
    folder_start(FOLDER);
    lmb_probes *const probes = cut_fixture_probes();
    write_probes(probes);
    lmb_probes_destroy(probes);
    char *const text = vdb_editor_text(PATH, "validity_level_1", "lambent_cut_cells");
    unsigned char bytes[512];
    size_t size = sizeof bytes, wedge = 0;
    CHECK(text && strlen(text) < sizeof bytes && lmb_base64_decode(text, bytes, &size), "the text is not there");
    for (size_t i = 0; i + 12 < size; ++i) { /* the first plane's children, behind its normal and offset */
        wedge = bytes[i] == 1 && bytes[i + 1] == 2 && bytes[i + 11] == CUT_BLEND(2) ? i : wedge;
    }
    CHECK(wedge > 0, "the wedge is not there");
    for (size_t i = 0; text && wedge > 0 && i < sizeof cases / sizeof cases[0]; ++i) {
        unsigned char *const child = &bytes[wedge + 10 * (size_t)cases[i].plane + (size_t)cases[i].side];
        const unsigned char kept = *child;
        char edited[sizeof bytes];
        *child = cases[i].child;
        lmb_base64_encode(bytes, size, edited);
        *child = kept;
        CHECK(vdb_editor_set_text(PATH, "validity_level_1", "lambent_cut_cells", edited), "set");
        const int failures = test_failures;
        check_refused(LMB_ERROR_FORMAT, "a cut cell has planes or regions that it cannot have");
        CHECK(test_failures == failures, "a wedge %s", cases[i].name);
    }
    free(text);
}

/* ---------------------------------------------------------------------------------------------- the rest */

/* What the format does not hold of levels. */
static void test_refused_levels(void)
{
    static const lmb_vdb_metadata metadata = {"{}", ""};
    folder_start(FOLDER);
    lmb_probes *probes = NULL;
    lmb_error error = {""};
    CHECK(lmb_probes_create(&probes) == LMB_OK, "create");
    CHECK(lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_ERROR_ARGUMENT, "no level");
    lmb_probes_destroy(probes);
    probes = cut_fixture_probes();
    probes->level[1].lattice.spacing = 1.5f;
    CHECK(lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_ERROR_ARGUMENT && strstr(error.message, "twice"), "%s",
          error.message);
    probes->level[1].lattice.spacing = 1.0f;
    CHECK(lmb_lattice_turn(&probes->level[1].lattice, (lmb_vec3d){0, 0, 1}, (lmb_vec3d){0, 1, 0}), "turn");
    CHECK(lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_ERROR_ARGUMENT && strstr(error.message, "turned"), "%s",
          error.message);
    memset(probes->level[1].lattice.axis, 0, sizeof probes->level[1].lattice.axis);
    probes->cut.corner[0][0] = 17;
    CHECK(lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_ERROR_ARGUMENT && strstr(error.message, "cut cell"),
          "%s", error.message);
    lmb_probes_destroy(probes);

    const lmb_lattice lattice = {.spacing = 1.0f, .size = {2, 2, 2}};
    static const int32_t at_one_point[65][3] = {{0}};
    for (int32_t count = 64; count <= 65; ++count) {
        int32_t first;
        probes = fixture_probes(&lattice, NULL);
        CHECK(lmb_probes_add_ghosts(probes, 0, at_one_point, count, &first) == LMB_OK, "%d ghosts", count);
        const lmb_result result = lmb_vdb_write(PATH, probes, &metadata, &error);
        CHECK(result == (count > 64 ? LMB_ERROR_ARGUMENT : LMB_OK), "%d ghosts of a point: %s", count, error.message);
        lmb_probes_destroy(probes);
    }
}

/* Many ghosts of a point, and those as far out as their voxels go. */
static void test_many_ghosts(void)
{
    static const lmb_vdb_metadata metadata = {"{}", ""};
    const int32_t far_out = INT32_MAX / 4 - 1;
    folder_start(FOLDER);
    for (int side = -1; side <= 1; side += 2) {
        for (int32_t beyond = 0; beyond <= 1; ++beyond) {
            lmb_lattice lattice = {.spacing = 0.3f, .size = {3, 3, 3}};
            int32_t point[64][3], first;
            for (int axis = 0; axis < 3; ++axis) {
                lattice.min[axis] = side * (far_out + beyond) - 1;
                for (int i = 0; i < 64; ++i) {
                    point[i][axis] = lattice.min[axis] + 1;
                }
            }
            lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 1.0, 5);
            CHECK(lmb_probes_add_ghosts(probes, 0, (const int32_t(*)[3])point, 64, &first) == LMB_OK, "ghosts");
            for (int32_t i = 0; i < 64; ++i) {
                probes->validity[first + i] = (float)i / 64.0f;
            }
            lmb_error error = {""};
            const lmb_result result = lmb_vdb_write(PATH, probes, &metadata, &error);
            CHECK(result == (beyond ? LMB_ERROR_ARGUMENT : LMB_OK), "%d at %d: %s", result, point[0][0], error.message);
            lmb_probes *const read = beyond ? NULL : read_probes();
            CHECK(!read || (read->ghost_count == 64 && memcmp(read->point[first], point, sizeof point) == 0),
                  "ghosts at %d", point[0][0]);
            double sum = 0.0;
            for (int32_t i = 0; read && i < 64; ++i) {
                sum += (double)read->validity[first + i] * 64.0; /* in another order: no cell names them */
            }
            CHECK(!read || sum == 63.0 * 32.0, "validity of ghosts at %d: %g", point[0][0], sum);
            lmb_probes_destroy(read);
            lmb_probes_destroy(probes);
        }
    }
}

static void test_base64(void)
{
    /* RFC 4648, section 10 */
    static const char *const cases[][2] = {{"", ""},
                                           {"f", "Zg=="},
                                           {"fo", "Zm8="},
                                           {"foo", "Zm9v"},
                                           {"foob", "Zm9vYg=="},
                                           {"fooba", "Zm9vYmE="},
                                           {"foobar", "Zm9vYmFy"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char text[16];
        unsigned char bytes[16];
        size_t size = 99;
        const size_t length = strlen(cases[i][0]);
        CHECK(lmb_base64_length(length) == strlen(cases[i][1]), "%s", cases[i][0]);
        lmb_base64_encode(cases[i][0], length, text);
        CHECK(strcmp(text, cases[i][1]) == 0, "%s gives %s", cases[i][0], text);
        CHECK(lmb_base64_decode(text, bytes, &size) && size == length && memcmp(bytes, cases[i][0], size) == 0, "%s",
              text);
    }
    unsigned char bytes[256], back[256];
    char text[400];
    size_t size = 0;
    for (int i = 0; i < 256; ++i) {
        bytes[i] = (unsigned char)(i * 77);
    }
    lmb_base64_encode(bytes, sizeof bytes, text);
    CHECK(lmb_base64_decode(text, back, &size) && size == 256 && memcmp(bytes, back, 256) == 0, "all bytes");
    static const char *const broken[] = {"Zg=A", "Z g=", "Zg===", "Zm9v\n", "-_AA"};
    for (size_t i = 0; i < sizeof broken / sizeof broken[0]; ++i) {
        CHECK(!lmb_base64_decode(broken[i], back, &size), "'%s' is taken", broken[i]);
    }
}

static void test_vdb_print(void)
{
    if (access("/usr/bin/vdb_print", X_OK) != 0) {
        test_skip("vdb_print is not installed");
        return;
    }
    folder_start(FOLDER);
    lmb_probes *const probes = cut_fixture_probes();
    write_probes(probes);
    lmb_probes_destroy(probes);
    CHECK(system("/usr/bin/vdb_print -l -m '" PATH "' > '" FOLDER "/printed' 2>&1") == 0, "vdb_print");
    unsigned char *text = NULL;
    size_t bytes = 0;
    CHECK(lmb_file_read(FOLDER "/printed", &text, &bytes, NULL) == LMB_OK, "read");
    static const char *const expected[] = {
        "Name: sh_8\n",         "Name: validity\n",
        "Name: sh_0_level_1\n", "Name: validity_level_1\n",
        "Name: sh_8_ghosts\n",  "Name: validity_level_1_ghosts\n",
        "lambent_levels: 2",    "lambent_cut_cells: ",
        "voxel size: 0.125",
    };
    for (size_t i = 0; text && i < sizeof expected / sizeof expected[0]; ++i) {
        CHECK(strstr((const char *)text, expected[i]), "vdb_print does not show '%s'", expected[i]);
    }
    free(text);
}

static const test_case cases[] = {
    {"levels, ghosts and cut cells come back", test_round_trip},
    {"random levels come back", test_random_levels},
    {"edited values", test_edited_values},
    {"removed voxels", test_removed_voxels},
    {"metadata and grids that are gone", test_broken_structure},
    {"broken cut cells", test_broken_cells},
    {"broken wedges", test_broken_wedges},
    {"levels that the format does not hold", test_refused_levels},
    {"many ghosts, far out", test_many_ghosts},
    {"bytes as text", test_base64},
    {"vdb_print shows levels and ghosts", test_vdb_print},
};
TEST_MAIN(cases)
