/* `lambent bench` on made-up volumes: every way to hold light in every size, alone and together, and its picture. */
#define _POSIX_C_SOURCE 200809L
#include <cjson/cJSON.h>

#include <lambent/file.h>

#include "command_fixture.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/bench"
#define PLOT OUTPUT "/bench.svg"
#define BENCH LMB_COMMAND " bench --repeat 1 --samples 600 "

static const char *const names[] = {"lambent",     "lambent.batch",       "lambent.compact", "lambent.compact.batch",
                                    "lambent.cut", "lambent.cut.batch",   "dense.fp32",      "dense.fp32.prefetch",
                                    "dense.fp16",  "dense.fp16.prefetch", "lambent.tiles",   "lambent.tiles.batch",
                                    "openvdb"};
enum { NAMES = sizeof names / sizeof names[0], SIZES = 2, LOADS = 2, PATTERNS = 2 };

static double number_of(const cJSON *object, const char *key)
{
    return cJSON_GetNumberValue(cJSON_GetObjectItem(object, key));
}

/* Counts a row where it belongs; its error is what its form of storage allows. */
static void row_count(const cJSON *row, int found[NAMES][SIZES][LOADS][PATTERNS])
{
    const char *const name = cJSON_GetStringValue(cJSON_GetObjectItem(row, "name"));
    const char *const pattern = cJSON_GetStringValue(cJSON_GetObjectItem(row, "pattern"));
    const double error = number_of(row, "rel_rmse"), threads = number_of(row, "threads");
    CHECK(error >= 0.0 && error < (strstr(name, "compact") ? 6e-3 : 1e-3), "%s, %s: %g", name, pattern, error);
    CHECK(number_of(row, "ns_per_sample") > 0.0 && number_of(row, "bytes_per_probe") > 27.0, "%s, %s", name, pattern);
    CHECK(threads == 1.0 || threads == 2.0, "%s: %g threads", name, threads);
    for (int i = 0; i < NAMES; ++i) {
        found[i][number_of(row, "probes") > 1500.0][threads > 1.0][strcmp(pattern, "random") == 0] +=
            strcmp(name, names[i]) == 0;
    }
}

static bool bench_run(char *printed, size_t size)
{
    mkdir(OUTPUT, 0777);
    const int status = run(printed, size, BENCH "--house 3000 --house 700 --threads 2 --json --plot " PLOT);
    CHECK(status == 0, "%s", printed);
    return status == 0;
}

static void every_row_is_there_once(void)
{
    static char printed[1 << 16];
    int found[NAMES][SIZES][LOADS][PATTERNS] = {{{{0}}}};
    if (!bench_run(printed, sizeof printed)) {
        return;
    }
    cJSON *const json = cJSON_Parse(printed);
    const cJSON *row;
    cJSON_ArrayForEach(row, cJSON_GetObjectItem(json, "samplers"))
    {
        row_count(row, found);
    }
    cJSON_Delete(json);
    for (int i = 0; i < NAMES * SIZES * LOADS * PATTERNS; ++i) {
        const int times = (&found[0][0][0][0])[i];
        CHECK(times == 1, "%s, case %d: %d times", names[i / (SIZES * LOADS * PATTERNS)],
              i % (SIZES * LOADS * PATTERNS), times);
    }
}

/* Reads a tag and keeps the names of those that are open. @return what follows, NULL where it is malformed */
static const char *tag_read(const char *at, char open[16][16], int *depth)
{
    const bool closes = at[1] == '/';
    const char *const name = at + 1 + closes;
    const size_t length = strcspn(name, " />");
    const char *end = name + length;
    for (bool quoted = false; *end && (quoted || *end != '>'); ++end) {
        quoted ^= *end == '\'';
    }
    if (*end == '\0' || length == 0 || length > 15 || (closes && *depth == 0) || (!closes && *depth == 16)) {
        return NULL;
    }
    if (closes) {
        --*depth;
        return strncmp(open[*depth], name, length) == 0 && open[*depth][length] == '\0' ? end + 1 : NULL;
    }
    if (end[-1] != '/') {
        snprintf(open[*depth], sizeof open[0], "%.*s", (int)length, name);
        ++*depth;
    }
    return end + 1;
}

/* As far as our pictures go: tags that match, values in single quotes, characters by their numbers. */
static bool is_well_formed(const char *text)
{
    char open[16][16];
    int depth = 0, elements = 0;
    for (const char *at = text; *at;) {
        if (*at == '<') {
            at = tag_read(at, open, &depth);
            if (!at) {
                return false;
            }
            ++elements;
        } else if (*at == '&' && at[1] != '#') {
            return false;
        } else {
            ++at;
        }
    }
    return depth == 0 && elements > 0;
}

static int occurrences(const char *text, const char *of)
{
    int count = 0;
    for (const char *at = text; (at = strstr(at, of)); at += strlen(of)) {
        ++count;
    }
    return count;
}

static void malformed_is_known(void)
{
    CHECK(is_well_formed("<a b='>'>&#60;<c/></a>"), "a good one");
    static const char *const bad[] = {"<a>", "</a>", "<a></b>", "<a b='></a>", "<a>&lt</a>", "<", "text"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        CHECK(!is_well_formed(bad[i]), "%s", bad[i]);
    }
}

/* Four plots: a line and two points of each sampler in every one, and a row of the table. */
static void picture_shows_all(void)
{
    static char printed[1 << 16];
    unsigned char *bytes = NULL;
    size_t size = 0;
    lmb_error error = {{0}};
    if (!bench_run(printed, sizeof printed)) {
        return;
    }
    const lmb_result read = lmb_file_read(PLOT, &bytes, &size, &error);
    CHECK(read == LMB_OK, "%s", error.message);
    char *const text = read == LMB_OK ? malloc(size + 1) : NULL;
    if (text) {
        snprintf(text, size + 1, "%.*s", (int)size, (const char *)bytes);
        CHECK(strncmp(text, "<svg ", 5) == 0 && is_well_formed(text), "see %s", PLOT);
        CHECK(occurrences(text, "nan") == occurrences(text, "nanovdb") && !strstr(text, "inf"), "see %s", PLOT);
        for (int i = 0; i < NAMES; ++i) {
            char line[64], point[64], label[64];
            snprintf(line, sizeof line, "<title>%s</title><polyline", names[i]);
            snprintf(point, sizeof point, "<title>%s: ", names[i]);
            snprintf(label, sizeof label, ">%s</text>", names[i]);
            CHECK(occurrences(text, line) == 4 && occurrences(text, point) == 8 && occurrences(text, label) == 5,
                  "%s: %d, %d, %d", names[i], occurrences(text, line), occurrences(text, point),
                  occurrences(text, label));
        }
    }
    free(text);
    free(bytes);
}

static void wrong_use_is_refused(void)
{
    CHECK_RUN(2, "--house N", "%s", BENCH);
    CHECK_RUN(2, "--threads takes", "%s", BENCH "--house 700 --threads 0");
    CHECK_RUN(2, "--house takes", "%s", BENCH "--house 0");
    CHECK_RUN(2, "more than eight", "%s", BENCH "a b c d e f g h i");
    CHECK_RUN(1, "/dev/null", "%s", BENCH "--house 700 --plot /dev/null/x.svg");
    CHECK_RUN(3, "house: no cell", "%s", BENCH "--house 1");
}

static const test_case cases[] = {
    {"every_row_is_there_once", every_row_is_there_once},
    {"malformed_is_known", malformed_is_known},
    {"picture_shows_all", picture_shows_all},
    {"wrong_use_is_refused", wrong_use_is_refused},
};

TEST_MAIN(cases)
