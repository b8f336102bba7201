/* Tiles as files, by the command: `bake --tile-size` writes what `pack --tile-size` makes, and `sample` says of tiles
 * what it says of the undivided volume. */
#define _POSIX_C_SOURCE 200809L
#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/tile_files.h>

#include "command_fixture.h"
#include "levels_fixture.h"
#include "local_fixture.h"
#include "variates.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/tile_files"
#define IN_OUTPUT "cd " OUTPUT " && "
#define BAKE IN_OUTPUT LMB_COMMAND " bake room.glb --quiet --spacing 0.25 --samples 4"
#define TILED BAKE " --tile-size 1"

enum { POSITIONS = 400 };

static bool level_made(void)
{
    return cornell_make(OUTPUT, OUTPUT "/room.glb");
}

/* Positions all over a volume, in it and beside it, a line each. */
static void positions_write(const lmb_volume_tiles_info *info)
{
    static char text[POSITIONS * 80];
    const lmb_vec3d low = info->bounds_min, high = info->bounds_max;
    lmb_error error = {{0}};
    uint64_t state = 5;
    size_t length = 0;
    for (int i = 0; i < POSITIONS; ++i) {
        const double x = 1.2 * variate_next(&state) - 0.1, y = 1.2 * variate_next(&state) - 0.1;
        const double z = 1.2 * variate_next(&state) - 0.1;
        length +=
            (size_t)snprintf(text + length, sizeof text - length, "%.17g %.17g %.17g 0 1 0\n",
                             low.x + x * (high.x - low.x), low.y + y * (high.y - low.y), low.z + z * (high.z - low.z));
    }
    CHECK(lmb_file_write(OUTPUT "/positions", text, length, &error) == LMB_OK, "%s", error.message);
}

/* Of a volume with levels, cut cells and objects that share a name. */
static void samples_are_the_same(void)
{
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_tile_files_stats stats = {0};
    lmb_tile_files *files = NULL;
    lmb_error error = {{0}};
    uint64_t state = 3;
    mkdir(OUTPUT, 0777);
    lmb_probes *const probes = levels_make(&levels_recipes[3]);
    local_fixture_add(probes, &state);
    CHECK(lmb_pack(probes, &data, &size, NULL) == LMB_OK, "pack");
    lmb_probes_destroy(probes);
    CHECK(lmb_file_write(OUTPUT "/whole.lmb", data, size, &error) == LMB_OK &&
              lmb_tile_files_write(data, size, 1.0, OUTPUT "/whole.lmt", &stats, &error) == LMB_OK &&
              lmb_tile_files_open(OUTPUT "/whole.lmt", &files, &error) == LMB_OK,
          "%s", error.message);
    free(data);
    if (!files) {
        return;
    }
    const lmb_volume_tiles_info info = lmb_volume_tiles_get_info(lmb_tile_files_tiles(files));
    CHECK(info.tile_count == stats.count && info.tile_bytes == stats.bytes && stats.count > 4, "%u tiles", stats.count);
    positions_write(&info);
    lmb_tile_files_close(files);
    static const char *const ways[] = {"", "--json", "--local-set statue", "--local-set 'plant in a pot'"};
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; ++i) {
        CHECK_RUN(0, NULL,
                  IN_OUTPUT "for f in lmb lmt; do " LMB_COMMAND " sample whole.$f %s <positions >$f.txt || exit 9; "
                            "done && cmp lmb.txt lmt.txt && test $(wc -l <lmb.txt) = 400",
                  ways[i]);
    }
    CHECK_RUN(3, "whole.lmt: has no local set 'nobody'",
              IN_OUTPUT LMB_COMMAND " sample whole.lmt --local-set nobody --at 1,1,1");
}

static void bakes_have_tiles(void)
{
    if (!level_made()) {
        return;
    }
    CHECK_RUN(0, NULL, "rm -rf " OUTPUT "/plain " OUTPUT "/tiled " OUTPUT "/packed && " BAKE " -o plain");
    CHECK_RUN(0, NULL, TILED " -o tiled && mkdir packed");
    CHECK_RUN(0, NULL,
              IN_OUTPUT "cmp plain/probes.lmb tiled/probes.lmb && " LMB_COMMAND
                        " pack tiled/probes.vdb -o packed/probes.lmt --tile-size 1 --quiet && cp tiled/bake.json "
                        "tiled/probes.vdb tiled/probes.lmb packed && diff -r packed tiled && ls packed | wc -l");
    CHECK_RUN(0, "tiled holds this bake",
              IN_OUTPUT LMB_COMMAND " bake room.glb --spacing 0.25 --samples 4 --tile-size 1 -o tiled");
    /* A tile that was changed, or is gone, is baked again. */
    CHECK_RUN(0, "written   tiled",
              IN_OUTPUT "rm tiled/probes_0_0_0.lmb && " LMB_COMMAND
                        " bake room.glb --spacing 0.25 --samples 4 --tile-size 1 -o tiled 2>/dev/null");
    CHECK_RUN(0, NULL, IN_OUTPUT "cp tiled/bake.json packed && diff -r packed tiled");
    /* Without, they go; what is not a bake's stays. */
    CHECK_RUN(0, NULL,
              IN_OUTPUT "touch tiled/probes_0_0_01.lmb && " LMB_COMMAND
                        " bake room.glb --quiet --spacing 0.25 --samples 4 -o tiled && rm tiled/probes_0_0_01.lmb && "
                        "test \"$(ls tiled | tr '\\n' ' ')\" = 'bake.json probes.lmb probes.vdb '");
}

static void shares_have_tiles(void)
{
    if (!level_made()) {
        return;
    }
    CHECK_RUN(0, NULL, "rm -rf " OUTPUT "/[sm][0-9] && " TILED " -o m0");
    CHECK_RUN(0, NULL, TILED " --shard 1/2 -o s1 && " TILED " --shard 2/2 -o s2");
    CHECK_RUN(0, NULL, IN_OUTPUT LMB_COMMAND " merge s1 s2 -o m1 --quiet");
    CHECK_RUN(0, NULL, IN_OUTPUT "cp m0/bake.json m1 && diff -r m0 m1 && test -f m1/probes.lmt");
    /* A share's folder goes on as a bake of all. */
    CHECK_RUN(0, NULL, TILED " --resume -o s1 && cd s1 && for f in probes*; do cmp $f ../m0/$f || exit 9; done");
}

static void tiles_that_are_missing(void)
{
    if (!level_made()) {
        return;
    }
    CHECK_RUN(0, NULL, TILED " -o broken --force && cd broken && rm probes_0_0_0.lmb && cp probes_-1_0_0.lmb x");
    CHECK_RUN(0, "irradiance", IN_OUTPUT LMB_COMMAND " sample broken/probes.lmt --at -0.5,0.5,0.5 --normal 0,1,0");
    CHECK_RUN(3, "broken/probes_0_0_0.lmb: ", IN_OUTPUT LMB_COMMAND " sample broken/probes.lmt --at 0.5,0.5,0.5");
    CHECK_RUN(3, "broken/probes_0_0_0.lmb: not the tile of broken/probes.lmt",
              IN_OUTPUT "cp broken/x broken/probes_0_0_0.lmb && " LMB_COMMAND
                        " sample broken/probes.lmt --at 0.5,0.5,0.5");
    CHECK_RUN(3, "cut.lmt: ",
              IN_OUTPUT "head -c 200 broken/probes.lmt >cut.lmt && " LMB_COMMAND " sample cut.lmt --at 0.5,0.5,0.5");
    CHECK_RUN(2, "--tile-size takes", BAKE " --tile-size 0 -o broken");
    CHECK_RUN(3, "broken/probes.lmb: is wanted undivided, not in tiles",
              IN_OUTPUT "rm broken/probes.lmb && " LMB_COMMAND " check room.glb broken --points 4 --samples 4 --quiet");
}

static const test_case cases[] = {
    {"samples are the same", samples_are_the_same},
    {"bakes have tiles", bakes_have_tiles},
    {"shares have tiles", shares_have_tiles},
    {"tiles that are missing", tiles_that_are_missing},
};

int main(void)
{
    return test_main(cases, sizeof cases / sizeof cases[0]);
}
