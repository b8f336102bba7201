/* The bytes that a level has anywhere, put into the chunk of the one that is written. */
#ifndef LMB_GLTF_EMBED_H
#define LMB_GLTF_EMBED_H

#include "gltf/gltf_writer.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Moves all buffers into the chunk. @return LMB_ERROR_FORMAT, _MEMORY */
lmb_result lmb_gltf_embed_buffers(lmb_gltf_writer *w);

/* Puts images that lie elsewhere behind them; those that cannot be read stay where they are, with a warning.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_gltf_embed_images(lmb_gltf_writer *w);

#ifdef __cplusplus
}
#endif

#endif
