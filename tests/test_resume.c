/* Bakes that are killed and go on, in shares, and again: always the bytes of one that was left alone. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <signal.h>
#include <sys/stat.h>
#include <time.h>

#include "command_fixture.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/resume"
#define LEVEL OUTPUT "/room.glb"
#define WHOLE OUTPUT "/whole"
#define EFFORT " --quiet --spacing 0.25 --samples 64 --lightmaps --texels-per-m 40"
#define BAKE LMB_COMMAND " bake " LEVEL EFFORT

static double whole_seconds;

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The level, and the bake of it that all others are compared with. */
static bool whole_make(void)
{
    static bool made;
    if (!made) {
        lmb_error error = {{0}};
        mkdir(OUTPUT, 0777);
        CHECK(lmb_level_cornell(LEVEL, &error) == LMB_OK, "%s", error.message);
        const double start = seconds_now();
        made = CHECK_RUN(0, NULL, "rm -rf " WHOLE " && " BAKE " -o " WHOLE);
        whole_seconds = seconds_now() - start;
    }
    return made;
}

/* All but the record, which has times; its hashes are those of the files. */
static void same_files(const char *folder)
{
    char line[1024];
    snprintf(line, sizeof line,
             "cd " WHOLE " && for f in probes.lmb probes.vdb lightmap/*; do cmp $f %s/$f || exit 1; done && test ! -e "
             "%s/.lambent-parts",
             folder, folder);
    CHECK_RUN(0, NULL, "%s", line);
}

/* Starts a bake into a folder and kills it after a share of the time that a whole one takes. */
static void kill_after(const char *folder, double share)
{
    const pid_t child = fork();
    if (child == 0) {
        char line[1024];
        snprintf(line, sizeof line, "exec " BAKE " --resume -o %s", folder);
        execl("/bin/sh", "sh", "-c", line, (char *)NULL);
        _exit(127);
    }
    const double seconds = share * whole_seconds;
    const struct timespec pause = {(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
    nanosleep(&pause, NULL);
    kill(child, SIGKILL);
    int status;
    waitpid(child, &status, 0);
}

/* Killed anywhere, several times in one folder. */
static void killed_bakes_go_on(void)
{
    static const char folder[] = OUTPUT "/killed";
    if (!whole_make()) {
        return;
    }
    for (int round = 0; round < 3; ++round) {
        CHECK_RUN(0, NULL, "rm -rf " OUTPUT "/killed");
        kill_after(folder, 0.25 + 0.25 * round);
        kill_after(folder, 0.9 - 0.3 * round);
        CHECK_RUN(0, NULL, BAKE " --resume -o " OUTPUT "/killed");
        same_files(folder);
    }
}

static void nothing_is_done_twice(void)
{
    if (!whole_make()) {
        return;
    }
    CHECK_RUN(0, "current",
              LMB_COMMAND " bake " LEVEL " --spacing 0.25 --samples 64 --lightmaps --texels-per-m 40 -o " WHOLE);
    CHECK_RUN(0, NULL, "mkdir " WHOLE "/.lambent-parts && touch " WHOLE "/.lambent-parts/probes-000000.part");
    CHECK_RUN(0, "current",
              LMB_COMMAND " bake " LEVEL " --resume --spacing 0.25 --samples 64 --lightmaps "
                          "--texels-per-m 40 -o " WHOLE);
    CHECK_RUN(0, NULL, "test ! -e " WHOLE "/.lambent-parts");
    CHECK_RUN(0, NULL,
              "rm -rf " OUTPUT "/again && cp -r " WHOLE " " OUTPUT "/again && printf x >> " OUTPUT "/again/probes.lmb");
    CHECK_RUN(0, NULL, BAKE " -o " OUTPUT "/again");
    same_files(OUTPUT "/again");
    CHECK_RUN(0, "written", LMB_COMMAND " bake " LEVEL " --spacing 0.5 --samples 2 -o " OUTPUT "/again");
    CHECK_RUN(0, "written", LMB_COMMAND " bake " LEVEL " --spacing 0.5 --samples 2 --force -o " OUTPUT "/again");
}

static void shares_are_merged(void)
{
    if (!whole_make()) {
        return;
    }
    CHECK_RUN(0, NULL,
              "cd " OUTPUT " && rm -rf s1 s2 s3 merged && for k in 1 2 3; do " BAKE
              " --shard $k/3 -o s$k > /dev/null || exit 1; done");
    CHECK_RUN(3, "is in none of the folders", "cd " OUTPUT " && " LMB_COMMAND " merge s1 s3 -o merged --quiet");
    CHECK_RUN(0, NULL, "cd " OUTPUT " && " LMB_COMMAND " merge s3 s1 s2 -o merged --quiet");
    same_files(OUTPUT "/merged");
    CHECK_RUN(3, "cannot open", LMB_COMMAND " merge " OUTPUT "/nothing -o " OUTPUT "/merged");
    CHECK_RUN(2, "--shard takes K/N", BAKE " --shard 4/3 -o " OUTPUT "/s4");
    CHECK_RUN(2, "--shard takes K/N", BAKE " --shard 1 -o " OUTPUT "/s4");
}

static const test_case cases[] = {
    {"killed bakes go on", killed_bakes_go_on},
    {"nothing is done twice", nothing_is_done_twice},
    {"shares are merged", shares_are_merged},
};

TEST_MAIN(cases)
