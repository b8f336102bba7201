/* The folder that a bake is written to: found bad before any work, whole whatever fails, never shared, and no file in
 * it lost that no bake made. */
#define _POSIX_C_SOURCE 200809L
#include <signal.h>
#include <sys/stat.h>
#include <time.h>

#include "command_fixture.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/output_folder"
#define LEVEL OUTPUT "/room.glb"
#define BAKE LMB_COMMAND " bake " LEVEL " --quiet --samples 2 --spacing 0.5 "
#define LIGHTMAPS " --lightmaps --texels-per-m 2 "

static bool level_make(void)
{
    return cornell_make(OUTPUT, LEVEL);
}

/* The level is missing too: that the folder is what is said shows that it is looked at first. */
static void bad_folders_cost_nothing(void)
{
    static const struct {
        const char *prepare;
        const char *folder;
        const char *options;
        const char *says;
    } table[] = {
        {"touch F", "F", "", "F: not a folder"},
        {"touch F", "F/below", "", "F"},
        {"true", "/proc/lambent", "", "/proc/lambent: cannot be written"},
        {"true", "/dev/null", "", "/dev/null: not a folder"},
        {"mkdir -p F/probes.lmb", "F", "", "F/probes.lmb: not a file"},
        {"mkdir -p F/bake.json", "F", "", "F/bake.json: not a file"},
        {"mkdir -p F/lightmap/lightmap.json", "F", LIGHTMAPS, "F/lightmap/lightmap.json: not a file"},
        {"mkdir -p F && touch F/lightmap", "F", LIGHTMAPS, "F/lightmap: not a folder"},
        {"true", "\"$(printf '%05000d' 0)\"", "", "path is too long"},
        {"true", "''", "", "not a folder"},
    };
    mkdir(OUTPUT, 0777);
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        CHECK_RUN(1, table[i].says,
                  "cd " OUTPUT " && rm -rf F && %s && " LMB_COMMAND " bake missing.glb -o %s --json-progress %s",
                  table[i].prepare, table[i].folder, table[i].options);
    }
    CHECK_RUN(0, NULL, "cd " OUTPUT " && rm -rf F");
    CHECK_RUN(3, "missing.glb", "cd " OUTPUT " && " LMB_COMMAND " bake missing.glb -o deep/er/est");
    CHECK(access(OUTPUT "/deep", F_OK) != 0, "a bake that could not begin left folders");
}

static void immutable_files_cost_nothing(void)
{
    char printed[4096];
    mkdir(OUTPUT, 0777);
    if (run(printed, sizeof printed,
            "cd " OUTPUT " && rm -rf I && mkdir I && touch I/probes.lmb && "
            "chattr +i I/probes.lmb") != 0) {
        test_skip("chattr does not work here");
        return;
    }
    CHECK_RUN(1, "I/probes.lmb: may not be replaced", "cd " OUTPUT " && " LMB_COMMAND " bake missing.glb -o I");
    CHECK_RUN(1, "I: cannot be written",
              "cd " OUTPUT " && chattr -i I/probes.lmb && chattr +i I && " LMB_COMMAND " bake missing.glb -o I");
    CHECK_RUN(0, NULL, "cd " OUTPUT " && chattr -i I && rm -r I");
}

/* What `bake` prints, run where the disk or the file size ends too early, and that the old bake stays. */
static void failed_write_leaves_the_old(const char *folder, const char *before)
{
    static char old[16384], now[16384];
    if (!CHECK_RUN(0, NULL, BAKE "-o %s", folder)) {
        return;
    }
    folder_state(folder, old, sizeof old);
    CHECK_RUN(1, "cannot write", "%s " BAKE LIGHTMAPS " --spacing 0.05 --texels-per-m 64 -o %s", before, folder);
    folder_state(folder, now, sizeof now);
    CHECK(strcmp(old, now) == 0, "%s: before\n%s\nand after\n%s", folder, old, now);
    CHECK_RUN(1, "the folder is as it was", "%s " BAKE " --spacing 0.05 -o %s", before, folder);
    CHECK_RUN(0, NULL, BAKE LIGHTMAPS "-o %s", folder);
}

static void file_size_limit_leaves_the_old(void)
{
    if (level_make()) {
        CHECK_RUN(0, NULL, "rm -rf " OUTPUT "/limit");
        failed_write_leaves_the_old(OUTPUT "/limit", "ulimit -f 200;");
    }
}

static void full_disk_leaves_the_old(void)
{
    char printed[4096];
    if (!level_make()) {
        return;
    }
    if (run(printed, sizeof printed, "mkdir -p " OUTPUT "/disk && mount -t tmpfs -o size=3m none " OUTPUT "/disk") !=
        0) {
        test_skip("no file system can be mounted here");
        return;
    }
    failed_write_leaves_the_old(OUTPUT "/disk/bake", "");
    CHECK_RUN(0, NULL, "umount " OUTPUT "/disk");
}

/* Every job of a farm on a disk that is full says which file does not fit, and goes on when there is room. */
static void full_disk_of_a_farm(void)
{
#define DISK OUTPUT "/farm_disk"
#define ROOM "mount -o remount,size=200m " DISK " && "
    static const char share[] = BAKE LIGHTMAPS "--spacing 0.25 --texels-per-m 10";
    char printed[4096];
    if (!level_make()) {
        return;
    }
    if (run(printed, sizeof printed, "mkdir -p " DISK " && mount -t tmpfs -o size=300k none " DISK) != 0) {
        test_skip("no file system can be mounted here");
        return;
    }
    CHECK_RUN(1, "prepared.bin: cannot write: No space left", "%s --prepare -o " DISK "/prepared", share);
    CHECK_RUN(1, ".part: cannot write: No space left", "%s --shard 1/2 -o " DISK "/s1", share);
    CHECK_RUN(0, NULL, ROOM "%s --prepare -o " DISK "/prepared", share);
    for (int k = 1; k <= 2; ++k) {
        CHECK_RUN(0, NULL, "%s --prepared " DISK "/prepared --shard %d/2 --resume -o " DISK "/s%d", share, k, k);
    }
    CHECK_RUN(1, "cannot write: No space left",
              "mount -o remount,size=$(($(du -sk " DISK " | cut -f1) + 100))k " DISK " && " LMB_COMMAND " merge " DISK
              "/s1 " DISK "/s2 -o " DISK "/merged --quiet");
    CHECK(access(DISK "/merged", F_OK) != 0, "a merge that failed left a folder");
    CHECK_RUN(0, NULL, ROOM LMB_COMMAND " merge " DISK "/s1 " DISK "/s2 -o " DISK "/merged --quiet");
    CHECK_RUN(0, NULL, "%s -o " DISK "/whole && diff -r --exclude=bake.json " DISK "/whole " DISK "/merged", share);
    CHECK_RUN(0, NULL, "umount " DISK);
#undef DISK
#undef ROOM
}

/* The folder is removed while the bake is at work: nothing is made in its place. */
static void vanished_folder_is_an_error(void)
{
#define FOLDER OUTPUT "/vanished"
    if (!level_make() || !CHECK_RUN(0, NULL, "rm -rf " FOLDER)) {
        return;
    }
    CHECK_RUN(1, FOLDER,
              BAKE LIGHTMAPS "--spacing 0.05 --samples 64 -o " FOLDER " & "
                             "while [ ! -e " FOLDER "/.lambent-lock ]; do sleep 0.01; done; sleep 0.1; "
                             "rm -rf " FOLDER "; wait $!");
    CHECK(access(FOLDER, F_OK) != 0, "a folder that was removed is there again");
#undef FOLDER
}

/* A file system that is mounted to be read: it is said before any work, and the bake on it stays. */
static void read_only_folder_is_an_error(void)
{
#define FOLDER OUTPUT "/read_only"
    static char old[16384], now[16384], printed[4096];
    if (!level_make()) {
        return;
    }
    if (run(printed, sizeof printed,
            "mkdir -p " FOLDER " && mount -t tmpfs -o size=4m none " FOLDER " && " BAKE "-o " FOLDER
            "/bake && mount -o remount,ro " FOLDER) != 0) {
        run(printed, sizeof printed, "umount " FOLDER);
        test_skip("no file system can be mounted here");
        return;
    }
    folder_state(FOLDER, old, sizeof old);
    CHECK_RUN(1, "Read-only file system", LMB_COMMAND " bake missing.glb -o " FOLDER "/bake");
    CHECK_RUN(1, "Read-only file system", LMB_COMMAND " bake missing.glb -o " FOLDER "/new");
    CHECK_RUN(1, "Read-only file system", LMB_COMMAND " pack " FOLDER "/bake/probes.vdb -o " FOLDER "/x.lmb");
    folder_state(FOLDER, now, sizeof now);
    CHECK(strcmp(old, now) == 0, "before\n%s\nand after\n%s", old, now);
    CHECK_RUN(0, NULL, "umount " FOLDER);
#undef FOLDER
}

/* A target that turns bad while the bake is at work: what has moved in by then is taken out again. */
static void failed_moves_are_undone(void)
{
#define FOLDER OUTPUT "/undone"
    static char old[16384], now[16384];
    if (!level_make() || !CHECK_RUN(0, NULL, "rm -rf " FOLDER " && " BAKE "-o " FOLDER)) {
        return;
    }
    folder_state(FOLDER, old, sizeof old);
    CHECK_RUN(1, "lightmap/lightmap_0.exr: cannot be written: Is a directory; the folder is as it was",
              BAKE LIGHTMAPS "--spacing 0.05 --samples 16 -o " FOLDER " & "
                             "while [ ! -e " FOLDER "/.lambent-lock ]; do sleep 0.01; done; sleep 0.1; "
                             "mkdir -p " FOLDER "/lightmap/lightmap_0.exr; wait $!");
    CHECK_RUN(0, NULL, "rmdir " FOLDER "/lightmap/lightmap_0.exr " FOLDER "/lightmap");
    folder_state(FOLDER, now, sizeof now);
    CHECK(strcmp(old, now) == 0, "before\n%s\nand after\n%s", old, now);
#undef FOLDER
}

/* Files of the earlier bake that the new one does not make go, by its record; others never. */
static void only_what_a_record_names_goes(void)
{
#define FOLDER OUTPUT "/files"
    if (!level_make() || !CHECK_RUN(0, NULL, "rm -rf " FOLDER " && " BAKE LIGHTMAPS "-o " FOLDER)) {
        return;
    }
    CHECK_RUN(0, "lightmap/lightmap_0.exr", "cat " FOLDER "/bake.json");
    CHECK_RUN(0, NULL,
              "cd " FOLDER " && touch mine.txt lightmap/mine.exr lightmap/lightmap_7.exr ../outside.lmb && "
              "mkdir lightmap/deep && touch lightmap/deep/mine && "
              "sed -i 's|\"files\":.\\[|&\"mine.txt\", \"../outside.lmb\", \"lightmap/../mine.txt\", \"\", 3, "
              "\"lightmap/deep/mine\", \"lightmap/deep\", \"/etc/passwd\", |' bake.json && "
              "grep -q 'lightmap/deep/mine' bake.json");
    CHECK_RUN(0, NULL, BAKE "-o " FOLDER "/");
    CHECK_RUN(0, NULL, "cd " FOLDER " && test ! -e lightmap/lightmap_0.exr && test ! -e lightmap/lightmap.json");
    CHECK_RUN(0, NULL,
              "cd " FOLDER " && ls mine.txt lightmap/mine.exr lightmap/lightmap_7.exr ../outside.lmb "
              "lightmap/deep/mine probes.lmb probes.vdb bake.json");
    CHECK_RUN(0, "0", "ls -A " FOLDER " | grep -c '^.lambent'; true");
    CHECK_RUN(0, NULL,
              BAKE LIGHTMAPS "-o " FOLDER " && rm -r " FOLDER "/lightmap/deep " FOLDER "/lightmap/*7.exr " FOLDER
                             "/lightmap/mine.exr && " BAKE "-o " FOLDER " && test ! -e " FOLDER "/lightmap");
    CHECK_RUN(3, "bake.json", LMB_COMMAND " check " LEVEL " " OUTPUT);
#undef FOLDER
}

/* A bake at work on a folder, until `signal_number` ends it. */
static pid_t bake_start(const char *folder)
{
    const pid_t child = fork();
    if (child == 0) {
        execl(LMB_COMMAND, LMB_COMMAND, "bake", LEVEL, "-o", folder, "--spacing", "0.05", "--samples", "10000000",
              "--quiet", (char *)NULL);
        _exit(127);
    }
    char lock[1024];
    snprintf(lock, sizeof lock, "%s/.lambent-lock", folder);
    const struct timespec pause = {0, 10000000};
    struct stat status;
    for (int i = 0; i < 1000 && (stat(lock, &status) != 0 || status.st_size == 0); ++i) {
        nanosleep(&pause, NULL);
    }
    return child;
}

static void two_bakes_do_not_mix(void)
{
#define FOLDER OUTPUT "/shared"
    static char old[16384], now[16384];
    if (!level_make() || !CHECK_RUN(0, NULL, "rm -rf " FOLDER " && " BAKE LIGHTMAPS "-o " FOLDER)) {
        return;
    }
    folder_state(FOLDER, old, sizeof old);
    const pid_t first = bake_start(FOLDER);
    char says[64];
    snprintf(says, sizeof says, "another bake is writing there, process %ld;", (long)first);
    CHECK_RUN(1, says, BAKE "-o " FOLDER);
    CHECK_RUN(1, "another bake", BAKE "-o " FOLDER "/../shared/");
    kill(first, SIGKILL);
    waitpid(first, NULL, 0);
    CHECK_RUN(0, "lambent-lock", "ls -A " FOLDER);
    /* What a killed bake had begun to write. */
    CHECK_RUN(0, NULL, "cd " FOLDER " && mkdir -p .lambent-new/lightmap && touch .lambent-new/lightmap/x.exr");
    CHECK_RUN(0, NULL, BAKE LIGHTMAPS "-o " FOLDER);
    folder_state(FOLDER, now, sizeof now);
    /* bake.json has times in it. */
    CHECK(strstr(now, "lambent") == NULL, "left: %s", now);
    CHECK_RUN(0, NULL, LMB_COMMAND " check " LEVEL " " FOLDER " --points 4 --samples 4 --quiet");
#undef FOLDER
}

static const test_case cases[] = {
    {"bad_folders_cost_nothing", bad_folders_cost_nothing},
    {"immutable_files_cost_nothing", immutable_files_cost_nothing},
    {"file_size_limit_leaves_the_old", file_size_limit_leaves_the_old},
    {"full_disk_leaves_the_old", full_disk_leaves_the_old},
    {"full_disk_of_a_farm", full_disk_of_a_farm},
    {"vanished_folder_is_an_error", vanished_folder_is_an_error},
    {"read_only_folder_is_an_error", read_only_folder_is_an_error},
    {"failed_moves_are_undone", failed_moves_are_undone},
    {"only_what_a_record_names_goes", only_what_a_record_names_goes},
    {"two_bakes_do_not_mix", two_bakes_do_not_mix},
};

TEST_MAIN(cases)
