/* A tool that builds a volume: probes, dilation, .vdb, .lmb, sampler, all through the installed package. */
#include <lambent/pack.h>
#include <lambent/probes.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int main(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {2, 2, 2}};
    const int32_t points[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                  {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    lmb_probes *probes = NULL;
    lmb_probes *read = NULL;
    lmb_volume *volume = NULL;
    unsigned char *data = NULL;
    size_t bytes = 0;
    lmb_sh3_rgb light = {{{{0.0f}}}};
    if (lmb_probes_create(&probes) != LMB_OK || lmb_probes_add_level(probes, &lattice, points, 8) != LMB_OK) {
        return 1;
    }
    probes->validity[0] = 1.0f;
    probes->radiance[0][0].channel[1].c[0] = 0.5f;
    const lmb_vdb_metadata metadata = {"{}", ""};
    lmb_error error = {""};
    if (lmb_probes_dilate(probes) != LMB_OK || lmb_vdb_write("consumer.vdb", probes, &metadata, &error) != LMB_OK ||
        lmb_vdb_read("consumer.vdb", &read, NULL, NULL, &error) != LMB_OK ||
        lmb_pack(read, &data, &bytes, NULL) != LMB_OK || lmb_volume_open_memory(data, bytes, &volume) != LMB_OK) {
        fprintf(stderr, "%s\n", error.message);
        return 1;
    }
    const lmb_vec3 middle = {0.5f, 0.5f, 0.5f};
    const int is_inside = lmb_volume_sample(volume, middle, &light);
    printf("inside %d, light %g\n", is_inside, (double)light.channel[1].c[0]);
    lmb_volume_close(volume);
    free(data);
    lmb_probes_destroy(read);
    lmb_probes_destroy(probes);
    return is_inside && light.channel[1].c[0] == 0.5f ? 0 : 1;
}
