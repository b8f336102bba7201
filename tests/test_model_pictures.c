/* Every lighting model that a bake can hold is drawn: by lightmaps in each format, where models that textures do not
 * hold are OpenEXR beside them, and by probes. */
#define _POSIX_C_SOURCE 200809L
#include "command_fixture.h"

#include <lambent/exr.h>
#include <lambent/lightmap.h>
#include <lambent/model.h>

#define OUTPUT LMB_TEST_OUTPUT_DIR "/model_pictures"
#define LEVEL OUTPUT "/room.glb"

enum { WIDTH = 16, HEIGHT = 9, PIXELS = WIDTH * HEIGHT };

typedef struct picture {
    bool drawn;
    float green[PIXELS];
} picture;

/* What `render` draws, into a file of that name. */
static picture picture_draw(const char *bake, const char *mode, const char *model)
{
    static const char *const names[1] = {"G"};
    picture made = {.drawn = false};
    float *plane[1] = {NULL};
    lmb_exr_header header;
    lmb_error error = {""};
    if (!CHECK_RUN(0, NULL,
                   LMB_COMMAND " render " LEVEL " " OUTPUT "/%s -o " OUTPUT
                               "/drawn.exr --quiet --size %dx%d --mode %s %s %s",
                   bake, (int)WIDTH, (int)HEIGHT, mode, model ? "--model" : "", model ? model : "")) {
        return made;
    }
    const lmb_result result = lmb_exr_read_channels(OUTPUT "/drawn.exr", names, 1, plane, &header, &error);
    made.drawn = result == LMB_OK && header.width == WIDTH && header.height == HEIGHT;
    CHECK(made.drawn, "%s", error.message);
    for (int i = 0; i < PIXELS && made.drawn; ++i) {
        made.green[i] = plane[0][i];
    }
    free(plane[0]);
    return made;
}

/* The mean difference of two pictures, over the mean of the second. */
static double pictures_differ(const picture *a, const picture *b)
{
    double difference = 0.0, sum = 0.0;
    for (int i = 0; i < PIXELS; ++i) {
        difference += fabs((double)a->green[i] - (double)b->green[i]);
        sum += (double)b->green[i];
    }
    return difference / sum;
}

/* So many models a bake has beside its own. */
enum { BATCH = 14, BATCHES = 3 };

static int batch_of(const lmb_model *model)
{
    int before = 0;
    for (size_t i = 0; lmb_model_at(i) != model; ++i) {
        before += (lmb_model_at(i)->uses & LMB_MODEL_FOR_LIGHTMAP) != 0;
    }
    return before / BATCH;
}

/* The names of the lightmaps' models of a batch, commas between. */
static void names_join(int batch, char *text, size_t size)
{
    text[0] = '\0';
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        const lmb_model *model = lmb_model_at(i);
        if ((model->uses & LMB_MODEL_FOR_LIGHTMAP) && batch_of(model) == batch) {
            const size_t used = strlen(text);
            snprintf(text + used, size - used, "%s%s", used > 0 ? "," : "", model->name);
        }
    }
}

/* Folders exr0, exr1, ... and ktx20, ktx21, ... of the batches. */
static bool baked(void)
{
    static const char *const formats[2] = {"exr", "ktx2"};
    static bool tried, made;
    for (int i = tried ? 2 * BATCHES : 0; i < 2 * BATCHES; ++i) {
        char models[1024];
        names_join(i / 2, models, sizeof models);
        made = (i > 0 ? made : cornell_make(OUTPUT, LEVEL)) &&
               (models[0] == '\0' ||
                CHECK_RUN(0, NULL,
                          LMB_COMMAND " bake " LEVEL " -o " OUTPUT "/%s%d --lightmap-format %s --models %s --lightmaps "
                                      "--texels-per-m 4 --spacing 0.5 --samples 64 --quiet",
                          formats[i % 2], i / 2, formats[i % 2], models));
    }
    tried = true;
    return made;
}

/* Beside textures, too, what is OpenEXR is as in a bake of OpenEXR alone; what textures hold is near it. */
static void lightmaps_are_drawn_by_every_model(void)
{
    if (!baked()) {
        return;
    }
    const picture own = picture_draw("exr0", "lightmap", NULL);
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        const lmb_model *model = lmb_model_at(i);
        if (!(model->uses & LMB_MODEL_FOR_LIGHTMAP)) {
            continue;
        }
        char bakes[2][32];
        snprintf(bakes[0], sizeof bakes[0], "exr%d", batch_of(model));
        snprintf(bakes[1], sizeof bakes[1], "ktx2%d", batch_of(model));
        const picture exr = picture_draw(bakes[0], "lightmap", model->name);
        const picture ktx2 = picture_draw(bakes[1], "lightmap", model->name);
        if (exr.drawn && ktx2.drawn) {
            const bool textures = (model->uses & LMB_MODEL_FOR_TEXTURE) != 0;
            CHECK(pictures_differ(&exr, &own) < 0.5, "%s: %g off", model->name, pictures_differ(&exr, &own));
            CHECK(pictures_differ(&ktx2, &exr) <= (textures ? 0.1 : 0.002), "%s: %g off beside textures", model->name,
                  pictures_differ(&ktx2, &exr));
        }
    }
}

static void probes_are_drawn_by_every_model(void)
{
    if (!baked()) {
        return;
    }
    const picture own = picture_draw("exr0", "probes", NULL);
    double most = 0.0;
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        const lmb_model *model = lmb_model_at(i);
        const char *name = lmb_model_full_name(model);
        if (!model->encode) {
            CHECK_RUN(2, name,
                      LMB_COMMAND " render " LEVEL " " OUTPUT "/exr0 -o " OUTPUT "/drawn.exr --mode probes --model %s",
                      name);
            continue;
        }
        const picture drawn = picture_draw("exr0", "probes", name);
        if (drawn.drawn) {
            const double off = pictures_differ(&drawn, &own);
            CHECK(off < 0.8, "%s: %g off", name, off);
            most = fmax(most, off);
        }
    }
    CHECK(most > 0.01, "all models draw the same");
}

static void what_is_not_there_is_refused(void)
{
    if (!baked()) {
        return;
    }
    CHECK_RUN(2, "no lightmap has the model",
              LMB_COMMAND " render " LEVEL " " OUTPUT "/exr0 -o " OUTPUT "/drawn.exr --model hlsh.light");
    CHECK_RUN(2, "probes make no model frob",
              LMB_COMMAND " render " LEVEL " " OUTPUT "/exr0 -o " OUTPUT "/drawn.exr --model frob --mode probes");
    CHECK_RUN(3, "lightmap_0.exr: cannot open",
              "cd " OUTPUT
              " && rm -rf broken && cp -r ktx20 broken && rm broken/lightmap/lightmap_0.exr && " LMB_COMMAND
              " render " LEVEL " broken -o drawn.exr --model hlsh");
}

static const test_case cases[] = {
    {"lightmaps are drawn by every model", lightmaps_are_drawn_by_every_model},
    {"probes are drawn by every model", probes_are_drawn_by_every_model},
    {"what is not there is refused", what_is_not_there_is_refused},
};

TEST_MAIN(cases)
