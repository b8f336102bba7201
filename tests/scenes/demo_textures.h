/* The demo level's textures, made pixel by pixel; equal on every machine. All repeat without a seam. */
#ifndef LAMBENT_DEMO_TEXTURES_H
#define LAMBENT_DEMO_TEXTURES_H

#include "level_builder.h"

typedef enum lmb_demo_texture {
    LMB_DEMO_PLASTER,      /* nearly white, slightly uneven */
    LMB_DEMO_TILES,        /* a checker of 2 x 2 dark and light tiles */
    LMB_DEMO_WOOD,         /* 4 planks along u */
    LMB_DEMO_BRICK,        /* 8 courses of 4 bricks */
    LMB_DEMO_BRICK_NORMAL, /* the same bricks, as a tangent-space normal map */
    LMB_DEMO_LATTICE       /* 4 x 4 holes (alpha 0) between white bars */
} lmb_demo_texture;

/* @return the image's index, or LMB_LEVEL_NONE when memory has run out */
int lmb_demo_texture_add(lmb_level_builder *builder, lmb_demo_texture texture);

#endif
