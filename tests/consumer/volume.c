/* A tool that builds a volume: grid, dilation, .vdb, .lmb, sampler, all through the installed package. */
#include <lambent/grid.h>
#include <lambent/pack.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int main(void)
{
    const int32_t min[3] = {0, 0, 0}, size[3] = {2, 2, 2};
    const uint8_t wanted[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    lmb_grid *grid = NULL;
    lmb_grid *read = NULL;
    lmb_volume *volume = NULL;
    unsigned char *data = NULL;
    size_t bytes = 0;
    lmb_sh3_rgb light = {{{{0.0f}}}};
    if (lmb_grid_create(1.0f, min, size, &grid) != LMB_OK || lmb_grid_add_probes(grid, wanted) != LMB_OK) {
        return 1;
    }
    grid->validity[0] = 1.0f;
    grid->radiance[0].channel[1].c[0] = 0.5f;
    const lmb_vdb_metadata metadata = {"{}", ""};
    lmb_error error = {""};
    if (lmb_grid_dilate(grid) != LMB_OK || lmb_vdb_write("consumer.vdb", grid, &metadata, &error) != LMB_OK ||
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
    lmb_grid_destroy(read);
    lmb_grid_destroy(grid);
    return is_inside && light.channel[1].c[0] == 0.5f ? 0 : 1;
}
