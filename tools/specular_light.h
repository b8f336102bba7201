/* Light around a point, whose reflections lambent_specular compares: a picture without its sun, the harmonics of that,
 * and the sun as a key light. */
#ifndef LMB_TOOLS_SPECULAR_LIGHT_H
#define LMB_TOOLS_SPECULAR_LIGHT_H

#include <lambent/environment.h>
#include <lambent/specular.h>

/* The picture as so many lights, columns x rows, for lobes that are wider than one. */
enum { SPECULAR_COLUMNS = 128, SPECULAR_ROWS = 64, SPECULAR_CELLS = SPECULAR_COLUMNS * SPECULAR_ROWS };

typedef struct specular_light {
    lmb_vec3 cell_direction[SPECULAR_CELLS];
    lmb_rgb cell_light[SPECULAR_CELLS]; /* radiance times solid angle */
    lmb_vec3 *bright_direction;         /* of pixels that samples would hit too seldom, what is above `most` */
    lmb_rgb *bright_light;
    size_t bright_count;
    float most;             /* luminance */
    lmb_scene scene;        /* the environment alone */
    lmb_key_light sun;      /* irradiance 0: none */
    lmb_sh3_rgb radiance;   /* of the picture without the sun */
    lmb_sh3_rgb all;        /* with it */
    lmb_key_light dominant; /* of all */
    lmb_sh3_rgb rest;       /* of all, without the dominant light */
} specular_light;

/* `description` as --env takes it; a picture or daylight. @return as lmb_scene_set_environment */
lmb_result specular_light_open(const char *description, specular_light *light, lmb_error *error);
void specular_light_close(specular_light *light);

/* A surface and who looks at it. */
typedef struct specular_surface {
    lmb_specular specular;
    lmb_vec3 normal, view;
} specular_surface;

/* Radiance of the picture, with its bright pixels. */
lmb_rgb specular_light_look(const specular_light *light, lmb_vec3 direction);

/* Radiance that a surface reflects of the picture: from the roughness of SPECULAR_WIDE on by the sum over all cells,
 * below it by the sum over what is bright and `samples` half vectors for the rest. The Fresnel factor is a
 * dielectric's, and its own code. */
#define SPECULAR_WIDE 0.3f
lmb_rgb specular_traced(const specular_light *light, const specular_surface *surface, uint32_t samples,
                        uint64_t stream);

/* What layers give. */
typedef enum specular_layer {
    SPECULAR_AREA,        /* of the picture, by harmonics */
    SPECULAR_ENVIRONMENT, /* of it, by a picture: as rough, in the mirrored direction, over its area layer, times that
                           */
    SPECULAR_SPLIT,       /* that picture times what a white sky sends on */
    SPECULAR_PHONG,       /* of it, by harmonics, through Phong's lobe of twice the roughness */
    SPECULAR_SUN,         /* of all light: the sun's highlight alone */
    SPECULAR_KEY,         /* that and the area layer */
    SPECULAR_KEY_MAP,     /* that and the environment map */
    SPECULAR_DOMINANT,    /* the highlight of the dominant light, and the area layer of what remains */
    SPECULAR_PAPER,       /* the same, and the area layer of all, as the paper adds them */
    SPECULAR_ALL_AREA,    /* the area layer alone */
    SPECULAR_LAYERS
} specular_layer;

/* Whether a layer is of the picture, without the sun. */
static inline bool specular_layer_is_of_picture(specular_layer layer)
{
    return layer <= SPECULAR_PHONG;
}

lmb_rgb specular_layer_of(const specular_light *light, specular_layer layer, const specular_surface *surface,
                          uint32_t samples, uint64_t stream);

#endif
