/* By which keys bakes are told apart. */
#ifndef LMB_BAKE_KEY_H
#define LMB_BAKE_KEY_H

#include <stdint.h>

#include <lambent/bake_settings.h>

/* Of everything that decides the bytes of a bake: settings, the level's and environment's content, this program's
 * version. Not of the level's path. 0: out of memory. */
uint64_t lmb_bake_key(const lmb_bake_settings *settings, uint64_t content_hash);

/* Of a bake with that key, of a box alone. */
uint64_t lmb_bake_part_key(uint64_t key, const lmb_vec3d box[2]);

#endif
