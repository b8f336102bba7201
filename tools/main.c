/* lambent: bakes light-probe volumes and matching lightmaps of game levels, and shows what it baked. */
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <lambent/version.h>

#include "command.h"
#include "interrupt.h"

static const struct {
    const char *name;
    int (*run)(int count, char **values);
    const char *about;
} commands[] = {
    {"bake", command_bake, "bake a level's probe volume and lightmaps into a folder"},
    {"bench", command_bench, "measure how fast a volume is sampled, or how fast a bake traces"},
    {"check", command_check, "measure a bake against the path-traced truth"},
    {"cube", command_cube, "trace environment maps of a baked level for specular reflection"},
    {"info", command_info, "say what is in a .vdb, .lmb, .exr, .ktx2 or .dds of ours"},
    {"merge", command_merge, "put the shares of a bake together"},
    {"models", command_models, "measure every lighting model under environments"},
    {"pack", command_pack, "turn a .vdb, edited or not, into the .lmb that a game opens"},
    {"probe", command_probe, "trace one probe of a level on the spot"},
    {"render", command_render, "draw a picture of a baked level"},
    {"sample", command_sample, "look up the light at a point of a .lmb"},
    {"ssbump", command_ssbump, "make a self-shadowed bump map of a height map"},
};

static void usage_print(FILE *stream)
{
    fputs("usage: lambent COMMAND ...\n\n", stream);
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
        fprintf(stream, "  %-8s %s\n", commands[i].name, commands[i].about);
    }
    fputs("\nlambent COMMAND --help, or lambent help COMMAND, says more. Exit status: 0 done, 1 the work failed, 2 "
          "usage,\n"
          "3 bad input, 4 interrupted.\n",
          stream);
}

/* Runs the command of that name. False when there is none. */
static bool command_run(const char *name, int count, char **values, int *status)
{
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
        if (strcmp(name, commands[i].name) == 0) {
            *status = commands[i].run(count, values);
            return true;
        }
    }
    return false;
}

static int help_run(int count, char **values)
{
    char option[] = "--help";
    char *help[] = {option, NULL};
    int status = EXIT_DONE;
    if (count == 0) {
        usage_print(stdout);
    } else if (count > 1 || !command_run(values[0], 1, help, &status)) {
        fprintf(stderr, "lambent: help: there is no command '%s'\n", values[count - 1]);
        usage_print(stderr);
        status = EXIT_USAGE;
    }
    return status;
}

static int run(int count, char **values)
{
    int status = EXIT_USAGE;
    const char *name = count > 0 ? values[0] : "";
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        return help_run(0, NULL);
    }
    if (strcmp(name, "help") == 0) {
        return help_run(count - 1, values + 1);
    }
    if (strcmp(name, "--version") == 0) {
        printf("lambent %s\n", lmb_version_text());
        return EXIT_DONE;
    }
    if (count == 0 || !command_run(name, count - 1, values + 1, &status)) {
        if (count > 0) {
            fprintf(stderr, "lambent: there is no command '%s'\n", name);
        }
        usage_print(stderr);
    }
    return status;
}

/* Where the caller has closed a standard stream, the next file that is opened would take its place. Writing to what
 * stands in for it fails. */
static void streams_hold(void)
{
    for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
        if (fcntl(descriptor, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0) {
            break;
        }
    }
}

int main(int count, char **values)
{
    streams_hold();
    /* A reader that has gone, or a file that has grown too large, are failed writes like others. */
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    interrupt_watch();
    interrupt_catch_terminate();
    return console_end(run(count - 1, values + 1));
}
