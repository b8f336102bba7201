/* Local sets in both files: they come back as they were, and no broken section is believed. */
#include <lambent/probe_local.h>

#include "harness.h"
#include "local_fixture.h"

#include <lambent/file.h>
#include <lambent/local_set_format.h>
#include <lambent/pack.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>

#include <stddef.h>
#include <sys/stat.h>

#define OUTPUT LMB_TEST_OUTPUT_DIR "/probe_local"

/* A volume of some probes, one key light and three local sets. */
static lmb_probes *probes_make(void)
{
    const lmb_lattice lattice = {.spacing = 0.5f, .min = {-3, -3, -3}, .size = {6, 5, 7}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 2.0, 7);
    uint64_t state = 99;
    probes->key_light_count = 1;
    probes->key_light[0] = (lmb_key_light){{0.0f, 1.0f, 0.0f}, {{2.0f, 1.0f, 0.5f}}};
    local_fixture_add(probes, &state);
    lmb_error error = {{0}};
    CHECK(lmb_probes_validate(probes, &error) == LMB_OK, "%s", error.message);
    return probes;
}

static double largest_difference(const lmb_sh3_rgb *a, const lmb_sh3_rgb *b)
{
    double largest = 0.0;
    for (int c = 0; c < 27; ++c) {
        largest = fmax(largest, fabs((double)(a->channel[c / 9].c[c % 9] - b->channel[c / 9].c[c % 9])));
    }
    return largest;
}

static void volume_has(const lmb_volume *volume, const lmb_probes *probes, double error)
{
    static lmb_sh3_rgb radiance[LMB_LOCAL_SET_MOST];
    static float seen[LMB_LOCAL_SET_MOST][LMB_KEY_LIGHTS_MOST];
    CHECK(lmb_volume_local_set_count(volume) == LOCAL_FIXTURE_SETS, "%u", lmb_volume_local_set_count(volume));
    for (uint32_t i = 0; i < lmb_volume_local_set_count(volume); ++i) {
        const lmb_probe_local *const local = &probes->local[i];
        const lmb_local_set set = lmb_volume_local_set_get(volume, i);
        CHECK(strcmp(set.name, local_fixture_name[i]) == 0 && set.node == 10 + (int)i && set.place == (int)i,
              "set %u: %s", i, set.name);
        CHECK(memcmp(&set.frame, &local->frame, sizeof set.frame) == 0, "set %u: its frame", i);
        lmb_volume_local_set_light(volume, i, radiance, seen);
        for (uint32_t k = 0; k < lmb_local_frame_count(&set.frame); ++k) {
            const double off = largest_difference(&radiance[k], &local->radiance[k]);
            CHECK(off <= error, "set %u, probe %u: off by %g", i, k, off);
            CHECK_NEAR(seen[k][0], local->key_visibility[k][0], 0.51 / 255.0, "set %u, probe %u", i, k);
            CHECK(seen[k][1] == 0.0f, "set %u, probe %u", i, k);
        }
    }
    CHECK(lmb_volume_local_set_find(volume, "statue") == 0, "the first of that name");
    CHECK(lmb_volume_local_set_find(volume, "plant in a pot") == 1, "the second");
    CHECK(lmb_volume_local_set_find(volume, "plant") == LOCAL_FIXTURE_SETS, "there is none");
}

static void run_time_file_has_them(void)
{
    lmb_probes *const probes = probes_make();
    for (int form = 0; form < LMB_VOLUME_FORMS; ++form) {
        unsigned char *data = NULL;
        size_t size = 0;
        lmb_volume *volume = NULL;
        CHECK(lmb_pack_as((lmb_volume_form)form, probes, &data, &size, NULL) == LMB_OK &&
                  lmb_volume_open_memory(data, size, &volume) == LMB_OK,
              "form %d", form);
        if (volume) {
            /* Halfs below 2 are 2^-11 off at most, bytes of squares by half of a step, (127^2 - 126^2) / 127^2 of
             * sqrt(5) times 2. */
            volume_has(volume, probes, form == LMB_VOLUME_HALFS ? 0x1p-11 : 0.04);
        }
        lmb_volume_close(volume);
        free(data);
    }
    lmb_probes_destroy(probes);
}

static void exchange_file_has_them(void)
{
    lmb_probes *const probes = probes_make();
    lmb_probes *read = NULL;
    lmb_error error = {{0}};
    mkdir(LMB_TEST_OUTPUT_DIR, 0777);
    mkdir(OUTPUT, 0777);
    const lmb_vdb_metadata metadata = {"{}", "0"};
    CHECK(lmb_vdb_write(OUTPUT "/sets.vdb", probes, &metadata, &error) == LMB_OK &&
              lmb_vdb_read(OUTPUT "/sets.vdb", &read, NULL, NULL, &error) == LMB_OK,
          "%s", error.message);
    for (uint32_t i = 0; read && i < LOCAL_FIXTURE_SETS && i < read->local_count; ++i) {
        const lmb_probe_local *const a = &probes->local[i], *const b = &read->local[i];
        const size_t count = lmb_local_frame_count(&a->frame);
        CHECK(strcmp(a->name, b->name) == 0 && a->node == b->node && a->place == b->place, "set %u: %s", i, b->name);
        CHECK(memcmp(&a->frame, &b->frame, sizeof a->frame) == 0, "set %u: its frame", i);
        CHECK(memcmp(a->validity, b->validity, count * sizeof *a->validity) == 0, "set %u: validity", i);
        CHECK(memcmp(a->key_visibility, b->key_visibility, count * sizeof *a->key_visibility) == 0, "set %u: keys", i);
    }
    CHECK(read && read->local_count == LOCAL_FIXTURE_SETS, "all of them");
    unsigned char *one = NULL, *two = NULL;
    size_t one_size = 0, two_size = 0;
    CHECK(read && lmb_pack(probes, &one, &one_size, NULL) == LMB_OK &&
              lmb_pack(read, &two, &two_size, NULL) == LMB_OK && one_size == two_size &&
              memcmp(one, two, one_size) == 0,
          "packed again they are the same bytes");
    free(one);
    free(two);
    lmb_probes_destroy(read);
    lmb_probes_destroy(probes);
}

/* What tests/golden/local_sets.* hold, files of versions 5 (.lmb) and 3 (.vdb), is read for ever. Where it is not these
 * probes, files of today lie in the tests' output folder. */
static void golden_files_have_them(void)
{
    lmb_probes *const probes = probes_make();
    lmb_probes *read = NULL;
    unsigned char *golden = NULL, *now = NULL, *then = NULL;
    size_t golden_size = 0, now_size = 0, then_size = 0;
    lmb_error error = {{0}};
    CHECK(lmb_pack(probes, &now, &now_size, NULL) == LMB_OK, "packed");
    CHECK(lmb_file_read(LMB_GOLDEN_DIR "/local_sets.lmb", &golden, &golden_size, &error) == LMB_OK &&
              lmb_vdb_read(LMB_GOLDEN_DIR "/local_sets.vdb", &read, NULL, NULL, &error) == LMB_OK &&
              lmb_pack(read, &then, &then_size, NULL) == LMB_OK,
          "%s", error.message);
    const bool as_stored = now && golden && now_size == golden_size && memcmp(now, golden, now_size) == 0;
    const bool as_read = now && then && now_size == then_size && memcmp(now, then, now_size) == 0;
    CHECK(as_stored, "local_sets.lmb has %zu bytes, packed they are %zu", golden_size, now_size);
    CHECK(as_read, "local_sets.vdb packs to %zu bytes, not to these %zu", then_size, now_size);
    if (!as_stored || !as_read) {
        static const lmb_vdb_metadata metadata = {"{}", "0"};
        mkdir(LMB_TEST_OUTPUT_DIR, 0777);
        mkdir(OUTPUT, 0777);
        lmb_file_write(OUTPUT "/local_sets.lmb", now, now_size, NULL);
        lmb_vdb_write(OUTPUT "/local_sets.vdb", probes, &metadata, NULL);
    }
    free(golden);
    free(now);
    free(then);
    lmb_probes_destroy(read);
    lmb_probes_destroy(probes);
}

/* ------------------------------------------------------------------------------------------- hostile files */

typedef struct forged {
    unsigned char *data;
    size_t size;
    lmb_volume_layout layout;
    size_t local_bytes;
} forged;

static forged forged_make(void)
{
    forged file = {.data = NULL};
    lmb_probes *const probes = probes_make();
    unsigned char *data = NULL;
    CHECK(lmb_pack(probes, &data, &file.size, NULL) == LMB_OK, "packed");
    lmb_probes_destroy(probes);
    file.data = malloc(file.size); /* of just that size, so that a read beyond is found */
    memcpy(file.data, data, file.size);
    free(data);
    lmb_volume_header header;
    memcpy(&header, file.data, sizeof header);
    CHECK(lmb_volume_layout_find(&header, &file.layout), "laid out");
    file.local_bytes = (size_t)header.local_bytes;
    return file;
}

/* Whether it opens; then all that its sets hold is finite. */
static bool opens(forged *file)
{
    static lmb_sh3_rgb radiance[LMB_LOCAL_SET_MOST];
    const uint64_t checksum =
        lmb_volume_hash(file->data + LMB_VOLUME_CHECKSUM_START, file->size - LMB_VOLUME_CHECKSUM_START);
    memcpy(file->data + offsetof(lmb_volume_header, checksum), &checksum, sizeof checksum);
    lmb_volume *volume = NULL;
    if (lmb_volume_open_memory(file->data, file->size, &volume) != LMB_OK) {
        return false;
    }
    for (uint32_t i = 0; i < lmb_volume_local_set_count(volume); ++i) {
        const lmb_local_set set = lmb_volume_local_set_get(volume, i);
        lmb_volume_local_set_light(volume, i, radiance, NULL);
        bool finite = strlen(set.name) < 100 && lmb_local_frame_is_valid(&set.frame);
        lmb_sh3_rgb light;
        lmb_local_set_sample(&set.frame, radiance, (lmb_vec3d){1e30, (double)NAN, -0.2}, &light);
        for (uint32_t k = 0; k < 27 * lmb_local_frame_count(&set.frame); ++k) {
            finite = finite && isfinite(radiance[k / 27].channel[k % 27 / 9].c[k % 9]);
        }
        for (int k = 0; k < 27; ++k) {
            finite = finite && isfinite(light.channel[k / 9].c[k % 9]);
        }
        CHECK(finite, "set %u", i);
    }
    lmb_volume_close(volume);
    return true;
}

/* Every byte of the section, changed in several ways. */
static void forged_bytes_are_harmless(void)
{
    static const unsigned char changes[] = {0x01, 0x80, 0xff, 0x7c};
    forged file = forged_make();
    int accepted = 0, refused = 0;
    for (size_t i = 0; i < file.local_bytes; i += i < 600 ? 1 : 97) {
        unsigned char *const at = file.data + file.layout.locals + i;
        const unsigned char kept = *at;
        for (size_t c = 0; c < sizeof changes; ++c) {
            *at = (unsigned char)(kept ^ changes[c]);
            const bool accepts = opens(&file);
            accepted += accepts;
            refused += !accepts;
        }
        *at = kept;
    }
    CHECK(accepted > 0 && refused > 0, "%d accepted, %d refused", accepted, refused);
    CHECK(opens(&file), "as it was");
    free(file.data);
}

/* Four bytes of the section set to a value: refused. */
static void refuses(forged *file, size_t offset, uint32_t value, const char *what)
{
    unsigned char *const at = file->data + file->layout.locals + offset;
    uint32_t kept;
    memcpy(&kept, at, sizeof kept);
    memcpy(at, &value, sizeof value);
    CHECK(!opens(file), "%s: accepted", what);
    memcpy(at, &kept, sizeof kept);
}

static void broken_sections_are_refused(void)
{
    forged file = forged_make();
    const size_t first = sizeof(lmb_volume_locals), names_at = first + LOCAL_FIXTURE_SETS * sizeof(lmb_volume_local);
    refuses(&file, 0, 0, "no sets");
    refuses(&file, 0, LOCAL_FIXTURE_SETS - 1, "a set too few");
    refuses(&file, 0, LOCAL_FIXTURE_SETS + 1, "a set too many");
    refuses(&file, 0, UINT32_MAX, "too many sets for 32 bits of bytes");
    refuses(&file, 4, 0, "no names");
    refuses(&file, 4, 2, "names that end within a word");
    refuses(&file, 4, 0xfffffffcu, "names beyond the end");
    refuses(&file, first + offsetof(lmb_volume_local, origin) + 4, 0x7ff00000u, "an origin that is infinite");
    refuses(&file, first + offsetof(lmb_volume_local, step), 0x7fc00000u, "a step that is NaN");
    refuses(&file, first + offsetof(lmb_volume_local, step) + 4, 0x3f800000u, "steps that are skewed");
    refuses(&file, first + offsetof(lmb_volume_local, size), 0, "no probes");
    refuses(&file, first + offsetof(lmb_volume_local, size), 3, "probes of the next set");
    refuses(&file, first + offsetof(lmb_volume_local, size), 9, "more than 8");
    refuses(&file, first + offsetof(lmb_volume_local, node), UINT32_MAX, "a negative node");
    refuses(&file, first + offsetof(lmb_volume_local, name), 1000, "a name beyond the names");
    refuses(&file, first + offsetof(lmb_volume_local, probe_first), 1, "probes that overlap");
    refuses(&file, first + offsetof(lmb_volume_local, reserved), 1, "what is reserved");
    lmb_volume_locals head;
    memcpy(&head, file.data + file.layout.locals, sizeof head);
    refuses(&file, names_at + head.name_bytes - 4, 0x41414141u, "a name that does not end");
    refuses(&file, names_at + head.name_bytes, 0x7c007c00u, "light that is infinite");
    const uint64_t lengths[] = {0, 4, file.local_bytes - 4, file.local_bytes + 56, UINT64_MAX};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; ++i) {
        unsigned char *const at = file.data + offsetof(lmb_volume_header, local_bytes);
        memcpy(at, &lengths[i], sizeof lengths[i]);
        CHECK(!opens(&file), "a length of %llu: accepted", (unsigned long long)lengths[i]);
    }
    free(file.data);
}

/* ------------------------------------------------------------------------------------------------ in memory */

static void frames_that_are_none_are_refused(void)
{
    lmb_probes *const probes = probes_make();
    const lmb_local_frame good = local_fixture_frame(0);
    for (int i = 0; i < 6; ++i) {
        lmb_local_frame frame = good;
        frame.size[i % 3] = i == 0 ? 0 : i == 1 ? 9 : 2;
        frame.step[0].x = i == 2 ? NAN : frame.step[0].x;
        frame.step[1] = i == 3 ? (lmb_vec3){0.0f, 0.0f, 0.0f} : i == 4 ? frame.step[0] : frame.step[1];
        frame.origin.z = i == 5 ? (double)INFINITY : frame.origin.z;
        CHECK(lmb_probes_add_local(probes, "bad", 1, 0, &frame) == LMB_ERROR_ARGUMENT, "frame %d", i);
    }
    CHECK(lmb_probes_add_local(probes, "bad", -1, 0, &good) == LMB_ERROR_ARGUMENT, "no node");
    CHECK(probes->local_count == LOCAL_FIXTURE_SETS, "%u", probes->local_count);
    CHECK(lmb_probes_find_local(probes, 11, 1) == 1 && lmb_probes_find_local(probes, 11, 0) == -1, "by node and place");
    lmb_probes_destroy(probes);
}

/* Constant light of valid probes reaches all others; a set without any has what the levels have. */
static void dark_probes_get_light(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {-4, -4, -4}, .size = {9, 9, 9}};
    lmb_probes *const probes = fixture_probes(&lattice, NULL);
    probes->key_light_count = 1;
    probes->key_light[0] = (lmb_key_light){{0.0f, 1.0f, 0.0f}, {{1.0f, 1.0f, 1.0f}}};
    for (int32_t i = 0; i < probes->count; ++i) {
        probes->validity[i] = 1.0f;
        probes->radiance[0][i].channel[1].c[3] = (float)probes->point[i][0];
        probes->key_visibility[i][0] = 0.25f;
    }
    for (int set = 0; set < LOCAL_FIXTURE_SETS; ++set) {
        const lmb_local_frame frame = local_fixture_frame(set);
        CHECK(lmb_probes_add_local(probes, "set", set, 0, &frame) == LMB_OK, "set %d", set);
    }
    const lmb_probe_local *const large = &probes->local[2], *const solid = &probes->local[0];
    large->validity[0] = large->validity[511] = 1.0f;
    large->radiance[0].channel[2].c[5] = large->radiance[511].channel[2].c[5] = 0.75f;
    large->key_visibility[0][0] = large->key_visibility[511][0] = 0.5f;
    lmb_probes_dilate_locals(probes);
    for (uint32_t k = 0; k < 512; ++k) {
        CHECK_NEAR(large->radiance[k].channel[2].c[5], 0.75, 1e-5, "probe %u", k);
        CHECK_NEAR(large->key_visibility[k][0], 0.5, 1e-5, "probe %u", k);
    }
    for (uint32_t k = 0; k < 8; ++k) {
        const lmb_vec3d at = lmb_local_frame_position(&solid->frame, k);
        CHECK_NEAR(solid->radiance[k].channel[1].c[3], at.x, 1e-5, "probe %u", k);
        CHECK_NEAR(solid->key_visibility[k][0], 0.25, 1e-5, "probe %u", k);
    }
    lmb_probes_destroy(probes);
}

/* An object that was turned and moved takes its set along: each place of it keeps its light. */
static void sets_move_with_objects(void)
{
    lmb_probes *const probes = probes_make();
    const lmb_vec3 turn[3] = {{0.0f, 0.0f, 1.0f}, {0.6f, 0.8f, 0.0f}, {-0.8f, 0.6f, 0.0f}};
    const lmb_vec3d from = {1.0, 2.0, 3.0}, to = {-30.0, 7.0, 0.5};
    for (int set = 0; set < LOCAL_FIXTURE_SETS; ++set) {
        const lmb_probe_local *const local = &probes->local[set];
        const lmb_local_frame moved = lmb_local_frame_moved(&local->frame, from, to, turn);
        CHECK(lmb_local_frame_is_valid(&moved), "set %d", set);
        for (int i = 0; i < 50; ++i) {
            const double x = fmod(0.618 * i, 1.0) + 0.9 * set, y = fmod(0.414 * i, 1.0), z = fmod(0.732 * i, 1.0) - set;
            const double w[3] = {x - from.x, y - from.y, z - from.z};
            const lmb_vec3d then = {x, y, z};
            const lmb_vec3d now = {to.x + 0.6 * w[1] - 0.8 * w[2], to.y + 0.8 * w[1] + 0.6 * w[2], to.z + w[0]};
            const float(*const seen)[LMB_KEY_LIGHTS_MOST] = (const float(*)[LMB_KEY_LIGHTS_MOST])local->key_visibility;
            lmb_sh3_rgb a, b;
            float seen_then[LMB_KEY_LIGHTS_MOST], seen_now[LMB_KEY_LIGHTS_MOST];
            lmb_local_set_sample_with_keys(&local->frame, local->radiance, seen, then, &a, seen_then);
            lmb_local_set_sample_with_keys(&moved, local->radiance, seen, now, &b, seen_now);
            CHECK(largest_difference(&a, &b) < 1e-4, "set %d, place %d: %g", set, i, largest_difference(&a, &b));
            CHECK_NEAR(seen_then[0], seen_now[0], 1e-4, "set %d, place %d", set, i);
        }
    }
    lmb_probes_destroy(probes);
}

static const test_case cases[] = {
    {"the run-time file has them", run_time_file_has_them},
    {"the exchange file has them", exchange_file_has_them},
    {"golden files have them", golden_files_have_them},
    {"forged bytes are harmless", forged_bytes_are_harmless},
    {"broken sections are refused", broken_sections_are_refused},
    {"frames that are none are refused", frames_that_are_none_are_refused},
    {"dark probes get light", dark_probes_get_light},
    {"sets move with objects", sets_move_with_objects},
};

TEST_MAIN(cases)
