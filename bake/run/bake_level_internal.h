#ifndef LMB_BAKE_LEVEL_INTERNAL_H
#define LMB_BAKE_LEVEL_INTERNAL_H

#include <lambent/bake_level.h>

/* How the level's file is read. Points into `settings`; `warnings` may be NULL. */
lmb_gltf_options lmb_level_gltf_options(const lmb_level_settings *settings, const lmb_warnings *warnings);

#endif
