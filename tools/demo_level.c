/* lambent_demo_level OUT.glb [OBJECT.glb]: writes the demo level, and the object that is carried through it. */
#include "demo_level.h"

#include <stdio.h>

int main(int argc, char **argv)
{
    if (argc < 2 || argc > 3) {
        fputs("usage: lambent_demo_level OUT.glb [OBJECT.glb]\n", stderr);
        return 2;
    }
    lmb_error error = {0};
    if (lmb_demo_level_write(argv[1], &error) != LMB_OK ||
        (argc == 3 && lmb_demo_object_write(argv[2], &error) != LMB_OK)) {
        fprintf(stderr, "lambent_demo_level: %s\n", error.message);
        return 1;
    }
    return 0;
}
