/* lambent: bakes light-probe volumes and matching lightmaps of game levels, and shows what it baked. */
#include <stdio.h>
#include <string.h>

#include "command.h"

static const struct {
    const char *name;
    int (*run)(int count, char **values);
    const char *about;
} commands[] = {
    {"bake", command_bake, "bake a level's probe volume and lightmaps into a folder"},
    {"bench", command_bench, "measure how fast a bake traces"},
    {"check", command_check, "measure a bake against the path-traced truth"},
    {"info", command_info, "say what is in a .vdb, .lmb or .exr of ours"},
    {"probe", command_probe, "trace one probe of a level on the spot"},
    {"render", command_render, "draw a picture of a baked level"},
    {"sample", command_sample, "look up the light at a point of a .lmb"},
};

static void usage_print(FILE *stream)
{
    fputs("usage: lambent COMMAND ...\n\n", stream);
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
        fprintf(stream, "  %-8s %s\n", commands[i].name, commands[i].about);
    }
    fputs("\nlambent COMMAND --help says more. Exit status: 0 done, 1 the work failed, 2 usage, 3 bad input,\n"
          "4 interrupted.\n",
          stream);
}

int main(int count, char **values)
{
    if (count >= 2 && (strcmp(values[1], "--help") == 0 || strcmp(values[1], "-h") == 0)) {
        usage_print(stdout);
        return EXIT_DONE;
    }
    if (count >= 2 && strcmp(values[1], "--version") == 0) {
        puts("lambent " LMB_VERSION);
        return EXIT_DONE;
    }
    for (size_t i = 0; count >= 2 && i < sizeof commands / sizeof commands[0]; ++i) {
        if (strcmp(values[1], commands[i].name) == 0) {
            return commands[i].run(count - 2, values + 2);
        }
    }
    if (count >= 2) {
        fprintf(stderr, "lambent: there is no command '%s'\n", values[1]);
    }
    usage_print(stderr);
    return EXIT_USAGE;
}
