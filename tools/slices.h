/* Pictures of a plane through probes: what the volume is made of, and the light that it holds. */
#ifndef LMB_TOOLS_SLICES_H
#define LMB_TOOLS_SLICES_H

#include <stdbool.h>
#include <stdint.h>

#include <lambent/probes.h>

typedef struct lmb_slice {
    int axis; /* 0, 1 or 2: x, y or z, which the plane is at right angles to */
    bool has_at;
    double at; /* metres along it; without: half way through the probes */
} lmb_slice;

/* The pictures. Where there is no cell they are black. Seen against the axis: x to the right (z, for x) and y upwards
 * (z downwards, for y). */
enum {
    SLICE_LEVELS,     /* a colour for each level, lighter in cut cells; cells have borders where there is room */
    SLICE_REGIONS,    /* a colour for each region of a cell that planes cut; others are grey, lighter if they are cut */
    SLICE_VALIDITY,   /* of the probe at the nearest corner of the cell: black 0, white 1; ghosts are tinted blue */
    SLICE_IRRADIANCE, /* without key lights, the mean over all normals, exposed and tone mapped */
    SLICE_PICTURES
};

typedef struct lmb_slice_pictures {
    int32_t width, height;
    uint8_t *srgb[SLICE_PICTURES]; /* 3 bytes a pixel, row 0 on top */
    double at;                     /* where the plane lies */
} lmb_slice_pictures;

/* Draws them. @return LMB_ERROR_MEMORY; then there are none */
lmb_result slice_draw(const lmb_probes *probes, const lmb_slice *slice, lmb_slice_pictures *pictures);

void slice_free(lmb_slice_pictures *pictures);

/* Writes levels.png, regions.png, validity.png and irradiance.png into a folder, which is made where it is not there.
 * @return LMB_ERROR_MEMORY, _WRITE */
lmb_result slice_write(const lmb_slice_pictures *pictures, const char *folder, lmb_error *error);

#endif
