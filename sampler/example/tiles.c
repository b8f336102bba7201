/* Moves a camera along a line through a volume in tiles and prints the light there: tiles FILE.lmt METRES. Tiles nearer
 * than METRES are opened, those farther than twice that are closed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/tiles.h>

/* FILE_X_Y_Z.lmb beside FILE.lmt. A game does it on a thread that loads, while others sample. */
static void tile_open(lmb_volume_tiles *tiles, uint32_t number, const char *index_path)
{
    const lmb_volume_tile tile = lmb_volume_tiles_get(tiles, number);
    const int stem = (int)(strlen(index_path) - strlen(".lmt"));
    char path[4096];
    lmb_volume *volume = NULL, *former; /* NULL: tiles are opened here that are not set */
    snprintf(path, sizeof path, "%.*s_%d_%d_%d.lmb", stem, index_path, tile.at[0], tile.at[1], tile.at[2]);
    lmb_result result = lmb_volume_open_file(path, &volume);
    if (result == LMB_OK) {
        result = lmb_volume_tiles_set(tiles, number, volume, &former);
    }
    if (result != LMB_OK) { /* positions in it stay outside */
        fprintf(stderr, "tiles: %s: %s\n", path, lmb_result_text(result));
        lmb_volume_close(volume);
    }
}

/* From the camera to the tile along the axis where that is most; not above 0 within. */
static double tile_distance(const lmb_volume_tile *tile, lmb_vec3d camera)
{
    const lmb_vec3d low = tile->bounds_min, high = tile->bounds_max;
    const double x = fmax(low.x - camera.x, camera.x - high.x), y = fmax(low.y - camera.y, camera.y - high.y);
    return fmax(fmax(x, y), fmax(low.z - camera.z, camera.z - high.z));
}

int main(int count, char **values)
{
    static _Alignas(16) unsigned char index[1 << 20]; /* 30 000 tiles */
    FILE *const file = count == 3 && strlen(values[1]) > strlen(".lmt") ? fopen(values[1], "rb") : NULL;
    const size_t size = file ? fread(index, 1, sizeof index, file) : 0;
    lmb_volume_tiles *tiles;
    const lmb_result opened = file ? lmb_volume_tiles_open_memory(index, size, &tiles) : LMB_ERROR_IO;
    if (opened != LMB_OK) {
        fprintf(stderr, "tiles: %s: %s\n", count == 3 ? values[1] : "FILE.lmt METRES", lmb_result_text(opened));
        return 1;
    }
    fclose(file);
    const double reach = strtod(values[2], NULL);
    const lmb_volume_tiles_info info = lmb_volume_tiles_get_info(tiles);
    const lmb_vec3d low = info.bounds_min, high = info.bounds_max;
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    for (int step = 0; step <= 10; ++step) {
        const double t = step / 10.0;
        const lmb_vec3d camera = {low.x + t * (high.x - low.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z)};
        uint32_t open = 0;
        for (uint32_t i = 0; i < info.tile_count; ++i) {
            const lmb_volume_tile tile = lmb_volume_tiles_get(tiles, i);
            const double distance = tile_distance(&tile, camera);
            if (distance < reach && !lmb_volume_tiles_is_set(tiles, i)) {
                tile_open(tiles, i, values[1]);
            } else if (distance > 2.0 * reach) { /* no other thread samples here, or closing waits: lambent/tiles.h */
                lmb_volume_close(lmb_volume_tiles_clear(tiles, i));
            }
            open += lmb_volume_tiles_is_set(tiles, i);
        }
        lmb_rgb light;
        const bool inside = lmb_volume_tiles_irradiance(tiles, camera, up, &light);
        printf("x %7.2f %s  %u of %u tiles  irradiance %.4f %.4f %.4f\n", camera.x, inside ? "inside " : "outside",
               open, info.tile_count, (double)light.c[0], (double)light.c[1], (double)light.c[2]);
    }
    for (uint32_t i = 0; i < info.tile_count; ++i) {
        lmb_volume_close(lmb_volume_tiles_clear(tiles, i)); /* NULL where it was not set */
    }
    lmb_volume_tiles_close(tiles);
    return 0;
}
