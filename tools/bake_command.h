/* Running a bake for a command: its folder, its progress, an interruption, and what is said of it. */
#ifndef LMB_TOOLS_BAKE_COMMAND_H
#define LMB_TOOLS_BAKE_COMMAND_H

#include <stdbool.h>

#include <lambent/bake.h>

/* What to bake, how, and what to say of it. */
typedef struct bake_options {
    lmb_bake_settings settings;
    lmb_bake_work work;
    lmb_vec3d only[2]; /* what work.only points to, where it does */
    const char *directory;
    const char *light_sets; /* "all", or names with commas between: each into a folder of its name in `directory` */
    bool dry_run;
    bool json_progress;
    bool quiet;
} bake_options;

/* Bakes, and says what was made. @return the exit status */
int bake_command_run(const bake_options *options);

#endif
