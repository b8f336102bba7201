/* Command lines: an input is a command's name and its arguments, a line each; behind an empty line comes what it reads
 * on standard input. They run in an empty folder that has a small volume in it, `small.lmb`, so that `sample` and
 * `info` have work to do and every other file is missing. `bench` and `models` need no file and may be asked for years
 * of work: their arguments are not for this. */
#define _GNU_SOURCE /* memfd_create */
#include "fuzz.h"

#include <stdbool.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <lambent/file.h>

#include "command.h"
#include "interrupt.h"

enum { MOST_ARGUMENTS = 40, MOST_BYTES = 4096 };

static const struct {
    const char *name;
    int (*run)(int count, char **values);
} commands[] = {
    {"bake", command_bake},   {"check", command_check},   {"info", command_info},     {"pack", command_pack},
    {"probe", command_probe}, {"render", command_render}, {"sample", command_sample},
};

static int input_file = -1;

static void sandbox_enter(void)
{
    static const char folder[] = LMB_TEST_OUTPUT_DIR "/fuzz_command";
    unsigned char *data = NULL;
    size_t size = 0;
    FUZZ_CHECK(lmb_file_read(LMB_GOLDEN_DIR "/small.lmb", &data, &size, NULL) == LMB_OK, "no volume");
    mkdir(folder, 0777);
    FUZZ_CHECK(chdir(folder) == 0 && lmb_file_write("small.lmb", data, size, NULL) == LMB_OK, "%s", folder);
    free(data);
    input_file = memfd_create("input", MFD_CLOEXEC);
    FUZZ_CHECK(input_file >= 0 && dup2(input_file, STDIN_FILENO) >= 0, "no file for the standard input");
    FUZZ_CHECK(freopen("/dev/null", "w", stdout), "no /dev/null");
}

/* Nothing outside the folder is to be touched, and nothing that never ends is to be read. */
static bool argument_is_harmless(const char *text)
{
    return !strchr(text, '/') && !strstr(text, "..");
}

static void input_set(const char *text, size_t size)
{
    FUZZ_CHECK(ftruncate(input_file, 0) == 0 && pwrite(input_file, text, size, 0) == (ssize_t)size, "no file");
    rewind(stdin);
    clearerr(stdin);
}

static void command_try(const char *name, int count, char **values)
{
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
        if (strcmp(name, commands[i].name) == 0) {
            const int status = commands[i].run(count, values);
            FUZZ_CHECK(status >= EXIT_DONE && status <= EXIT_BAD_INPUT, "%s: status %d", name, status);
            FUZZ_CHECK(access("small.lmb", R_OK) == 0, "%s took the volume away", name);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char text[MOST_BYTES + 1];
    char *values[MOST_ARGUMENTS + 1] = {NULL};
    int count = 0;
    if (input_file < 0) {
        sandbox_enter();
    }
    if (size > MOST_BYTES || memchr(data, '\0', size)) {
        return -1;
    }
    memcpy(text, data, size);
    text[size] = '\0';
    char *at = text;
    while (count < MOST_ARGUMENTS && *at && *at != '\n') {
        char *const end = at + strcspn(at, "\n");
        char *const next = *end ? end + 1 : end;
        *end = '\0';
        if (!argument_is_harmless(at)) {
            return -1;
        }
        values[count++] = at;
        at = next;
    }
    at += *at == '\n';
    input_set(at, strlen(at));
    if (count > 0) {
        command_try(values[0], count - 1, values + 1);
    }
    return 0;
}

void fuzz_seeds(void)
{
    static const char *const lines[] = {
        "bake\nlevel.glb\n-o\nout\n--env\n#ffeedd,rotation=30,strength=2\n--spacing\n0.5\n--lightmaps\n--seed-point\n"
        "1,2,3\n--exclude\nCam*\n--models\nsh3,hlsh\n--quality\ndraft\n--samples=64\n--threads\n1\n--isa\navx2\n",
        "bake\n--dry-run\n--json-progress\n--max-probes\n1000\n--tolerance\n0.1\n--texels-per-m\n4\n--padding\n2\n"
        "--key-lights\n2\n--bounces\n3\n--seed\n9\n--estimator\nreference\n--no-denoise\n--texel-error\n--\n-x.glb\n",
        "check\nlevel.glb\nbaked\n--points\n100\n--seed\n3\n--json\n",
        "info\nsmall.lmb\n--json\n",
        "info\nsmall.lmb\n",
        "pack\nfile.vdb\n-o\nfile.lmb\n",
        "probe\nlevel.glb\n--at\n0,1,2\n--normal\n0,1,0\n--vertex-normal\n0,0,1\n--json\n--light-scale\n2\n"
        "--emission-scale\n3\n--allow-outside-uris\n--quiet\n",
        "render\nlevel.glb\nbaked\n-o\nshot.png\n--camera\n0,1,2\n--look\n0,0,0\n--fov\n60\n--mode\nfinal\n",
        "sample\nsmall.lmb\n--at\n0.5,0.5,0.5\n--normal\n0,1,0\n--visibility\n0.5\n--model\nhlsh\n--json\n",
        "sample\nsmall.lmb\n--cone-cos=0.3\n\n1 2 3\n# none\n1 2 3 0 1 0\n1 2 3 0 1 0 0.5\n1e3 2 -3 0 1 0 0.5 1 0 "
        "0\nx\n",
        "sample\n--help\n",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; ++i) {
        fuzz_seed(lines[i], strlen(lines[i]));
    }
}
