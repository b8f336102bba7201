/* README.md shows the example that is built, to the letter. */
#include "harness.h"

#include <stdlib.h>

static char *read_text(const char *path)
{
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    if (file && fseek(file, 0, SEEK_END) == 0) {
        const long size = ftell(file);
        rewind(file);
        text = size >= 0 ? calloc((size_t)size + 1, 1) : NULL;
        if (text && fread(text, 1, (size_t)size, file) != (size_t)size) {
            free(text);
            text = NULL;
        }
    }
    if (file) {
        fclose(file);
    }
    return text;
}

static void readme_shows_the_example(void)
{
    static const char fence[] = "```c\n";
    char *example = read_text(LMB_SOURCE_DIR "/sampler/example/moving_object.c");
    char *readme = read_text(LMB_SOURCE_DIR "/README.md");
    CHECK(example, "sampler/example/moving_object.c cannot be read");
    CHECK(readme, "README.md cannot be read");
    if (example && readme) {
        const char *block = strstr(readme, fence);
        const char *shown = block ? block + strlen(fence) : "";
        const size_t size = strlen(example);
        CHECK(size > 0 && strncmp(shown, example, size) == 0 && strncmp(shown + size, "```\n", 4) == 0,
              "the first C block of README.md is not sampler/example/moving_object.c");
    }
    free(example);
    free(readme);
}

static const test_case cases[] = {
    {"README shows the example", readme_shows_the_example},
};

TEST_MAIN(cases)
