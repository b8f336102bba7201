/* Buildings from axis-aligned blocks: solid ones add, empty ones carve, and later ones overwrite earlier ones. Only
 * the surfaces where solid meets empty become quads, each once, with corners on common planes: no hidden, doubled or
 * cracked faces. */
#ifndef LAMBENT_LEVEL_BLOCKS_H
#define LAMBENT_LEVEL_BLOCKS_H

#include "level_builder.h"

typedef struct lmb_level_block {
    lmb_vec3 min, max;
    bool solid;
    int material[6]; /* of its -X, +X, -Y, +Y, -Z, +Z sides; a face between two blocks takes the later block's.
                        LMB_LEVEL_NONE leaves the face out */
} lmb_level_block;

/* A block with one material on all its sides. */
lmb_level_block lmb_level_block_of(bool solid, lmb_vec3 min, lmb_vec3 max, int material);

/* Adds the surface of `count` blocks to the mesh. Textures are laid out once over all of it. */
void lmb_level_builder_add_blocks(lmb_level_builder *builder, int mesh, const lmb_level_block *blocks, size_t count);

#endif
