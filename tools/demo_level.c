/* lambent_demo_level [--volumes] OUT.glb [OBJECT.glb]: writes the demo level, with boxes of probes if asked to, and the
 * object that is carried through it. */
#include "demo_level.h"

#include <stdio.h>
#include <string.h>

int main(int argc, char **argv)
{
    const int first = argc > 1 && strcmp(argv[1], "--volumes") == 0 ? 2 : 1, files = argc - first;
    if (files < 1 || files > 2) {
        fputs("usage: lambent_demo_level [--volumes] OUT.glb [OBJECT.glb]\n", stderr);
        return 2;
    }
    lmb_error error = {0};
    lmb_result result =
        first == 2 ? lmb_demo_level_write_with_volumes(argv[first], &error) : lmb_demo_level_write(argv[first], &error);
    if (result == LMB_OK && files == 2) {
        result = lmb_demo_object_write(argv[first + 1], &error);
    }
    if (result != LMB_OK) {
        fprintf(stderr, "lambent_demo_level: %s\n", error.message);
        return 1;
    }
    return 0;
}
