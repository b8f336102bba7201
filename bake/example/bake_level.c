/* Bakes a level's probes and lightmaps into a folder, as `lambent bake --lightmaps` does: bake_level LEVEL DIR */
#include <stdio.h>

#include <lambent/bake.h>

static bool print_progress(void *context, const lmb_bake_progress *progress)
{
    (void)context;
    /* Negative seconds: not known yet. */
    printf("%-13s %3.0f %%, %.0f s left\n", lmb_bake_phase_name(progress->phase), 100.0 * progress->done,
           progress->seconds_left);
    return true; /* or stop the bake, which leaves the folder as it was */
}

static void print_warning(void *context, const char *line)
{
    (void)context;
    fprintf(stderr, "bake_level: warning: %s\n", line);
}

int main(int count, char **values)
{
    if (count != 3) {
        fprintf(stderr, "usage: bake_level LEVEL DIR\n");
        return 2;
    }
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.level.path = values[1];
    settings.lightmaps = true;
    lmb_bake_settings_quality(&settings, "draft");

    const lmb_bake_listener listener = {.progress = print_progress, .warnings = {print_warning, NULL}};
    lmb_bake_record record;
    lmb_error error;
    lmb_bake_folder *folder;
    lmb_result result = lmb_bake_folder_open(values[2], settings.lightmaps, &folder, &error);
    if (result == LMB_OK) {
        result = lmb_bake_run(&settings, folder, &listener, &record, &error);
        lmb_bake_folder_close(folder);
    }
    if (result != LMB_OK) {
        fprintf(stderr, "bake_level: %s\n", error.message);
        return 1;
    }
    printf("%d probes and %llu texels in %s, noise of %.1f %%\n", record.probes,
           (unsigned long long)record.lightmap.elements, values[2], 100.0 * lmb_bake_record_error(&record));
    return 0;
}
