#define _POSIX_C_SOURCE 200809L
#include "machine.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <lambent/version.h>

/* "model name" of the first processor, as Linux has it. */
static void processor_name(char *name, size_t size)
{
    snprintf(name, size, "unknown processor");
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[256];
    while (file && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && colon && colon[1]) {
            snprintf(name, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
            break;
        }
    }
    if (file) {
        fclose(file);
    }
}

void machine_text(char text[512])
{
    char name[256];
    processor_name(name, sizeof name);
    snprintf(text, 512, "%s, %ld processors, compiler %s, lambent %s", name, sysconf(_SC_NPROCESSORS_ONLN), __VERSION__,
             lmb_version_text());
}
