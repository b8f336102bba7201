/* Makes a volume to measure the sampler on, without a bake: lambent_house_volume DIR [PROBES]
 *
 * Writes DIR/probes.vdb and DIR/probes.lmb with about that many probes (default 262144), those of a house (house.h). */
#include <stdio.h>
#include <stdlib.h>

#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/vdb.h>

#include "house.h"

static lmb_result files_write(const lmb_probes *probes, const char *folder, lmb_error *error)
{
    char *const vdb = lmb_file_in(folder, "probes.vdb");
    char *const lmb = lmb_file_in(folder, "probes.lmb");
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_result result = LMB_ERROR_MEMORY;
    if (vdb && lmb) {
        result = lmb_vdb_write(vdb, probes, &(lmb_vdb_metadata){"{}", ""}, error);
    }
    if (result == LMB_OK) {
        result = lmb_pack(probes, &data, &size, NULL);
    }
    if (result == LMB_OK) {
        result = lmb_file_write(lmb, data, size, error);
    }
    free(data);
    free(vdb);
    free(lmb);
    return result;
}

int main(int argc, char **argv)
{
    const double wanted = argc > 2 ? atof(argv[2]) : 262144.0;
    if (argc < 2 || argc > 3 || !(wanted >= 1.0 && wanted <= 1e8)) {
        fputs("usage: lambent_house_volume DIR [PROBES]\n", stderr);
        return 2;
    }
    lmb_probes *const probes = house_probes(wanted);
    lmb_error error = {"out of memory"};
    const lmb_result result = probes ? files_write(probes, argv[1], &error) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        const int32_t *const size = probes->level[0].lattice.size;
        printf("%s: %d probes of %d x %d x %d points\n", argv[1], probes->count, size[0], size[1], size[2]);
    } else {
        fprintf(stderr, "lambent_house_volume: %s\n", error.message);
    }
    lmb_probes_destroy(probes);
    return result == LMB_OK ? 0 : 1;
}
