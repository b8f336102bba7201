/* The C sample of README.md: it compiles, and README.md shows exactly this text. */
#include "harness.h"

#include <stdlib.h>

/* README begins */
#include <lambent/hhd.h>
#include <lambent/volume.h>

/* Light that a surface reflects at `position`: `n_v` is its own normal, `n` the one from the normal map. */
static inline lmb_rgb shade(const lmb_volume *volume, lmb_vec3 position, lmb_vec3 n_v, lmb_vec3 n, lmb_rgb albedo)
{
    lmb_sh3_rgb radiance;
    lmb_volume_sample(volume, position, &radiance);
    const lmb_irradz texel = lmb_irradz_encode(&radiance, n_v, 0.0f); /* once a frame and object, or per vertex */
    const lmb_hhd_rgb light = lmb_irradz_decode(&texel, n_v);
    const lmb_rgb irradiance = lmb_hhd_rgb_evaluate(&light, n_v, n); /* per pixel */
    return (lmb_rgb){{albedo.c[0] * irradiance.c[0], albedo.c[1] * irradiance.c[1], albedo.c[2] * irradiance.c[2]}};
}
/* README ends */

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

static void readme_shows_the_sample(void)
{
    char *source = read_text(LMB_SOURCE_DIR "/tests/test_readme.c");
    char *readme = read_text(LMB_SOURCE_DIR "/README.md");
    char *begin = source ? strstr(source, "/* README begins */\n") : NULL;
    char *end = source ? strstr(source, "/* README ends */\n") : NULL;
    CHECK(begin && end && begin < end, "the sample's marks");
    CHECK(readme, "README.md cannot be read");
    if (begin && end && readme) {
        *end = '\0';
        const char *sample = strchr(begin, '\n') + 1;
        CHECK(strstr(readme, sample) != NULL, "README.md does not show this:\n%s", sample);
    }
    free(source);
    free(readme);
}

static const test_case cases[] = {
    {"README shows the sample", readme_shows_the_sample},
};

TEST_MAIN(cases)
